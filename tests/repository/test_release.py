"""One version number, and what a release is made of, in all places."""

import re
import tomllib

import pytest
from conftest import ROOT

import frictionmap as fm


def _text(name):
    return (ROOT / name).read_text(encoding="utf-8")


def _released():
    """Number and date of the newest release in the changelog."""
    return re.findall(r"^## (\d+\.\d+\.\d+) \((\d{4}-\d{2}-\d{2})\)$", _text("CHANGELOG.md"), re.MULTILINE)[0]


def _number(version):
    return tuple(map(int, version.split(".")[:3]))


def test_the_version_is_a_release_or_on_the_way_to_the_next():
    if re.fullmatch(r"\d+\.\d+\.\d+", fm.__version__):
        assert fm.__version__ == _released()[0]
        assert "## Unreleased" not in _text("CHANGELOG.md")
    else:
        assert re.fullmatch(r"\d+\.\d+\.\d+\.dev\d+", fm.__version__)
        assert _number(fm.__version__) > _number(_released()[0])


def test_the_last_release_is_cited():
    found = dict(re.findall(r"^(version|date-released): (.*)$", _text("CITATION.cff"), re.MULTILINE))
    assert (found["version"], found["date-released"]) == _released()


def test_entries_for_bibtex_have_the_last_release():
    import sys

    sys.path.insert(0, str(ROOT / "docs"))
    try:
        generated = pytest.importorskip("generated")
    finally:
        sys.path.remove(str(ROOT / "docs"))
    entries = "\n".join(generated.citation())
    number, date = _released()
    assert f"version = {{{number}}}" in entries
    assert f"year    = {{{date[:4]}}}" in entries
    assert entries.count("{") == entries.count("}")


@pytest.fixture(scope="module")
def recipe():
    """The recipe for conda, rendered as `conda build` does."""
    jinja2, yaml = pytest.importorskip("jinja2"), pytest.importorskip("yaml")

    def load_file_regex(load_file, regex_pattern, from_recipe_dir):
        assert from_recipe_dir
        return re.search(regex_pattern, (ROOT / "conda" / load_file).read_text(encoding="utf-8"))

    return yaml.safe_load(
        jinja2.Environment(undefined=jinja2.StrictUndefined)
        .from_string(_text("conda/meta.yaml"))
        .render(load_file_regex=load_file_regex, PYTHON="python")
    )


def test_the_recipe_has_the_number_of_the_package(recipe):
    assert recipe["package"] == {"name": "frictionmap", "version": fm.__version__}


def test_the_recipe_needs_what_the_package_needs(recipe):
    project = tomllib.loads(_text("pyproject.toml"))["project"]
    needed = {re.sub(r"^matplotlib>", "matplotlib-base>", name.lower()) for name in project["dependencies"]}
    needed.add("python" + project["requires-python"])
    assert {name.replace(" ", "") for name in recipe["requirements"]["run"]} == needed


def test_the_recipe_starts_what_the_package_starts(recipe):
    scripts = tomllib.loads(_text("pyproject.toml"))["project"]["scripts"]
    found = dict(entry.split(" = ") for entry in recipe["build"]["entry_points"])
    assert found == scripts
    for command in recipe["test"]["commands"]:
        assert command.split()[0] in scripts

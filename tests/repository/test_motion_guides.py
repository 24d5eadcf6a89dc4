"""Guides whose code prints what they show; configurations of motions in time are the files."""

import contextlib
import io

import pytest
from conftest import ROOT
from test_readme import blocks

CONFIGS = ROOT / "configs" / "motions"
NAMED = "# configs/motions/"
ALL = {path.name: blocks(path.read_text(encoding="utf-8")) for path in (ROOT / "docs/guides").glob("*.md")}
#: Guides with the output of their code, beside those of motions in time.
PRINTED = {
    "motions-in-time.md", "reading-a-map.md", "records.md", "response-curves.md", "several-contacts.md",
    "units.md", "which-start.md",
}  # fmt: skip
PAGES = {
    name: found
    for name, found in sorted(ALL.items())
    if name in PRINTED or any(language == "toml" and text.startswith(NAMED) for language, text in found)
}


@pytest.mark.parametrize("page", PAGES)
def test_code_prints_what_the_page_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names, printed = {"__name__": "guide"}, io.StringIO()
    for language, text in PAGES[page]:
        if language == "python":
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(text, page, "exec"), names)
        elif language == "text":
            assert printed.getvalue() == text


def test_every_configuration_stands_on_a_page():
    shown = {
        text.partition("\n")[0].removeprefix(NAMED): text.partition("\n")[2]
        for found in PAGES.values()
        for language, text in found
        if language == "toml" and text.startswith(NAMED)
    }
    assert sorted(shown) == sorted(path.name for path in CONFIGS.glob("*.toml"))
    for name, text in shown.items():
        kept = (CONFIGS / name).read_text(encoding="utf-8")
        assert text.split() in (kept.split(), kept.partition("\n")[2].split()), name

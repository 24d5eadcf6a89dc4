"""The manual is built without a warning, names every command, key and function, and fetches nothing."""

import html
import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT
from pages import HANG
from test_reference import NAMES

import frictionmap as fm
from frictionmap.command_line.arguments import described
from frictionmap.files.keys import KEYS
from frictionmap.model.settings import GENERAL_OUTPUTS, OUTPUTS


@pytest.fixture(scope="module")
def manual(tmp_path_factory):
    """The folder of its pages, the figures left out."""
    pytest.importorskip("sphinx_gallery")
    pytest.importorskip("myst_parser")
    pytest.importorskip("furo")
    folder = tmp_path_factory.mktemp("manual")
    copy = folder / "docs"  # pages are made beside the others
    for name in ("docs", "configs", "benchmarks/results", "paper", "CHANGELOG.md", "CITATION.cff"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).symlink_to(ROOT / name) if name != "docs" else copy_of(ROOT / name, copy)
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "-W", "-t", "quick", copy, folder / "pages"],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=3000,
    )
    assert done.returncode == 0, done.stderr
    return folder / "pages"


def copy_of(folder, place):
    """The files of a folder that are kept, without what a build has made."""
    made = {"figures", "reference", "_build"}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.relative_to(folder).parts[0] not in made:
            target = place / path.relative_to(folder)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(path.read_bytes())


def text(manual, page):
    return (manual / page).read_text(encoding="utf-8")


def test_every_command_and_option_is_documented(manual):
    page = text(manual, "reference/commands.html")
    for command in described():
        assert f"frictionmap {command.name}" in page
        flags = {flag for argument in command.arguments for flag in argument.flags} - {"-h", "--help"}
        assert not {flag for flag in flags if flag not in page}


def test_every_key_and_output_is_documented(manual):
    page = text(manual, "reference/configuration.html")
    assert all(f">{key.name}<" in page for keys in KEYS.values() for key in keys)
    variables = text(manual, "reference/variables.html")
    assert all(f">{name}<" in variables for name in (*OUTPUTS, *GENERAL_OUTPUTS))


def test_every_public_name_has_a_page(manual):
    index = text(manual, "reference/api.html")
    for name in NAMES:
        assert f'id="frictionmap.{name}"' in text(manual, f"reference/api/frictionmap.{name}.html"), name
        assert f'href="api/frictionmap.{name}.html' in index, name
    constants = [name for name in fm.regimes.__all__ if isinstance(getattr(fm.regimes, name), int)]
    assert constants
    page = text(manual, "reference/codes.html")
    for name in constants:
        assert f">{name}<" in page, name


def test_every_guide_can_be_found(manual):
    index = text(manual, "index.html")
    for path in (ROOT / "docs" / "guides").glob("*.md"):
        assert f'href="guides/{path.stem}.html"' in index
    assert len(list(manual.glob("figures/plot_*.html"))) == len(list((ROOT / "docs/gallery").glob("*.py")))


TRADES = ("squeal", "macroslip", "bearing", "isolator", "brace", "blade", "backlash", "earthquake")


@pytest.mark.parametrize("word", TRADES)
def test_first_page_has_the_words_of_the_trades(manual, word):
    assert word in text(manual, "index.html")


@pytest.mark.parametrize("word", TRADES)
def test_search_finds_the_words_of_the_trades(manual, word):
    """The index that the search of the pages loads has them, on the page of the glossary as well."""
    stemmer = pytest.importorskip("snowballstemmer").stemmer("porter")
    found = re.fullmatch(r"Search\.setIndex\((.*)\);?\s*", text(manual, "searchindex.js"), re.DOTALL)
    index = json.loads(found[1])
    pages = np.atleast_1d(index["terms"].get(stemmer.stemWord(word), []))
    assert "glossary" in [index["docnames"][int(page)] for page in pages]


#: What follows the heading, or the bold word, of a decision.
DECISION = re.compile(
    r"(?:^#+ [^\n]*\bdecision\b[^\n]*\n|\*\*Decision\.\*\*)(.*?)(?=^#|\Z)",
    re.IGNORECASE | re.MULTILINE | re.DOTALL,
)


def test_every_guide_has_a_decision_with_numbers():
    for path in (ROOT / "docs" / "guides").glob("*.md"):
        decisions = DECISION.findall(path.read_text(encoding="utf-8"))
        assert [words for words in decisions if re.search(r"\d", words)], path.name


def test_nothing_is_fetched_from_elsewhere(manual):
    for page in manual.rglob("*.html"):
        tags = re.findall(r"<(?:script|link|img|iframe|source)\b[^>]*>", page.read_text(encoding="utf-8"))
        assert not [tag for tag in tags if re.search(r'(?:src|href)="(?:https?:)?//', tag)], page
    for sheet in manual.rglob("*.css"):
        assert not re.search(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//", sheet.read_text(encoding="utf-8"))


def test_every_formula_of_the_theory_is_typeset(manual):
    source = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    displayed = re.findall(r"^ *\$\$\n(.+?)\n *\$\$$", source, re.MULTILINE | re.DOTALL)
    inline = re.findall(r"(?<!\$)\$[^$\n]+\$(?!\$)", source)
    assert len(displayed) > 30  # the pattern finds them
    page = text(manual, "theory.html")
    assert '<div class="highlight' not in page  # no formula in a box of characters
    formulas = re.findall(r"<math\b.*?</math>", page, re.DOTALL)
    assert len(formulas) == len(displayed) + len(inline)
    assert page.count('<div class="math"') == len(displayed)  # each can scroll by itself
    # what the converter does not know stays in the text as it is: commands, and & of an environment
    shown = [html.unescape(re.sub(r"<[^>]+>", "", formula)) for formula in formulas]
    assert not [formula for formula in shown if "\\" in formula or "&" in formula]


def test_no_symbol_of_the_theory_is_spelled_out(manual):
    page = text(manual, "theory.html")
    page = page[page.index("<h1>") : page.index("</article>")]
    page = re.sub(r"<(math|code)\b.*?</\1>", "", page, flags=re.DOTALL)
    prose = html.unescape(re.sub(r"<[^>]+>", "", page))
    greek = r"\b(?:beta|gamma|chi|lambda|omega|zeta|tau|phi|kappa|sigma|theta)(?:_\w+)?\b"
    assert re.findall(rf"{greek}|\w\^\{{", prose) == []


def test_no_formula_of_the_manual_is_left_as_source(manual):
    for page in manual.rglob("*.html"):
        assert "$$" not in page.read_text(encoding="utf-8"), page


#: Sizes of windows, and pages with all that pages consist of: tables, code, formulas, pictures, signatures.
SIZES = {"phone": (390, 844), "tablet": (820, 1180), "desktop": (1440, 900)}
LOOKED_AT = (
    "index",
    "theory",
    "guides/choosing-friction",
    "reference/configuration",
    "reference/api/frictionmap.sweep",
)


@pytest.mark.parametrize("size", SIZES)
def test_axe_finds_nothing_serious_on_a_page(browser, manual, size):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    context = browser.new_context(viewport=dict(zip(("width", "height"), SIZES[size], strict=True)))
    page = context.new_page()
    page.set_default_timeout(1000.0 * HANG)
    for name in LOOKED_AT:
        page.goto((manual / f"{name}.html").as_uri())
        found = axe.run(page).response
        serious = [one for one in found["violations"] if one["impact"] in ("serious", "critical")]
        assert [(one["id"], [node["target"] for node in one["nodes"]]) for one in serious] == [], name
        assert len(found["passes"]) > 10
        assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0, name
    context.close()

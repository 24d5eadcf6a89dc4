"""The glossary: one row per term, and every equation that it cites exists."""

import re

import pytest
from conftest import ROOT

from frictionmap.units.table import UNITS

GLOSSARY = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in GLOSSARY.splitlines()
    if line.startswith("|") and not line.startswith(("| term", "| ---"))
]


def test_every_row_has_a_term_and_a_meaning():
    assert len(ROWS) > 60
    for row in ROWS:
        assert len(row) == 4, row
        assert row[0], row
        assert row[2], row


def test_no_term_and_no_symbol_has_two_meanings():
    terms = [term.strip() for row in ROWS for term in row[0].split(",")]
    symbols = [symbol.strip() for row in ROWS for symbol in row[1].split(",") if symbol.strip()]
    assert len(terms) == len(set(terms))
    assert len(symbols) == len(set(symbols))


def test_sections_that_are_cited_exist():
    headings = re.findall(r"^## (\d+)\.", (ROOT / "docs" / "theory.md").read_text(encoding="utf-8"), re.M)
    cited = {number for row in ROWS for number in re.findall(r"(?<!T)\((\d+)\)", row[3])}
    assert cited
    assert cited <= set(headings)


@pytest.mark.parametrize(
    "word",
    [
        "macroslip", "microslip", "backbone", "masing", "engine order", "residual flexibility", "squeal",
        "sticking fraction", "lift-off", "preload", "ring-down", "exceedance", "backlash", "isolator",
        "bearing", "brace",
        "blade", "earthquake", "hysteresis loop", "loss factor", "breakaway", "flutter", "storey drift",
    ],
)  # fmt: skip
def test_words_of_the_trades_are_explained(word):
    assert [row for row in ROWS if word in f"{row[0]} {row[2]}".lower()]


def test_units_of_the_glossary_are_units():
    """What stands in brackets in the meaning of a term is a unit, or a key."""
    bracketed = {unit for row in ROWS for unit in re.findall(r"(?<!`)\[([^\]]+)\](?!\()", row[2])}
    assert {"N", "mm", "s", "J"} <= bracketed
    assert bracketed <= {*UNITS, "s", "J", "N/mm", "1/s", "m/s", "m/N", "Hz/s"}

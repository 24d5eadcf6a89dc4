"""Equations of the thesis by their numbers: every number cited exists, and what is computed is cited."""

import io
import re
import tokenize
from pathlib import Path

import frictionmap as fm

PACKAGE = Path(fm.__file__).parent

#: Number of the last equation of each chapter and appendix of the thesis.
LAST = {"2": 37, "3": 34, "4": 5, "5": 96, "6": 33, "7": 62, "A": 20, "B": 15}

#: What the package computes, by the equations that define it.
COMPUTED = {
    "boundary of continuous motion": ("2.26", "3.21", "5.65", "7.46"),
    "its sliding condition S": ("2.27", "5.55"),
    "boundary to permanent sticking": ("2.29", "3.24", "6.11", "6.27", "6.33"),
    "contact amplitude of continuous motion": ("2.34", "7.20"),
    "damping functions": ("7.11", "7.12"),
    "decay functions": ("B.8", "B.9"),
    "limits for r to infinity": ("2.31", "6.8", "6.28", "6.29"),
    "least friction for a finite peak": ("6.2", "6.26", "7.62"),
    "invariant points": ("6.9", "6.10"),
    "amplitude by one harmonic": ("5.50", "7.33"),
    "amplitude and phase by frequency": ("4.4", "4.5"),
    "chain of masses": ("5.4", "5.8"),
    "force in a stop of a moving wall": ("3.32",),
    "continuum of motions": ("3.33",),
}

NUMBER = re.compile(r"\(([2-7AB])\.(\d+)[a-f]?\)")


def cited(path):
    """Chapter and number of every equation cited in comments and docstrings."""
    tokens = tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline)
    for token in tokens:
        if token.type in (tokenize.COMMENT, tokenize.STRING):
            yield from NUMBER.findall(token.string)


def test_every_number_cited_exists():
    numbers = [(path.name, *found) for path in PACKAGE.rglob("*.py") for found in cited(path)]
    assert len(numbers) > 40  # the pattern finds them
    assert [cite for cite in numbers if not 1 <= int(cite[2]) <= LAST[cite[1]]] == []


def test_what_is_computed_is_cited_where_it_is():
    found = {f"{chapter}.{number}" for path in PACKAGE.rglob("*.py") for chapter, number in cited(path)}
    missing = {what: set(numbers) - found for what, numbers in COMPUTED.items() if set(numbers) - found}
    assert missing == {}

"""The paper: its measured numbers are those of the page of results, its length that of a short paper."""

import re

from conftest import ROOT

PAPER = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")


def test_the_table_has_the_numbers_of_the_results():
    rows = re.findall(r"^\| [^|]+(\|(?: [\d.]+ [mµ]?s \| \d+e-\d+ \|){2})$", PAPER, re.MULTILINE)
    assert len(rows) == 6
    for row in rows:
        assert row in RESULTS, row


def test_every_citation_has_an_entry():
    entries = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "paper" / "paper.bib").read_text(), re.MULTILINE))
    cited = set(re.findall(r"@(\w+)", PAPER.partition("# Summary")[2]))
    assert cited == entries


def test_it_is_short():
    body = PAPER.partition("# Summary")[2].partition("# References")[0]
    assert 1000 <= len(re.findall(r"\w[\w'.-]*", body)) <= 1500

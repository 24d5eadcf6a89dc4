"""Invalid input, interrupts and damaged files, some of each kind: nothing goes wrong in careless hands."""

import json

import pytest
from measuring import check_quoted, check_result, python

from benchmarks.measures.faults.verdict import SLOW as TOO_SLOW
from benchmarks.report import results_page


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """The folder of the results, and what was printed."""
    folder = tmp_path_factory.mktemp("results")
    return folder, python("-m", "benchmarks", "faults", "--quick", "--results", str(folder))


@pytest.mark.slow
def test_quick_form(quick):
    folder, said = quick
    assert said.splitlines()[-1].split()[:2] == ["faults", "took"]
    check_result(folder, "faults", "faults")
    assert check_quoted(results_page.block(folder).splitlines()) > 10


@pytest.mark.slow
def test_nothing_goes_wrong_in_careless_hands(quick):
    folder, _ = quick
    families = json.loads((folder / "faults.json").read_text())["families"]
    assert sum(entry["tried"] for entry in families.values()) >= 75
    for name, entry in families.items():
        wrong = set(entry["wrong by kind"]) - {TOO_SLOW}  # a busy machine is
        assert not wrong, (name, entry["examples"])

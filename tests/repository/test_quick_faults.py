"""Invalid input, interrupts and damaged files, some of each kind: nothing goes wrong in careless hands."""

import json

import pytest
from measuring import check_tables, numbers, python

from benchmarks.measures.faults.verdict import SLOW as TOO_SLOW
from benchmarks.report import results_page


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """The folder of the results."""
    folder = tmp_path_factory.mktemp("results")
    python("-m", "benchmarks", "faults", "--quick", "--results", str(folder))
    return folder


@pytest.mark.slow
def test_nothing_goes_wrong_in_careless_hands(quick):
    families = json.loads((quick / "faults.json").read_text())["families"]
    assert sum(entry["tried"] for entry in families.values()) > 90
    for name, entry in families.items():
        wrong = set(entry["wrong by kind"]) - {TOO_SLOW}  # a busy machine is
        assert not wrong, (name, entry["examples"])


@pytest.mark.slow
def test_quick_faults_can_be_quoted(quick):
    assert (quick / "faults.png").read_bytes().startswith(b"\x89PNG")
    assert len(numbers(json.loads((quick / "faults.json").read_text())["families"])) > 30
    assert check_tables(results_page.block(quick).splitlines()) > 10

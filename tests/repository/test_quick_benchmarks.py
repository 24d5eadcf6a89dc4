"""The quick forms of the benchmarks run, and write what they say they write."""

import json

import pytest
from measuring import WITHOUT_FIGURE, check_quoted, check_result, python

from benchmarks.__main__ import BENCHMARKS
from benchmarks.report import results_page

#: Benchmarks whose figure has another name, or that have none.
FIGURES = {"bound": "fig-5-55"} | dict.fromkeys(WITHOUT_FIGURE)

#: In one process, so that each kernel is compiled once.
NAMES = BENCHMARKS


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """The folder of the results, and what was printed."""
    folder = tmp_path_factory.mktemp("results")
    return folder, python("-m", "benchmarks", *NAMES, "--quick", "--results", str(folder))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_quick_form(name, quick):
    folder, said = quick
    assert [line for line in said.splitlines()[-len(NAMES) :] if line.split()[:2] == [name, "took"]]
    check_result(folder, name, FIGURES.get(name, name))


@pytest.mark.slow
def test_quick_results_can_be_quoted(quick):
    folder, _ = quick
    assert check_quoted(results_page.block(folder).splitlines()) > 40


@pytest.mark.slow
def test_our_quick_answers_are_right(quick):
    folder, _ = quick
    accuracy = json.loads((folder / "accuracy.json").read_text())
    for scene in accuracy["steady states"].values():
        for point in scene["methods"]["frictionmap"]["points"]:
            assert point["cells with wrong stop counts"] == 0
            assert max(point["relative errors of Z"]) < 1e-10
    assert accuracy["random cells"]["cells with wrong stop counts"] == 0
    stress = json.loads((folder / "stress.json").read_text())
    assert stress["random cells"]["resolved without a regime or a number"] == []
    for group in stress["groups"].values():
        assert group["inconsistent"] == group["trouble"] == group["wrong stop counts"] == 0
    steady = json.loads((folder / "steady.json").read_text())
    for name in ("T Fig. 3.12", "five damped chains", "mu = 1, any start"):
        assert "unexplained" not in steady[name]["differences by cause"]

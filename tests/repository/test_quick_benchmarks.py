"""The quick forms of the benchmarks run, and write what they say they write; faults: test_quick_faults."""

import json
import math

import pytest
from measuring import check_tables, numbers, python, spreads

from benchmarks.__main__ import BENCHMARKS
from benchmarks.report import results_page

#: Benchmarks whose figure has another name.
FIGURES = {"bound": "fig-5-55"}

#: In one process, so that each kernel is compiled once.
NAMES = [name for name in BENCHMARKS if name != "faults"]


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
    content = json.loads((folder / f"{name}.json").read_text())
    machine = content.pop("machine")
    assert machine["versions"]["numba"]
    if "no browser" in content:
        pytest.skip(content["no browser"])
    found = numbers(content)
    assert len(found) > 5
    assert not any(math.isnan(number) for number in found)
    for one in spreads(content):
        assert one["least"] <= one["median"] <= one["most"]
        assert one["runs"] >= 1
    assert (folder / f"{FIGURES.get(name, name)}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_quick_results_can_be_quoted(quick):
    folder, _ = quick
    lines = results_page.block(folder).splitlines()
    assert check_tables(lines) > 40


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

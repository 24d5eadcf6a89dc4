"""The trials report every fault: tried on a stand-in that does everything wrong."""

import random
import shutil
import textwrap

import numpy as np
import pytest
import xarray as xr

from . import calls, configurations, interrupts, malformed, refusals, verdict
from . import moments as moments_module
from .child import Child, Ended
from .folders import Change, snapshot
from .moments import Run
from .verdict import Family, Said

#: A program whose first argument says how it goes wrong.
STAND_IN = """
    import os, sys, time
    from pathlib import Path


    def main(arguments):
        how = arguments[0]
        if how == "error":
            raise KeyError("beta")
        if how == "hang":
            time.sleep(1000.0)
        if how == "crash":
            os.abort()
        if how == "accept":
            return 0
        if how == "two":
            print("frictionmap: bad\\n  value", file=sys.stderr)
            return 2
        if how == "one":
            print("frictionmap: bad", file=sys.stderr)
            return 1
        if how == "lose":
            Path("c.toml").unlink()
        if how == "leave":
            Path("scratch").write_text("")
        print("frictionmap: beta must be a number; got nan", file=sys.stderr)
        return 2
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("package") / "frictionmap"
    folder.mkdir()
    (folder / "__init__.py").write_text(textwrap.dedent(STAND_IN))
    (folder / "command_line").mkdir()
    (folder / "command_line" / "__init__.py").write_text("")
    (folder / "command_line" / "cli.py").write_text("from .. import main\n")
    return folder.parent


@pytest.fixture(scope="module")
def child(package):
    with Child(package) as started:
        yield started


@pytest.mark.parametrize(
    ("how", "wrong"),
    [
        ("right", None),
        ("error", verdict.TRACEBACK),
        ("crash", verdict.CRASH),
        ("accept", verdict.ACCEPTED),
        ("two", verdict.LINES),
        ("one", verdict.STATUS),
        ("lose", verdict.CHANGED),
        ("leave", verdict.LEFT),
    ],
)
def test_how_a_command_goes_wrong(how, wrong, child, tmp_path):
    prepared = refusals.template(tmp_path / "prepared")
    case = configurations.Case((how,), (("beta",), ("nan",)))
    found, said = refusals.try_case(child, case, prepared, tmp_path / "here")
    assert found == wrong, said


def test_a_message_that_leaves_something_out(child, tmp_path):
    prepared = refusals.template(tmp_path / "prepared")
    case = configurations.Case(("right",), (("gamma",), ("nan",)))
    assert refusals.try_case(child, case, prepared, tmp_path / "here")[0] == verdict.VAGUE


def test_a_hang_is_ended_and_named(child, tmp_path):
    with pytest.raises(Ended) as ended:
        child.ask(limit=1.0, do="main", arguments=["hang"], folder=str(tmp_path))
    assert ended.value.hang
    assert "in main" in ended.value.stack
    assert not ended.value.in_library
    assert child.main(["right"], tmp_path).status == 2  # a new child


def test_a_hang_inside_the_library_is_known():
    stack = (
        'Current thread 0x1:\n  File "/lib/xarray/backends/netCDF4_.py", line 1 in _getitem\n  File "x.py"'
    )
    assert Ended(True, stack).in_library
    assert not Ended(True, 'Current thread:\n  File "x.py", line 1\n  File "netCDF4_.py"').in_library


@pytest.mark.parametrize(
    ("code", "plain", "wrong"),
    [
        ("fm.answer('good')", "", None),
        ("fm.answer('vague')", "", verdict.VAGUE),
        ("fm.answer('two lines')", "", verdict.LINES),
        ("fm.answer(1)", "", verdict.ACCEPTED),
        ("fm.answer()", "", verdict.FOREIGN),
        ("fm.answer(1)", "fm.answer(1)", None),
        ("fm.answer(1)", "fm.answer(2)", verdict.ANSWER),
        ("fm.answer('good')", "fm.answer(2)", verdict.REFUSED),
    ],
)
def test_how_a_call_goes_wrong(code, plain, wrong):
    call = calls.Call(code, (("value",),), plain)
    error = {"good": "value must be better", "vague": "bad", "two lines": "value is\nbad"}
    words = next((text for key, text in error.items() if f"'{key}'" in code), "")
    kind = "TypeError" if code == "fm.answer()" else "InputError" if words else ""
    found = {"error": kind, "words": words, "same": code == plain, "warned": 0, "said": ""}
    assert calls.wrong_outcome(call, found) == wrong


def test_changes_of_a_folder(tmp_path):
    for name in ("kept", "changed", "gone", "opened"):
        (tmp_path / name).write_text(name)
    before = snapshot(tmp_path)
    (tmp_path / "changed").write_text("else")
    (tmp_path / "gone").unlink()
    (tmp_path / "opened").chmod(0o777)
    (tmp_path / "new").symlink_to("kept")
    change = Change.between(before, snapshot(tmp_path))
    assert sorted(change.lost) == ["changed", "gone", "opened"]
    assert change.new == ["new"]
    assert not Change.between(before, before)


def test_counts_and_examples():
    family = Family("name")
    for k in range(10):
        family.add(k, verdict.LINES if k % 2 else None, "said")
    family.add("apart", verdict.HANG, "stack", excused=True)
    content = family.content()
    assert (content["tried"], content["wrong"]) == (11, 5)
    assert content["wrong by kind"] == {verdict.LINES: 5}
    assert content["beyond reach"] == {verdict.HANG: 1}
    assert len(content["examples"][verdict.LINES]) < 5


# Malformed files


@pytest.fixture
def good(tmp_path):
    axes = {"r": [0.5, 1.0, 1.5], "beta": [0.1, 0.2]}
    data = {"regime": (("r", "beta"), np.ones((3, 2), "i1"), {"flag_values": np.array([0, 1], "i1")})}
    path = tmp_path / "good.nc"
    xr.Dataset(data, axes, {"source": "somebody"}).to_netcdf(path)
    return path


@pytest.mark.parametrize("family", [malformed.STRUCTURE, malformed.VALUES, malformed.BYTES, malformed.SLICES])
def test_malformed_files_differ_and_come_again(family, good, tmp_path):
    path = tmp_path / "mutant.nc"
    made = {}
    for seed in range(12):
        words = malformed.make(good, family, seed, path)
        made[words] = path.read_bytes()
        assert malformed.make(good, family, seed, path) == words
        if family == malformed.BYTES:
            assert path.read_bytes() == made[words]
    assert len(made) > 6


def test_a_changed_number_is_seen(good, tmp_path):
    other = tmp_path / "other.nc"
    shutil.copy(good, other)
    assert not malformed.differs(good, other)
    with xr.open_dataset(good) as ds:
        ds.load().assign(regime=ds["regime"] * 0).to_netcdf(other)
    assert malformed.differs(good, other)


# Interrupts


@pytest.mark.parametrize(
    ("said", "wrong"),
    [
        (Said(130, err="frictionmap: interrupted\n"), None),
        (Said(0, out="done"), None),
        (Said(None), verdict.HANG),
        (Said(130, err="x\n", seconds=5.0), verdict.SLOW),
        (Said(1, err="x\n"), verdict.STATUS),
        (Said(-11), verdict.STATUS),
        (
            Said(1, err='Traceback (most recent call last):\n  File "/a/frictionmap/command_line/cli.py"'),
            verdict.TRACEBACK,
        ),
        (Said(130, err="one\ntwo\n"), verdict.LINES),
    ],
)
def test_how_an_interrupted_run_goes_wrong(said, wrong):
    moment = interrupts.Moment(Run("map", [], "out.nc", 1.0, None), "SIGINT", 0.5, False, False)
    assert interrupts.wrong_end(moment, said, allowed=2.0) == wrong


def test_moments_are_spread_over_the_run():
    of = Run("map", [], "out.nc", 2.0, None)
    moments = list(interrupts.moments_of([of], 0.1, (8, 3), random.Random(1)))
    delays = sorted(m.delay for m in moments if m.signal == "SIGINT" and not m.writing)
    assert len(delays) == 8
    assert 0.1 <= delays[0] < 0.35
    assert 1.8 < delays[-1] <= 2.1
    assert sum(m.writing for m in moments) == 3 * len(moments_module.SIGNALS)


def test_the_lists_are_as_long_as_they_are_meant_to_be(tmp_path):
    counts = {name: len(found) for name, found in calls.families().items()}
    assert counts["bad Python calls"] >= 200
    assert len(refusals.families(tmp_path)["bad configurations"]) >= 300
    cases = [
        str(case.arguments) + str(case.files) for case in refusals.families(tmp_path)["bad command lines"]
    ]
    assert len(set(cases)) == len(cases)

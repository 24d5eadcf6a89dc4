"""Invalid input, interrupts and damaged files: some trials of every kind, or with --whole all of them."""

import functools
from pathlib import Path

import pytest
from conftest import ROOT

from . import caches, calls, interrupts, moments, mutants, places, races, refusals
from .child import Child
from .machine import environment
from .verdict import SLOW, UNSEEN, Family

pytestmark = pytest.mark.slow

#: What `--whole` tries at least, by the beginning of the names of families.
LEAST = {"bad c": 300, "bad Python": 200, "interrupts": 100, "malformed": 5000, "damaged": 11}

#: Share of damaged files whose changed numbers may pass unseen: a number that stands alone, outside the
#: compressed arrays, has no checksum.
UNSEEN_SHARE = 0.002


@pytest.fixture(scope="module")
def quick(request):
    return not request.config.getoption("--whole")


@pytest.fixture(scope="module")
def child():
    with Child(ROOT) as started:
        yield started


@pytest.fixture(scope="module")
def commands(quick, tmp_path_factory):
    """The inputs of processes of their own, and the environment."""
    env = environment(ROOT)

    @functools.cache
    def made() -> moments.Commands:
        return moments.Commands(moments.inputs(tmp_path_factory.mktemp("shared") / "inputs", env, quick), env)

    return made


def check(families: list[Family], quick: bool) -> None:
    """Nothing went wrong; trials that ended inside the HDF5 library are counted apart, see `mutants`."""
    for family in families:
        print(
            f"{family.name}: {family.tried} tried; wrong: {dict(family.wrong)}; apart: {dict(family.named)}"
        )
    for family in families:
        excused = {SLOW} if quick else set()  # a busy machine is slow
        if family.wrong[UNSEEN] <= UNSEEN_SHARE * family.tried:
            excused.add(UNSEEN)
        assert not set(family.wrong) - excused, (family.name, dict(family.wrong), family.examples)
    names = [family.name for family in families]
    for beginning, least in {} if quick else LEAST.items():
        tried = sum(family.tried for family in families if family.name.startswith(beginning))
        assert tried >= least or not any(name.startswith(beginning) for name in names)


def test_command_lines_and_configurations(child, quick, tmp_path):
    check(refusals.run(child, tmp_path, quick), quick)


def test_python_calls(child, quick, tmp_path):
    check(calls.run(child, refusals.template(tmp_path / "prepared"), quick), quick)


def test_malformed_files(child, quick, tmp_path):
    check(mutants.run(child, tmp_path, quick), quick)


@pytest.mark.parametrize("part", [interrupts, races, places], ids=["interrupts", "several runs", "places"])
def test_processes(part, commands, quick, tmp_path):
    check(part.run(commands(), tmp_path, quick), quick)


def test_caches(quick, tmp_path):
    check(caches.run(ROOT, Path(tmp_path) / "cache", quick), quick)

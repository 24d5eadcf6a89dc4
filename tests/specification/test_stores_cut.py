"""Stores are cut by what their cells cost, and keep their cut; interrupted workers print nothing."""

import math
import os
import random
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.model.variations import checked_variations
from frictionmap.steady.cost import seconds_of_cells
from frictionmap.stores.cuts import cut_by_cost
from frictionmap.stores.run import fill_store, in_this_process
from frictionmap.stores.store import opened
from frictionmap.stores.study import study_of

pytest.importorskip("zarr")

FIVE = fm.System(mass_ratios=[1] * 5, stiffness_ratios=[1] * 5, damping_ratios=0.01, contact_masses=[3])

#: Some seconds of work.
CONFIG = """
[system]
mass_ratios = [1.0, 1.0, 1.0, 1.0, 1.0]
stiffness_ratios = [1.0, 1.0, 1.0, 1.0, 1.0]
damping_ratios = 0.01
contact_masses = [3]
[grid]
r = { start = 0.05, stop = 2.0, num = 400 }
beta = { start = 0.0, stop = 1.2, num = 200 }
mu = [1.5]
"""
ONE_LINE = re.compile(
    r"frictionmap: interrupted; ([0-9]+) of ([0-9]+) blocks are in out\.zarr; repeat the command to resume\n"
)


def study(system, n, mu, **settings):
    grid = {"mu": np.array(mu), "r": np.linspace(0.05, 2.0, n), "beta": np.linspace(0.0, 1.2, n)}
    return study_of(system, None, grid, fm.Solver(**settings))


def seconds(asked, threads=1):
    axes = {"mu": asked.mu, "r": asked.r, "beta": asked.beta}
    return seconds_of_cells(asked.system, axes, asked.solver, threads)


def test_a_large_map_that_is_expensive_is_cut_into_many_blocks():
    asked = study(FIVE, 800, [1.5])
    cut = cut_by_cost(asked)
    assert replace(asked, cut=cut).blocks >= 4 * 16
    assert cut.rows * 800 * seconds(asked) <= 10.0
    finer = cut_by_cost(asked, workers=100)
    assert replace(asked, cut=finer).blocks >= 4 * 100


def test_a_block_of_a_very_large_map_takes_ten_seconds():
    asked = study(FIVE, 3000, [1.5])
    of_row = 3000 * seconds(asked)
    assert cut_by_cost(asked).rows == max(1, math.floor(10.0 / of_row))


@pytest.mark.parametrize(("system", "mu"), [(fm.System(), [1.0]), (FIVE, [1.0, 1.5])], ids=["one", "five"])
def test_the_cost_is_counted_and_not_timed(system, mu):
    """The same bits at every call and on any number of threads; up to sixteen workers change nothing."""
    asked = study(system, 200, mu)
    assert seconds(asked, 1) == seconds(asked, 2) > 0.0
    assert cut_by_cost(asked) == cut_by_cost(asked, workers=2) == cut_by_cost(asked, workers=16)


def test_what_is_followed_longer_costs_more():
    """Without damping, at lower frequencies, with more masses, and with a look at other starts."""
    usual = seconds(study(FIVE, 100, [1.5]))
    assert seconds(study(FIVE, 100, [1.0])) < usual / 4.0
    assert seconds(study(fm.System(damping_ratios=0.01), 100, [1.5])) < usual / 20.0
    assert seconds(study(replace(FIVE, damping_ratios=0.001), 100, [1.5])) > usual
    others = study(FIVE, 100, [1.5], outputs=("regime", "also_reachable"))
    assert seconds(others) == pytest.approx(9.0 * usual)


def test_many_small_maps_share_files_as_before():
    chance = np.random.default_rng(3)
    axes = {"sample": {"mass_ratios[2]": 1.0 + 0.05 * chance.standard_normal(1000)}}
    grid = {"mu": np.array([1.0]), "r": np.linspace(0.05, 2.0, 15), "beta": np.linspace(0.0, 1.2, 15)}
    asked = study_of(FIVE, checked_variations(FIVE, axes), grid, fm.Solver())
    assert cut_by_cost(asked).together == asked.together == (64, 1, 1)


@pytest.mark.parametrize("cells", [1, 90, 10**9])
def test_results_do_not_depend_on_the_cut(tmp_path, cells):
    asked = study(FIVE, 17, [1.0, 1.5], outputs=("regime", "contact_amplitude", "cycles"))
    path = tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(1), find_cut=lambda one: one.cut_at(cells))
    whole = fm.sweep(FIVE, asked.r, asked.beta, asked.mu, solver=asked.solver)
    assert opened(path).study.rows == max(1, min(17, cells // 17))
    with xr.open_zarr(path, consolidated=False, chunks=None) as stored:
        for name, variable in whole.variables.items():
            np.testing.assert_array_equal(stored[name].values, variable.values)


def test_a_store_is_gone_on_with_by_its_own_cut(tmp_path):
    """Whatever cut a new one would have: by another number of workers, or of another program."""
    asked, path = study(fm.System(), 20, [1.0, 1.5]), tmp_path / "map.zarr"

    def first_three(store, batches):
        return islice(in_this_process(1)(store, batches), 3)

    fill_store(path, asked, "map", first_three, find_cut=lambda one: one.cut_at(60))
    assert opened(path).marks().sum() == 3
    fill_store(path, asked, "map", in_this_process(1), find_cut=lambda one: one.cut_at(200))
    assert opened(path).study.rows == 3
    assert opened(path).marks().all()
    whole = fm.sweep(fm.System(), asked.r, asked.beta, asked.mu, solver=asked.solver)
    with xr.open_zarr(path, consolidated=False, chunks=None) as stored:
        np.testing.assert_array_equal(stored["regime"].values, whole["regime"].values)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("to", ["the program", "all of the terminal"])
def test_workers_are_interrupted_without_a_word_of_theirs(tmp_path, to):
    """At random moments; blocks that were done are kept.

    Another number of workers resumes with them, whichever worker was stopped.
    """
    pytest.importorskip("distributed")
    (tmp_path / "map.toml").write_text(CONFIG)
    command = [sys.executable, "-m", "frictionmap", "map", "map.toml", "-o", "out.zarr", "--quiet"]
    environment = os.environ | {"PYTHONPATH": str(Path(fm.__file__).parent.parent)}
    marks = tmp_path / "out.zarr" / "block_done" / "c"
    run = subprocess.Popen(
        [*command, "--workers", "2"], cwd=tmp_path, env=environment, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    while not any(file.is_file() and file.name.isdigit() for file in marks.rglob("*")) and run.poll() is None:
        time.sleep(0.01)
    time.sleep(random.uniform(0.0, 0.5))
    (os.kill if to == "the program" else os.killpg)(run.pid, signal.SIGINT)
    output, message = run.communicate(timeout=600)  # until nobody is left who could say anything
    found = ONE_LINE.fullmatch(message)
    assert found, message
    assert (run.returncode, output) == (130, "")
    done, blocks = map(int, found.groups())
    kept = opened(tmp_path / "out.zarr").marks()
    assert done <= kept.sum() < blocks == kept.size
    assert kept.any()
    assert blocks >= 8
    if to == "the program":
        _goes_on([*command, "--workers", "1"], tmp_path, environment)


def _goes_on(command, tmp_path, environment):
    """A store is completed by a command, and is the map."""
    subprocess.run(command, cwd=tmp_path, env=environment, check=True, timeout=900)
    ds = opened(tmp_path / "out.zarr")
    assert ds.marks().all()
    whole = fm.sweep(ds.study.system, ds.study.r, ds.study.beta, ds.study.mu)
    with xr.open_zarr(tmp_path / "out.zarr", consolidated=False, chunks=None) as stored:
        np.testing.assert_array_equal(stored["contact_amplitude"].values, whole["contact_amplitude"].values)

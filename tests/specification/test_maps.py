"""Regime maps: any threads, any part of a grid, any outputs; arguments, progress, memory."""

import os
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from conftest import ROOT
from outputs import OUTPUTS
from structures import chain_matrices, pendants

import frictionmap as fm
from frictionmap import jobs, regimes
from frictionmap.files.config import load_config
from frictionmap.single.kernel_data import structure_arrays
from frictionmap.theory.boundary_curves import find_curves


@pytest.mark.parametrize(("given", "used"), [(None, 3), ("", 3), ("1", 1), ("2", 2), ("64", 3)])
@pytest.mark.parametrize("system", [fm.System(), fm.System(contact_stiffness=2.0)])
def test_an_environment_variable_limits_threads(monkeypatch, system, given, used):
    """As install.md says, with three processors; a number that is given as an argument counts for itself."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2}, raising=False)
    monkeypatch.setattr(jobs, "_IDLE", {})
    if given is None:
        monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    else:
        monkeypatch.setenv("NUMBA_NUM_THREADS", given)
    r, beta = np.linspace(0.3, 1.5, 40), np.linspace(0.1, 0.9, 40)
    fm.sweep(system, r, beta)
    assert {*jobs._IDLE} == {used}
    fm.sweep(system, r, beta, threads=4)
    assert {*jobs._IDLE} == {used, 4}


@pytest.mark.parametrize("given", ["0", "-2", "two", "1.5"])
def test_an_invalid_number_of_threads_in_the_environment_is_refused(monkeypatch, given):
    monkeypatch.setenv("NUMBA_NUM_THREADS", given)
    with pytest.raises(fm.InputError, match=f"^NUMBA_NUM_THREADS must be a whole number >= 1; got '{given}'"):
        fm.sweep(fm.System(), [1.0], [0.5])


@pytest.mark.parametrize("start", ["rest", "moving"])
def test_same_bits_for_any_number_of_threads(start):
    r = np.linspace(0.05, 2.5, 60)
    beta = np.linspace(0.0, 1.2, 61)
    for system in (fm.System(), fm.System(contact="joined-base-wall", damping_ratios=0.05)):
        maps = [
            fm.sweep(system, r, beta, [1.0, 1.5], threads=n, start=start, outputs=OUTPUTS) for n in (1, 2, 5)
        ]
        for other in maps[1:]:
            for name in maps[0].data_vars:
                assert maps[0][name].values.tobytes() == other[name].values.tobytes(), name


CHAIN = {"mass_ratios": [1.0, 2.0, 1.5], "stiffness_ratios": [1.0, 0.7, 1.3]}
FREE = chain_matrices([1.0, 0.7, 1.9, 0.4], [1.0, 1.3, 0.6, 2.0])

#: Every kind of system that has arithmetic of its own.
KINDS = {
    "one mass": fm.System(damping_ratios=0.05),
    "one mass and a moving wall": fm.System(contact="joined-base-wall", damping_ratios=0.1),
    "one mass, dampers on the base": fm.System(
        excitation="base", damping_reference="base", damping_ratios=0.2
    ),
    "chain": fm.System(**CHAIN, contact_masses=[2], load_mass=3),
    "damped chain": fm.System(**CHAIN, contact_masses=[3], damping_ratios=[0.01, 0.02, 1.3]),
    "moving wall": fm.System("joined-base-wall", [2], **CHAIN, damping_ratios=0.03),
    "between masses": fm.System("between-masses", [1, 3], **CHAIN, load_mass=2),
    "twenty masses": fm.System(mass_ratios=[1.0] * 20, stiffness_ratios=[1.0] * 20, contact_masses=[17]),
    "matrices": fm.System(matrices=FREE, contact_masses=[4], load=[1.0, 0.3j, 0.0, -0.7 + 0.1j]),
    "matrices with C": fm.System(
        "joined-base-wall", [2], matrices=FREE | {"C": 0.02 * FREE["M"] + 0.01 * FREE["K"]},
        damping_reference="base",
    ),
    "modes that the contact does not see": pendants(4, 2),
    "the same, damped": pendants(1, 4, damping_ratios=0.04),
}  # fmt: skip


def _numbers(found, r):
    """All arrays of the tables that the kernels take, those over r with r first."""
    for name in ("loads", "orbit", "rest", "moving", "marginal", "uncoupled", "held"):
        part = getattr(found, name)
        for k, array in enumerate(part if isinstance(part, tuple) else (part,)):
            if isinstance(array, np.ndarray):
                assert array.shape[0] == r.size
                yield f"{name} {k}", array


@pytest.mark.parametrize("kind", KINDS)
def test_what_depends_on_r_does_not_depend_on_the_other_frequencies(kind):
    """Curves, loads and starts: alone, in slices at any offset and in the whole, to the bit."""
    system = KINDS[kind]
    rng = np.random.default_rng(24)
    r = np.sort(np.concatenate((rng.uniform(0.05, 3.0, 37), [0.5, 1.0, *system.modes.w])))
    r = np.unique(r)
    mu = np.array([1.0, 1.5])
    whole = find_curves(system, r, mu)
    tables = dict(_numbers(structure_arrays(system, r, whole), r)) if system.n > 1 else {}
    pieces = [slice(k, k + 1) for k in range(r.size)]
    pieces += [slice(first, first + length) for first, length in ((0, 2), (1, 7), (3, 16), (6, 33))]
    for piece in pieces:
        part = find_curves(system, r[piece].copy(), mu)
        for name, value in vars(whole).items():
            assert getattr(part, name).tobytes() == value[..., piece].tobytes(), (name, r[piece])
        if tables:
            for name, value in _numbers(structure_arrays(system, r[piece].copy(), part), r[piece]):
                assert value.tobytes() == tables[name][piece].tobytes(), (name, r[piece])


@pytest.mark.parametrize("kind", ["one mass", "chain", "damped chain", "moving wall", "matrices"])
def test_a_cell_does_not_depend_on_the_others(kind):
    """Alone and in another grid: the same answer, to the bit.

    Except for mu = 1, where a neighbour saves the way to the only answer, and so may its last digits be.
    """
    system = KINDS[kind]
    rng = np.random.default_rng(5)
    r = np.sort(rng.uniform(0.1, 2.2, 9))
    beta = np.append(0.0, np.sort(rng.uniform(0.01, 1.0, 11)))
    whole = fm.sweep(system, r, beta, [1.0, 1.3], outputs=OUTPUTS)
    for i, j in zip(rng.integers(0, 9, 6), rng.integers(0, 12, 6), strict=True):
        for rows, columns in (([i], [j]), (sorted({0, i, 8}), sorted({j, 3, 11}))):
            part = fm.sweep(system, r[rows], beta[columns], [1.0, 1.3], outputs=OUTPUTS)
            same = whole.isel(r=rows, beta=columns)
            for name in part.data_vars:
                pair = part[name].values, same[name].values
                np.testing.assert_array_equal(pair[0][1], pair[1][1], name)
                if name in ("contact_amplitude", "stuck_fraction"):
                    np.testing.assert_allclose(*pair, rtol=1e-12, atol=1e-14, err_msg=name)
                elif name not in ("cycles", "origin"):
                    np.testing.assert_array_equal(*pair, name)


def test_a_cell_on_beta_stick_does_not_depend_on_its_grid():
    """T Fig. 6.24, r = 0.5: beta = 0.2 is beta_stick, or next to it; every grid must say the same."""
    config = load_config(ROOT / "configs" / "fig-6-24.toml")
    alone = fm.sweep(config.system, [0.5], [0.2], 1.0)
    for r in (config.r, config.r[50:], config.r[43:57], config.r[::2], config.r[::50]):
        for beta in (config.beta, config.beta[20:21], config.beta[3:22]):
            part = fm.sweep(config.system, r, beta, 1.0).sel(r=[0.5], beta=[0.2])
            for name in alone.data_vars:
                np.testing.assert_array_equal(part[name].values, alone[name].values, name)


@pytest.mark.parametrize("name", OUTPUTS)
def test_only_what_is_asked_for_is_there(name):
    ds = fm.sweep(fm.System(), [0.8, 1.5], [0.2, 0.8], [1.0, 1.5], outputs=[name])
    assert set(ds.data_vars) == {name, "beta_lim", "beta_stick"}
    assert ds[name].dims == ("mu", "r", "beta")


@pytest.mark.parametrize("outputs", [["beta_lim_modal"], ["regime", "beta_lim_modal"]])
def test_the_modal_bound_is_part_of_maps_on_request(outputs):
    """In a map and in a cell it is that of `boundaries`, to the bit; no cell variable is added for it."""
    system = fm.System(contact_masses=[2], mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])
    axes = [0.4, 0.7], [0.05, 0.3], [1.0, 1.4]
    ds = fm.sweep(system, *axes, outputs=outputs)
    assert set(ds.data_vars) == {*outputs, "beta_lim", "beta_stick"}
    expected = fm.boundaries(system, axes[0], axes[2])["beta_lim_modal"]
    np.testing.assert_array_equal(ds["beta_lim_modal"].values, expected.values)
    assert (ds["beta_lim_modal"] < ds["beta_lim"]).any()
    cell = fm.response(system, 0.7, 0.05, outputs=outputs)
    assert float(cell["beta_lim_modal"]) == float(expected.sel(mu=1.0, r=0.7))
    assert "beta_lim_modal" not in fm.response(system, 0.7, 0.05)
    assert "beta_lim_modal" not in fm.curves(system, *axes[:2])


@pytest.mark.parametrize("name", OUTPUTS)
def test_unresolved_cells_have_a_status_whatever_the_outputs(name):
    """r = 1/2 undamped is marginal, r = 0 has no number of stops."""
    axes = [0.0, 0.5, 1.5], [0.2, 0.8], [1.0, 1.5]
    asked = fm.sweep(fm.System(), *axes, outputs=[name])
    told = fm.sweep(fm.System(), *axes, outputs=["status"])
    assert told.status.any()
    np.testing.assert_array_equal(asked.status, told.status, strict=True)


def test_progress_reaches_the_end():
    seen = []
    fm.sweep(fm.System(), np.linspace(0.1, 2, 60), np.linspace(0.1, 0.9, 60), 1.5,
             progress=lambda done, total: seen.append((done, total)))  # fmt: skip
    assert seen == sorted(seen)
    assert seen[-1][0] == seen[-1][1] > 1000


def test_bad_settings():
    with pytest.raises(fm.InputError, match=r"beta must be >= 0; got -0.1 at index 1"):
        fm.sweep(fm.System(), [1.0], [-0.2 + 0.2, -0.1])
    with pytest.raises(fm.InputError, match="threads must be >= 1; got 0"):
        fm.sweep(fm.System(), [1.0], [0.5], threads=0)
    with pytest.raises(fm.InputError, match="at most 1e"):
        fm.sweep(fm.System(), np.linspace(0, 1, 40000), np.linspace(0, 1, 40000))


MASKED = np.ma.masked_array([0.4, 0.5], [True, False])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: fm.sweep("fixed-wall", [1.0], [0.5]),
            "system must be a frictionmap.System; got 'fixed-wall'",
        ),
        (lambda: fm.response(fm.System, 1.0, 0.5), "system must be a frictionmap.System; got <class"),
        (lambda: fm.boundaries(xr.Dataset(), [1.0]), "system must be a frictionmap.System; got <xarray"),
        (lambda: fm.continuous_motion(None, 1.0, 0.1), "system must be a frictionmap.System; got None"),
        (lambda: fm.sweep(fm.System(), [1.0], [0.5], solver="moving"), "solver must be a frictionmap.Solver"),
        (
            lambda: fm.response(fm.System(), 1.0, 0.5, solver={}),
            "solver must be a frictionmap.Solver; got {}",
        ),
        (
            lambda: fm.sweep(fm.System(), [1.0], [0.5], output=["regime"]),
            r"unknown setting 'output' \(did you mean outputs\?\); valid: start",
        ),
        (lambda: fm.sweep(fm.System(), [1.0], [0.5], progress=1), "progress must be a function"),
        (lambda: fm.sweep(fm.System(), MASKED, [0.5]), "r must have no masked values"),
        (lambda: fm.sweep(fm.System(), [0.5], MASKED), "beta must have no masked values"),
        (lambda: fm.boundaries(fm.System(), [0.5], 2.0 + MASKED), "mu must have no masked values"),
        (lambda: fm.response(fm.System(), np.ma.masked, 0.5), "r must have no masked values"),
        (lambda: fm.sweep(fm.System(), xr.Dataset({"r": 1.0}), [0.5]), "r must be numbers"),
        (lambda: fm.response(fm.System(), xr.DataArray([0.5]), 0.5), "r must be a number"),
        (lambda: fm.response(fm.System(), 0.5, 0.5, points=10**9), r"points must be <= 1e\+06"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(fm.InputError, match=message) as error:
        call()
    assert "\n" not in str(error.value)


def same(one, other):
    """Compare all of two datasets but the time at which they were made."""
    time = {"history": ""}
    return one.assign_attrs(time).identical(other.assign_attrs(time))


def test_numbers_in_any_dress():
    """Scalars of a dataset and arrays without dimensions are numbers; axes may be any arrays; no -0.0."""
    system = fm.System()
    ds = fm.sweep(system, xr.DataArray([0.4, 0.9]), np.array([0.2, 0.5], dtype=">f4"), range(1, 3))
    one = fm.response(system, ds.r[1], np.array(0.5), mu=ds.mu[0])
    assert same(one, fm.response(system, 0.9, 0.5, 1.0))
    minus = fm.sweep(system, np.array([-0.0, 0.5]), [-0.0, 0.5])
    assert same(minus, fm.sweep(system, [0.0, 0.5], [0.0, 0.5]))
    assert not np.signbit(minus.r.values).any()


def test_settings_replace_those_of_a_solver():
    solver = fm.Solver(cycles=50, outputs=["regime", "cycles"])
    cell = ([0.9], [0.7], 1.5)
    assert set(fm.sweep(fm.System(), *cell, solver=solver).data_vars) >= {"regime", "cycles"}
    ds = fm.sweep(fm.System(), *cell, solver=solver, start="moving", outputs=["regime"])
    assert "cycles" not in ds
    assert ds.regime.item() == regimes.CONTINUOUS  # from rest it sticks
    assert solver.start == "rest"


def test_response_holds_what_outputs_ask_for():
    system, cell = fm.System(damping_ratios=0.03), (0.662, 0.3, 2.5)
    names = ["cycles", "multiplier", "asymmetry", "amplitude", "also_reachable", "sliding_limit"]
    expected = fm.sweep(system, [cell[0]], [cell[1]], cell[2], outputs=names)
    for found in (
        fm.response(system, *cell, outputs=names),
        fm.response(system, *cell, solver=fm.Solver(outputs=names)),
    ):
        for name in names:
            np.testing.assert_array_equal(found[name].values, expected[name].values.ravel().squeeze(), name)
        assert float(found.amplitude.max()) == pytest.approx(float(np.abs(found.x).max()), rel=1e-4)


def test_public_names_are_listed():
    assert set(fm.__all__) <= set(dir(fm))
    assert "features" in dir(fm)
    assert fm.features.high_frequency_limits(fm.System()).beta_lim == pytest.approx(0.537, abs=1e-3)


def test_kernels_are_cached_between_processes():
    """A second process loads what the first one compiled or found, and compiles nothing."""
    code = (
        "import frictionmap as fm, numba\n"
        "fm.sweep(fm.System(), [0.3], [0.5], 1.0)\n"
        "from frictionmap._kernels.engine.fill import fill_open as f, fill_closed as g\n"
        "print(sum(len(k.stats.cache_hits) for k in (f, g)), sum(len(k.stats.cache_misses) for k in (f, g)))"
    )
    first, second = (
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    )
    assert sum(map(int, first)) == 2
    assert second == ["2", "0"]


@pytest.mark.slow
def test_memory_of_a_large_map():
    """A 4096 x 4096 map with the three default outputs stays below 1 GiB."""
    code = (
        "import frictionmap as fm, numpy as np\n"
        "from frictionmap.files.storage import write\n"
        "import pathlib, tempfile\n"
        "ds = fm.sweep(fm.System(), np.linspace(0.3, 3, 4096), np.linspace(0.9, 4, 4096))\n"
        "with tempfile.TemporaryDirectory() as folder:\n"
        "    write(ds, pathlib.Path(folder) / 'map.nc')\n"
        # getrusage would count what the parent held when it started this process
        "print(*[line.split()[1] for line in open('/proc/self/status') if line.startswith('VmHWM')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 1024 * 1024  # kB


def test_maps_share_no_labels():
    """Coordinates and attributes are kept between calls; what belongs to a dataset is its own."""
    axes = [0.4, 0.9], [0.2, 0.6], [1.0, 1.5]
    first = fm.sweep(fm.System(), *axes, outputs=("regime", "amplitude"))
    kept = first.copy(deep=True)
    plain = xr.Dataset(
        {name: first[name].variable for name in first.data_vars},
        {name: (name, first[name].values.copy(), first[name].attrs) for name in first.coords},
        first.attrs,
    )
    assert first.identical(plain)
    first.r.attrs["long_name"] = "changed"
    first.regime.attrs["long_name"] = "changed"
    with pytest.raises(ValueError, match="read-only"):
        first.regime.attrs["flag_values"][0] = 9
    first.attrs["config"] = "changed"
    first["r"] = first.r * 2.0
    first.beta_lim[:] = 0.0
    second = fm.sweep(fm.System(), *axes, outputs=("regime", "amplitude"))
    assert second.drop_attrs().identical(kept.drop_attrs())
    assert second.r.attrs == kept.r.attrs
    assert second.assign_attrs(history=kept.history).identical(kept)  # it has the time
    assert second.sel(r=0.9, beta=0.2, mu=1.5).r == 0.9
    longer = fm.sweep(fm.System(), np.linspace(0.3, 0.9, 5000), [0.2], [1.2])
    assert longer.sel(r=0.9).r == 0.9

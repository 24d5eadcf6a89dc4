"""Regime maps: planning, threads, skipping, outputs, singular rows of the published grid, interruption."""

import math
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
import xarray as xr
from test_systems import chain_matrices, pendants

import frictionmap as fm
from frictionmap import regimes
from frictionmap.files.config import load_config
from frictionmap.model.settings import OUTPUTS as EVERY
from frictionmap.steady.kernel_data import structures
from frictionmap.theory.boundaries import find_curves

BASE = fm.System(contact="joined-base-wall")

OUTPUTS = EVERY[: EVERY.index("multiplier")]  # that of the masses would take the code for structures


@pytest.fixture(scope="module")
def published():
    """The map of T Fig. 3.12 with every output."""
    config = load_config(_configs() / "fig-3-12.toml")
    return fm.sweep(config.system, config.r, config.beta, config.mu, outputs=OUTPUTS)


def _configs():
    from conftest import ROOT

    return ROOT / "configs"


def test_published_map_rows_at_the_edges(published):
    """r = 0, r = 1 and beta = 0 of T Fig. 3.12 come out right."""
    assert published.sizes == {"mu": 2, "r": 126, "beta": 401}
    still = published.sel(r=0.0)
    assert np.all(still.regime == regimes.PERMANENT_STICKING)
    assert np.all(still.contact_amplitude == 0.0)
    linear = published.sel(beta=0.0).isel(r=slice(1, None))
    assert np.all(linear.regime == regimes.CONTINUOUS)
    r = linear.r.values
    with np.errstate(divide="ignore"):
        expected = r**2 / np.abs((1.0 - r) * (1.0 + r))
    np.testing.assert_allclose(linear.contact_amplitude, np.stack([expected, expected]), rtol=1e-15)
    resonant = published.sel(r=1.0, mu=1.0)
    below = resonant.beta.values < math.pi / 4
    assert np.all(np.isinf(resonant.contact_amplitude.values[below]))
    assert np.all(resonant.regime.values[below] == regimes.CONTINUOUS)
    between = ~below & (resonant.beta.values < 1.0)
    assert np.all(resonant.regime.values[between] == regimes.STICK_SLIP)
    assert np.all(resonant.stops_per_cycle.values[between] == 2.0)
    assert np.all(resonant.regime.values[resonant.beta.values >= 1.0] == regimes.PERMANENT_STICKING)


def test_published_map_is_resolved(published):
    """mu = 1: every cell but the marginal column r = 1/2 has status 0; no NaN without a status."""
    smooth = published.sel(mu=1.0)
    marginal = smooth.status == regimes.MARGINAL
    assert set(np.unique(smooth.status)) == {regimes.RESOLVED, regimes.MARGINAL}
    assert np.unique(smooth.r.values[np.nonzero(marginal.values)[0]]).tolist() == [0.5]
    assert not np.any(smooth.regime == regimes.UNRESOLVED)
    assert not np.any(np.isnan(smooth.contact_amplitude))
    rough = published.sel(mu=1.5)
    assert int((rough.status == regimes.NOT_PERIODIC).sum()) <= 8
    assert not np.any(rough.regime == regimes.UNRESOLVED)
    nan = np.isnan(published.contact_amplitude) & (published.status == regimes.RESOLVED)
    assert not bool(nan.any())


def test_published_map_says_what_the_thesis_says(published):
    """T 3.6.2: two stops predominate, more are rare; one stop only for mu > 1, around r = 1/2."""
    smooth, rough = published.sel(mu=1.0), published.sel(mu=1.5)
    stops = smooth.stops_per_cycle.values[smooth.regime.values == regimes.STICK_SLIP]
    assert (stops == 2.0).mean() > 0.99
    assert set(np.unique(stops)) <= {2.0, 4.0}
    one = rough.stops_per_cycle == 1.0
    assert bool(one.any())
    assert float(np.abs(rough.r.values[np.nonzero(one.values)[0]] - 0.5).max()) < 0.16
    # "the direct transition from the continuous to the permanent sticking regime" for mu = 1.5
    column = rough.sel(r=1.0).regime.values
    change = np.flatnonzero(np.diff(column))
    assert column[change].tolist() == [regimes.CONTINUOUS]
    assert column[change + 1].tolist() == [regimes.PERMANENT_STICKING]


def test_skip_exact_and_none_agree(published):
    """T Fig. 3.12, mu = 1, cell by cell, but at r = 1/2 below beta_lim.

    There, undamped at r = 1/(2n), a continuum of asymmetric motions exists, T(3.33); the duration of a stop
    dies like n^-1/2, and marching shows stops that the steady state does not have: status marginal.
    """
    exact = published.sel(mu=[1.0])
    none = fm.sweep(BASE, exact.r.values, exact.beta.values, 1.0, skip="none", outputs=OUTPUTS)
    marginal = (none.status == regimes.MARGINAL).values
    columns = np.unique(none.r.values[np.nonzero(marginal)[1]])
    assert columns.tolist() == [0.5]
    assert np.all(none.beta.values[np.nonzero(marginal)[2]] < none.beta_lim.sel(r=0.5).item())
    slow = (none.status == regimes.NOT_REACHED).values
    # next to the undamped resonance a motion from rest needs more than 2,000 periods for beta = 0.01
    assert slow.sum() <= 4
    assert np.all(np.abs(none.r.values[np.nonzero(slow)[1]] - 1.0) < 0.05)
    decided = ~(marginal | slow)
    for name in ("regime", "stops_per_cycle", "period"):
        np.testing.assert_array_equal(exact[name].values[decided], none[name].values[decided], name)
    np.testing.assert_allclose(
        exact.contact_amplitude.values[decided], none.contact_amplitude.values[decided], rtol=1e-11
    )


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
    for name in ("loads", "orbit", "rest", "moving", "marginal", "alone_re", "alone_im", "held"):
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
    tables = dict(_numbers(structures(system, r, whole), r)) if system.n > 1 else {}
    pieces = [slice(k, k + 1) for k in range(r.size)]
    pieces += [slice(first, first + length) for first, length in ((0, 2), (1, 7), (3, 16), (6, 33))]
    for piece in pieces:
        part = find_curves(system, r[piece].copy(), mu)
        for name, value in vars(whole).items():
            assert getattr(part, name).tobytes() == value[..., piece].tobytes(), (name, r[piece])
        if tables:
            for name, value in _numbers(structures(system, r[piece].copy(), part), r[piece]):
                assert value.tobytes() == tables[name][piece].tobytes(), (name, r[piece])


@pytest.mark.parametrize("kind", ["one mass", "chain", "damped chain", "moving wall", "matrices"])
def test_a_cell_does_not_depend_on_the_others(kind):
    """Alone and in another grid: the same answer, to the bit.

    But for mu = 1, where a neighbour saves the way to the one answer there is, and so may its last digits be.
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
    config = load_config(_configs() / "fig-6-24.toml")
    alone = fm.sweep(config.system, [0.5], [0.2], 1.0)
    for r in (config.r, config.r[50:], config.r[43:57], config.r[::2], config.r[::50]):
        for beta in (config.beta, config.beta[20:21], config.beta[3:22]):
            part = fm.sweep(config.system, r, beta, 1.0).sel(r=[0.5], beta=[0.2])
            for name in alone.data_vars:
                np.testing.assert_array_equal(part[name].values, alone[name].values, name)


@pytest.mark.parametrize("name", OUTPUTS)
def test_only_what_is_asked_for_is_there(name):
    ds = fm.sweep(fm.System(), [0.8, 1.5], [0.2, 0.8], [1.0, 1.5], outputs=[name])
    assert set(ds.data_vars) == {name, "beta_lim", "beta_lim_modal", "beta_stick"}
    assert ds[name].dims == ("mu", "r", "beta")


@pytest.mark.parametrize("name", OUTPUTS)
def test_what_is_not_resolved_says_why_whatever_is_asked_for(name):
    """r = 1/2 undamped is marginal, r = 0 has no number of stops."""
    axes = [0.0, 0.5, 1.5], [0.2, 0.8], [1.0, 1.5]
    asked = fm.sweep(fm.System(), *axes, outputs=[name])
    told = fm.sweep(fm.System(), *axes, outputs=["status"])
    assert told.status.any()
    np.testing.assert_array_equal(asked.status, told.status, strict=True)


def test_closed_form_cells_are_not_integrated(published):
    """skip = "exact", mu = 1: outside the strip nothing is integrated, and inside everything is."""
    smooth = published.sel(mu=1.0)
    strip = (smooth.beta >= smooth.beta_lim) & (smooth.beta < smooth.beta_stick) & (smooth.beta > 0.0)
    np.testing.assert_array_equal((smooth.origin != 0).values, strip.transpose("r", "beta").values)


def test_moving_start_with_mu_1_gives_the_same_regimes():
    """theory.md 6: for mu = 1 the regime does not depend on the start."""
    r = np.linspace(0.11, 2.5, 40)
    beta = np.linspace(0.01, 1.1, 40)
    for skip in ("exact", "none"):
        rest = fm.sweep(fm.System(damping_ratios=0.02), r, beta, 1.0, skip=skip, outputs=OUTPUTS)
        moving = fm.sweep(
            fm.System(damping_ratios=0.02), r, beta, 1.0, skip=skip, start="moving", outputs=OUTPUTS
        )
        both = (rest.status == 0) & (moving.status == 0)
        assert float(both.mean()) > 0.999
        np.testing.assert_array_equal(rest.regime.where(both), moving.regime.where(both))
        np.testing.assert_allclose(
            rest.contact_amplitude.where(both & (rest.regime > 0)),
            moving.contact_amplitude.where(both & (rest.regime > 0)),
            rtol=1e-9,
        )


def test_joined_base_wall_is_the_fixed_wall_scaled():
    """Undamped: the cell (r, beta) with a joined base-wall is the cell (r, beta/r^2) with a fixed wall."""
    for r in (0.3, 0.7, 1.0, 1.6):
        beta = np.linspace(0.05, 1.1, 30)
        wall = fm.sweep(fm.System(), [r], beta, [1.0, 1.5], outputs=OUTPUTS)
        base = fm.sweep(BASE, [r], beta * r**2, [1.0, 1.5], outputs=OUTPUTS)
        np.testing.assert_array_equal(wall.regime.values, base.regime.values)
        np.testing.assert_array_equal(wall.stops_per_cycle.values, base.stops_per_cycle.values)
        np.testing.assert_allclose(
            wall.contact_amplitude.values * r**2, base.contact_amplitude.values, rtol=1e-9
        )


def test_ties_with_beta_stick_stick():
    """beta = r^2/mu, exactly representable, sticks; the double below it does not."""
    for r, mu in ((0.5, 1.0), (1.5, 1.0), (0.75, 1.5), (2.0, 2.0), (1.25, 1.25)):
        tie = float(Fraction(r) ** 2 / Fraction(mu))
        for skip in ("exact", "none"):
            ds = fm.sweep(BASE, [r], [np.nextafter(tie, 0.0), tie], mu, skip=skip, outputs=OUTPUTS)
            below, at = ds.regime.values[0, 0]
            assert at == regimes.PERMANENT_STICKING, (r, mu, skip)
            if mu == 1.0:
                assert below == regimes.STICK_SLIP, (r, mu, skip)


def test_fixed_wall_at_rest_frequency():
    """r = 0: linear at beta = 0, stuck from beta_stick on, and in between stick-slip without a count."""
    ds = fm.sweep(fm.System(), [0.0], [0.0, 0.5, 1.0], 1.0, outputs=OUTPUTS)
    assert ds.regime.values.ravel().tolist() == [
        regimes.CONTINUOUS, regimes.STICK_SLIP, regimes.PERMANENT_STICKING
    ]  # fmt: skip
    assert ds.status.values.ravel().tolist() == [0, regimes.QUASI_STATIC, 0]
    assert ds.contact_amplitude.values[0, 0, 0] == 1.0
    assert np.isnan(ds.stops_per_cycle.values[0, 0, 1])


def test_extreme_ratios_end_with_an_answer():
    """Tiny and huge frequency ratios, friction near its bounds, heavy damping: a regime or a status."""
    for zeta in (0.0, 1e-6, 1.0, 20.0):
        ds = fm.sweep(
            fm.System(damping_ratios=zeta),
            [1e-3, 1e-2, 30.0, 1e4, 1e8],
            [1e-12, 1e-3, 0.3, 1.0 - 1e-12, 1.0, 50.0],
            [1.0, 1.0 + 1e-12, 3.0],
            cycles=20,
            outputs=OUTPUTS,
        )
        assert not np.any(ds.status == regimes.NOT_COMPUTED)
        resolved = ds.status == regimes.RESOLVED
        assert np.all((ds.regime != regimes.UNRESOLVED).where(resolved, True))
        assert np.all(np.isfinite(ds.contact_amplitude).where(resolved, True))


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
            r"got output \(did you mean outputs",
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


def test_numbers_in_any_dress():
    """Scalars of a dataset and arrays without dimensions are numbers; axes may be any arrays; no -0.0."""
    system = fm.System()
    ds = fm.sweep(system, xr.DataArray([0.4, 0.9]), np.array([0.2, 0.5], dtype=">f4"), range(1, 3))
    one = fm.response(system, ds.r[1], np.array(0.5), mu=ds.mu[0])
    assert one.identical(fm.response(system, 0.9, 0.5, 1.0))
    minus = fm.sweep(system, np.array([-0.0, 0.5]), [-0.0, 0.5])
    assert minus.identical(fm.sweep(system, [0.0, 0.5], [0.0, 0.5]))
    assert not np.signbit(minus.r.values).any()


def test_settings_beside_a_solver_take_the_place_of_its_own():
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


def test_kernels_are_cached_between_processes(tmp_path):
    """A second process loads what the first one compiled, and compiles nothing."""
    code = (
        "import frictionmap as fm, numba\n"
        "fm.sweep(fm.System(), [0.3], [0.5], 1.0)\n"
        "from frictionmap._kernels.engine.fill import fill_open as f, fill_closed as g\n"
        "print(sum(len(k.stats.cache_hits) for k in (f, g)), sum(len(k.stats.cache_misses) for k in (f, g)))"
    )
    import os

    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    first, second = (
        subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    )
    assert first == ["0", "2"]
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

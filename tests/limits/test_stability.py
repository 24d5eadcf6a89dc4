"""Floquet multipliers, symmetry, and what else a cell could end in."""

import math

import numpy as np
import pytest
import xarray as xr
from kernels import callable_kernel
from structures import random_chain

import frictionmap as fm
from frictionmap._kernels import spectral_radius as radii
from frictionmap._kernels.event_codes import REVERSE, EventSequence
from frictionmap._kernels.structure import events as follow
from frictionmap._kernels.structure import newton as returns
from frictionmap._kernels.structure.events import UNDER_WAY
from frictionmap._kernels.structure.newton import make_workspace
from frictionmap._kernels.structure.oscillators import make_scratch, make_state
from frictionmap._kernels.structure.state import make_structure
from frictionmap.single.cells import Cells

after_slide = callable_kernel(follow.after_slide)
slide_on = callable_kernel(follow.slide_on)
return_map = callable_kernel(returns.return_map)
spectral_radius = callable_kernel(radii.spectral_radius)

OUTPUTS = ("regime", "status", "multiplier", "asymmetry", "stops_per_cycle", "period")
BASE = fm.System(contact="joined-base-wall")


@pytest.mark.plain
@pytest.mark.parametrize("r", [0.75, 0.9, 2.0, 3.0])
def test_closed_form_of_one_mass(r):
    """Two turns per period: det of the half-period map is the ratio of the accelerations at a turn.

    With a complex pair the modulus is its root: rho = (Z - beta/r^2)/(Z + beta/r^2) over a period.
    """
    ds = fm.sweep(fm.System(), [r], [0.3], outputs=("contact_amplitude", "multiplier"))
    z = ds.contact_amplitude.item()
    # at a maximum of z, before and after the turn: r^2 z'' = c - z -+ beta, c the load there
    u = math.tan(math.pi / (2.0 * r)) / (1.0 / r) / r**2
    cosine = math.sqrt(1.0 - (0.3 * u * (1.0 - r**2)) ** 2) * np.sign(1.0 - r**2)
    ratio = (z - cosine - 0.3) / (z - cosine + 0.3)
    assert ds.multiplier.item() == pytest.approx(abs(ratio), rel=1e-9)


def set_moving(system, r, beta, mu):
    """(n, structure, its moving start with cos and sin of the load's phase, workspace, scratch)."""
    cells = Cells(system, np.array([r]), np.array([beta]), np.array([mu]), fm.Solver())
    found = cells.structure_arrays
    n = found.participating.size
    st = make_structure(found.model, found.loads, 0, r, 24.0)
    moving = found.moving
    state = make_state(n)
    state[:, :n] = moving.coordinates[0], moving.velocity[0] / st.rate
    return n, st, state, moving.cos[0], moving.sin[0], make_workspace(n), make_scratch(n)


@pytest.mark.plain
def test_determinant_is_the_product_of_acceleration_ratios():
    """Volume in the space of states shrinks at turns, by (load - beta)/(load + beta), and by damping only.

    The load there is that of the response.  A stop forgets the contact's velocity: the determinant is 0.
    """
    rng = np.random.default_rng(5)
    turned = stopped = 0
    while turned < 20 or stopped < 10:
        zeta = float(rng.choice([0.0, 0.02, 0.4]))
        system, _ = random_chain(rng, zeta)
        r, mu = float(rng.uniform(0.3, 2.0)), float(rng.choice([1.0, 1.5]))
        beta = float(rng.uniform(0.02, 0.7)) * fm.boundaries(system, [r]).beta_stick.item()
        n, st, state, c, s, work, scratch = set_moving(system, r, beta, mu)
        ratio, events = 1.0, next_events(st, beta, mu * beta, state, c, s, 4, work, scratch)
        moved, force, at, time = state.copy(), UNDER_WAY, (c, s), 0.0
        for k in range(4):
            steps, _, *at, _ = slide_on(st, beta, force, moved, *at, 1e6, scratch)
            code, *at, force, wait, load, _ = after_slide(
                st, beta, mu * beta, moved, work.held, *at, 1e3, scratch
            )
            if code > 2 or abs(time + steps * st.h + wait) > 2.9 * np.pi:
                break
            time += steps * st.h + wait
            ratio *= (load - beta) / (load + beta) if code == REVERSE else 0.0
            halves = np.int64(k % 2 + 1) if (time < np.pi * (k % 2 + 1)) else np.int64(k % 2 + 3)
            if return_map(
                st, beta, mu * beta, state.copy(), c, s, first_of(events, k + 1), halves, True, work, scratch
            ):
                decay = np.exp(-2.0 * np.sum(system.modes.zeta * system.modes.w) * np.pi * halves / r)
                flow = work.flow[: 2 * n, : 2 * n]
                assert np.linalg.det(flow) == pytest.approx(ratio * decay, rel=1e-8, abs=1e-11)
                turned += ratio > 0.0
                stopped += ratio == 0.0


def test_derivative_of_the_return_map():
    """Against differences of second order, on orbits with stops, turns, and over-damped held structures."""
    rng = np.random.default_rng(4)
    checked = 0
    for _ in range(40):
        system, _ = random_chain(rng, float(rng.choice([0.01, 0.2, 1.0, 1.6])))
        r, mu = float(rng.uniform(0.4, 1.8)), float(rng.choice([1.0, 1.3, 2.0]))
        beta = float(rng.uniform(0.1, 0.6)) * fm.boundaries(system, [r]).beta_stick.item()
        n, st, state, c, s, work, scratch = set_moving(system, r, beta, mu)
        # some slides on, to the middle of one
        force, seen = UNDER_WAY, []
        for _ in range(6):
            _, _, c, s, _ = slide_on(st, beta, force, state, c, s, 1e6, scratch)
            code, c, s, force, *_ = after_slide(st, beta, mu * beta, state, work.held, c, s, 1e3, scratch)
            seen.append(code)
        if seen[-1] > 2:
            continue
        ahead = state.copy()
        steps, *_ = slide_on(st, beta, force, ahead, c, s, 1e6, scratch)
        _, _, c, s, _ = slide_on(st, beta, force, state, c, s, 0.5 * steps, scratch)
        # what follows, for as many half periods as there are slides
        for count in (1, 2, 3):
            events = next_events(st, beta, mu * beta, state, c, s, count, work, scratch)
            for halves in (1, 2, 3):
                sequence = first_of(events, count)
                good = return_map(
                    st, beta, mu * beta, state.copy(), c, s, sequence, halves, True, work, scratch
                )
                if good:
                    break
            if good:
                break
        if not good:
            continue
        flow = work.flow.copy()
        for j in range(2 * n):
            ends = []
            step = 1e-6 * np.abs(state).max()
            for sign in (1.0, -1.0):
                moved = state.copy()
                moved[j // n, j % n] += sign * step / (st.rate if j >= n else 1.0)
                if not return_map(st, beta, mu * beta, moved, c, s, sequence, halves, False, work, scratch):
                    break
                ends.append(np.concatenate((moved[0, :n], moved[1, :n] * st.rate)))
            if len(ends) == 2:
                column = (ends[0] - ends[1]) / (2.0 * step)
                np.testing.assert_allclose(flow[:, j], column, atol=2e-4 * np.abs(flow).max())
                checked += 1
    assert checked > 40


def first_of(events, count):
    return EventSequence(events, np.int64(0), np.int64(count))


def next_events(st, beta, mu_beta, state, c, s, count, work, scratch):
    """The next events."""
    state = state.copy()
    events, force = np.empty(count), UNDER_WAY
    for k in range(count):
        _, _, c, s, _ = slide_on(st, beta, force, state, c, s, 1e6, scratch)
        events[k], c, s, force, *_ = after_slide(st, beta, mu_beta, state, work.held, c, s, 1e3, scratch)
    return events


def _of_eigenvalues(rng, values, orthogonal):
    """A real matrix with these eigenvalues, complex ones with their conjugates; condition of the basis."""
    blocks = [
        np.array([[v.real, v.imag], [-v.imag, v.real]]) if np.iscomplex(v) else np.array([[v.real]])
        for v in np.atleast_1d(values).astype(complex)
    ]
    n = sum(block.shape[0] for block in blocks)
    matrix, at = np.zeros((n, n)), 0
    for block in blocks:
        matrix[at : at + block.shape[0], at : at + block.shape[0]] = block
        at += block.shape[0]
    basis = np.linalg.qr(rng.normal(size=(n, n)))[0] if orthogonal else rng.normal(size=(n, n))
    return basis @ matrix @ np.linalg.inv(basis), np.linalg.cond(basis)


def test_spectral_radius():
    rng = np.random.default_rng(0)
    for n in (1, 2, 5, 12):
        for _ in range(20):
            matrix = rng.normal(size=(n, n))
            exact = np.abs(np.linalg.eigvals(matrix)).max()
            found = spectral_radius(matrix.copy(), n, np.empty((n, n)), 0.0)
            assert found == pytest.approx(exact, rel=1e-11)
            matrix *= rng.uniform(0.5, 0.999) / exact
            exact = np.abs(np.linalg.eigvals(matrix)).max()
            quick = spectral_radius(matrix.copy(), n, np.empty((n, n)), 0.01)
            assert abs(quick - exact) <= 0.05 * (1.0 - exact)
    assert spectral_radius(np.zeros((3, 3)), 3, np.empty((3, 3)), 0.0) == 0.0
    assert spectral_radius(np.array([[0.0, 1.0], [0.0, 0.0]]), 2, np.empty((2, 2)), 0.0) == 0.0


@pytest.mark.parametrize(
    "values",
    [
        [0.9, 0.1, 0.0, 0.0], [0.9, -0.9, 0.5, -0.5], [0.9, 0.9, 0.2], [0.9, 0.9, 0.9, 0.9],
        [0.9, 0.8999, 0.8998, 0.1], [0.6 + 0.6j, 0.2j, 0.3], [0.6 + 0.6j, 0.6 - 0.59j, 0.84],
        [1j, 0.6 + 0.8j, -0.8 + 0.6j], [0.9j, -0.9, 0.9], [1e-9, 1e-12, 1e-12j], [1e5, 1e5 + 1j, -1e-5],
        [0.0, 0.0, 0.7], [0.5 + 1e-9j, 0.5, 0.1],
    ],
)  # fmt: skip
@pytest.mark.parametrize("orthogonal", [True, False])
def test_spectral_radius_of_known_eigenvalues(values, orthogonal):
    """Simple, double, complex ones, some of them close or of the same modulus."""
    rng = np.random.default_rng(5)
    exact = np.abs(values).max()
    for _ in range(10):
        matrix, condition = _of_eigenvalues(rng, values, orthogonal)
        n = matrix.shape[0]
        found = spectral_radius(matrix, n, np.empty((n, n)), 0.0)
        assert found == pytest.approx(exact, rel=1e-11 * condition)


@pytest.mark.parametrize("others", [[], [0.5], [0.9, 0.1]])
def test_spectral_radius_of_a_defective_matrix(others):
    """A Jordan block: rounding errors of every squaring split the double eigenvalue."""
    basis = np.linalg.qr(np.random.default_rng(6).normal(size=(2 + len(others),) * 2))[0]
    matrix = np.diag([0.9, 0.9, *others])
    matrix[0, 1] = 1.0
    matrix = basis @ matrix @ basis.T
    n = matrix.shape[0]
    # 2e-7 to 1.1e-6 over random bases, as from the norm of the last power alone
    assert spectral_radius(matrix, n, np.empty((n, n)), 0.0) == pytest.approx(0.9, rel=5e-6)


def test_steady_states_are_stable_and_antiperiodic_where_unique():
    """mu = 1: no multiplier above 1, no asymmetry; damped structures of up to four masses."""
    rng = np.random.default_rng(8)
    for _ in range(30):
        system, _ = random_chain(rng, 0.05)
        r = float(rng.uniform(0.3, 2.0))
        beta = np.array([0.1, 0.4, 0.7, 0.95]) * fm.boundaries(system, [r]).beta_stick.item()
        ds = fm.sweep(system, [r], beta, outputs=OUTPUTS)
        sliding = ((ds.regime > 0) & (ds.status == 0)).values
        assert np.all(ds.multiplier.values[sliding] < 1.0)
        assert np.all(ds.asymmetry.values[sliding] == 0.0)


def test_asymmetric_motion():
    """One stop per cycle cannot be antiperiodic: joined base-wall, r = 0.52, beta = 0.06, mu = 1.5."""
    ds = fm.sweep(BASE, [0.52], [0.06], 1.5, outputs=OUTPUTS)
    assert ds.stops_per_cycle.item() == 1.0
    history = fm.response(BASE, 0.52, 0.06, 1.5, points=4000)
    z = history.z.values[:-1]
    exact = np.abs(z + np.roll(z, 2000)).max() / float(history.contact_amplitude)
    assert ds.asymmetry.item() == pytest.approx(exact, rel=1e-3)
    assert ds.multiplier.item() < 1.0


@pytest.mark.parametrize(
    ("r", "beta", "mu", "period", "mirrored"),
    [
        (0.3, 0.5, 1.5, 1, True),
        (0.662, 0.3, 2.5, 1, False),
        (0.462, 0.1941, 2.5, 2, False),
        (0.262, 0.1563, 2.5, 3, True),
        (0.45, 0.179, 2.5, 3, False),
        (0.475, 0.2017, 2.0, 4, False),
    ],
)
def test_asymmetry_is_that_of_the_response(r, beta, mu, period, mirrored):
    """Least over odd m of max |z(tau + m pi) + z(tau)|, over the amplitude, by 4,000 samples per period.

    A motion of period 3 that is its own mirror image is so after three half periods, not after one.
    """
    system = fm.System(damping_ratios=0.03)
    ds = fm.sweep(system, [r], [beta], mu, outputs=OUTPUTS)
    history = fm.response(system, r, beta, mu, points=4000)
    assert ds.period.item() == history.period.item() == period
    z = history.z.values[:-1]
    differences = [np.abs(z + np.roll(z, 2000 * m)).max() for m in range(1, 2 * period, 2)]
    exact = min(differences) / float(history.contact_amplitude)
    assert (exact < 1e-9) == mirrored
    assert ds.asymmetry.item() == pytest.approx(exact, rel=1e-3, abs=1e-9)
    if period == 3:  # what m = 1 alone says is another number
        assert differences[0] / float(history.contact_amplitude) > max(0.05, exact)


@pytest.mark.parametrize(
    ("system", "r", "beta", "flags"),
    [
        (fm.System(), 0.9, 0.7, 1 | 4),
        (fm.System(), 0.303, 0.76, 1 | 2),
        (BASE, 0.52, 0.06, 2 | 4),
    ],
)
def test_coexistence(system, r, beta, flags):
    """Cells with two answers, found by exact integration; theory.md 6."""
    ds = fm.sweep(system, [r], [beta], 1.5, outputs=("also_reachable", "sliding_limit"))
    assert ds.also_reachable.item() == flags
    assert ds.sliding_limit.item() >= beta * (1.0 - 1e-12) or flags == 2 | 4


TWO = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02)
COEXISTENCE = ("also_reachable", "sliding_limit")


@pytest.mark.parametrize(
    ("system", "r", "mu"),
    [
        (fm.System(), [0.31, 1.0218979168366544], [1.0, 1.3601607109057832]),
        (BASE, [0.0, 0.52, 0.9], [1.5]),
        (TWO, [0.45, 1.3], [1.0, 1.4]),
    ],
)
def test_what_is_reachable_does_not_depend_on_the_grid(system, r, mu):
    """Alone, in rows of two and in the whole, beta_lim and beta_stick themselves among the cells."""
    edges = fm.boundaries(system, r, mu)
    beta = np.unique(np.concatenate((edges.beta_lim.values.ravel(), edges.beta_stick.values.ravel(),
                                     [0.0, 0.05, 0.4, 0.7, 0.8, 1.5])))  # fmt: skip
    whole = fm.sweep(system, r, beta, mu, outputs=COEXISTENCE)
    for j in range(beta.size):
        for columns in ([j], sorted({j, (3 * j) % beta.size}), range(max(0, j - 1), j + 1)):
            for i in range(len(r)):
                part = fm.sweep(system, [r[i]], beta[list(columns)], mu, outputs=COEXISTENCE)
                same = whole.isel(r=[i], beta=list(columns))
                for name in COEXISTENCE:
                    np.testing.assert_array_equal(part[name].values, same[name].values, name)


@pytest.mark.parametrize("system", [fm.System(), BASE, fm.System(damping_ratios=0.3), TWO])
def test_what_is_proved_is_listed(system):
    """theory.md 6: continuous below beta_lim, can stick from beta_stick, stuck beyond mu beta_stick."""
    rng = np.random.default_rng(9)
    r, mu = np.sort(rng.uniform(0.2, 2.0, 4)), [1.0, 1.7]
    edges = fm.boundaries(system, r, mu)
    beta = np.unique(np.concatenate((rng.uniform(0.0, 1.2, 9), [0.0], edges.beta_stick.values.ravel())))
    ds = fm.sweep(system, r, beta, mu, outputs=(*COEXISTENCE, "regime", "status"))
    found, lim, stick = xr.broadcast(ds.also_reachable, ds.beta_lim, ds.beta_stick)[:3]
    b = ds.beta.broadcast_like(found)
    np.testing.assert_array_equal((found & 4).where(b < lim, 4), 4)
    np.testing.assert_array_equal((found & 1).where((b >= stick) & (b > 0.0), 1), 1)
    np.testing.assert_array_equal((found & 1).where(b < stick, 0), 0)
    np.testing.assert_array_equal(found.where(b > 1.001 * ds.mu * stick, 1), 1)
    own = 2 ** ds.regime.clip(0).astype(int)
    assert bool(((found & own) > 0).where(ds.status == 0, True).all())
    assert bool((ds.sliding_limit >= np.maximum(ds.beta_stick, ds.beta_lim)).all())
    assert bool((ds.sliding_limit <= ds.mu * ds.beta_stick * (1.0 + 1e-12)).all())


def test_what_is_reachable_where_nothing_moves():
    """r = 0: a wall that moves with the base loads nothing; a fixed one is quasi-static between its edges."""
    assert fm.sweep(BASE, [0.0], [0.0, 0.5], 1.5, outputs=COEXISTENCE).also_reachable.values.tolist() == [
        [[1, 1]]
    ]
    ds = fm.sweep(fm.System(), [0.0], [0.0, 0.3, 0.9], 1.5, outputs=COEXISTENCE)
    assert ds.also_reachable.values.tolist() == [[[4, 2, 1]]]
    assert ds.sliding_limit.item() == ds.beta_stick.item()


def test_one_answer_where_it_is_unique():
    """mu = 1: one regime in every cell, that of the map; and sliding ends at beta_stick."""
    rng = np.random.default_rng(3)
    r, beta = np.sort(rng.uniform(0.1, 2.5, 40)), np.sort(rng.uniform(0.0, 1.3, 50))
    ds = fm.sweep(fm.System(), r, beta, outputs=("regime", "also_reachable", "sliding_limit"))
    np.testing.assert_array_equal(ds.also_reachable.values, 1 << ds.regime.values)
    np.testing.assert_array_equal(ds.sliding_limit.values, ds.beta_stick.values)


def test_reachable_holds_what_is_reached():
    """mu > 1, two masses: the regimes from rest and from a moving start are among those reachable."""
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02)
    grid = {"r": np.linspace(0.3, 2.0, 12), "beta": np.linspace(0.05, 1.0, 20), "mu": [1.4]}
    ds = fm.sweep(system, **grid, outputs=("regime", "also_reachable", "sliding_limit"))
    moving = fm.sweep(system, **grid, start="moving")
    for regime in (ds.regime.values, moving.regime.values):
        known = regime >= 0
        assert np.all(ds.also_reachable.values[known] & (1 << regime[known]))
    assert np.any((ds.also_reachable.values & 1 > 0) & (ds.also_reachable.values & 6 > 0))
    slides = (ds.also_reachable.values & 6 > 0).any(axis=2)
    highest = np.where(ds.also_reachable.values & 6 > 0, ds.beta.values, 0.0).max(axis=2)
    assert np.all(ds.sliding_limit.values[slides] >= highest[slides] * (1.0 - 1e-12))

"""Eight scan steps at once against the scan that takes one after the other."""

import cmath
import math

import mpmath
import numpy as np
import pytest
import scalar_scan
from kernels import callable_kernel
from structures import random_chain

import frictionmap as fm
from frictionmap._kernels.structure import block, oscillators
from frictionmap._kernels.structure.oscillators import AT_LIMIT, STARTS_INSIDE, make_scratch, make_state
from frictionmap._kernels.structure.state import make_structure
from frictionmap.single.cells import Cells

pytestmark = pytest.mark.plain

scan = callable_kernel(block.scan)
one_by_one = callable_kernel(scalar_scan.scan)
value = callable_kernel(oscillators.value)
extremes = callable_kernel(block.extremes)
step_on = callable_kernel(oscillators.step_on)
phase_at = callable_kernel(oscillators.phase_at)


def structure_at(system, r):
    cells = Cells(system, np.array([r]), np.array([0.1]), np.ones(1), fm.Solver())
    found = cells.structure_arrays
    return make_structure(found.model, found.loads, 0, r, 24.0)


def both(table, eight, n, friction, low, high, rise, state, tau, limit):
    """What both scans return, and the states they end in."""
    phase = math.cos(tau), math.sin(tau)
    results = []
    for follow, tables in ((scan, (table, eight)), (one_by_one, (table,))):
        moved = make_state(n)
        moved[:, :n] = state
        results.append((
            follow(*tables, friction, low, high, rise, moved, *phase, limit, make_scratch(n)),
            moved[:, :n],
        ))  # fmt: skip
    return results


def assert_alike(results, scale):
    (one, state), (other, expected) = results
    assert one[1] == other[1]
    np.testing.assert_allclose(one[0], other[0], rtol=1e-11, atol=1e-9)
    np.testing.assert_allclose(one[2:], other[2:], rtol=1e-7, atol=1e-9 * max(scale, 1.0))
    np.testing.assert_allclose(state, expected, atol=1e-9 * scale)


@pytest.mark.parametrize("zeta", [0.0, 0.02, 0.4, 1.3])
def test_free_and_held_oscillators(zeta):
    """Ranges left at once, after few steps and never; limits inside a step, at a node and beyond."""
    rng = np.random.default_rng(int(100 * zeta))
    ends = set()
    for _ in range(12):
        system, _ = random_chain(rng, zeta)
        st = structure_at(system, float(rng.uniform(0.2, 3.0)))
        for table, eight, n in ((st.free, st.free_block, st.n), (st.held, st.held_block, st.m)):
            for _ in range(6):
                state = rng.normal(size=(2, n)) * np.array([[1.0], [st.h]])
                tau = float(rng.uniform(0.0, 6.0))
                beta = float(rng.uniform(0.0, 1.0))
                start = make_state(n)
                start[:, :n] = state
                y = value(table, start, math.cos(tau), math.sin(tau))
                size = float(rng.choice([1e-6, 0.1, 1.0, 100.0])) * max(abs(y), st.h)
                low, high = y - size * rng.uniform(), y + size * rng.uniform()
                if rng.uniform() < 0.3:
                    high = math.inf
                limit = float(rng.choice([0.0, 0.3, 1.0, 7.0, 7.5, 8.0, 8.2, 16.0, 60.0, 300.7]))
                results = both(table, eight, n, beta, low, high, STARTS_INSIDE, state, tau, limit)
                assert_alike(results, np.abs(results[1][1]).max(initial=1e-3) + abs(y))
                ends.add(results[0][0][1])
                if results[0][0][1] == AT_LIMIT:
                    assert results[0][0][0] == limit
    assert len(ends) == 3


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_slides_from_rest(zeta):
    """The contact is at rest and the load exceeds the friction by much, by little and by next to nothing."""
    rng = np.random.default_rng(3)
    for excess in (1.0, 1e-2, 1e-5, 1e-9, 0.0):
        system, _ = random_chain(rng, zeta)
        r = float(rng.uniform(0.3, 1.5))
        st = structure_at(system, r)
        state, tau = np.zeros((2, st.n)), float(rng.uniform(-1.5, -0.1))
        force = st.free_cos * math.cos(tau) + st.free_sin * math.sin(tau)
        rise = excess * st.inverse_mass / st.rate**2
        results = both(st.free, st.free_block, st.n, force - excess, 0.0, math.inf, rise, state, tau, 4000.0)
        assert_alike(results, np.abs(results[1][1]).max())


def test_every_lane_can_hold_the_event():
    """One oscillator that falls through the end of its range in each of the first seventeen steps."""
    st = structure_at(fm.System(contact_masses=[1], mass_ratios=[1, 1], stiffness_ratios=[1, 1]), 0.7)
    seen = set()
    for k in range(17):
        tau = 0.4
        state = np.zeros((2, st.m))
        state[1] = -0.3 * st.h
        level = both(
            st.held, st.held_block, st.m, 0.0, -math.inf, math.inf, STARTS_INSIDE, state, tau, k + 0.5
        )[1][1]
        there = make_state(st.m)
        there[:, : st.m] = level
        angle = tau + (k + 0.5) * st.h
        y = value(st.held, there, math.cos(angle), math.sin(angle))
        results = both(st.held, st.held_block, st.m, 0.0, y, math.inf, STARTS_INSIDE, state, tau, 400.0)
        assert_alike(results, 1.0)
        seen.add(int(results[0][0][0]))
    assert len(seen) > 8


def test_extremes_are_those_of_the_nodes_one_by_one():
    """Minima and maxima among the nodes inside; the first and the last node have only one neighbour."""
    rng = np.random.default_rng(11)
    found = []
    for _ in range(20):
        system, _ = random_chain(rng, float(rng.choice([0.0, 0.02, 0.4])))
        st = structure_at(system, float(rng.uniform(0.2, 3.0)))
        for table, eight, n in ((st.free, st.free_block, st.n), (st.held, st.held_block, st.m)):
            for steps in (0.5, 1.0, 2.2, 7.9, 8.0, 9.3, 40.0):
                state, before = make_state(n), make_state(n)
                state[:, :n] = rng.normal(size=(2, n)) * np.array([[1.0], [st.h]])
                tau, beta = float(rng.uniform(0.0, 6.0)), float(rng.uniform(0.0, 1.0))
                moved, y = state.copy(), [value(table, state, math.cos(tau), math.sin(tau))]
                for k in range(int(steps)):
                    phase = tau + k * st.h
                    step_on(table, n, beta, moved, before, math.cos(phase), math.sin(phase))
                    phase += st.h
                    y.append(value(table, moved, math.cos(phase), math.sin(phase)))
                inside = np.array(y[1:-1])
                low = inside[(inside <= y[:-2]) & (inside <= y[2:])].min(initial=math.inf)
                high = inside[(inside >= y[:-2]) & (inside >= y[2:])].max(initial=-math.inf)
                got = extremes(table, eight, beta, state, math.cos(tau), math.sin(tau), steps)
                np.testing.assert_allclose(got, (low, high), rtol=1e-9, atol=1e-9 * np.abs(y).max())
                found.append(math.isfinite(low) or math.isfinite(high))
    assert 0.3 < np.mean(found) < 0.9


@pytest.mark.parametrize("done", [0.0, 63.0, 64.0, 1e6])
@pytest.mark.parametrize("h", [0.01, 0.3, 0.499, 1.5])
def test_load_phase_inside_a_step(done, h):
    """Against 30 digits, after few and many steps, by the series and by the library's functions."""
    rng = np.random.default_rng(5)
    for tau, x in rng.uniform([0.0, -0.1], [6.0, 1.1], (100, 2)):
        start, now = (cmath.exp(1j * angle) for angle in (tau, tau + done * h))
        with mpmath.workdps(30):
            exact = complex(mpmath.expj(mpmath.mpf(tau) + (done + mpmath.mpf(x)) * mpmath.mpf(h)))
        found = phase_at((start.real, start.imag), (now.real, now.imag), done, x, h)
        assert abs(complex(*found) - exact) < 5e-16 + 2e-16 * done * h

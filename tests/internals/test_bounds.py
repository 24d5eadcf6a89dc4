"""The bounds that make events and shortcuts certain."""

import math

import mpmath as mp
import numpy as np
import pytest
from kernels import callable_kernel
from structures import random_chain

import frictionmap as fm
from frictionmap._kernels import closed_form, continuous_motion, taylor_series
from frictionmap._kernels.continuous_motion import orbit_phase
from frictionmap._kernels.one_mass import events, sliding_orbit
from frictionmap._kernels.one_mass.scan_step import step_constants
from frictionmap._kernels.one_mass.sliding_orbit import Oscillator
from frictionmap._kernels.structure import sliding_orbit as structure_orbit
from frictionmap._kernels.structure.oscillators import make_state
from frictionmap._kernels.structure.sliding_orbit import make_wave
from frictionmap._kernels.structure.state import LOAD, SPEED, W, make_structure
from frictionmap._kernels.taylor_series import MAX_TERMS
from frictionmap.single.cells import Cells
from frictionmap.theory.boundary_curves import one_mass_curves

decay = callable_kernel(closed_form.decay)
continuous_amplitude = callable_kernel(continuous_motion.continuous_amplitude)
stop_free_radius = callable_kernel(sliding_orbit.stop_free_radius)
structure_radius = callable_kernel(structure_orbit.stop_free_radius)
orbit_state = callable_kernel(structure_orbit.orbit_state)
first_root = callable_kernel(taylor_series.first_root)
slide = callable_kernel(events.slide)


@pytest.mark.parametrize("value", [0.0, 1e-40, 1e-22, 1e-17, 1e-9, 1e-3])
def test_first_root_after_a_rising_start(value):
    """A tiny value that rises first: value + x/1000 - 2 x^2/1000 has its root next to 1/2."""
    p = np.array([0.0, value, 1e-3, -2e-3, 0.0, 0.0])
    exact = (1e-3 + math.sqrt(1e-6 + 8e-3 * value)) / 4e-3
    found = first_root(p, 1, 6)
    assert found == pytest.approx(exact, rel=1e-14) if exact <= 1.0 else found == 2.0


def test_first_root_of_random_polynomials():
    """Never later than the first change of sign of dense samples, and a zero where it says."""
    rng = np.random.default_rng(11)
    x = np.linspace(0.0, 1.0, 20001)
    for _ in range(500):
        p = rng.normal(size=8) / np.cumprod(np.arange(1.0, 9.0))
        p[0] = abs(p[0]) * 10.0 ** rng.uniform(-12, 0)
        values = np.polynomial.polynomial.polyval(x, p)
        below = np.flatnonzero(values <= 0.0)
        root = first_root(p, 0, 8)
        if below.size:
            assert root <= x[below[0]] + 1e-12
        if root <= 1.0:
            size = np.abs(p).sum()
            assert abs(np.polynomial.polynomial.polyval(root, p)) <= 1e-13 * size


def test_nothing_can_stop_within_the_radius():
    """The radius never exceeds the least deviation that makes z' zero and |load| mu b on the orbit, sampled
    densely.
    """
    rng = np.random.default_rng(3)
    positive = 0
    for _ in range(400):
        zeta = float(rng.choice([0.0, rng.uniform(0.0, 2.0), 10.0 ** rng.uniform(-3.0, 1.3)]))
        r, mu = 10.0 ** rng.uniform(-1.0, 1.5), float(rng.choice([1.0, rng.uniform(1.0, 3.0)]))
        found = one_mass_curves(fm.System(damping_ratios=zeta), np.array([r]), np.array([mu]))
        f = found.frequencies
        oscillator = Oscillator(r, zeta, f.v_abs[0], f.v_arg[0], f.u[0], f.g[0], False)
        b = float(found.lim[0, 0]) * min(1.0 - 1e-9, 10.0 ** rng.uniform(-6.0, 0.0))
        amplitude = continuous_amplitude(oscillator.v_abs, oscillator.u, oscillator.g, b)
        phase = orbit_phase(oscillator.v_abs, oscillator.v_arg, oscillator.u, b)
        step = step_constants(r, zeta, 64.0)
        radius = stop_free_radius(step, oscillator, b, mu * b, amplitude, phase)
        tau = np.linspace(0.0, math.pi, 8001)
        q, e = np.array([decay(zeta, t / r) for t in tau]).T
        g1, from_cos, swing = 1.0 + oscillator.g, amplitude + b * oscillator.g, b * oscillator.u
        z = from_cos * np.cos(tau) + swing * np.sin(tau) + b * (1.0 - g1 * (e + 2 * zeta * q)) - swing * r * q
        v = swing * (np.cos(tau) - e) - from_cos * np.sin(tau) + b * g1 * q / r
        least = np.hypot(r * v, np.maximum(np.abs(z - np.cos(tau + phase)) - mu * b, 0.0)).min()
        assert radius <= least * (1.0 + 1e-2) + 1e-9, (zeta, r, mu, b)
        positive += radius > 0.0
    assert positive > 200


def _least_deviation(st, state, c, s, mu_beta):
    """Least energy norm of a deviation of this state that makes z' zero and |load| at most mu beta."""
    n, w = st.n, st.modes[W, : st.n]
    coordinates = np.concatenate((state[0, :n] * w, state[1, :n] * st.rate))  # their norm is the energy norm
    rows = [np.concatenate((st.modes[k, :n] / w, st.modes[k + 1, :n])) for k in (SPEED, LOAD)]
    speed = rows[0] @ coordinates
    load = rows[1] @ coordinates + st.free_cos * c + st.free_sin * s
    least = -rows[0] * speed / (rows[0] @ rows[0])
    after = load + rows[1] @ least
    if abs(after) > mu_beta:  # both, the load just to its limit
        asked = np.array([-speed, math.copysign(mu_beta, after) - load])
        least = np.linalg.lstsq(np.array(rows), asked, rcond=None)[0]
    return np.linalg.norm(least)


def test_nothing_of_a_structure_can_stop_within_the_radius():
    """As for one mass; the radius is close to the least deviation where the scan steps are short."""
    rng = np.random.default_rng(7)
    ratios = []
    for _ in range(80):
        system, _ = random_chain(rng, float(rng.choice([0.0, 0.02, 0.4, 1.3])))
        r, mu = float(rng.uniform(0.2, 2.0)), float(rng.choice([1.0, rng.uniform(1.0, 3.0)]))
        beta = fm.boundaries(system, [r], [mu]).beta_lim.item() * float(rng.uniform(0.2, 0.95))
        if not beta > 0.0:
            continue
        found = Cells(system, np.array([r]), np.array([beta]), np.array([mu]), fm.Solver()).structure_arrays
        st = make_structure(found.model, found.loads, 0, r, 200.0)
        orbit, n = found.orbit, st.n
        phase = orbit_phase(orbit.v_abs[0], orbit.v_arg[0], orbit.u[0], beta)
        state = make_state(n)
        radius = structure_radius(st, orbit, 0, beta, mu * beta, phase, make_wave(st.h, 1.0))
        least = math.inf
        for tau in np.linspace(-math.pi, 0.0, 601) - phase:
            c, s = math.cos(tau), math.sin(tau)
            orbit_state(st, orbit, 0, beta, phase, c, s, state)
            least = min(least, _least_deviation(st, state, c, s, mu * beta))
        assert radius <= least * (1.0 + 1e-2) + 1e-9
        finer = structure_radius(st, orbit, 0, beta, mu * beta, phase, make_wave(st.h, 32.0))
        assert radius * (1.0 - 1e-9) <= finer <= least * (1.0 + 1e-2) + 1e-9
        if radius > 0.0:
            ratios.append(radius / least)
    assert len(ratios) > 30
    assert np.median(ratios) > 0.95


@pytest.mark.parametrize(
    ("beta", "place"),
    [(1.05, 0.01195), (1.2, -0.10899), (1.5, 0.36402)],
)
def test_where_a_moving_mass_sticks_permanently(beta, place):
    """r = 0.25, mu = 1, from a moving start: places found by marching event by event, five digits."""
    ds = fm.response(fm.System(), 0.25, beta, start="moving", skip="none", points=10)
    assert int(ds.regime) == 0
    assert float(ds.z[0]) == pytest.approx(place, abs=5e-6)


@pytest.mark.parametrize(
    ("steps", "r", "b", "z", "v", "c", "s"),
    [
        (4.0, 8.833707792815149, 1.370367278807733e-05, -0.9989228207925247, 3.6418001626437013e-07,
         -0.9965281004332572, 0.08325710208074799),
        (24.0, 0.5558862112528401, 1.179618511125476e-06, 0.766525118439465, 0.005952460067772305,
         0.7166424833834543, -0.6974407150503873),
    ],
)  # fmt: skip
def test_a_slide_ends_only_where_the_velocity_is_zero(steps, r, b, z, v, c, s):
    """Undamped slides whose velocity dips to zero up to rounding: the closed form at the end found."""
    step = step_constants(r, 0.0, steps)
    acceleration = step.stiffness * (c - b - z)
    n, _, _, _ = slide(step, b, z, v * step.h, acceleration, c, s, 1e5, np.empty(MAX_TERMS))
    t = n * step.h
    with mp.workdps(40):
        a, z, v, c, s, t = 1 / mp.mpf(r), mp.mpf(z), mp.mpf(v), mp.mpf(c), mp.mpf(s), mp.mpf(t)
        gain = 1 / (1 - mp.mpf(r) ** 2)
        velocity = (
            -(z - gain * c + b) * a * mp.sin(a * t)
            + (v + gain * s) * mp.cos(a * t)
            - gain * (s * mp.cos(t) + c * mp.sin(t))
        )
    assert abs(float(velocity)) < 1e-9 * float(v) + 1e-14

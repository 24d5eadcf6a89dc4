"""Motions on the boundary of continuous motion, and with the contact held: amplitude and phase over r."""

import math

import mpmath as mp
import numpy as np
import pytest
from continuous_motions import CASES, Precise, as_system, random_system

import frictionmap as fm
from frictionmap.theory.boundary_curves import find_curves
from frictionmap.theory.limit_curves import limit_variables

UNDAMPED = [
    (("wall", 1), 1, [1.0], [1.0], 0.0),
    (("base", 1), 1, [1.0], [1.0], 0.0),
    (("wall", 2), 1, [1.0, 0.7], [1.0, 1.3], 0.0),
    (("base", 1), 1, [1.0, 1.5], [1.0, 0.8], 0.0),
    (("masses", 1, 3), 2, [1.0, 0.7, 1.4], [1.0, 1.3, 0.6], 0.0),
]


def limits(system, r, mu=(1.0,)):
    r, mu = np.array(r), np.array(mu)
    found = limit_variables(system, r, mu, find_curves(system, r, mu))
    return {name.removeprefix("limit_"): variable.values for name, variable in found.items()}


def exact_limit(case, r, mu):
    """In 60 digits, where the boundary is the end of the slide: mu is so large that S counts for nothing."""
    exact = Precise(*case, r, 0)
    weights = exact.weights
    c = exact.c
    pull = [sum(c[k] * weights[k][i] for k in range(exact.n)) for i in range(exact.n)]
    u = sum(pull[i] * exact.u[i] for i in range(exact.n))
    inertia = sum(pull[i] * exact.w[i] ** 2 for i in range(exact.n)) / exact.r**2
    h = (
        sum(
            pull[i] * exact.w[i] ** 2 * (exact.g[i] + 2 * exact.zeta[i] * exact.r / exact.w[i] * exact.u[i])
            for i in range(exact.n)
        )
        / exact.r**2
    )
    return Precise(*case, r, abs(exact.V) / mp.sqrt(u**2 + (h + mu * inertia) ** 2))


def compare(found, motion, tolerance):
    """Values (1, 1, n) against `Precise`: where x turns, and the first harmonic by quadrature."""
    for k in range(motion.n):
        start = float(mp.fmod(mp.mpf(found["phase"][0, 0, k]) - motion.phase + 4 * mp.pi, mp.pi))
        # next to its own end a half goes on as its mirror image
        turn = mp.findroot(lambda t, k=k: velocity(motion, k, t), (start - 1e-7, start + 1e-7), tol=1e-30)
        value = motion.x(k, turn + motion.phase)
        tau = float(turn + motion.phase + (mp.pi if value < 0 else 0))
        assert found["amplitude"][0, 0, k] == pytest.approx(abs(float(value)), rel=tolerance)
        assert math.remainder(found["phase"][0, 0, k] - tau, math.tau) == pytest.approx(0.0, abs=tolerance)
        first = mp.quad(lambda t, k=k: motion.half(k, t) * mp.expj(-t), mp.linspace(0, mp.pi, 5))
        first *= 2 / mp.pi * mp.expj(-motion.phase)
        size = abs(complex(first))
        assert found["first_harmonic_amplitude"][0, 0, k] == pytest.approx(size, rel=tolerance)
        lag = found["first_harmonic_phase"][0, 0, k] + float(mp.arg(first))
        assert math.remainder(lag, math.tau) == pytest.approx(0.0, abs=tolerance)


def velocity(motion, k, t):
    """x_k', as x_k goes on beyond its half."""
    halves = mp.floor(t / mp.pi)
    return (-1) ** int(halves) * mp.diff(lambda s: motion.half(k, s), t - halves * mp.pi)


@pytest.mark.parametrize("case", [*UNDAMPED, *CASES[:4]], ids=lambda case: f"{case[0]}-{case[4]}")
def test_in_60_digits(case):
    """Off resonances, and beside them: undamped, at 10^-3 of one."""
    system = as_system(*case)
    places = [0.83, 1.41, *(system.modes.w[:1] * 1.001 if case[4] == 0.0 else [])]
    for r in places:
        with mp.workdps(60):
            motion = exact_limit(case, r, 5)
            compare(limits(system, [r], [5.0]), motion, 1e-10)


@pytest.mark.parametrize("case", UNDAMPED, ids=lambda case: str(case[0]))
def test_at_an_undamped_resonance_it_is_the_limit(case):
    """Against 60 digits at 10^-20 beside it, on the one side or the other."""
    system = as_system(*case)
    for i, w in enumerate(system.modes.w):
        found = limits(system, [w], [5.0])
        assert np.isinf(fm.boundaries(system, [w]).V[0])
        with mp.workdps(60):
            side = (-1) ** (i + system.n)
            exact_w = Precise(*case, 0.9, 0).w[i]
            compare(found, exact_limit(case, exact_w * (1 + side * mp.mpf(10) ** -20), 5), 1e-11)


def test_as_continuous_motion():
    """At beta_lim, also where S decides; beta_lim's own rounding costs digits beside a resonance only."""
    rng = np.random.default_rng(31)
    for _ in range(60):
        system = random_system(rng, damped=bool(rng.random() < 0.6))
        r, mu = np.sort(rng.uniform(0.2, 3.0, 3)), (1.0, 1.4)
        found = limits(system, r, mu)
        betas = fm.boundaries(system, r, mu).beta_lim.values
        for m, j in np.ndindex(betas.shape):
            if np.min(np.abs(system.modes.w / r[j] - 1.0)) < 0.01:
                continue
            motion = fm.continuous_motion(system, r[j], betas[m, j])
            size = motion.amplitude.max()
            np.testing.assert_allclose(found["amplitude"][m, j], motion.amplitude, rtol=0, atol=1e-10 * size)
            first = found["first_harmonic_amplitude"][m, j] * np.exp(
                -1j * found["first_harmonic_phase"][m, j]
            )
            np.testing.assert_allclose(first, motion.first_harmonic, rtol=0, atol=1e-10 * size)
            turn = np.exp(1j * found["phase"][m, j])
            np.testing.assert_allclose(turn, np.exp(1j * motion.phase), rtol=0, atol=1e-8)


def test_where_nothing_slides_without_stops():
    """r = 0 and r = w/3 to the bit: beta_lim is 0, and the motion at that is the one without friction."""
    pole = fm.System(matrices={"M": [[1.0]], "K": [[9.0]]}, frequency_scale=1.0)
    base = fm.System(contact="joined-base-wall")
    for system, r, expected in ((fm.System(), 0.0, 1.0), (base, 0.0, 1.0), (pole, 1.0, 0.125)):
        found = limits(system, [r])
        assert found["amplitude"].item() == expected
        assert found["first_harmonic_amplitude"].item() == expected
        assert found["phase"].item() == found["first_harmonic_phase"].item() == 0.0


def test_a_resonance_that_the_contact_does_not_see():
    """Two equal branches on the mass in contact: one against the other they grow, and the mass does not."""
    matrices = {"M": np.eye(3), "K": np.array([[4.0, 0.0, -4.0], [0.0, 4.0, -4.0], [-4.0, -4.0, 10.0]])}
    system = fm.System(contact_masses=[3], load_mass=1, matrices=matrices, frequency_scale=1.0)
    w = system.modes.w[system.modes.chi == 0.0]
    found = limits(system, w)
    for kind in ("amplitude", "first_harmonic_amplitude"):
        np.testing.assert_array_equal(np.isinf(found[kind][0, 0]), [True, True, False])
    for kind in ("phase", "first_harmonic_phase"):
        np.testing.assert_array_equal(np.isnan(found[kind][0, 0]), [True, True, False])


def test_peak_of_the_boundary_curve():
    """Fixed wall, r = 1: with u sin(tau) gone and S = 1, X = pi/4 and the lag is a quarter turn."""
    found = limits(fm.System(), [1.0])
    assert found["amplitude"].item() == pytest.approx(0.25 * math.pi, rel=1e-15)
    assert found["phase"].item() == pytest.approx(0.5 * math.pi, rel=1e-15)


# The contact held


def test_held_phase():
    """Of the phasor that solves theory.md 4: by the equations with one multiplier."""
    rng = np.random.default_rng(32)
    for _ in range(40):
        system = random_system(rng)
        modes, n = system.modes, system.n
        r = rng.uniform(0.2, 3.0)
        bordered = np.zeros((n + 1, n + 1), dtype=complex)
        bordered[:n, :n] = modes.stiffness - r**2 * modes.mass + 1j * r * modes.damping
        bordered[:n, n] = bordered[n, :n] = modes.contact
        right = np.append(modes.load + 1j * r * modes.load_rate, modes.base_motion)
        x = np.linalg.solve(bordered, right)[:n]
        ds = fm.boundaries(system, [r])
        found = ds.held_response.values[:, 0] * np.exp(-1j * np.nan_to_num(ds.held_phase.values[:, 0]))
        size = max(np.abs(x).max(), 1e-3)  # one mass, or the load on it: all are at rest
        np.testing.assert_allclose(found, x, rtol=0.0, atol=1e-11 * size)
        at_rest = np.abs(x) < 1e-10 * size
        np.testing.assert_array_equal(np.isnan(ds.held_phase.values[:, 0]), at_rest)


def test_held_masses_without_a_phase():
    """Behind a mass held by a wall nothing moves; a resonance has no phase; a base moves what it holds."""
    chain = fm.System(mass_ratios=[1.0] * 3, stiffness_ratios=[1.0] * 3, contact_masses=[2])
    ds = fm.boundaries(chain, [0.5, 1.0, 2.0])
    np.testing.assert_array_equal(ds.held_response[1:], 0.0)
    np.testing.assert_array_equal(np.isnan(ds.held_phase[1:]), True)
    np.testing.assert_array_equal(ds.held_phase[0], [0.0, 0.0, math.pi])  # 1/(2 - r^2)
    assert ds.held_phase.units == "radian"
    one = fm.boundaries(fm.System(contact="joined-base-wall"), [0.5, 1.5])
    np.testing.assert_array_equal(one.held_phase, 0.0)
    assert np.isnan(fm.boundaries(fm.System(), [0.5]).held_phase).all()
    behind = fm.System(mass_ratios=[1.0] * 2, stiffness_ratios=[1.0] * 2, load_mass=2)
    ds = fm.boundaries(behind, [1.0])  # mass 2 on its spring alone
    np.testing.assert_array_equal(ds.held_response[:, 0], [0.0, np.inf])
    assert np.isnan(ds.held_phase).all()

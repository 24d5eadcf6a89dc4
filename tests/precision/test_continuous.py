"""The closed form of continuous motion against a simulation, the equations of motion, and 40 digits."""

import math

import mpmath as mp
import numpy as np
import pytest
from continuous_motions import (
    CASES,
    Precise,
    as_system,
    below_the_boundary,
    beta_lim,
    half_nodes,
    random_system,
)

import frictionmap as fm
from benchmarks.references.naive import naive_steady_state
from frictionmap.theory.continuous_motion import inversion_points
from frictionmap.theory.half_waves import free_response


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{len(case[2])}")
def test_against_the_simulation(case):
    """T(7.28) as theory.md corrects it: amplitudes of z and of every mass, found without any closed form."""
    contact, load, gamma, kappa, zeta = case
    system = as_system(*case)
    for r, share in ((0.31, 0.9), (0.73, 0.6), (1.31, 0.3), (2.2, 0.6)):
        beta = share * beta_lim(system, r)
        motion = fm.continuous_motion(system, r, beta)
        found = naive_steady_state(
            gamma=gamma, kappa=kappa, contact=contact, load=load, zeta=zeta, r=r, beta=beta, cycles=2000
        )
        assert found.status == "ok"
        assert found.stops == 0.0
        assert motion.contact_amplitude == pytest.approx(found.Z, rel=1e-9)
        np.testing.assert_allclose(motion.amplitude, found.X, rtol=1e-9)


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{len(case[2])}")
def test_equations_of_motion_in_40_digits(case):
    """The closed form solves theory.md 1 and returns as its mirror image; ours is the same to rounding."""
    r, share = 0.83, 0.7
    system = as_system(*case)
    beta = share * beta_lim(system, r)
    motion = fm.continuous_motion(system, r, beta)
    with mp.workdps(40):
        exact = Precise(*case, r, beta)
        phase, n = exact.phase, exact.n
        for t in (mp.mpf("0.3"), mp.mpf("1.7"), mp.mpf("2.9")):  # z falls: friction pushes up
            x, v, a = (
                mp.matrix([mp.diff(lambda s, k=k: exact.half(k, s), t, m) for k in range(n)])
                for m in range(3)
            )
            residual = exact.M * a + exact.C * v + exact.K * x - exact.beta * exact.c
            residual[exact.load - 1] -= mp.cos(t + phase)
            # at zeta = 1 the limit costs two thirds of the digits, and derivatives some more
            assert mp.norm(residual, mp.inf) < mp.mpf(10) ** (-9 if 1.0 in np.atleast_1d(case[4]) else -18)
        zero = mp.mpf(0)
        for order in (0, 1):
            for k in range(n):
                start = mp.diff(lambda s, k=k: exact.half(k, s), zero, order)
                end = mp.diff(lambda s, k=k: exact.half(k, s), +mp.pi, order)
                assert abs(start + end) < mp.mpf(10) ** -9
        across = sum(exact.c[k] * mp.diff(lambda s, k=k: exact.half(k, s), zero) for k in range(n))
        assert abs(across + exact.s * mp.sin(phase)) < mp.mpf(10) ** -9
        assert motion.contact_amplitude == pytest.approx(float(exact.Z), rel=1e-13)
        assert math.remainder(motion.contact_phase - float(phase), math.tau) == pytest.approx(0.0, abs=1e-13)
        tau = np.linspace(-7.0, 7.0, 23)
        size = motion.amplitude.max()
        for k in range(n):
            expected = [float(exact.x(k, mp.mpf(t))) for t in tau]
            np.testing.assert_allclose(motion.displacement(tau)[k], expected, rtol=0.0, atol=2e-13 * size)


def test_amplitude_is_the_largest_modulus():
    """A mass off the contact, to 13 digits: at the zero of its velocity in 40 digits."""
    case = (("wall", 2), 1, [1.0, 1.0], [1.0, 1.0], [0.01, 0.02])
    for r, share in ((0.4, 0.9), (0.9, 0.8), (1.3, 0.6), (2.5, 0.5)):
        system = as_system(*case)
        beta = share * beta_lim(system, r)
        motion = fm.continuous_motion(system, r, beta)
        with mp.workdps(40):
            exact = Precise(*case, r, beta)
            for k in range(2):
                t = np.linspace(0.0, math.pi, 2001)
                x = np.abs(motion.displacement(t + motion.contact_phase)[k])
                start = t[np.argmax(x)]
                peak = max(abs(exact.half(k, mp.mpf(0))), abs(exact.half(k, +mp.pi)))
                if 0.0 < start < math.pi:
                    peak = max(peak, abs(exact.half(k, exact.turn(k, start))))
                assert motion.amplitude[k] == pytest.approx(float(peak), rel=1e-13)


def test_no_sample_lies_above_the_amplitude():
    rng = np.random.default_rng(11)
    tau = np.linspace(0.0, math.pi, 20001)
    for _ in range(60):
        system = random_system(rng, damped=bool(rng.random() < 0.7))
        r, beta = below_the_boundary(rng, system)
        motion = fm.continuous_motion(system, r, beta)
        x = np.abs(motion.displacement(tau)).max(axis=1)
        assert np.all(x <= motion.amplitude * (1.0 + 1e-14))
        fastest = max(1.0, system.modes.w.max() / r)
        assert np.all(x >= motion.amplitude * (1.0 - (fastest * 1e-4) ** 2))
        z = motion.contact(tau)
        assert np.abs(z).max() <= motion.contact_amplitude * (1.0 + 1e-13)
        assert motion.contact(motion.contact_phase) == pytest.approx(motion.contact_amplitude, rel=1e-12)


def test_z_is_that_of_the_masses():
    """c.x - s cos(tau), and velocities are derivatives."""
    rng = np.random.default_rng(12)
    tau = np.linspace(-4.0, 9.0, 301)
    for _ in range(30):
        system = random_system(rng)
        r, beta = below_the_boundary(rng, system)
        motion = fm.continuous_motion(system, r, beta)
        x, v = motion.displacement(tau), motion.velocity(tau)
        size = motion.amplitude.max() + 1.0
        z = system.contact_vector @ x - system.base_motion * np.cos(tau)
        np.testing.assert_allclose(motion.contact(tau), z, rtol=0.0, atol=1e-13 * size)
        z = system.contact_vector @ v + system.base_motion * np.sin(tau)
        np.testing.assert_allclose(motion.contact_velocity(tau), z, rtol=0.0, atol=1e-12 * size)
        np.testing.assert_allclose(motion.displacement(tau + math.pi), -x, rtol=0.0, atol=1e-12 * size)
        np.testing.assert_allclose(motion.velocity(tau + math.pi), -v, rtol=0.0, atol=1e-11 * size)


def test_equations_of_motion_of_random_systems():
    """Also of loads with phases and of bases that push through dashpots: the impulse over a stretch.

    M x' + C x changes by the integral of the load and of friction, less that of K x.
    """
    rng = np.random.default_rng(13)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    for _ in range(40):
        system = random_system(rng, damped=bool(rng.random() < 0.7))
        r, beta = below_the_boundary(rng, system)
        motion, modes = fm.continuous_motion(system, r, beta), system.modes
        p = modes.load + 1j * r * modes.load_rate
        start, end = motion.contact_phase + np.array([0.2, 2.7])  # z falls in between
        tau = 0.5 * (start + end) + 0.5 * (end - start) * nodes
        change = r**2 * modes.mass @ np.diff(motion.velocity([start, end]))[:, 0]
        change += r * modes.damping @ np.diff(motion.displacement([start, end]))[:, 0]
        force = (p[:, np.newaxis] * np.exp(1j * tau)).real + beta * modes.contact[:, np.newaxis]
        force -= modes.stiffness @ motion.displacement(tau)
        size = np.abs(modes.stiffness).max() * motion.amplitude.max() + np.abs(p).max()
        impulse = 0.5 * (end - start) * force @ weights
        np.testing.assert_allclose(change, impulse, rtol=0.0, atol=1e-12 * size)


def test_energy_over_a_period():
    """The load's and the base's work is lost in friction and in damping."""
    rng = np.random.default_rng(14)
    for _ in range(60):
        system = random_system(rng)
        r, beta = below_the_boundary(rng, system)
        motion, modes = fm.continuous_motion(system, r, beta), system.modes
        tau, weights = half_nodes(motion)
        v, slide = motion.velocity(tau), motion.contact_velocity(tau)
        p = modes.load + 1j * r * modes.load_rate
        friction = beta * np.sign(slide)
        # the wall that moves with the base works on the structure with the force of friction, too
        work = ((p[:, np.newaxis] * np.exp(1j * tau)).real * v).sum(axis=0)
        work += friction * system.base_motion * np.sin(tau)
        assert weights @ (friction * slide) == pytest.approx(4.0 * beta * motion.contact_amplitude, rel=1e-10)
        lost = friction * slide + r * np.einsum("kt,kl,lt->t", v, modes.damping, v)
        scale = weights @ np.abs(work)
        assert weights @ work == pytest.approx(weights @ lost, abs=1e-10 * scale)


def test_one_mass():
    """T(2.34) to (2.37), (7.20) as printed, where they lose no digits."""
    for r in (0.3, 0.62, 0.8, 1.2, 1.9):
        for zeta in (0.02, 0.3, 0.9):
            s = math.sqrt(1.0 - zeta**2)
            x, angle = math.pi * zeta / r, math.pi * s / r
            below = math.cosh(x) + math.cos(angle)
            u = math.sin(angle) / (r * s * below)
            g = (math.sinh(x) - zeta / s * math.sin(angle)) / below
            v = 1.0 / math.hypot(1.0 - r**2, 2.0 * zeta * r)
            system = fm.System(damping_ratios=zeta)
            beta = 0.8 * beta_lim(system, r)
            motion = fm.continuous_motion(system, r, beta)
            expected = math.sqrt(v**2 - (beta * u) ** 2) - beta * g
            assert motion.contact_amplitude == pytest.approx(expected, rel=1e-12)
            assert motion.amplitude[0] == pytest.approx(expected, rel=1e-12)
            assert motion.monoharmonic_amplitude[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
def test_as_response(contact):
    """Time histories of `frictionmap.response`, whose slides are marched."""
    for zeta, r, share in ((0.0, 0.7, 0.6), (0.1, 1.4, 0.5), (1.3, 0.4, 0.9)):
        system = fm.System(contact=contact, damping_ratios=zeta)
        beta = share * beta_lim(system, r)
        ds = fm.response(system, r, beta, points=200)
        motion = fm.continuous_motion(system, r, beta)
        size = motion.amplitude[0]
        tau = ds.tau.values
        np.testing.assert_allclose(motion.displacement(tau)[0], ds.x[0], rtol=0.0, atol=1e-11 * size)
        np.testing.assert_allclose(motion.velocity(tau)[0], ds.v[0], rtol=0.0, atol=1e-10 * size)
        np.testing.assert_allclose(motion.contact(tau), ds.z, rtol=0.0, atol=1e-11 * size)


def test_little_damping_is_no_damping():
    rng = np.random.default_rng(15)
    for _ in range(20):
        system = random_system(rng, damped=False)
        r, beta = below_the_boundary(rng, system)
        settings = {name: getattr(system, name) for name in ("contact", "contact_masses", "mass_ratios")}
        settings |= {"stiffness_ratios": system.stiffness_ratios, "excitation": system.excitation}
        if system.load is not None:
            settings["load"] = system.load
        gap = np.min(np.abs(system.modes.w / r - 1.0))
        odd = np.min(np.abs(np.mod(system.modes.w / r, 2.0) - 1.0))
        if min(gap, odd) < 0.05 or beta > 0.9 * beta_lim(system, r):
            continue
        expected = fm.continuous_motion(system, r, beta)
        found = fm.continuous_motion(fm.System(damping_ratios=1e-9, **settings), r, beta)
        np.testing.assert_allclose(found.amplitude, expected.amplitude, rtol=1e-5)
        assert found.contact_amplitude == pytest.approx(expected.contact_amplitude, rel=1e-5)


def test_critical_damping_is_no_step():
    """zeta = 1 lies between its neighbours, and continues sin into sinh."""
    masses = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0]}
    motions = [
        fm.continuous_motion(fm.System(damping_ratios=[0.1, zeta], **masses), 0.7, 0.1)
        for zeta in (1.0 - 1e-7, 1.0, 1.0 + 1e-7)
    ]
    tau = np.linspace(0.0, 6.0, 50)
    below, at, above = (motion.displacement(tau) for motion in motions)
    np.testing.assert_allclose(0.5 * (below + above), at, rtol=0.0, atol=1e-13)
    assert np.abs(above - below).max() > 1e-9


#: Distances from natural frequencies and their sub-multiples, on both sides.
NEAR = [sign * 10.0**power for power in (-12, -9, -6, -3) for sign in (-1.0, 1.0)]


@pytest.mark.parametrize("contact", ["wall", "base"])
@pytest.mark.parametrize("zeta", [0.0, 1e-6, 0.01, 1.0, 1.5])
@pytest.mark.parametrize("place", [1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0])
def test_next_to_singular_frequencies(contact, zeta, place):
    """Against 75 digits at the same doubles: amplitude and displacement, relative to the harmonic motion."""
    case = ((contact, 1), 1, [1.0], [1.0], zeta)
    system = as_system(*case)
    for distance in [0.0, *NEAR]:
        r = place * (1.0 + distance)
        limit = beta_lim(system, r)
        if limit == 0.0 or (zeta == 0.0 and r == 1.0):
            continue
        for share in (0.5, 0.999):
            beta = share * limit
            motion = fm.continuous_motion(system, r, beta)
            with mp.workdps(75):
                exact = Precise(*case, r, beta)
                size = float(abs(exact.V)) + system.base_motion
                assert motion.contact_amplitude == pytest.approx(float(exact.Z), abs=1e-13 * size)
                tau = np.array([-2.0, 0.1, 1.0, 2.5, 4.4])
                expected = np.array([float(exact.x(0, mp.mpf(t))) for t in tau])
            np.testing.assert_allclose(motion.displacement(tau)[0], expected, rtol=0.0, atol=1e-12 * size)
            assert np.isfinite(motion.amplitude).all()
            # the mass itself is the contact with a wall that stands still
            if contact == "wall":
                assert motion.amplitude[0] == pytest.approx(motion.contact_amplitude, abs=1e-13 * size)


@pytest.mark.parametrize("r", [30.0, 1e3, 1e6])
@pytest.mark.parametrize("case", [CASES[0], CASES[3], CASES[4], CASES[7]], ids=lambda case: str(case[0]))
def test_high_frequencies(case, r):
    """1 - cos(tau/R) is of the order of 1/R^2: no digit of it is lost."""
    system = as_system(*case)
    beta = 0.7 * beta_lim(system, r)
    motion = fm.continuous_motion(system, r, beta)
    with mp.workdps(75):
        exact = Precise(*case, r, beta)
        assert motion.contact_amplitude == pytest.approx(float(exact.Z), rel=1e-12)
        tau = np.array([-2.0, 0.1, 1.0, 2.5, 4.4])
        expected = np.array([[float(exact.x(k, mp.mpf(t))) for t in tau] for k in range(exact.n)])
        # a mass off the load moves by 1/r^2 less, what the modes leave of each other
        size = np.abs(expected).max()
        np.testing.assert_allclose(motion.displacement(tau), expected, rtol=0.0, atol=1e-12 * size)


def test_low_frequencies():
    """r = 10^-3: thousands of periods of the modes in one of the load, at no great cost."""
    system = as_system(*CASES[6])
    beta = 0.5 * beta_lim(system, 1e-3)
    motion = fm.continuous_motion(system, 1e-3, beta)
    np.testing.assert_allclose(motion.amplitude, 1.0, rtol=1e-4)  # all move with the base
    tau = np.linspace(0.0, math.pi, 200_001)
    assert np.all(np.abs(motion.displacement(tau)).max(axis=1) <= motion.amplitude * (1.0 + 1e-14))


def test_pieces_of_the_answer():
    """1 - d, q and e of T(B.8), (B.9) at any damping and time, against 60 digits."""
    theta = np.concatenate((10.0 ** np.arange(-9.0, 2.5, 0.23), [0.1, 0.1499, 0.15, 0.29, 0.3, 0.31]))
    for zeta in (0.0, 1e-9, 1e-3, 0.3, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.2, 1.999, 2.0, 10.0, 100.0):
        rise, q, e = free_response(zeta, theta)
        with mp.workdps(60):
            for k, value in enumerate(theta):
                z, x = mp.mpf(zeta), mp.mpf(value)
                s = mp.sqrt(mp.mpc(1 - z**2)) if zeta != 1.0 else mp.mpc(mp.mpf(10) ** -20)
                exact_q = mp.re(mp.exp(-z * x) * mp.sin(s * x) / s)
                exact_e = mp.re(mp.exp(-z * x) * (mp.cos(s * x) - z / s * mp.sin(s * x)))
                exact_rise = 1 - exact_e - 2 * z * exact_q
                turns = 1e-16 * value if zeta < 1.0 else 0.0  # rounding of the angle
                smaller = min(1.0, value**2 / 20.0) if zeta < 1e-2 else 0.0  # 1 - cos returns to zero
                size = max(abs(float(exact_rise)), smaller)
                assert abs(rise[k] - float(exact_rise)) <= 5e-14 * size + turns
                assert abs(q[k] - float(exact_q)) <= 1e-13 * min(value, 1.0) + turns
                assert abs(e[k] - float(exact_e)) <= 1e-14 + turns


def test_monoharmonic_amplitude():
    """T(5.50), (5.74), (5.90) without damping; with it hypot(x(0), x'(0)), which T(7.33) prints with a slip.

    In T(7.33) the term in root U_dk sin(angle V_dk - angle V_dj) has the wrong sign: it is a product of two
    terms of unlike sign of T(7.32).
    """
    rng = np.random.default_rng(16)
    wrong = 0.0
    for _ in range(40):
        damped = bool(rng.random() < 0.5)
        system = random_system(rng, damped)
        r, beta = below_the_boundary(rng, system)
        motion, modes = fm.continuous_motion(system, r, beta), system.modes
        at = np.array([r])
        found = motion.monoharmonic_amplitude
        start = [motion.contact_phase]
        at_start = np.hypot(motion.displacement(start), motion.velocity(start))[:, 0]
        np.testing.assert_allclose(found, at_start, rtol=1e-10)
        ds = fm.boundaries(system, at)
        v, u_z = complex(ds.V[0], ds.V_imag[0]), ds.U.item()
        v_k = np.array([modes.response(at, row)[0] for row in modes.phi])
        u = motion._compliance @ motion._responses.u[0]
        g = motion._compliance @ motion._responses.g[0]
        if not damped and system.load is None:
            squares = v_k.real**2 + (1.0 - 2.0 * v_k.real * u_z / (v.real * u)) * (beta * u) ** 2
            np.testing.assert_allclose(found**2, squares, rtol=1e-9, atol=1e-12)
        root, turn = math.sqrt(abs(v) ** 2 - (beta * u_z) ** 2), np.angle(v_k) - np.angle(v)
        for sign in (-1.0, 1.0):  # theory's and T's
            cross = root * (g * np.cos(turn) + sign * u * np.sin(turn))
            cross += beta * u_z * (g * np.sin(turn) + u * np.cos(turn))
            squares = np.abs(v_k) ** 2 + beta**2 * (g**2 + u**2) - 2.0 * beta * np.abs(v_k) / abs(v) * cross
            if sign < 0.0:
                np.testing.assert_allclose(found**2, squares, rtol=1e-9, atol=1e-11)
            else:
                wrong = max(wrong, np.max(np.abs(squares / found**2 - 1.0)))
    assert wrong > 0.01


def test_first_harmonic():
    """The phasor by quadrature of the displacement, T(4.4), (4.5)."""
    rng = np.random.default_rng(17)
    for _ in range(30):
        system = random_system(rng, damped=bool(rng.random() < 0.7))
        r, beta = below_the_boundary(rng, system)
        motion = fm.continuous_motion(system, r, beta)
        tau, weights = half_nodes(motion)
        expected = motion.displacement(tau) @ (weights * np.exp(-1j * tau)) / math.pi
        size = motion.amplitude.max()
        np.testing.assert_allclose(motion.first_harmonic, expected, rtol=0.0, atol=1e-12 * size)


def test_without_friction():
    """beta = 0 is the linear response, also where U is infinite."""
    for system in (fm.System(), fm.System(contact="joined-base-wall")):
        for r in (1.0 / 3.0, 0.5, 0.8, 2.0):
            motion = fm.continuous_motion(system, r, 0.0)
            np.testing.assert_allclose(motion.amplitude, abs(1.0 / (1.0 - r**2)), rtol=1e-14)
            np.testing.assert_allclose(motion.monoharmonic_amplitude, motion.amplitude, rtol=1e-14)
            np.testing.assert_allclose(np.abs(motion.first_harmonic), motion.amplitude, rtol=1e-14)
            tau = np.array([0.0, 1.0, 4.0])
            np.testing.assert_allclose(motion.displacement(tau)[0], np.cos(tau) / (1.0 - r**2), atol=1e-14)
            np.testing.assert_allclose(motion.velocity(tau)[0], -np.sin(tau) / (1.0 - r**2), atol=1e-14)
    pole = fm.System(matrices={"M": [[1.0]], "K": [[9.0]]}, frequency_scale=1.0)  # w = 3: u is infinite at 1
    motion = fm.continuous_motion(pole, 1.0, 0.0)
    for amplitudes in (motion.amplitude, motion.monoharmonic_amplitude, np.abs(motion.first_harmonic)):
        np.testing.assert_allclose(amplitudes, 1.0 / 8.0, rtol=1e-15)
    with pytest.raises(fm.NoSteadyState, match="beta_lim = 0"):
        fm.continuous_motion(pole, 1.0, 1e-300)


def test_on_the_boundary_next_to_a_pole():
    """|V| = beta_lim |U| there up to rounding, which must not be taken for no motion."""
    for place in (1.0, 1.0 / 3.0, 1.0 / 5.0):
        for distance in NEAR:
            r = place * (1.0 + distance)
            for contact in ("fixed-wall", "joined-base-wall"):
                system = fm.System(contact=contact)
                motion = fm.continuous_motion(system, r, beta_lim(system, r))
                assert np.isfinite(motion.amplitude).all()
                assert motion.contact_amplitude >= 0.0


def test_modes_that_the_contact_does_not_see():
    """Two equal branches on a mass in contact: in the mode of the one against the other it stands still.

    Their u is infinite at its odd sub-multiples; only its harmonic motion is left there.
    """
    matrices = {"M": np.eye(3), "K": np.array([[4.0, 0.0, -4.0], [0.0, 4.0, -4.0], [-4.0, -4.0, 10.0]])}
    system = fm.System(contact_masses=[3], load_mass=1, matrices=matrices, frequency_scale=1.0)
    unseen = system.modes.chi == 0.0
    assert unseen.sum() == 1
    w = system.modes.w[unseen].item()
    assert w == pytest.approx(2.0)
    r = w / 3.0
    beta = 0.8 * beta_lim(system, r)
    motion = fm.continuous_motion(system, r, beta)
    for nearby in (r * (1.0 - 1e-9), r * (1.0 + 1e-9)):
        near = fm.continuous_motion(system, nearby, beta)
        np.testing.assert_allclose(motion.amplitude, near.amplitude, rtol=1e-6)
    # x1 - x2 is that mode alone
    tau = np.array([0.3, 2.0])
    difference = np.diff(motion.displacement(tau)[:2], axis=0)[0]
    np.testing.assert_allclose(difference, -np.cos(tau) / (w**2 - r**2), rtol=1e-12)
    with pytest.raises(fm.NoSteadyState, match="undamped resonance"):
        fm.continuous_motion(system, w, 0.01)


def test_existence():
    """Up to beta_lim of mu = 1, and not above; at poles of U no motion with friction is continuous."""
    rng = np.random.default_rng(18)
    for _ in range(20):
        system = random_system(rng)
        r, _ = below_the_boundary(rng, system)
        limit = beta_lim(system, r)
        slide = fm.continuous_motion(system, r, limit)
        tau = slide.contact_phase + np.linspace(0.0, math.pi, 4001)
        assert np.all(slide.contact_velocity(tau) <= 1e-10 * (slide.contact_amplitude + limit))
        with pytest.raises(fm.NoSteadyState, match="no motion is continuous above beta_lim"):
            fm.continuous_motion(system, r, limit * (1.0 + 1e-9))
    with pytest.raises(fm.NoSteadyState, match="no motion is continuous"):
        fm.continuous_motion(fm.System(), 1.0 / 3.0, 1e-9)
    with pytest.raises(fm.NoSteadyState, match="undamped resonance"):
        fm.continuous_motion(fm.System(), 1.0, 0.1)
    with pytest.raises(fm.NoSteadyState, match="undamped resonance"):
        fm.continuous_motion(fm.System(), 1.0, 0.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fm.continuous_motion(fm.System(), 0.0, 0.1), "r must be > 0"),
        (lambda: fm.continuous_motion(fm.System(), math.nan, 0.1), "r must be finite"),
        (lambda: fm.continuous_motion(fm.System(), 1e9, 0.1), "r must be <= 1e"),
        (lambda: fm.continuous_motion(fm.System(), "2", 0.1), "r must be a number"),
        (lambda: fm.continuous_motion(fm.System(), 2.0, -0.1), "beta must be >= 0"),
        (lambda: fm.continuous_motion(fm.System(), 2.0, 0.1).contact([[1.0]]), "tau must be one-dimensional"),
        (lambda: fm.continuous_motion(fm.System(), 2.0, 0.1).displacement(math.inf), "tau must be .*finite"),
        (lambda: fm.continuous_motion(fm.System(), 2.0, 0.1).velocity("soon"), "tau must be numbers"),
        (lambda: inversion_points(fm.System(), 1, 0.0, 0.5, 2.0), "beta must be > 0"),
        (lambda: inversion_points(fm.System(), 2, 0.1, 0.5, 2.0), "mass must be <= 1"),
        (lambda: inversion_points(fm.System(), 1, 0.1, 2.0, 0.5), "high must be > 2"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(fm.InputError, match=message):
        call()

"""Phases, harmonics and energy of continuous motion against quadrature, 40 digits, and their identities."""

import math

import mpmath as mp
import numpy as np
import pytest
from continuous_motions import CASES, Precise, as_system, below_the_boundary, half_nodes, random_system
from structures import KINDS

import frictionmap as fm


def angle_between(a, b):
    """Largest distance of angles, whole turns apart; NaN beside NaN is none."""
    a, b = np.broadcast_arrays(np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    np.testing.assert_array_equal(np.isnan(a), np.isnan(b))
    return np.nanmax(np.abs(np.remainder(a - b + math.pi, math.tau) - math.pi), initial=0.0)


def motions(seed, count):
    """Motions of random systems, with the systems."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        system = random_system(rng, damped=bool(rng.random() < 0.7))
        yield system, fm.continuous_motion(system, *below_the_boundary(rng, system))


def of_reference(row, systems):
    """The motion of a row of the reference."""
    entry = systems[row["system"]]
    kind, *masses = entry["contact"]
    load = {"excitation": "base", "damping_reference": "base"} if entry["base_damping"] else {}
    load = load or ({} if kind == "base" else {"load_mass": entry["load"]})
    system = fm.System(
        contact=KINDS[kind], contact_masses=masses, mass_ratios=entry["gamma"],
        stiffness_ratios=entry["kappa"], damping_ratios=row["zeta"], **load,
    )  # fmt: skip
    return fm.continuous_motion(system, row["r"], row["beta"])


def test_reference_rows(curve_rows):
    """Every row that is continuous, to 1e-12: twenty times what rounding leaves in the worst."""
    systems, rows = curve_rows
    rows = [row for row in rows if row["regime"] == "continuous"]
    assert len(rows) > 40
    for row in rows:
        motion = of_reference(row, systems)
        size = max(row["amplitude"])
        np.testing.assert_allclose(motion.amplitude, row["amplitude"], rtol=1e-12)
        assert motion.contact_amplitude == pytest.approx(row["contact_amplitude"], rel=1e-12)
        assert angle_between(motion.phase, row["lag"]) < 1e-12
        assert angle_between(motion.contact_phase, row["contact_lag"]) < 1e-12
        for name, found, scale in (
            ("harmonics_x", motion.harmonics(7), size),
            ("harmonics_z", motion.contact_harmonics(7), size),
            ("harmonics_f", motion.friction_harmonics(7), 1.0),
        ):
            parts = np.array(row[name])
            expected = (parts[..., 0] + 1j * parts[..., 1]).reshape(found.shape)
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * scale)
        assert motion.sliding_distance == pytest.approx(row["sliding_distance"], rel=1e-12)
        assert motion.work_friction == pytest.approx(row["work_friction"], rel=1e-12)
        assert motion.work_input == pytest.approx(row["work_input"], rel=1e-12)
        assert motion.work_damping == pytest.approx(row["work_viscous"], rel=1e-12)
        assert motion.equivalent_damping == pytest.approx(row["equivalent_damping"], rel=1e-12)
        if row["transmitted_first_harmonic"] is not None:
            expected = complex(*row["transmitted_first_harmonic"])
            assert abs(motion.transmitted_first_harmonic - expected) < 1e-12 * size


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{len(case[2])}")
def test_in_40_digits(case):
    """The time of the largest displacement as a zero of the velocity; harmonics by quadrature."""
    system = as_system(*case)
    r = 0.83
    motion = fm.continuous_motion(system, r, 0.7 * fm.boundaries(system, [r]).beta_lim.item())
    harmonics = motion.harmonics(5)
    tolerance = 1e-9 if 1.0 in np.atleast_1d(case[4]) else 1e-12  # of `Precise` at zeta = 1
    with mp.workdps(40):
        exact = Precise(*case, r, motion.beta)
        for k in range(exact.n):
            turn = exact.turn(k, float(np.remainder(motion.phase[k] - motion.contact_phase, math.pi)))
            tau = turn + exact.phase
            if exact.x(k, tau) < 0:
                tau += mp.pi
            assert angle_between(motion.phase[k], float(tau)) < tolerance
            # one order of each of many masses: quadrature takes long
            orders = (1, 3, 5) if exact.n < 3 else (1 + 2 * (k % 3),)
            for m in orders:  # the other half gives the same
                value = mp.quad(
                    lambda t, k=k, m=m: exact.half(k, t) * mp.expjpi(-m * (t + exact.phase) / mp.pi),
                    mp.linspace(0, mp.pi, 5),
                )
                error = abs(harmonics[k, m] - complex(value * 2 / mp.pi))
                assert error < tolerance * motion.amplitude.max()


def test_harmonics_by_quadrature():
    """Of displacements, of the contact and of friction, loads with phases and moving bases included."""
    orders = np.arange(8)
    for _, motion in motions(21, 40):
        tau, weights = half_nodes(motion)
        waves = weights * np.exp(-1j * orders[:, np.newaxis] * tau) / math.pi
        waves[0] *= 0.5
        size = motion.amplitude.max()
        expected = motion.displacement(tau) @ waves.T
        np.testing.assert_allclose(motion.harmonics(7), expected, rtol=0.0, atol=1e-12 * size)
        z = motion.contact(tau) @ waves.T
        np.testing.assert_allclose(motion.contact_harmonics(7), z, rtol=0.0, atol=1e-12 * size)
        friction = motion.beta * np.sign(motion.contact_velocity(tau))
        np.testing.assert_allclose(
            motion.friction_harmonics(7), friction @ waves.T, rtol=0.0, atol=1e-13 * motion.beta
        )
        np.testing.assert_array_equal(motion.first_harmonic, motion.harmonics(1)[:, 1])


def test_phase_is_where_samples_are_largest():
    for _, motion in motions(22, 60):
        for phase, amplitude, mass in zip(motion.phase, motion.amplitude, range(9), strict=False):
            assert -math.pi < phase <= math.pi
            assert motion.displacement(phase)[mass, 0] == pytest.approx(amplitude, rel=1e-13)
            speed = np.abs(motion.velocity(np.linspace(0.0, math.pi, 200))[mass]).max()
            assert abs(motion.velocity(phase)[mass, 0]) < 1e-12 * (speed + amplitude)
        assert -math.pi < motion.contact_phase <= math.pi


def test_the_mass_at_a_wall_turns_with_the_contact():
    """Also on the boundary, where its acceleration vanishes at the turn."""
    for system in (fm.System(), fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1])):
        mass = system.contact_masses[0] - 1
        for r in (0.7, 1.3, 2.1):
            limit = fm.boundaries(system, [r]).beta_lim.item()
            for beta in (0.5 * limit, limit):
                motion = fm.continuous_motion(system, r, beta)
                assert motion.phase[mass] == motion.contact_phase
                assert motion.amplitude[mass] == motion.contact_amplitude


def power_of_the_base(system, motion, tau):
    """Forces of springs and dashpots that end at the base, and of friction on a wall, times its velocity."""
    modes, r, rate = system.modes, motion.r, -np.sin(tau)
    forces = modes.stiffness.sum(axis=1) @ (np.cos(tau) - motion.displacement(tau))
    if system.damping_reference == "base":
        forces += r * modes.damping.sum(axis=1) @ (rate - motion.velocity(tau))
    wall = system.base_motion * motion.beta * np.sign(motion.contact_velocity(tau))
    return (forces - wall) * rate


def test_work_by_quadrature():
    """Of dashpots, friction, and what moves load, base and wall, each by its definition; their balance."""
    for system, motion in motions(23, 80):
        modes = system.modes
        tau, weights = half_nodes(motion)
        v, slide = motion.velocity(tau), motion.contact_velocity(tau)
        if system.excitation == "base":
            power = power_of_the_base(system, motion, tau)
        else:
            power = ((modes.load[:, np.newaxis] * np.exp(1j * tau)).real * v).sum(axis=0)
        stretch = v + np.sin(tau) if system.damping_reference == "base" else v
        lost = motion.r * np.einsum("kt,kl,lt->t", stretch, modes.damping, stretch)
        scale = weights @ np.abs(power)
        assert motion.work_input == pytest.approx(weights @ power, abs=1e-12 * scale)
        assert motion.work_damping == pytest.approx(weights @ lost, abs=1e-12 * scale)
        assert motion.sliding_distance == pytest.approx(weights @ np.abs(slide), rel=1e-10)
        assert motion.work_friction == motion.beta * motion.sliding_distance
        assert abs(motion.work_input - motion.work_friction - motion.work_damping) < 1e-12 * scale


def test_transmitted_force():
    """That of springs, dashpots and wall by the equations of motion: the push of a base is a load."""
    for _, motion in motions(24, 60):
        modes, r = motion._modes, motion.r
        tau, weights = half_nodes(motion)
        wall = modes.contact.sum() * motion.beta * np.sign(motion.contact_velocity(tau))
        force = modes.stiffness.sum(axis=1) @ motion.displacement(tau) + wall
        force += r * modes.damping.sum(axis=1) @ motion.velocity(tau)
        expected = weights @ (force * np.exp(-1j * tau)) / math.pi
        scale = np.abs(force).max()
        assert motion.transmitted_first_harmonic == pytest.approx(expected, abs=1e-11 * scale)


# Identities


def test_one_mass_at_a_wall():
    """(7) of theory.md 9: modulus and phase of the first harmonic by V and U; T(4.4), (4.5)."""
    system = fm.System()
    for r in (0.62, 0.85, 0.97, 1.3, 2.2):
        beta = 0.4
        motion = fm.continuous_motion(system, r, beta)
        v, u = 1.0 / (1.0 - r**2), math.tan(0.5 * math.pi / r) / r
        square = v**2 + 8.0 / math.pi * beta**2 * v * (u + 2.0 * v / math.pi)
        assert abs(motion.first_harmonic[0]) ** 2 == pytest.approx(square, rel=1e-13)
        sine, cosine = -beta * u / v, motion.contact_amplitude / v
        tangent = 4.0 * beta / math.pi * cosine / (1.0 - 4.0 * beta / math.pi * sine)
        lag = -np.angle(motion.first_harmonic[0])
        assert math.tan(lag) == pytest.approx(tangent, rel=1e-13)
        # energy: the load's work is that of friction
        expected = 4.0 * beta * motion.contact_amplitude / (math.pi * abs(motion.first_harmonic[0]))
        assert math.sin(lag) == pytest.approx(expected, rel=1e-13)


def test_sine_of_the_phase_is_the_work():
    """A single load, fixed wall or between masses: sin(phi) = (W_f + W_v)/(pi |X_l1|)."""
    rng = np.random.default_rng(25)
    for _ in range(40):
        n = int(rng.integers(1, 5))
        load = int(rng.integers(1, n + 1))
        system = fm.System(
            contact_masses=[int(rng.integers(1, n + 1))], load_mass=load,
            mass_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
            stiffness_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
            damping_ratios=float(rng.choice([0.0, 0.03, 0.5])),
        )  # fmt: skip
        motion = fm.continuous_motion(system, *below_the_boundary(rng, system))
        x = motion.first_harmonic[load - 1]
        lost = motion.work_friction + motion.work_damping
        assert -x.imag / abs(x) == pytest.approx(lost / (math.pi * abs(x)), abs=1e-13)


def test_masses_behind_the_contact_follow_it():
    """Every harmonic by the transfer function of what hangs on mass 1, in any motion."""
    gamma, kappa, orders = 0.7, 1.4, np.array([1, 3, 5, 7])
    system = fm.System(mass_ratios=[1.0, gamma], stiffness_ratios=[1.0, kappa])
    for r in (0.55, 0.9, 1.25, 2.0):
        motion = fm.continuous_motion(system, r, 0.5 * fm.boundaries(system, [r]).beta_lim.item())
        first, second = motion.harmonics(7)[:, orders]
        np.testing.assert_allclose(second / first, kappa / (kappa - gamma * (orders * r) ** 2), rtol=1e-12)


def test_even_harmonics_and_resonances_of_them_are_zero():
    """r = 1/2: the second harmonic meets w = 1 and friction has none; r = 1/3 without friction as well."""
    for r, beta in ((0.5, 0.1), (1.0 / 3.0, 0.0), (0.25, 0.01)):
        harmonics = fm.continuous_motion(fm.System(), r, beta).harmonics(8)
        np.testing.assert_array_equal(harmonics[0, ::2], 0.0)
        assert np.isfinite(harmonics).all()
        if beta == 0.0:
            np.testing.assert_array_equal(harmonics[0, 2:], 0.0)


@pytest.mark.parametrize("order", [-1, 1.5, True])
def test_bad_orders(order):
    motion = fm.continuous_motion(fm.System(), 0.7, 0.1)
    for function in (motion.harmonics, motion.contact_harmonics, motion.friction_harmonics):
        with pytest.raises(fm.InputError, match="n must be"):
            function(order)

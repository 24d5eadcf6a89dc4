"""Features against the numbers that the thesis prints, and against the curves themselves.

Tolerances: half of the last digit printed.  What T prints otherwise than it is stands beside the datum.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq
from structures import chain

import frictionmap as fm
from frictionmap import features
from frictionmap.theory.continuous_motion import inversion_points

#: T 6.5.1: two masses, contact between them, load on the first.
BETWEEN = {
    "contact": "between-masses", "contact_masses": [1, 2], "mass_ratios": [1, 0.5],
    "stiffness_ratios": [1, 0.5],
}  # fmt: skip


def equal_chain(n, **settings):
    return fm.System(mass_ratios=[1.0] * n, stiffness_ratios=[1.0] * n, **settings)


def beta_lim(system, r):
    return fm.boundaries(system, [r]).beta_lim.item()


def amplitude(system, mass, r, beta):
    return fm.continuous_motion(system, r, beta).amplitude[mass - 1]


def frictionless(system, mass, r):
    return amplitude(system, mass, r, 0.0)


# Resonances


def test_peak_thresholds():
    """T p. of (2.30), (6.3): 0.785; 6.2.1: 0.436, 1.765, 0.630; 6.3.3: 0.485, 1.271; 6.5.1: 0.785, 0.393."""
    assert features.peak_thresholds(fm.System()) == pytest.approx([math.pi / 4])
    assert np.round(features.peak_thresholds(equal_chain(3)), 3).tolist() == [0.785] * 3
    three = equal_chain(3, contact_masses=[2])
    assert np.round(features.peak_thresholds(three), 3).tolist() == [0.436, 1.765, 0.630]
    two = equal_chain(2, contact_masses=[2])
    assert np.round(features.peak_thresholds(two), 3).tolist() == [0.485, 1.271]
    assert np.round(features.peak_thresholds(fm.System(**BETWEEN)), 3).tolist() == [0.785, 0.393]


def test_peak_thresholds_are_beta_lim_at_resonance():
    """Without damping the threshold is the limit of beta_lim at each natural frequency."""
    system = equal_chain(3, contact_masses=[2])
    for w, threshold in zip(system.modes.w, features.peak_thresholds(system), strict=True):
        assert beta_lim(system, w * (1.0 - 1e-9)) == pytest.approx(threshold, rel=1e-6)


def test_peak_thresholds_with_little_damping():
    """T(7.62) goes over into (6.2)."""
    damped = features.peak_thresholds(fm.System(damping_ratios=1e-6))
    assert damped == pytest.approx([math.pi / 4], rel=1e-6)


def test_peak_amplitudes():
    """T(7.60), (7.61): 1/(2 zeta) - sinh/(cosh - 1) beta for one mass; near the exact ones for many."""
    for zeta in (0.01, 0.05, 0.2):
        x = math.pi * zeta
        expected = 0.5 / zeta - math.sinh(x) / (math.cosh(x) - 1.0) * 0.3
        found = features.peak_amplitudes(fm.System(damping_ratios=zeta), 0.3)
        assert found == pytest.approx(np.array([[expected]]), rel=1e-12)
    system = equal_chain(3, contact_masses=[2], damping_ratios=0.005)
    found = features.peak_amplitudes(system, 0.3)
    exact = np.column_stack([fm.continuous_motion(system, w, 0.3).amplitude for w in system.modes.w])
    np.testing.assert_allclose(found, exact, rtol=0.05)
    free = features.peak_amplitudes(system, 0.0)
    exact = np.column_stack([fm.continuous_motion(system, w, 0.0).amplitude for w in system.modes.w])
    np.testing.assert_allclose(free, exact, rtol=0.02)
    # a straight line down to the thresholds, 0.436, 1.765 and 0.630
    half = features.peak_amplitudes(system, 0.15)
    np.testing.assert_allclose(half, 0.5 * (free + found), rtol=1e-12)
    beyond = features.peak_amplitudes(system, 0.5)
    assert np.isnan(beyond).tolist() == [[True, False, False]] * 3
    # without damping, and of a mode that the contact does not see
    assert np.isinf(features.peak_amplitudes(equal_chain(2), 0.5)).all()
    matrices = {"M": np.eye(2), "K": np.diag([1.0, 4.0])}
    apart = fm.System(matrices=matrices, load=[1.0, 1.0], damping_ratios=0.1)
    assert features.peak_amplitudes(apart, 100.0)[1, 1] == pytest.approx(1.0 / (2.0 * 0.1 * 4.0))


def test_no_resonance_above():
    """T 3.6.2: if beta >= 1.06 no sliding mass under joined base-wall motion moves more than the base.

    The largest amplitude falls through 1 at beta = 1.057, on the continuous part of the curve.
    """
    system = fm.System(contact="joined-base-wall")

    def largest(beta):
        start = brentq(lambda r: beta_lim(system, r) - beta, 1.05, 1.6)
        r = start + np.linspace(1e-9, 0.15, 31)
        return max(amplitude(system, 1, x, beta) for x in r)

    threshold = brentq(lambda beta: largest(beta) - 1.0, 1.04, 1.08, xtol=1e-4)
    assert threshold == pytest.approx(1.06, abs=0.005)
    # stick-slip, between sticking at r = sqrt(beta) and there: near sticking the mass follows the base
    for r in np.linspace(1.032, 1.225, 25):
        assert np.abs(fm.response(system, r, 1.06, points=400).x).max() < 1.0


# High and low frequencies


def test_high_frequency_limits():
    """T(2.31): 0.537; 6.5.1: 0.179 and 0.333; zero if the load acts elsewhere; r = 10^6 agrees."""
    wall = features.high_frequency_limits(fm.System())
    assert round(wall.beta_lim, 3) == 0.537
    assert wall.beta_stick == 1.0
    between = fm.System(**BETWEEN)
    limits = features.high_frequency_limits(between)
    assert round(limits.beta_lim, 3) == 0.179
    assert round(limits.beta_stick, 3) == 0.333
    assert features.high_frequency_limits(equal_chain(2, contact_masses=[2])) == (0.0, 0.0)
    base = features.high_frequency_limits(fm.System(contact="joined-base-wall"))
    assert base == (math.inf, math.inf)
    for system, mu in ((fm.System(), 1.0), (fm.System(), 2.0), (between, 1.5), (equal_chain(3), 1.2)):
        ds = fm.boundaries(system, [1e6], mu)
        limits = features.high_frequency_limits(system, mu)
        assert ds.beta_lim.item() == pytest.approx(limits.beta_lim, rel=1e-9)
        assert ds.beta_stick.item() == pytest.approx(limits.beta_stick, rel=1e-9)


def test_quasi_static_displacement():
    """T 6.2.2: 1 - beta, and 1 - 2 beta twice; 6.3.2: 1 - beta twice; 6.3.3: 1 - (1 + kappa) beta/kappa."""
    np.testing.assert_allclose(features.quasi_static_displacement(fm.System(), 0.3), [0.7])
    np.testing.assert_allclose(features.quasi_static_displacement(equal_chain(2), 0.3), [0.7, 0.7])
    three = equal_chain(3, contact_masses=[2])
    np.testing.assert_allclose(features.quasi_static_displacement(three, 0.3), [0.7, 0.4, 0.4])
    kappa = 0.8
    two = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, kappa], contact_masses=[2])
    expected = [0.7, 1.0 - (1.0 + kappa) / kappa * 0.3]
    np.testing.assert_allclose(features.quasi_static_displacement(two, 0.3), expected)
    # loads with phases: at tau = 0
    turned = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], load=[1.0, 1.0j])
    np.testing.assert_allclose(features.quasi_static_displacement(turned, 0.3), [0.7, 0.7])


# Points that friction leaves alone


def test_invariant_points():
    """T 6.3.2: 0.559 and 1.118 = sqrt(5)/2, twice as much (T prints 1.123); 6.3.3: 1.450, the largest."""
    points = features.invariant_points(equal_chain(2), 0.5, 2.0)
    assert [round(float(point), 3) for point in points] == [0.559, 1.118]
    np.testing.assert_allclose(points, [math.sqrt(5.0) / 4.0, math.sqrt(5.0) / 2.0], rtol=1e-14)
    points = features.invariant_points(equal_chain(2, contact_masses=[2]), 0.3, 10.0)
    assert round(float(points[-1]), 3) == 1.450
    single = features.invariant_points(fm.System(), 0.09, 2.0)
    np.testing.assert_allclose(single, [1 / 10, 1 / 8, 1 / 6, 1 / 4, 1 / 2], rtol=1e-14)
    assert features.invariant_points(fm.System(), 0.51, 2.0).size == 0


def test_amplitude_and_phase_at_invariant_points():
    """T 6.2.4: neither depends on beta, and the phase is 0 or 180 degrees."""
    for system in (equal_chain(3, contact_masses=[2]), fm.System(**BETWEEN)):
        for r in features.invariant_points(system, 0.4, 3.0):
            limit = beta_lim(system, r)
            motions = [fm.continuous_motion(system, r, share * limit) for share in (0.0, 0.5, 0.99)]
            for motion in motions:
                assert motion.contact_amplitude == pytest.approx(motions[0].contact_amplitude, rel=1e-12)
                assert math.sin(motion.contact_phase) == pytest.approx(0.0, abs=1e-11)


def test_invariant_points_with_damping():
    """Of the phase only; also next to the frequencies where U has lost its poles."""
    for zeta in (1e-6, 0.01, [0.3, 1.2]):
        system = equal_chain(2, damping_ratios=zeta)
        points = features.invariant_points(system, 0.3, 3.0)
        assert points.size
        for r in points:
            limit = beta_lim(system, r)
            phases = [fm.continuous_motion(system, r, share * limit).contact_phase for share in (0.0, 0.9)]
            assert phases[1] == pytest.approx(phases[0], abs=1e-9)
    # u of one mode vanishes at w sqrt(1 - zeta^2)/k for all whole k, as sin(pi sqrt(1 - zeta^2)/r)
    for zeta in (1e-6, 0.01, 0.2):
        s = math.sqrt(1.0 - zeta**2)
        points = features.invariant_points(fm.System(damping_ratios=zeta), 0.18, 3.0)
        np.testing.assert_allclose(points, s / np.arange(5.0, 0.0, -1.0), rtol=1e-13)


def test_mass_invariant_points():
    """T 6.3.3: 0.828 and 1.549, the two largest for mass 1, contact on mass 2; 6.3.2: 0.527 (it is 0.528),
    0.576 and 1.201 for mass 2, contact on mass 1; 6.5.1: 0.778 and 1.213 (it is 1.2135) for mass 1."""
    points = features.mass_invariant_points(equal_chain(2, contact_masses=[2]), 1, 0.5, 3.0)
    assert [round(float(point), 3) for point in points[-2:]] == [0.828, 1.549]
    points = features.mass_invariant_points(equal_chain(2), 2, 0.5, 3.0)
    np.testing.assert_allclose(points, [0.527, 0.576, 1.201], rtol=0.0, atol=0.0006)
    points = features.mass_invariant_points(fm.System(**BETWEEN), 1, 0.7, 3.0)
    np.testing.assert_allclose(points, [0.778, 1.213], rtol=0.0, atol=0.00055)
    # one mass under joined base-wall motion, T(3.30): sqrt(2), as with a dashpot; and U = 0
    points = features.mass_invariant_points(fm.System(contact="joined-base-wall"), 1, 0.3, 3.0)
    np.testing.assert_allclose(points, [0.5, math.sqrt(2.0)], rtol=1e-14)
    # the mass in contact with a fixed wall
    system = equal_chain(3, contact_masses=[2])
    expected = features.invariant_points(system, 0.3, 3.0)
    np.testing.assert_allclose(features.mass_invariant_points(system, 2, 0.3, 3.0), expected, rtol=1e-13)


def test_monoharmonic_amplitude_at_mass_invariant_points():
    """T(5.50) does not depend on beta there; with damping left out, T 7.4.3, the points stay."""
    for system in (equal_chain(2), equal_chain(3, contact_masses=[2]), fm.System(**BETWEEN)):
        damped = fm.System(
            contact=system.contact, contact_masses=system.contact_masses, mass_ratios=system.mass_ratios,
            stiffness_ratios=system.stiffness_ratios, damping_ratios=0.02,
        )  # fmt: skip
        for mass in range(1, system.n + 1):
            points = features.mass_invariant_points(system, mass, 0.5, 3.0)
            assert points.size
            np.testing.assert_array_equal(features.mass_invariant_points(damped, mass, 0.5, 3.0), points)
            for r in points:
                motion = fm.continuous_motion(system, r, 0.9 * beta_lim(system, r))
                expected = frictionless(system, mass, r)
                assert motion.monoharmonic_amplitude[mass - 1] == pytest.approx(expected, rel=1e-10)


def test_no_invariant_point_is_missed():
    """Every change of sign between a hundred thousand samples is at one of the points."""
    rng = np.random.default_rng(21)
    for _ in range(15):
        n = int(rng.integers(2, 5))
        mass = int(rng.integers(1, n + 1))
        system = fm.System(
            contact_masses=[int(rng.integers(1, n + 1))],
            load_mass=int(rng.integers(1, n + 1)),
            mass_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
            stiffness_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
        )
        modes = system.modes
        r = np.linspace(0.25, 4.0, 100_001)
        u = np.tan(0.5 * np.pi * modes.w / r[:, np.newaxis]) * modes.w / r[:, np.newaxis]
        v = modes.participation(r).real / (modes.w**2 - r[:, np.newaxis] ** 2)
        poles = np.concatenate([modes.w / k for k in range(1, 40, 2)])
        across = np.searchsorted(np.sort(poles), r)

        def all_found(points, values, r=r, across=across):
            changes = (values[1:] * values[:-1] < 0.0) & (across[1:] == across[:-1])
            middle = 0.5 * (r[1:] + r[:-1])[changes]
            return bool(np.all(np.abs(middle[:, np.newaxis] - points).min(axis=1, initial=9.0) < r[1] - r[0]))

        u_z, v_z = u @ (modes.chi / modes.w) ** 2, v @ modes.chi
        u_k, v_k = u @ (modes.phi[mass - 1] * modes.chi / modes.w**2), v @ modes.phi[mass - 1]
        points = features.invariant_points(system, 0.25, 4.0)
        assert all_found(points, u_z)
        # between two poles of U there is one, and one only
        places = np.searchsorted(np.sort(poles[(poles > 0.25) & (poles < 4.0)]), points)
        assert np.all(np.diff(places) == 1)
        points = features.mass_invariant_points(system, mass, 0.25, 4.0)
        assert all_found(points, u_k)
        jumps = np.diff(np.sign(v_z), prepend=np.sign(v_z[0])) != 0.0  # there V_k/V has poles
        places = across + 100 * np.cumsum(jumps)
        a_k = (modes.chi * modes.phi[mass - 1] / (modes.w**2 - r[:, np.newaxis] ** 2)).sum(axis=1)
        ratio = v_k / v_z
        if mass != system.contact_masses[0]:
            assert all_found(points, u_k - 2.0 * ratio * u_z, across=places)
        first = features.first_harmonic_points(system, 0.25, 4.0)[mass - 1]
        assert all_found(first.unchanged, a_k)
        assert all_found(first.inversions, ratio * u_z + 2.0 / np.pi * a_k, across=places)


def test_the_highest_points_only():
    system = equal_chain(5)
    every = features.invariant_points(system, 0.02, 3.0)
    few = features.invariant_points(system, 0.02, 3.0, 20)
    assert 15 <= few.size <= 21
    np.testing.assert_array_equal(few, every[-few.size :])
    assert features.invariant_points(system, 1e-300, 3.0, 20).size == few.size


# Inversions


def test_inversions_of_the_exact_amplitude():
    """T 6.5.1: mass 1 inverts in two small regions, at 0.770 and at 1.226: there its amplitude on the
    boundary of continuous motion is that without friction.  Their other ends are those for beta -> 0, where
    the monoharmonic amplitude is exact, 0.778 and 1.213."""
    system = fm.System(**BETWEEN)

    def on_boundary(r):
        return amplitude(system, 1, r, beta_lim(system, r)) - frictionless(system, 1, r)

    assert round(brentq(on_boundary, 0.74, 0.79), 3) == 0.770
    assert round(brentq(on_boundary, 1.20, 1.24), 3) == 1.226
    limits = features.mass_invariant_points(system, 1, 0.7, 1.3)
    np.testing.assert_allclose(inversion_points(system, 1, 1e-3, 0.7, 1.3, 61), limits, atol=1e-4)
    between = inversion_points(system, 1, 0.4, 0.7, 1.3, 61)
    assert 0.770 < between[0] < limits[0]
    assert limits[1] < between[1] < 1.226
    # friction raises the amplitude in between, towards the resonance of the stuck structure
    for r, raised in ((0.75, False), (0.9, True), (1.1, True), (1.24, False)):
        beta = 0.5 * beta_lim(system, r)
        assert (amplitude(system, 1, r, beta) > frictionless(system, 1, r)) == raised


def test_inversion_over_a_range():
    """T 3.5: one mass under joined base-wall motion inverts over about 1.4 < r < 1.55, and not at sqrt(2),
    T(3.30), which is the end for beta -> 0.  The other is where a curve near the last, beta = 1.4, turns."""
    system = fm.System(contact="joined-base-wall")
    points = [inversion_points(system, 1, beta, 1.3, 1.6, 31).item() for beta in (0.001, 0.2, 0.75, 1.0)]
    np.testing.assert_allclose(points, [math.sqrt(2.0), 1.4308, 1.4688, 1.4844], rtol=0.0, atol=1e-4)

    def slope(r, beta=1.4, step=1e-4):
        return amplitude(system, 1, r, beta) - amplitude(system, 1, r, beta - step)

    assert round(brentq(slope, 1.48, 1.6), 2) == 1.55
    # amplitudes there are below those of the base, T 3.5
    assert amplitude(system, 1, 1.5, 0.5) < 1.0


def test_inversions_of_the_first_harmonic():
    """T 4.4.2, Fig. 4.10: frequency-based curves invert at one point.  That is exact, and so is where:
    U/V = -2/pi, that is tan(pi/(2 r)) (r^2 - 1)/r^3 = 2/pi at r = 1.5063.  T prints 1.504, as read off a
    figure; its other such number, 0.604 of 4.4.1, is 0.6053.  0.334 there is the pole of U at 1/3."""
    base = fm.System(contact="joined-base-wall")
    point = features.first_harmonic_invariant_points(base, 1, 1.2, 3.0).item()
    assert point == pytest.approx(1.504, abs=0.003)
    assert math.tan(0.5 * math.pi / point) * (point**2 - 1.0) / point**3 == pytest.approx(2.0 / math.pi)
    wall = fm.System()
    points = features.first_harmonic_invariant_points(wall, 1, 1.0 / 3.0, 3.0)
    assert points == pytest.approx([0.604], abs=0.002)
    for system in (base, wall, equal_chain(3, contact_masses=[2]), fm.System(**BETWEEN)):
        for mass in range(1, system.n + 1):
            for r in features.first_harmonic_invariant_points(system, mass, 0.5, 3.0):
                beta = 0.9 * beta_lim(system, r)
                found = abs(fm.continuous_motion(system, r, beta).first_harmonic[mass - 1])
                # where the harmonic compliance vanishes there may be no motion to compare
                size = frictionless(system, mass, r)
                assert found == pytest.approx(size, rel=1e-9, abs=1e-12)
    # between the pole and the point friction raises the first harmonic while it lowers the amplitude
    motion = fm.continuous_motion(wall, 0.45, 0.2)
    assert abs(motion.first_harmonic[0]) > 1.0 / (1.0 - 0.45**2) > motion.amplitude[0]


def test_a_first_harmonic_without_friction_in_any_regime():
    """Where A_k = 0 friction does not reach the first harmonic of mass k, whatever its time history is.

    Two masses, contact on mass 2: r = sqrt(2) is the natural frequency with it held, T 6.3.3 ("1.414").
    Samples of a response with stops, whose first harmonic is off by some N^-3.
    """
    system = equal_chain(2, contact_masses=[2])
    point = features.first_harmonic_points(system, 1.0, 1.45)[1].unchanged.item()
    assert point == pytest.approx(math.sqrt(2.0), rel=1e-14)
    for share in (1.2, 2.0):
        ds = fm.response(system, point, share * beta_lim(system, point), points=4000)
        assert float(ds.stops_per_cycle) > 0.0
        wave = np.exp(-1j * ds.tau.values[:-1])
        first = 2.0 * np.mean(ds.x.values[1, :-1] * wave)
        assert first == pytest.approx(frictionless(system, 2, point) * -1.0, abs=1e-9)


def mp_functions(entry):
    """A_k and the bracket of theory.md 9 of a chain without damping, masses and contact, by its matrices."""
    gamma, kappa, contact, load = (entry[name] for name in ("gamma", "kappa", "contact", "load"))
    n = len(gamma)
    stiffness = mp.zeros(n)
    for i in range(n):
        stiffness[i, i] += mp.mpf(kappa[i])
        if i:
            stiffness[i - 1, i - 1] += mp.mpf(kappa[i])
            stiffness[i, i - 1] = stiffness[i - 1, i] = -mp.mpf(kappa[i])
    root = mp.diag([1 / mp.sqrt(mp.mpf(value)) for value in gamma])
    squares, shapes = mp.eigsy(root * stiffness * root)
    phi, w = root * shapes, [mp.sqrt(value) for value in squares]
    c = mp.zeros(n, 1)
    c[contact[-1] - 1] = 1
    if contact[0] == "masses":
        c[contact[1] - 1] = -1
    chi = [(c.T * phi[:, i])[0] for i in range(n)]
    rows = [phi[k, :] for k in range(n)] + [mp.matrix([chi])]

    def compliance(k, r):
        return sum(rows[k][i] * chi[i] / (w[i] ** 2 - r**2) for i in range(n))

    def response(k, r):
        found = sum(rows[k][i] * phi[load - 1, i] / (w[i] ** 2 - r**2) for i in range(n))
        return found - (1 if k == n and contact[0] == "base" else 0)

    def bracket(k, r):
        u = sum((chi[i] / w[i]) ** 2 * mp.tan(mp.pi * w[i] / (2 * r)) * w[i] / r for i in range(n))
        return response(k, r) / response(n, r) * u + 2 / mp.pi * compliance(k, r)

    return compliance, bracket


RIG = {"gamma": ["1", "0.9772"], "kappa": ["1", "1.1119"], "load": 1}
EQUAL = {"gamma": [1, 1], "kappa": [1, 1], "load": 1}

#: System; low end; then of every mass and of z where A_k = 0 and where the bracket is, to six digits: all
#: that there are up to r = 4.  T reads off figures: 0.604, 1.504; 0.576, 1.201; 1.414, 1.549; 0.770, 1.226.
FIRST_HARMONICS = [
    ({"gamma": [1], "kappa": [1], "load": 1, "contact": ("wall", 1)}, 0.15,
     [([], [0.168636, 0.257099, 0.605258])] * 2),
    ({"gamma": [1], "kappa": [1], "load": 1, "contact": ("base", 1)}, 0.55,
     [([], [1.506310]), ([], [0.605258])]),
    ({**EQUAL, "contact": ("wall", 1)}, 0.54,
     [([1.0], [0.572614, 1.202347]), ([], [0.572614, 1.202347]), ([1.0], [0.572614, 1.202347])]),
    ({**EQUAL, "contact": ("wall", 2)}, 0.54,
     [([], [0.545895, 0.822806, 1.549463])] + [([1.414214], [0.547034, 1.475070])] * 2),
    ({"gamma": [1, 0.5], "kappa": [1, 0.5], "load": 1, "contact": ("masses", 1, 2)}, 0.65,
     [([], [0.768260, 1.225103]), ([1.0], [0.840005, 1.939685]), ([0.816497], [0.966637])]),
    ({**EQUAL, "contact": ("base", 1)}, 0.54,
     [([1.0], [0.568719, 0.891203, 1.884247]), ([], [0.568719, 0.891203, 1.884247]),
      ([1.0], [0.572614, 1.202347])]),
    ({"gamma": [1, 1, 1], "kappa": [1, 1, 1], "load": 1, "contact": ("wall", 2)}, 0.61,
     [([1.0], [1.104672, 1.329238, 1.735329]), ([1.0, 1.414214], [1.143878, 1.500469]),
      ([1.414214], [1.143878, 1.500469]), ([1.0, 1.414214], [1.143878, 1.500469])]),
    ({**RIG, "contact": ("wall", 2)}, 0.58,
     [([], [0.865240, 1.611540])] + [([1.453238], [1.524160])] * 2),
    ({**RIG, "contact": ("base", 1)}, 0.6,
     [([1.066697], [0.921366, 1.935415]), ([], [0.921366, 1.935415]), ([1.066697], [1.271009])]),
]  # fmt: skip


@pytest.mark.parametrize(("entry", "low", "expected"), FIRST_HARMONICS)
def test_first_harmonic_points(entry, low, expected):
    """All of them and none twice, each to 1e-13 of a root in 30 digits."""
    compliance, bracket = mp_functions(entry)
    found = features.first_harmonic_points(chain(entry), low, 4.0)
    assert len(found) == len(expected)
    with mp.workdps(30):
        for k, (points, numbers) in enumerate(zip(found, expected, strict=True)):
            for function, roots, printed in zip((compliance, bracket), points, numbers, strict=True):
                assert [round(float(root), 6) for root in roots] == printed
                for root in roots:
                    exact = mp.findroot(lambda r, k=k, function=function: function(k, r), mp.mpf(float(root)))
                    assert abs(root - exact) < 1e-13 * root
    held = chain(entry).modes.held_frequencies()
    np.testing.assert_allclose(found[-1].unchanged, held[held > low], rtol=1e-13)


def test_a_pair_of_roots_that_no_sample_parts():
    """A_3 has two zeros, 5 10^-4 of them apart: it dips below zero between two samples."""
    entry = {
        "gamma": [1.0, 5.94, 1.13, 1.57], "kappa": [1.0, 2.5, 1.66, 5.5], "contact": ("wall", 2), "load": 1,
    }  # fmt: skip
    compliance, _ = mp_functions(entry)
    found = features.first_harmonic_points(chain(entry), 1.8, 1.95)[2].unchanged
    assert found.size == 2
    assert found[1] - found[0] < 1e-3
    with mp.workdps(30):
        for root in found:
            exact = mp.findroot(lambda r: compliance(2, r), mp.mpf(float(root)))
            assert abs(root - exact) < 1e-12


def test_no_friction_at_an_antiresonance_is_no_invariant_point():
    """Load on mass 3 of 4, contact on 1: where mass 4 holds mass 3 still, masses 1 and 2 stand still, too.

    V and V_2 vanish there together, their ratio does not: no root of the brackets with V_k/V.
    """
    entry = {
        "gamma": [1.0, 0.8, 1.3, 0.9], "kappa": [1.0, 1.4, 0.7, 1.1], "contact": ("wall", 1), "load": 3,
    }  # fmt: skip
    system = chain(entry)
    tuned = math.sqrt(1.1 / 0.9)
    assert abs(system.modes.contact_response(np.array([tuned]))[0]) < 1e-14
    for points in (
        features.first_harmonic_invariant_points(system, 2, 0.5, 4.0),
        features.mass_invariant_points(system, 2, 0.5, 4.0),
    ):
        assert np.min(np.abs(points - tuned)) > 1e-3


# The contact held


def test_held_frequencies():
    """Two equal masses, mass 2 held: mass 1 between two springs; and the interlacing of any chain."""
    assert equal_chain(2, contact_masses=[2]).modes.held_frequencies() == pytest.approx([math.sqrt(2.0)])
    system = fm.System(
        contact="between-masses", contact_masses=[2, 4], load_mass=3,
        mass_ratios=[1, 2, 0.5, 1.5], stiffness_ratios=[1, 0.7, 1.3, 0.4],
    )  # fmt: skip
    held, free = system.modes.held_frequencies(), system.modes.w
    assert np.all((free[:-1] <= held) & (held <= free[1:]))
    # beta_stick has its poles there
    ds = fm.boundaries(system, held * (1.0 + 1e-9))
    assert np.all(ds.beta_stick > 1e6)


def test_held_response():
    """T(6.12), (6.14): 1/|1 + kappa - r^2|; T(6.13): where beta_stick is beta."""
    r = np.array([0.3, 1.0, 2.0, 3.0])
    for kappa in (1.0, 0.6):
        two = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, kappa], contact_masses=[2])
        ds = fm.boundaries(two, r)
        np.testing.assert_allclose(ds.held_response[0], 1.0 / np.abs(1.0 + kappa - r**2), rtol=1e-13)
        np.testing.assert_allclose(ds.held_response[1], 0.0, atol=1e-15)
        np.testing.assert_allclose(ds.beta_stick[0], kappa * ds.held_response[0], rtol=1e-13)
    three = equal_chain(3, contact_masses=[2])
    np.testing.assert_allclose(fm.boundaries(three, r).held_response[0], 1.0 / np.abs(2.0 - r**2), rtol=1e-13)
    for beta in (0.7, 3.0):
        ends = [math.sqrt((2.0 * beta - 1.0) / beta), math.sqrt((2.0 * beta + 1.0) / beta)]
        np.testing.assert_allclose(fm.boundaries(three, ends).beta_stick[0], beta, rtol=1e-12)


# The file


def test_boundaries_list_them():
    """Invariant points within the axis, its ends included; padded; no empty variable."""
    system = equal_chain(2, contact_masses=[2])
    points = features.invariant_points(system, 0.3, 3.0)
    ds = fm.boundaries(system, [points[-2], 1.0, points[-1]])
    np.testing.assert_allclose(ds.invariant_point, points[-2:], rtol=1e-13)
    assert ds.dof.values.tolist() == [1, 2]
    assert ds.held_response.dims == ("dof", "r")
    ds = fm.boundaries(system, [0.0, 0.4, 3.0])
    assert ds.mass_invariant_point.dims == ("dof", "mass_invariant")
    for mass in (1, 2):
        row = ds.mass_invariant_point[mass - 1].values
        expected = features.mass_invariant_points(system, mass, 0.4, 3.0)
        np.testing.assert_allclose(row[: expected.size], expected, rtol=1e-13)
        assert np.isnan(row[expected.size :]).all()
    first = features.first_harmonic_points(system, 0.4, 3.0)
    assert ds.invariant_first_harmonic.dims == ("dof", "root")
    for k, points in enumerate(first[:2]):
        row = ds.invariant_first_harmonic[k].values
        np.testing.assert_allclose(row[: points.all.size], points.all, rtol=1e-13)
        assert np.isnan(row[points.all.size :]).all()
    np.testing.assert_allclose(ds.contact_invariant_first_harmonic, first[2].all, rtol=1e-13)
    for r in ([2.0, 3.0], [2.0], [0.0], [0.0, 2.0]):
        ds = fm.boundaries(system, r)
        assert "invariant_point" not in ds
        assert "invariant_first_harmonic" not in ds
        assert "mass_invariant_point" not in ds
    # many near r = 0: the highest are listed
    ds = fm.boundaries(system, [0.0, 1e-3, 1.0, 3.0])
    assert 30 <= ds.invariant_point.size <= 45
    # with damping: none of a mass; with two phases: none of a mass
    assert "mass_invariant_point" not in fm.boundaries(equal_chain(2, damping_ratios=0.1), [0.3, 3.0])
    phases = equal_chain(2, load=[1.0, 1.0j])
    assert "mass_invariant_point" not in fm.boundaries(phases, [0.3, 3.0])
    assert "invariant_point" in fm.boundaries(phases, [0.3, 3.0])
    one = fm.boundaries(fm.System(contact="joined-base-wall"), [0.3, 3.0])
    np.testing.assert_allclose(one.invariant_point, [0.5], rtol=1e-13)
    np.testing.assert_array_equal(one.held_response, [[1.0, 1.0]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: features.high_frequency_limits(fm.System(), 0.5), "mu must be >= 1"),
        (lambda: features.quasi_static_displacement(fm.System(), -1.0), "beta must be >= 0"),
        (lambda: features.peak_amplitudes(fm.System(), -1.0), "beta must be >= 0"),
        (lambda: features.invariant_points(fm.System(), 0.0, 1.0), "low must be > 0"),
        (lambda: features.invariant_points(fm.System(), 1.0, 0.5), "high must be > 1"),
        (lambda: features.invariant_points(fm.System(), 1.0, 2.0, 0), "most must be >= 1"),
        (lambda: features.mass_invariant_points(fm.System(), 2, 0.1, 1.0), "mass must be <= 1"),
        (lambda: features.first_harmonic_invariant_points(fm.System(), 0, 0.1, 1.0), "mass must be >= 1"),
        (lambda: features.first_harmonic_points(fm.System(), 1.0, 0.5), "high must be > 1"),
        (
            lambda: features.mass_invariant_points(equal_chain(2, load=[1.0, 2.0 + 1.0j]), 1, 0.1, 1.0),
            "load must have one phase",
        ),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(fm.InputError, match=message):
        call()

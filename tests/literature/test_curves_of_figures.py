"""Numbers of the thesis's response curves that continuous motion decides, and what its text says of them.

T's are read off figures; beside them stand the exact ones, from 40-digit arithmetic, to the digits given.
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from structures import chain_matrices

import frictionmap as fm
from frictionmap.theory.continuous_motion import inversion_points

BASE = fm.System(contact="joined-base-wall")
TWO = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])


def beta_lim(system, r, mu=1.0):
    return fm.boundaries(system, [r], mu).beta_lim.item()


def highest(function, low, high):
    """Place and value of the one maximum of a function in an interval."""
    found = minimize_scalar(
        lambda x: -function(x), bounds=(low, high), method="bounded", options={"xatol": 1e-10}
    )
    return found.x, -found.fun


def first_harmonic_lag(system, r, beta):
    return -math.degrees(np.angle(fm.continuous_motion(system, r, beta).first_harmonic[0]))


def test_figure_2_4_negative_lag():
    """T line 505, "always increased by friction for r < 1": not below r = 1/2, where U V > 0."""
    motion = fm.continuous_motion(fm.System(), 0.42, 0.1)
    assert math.degrees(motion.phase[0]) == pytest.approx(-7.683, abs=5e-4)
    assert first_harmonic_lag(fm.System(), 0.42, 0.1) == pytest.approx(7.072, abs=5e-4)


def test_figure_3_8_base_wall_at_high_frequency():
    """T line 832: Z -> 1."""
    for beta in (0.5, 2.0):
        assert fm.continuous_motion(BASE, 1e4, beta).contact_amplitude == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize(
    ("beta", "expected"),
    [
        (0.01, 1.4151),
        (0.1, 1.4227),
        (0.2, 1.4308),
        (0.5, 1.4525),
        (0.75, 1.4688),
        (1.0, 1.4844),
        (1.2, 1.4966),
    ],
)
def test_figure_3_7_inversion(beta, expected):
    """T line 844: curves cross between 1.4 and 1.55, X < 1."""
    point = inversion_points(BASE, 1, beta, 1.38, 1.55, 31).item()
    assert point == pytest.approx(expected, abs=5e-5)
    assert fm.continuous_motion(BASE, point, beta).amplitude[0] < 1.0


def hump(beta):
    """Largest amplitude above resonance."""
    low = brentq(lambda r: beta_lim(BASE, r) - beta, 0.9, 1.4)
    return highest(lambda r: fm.continuous_motion(BASE, r, beta).amplitude[0], low, 1.5)


def test_figure_3_14_end_of_the_resonance():
    """T line 944: "no resonance from beta = 1.06": there the hump is as high as the base moves."""
    assert hump(1.05)[1] == pytest.approx(1.01009603, abs=5e-9)
    assert hump(1.06)[1] == pytest.approx(0.99573158, abs=5e-9)
    beta = brentq(lambda beta: hump(beta)[1] - 1.0, 1.05, 1.06, xtol=1e-12)
    assert beta == pytest.approx(1.05695844, abs=5e-9)
    assert hump(beta)[0] == pytest.approx(1.288803, abs=5e-7)


def test_figure_3_14_continuous_from():
    """T line 946: beta > 1.55 becomes continuous after r = 1.5."""
    assert beta_lim(BASE, 1.5) == pytest.approx(1.454803, abs=5e-7)
    assert brentq(lambda r: beta_lim(BASE, r) - 1.55, 1.5, 1.6) == pytest.approx(1.558823, abs=5e-7)


def test_figure_3_15_just_above_the_start_of_sliding():
    """mu = 1.5 and 2, beta = 1: continuous from r = sqrt(mu) on, here 0.001 above it."""
    for mu, expected in ((1.5, 1.09134), (2.0, 0.91650)):
        motion = fm.continuous_motion(BASE, math.sqrt(mu) + 0.001, 1.0)
        assert motion.amplitude[0] == pytest.approx(expected, abs=5e-6)


def test_figure_4_6_harmonics():
    """r = 0.85, beta = 0.2: harmonics 3, 5, 7 in dB re first."""
    sizes = np.abs(fm.continuous_motion(fm.System(), 0.85, 0.2).harmonics(7)[0, 1::2])
    found = 20.0 * np.log10(sizes[1:] / sizes[0])
    np.testing.assert_allclose(found, [-47.138, -61.404, -70.418], rtol=0.0, atol=5e-4)


@pytest.mark.parametrize(
    ("beta", "range_below", "range_above"),
    [
        (0.2, (14.680, 14.752), (165.248, 165.268)),
        (0.4, (29.93, 30.61), (149.394, 149.646)),
        (0.6, (46.49, 49.78), (130.286, None)),
    ],
)
def test_figure_4_8_phases(beta, range_below, range_above):
    """T line 1152: "almost constant", asin(4 beta/pi) = 14.753, 30.617, 49.813 degrees; its section 4.4.1.

    Ranges over 0.65 <= r <= 0.95 and 1.1 <= r <= 2.4; beta = 0.6 comes to its end, 134.158, in stick-slip.
    """
    most = math.degrees(math.asin(4.0 * beta / math.pi))
    assert most == pytest.approx({0.2: 14.753, 0.4: 30.617, 0.6: 49.813}[beta], abs=5e-4)
    for (low, high), (least, greatest), digits in (
        ((0.65, 0.95), range_below, 3 if beta == 0.2 else 2),
        ((1.1, 2.4), range_above, 3),
    ):
        inside = [r for r in np.linspace(low, high, 131) if beta_lim(fm.System(), r) >= beta]
        lags = [first_harmonic_lag(fm.System(), r, beta) for r in inside]
        assert round(min(lags), digits) == least
        assert greatest is None or round(max(lags), digits) == greatest


def test_figure_4_7_range_where_the_first_harmonic_rises():
    """T line 1136: 0.334 to 0.604; and, not in T, the same above r = 1/5 and 1/7."""
    for low, high in ((1 / 3, 0.605257808375), (1 / 5, 0.257099259954), (1 / 7, 0.168635821426)):
        for r, rises in ((low + 1e-3, True), (high - 1e-4, True), (high + 1e-4, False)):
            motion = fm.continuous_motion(fm.System(), r, 0.9 * beta_lim(fm.System(), r))
            assert (abs(motion.first_harmonic[0]) > 1.0 / (1.0 - r**2)) == rises


def test_figure_4_10_inversion():
    """T line 1176: 1.504; r = 1.5063100483872, X = 0.788040718, for any beta."""
    r = 1.5063100483872
    for beta in (0.3, 0.75, 1.4):
        motion = fm.continuous_motion(BASE, r, beta)
        assert abs(motion.first_harmonic[0]) == pytest.approx(0.788040718, abs=5e-10)


def test_figure_6_2_amplitudes_on_the_boundary():
    """T line 1850: beta_lim at the resonances 0.436, 1.765, 0.630."""
    system = fm.System(matrices=chain_matrices([1] * 3, [1] * 3), contact_masses=[2], frequency_scale=1.0)
    found = fm.features.peak_thresholds(system)
    np.testing.assert_allclose(found, [0.436, 1.765, 0.630], rtol=0.0, atol=6e-4)


def test_figure_6_6_crossings_of_the_boundary():
    """T line 2022: beta = 0.2 is continuous over 0.372..0.524, and from 0.559 on all are."""
    edges = [
        brentq(lambda r: beta_lim(TWO, r) - 0.2, *around)
        for around in ((0.36, 0.4), (0.51, 0.53), (0.545, 0.555))
    ]
    np.testing.assert_allclose(edges, [0.378433, 0.523705, 0.550175], rtol=0.0, atol=5e-7)
    for beta, around, expected in (
        (0.4, (0.553, 0.565), 0.558748), (0.6, (0.56, 0.572), 0.566769),
        (0.8, (0.57, 0.59), 0.576989), (0.8, (0.6, 0.618), 0.614941),
    ):  # fmt: skip
        r = brentq(lambda r, beta=beta: beta_lim(TWO, r) - beta, *around)
        assert r == pytest.approx(expected, abs=5e-7)


def test_figure_6_13_time_based_points():
    """T lines 2092, 2132: thresholds 0.485, 1.271; z at 1.450, x1 at 0.828 and 1.549 (monoharmonic)."""
    system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], contact_masses=[2])
    np.testing.assert_allclose(fm.features.peak_thresholds(system), [0.485, 1.271], rtol=0.0, atol=5e-4)
    np.testing.assert_allclose(
        fm.features.invariant_points(system, 0.54, 4.0), [0.543048, 1.449813], atol=5e-7
    )
    found = fm.features.mass_invariant_points(system, 1, 0.6, 4.0)
    np.testing.assert_allclose(found, [0.828219, 1.549362], rtol=0.0, atol=1e-6)


def test_figure_6_23_thresholds():
    """T line 2312: between masses, gamma = kappa = 0.5: 0.785 and 0.393."""
    system = fm.System(
        contact="between-masses", contact_masses=[1, 2], mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 0.5]
    )
    np.testing.assert_allclose(fm.features.peak_thresholds(system), [0.785, 0.393], rtol=0.0, atol=6e-4)


@pytest.mark.parametrize(
    ("zeta", "beta", "at_resonance", "estimate", "peak", "place"),
    [
        (0.01, 0.4, 24.5348625, 24.5331147, 24.5388596, 0.999742),
        (0.1, 0.2, 3.72543970, 3.71630567, 3.75294569, 0.985870),
        (0.1, 0.4, 2.45007380, 2.43261133, 2.49107015, 0.973496),
    ],
)
def test_figures_7_8_and_7_9_peaks(zeta, beta, at_resonance, estimate, peak, place):
    """X at r = 1, T(7.61) there, and the true peak beside it."""
    system = fm.System(damping_ratios=zeta)

    def amplitude(r):
        return fm.continuous_motion(system, r, beta).amplitude[0]

    digits = 5e-8 if zeta < 0.1 else 5e-9
    assert amplitude(1.0) == pytest.approx(at_resonance, abs=digits)
    assert fm.features.peak_amplitudes(system, beta).item() == pytest.approx(estimate, abs=digits)
    r, value = highest(amplitude, 0.95, 1.0)
    assert value == pytest.approx(peak, abs=digits)
    assert r == pytest.approx(place, abs=5e-7)


@pytest.mark.parametrize(
    ("system", "beta"),
    [
        (TWO, 0.4),
        (BASE, 0.8),
        (fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.1), 0.2),
    ],
)
def test_phases_go_on_without_jumps(system, beta):
    """From one r to the next no phase turns by more than 2 pi/3, where the motion stays continuous."""
    r = np.linspace(0.5, 2.5, 801)
    inside = fm.boundaries(system, r).beta_lim.values[0] >= beta
    motions = [fm.continuous_motion(system, x, beta) if ok else None for x, ok in zip(r, inside, strict=True)]
    resonant = np.abs(r[:, np.newaxis] / system.modes.w - 1.0).min(axis=1) < 0.01
    pairs = [
        (a, b)
        for a, b, near in zip(motions[:-1], motions[1:], resonant[:-1] | resonant[1:], strict=True)
        if a is not None and b is not None and not near
    ]
    assert len(pairs) > 300
    for a, b in pairs:
        for one, other in ((a.phase, b.phase), (np.angle(a.first_harmonic), np.angle(b.first_harmonic))):
            turn = np.remainder(other - one + math.pi, math.tau) - math.pi
            assert np.all(np.abs(turn) < 2.0 * math.pi / 3.0)


@pytest.mark.parametrize(
    ("zeta", "stops", "amplitude"),
    [
        (0.0, 4, 0.813277013839),
        (0.001, 4, 0.81573860098),
        (0.01, 4, 0.828549298876),
        (0.05, 2, 0.829667156722),
        (0.1, 2, 0.813341723355),
    ],
)
def test_figure_7_10_stops(zeta, stops, amplitude):
    """r = 0.1, beta = 0.2, mu = 1: damping takes two of the four stops."""
    found = fm.sweep(fm.System(damping_ratios=zeta), 0.1, 0.2)
    assert found["stops_per_cycle"].item() == stops
    assert found["contact_amplitude"].item() == pytest.approx(amplitude, abs=1e-12)

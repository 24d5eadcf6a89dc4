"""Features against the numbers that the thesis prints, and against the curves themselves.

Tolerances: half of the last digit printed.
"""

import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import features


def equal_chain(n, **settings):
    return fm.System(mass_ratios=[1.0] * n, stiffness_ratios=[1.0] * n, **settings)


def test_peak_thresholds():
    """T p. of (2.30), (6.3): 0.785; 6.2.1: 0.436, 1.765, 0.630; 6.3.3: 0.485, 1.271; 6.5.1: 0.785, 0.393."""
    assert features.peak_thresholds(fm.System()) == pytest.approx([math.pi / 4])
    three = equal_chain(3, contact_masses=[2])
    assert np.round(features.peak_thresholds(three), 3).tolist() == [0.436, 1.765, 0.630]
    two = equal_chain(2, contact_masses=[2])
    assert np.round(features.peak_thresholds(two), 3).tolist() == [0.485, 1.271]
    between = fm.System(
        contact="between-masses", contact_masses=[1, 2], mass_ratios=[1, 0.5], stiffness_ratios=[1, 0.5]
    )
    assert np.round(features.peak_thresholds(between), 3).tolist() == [0.785, 0.393]


def test_peak_thresholds_are_beta_lim_at_resonance():
    """Without damping the threshold is the limit of beta_lim at each natural frequency."""
    system = equal_chain(3, contact_masses=[2])
    for w, threshold in zip(system.modes.w, features.peak_thresholds(system), strict=True):
        beta_lim = fm.boundaries(system, [w * (1.0 - 1e-9)]).beta_lim.item()
        assert beta_lim == pytest.approx(threshold, rel=1e-6)


def test_peak_thresholds_with_little_damping():
    """T(7.62) goes over into (6.2)."""
    damped = features.peak_thresholds(fm.System(damping_ratios=1e-6))
    assert damped == pytest.approx([math.pi / 4], rel=1e-6)


def test_high_frequency_limits():
    """T(2.31): 0.537; 6.5.1: 0.179 and 0.333; zero if the load acts elsewhere; r = 10^6 agrees."""
    wall = features.high_frequency_limits(fm.System())
    assert round(wall.beta_lim, 3) == 0.537
    assert wall.beta_stick == 1.0
    between = fm.System(
        contact="between-masses", contact_masses=[1, 2], mass_ratios=[1, 0.5], stiffness_ratios=[1, 0.5]
    )
    limits = features.high_frequency_limits(between)
    assert round(limits.beta_lim, 3) == 0.179
    assert round(limits.beta_stick, 3) == 0.333
    assert features.high_frequency_limits(equal_chain(2, contact_masses=[2])) == (0.0, 0.0)
    base = features.high_frequency_limits(fm.System(contact="joined-base-wall"))
    assert base == (math.inf, math.inf)
    for system, mu in ((fm.System(), 1.0), (fm.System(), 2.0), (between, 1.5)):
        ds = fm.boundaries(system, [1e6], mu)
        limits = features.high_frequency_limits(system, mu)
        assert ds.beta_lim.item() == pytest.approx(limits.beta_lim, rel=1e-9)
        assert ds.beta_stick.item() == pytest.approx(limits.beta_stick, rel=1e-9)


def test_quasi_static_displacement():
    """T 6.3.2: X_10 = X_20 = 1 - beta for the load and the contact on mass 1 of two."""
    np.testing.assert_allclose(features.quasi_static_displacement(equal_chain(2), 0.3), [0.7, 0.7])


def test_invariant_points():
    """T 6.3.2: 0.559 and sqrt(5)/2 = 1.118 (printed 1.123: a slip, it is twice sqrt(5)/4 = 0.559)."""
    points = features.invariant_points(equal_chain(2), 0.5, 2.0)
    assert points[-1] == pytest.approx(math.sqrt(5.0) / 2.0, rel=1e-12)
    assert round(float(points[np.argmin(np.abs(points - 0.559))]), 3) == 0.559
    # T 6.3.3: 1.450 is the largest for mass 2 in contact, load on mass 1
    other = features.invariant_points(equal_chain(2, contact_masses=[2]), 0.5, 2.0)
    assert round(float(other[-1]), 3) == 1.450
    # one mass: R = 1/(2n)
    single = features.invariant_points(fm.System(), 0.09, 2.0)
    np.testing.assert_allclose(single, [1 / 10, 1 / 8, 1 / 6, 1 / 4, 1 / 2], rtol=1e-12)


def test_mass_invariant_points():
    """T 6.3.3: 0.828 and 1.549 are the two largest for mass 1, contact on mass 2, load on mass 1."""
    points = features.mass_invariant_points(equal_chain(2, contact_masses=[2]), 1, 0.5, 3.0)
    assert [round(float(point), 3) for point in points[-2:]] == [0.828, 1.549]


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


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: features.high_frequency_limits(fm.System(), 0.5), "mu must be >= 1"),
        (lambda: features.quasi_static_displacement(fm.System(), -1.0), "beta must be >= 0"),
        (lambda: features.invariant_points(fm.System(), 0.0, 1.0), "low must be > 0"),
        (lambda: features.invariant_points(fm.System(), 1.0, 0.5), "high must be > 1"),
        (lambda: features.mass_invariant_points(fm.System(), 2, 0.1, 1.0), "mass must be <= 1"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(fm.InputError, match=message):
        call()

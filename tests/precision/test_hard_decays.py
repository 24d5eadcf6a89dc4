"""Free decays with gaps, strong damping, much noise and a zero that wanders: estimates against truths."""

import re

import numpy as np
import pytest
from decays import Truth, synthetic

import frictionmap as fm
from frictionmap.identify.signals.turning_points import turning_points
from frictionmap.identify.statistics.correlation import long_inflation

GAP = Truth(3.0, 0.01, 0.5, 10.0, -0.03, 0.1, 200.0, 4.0, 0.03)
HEAVY = Truth(1.2, 0.3, 0.2, 10.0, -0.05, 0.1, 200.0, 5.0, 0.05)
NOISY = Truth(3.13, 0.006, 0.4, 10.0, -0.05, 0.1, 100.0, 3.5, 0.4)
MIXED = Truth(3.086, 0.012, 0.15, 12.0, -0.02, -0.4, 250.0, 6.0, 0.03)
NAMES = ("f_n", "zeta", "x_F")


def assert_true(ds, truth, most=4.5):
    """Residuals as large as the noise, estimates within some standard errors, bounds of mu in order."""
    count = ds.sizes["sample"] - ds.sizes["parameter"]
    # a variance of so many residuals is known to sqrt(2/count)
    assert float(ds.reduced_chi_square) / truth.noise**2 == pytest.approx(1.0, abs=4.5 * np.sqrt(2.0 / count))
    for name in NAMES:
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - getattr(truth, name)) < most * float(one.standard_error), name
    assert float(ds.mu_lower) < float(ds.mu_upper)


# Gaps


def with_gap(begin, length, seed=1):
    time, x = synthetic(GAP, seed, mu=2.0)
    kept = (time < begin) | (time > begin + length)
    return time[kept], x[kept]


@pytest.mark.parametrize("length", [0.35, 0.5, 0.7])
@pytest.mark.parametrize("begin", [0.05, 0.14, 0.28, 0.45, 0.9, 1.2])
def test_a_gap_of_a_cycle_or_more_does_not_change_the_answer(begin, length):
    """The motion lasts 8 half cycles of 1/6 s, so that a gap hides two to four turning points."""
    ds = fm.identify.free_decay(*with_gap(begin, length))
    assert_true(ds, GAP)
    assert float(ds.mu_lower) < 2.0 < float(ds.mu_upper)
    assert "a gap of" in ds.warnings


def test_turning_points_behind_a_gap_are_numbered_as_if_there_were_none():
    """Each is (j + 1/2) half cycles after the one before the record, whatever is hidden."""
    half = 0.5 / (GAP.f_n * np.sqrt(1.0 - GAP.zeta**2))
    for begin in np.arange(0.2, 0.8, 0.05):
        for length in (0.2, 0.4):
            points = turning_points(*with_gap(begin, length))
            since = (points.time - GAP.t0) / half
            expected = np.rint(since).astype(int)
            np.testing.assert_allclose(since, expected, atol=0.1)
            np.testing.assert_array_equal(points.number, expected - expected[0])
            np.testing.assert_array_equal(points.upper, expected % 2 == 0)


def test_the_linear_decrement_counts_the_maxima_in_a_gap():
    """T(4.3): without viscous damping each maximum is 4 x_F below the one before."""
    time, x = synthetic(GAP._replace(zeta=0.0, noise=1e-3), 2)
    kept = (time < 0.4) | (time > 0.85)
    ds = fm.identify.free_decay(time[kept], x[kept])
    # parabolas through seven samples are flatter than cosines: (0.03 w)^2/6 of a mm at the most
    assert float(ds.linear_decrement) == pytest.approx(GAP.x_F, abs=0.01)


def test_a_gap_that_leaves_no_decay_is_named():
    time, x = synthetic(GAP, 1, mu=2.0)
    kept = (time < 0.2) | (time > 1.4)
    with pytest.raises(fm.InputError, match=r"fewer than 3 extrema in .* outside a gap of 1\.2\d* s"):
        fm.identify.free_decay(time[kept], x[kept])


# Strong damping and much noise


@pytest.mark.parametrize("seed", [22, 25])
def test_strong_damping_leaves_the_right_number_of_half_cycles(seed):
    """Other starts end at sums 2.6 times as large, with 6 or 8 half cycles and contradictory bounds of mu."""
    ds = fm.identify.free_decay(*synthetic(HEAVY, seed))
    assert_true(ds, HEAVY)
    assert int(ds.half_cycles) == 3
    assert float(ds.mu_lower) <= 1.0 < float(ds.mu_upper)


def test_the_frequency_is_searched_for_near_that_of_the_turning_points():
    """With zeta = 0.5 the turning points are 13 % slower than the natural frequency, each 0.16 as high."""
    truth = HEAVY._replace(zeta=0.5, x_F=0.01, X0=100.0, noise=0.001, rate=400.0)
    assert_true(fm.identify.free_decay(*synthetic(truth, 3)), truth)


@pytest.mark.parametrize("seed", [10, 34, 41, 68])
def test_intervals_allow_for_a_number_of_half_cycles_that_noise_hides(seed):
    """At 4 % noise 12 half cycles fit a little better than the true 11: x_F is off by 5 to 7 errors."""
    ds = fm.identify.free_decay(*synthetic(NOISY, seed))
    one = ds.sel(parameter="x_F")
    assert float(one.lower) < NOISY.x_F < float(one.upper)
    if int(ds.half_cycles) != 11:
        assert re.search(r"hides the number of half cycles \(12 fit best, .*11", ds.warnings)
    assert float(ds.mu_lower) <= 1.0 < float(ds.mu_upper)


# Not a free decay


def test_two_frequencies_are_no_free_decay():
    time = np.arange(800) / 200.0
    x = np.exp(-0.4 * time) * (8.0 * np.cos(19.0 * time) + 4.0 * np.cos(27.0 * time))
    noise = np.random.default_rng(1).normal(0.0, 0.03, time.size)
    with pytest.raises(fm.InputError, match=re.escape("are far above the noise between samples (0.02")):
        fm.identify.free_decay(time, x + noise)


# A wander of the zero


def wandering(truth, amplitude, seed):
    """A record whose zero follows a sine of 0.13 Hz and any phase; amplitude over the noise."""
    time, x = synthetic(truth, seed)
    phase = np.random.default_rng([seed, 4]).uniform(0.0, 2.0 * np.pi)
    return time, x + amplitude * truth.noise * np.sin(2.0 * np.pi * 0.13 * time + phase)


def test_a_wander_larger_than_the_noise_leaves_the_estimates_right():
    for seed in range(2):
        ds = fm.identify.free_decay(*wandering(MIXED, 3.0, seed))
        assert_true(ds, MIXED)
        assert "low-frequency part" in ds.warnings
        # the wander stays in the residuals, beside the noise
        assert float(ds.residual_rms) > 1.5 * MIXED.noise
        assert float(ds.wander_rms) > 1.0 * MIXED.noise


def test_no_wander_is_found_in_white_noise():
    for seed in range(4):
        ds = fm.identify.free_decay(*synthetic(MIXED, seed))
        assert "wander_terms" not in ds
        assert "is fitted beside the decay" not in ds.warnings


def test_rounding_is_no_wander():
    """Residuals of exact data are rounding of a model with 24 half cycles, and so are correlated."""
    ds = fm.identify.free_decay(*synthetic(MIXED._replace(noise=0.0), 1))
    assert "wander_terms" not in ds
    assert ds.estimate.values[:3] == pytest.approx([MIXED.f_n, MIXED.zeta, MIXED.x_F], rel=1e-9)


@pytest.mark.slow
def test_intervals_hold_the_truth_although_the_zero_wanders():
    """Fewer than 6 of 8 intervals hold it in one of 170 cases; `benchmarks coverage` asks it of 400."""
    held = 0
    for seed in range(8):
        one = fm.identify.free_decay(*wandering(MIXED, 1.0, seed)).sel(parameter="x_F")
        held += bool(one.lower <= MIXED.x_F <= one.upper)
    assert held >= 6


def test_the_likelihood_integrates_the_wander_out():
    """What a polynomial of time adds to the data does not change it."""
    ds = fm.identify.free_decay(*wandering(MIXED, 2.0, 1))
    best = fm.identify.log_likelihood(ds)(ds.estimate.values)
    count, terms = ds.sizes["sample"], int(ds.wander_terms)
    assert terms >= 2
    # the reduced chi square is that of all unknowns, the terms of the wander among them
    expected = -0.5 * (count - 6 - terms) - count * np.log(float(ds.sigma[0]) * np.sqrt(2.0 * np.pi))
    assert best == pytest.approx(expected, abs=1e-4)
    u = 2.0 * (ds.time - ds.time[0]).values / float(ds.time[-1] - ds.time[0]) - 1.0
    shifted = ds.assign(data=ds.data + 0.3 * u + 0.1 * u**2)
    centre = ds.estimate.values + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.1 / 3.0])  # u^2 = 1/3 + 2/3 P_2(u)
    assert fm.identify.log_likelihood(shifted)(centre) == pytest.approx(best, abs=1e-6)


# Correlated residuals


def correlated(c, share, size, seed):
    """White noise and a share of noise that repeats c of the sample before, both of variance 1."""
    rng = np.random.default_rng(seed)
    white, slow = rng.normal(size=(2, size))
    for k in range(1, size):
        slow[k] = c * slow[k - 1] + np.sqrt(1.0 - c**2) * slow[k]
    return white + share * slow


def test_a_slow_part_below_white_noise_is_seen():
    """Its correlations s^2/(1 + s^2) c^k sum up to a time of 1 + 2 s^2/(1 + s^2) c/(1 - c)."""
    share, c = 0.5, 0.95
    expected = np.sqrt(1.0 + 2.0 * share**2 / (1.0 + share**2) * c / (1.0 - c))
    assert long_inflation(correlated(c, share, 20_000, 1)) == pytest.approx(expected, rel=0.15)
    assert long_inflation(correlated(0.0, 0.0, 20_000, 2)) == 1.0
    assert long_inflation(np.zeros(100)) == 1.0


@pytest.mark.parametrize("friction", [1.4, 1.8, 2.0, 2.3, 2.5])
@pytest.mark.parametrize("held", [0.2, 0.5])
def test_two_or_three_half_cycles_after_a_rest(friction, held):
    """Before its release the mass looks like a turning point, at any time."""
    truth = Truth(3.1, 0.01, friction, 9.0, held, 0.5, 300.0, held + 1.0, 0.01)
    for seed in range(3):
        ds = fm.identify.free_decay(*synthetic(truth, seed))
        for name in ("f_n", "zeta", "x_F", "X0"):
            one = ds.sel(parameter=name)
            assert abs(float(one.estimate) - getattr(truth, name)) < 4.5 * float(one.standard_error)
        assert abs(float(ds.estimate.sel(parameter="x_F")) - friction) < 0.1

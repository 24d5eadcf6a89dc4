"""Free decays with noise that is correlated: by the steps of a converter, and in time."""

import numpy as np
import pytest
from decays import Truth, synthetic
from scipy.signal import lfilter
from scipy.stats import binom

import frictionmap as fm
from frictionmap.identify.decay.rounding import rounding_growth, shares
from frictionmap.identify.statistics.coloured import Coloured, coloured_growth, coloured_noise

NAMES = ("f_n", "zeta", "x_F", "X0", "t0", "centre")
STEP = 40.0 / 4096.0  # mm


def fewest(count):
    """Of this number of intervals at 95 %, fewer hold the truth in one of 1,000 cases at the most."""
    return int(binom.ppf(1e-3, count, 0.95))


def drawn(rng):
    """Light decays of 4 s."""
    first = rng.uniform(6.0, 12.0)
    f_n, friction = rng.uniform(1.5, 5.0), first * rng.uniform(0.01, 0.05)
    early = -rng.uniform(0.1, 0.4) / (2.0 * f_n)
    return Truth(
        f_n, 10.0 ** rng.uniform(-2.5, -1.5), friction, first, early, rng.uniform(-0.5, 0.5), 200.0, 4.0, 0.0
    )


def rounded(rng, x):
    """Noise of a tenth of a step, then whole steps."""
    return np.round((x + rng.normal(0.0, 0.1 * STEP, x.size)) / STEP) * STEP


def coloured(rng, x, level=0.04, memory=0.9):
    """Noise of a share of the first amplitude, each sample with 0.9 of the noise of the one before."""
    new = rng.normal(0.0, level * np.abs(x).max() * np.sqrt(1.0 - memory**2), x.size + 300)
    return x + lfilter([1.0], [1.0, -memory], new)[300:]


@pytest.mark.slow
@pytest.mark.parametrize("disturbed", [rounded, coloured])
def test_intervals_have_their_nominal_coverage(disturbed):
    held = np.zeros(len(NAMES), dtype=int)
    for seed in range(40):
        rng = np.random.default_rng([21, seed])
        truth = drawn(rng)
        time, x = synthetic(truth, seed)
        ds = fm.identify.free_decay(time, disturbed(rng, x))
        true = np.array([getattr(truth, name) for name in NAMES])
        held += (ds.lower.values <= true) & (true <= ds.upper.values)
    assert (held >= fewest(40)).all(), dict(zip(NAMES, held.tolist(), strict=True))


@pytest.mark.slow
def test_intervals_of_joint_fits_of_coarse_decays_have_their_nominal_coverage():
    held = 0
    for seed in range(20):
        rng = np.random.default_rng([31, seed])
        truth = drawn(rng)
        pulls = [synthetic(truth._replace(X0=share * truth.X0), seed) for share in (1.0, 0.8)]
        ds = fm.identify.joint([(time, rounded(rng, x)) for time, x in pulls]).sel(parameter="zeta")
        held += float(ds.lower) <= truth.zeta <= float(ds.upper)
    assert held >= fewest(20)


def test_steps_above_the_noise_are_reported():
    rng = np.random.default_rng(1)
    time, x = synthetic(drawn(rng), 1)
    coarse, fine = (
        fm.identify.free_decay(time, rounded(rng, x)),
        fm.identify.free_decay(time, coloured(rng, x)),
    )
    assert "the steps of the converter (0.00977) exceed the noise" in coarse.warnings
    assert "steps of the converter" not in fine.warnings
    assert float(coarse.error_inflation) >= 1.0


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.2, 0.4])
def test_samples_at_one_place_share_what_rounding_leaves(noise):
    """Groups of 400 samples, each at another place between two steps: variances of and within groups."""
    rng = np.random.default_rng(2)
    places = (np.arange(2000.0)[:, np.newaxis] + 0.5) / 2000.0
    wrong = np.round(places + rng.normal(0.0, noise, (2000, 400))) - places
    common, white = shares(1.0, float(np.mean(wrong**2)))
    # the terms left out without noise are 3 % of the variance
    assert np.var(wrong.mean(axis=1)) == pytest.approx(common + white / 400.0, rel=0.05, abs=1e-4)
    assert np.var(wrong, axis=1).mean() == pytest.approx(white, rel=0.05, abs=3e-3)


def test_estimates_allow_for_shared_rounding_errors():
    """The mean of two groups at rest and many moving samples: simulated at random places."""
    rng, step, noise = np.random.default_rng(3), 0.01, 0.001
    shape = np.concatenate((np.zeros(50), np.linspace(0.0, 0.2, 60), np.full(90, 0.2)))
    gains = np.full((1, shape.size), 1.0 / shape.size)
    found, expected = [], []
    for _ in range(3000):
        places = shape + rng.uniform(0.0, step)
        x = np.round((places + rng.normal(0.0, noise, places.size)) / step) * step
        found.append(np.mean(x - places))
        variance = noise**2 + step**2 / 12.0
        by_white = np.sqrt(variance / shape.size)
        expected.append(by_white * rounding_growth(x, places, variance, np.ones(shape.size), gains)[0])
    # rms of 3,000, and of growths that are of groups 20 steps apart, with common errors alike
    assert np.std(found) == pytest.approx(np.mean(expected), rel=0.06)
    assert np.mean(expected) > 5.0 * by_white


# Noise that is correlated in time


def irregular(rng, samples=200):
    time = np.sort(rng.uniform(0.0, 4.0, samples))
    return time, np.column_stack((np.ones(samples), time, np.cos(9.0 * time) * np.exp(-time)))


def covariance(time, noise):
    """V, dense."""
    lags = np.abs(time[:, np.newaxis] - time)
    return noise.variance * (
        (1.0 - noise.share) * np.eye(time.size) + noise.share * np.exp(-lags / noise.time)
    )


@pytest.mark.parametrize(
    "noise", [Coloured(1.0, 0.7, 0.1), Coloured(1.0, 1.0 - 1e-5, 0.5), Coloured(1.0, 0.2, 2.0)]
)
def test_growth_is_that_of_the_dense_covariance(noise):
    time, slopes = irregular(np.random.default_rng(4))
    gains = np.linalg.pinv(slopes)
    grown = np.diag(gains @ covariance(time, noise) @ gains.T) / np.diag(gains @ gains.T)
    np.testing.assert_allclose(coloured_growth(time, slopes, noise), np.sqrt(grown), rtol=1e-9)


def restricted(time, slopes, residual, noise):
    """-2 ln of the restricted likelihood by dense matrices (Harville 1974), up to a constant."""
    V = covariance(time, noise)
    weighted = np.linalg.solve(V, slopes)
    P = np.linalg.inv(V) - weighted @ np.linalg.solve(slopes.T @ weighted, weighted.T)
    logs = np.linalg.slogdet(V)[1] + np.linalg.slogdet(slopes.T @ weighted)[1]
    return logs + residual @ P @ residual


def test_the_noise_found_has_the_largest_restricted_likelihood():
    rng = np.random.default_rng(5)
    time, slopes = irregular(rng)
    true = Coloured(2.0, 0.8, 0.2)
    e = np.linalg.cholesky(covariance(time, true)) @ rng.normal(size=time.size)
    residual = e - slopes @ (np.linalg.pinv(slopes) @ e)
    found = coloured_noise(time, residual, slopes)
    least = restricted(time, slopes, residual, found)
    assert least < restricted(time, slopes, residual, true)
    for name in Coloured._fields[:1] + Coloured._fields[2:]:
        for factor in (0.5, 0.9, 1.1, 2.0):  # the search ends within 0.1 of the least
            other = found._replace(**{name: factor * getattr(found, name)})
            assert restricted(time, slopes, residual, other) > least - 0.1

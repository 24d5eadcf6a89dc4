"""Disturbances of measured channels: gaps, wander of the zero, outliers, a limited range."""

import numpy as np

#: Slow wander of the zero: its frequency [Hz], and its amplitude over the standard deviation of the noise.
WANDER_FREQUENCY, WANDER = 0.13, 0.5

#: Share of the samples that are outliers, and their distance over the standard deviation of the noise.
OUTLIERS, FAR = 0.02, 10.0


def without_gap(time: np.ndarray, begin: float, length: float) -> np.ndarray:
    """Samples outside a gap, bool, shape (samples,)."""
    return (time < begin) | (time > begin + length)


def wander(rng: np.random.Generator, time: np.ndarray, noise: float) -> np.ndarray:
    """Slow motion of the zero at `time` with random phase; its mean is 0, because a mean is part of the
    centre.
    """
    zero = WANDER * noise * np.sin(2.0 * np.pi * (WANDER_FREQUENCY * time + rng.uniform()))
    return zero - np.mean(zero)


def outliers(rng: np.random.Generator, size: int, noise: float | np.ndarray) -> np.ndarray:
    """Errors of the samples that are far off, 0 for the others."""
    far = rng.uniform(size=size) < OUTLIERS
    return np.where(far, FAR * noise * rng.choice([-1.0, 1.0], size), 0.0)


def clipped(x: np.ndarray, centre: float, share: float) -> np.ndarray:
    """Limit the range of a channel on both sides to a share of its largest distance from `centre`."""
    reach = share * np.max(np.abs(x - centre))
    return np.clip(x, centre - reach, centre + reach)

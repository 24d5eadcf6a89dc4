"""Rounding by a coarse converter: samples at one place have one error, and then count as one sample.

A place m with normal noise of standard deviation s, rounded to steps q, has the mean error (Widrow and
Kollar, Quantization Noise, 2008)

    b(m) = sum_k (-1)^k q/(pi k) rho_k sin(2 pi k m/q),   rho_k = exp(-2 (pi k s/q)^2),

which depends on where between two steps it is.  Noise of half a step leaves nothing of it; smaller noise
leaves an error that all samples near one place have in common.  Nothing is known of that place, so over all
places errors have the covariance sum_k a_k cos(2 pi k (m_i - m_j)/q), a_k = (q rho_k/(pi k))^2/2, beside
white noise of the variance s^2 + q^2/12 - sum_k a_k.

Where the mass is at rest, before its release and in the end, all samples have one error.  These get a weight
with which they count as one sample of the variance sum_k a_k.  A moving mass passes many steps, and samples
that it leaves at one place have errors in common at its turning points only.
"""

import numpy as np

from ..signals.turning_points import resolution

#: Terms of the series; those beyond add to 3 % of the variance without noise, to nothing with some noise.
_TERMS = 20

#: Rounding leaves a variance of q^2/12 in moving samples.  A step whose rounding would leave twice as much as
#: there is rounds nothing: exact data.
_SEEN = 0.5

#: Rounding changes little if samples at rest count as nearly as many as they are: all but this share.
_LITTLE = 0.1

#: The mass is at rest while the fitted motion is within this part of a step of the first or the last place.
_AT_REST = 0.5


def common_variances(step: float, variance: float) -> np.ndarray:
    """a_k, shape (terms,), of samples with a variance of which rounding is a part."""
    k = np.arange(1, _TERMS + 1)
    noise = max(variance - step**2 / 12.0, 0.0)
    rho = np.exp(-2.0 * (np.pi * k / step) ** 2 * noise)
    return 0.5 * (step * rho / (np.pi * k)) ** 2


def rounding_weights(x: np.ndarray, places: np.ndarray) -> np.ndarray | None:
    """Weights of the residuals of samples x, fitted by `places`, shape (samples,); None if all are 1."""
    step = resolution(x)
    groups = _at_rest(places, step)
    moving = np.ones(x.size, dtype=bool)
    for group in groups:
        moving[group] = False
    variance = mean_square((places - x)[moving])
    if not 12.0 * variance > _SEEN * step**2 > 0.0:
        return None
    common, white = shares(step, variance)
    if common * max(group.stop - group.start for group in groups) < _LITTLE * white:
        return None
    weights = np.ones(x.size)
    for group in groups:
        weights[group] = np.sqrt(white / (white + common * (group.stop - group.start)))
    return weights


def shares(step: float, variance: float) -> tuple[float, float]:
    """Variance that samples at one place have in common, and the rest, which is white."""
    common = float(common_variances(step, variance).sum())
    return common, max(variance, step**2 / 12.0) - common


def mean_square(residual: np.ndarray) -> float:
    """Mean square of residuals; 0 of none."""
    return float(residual @ residual) / max(residual.size, 1)


def _at_rest(places: np.ndarray, step: float) -> tuple[slice, slice]:
    """Samples before the mass leaves its first place, and after it has come to its last one."""
    left = np.flatnonzero(np.abs(places - places[0]) > _AT_REST * step)
    away = np.flatnonzero(np.abs(places - places[-1]) > _AT_REST * step)
    if not left.size:
        return slice(0, 0), slice(0, places.size)
    return slice(0, int(left[0])), slice(int(away[-1]) + 1, places.size)


def rounding_growth(
    x: np.ndarray, places: np.ndarray, variance: float, weights: np.ndarray, gains: np.ndarray
) -> np.ndarray:
    """Factors of standard errors by errors that samples at one place have in common, shape (unknowns,).

    They are at least 1: how far the noise is below a step is itself an estimate.

    variance : of a moving sample
    gains : shape (unknowns, samples), of each weighted residual in each estimate
    """
    step, of_samples = resolution(x), gains * weights
    found = shares(step, variance)[1] * np.sum(of_samples**2, axis=1)
    for k, one in enumerate(common_variances(step, variance), 1):
        found += one * np.abs(of_samples @ np.exp(2j * np.pi * k * places / step)) ** 2
    return np.sqrt(np.maximum(found / (variance * np.sum(gains**2, axis=1)), 1.0))

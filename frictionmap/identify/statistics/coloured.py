"""Noise that is correlated over many samples, and by how much it makes the errors of least squares larger.

Estimates from n residuals r = (I - J J^+) e see less of slow noise than there is, because the fit follows it.
So the noise is described by two parts, white and with the correlation exp(-|t|/tau), whose shares and tau
have the largest restricted likelihood (Patterson and Thompson, Biometrika 58, 1971): it is that of the
residuals, with what the fit took away allowed for.  The covariance V = (1 - c) I + c K has a factor in O(n)
operations at any times: K^-1 = D^T D with D bidiagonal, V = D^-1 Q D^-T, and Q = (1 - c) D D^T + c I = L L^T
is tridiagonal.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import cholesky_banded, solve_banded
from scipy.optimize import minimize

#: Starting values: shares of the correlated part, and its times in usual steps between samples.
_SHARES, _STEPS = (0.3, 0.9), (1.0, 4.0, 16.0, 64.0)

#: The search ends where log tau and the logit of the share change by less than this, and -2 ln of the
#: likelihood as well: a standard error is where the latter has grown by 1.
_SETTLED = 0.1

#: The logit of the share, and log tau over the length of the record, lie within these bounds: beyond them the
#: noise is white, all of it is correlated, or it is one slow drift.
_MOST_LOGIT, _LONGEST = 12.0, 1.0


class Coloured(NamedTuple):
    """Noise of which a share is correlated like exp(-|t|/time)."""

    variance: float  # of a sample
    share: float
    time: float  # s


class _Factors(NamedTuple):
    """V^-1 = D^T Q^-1 D."""

    diagonal: np.ndarray  # (samples,) of D
    below: np.ndarray  # (samples - 1,) beside it
    root: np.ndarray  # (2, samples) diagonals of L, Q = L L^T


def coloured_noise(time: np.ndarray, residual: np.ndarray, slopes: np.ndarray) -> Coloured:
    """The noise that made the residuals of a fit, by restricted likelihood.

    time, residual : shape (samples,), increasing times [s]
    slopes : shape (samples, unknowns), of what the fit can follow, of full rank
    """
    directions = np.linalg.qr(slopes / np.linalg.norm(slopes, axis=0))[0]  # of the same likelihood
    values = np.column_stack((directions, residual / np.linalg.norm(residual)))
    steps = np.diff(time)
    usual, length = float(np.median(steps)), float(time[-1] - time[0])
    longest = np.log(length / usual) + _LONGEST

    def share_and_time(place: np.ndarray) -> tuple[float, float]:
        logit = float(np.clip(place[0], -_MOST_LOGIT, _MOST_LOGIT))
        return 1.0 / (1.0 + np.exp(-logit)), usual * float(np.exp(np.clip(place[1], -longest, longest)))

    def cost(place: np.ndarray) -> float:
        return _restricted(values, _factors(steps, *share_and_time(place)))[0]

    starts = [np.array([np.log(c / (1.0 - c)), np.log(n)]) for c in _SHARES for n in _STEPS]
    found = minimize(
        cost, min(starts, key=cost), method="Nelder-Mead", options={"xatol": _SETTLED, "fatol": _SETTLED}
    )
    share, tau = share_and_time(found.x)
    variance = _restricted(values, _factors(steps, share, tau))[1] * float(residual @ residual)
    return Coloured(variance, share, tau)


def coloured_growth(time: np.ndarray, slopes: np.ndarray, noise: Coloured) -> np.ndarray:
    """Factors of standard errors against white noise of the same variance, shape (unknowns,).

    time, slopes : see `coloured_noise`
    """
    factors = _factors(np.diff(time), noise.share, noise.time)
    basis, triangle = np.linalg.qr(slopes / np.linalg.norm(slopes, axis=0))
    back = solve_banded((0, 1), np.vstack((np.append(0.0, factors.below), factors.diagonal)), basis)
    of_noise = factors.root[0][:, np.newaxis] * back  # L^T D^-T
    of_noise[:-1] += factors.root[1, :-1, np.newaxis] * back[1:]
    inverse = np.linalg.inv(triangle)
    return np.linalg.norm(inverse @ of_noise.T, axis=1) / np.linalg.norm(inverse, axis=1)


def _restricted(values: np.ndarray, factors: _Factors) -> tuple[float, float]:
    """-2 ln of the restricted likelihood, up to a constant, and the variance of a sample.

    values : shape (samples, unknowns + 1), orthonormal slopes and residuals
    """
    white = factors.diagonal[:, np.newaxis] * values
    white[1:] += factors.below[:, np.newaxis] * values[:-1]
    white = solve_banded((1, 0), factors.root, white)
    log_of_covariance = 2.0 * float(np.log(factors.root[0] / factors.diagonal).sum())
    sizes = np.diag(np.linalg.cholesky(white.T @ white))
    freedom = values.shape[0] - values.shape[1] + 1
    cost = 2.0 * freedom * np.log(sizes[-1]) + log_of_covariance + 2.0 * float(np.log(sizes[:-1]).sum())
    return float(cost), float(sizes[-1]) ** 2 / freedom


def _factors(steps: np.ndarray, share: float, tau: float) -> _Factors:
    """Factors of the covariance of noise of variance 1."""
    size = 1.0 / np.sqrt(-np.expm1(-2.0 * steps / tau))
    diagonal, below = np.append(1.0, size), -np.exp(-steps / tau) * size
    band = np.zeros((2, diagonal.size))
    band[0] = share + (1.0 - share) * diagonal**2
    band[0, 1:] += (1.0 - share) * below**2
    band[1, :-1] = (1.0 - share) * below * diagonal[:-1]
    return _Factors(diagonal, below, cholesky_banded(band, lower=True))

"""Least squares in which outliers have little weight: the cost soft_l1 as squares of other residuals.

With t = r/s the cost 2 s^2 (sqrt(1 + t^2) - 1) is the square of r sqrt(2/(1 + q)), q = sqrt(1 + t^2): within
the scale s it is r^2, far beyond it grows like |r|.  Least squares apply to these residuals,
but the variance is that of an M-estimator (Huber and Ronchetti, Robust Statistics, 2009, ch. 7).
"""

import numpy as np
from scipy.special import erfcx

from .least_squares import Problem, Solution

LOSSES = ("linear", "soft_l1")

#: Median of the modulus of a normal deviate, in standard deviations.
_NORMAL_MEDIAN = 0.6745

#: Mean of t^2/(1 + t^2) of a normal deviate t: 1 - sqrt(pi/2) e^(1/2) erfc(1/sqrt(2)).
_NORMAL_INFLUENCE = 1.0 - float(np.sqrt(0.5 * np.pi) * erfcx(np.sqrt(0.5)))

#: Relative change at which the standard deviation has settled; largest number of steps.
_SETTLED, _STEPS = 1e-6, 200

#: If the leverage of a sample is closer to 1 than this, its residual contains no information about its error.
_UNSEEN = 1e-6


def soften(problem: Problem, scale: float) -> Problem:
    """The problem with residuals beyond `scale` > 0 weighted down."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        plain, slopes = problem.residuals(values)
        q = np.hypot(1.0, plain / scale)
        return plain * np.sqrt(2.0 / (1.0 + q)), slopes * (np.sqrt(0.5 * (1.0 + q)) / q)[:, np.newaxis]

    return problem._replace(residuals=residuals)


def pseudo_residuals(residual: np.ndarray, scale: float) -> np.ndarray:
    """Residuals psi(r)/mean(psi') of pseudo-values, psi = r/sqrt(1 + (r/s)^2).

    Least squares of pseudo-values about the estimate of soft_l1 end at this estimate, and the variance of
    these residuals is that of a sample in its covariance.
    """
    q = np.hypot(1.0, residual / scale)
    return residual / q / float(np.mean(q**-3))


def effective_variance(problem: Problem, best: Solution, scale: float) -> float:
    """The variance of a sample by which the softened slopes give the errors of estimates.

    problem : as it was before it was softened
    """
    return _variance(problem.residuals(best.values)[0], int(problem.free.sum()), scale)


def _variance(plain: np.ndarray, unknowns: int, scale: float) -> float:
    """Effective variance from residuals that are not softened."""
    q = np.hypot(1.0, plain / scale)
    influence, change = plain / q, q**-3
    weight = 0.5 * (1.0 + q) / q**2
    # of few samples: Huber's correction for unknowns that the residuals have followed
    few = 1.0 + unknowns / plain.size * float(np.var(change)) / float(np.mean(change)) ** 2
    spread = float(np.sum(influence**2)) / (plain.size - unknowns)
    return few**2 * spread * float(np.mean(weight)) / float(np.mean(change)) ** 2


def jackknife_growth(problem: Problem, best: Solution, scale: float) -> np.ndarray:
    """HC3 inflation of the standard errors, >= 1, shape (parameters,).

    With A = (J^T diag(psi') J)^-1 and leverages h the covariance A (sum psi_i^2/(1 - h_i)^2 J_i J_i^T) A is
    nearly that by which estimates vary when one sample after another is left out (MacKinnon and White,
    J. Econometrics 29, 1985, HC3).  It allows for tables, in which few samples decide a parameter, and for
    variances that are not alike.

    problem : as it was before it was softened
    """
    plain, slopes = problem.residuals(best.values)
    x = slopes[:, problem.free]
    x = x / np.linalg.norm(x, axis=0)
    q = np.hypot(1.0, plain / scale)
    influence, change = plain / q, q**-3
    inverse = np.linalg.inv(x.T @ (change[:, np.newaxis] * x))
    unseen = 1.0 - change * np.einsum("ij,jk,ik->i", x, inverse, x)
    alone = np.where(unseen > _UNSEEN, influence / np.maximum(unseen, _UNSEEN), 0.0)
    own = np.sum((inverse @ (x * alone[:, np.newaxis]).T) ** 2, axis=1)
    soft = np.sqrt(0.5 * (1.0 + q)) / q
    usual = np.diag(np.linalg.inv(x.T @ (soft[:, np.newaxis] ** 2 * x)))
    usual = usual * _variance(plain, x.shape[1], scale)
    grown = np.ones(problem.free.size)
    grown[problem.free] = np.sqrt(
        np.maximum(np.divide(own, usual, out=np.ones(own.size), where=usual > 0.0), 1.0)
    )
    return grown


def root_mean_square(residual: np.ndarray, freedom: float) -> float:
    """Standard deviation of residuals with the given degrees of freedom."""
    return float(np.sqrt(residual @ residual / freedom))


def usual_size(residual: np.ndarray, freedom: float) -> float:
    """The standard deviation s of residuals with outliers: sum psi(r/s)^2 is that of normal deviates.

    Huber's second proposal, with psi(t) = t/sqrt(1 + t^2) and the given degrees of freedom.
    """
    share = residual.size / freedom
    size = float(np.median(np.abs(residual))) / _NORMAL_MEDIAN * np.sqrt(share)
    for _ in range(_STEPS if size > 0.0 else 0):
        t = residual / size
        change = np.sqrt(share * float(np.mean((t / np.hypot(1.0, t)) ** 2)) / _NORMAL_INFLUENCE)
        size *= change
        if abs(change - 1.0) < _SETTLED:
            break
    return size

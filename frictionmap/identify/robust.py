"""Least squares in which outliers have little weight: the cost soft_l1 as squares of other residuals.

With t = r/s the cost 2 s^2 (sqrt(1 + t^2) - 1) is the square of r sqrt(2/(1 + q)), q = sqrt(1 + t^2): within
the scale s it is r^2, far beyond it grows like |r|.  What holds for least squares holds for these residuals,
but for the variance, which is that of an M-estimator (Huber and Ronchetti, Robust Statistics, 2009, ch. 7).
"""

import numpy as np

from .least_squares import Problem, Solution

LOSSES = ("linear", "soft_l1")

#: Median of the modulus of a normal deviate, in standard deviations.
_NORMAL_MEDIAN = 0.6745


def softened(problem: Problem, scale: float) -> Problem:
    """The problem with little weight of residuals beyond `scale` > 0."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        plain, slopes = problem.residuals(values)
        q = np.hypot(1.0, plain / scale)
        return plain * np.sqrt(2.0 / (1.0 + q)), slopes * (np.sqrt(0.5 * (1.0 + q)) / q)[:, np.newaxis]

    return problem._replace(residuals=residuals)


def effective_variance(problem: Problem, best: Solution, scale: float) -> float:
    """The variance of a sample by which the softened slopes give the errors of estimates.

    problem : as it was before it was softened
    """
    plain = problem.residuals(best.values)[0]
    q = np.hypot(1.0, plain / scale)
    influence, change = plain / q, q**-3
    weight = 0.5 * (1.0 + q) / q**2
    unknowns = int(problem.free.sum())
    # of few samples: Huber's correction for unknowns that the residuals have followed
    few = 1.0 + unknowns / plain.size * float(np.var(change)) / float(np.mean(change)) ** 2
    spread = float(np.sum(influence**2)) / (plain.size - unknowns)
    return few**2 * spread * float(np.mean(weight)) / float(np.mean(change)) ** 2


def root_mean_square(residual: np.ndarray) -> float:
    """The standard deviation of residuals whose mean is zero."""
    return float(np.sqrt(np.mean(residual**2)))


def usual_size(residual: np.ndarray) -> float:
    """The standard deviation of normal deviates whose sizes have the same median, outliers or not."""
    return float(np.median(np.abs(residual))) / _NORMAL_MEDIAN

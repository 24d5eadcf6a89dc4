"""Least squares with a hundred unknowns, most of them of the motion: Levenberg-Marquardt by normal equations.

`statistics.least_squares` takes singular values of all slopes in every step, which are many here.  Normal
equations square the condition, which is 1e6 at most where parameters can be separated.
"""

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from ..statistics.least_squares import Problem, Solution

#: A step that would reduce the sum by less than this share of the variance of a sample moves no unknown by
#: more than a thousandth of its standard error.
_SETTLED = 1e-6

#: Damping over the scaled normal matrix: at first, its change after a step, and where no step helps.
_DAMPING, _CHANGE, _MOST_DAMPED = 1e-3, 5.0, 1e9

#: Least damping after one that left the normal matrix, of unit diagonal, singular to rounding.
_LEAST_DAMPED = 1e-12

#: Reduction of the sum, over the one predicted, beyond which steps may grow.
_AS_PREDICTED = 0.5


def descend(problem: Problem, start: np.ndarray, most: int) -> Solution:
    """The least sum near a start, with no unknown at or below `lowest`; `most`: evaluations."""
    free = np.flatnonzero(problem.free)
    values = np.array(start, dtype=float)
    residual, slopes = problem.residuals(values)
    if not free.size:
        return _solution(values, residual, slopes)
    total, damping = float(residual @ residual), _DAMPING
    normal, gradient, scale = _equations(slopes[:, free], residual)
    for _ in range(most):
        try:
            factors = cho_factor(normal + damping * np.eye(free.size))
        except LinAlgError:  # the data do not separate some unknowns, to rounding: more damping does
            damping = max(damping * _CHANGE, _LEAST_DAMPED)
            continue
        step = -cho_solve(factors, gradient)
        predicted = -float(step @ (2.0 * gradient + normal @ step))
        settled = predicted <= _SETTLED * total / residual.size
        if (settled and damping <= _DAMPING) or damping > _MOST_DAMPED:
            break
        moved = values.copy()
        moved[free] += step / scale
        reduction, found = -np.inf, None
        if (moved[free] > problem.lowest[free]).all():
            found = problem.residuals(moved)
            reduction = total - float(found[0] @ found[0])
        if found is None or not reduction > 0.0:
            damping *= _CHANGE
            continue
        values, (residual, slopes) = moved, found
        total -= reduction
        damping /= _CHANGE if reduction > _AS_PREDICTED * predicted else 1.0
        normal, gradient, scale = _equations(slopes[:, free], residual)
    return _solution(values, residual, slopes)


def _equations(slopes: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """J^T J and J^T r of slopes over their lengths, and these; 1 where nothing depends on an unknown."""
    normal = slopes.T @ slopes
    length = np.sqrt(np.diag(normal))
    scale = np.where(length > 0.0, length, 1.0)
    return normal / np.outer(scale, scale), slopes.T @ residual / scale, scale


def _solution(values: np.ndarray, residual: np.ndarray, slopes: np.ndarray) -> Solution:
    return Solution(values, residual, slopes, np.zeros(values.size, dtype=bool))

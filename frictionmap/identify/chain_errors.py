"""Fits of chains with unknown errors: those of amplitudes and of lags follow from their residuals."""

from collections.abc import Callable

import numpy as np

from .chain_fit import Found, Measured, fit_chain, no_sum, problem
from .least_squares import Problem, minimise
from .robust import root_mean_square, usual_size

#: Errors from residuals are found again and again until they change by less than this share.
_SETTLED, _ROUNDS = 1e-3, 20

#: Solutions whose sums exceed the least one by this factor are not followed.
_HOPELESS = 3.0


def fit_by_residuals(data: Measured, known: np.ndarray) -> tuple[Found, Problem, Measured]:
    """The least sum, weights of amplitudes and of lags by their residuals; the data have these weights."""
    found, task = fit_chain(data, known)
    if not _of_both_kinds(data):
        return found, task, data
    for _ in range(_ROUNDS):
        weighed = _weighed(data, task, found, root_mean_square)
        if np.allclose(weighed.sigma, data.sigma, rtol=_SETTLED, atol=0.0):
            break
        data, task = weighed, problem(weighed, known)
        found = found._replace(best=minimise(task, found.best.values))
    near = [one for one in found.others if one.sum <= _HOPELESS * found.others[0].sum]
    minima = sorted([found.best, *(minimise(task, one.values) for one in near)], key=lambda one: one.sum)
    return found._replace(best=minima[0], others=minima[1:], nothing=no_sum(data)), task, data


def fit_robust_by_residuals(data: Measured, known: np.ndarray) -> tuple[Found, Problem, Measured]:
    """Fit with errors from the residuals, giving little weight to outliers."""
    found, task = fit_chain(data, known)
    for _ in range(2):  # the first errors are those of a fit that outliers pull
        if _of_both_kinds(data):
            data = _weighed(data, task, found, usual_size)
            task = problem(data, known)
        usual = usual_size(task.residuals(found.best.values)[0])
        if usual == 0.0:  # exact data have none
            break
        found, task = fit_chain(data, known, usual)
    return found, task, data


def _weighed(data: Measured, task: Problem, found: Found, size: Callable[[np.ndarray], float]) -> Measured:
    """The data with errors of both kinds in the ratio of their residuals, of exact data as they are.

    size : of some residuals
    """
    residual = task.residuals(found.best.values)[0] * data.sigma
    sizes = np.array([size(residual[~data.is_phase]), size(residual[data.is_phase])])
    if not (sizes > 0.0).all():
        return data
    return data._replace(sigma=sizes[data.is_phase.astype(int)] / size(residual))


def _of_both_kinds(data: Measured) -> bool:
    return bool(data.is_phase.any() and not data.is_phase.all())

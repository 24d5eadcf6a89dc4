"""Fits of chains with unknown errors: those of amplitudes and of lags follow from their residuals."""

from collections.abc import Callable

import numpy as np

from ..statistics.least_squares import Problem, Solution, minimise
from ..statistics.levels import ROUNDS, SETTLED
from ..statistics.robust import root_mean_square, soften, usual_size
from ..statistics.weights import freedom_by_kind
from .fit import HOPELESS, Found, Measured, fit_chain, no_sum, problem

#: In the first rounds all starts are tried.
_SEARCHED = 2


def fit_by_residuals(data: Measured, known: np.ndarray) -> tuple[Found, Problem, Measured]:
    """The least sum, weights of amplitudes and of lags by their residuals; the data have these weights."""
    found, task = fit_chain(data, known)
    if not _has_both_kinds(data):
        return found, task, data
    for _ in range(ROUNDS):
        weighed = _weighed(data, task, found.best, root_mean_square)
        settled = np.allclose(weighed.sigma, data.sigma, rtol=SETTLED, atol=0.0)
        data, task = weighed, problem(weighed, known)
        found = found._replace(best=minimise(task, found.best.values))
        if settled:
            break
    near = [one for one in found.others if one.sum <= HOPELESS * found.others[0].sum]
    minima = sorted([found.best, *(minimise(task, one.values) for one in near)], key=lambda one: one.sum)
    return found._replace(best=minima[0], others=minima[1:], nothing=no_sum(data)), task, data


def fit_robust_by_residuals(data: Measured, known: np.ndarray) -> tuple[Found, Problem, Measured]:
    """Fit with errors from the residuals, giving little weight to outliers."""
    found, task = fit_chain(data, known)
    for round_ in range(ROUNDS):
        weighed = _weighed(data, task, found.best, usual_size) if _has_both_kinds(data) else data
        plain = problem(weighed, known)
        residual, slopes = plain.residuals(found.best.values)
        usual = usual_size(residual, residual.size - np.linalg.matrix_rank(slopes[:, plain.free]))
        if usual == 0.0:  # exact data have none
            break
        settled = np.allclose(weighed.sigma / usual, data.sigma / (found.outliers or np.inf), SETTLED, 0.0)
        data, task = weighed, plain
        if round_ < _SEARCHED:  # the first errors are those of a fit that outliers pull
            found, task = fit_chain(data, known, usual)
        else:
            best = minimise(soften(task, usual), found.best.values)
            found = found._replace(best=best, outliers=usual)
        if settled:
            break
    return found, task, data


def _weighed(data: Measured, task: Problem, best: Solution, size: Callable[..., float]) -> Measured:
    """Weigh amplitudes and lags by the sizes of their residuals; exact data stay as they are.

    size : function of residuals and their degrees of freedom
    """
    residual = task.residuals(best.values)[0] * data.sigma
    kind = data.is_phase.astype(int)
    freedom = freedom_by_kind(best, task.free, kind)
    sizes = np.array([size(residual[kind == k], one) for k, one in enumerate(freedom)])
    if not (sizes > 0.0).all():
        return data
    return data._replace(sigma=sizes[kind] / size(residual, float(freedom.sum())))


def _has_both_kinds(data: Measured) -> bool:
    return bool(data.is_phase.any() and not data.is_phase.all())

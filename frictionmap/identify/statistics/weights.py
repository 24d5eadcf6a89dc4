"""Errors of estimates whose samples are weighted by variances that the same residuals gave.

Several kinds of samples k, such as lags and amplitudes, have an unknown variance each, found from its
residuals with n_k degrees of freedom. With I_k = J_k^T J_k/s_k^2 of the samples of a kind and
P = (sum I_k)^-1, the covariance of estimates, allowing for the scatter of the weights, is
P + 4 P sum_k (I_k - I_k P I_k)/n_k P (Kenward and Roger, Biometrics 53, 1997, for variances alone; of a mean
that is Meier, Biometrics 9, 1953). The part of a kind in the variance of a parameter is
p_k = (P I_k P)_jj/P_jj; that variance has 1/sum_k p_k^2/n_k degrees of freedom (Satterthwaite).
"""

import numpy as np

from .least_squares import Errors, ErrorScaling, Problem, Solution, errors, leverage, unscaled_covariance
from .robust import effective_variance, jackknife_growth


def freedom_by_kind(best: Solution, free: np.ndarray, kind: np.ndarray) -> np.ndarray:
    """Degrees of freedom of the residuals of each kind, >= 1, shape (kinds,).

    free : (parameters,) bool, what was fitted
    kind : (samples,) from 0
    """
    left = 1.0 - leverage(best.slopes[:, free & ~best.at_bound])
    return np.maximum(np.bincount(kind, left), 1.0)


def estimated_weights(
    problem: Problem, best: Solution, kind: np.ndarray, unknown: np.ndarray
) -> ErrorScaling:
    """Factors of the standard errors if the variances of some kinds of samples were estimated.

    kind : (samples,) from 0
    unknown : (kinds,) bool, whether the variance of a kind was estimated
    """
    covariance = unscaled_covariance(problem, best)
    variance = np.where(problem.free, np.diag(covariance), 1.0)
    in_all = best.residual.size - int(problem.free.sum())
    excess, spread = np.zeros(variance.size), np.zeros(variance.size)
    for k, freedom in enumerate(freedom_by_kind(best, problem.free, kind)):
        if unknown[k]:
            slopes = best.slopes[kind == k]
            share = covariance @ (slopes.T @ slopes)  # P I_k
            own = share @ covariance
            excess += np.diag(own - share @ own) / freedom
            spread += (np.diag(own) / variance) ** 2 / freedom
    larger = np.sqrt(1.0 + 4.0 * np.maximum(excess, 0.0) / variance)
    return ErrorScaling(larger, 1.0 / np.maximum(spread, 1.0 / in_all))


def table_errors(
    plain: Problem, task: Problem, best: Solution, kind: np.ndarray, given: np.ndarray, outliers: float | None
) -> tuple[Errors, ErrorScaling, float | None]:
    """Errors of a fit to several kinds of samples, how they were scaled, and the variance if it is known.

    plain : each sample with its full weight; `task` is what was solved
    given : (kinds,) bool, whether the errors of a kind were given
    outliers : residuals beyond this have little weight; None: all count alike
    """
    if outliers is None:
        variance = 1.0 if given.any() else None
        scaling = estimated_weights(task, best, kind, ~given)
    else:
        variance = effective_variance(plain, best, outliers)
        scaling = ErrorScaling(jackknife_growth(plain._replace(free=task.free), best, outliers))
    return errors(task, best, variance, scaling=scaling), scaling, variance

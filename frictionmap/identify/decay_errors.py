"""Errors of a decay: those of the best fit, and of others that the noise cannot distinguish from it.

Where two numbers of half cycles fit alike, the profile of the sum over a parameter is the least one of two
parabolas.  The 95 % interval holds all values at which one of them has grown by no more than is allowed.
"""

import numpy as np

from .correlation import long_inflation
from .decay_fit import Fit, freedom_of, sample_variance
from .decay_problem import Record
from .least_squares import Errors, Solution, errors, inflation, one_sided, two_sided


def decay_errors(record: Record, fits: list[Fit]) -> Errors:
    """Errors of the named parameters; the best fit is the first one."""
    best, each = _of_one(record, fits[0]), [_of_one(record, fit) for fit in fits[1:]]
    allowed = two_sided(freedom_of(record)) ** 2 * sample_variance(record, fits[0]) * best.inflation**2
    lower, upper = best.lower.copy(), best.upper.copy()
    for fit, found in zip(fits[1:], each, strict=True):
        growth = max(fit.solution.sum - fits[0].solution.sum, 0.0)
        if growth < allowed:
            share = np.sqrt(1.0 - growth / allowed)
            values = fit.solution.values[: lower.size]
            lower = np.minimum(lower, values - share * (values - found.lower))
            upper = np.maximum(upper, values + share * (found.upper - values))
    return best._replace(lower=lower, upper=upper)


def decay_solution(record: Record, fit: Fit) -> Solution:
    """The named parameters, and the residuals of the decay alone: a wander of the zero stays in them."""
    named = len(record.names)
    values = fit.solution.values.copy()
    values[named:] = 0.0
    residual, slopes = fit.plain.residuals(values)
    return Solution(values[:named], residual, slopes[:, :named], fit.solution.at_bound[:named])


def _of_one(record: Record, fit: Fit) -> Errors:
    """Errors of one fit; the variance is that of a sample with its full weight."""
    grown, by_lag_1 = long_inflation(fit.solution.residual), inflation(fit.solution.residual)[1]
    variance = (
        sample_variance(record, fit) * (grown / by_lag_1) ** 2
    )  # errors() knows of the lag-1 correlation
    found = errors(fit.problem, fit.solution, variance)
    residual = fit.plain.residuals(fit.solution.values)[0]
    named = slice(len(record.names))
    at_bound = fit.solution.at_bound
    reach = np.where(at_bound, (found.upper - found.lower) / one_sided(freedom_of(record)), 0.0)
    return found._replace(
        # a parabola at a bound gives no more than this; where the sum grows more slowly, its error is larger
        standard_error=np.maximum(found.standard_error, reach)[named],
        lower=found.lower[named],
        upper=found.upper[named],
        correlation=found.correlation[named, named],
        variance=float(residual @ residual) / freedom_of(record),
        inflation=grown,
    )

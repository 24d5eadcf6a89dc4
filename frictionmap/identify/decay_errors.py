"""Errors of a decay: those of the best fit, and of others that the noise cannot distinguish from it.

Where two numbers of half cycles fit alike, a parameter has a profile of the sum that is the least one of several
parabolas.  Its 95 % interval holds all values at which one of them has grown by no more than is allowed.
"""

import numpy as np

from .decay_fit import Fit, sample_variance
from .decay_problem import Record
from .least_squares import Errors, Solution, errors, two_sided


def decay_errors(record: Record, fits: list[Fit]) -> Errors:
    """Errors of the named parameters; the best fit is the first one."""
    each = [_of_one(record, fit) for fit in fits if fit is fits[0] or fit.possible]
    best = each[0]
    freedom = record.time.size - int(record.free.sum())
    allowed = two_sided(freedom) ** 2 * sample_variance(record, fits[0]) * best.inflation**2
    lower, upper = best.lower.copy(), best.upper.copy()
    others = [fit for fit in fits[1:] if fit.possible]
    for fit, found in zip(others, each[1:], strict=True):
        growth = max(fit.solution.sum - fits[0].solution.sum, 0.0)
        if growth < allowed:
            left = np.sqrt(1.0 - growth / allowed)
            values = fit.solution.values[: lower.size]
            lower = np.minimum(lower, values - left * (values - found.lower))
            upper = np.maximum(upper, values + left * (found.upper - values))
    widened = (lower < best.lower) | (upper > best.upper)
    half_width = 0.5 * (upper - lower) / two_sided(freedom)
    standard_error = np.where(widened, np.maximum(best.standard_error, half_width), best.standard_error)
    return best._replace(lower=lower, upper=upper, standard_error=standard_error)


def decay_solution(record: Record, fit: Fit) -> Solution:
    """The named parameters, and the residuals of the decay alone: a wander of the zero stays in them."""
    named = len(record.names)
    values = fit.solution.values.copy()
    values[named:] = 0.0
    residual, slopes = fit.plain.residuals(values)
    return Solution(values[:named], residual, slopes[:, :named], fit.solution.at_bound[:named])


def _of_one(record: Record, fit: Fit) -> Errors:
    """Errors of one fit; the variance is that of a sample with its full weight."""
    found = errors(fit.problem, fit.solution, sample_variance(record, fit))
    residual = fit.plain.residuals(fit.solution.values)[0]
    freedom = residual.size - int(record.free.sum())
    named = slice(len(record.names))
    return found._replace(
        standard_error=found.standard_error[named],
        lower=found.lower[named],
        upper=found.upper[named],
        correlation=found.correlation[named, named],
        variance=float(residual @ residual) / freedom,
    )

"""Errors of a decay: those of the best fit, and of others that the noise cannot distinguish from it.

Where the noise hides the number of half cycles, an interval holds whichever number is right: it reaches from
the least end of the intervals of all numbers that fit alike to the largest one.  The same holds for a slow
wander of the zero that the residuals neither show nor exclude.
"""

import numpy as np

from ..statistics.correlation import long_inflation
from ..statistics.least_squares import Errors, Solution, errors, inflation, one_sided
from .fit import DecayFit, freedom_of, sample_variance
from .problem import Record
from .wander import Search


def decay_errors(found: Search) -> Errors:
    """Errors of the named parameters: intervals of all fits, the rest of the best one."""
    each = [_of_one(found.record, fit) for fit in found.fits]
    if found.doubted is not None:
        each += [_of_one(found.doubted, fit) for fit in found.also]
    lower = np.min([one.lower for one in each], axis=0)
    upper = np.max([one.upper for one in each], axis=0)
    return each[0]._replace(lower=lower, upper=upper)


def decay_solution(record: Record, fit: DecayFit) -> Solution:
    """The named parameters, and the residuals of the decay alone: a wander of the zero stays in them."""
    named = len(record.names)
    values = fit.solution.values.copy()
    values[named:] = 0.0
    residual, slopes = fit.plain.residuals(values)
    return Solution(values[:named], residual, slopes[:, :named], fit.solution.at_bound[:named])


def _of_one(record: Record, fit: DecayFit) -> Errors:
    """Errors of one fit; the variance is that of a sample with its full weight."""
    grown, by_lag_1 = long_inflation(fit.solution.residual), inflation(fit.solution.residual)[1]
    # errors() allows for the lag-1 correlation itself
    variance = sample_variance(record, fit) * (grown / by_lag_1) ** 2
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
        freedom=found.freedom[named],
        correlation=found.correlation[named, named],
        variance=float(residual @ residual) / freedom_of(record),
        inflation=grown,
    )

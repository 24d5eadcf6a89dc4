"""Errors of a decay: those of the best fit, and of others that the noise cannot distinguish from it.

Where the noise hides the number of half cycles, an interval holds whichever number is right: it reaches from
the least end of the intervals of all numbers that fit alike to the largest one.  The same holds for a slow
wander of the zero that the residuals neither show nor exclude.
"""

import numpy as np

from ..statistics.coloured import Coloured, coloured_growth, coloured_noise
from ..statistics.correlation import long_inflation
from ..statistics.least_squares import Errors, ErrorScaling, Noise, Solution, errors, one_sided
from .fit import DecayFit, freedom_of, sample_variance
from .problem import Record
from .rounding import rounding_growth
from .wander import Search

#: Samples for each unknown from which the residuals show what noise there is.
_ENOUGH = 2


def decay_errors(found: Search) -> Errors:
    """Errors of the named parameters: intervals of all fits, the rest of the best one."""
    noise = _coloured(found.record, found.fits[0])
    each = [_fit_errors(found.record, fit, noise) for fit in found.fits]
    if found.doubted is not None:
        each += [_fit_errors(found.doubted, fit, noise) for fit in found.also]
    lower = np.min([one.lower for one in each], axis=0)
    upper = np.max([one.upper for one in each], axis=0)
    return each[0]._replace(lower=lower, upper=upper)


def decay_solution(record: Record, fit: DecayFit) -> Solution:
    """The named parameters, and the residuals of the decay alone: a wander of the zero stays in them."""
    named = len(record.names)
    values = fit.solution.values.copy()
    values[record.steady :] = 0.0
    residual, slopes = fit.plain.residuals(values)
    return Solution(values[:named], residual, slopes[:, :named], fit.solution.at_bound[:named])


def _fit_errors(record: Record, fit: DecayFit, coloured: Coloured | None) -> Errors:
    """Errors of one fit; the variance is that of a sample with its full weight."""
    solution, freedom = fit.solution, freedom_of(record)
    residual = fit.plain.residuals(solution.values)[0]
    noise = Noise(sample_variance(record, fit), np.empty((residual.size, 0)), int(freedom))
    by_time, larger = _growth(record, fit, coloured), np.ones(record.free.size)
    if record.weights is not None:
        free = record.free
        gains = np.linalg.pinv(solution.slopes[:, free])
        larger[free] = rounding_growth(record.x, record.x + residual, noise.variance, record.weights, gains)
    # samples that are correlated in time count as fewer; the errors of rounding are known
    scaling = ErrorScaling(by_time * larger, np.maximum(freedom / by_time**2, 1.0))
    found = errors(fit.problem, solution, noise=noise, scaling=scaling)
    named = slice(len(record.names))
    widths = np.array([one_sided(float(one)) for one in found.freedom])
    reach = np.where(solution.at_bound, (found.upper - found.lower) / widths, 0.0)
    return found._replace(
        # a parabola at a bound gives no more than this; where the sum grows more slowly, its error is larger
        standard_error=np.maximum(found.standard_error, reach)[named],
        lower=found.lower[named],
        upper=found.upper[named],
        freedom=found.freedom[named],
        correlation=found.correlation[named, named],
        variance=float(residual @ residual) / (residual.size - int(record.free.sum())),
        inflation=float(scaling.larger[named].max()),
    )


def _coloured(record: Record, fit: DecayFit) -> Coloured | None:
    """The noise of a fit, if it is correlated in time."""
    moving, solution = record.unweighted, fit.solution
    # of a wander of the zero a polynomial leaves what is faster than a quarter of the decay's frequency
    if record.wander is None and long_inflation(solution.residual[moving]) == 1.0:
        return None
    if np.count_nonzero(moving) < _ENOUGH * np.count_nonzero(record.free):
        return None
    return coloured_noise(
        record.time[moving], solution.residual[moving], solution.slopes[moving][:, record.free]
    )


def _growth(record: Record, fit: DecayFit, noise: Coloured | None) -> np.ndarray:
    """Factors of standard errors by noise that is correlated in time, shape (unknowns,), at least 1."""
    free, moving, solution = record.free, record.unweighted, fit.solution
    larger = np.ones(free.size)
    if noise is not None:
        seen = solution.sum / freedom_of(record)
        grown = coloured_growth(record.time[moving], solution.slopes[moving][:, free], noise)
        larger[free] = np.maximum(grown * np.sqrt(noise.variance / seen), 1.0)
    return larger

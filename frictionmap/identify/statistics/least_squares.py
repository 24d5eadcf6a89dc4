"""Nonlinear least squares with bounds from below, and the errors of what is fitted."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit

#: Residuals and their derivatives by the parameters, shapes (samples,) and (samples, parameters).
Residuals = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]

#: 95 %: two-sided, and one-sided on a bound.
_TWO_SIDED, _ONE_SIDED = 0.975, 0.95

#: Singular values of slopes below this share of the largest are zero: half of all digits.
_RANK = float(np.sqrt(np.finfo(float).eps))

#: Shares of a direction in which no residual changes that are no rounding.
_PART = 1e-4

#: Ends of profiles are found to this share of the standard error.
_PROFILE = 1e-3

#: Standard errors from which a lag-1 correlation is significant.
_COLOURED = 3.0


class Problem(NamedTuple):
    """A least-squares problem."""

    residuals: Residuals
    free: np.ndarray  # shape (parameters,), bool: others are held
    floor: np.ndarray  # what a parameter cannot be below, a little above which the fit may end; -inf: none
    lowest: np.ndarray  # where the model ends, below the floor
    highest: np.ndarray


class Solution(NamedTuple):
    """A least sum of squares."""

    values: np.ndarray  # shape (parameters,)
    residual: np.ndarray  # shape (samples,)
    slopes: np.ndarray  # shape (samples, parameters)
    at_bound: np.ndarray  # shape (parameters,), bool

    @property
    def sum(self) -> float:
        """Sum of squared residuals."""
        return float(self.residual @ self.residual)


class Noise(NamedTuple):
    """Noise with covariance variance * (I + G G^T)."""

    variance: float
    excess: np.ndarray  # G, shape (samples, any number)
    freedom: int  # degrees of freedom by which it is known


class ErrorScaling(NamedTuple):
    """Factors of standard errors, and degrees of freedom, that replace those of the slopes."""

    larger: np.ndarray  # (parameters,) factors of standard errors
    freedom: np.ndarray | None = (
        None  # (parameters,) degrees of freedom of the intervals, if not those of all
    )


class Errors(NamedTuple):
    """Errors of estimates; held parameters have none."""

    standard_error: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    freedom: np.ndarray  # degrees of freedom of the intervals
    correlation: np.ndarray
    variance: float  # reduced chi square: the mean square of residuals, per degree of freedom
    lag_correlation: float
    inflation: float  # of the errors, as residuals are correlated


def minimise(problem: Problem, start: np.ndarray, most: int | None = None) -> Solution:
    """The least sum with no parameter below its bound.

    most : evaluations of a fit that only leads to starting values; by default so many that all fits end

    A parameter below its bound is held there, and the others are fitted again; of several ways to
    hold some of them the least sum wins.
    """
    free_fit = _fit(problem, start, problem.free, most)
    candidates = _below(problem, free_fit)
    if not candidates.any():
        return free_fit
    inside = np.maximum(free_fit.values, problem.floor)
    while True:
        held_fits = [_hold(problem, inside, held, most) for held in _subsets(candidates)]
        valid = [fit for fit in held_fits if not _below(problem, fit).any()]
        if valid:
            return min(valid, key=lambda fit: fit.sum)
        candidates = np.logical_or.reduce([candidates, *(_below(problem, fit) for fit in held_fits)])


def continued_below(problem: Problem) -> Problem:
    """The problem with residuals that go on as straight lines below the floor, where there is no model."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        inside = np.maximum(values, problem.floor)
        residual, slopes = problem.residuals(inside)
        return residual + slopes @ (values - inside), slopes

    return problem._replace(residuals=residuals)


def _below(problem: Problem, fit: Solution) -> np.ndarray:
    """Free parameters below their bounds, bool (parameters,)."""
    return problem.free & (fit.values < problem.floor)


def errors(
    problem: Problem,
    best: Solution,
    known_variance: float | None = None,
    noise: Noise | None = None,
    scaling: ErrorScaling | None = None,
) -> Errors:
    """Standard errors, 95 % intervals and correlations from the slopes at the least sum.

    The variance of a sample is that of the residuals, if it is not known.  Residuals that are correlated
    count as fewer: errors grow by the root of the integrated autocorrelation time, (1 + c)/(1 - c) for the
    lag-1 correlation c, or as `noise` says.  On a bound the interval is one-sided, from the profile of the
    sum.
    """
    free = problem.free
    freedom = best.residual.size - int(free.sum())
    reduced = best.sum / freedom
    variance = reduced if known_variance is None else known_variance
    lag, by_lag = inflation(best.residual)
    grown = np.full(free.size, by_lag)
    inverse = unscaled_covariance(problem, best)
    deviation = np.sqrt(np.diag(inverse))
    if noise is not None:
        variance, freedom = noise.variance, noise.freedom
        inverse, grown = _with_excess(inverse, best.slopes, noise.excess)
    larger, freedoms = grown, np.full(free.size, float(freedom))
    if scaling is not None:
        larger = grown * scaling.larger
        freedoms = freedoms if scaling.freedom is None else scaling.freedom
    standard_error = deviation * np.sqrt(variance) * larger
    scale = np.where(free, deviation * (grown if noise is not None else 1.0), 1.0)
    correlation = np.where(np.eye(free.size, dtype=bool), 1.0, inverse / np.outer(scale, scale))
    reach = half_widths(freedoms) * standard_error
    lower, upper = best.values - reach, best.values + reach
    lower = np.where(free, np.maximum(lower, problem.floor), lower)
    for index in np.flatnonzero(best.at_bound):
        lower[index] = problem.floor[index]
        allowed = (one_sided(float(freedoms[index])) * float(larger[index])) ** 2 * variance
        upper[index], _ = profile_end(problem, best, int(index), allowed, float(standard_error[index]))
    return Errors(standard_error, lower, upper, freedoms, correlation, reduced, lag, float(grown.max()))


def leverage(slopes: np.ndarray) -> np.ndarray:
    """Leverage of each sample, 0 to 1, shape (samples,); the sum is the number of unknowns."""
    length = np.linalg.norm(slopes, axis=0)
    directions, sizes, _ = np.linalg.svd(slopes[:, length > 0.0] / length[length > 0.0], full_matrices=False)
    return np.sum(directions[:, sizes > _RANK * sizes.max(initial=0.0)] ** 2, axis=1)


def growth(problem: Problem, best: Solution, noise: Noise) -> np.ndarray:
    """Factors by which errors exceed those of white noise, shape (parameters,); 1 for held parameters."""
    return _with_excess(unscaled_covariance(problem, best), best.slopes, noise.excess)[1]


def unscaled_covariance(problem: Problem, best: Solution) -> np.ndarray:
    """(J^T J)^-1 of what is free, 0 of what is held, shape (parameters, parameters)."""
    free = problem.free
    inverse = np.zeros((free.size, free.size))
    inverse[np.ix_(free, free)] = _inverse(best.slopes[:, free])
    return inverse


def _with_excess(
    inverse: np.ndarray, slopes: np.ndarray, excess: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(J^T J)^-1 J^T (I + G G^T) J (J^T J)^-1, and by what its deviations are larger than without G."""
    moved = inverse @ (slopes.T @ excess)
    grown = inverse + moved @ moved.T
    plain = np.diag(inverse)
    return grown, np.sqrt(np.divide(np.diag(grown), plain, out=np.ones(plain.size), where=plain > 0.0))


def correlation_of(covariance: np.ndarray) -> np.ndarray:
    """Correlation of what has a covariance; 0 with what is held, whose variance is 0."""
    deviation = np.sqrt(np.diag(covariance))
    scale = np.where(deviation > 0.0, deviation, 1.0)
    return np.where(np.eye(deviation.size, dtype=bool), 1.0, covariance / np.outer(scale, scale))


def half_widths(freedom: np.ndarray) -> np.ndarray:
    """Half the widths of 95 % intervals over the standard errors, by the degrees of freedom of each."""
    return np.asarray(stdtrit(freedom, _TWO_SIDED))


def two_sided(freedom: int) -> float:
    """Half the width of a 95 % interval, over the standard error."""
    return float(half_widths(np.array(freedom)))


def one_sided(freedom: float) -> float:
    """Width of a one-sided 95 % interval, over the standard error."""
    return float(stdtrit(freedom, _ONE_SIDED))


def undetermined(problem: Problem, best: Solution, rank: float = _RANK) -> tuple[np.ndarray, int]:
    """Indices of free parameters that are not identifiable separately, and the rank deficiency.

    The rank of the slopes, each over its length, is that of what the residuals see of the parameters.

    rank : singular values below this share of the largest are zero; more than the errors of the slopes
    """
    free = np.flatnonzero(problem.free & ~best.at_bound)
    slopes = best.slopes[:, free]
    length = np.linalg.norm(slopes, axis=0)
    unseen = length == 0.0
    _, sizes, directions = np.linalg.svd(slopes / np.where(unseen, 1.0, length), full_matrices=False)
    blind = directions[sizes <= rank * sizes[0]]
    taking_part = (np.abs(blind) > _PART).any(axis=0) | unseen
    return free[taking_part], len(blind)


def _fit(problem: Problem, start: np.ndarray, free: np.ndarray, most: int | None = None) -> Solution:
    """The least sum over some parameters, bounds from below not heeded; infinite if there is no model."""
    values = start.astype(float)
    last: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}  # residuals and slopes are asked for one by one

    def at(part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = part.tobytes()
        if key not in last:
            values[free] = part
            found = problem.residuals(values)
            last.clear()
            last[key] = found
        return last[key]

    if free.any():
        inside = np.clip(values[free], problem.lowest[free], problem.highest[free])
        if not np.isfinite(at(inside)[0]).all():
            return _no_model(values, at(inside)[0].size)
        found = least_squares(
            lambda part: at(part)[0],
            inside,
            jac=lambda part: at(part)[1][:, free],
            bounds=(problem.lowest[free], problem.highest[free]),
            method="trf",
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-14,
            gtol=1e-14,
            max_nfev=most,
        )
        values[free] = found.x
    residual, slopes = problem.residuals(values)
    if not np.isfinite(residual).all():
        return _no_model(values, residual.size)
    return Solution(values.copy(), residual, slopes, np.zeros(values.size, dtype=bool))


def _no_model(values: np.ndarray, samples: int) -> Solution:
    """Placeholder for a fit that starts where the model has no finite residuals; its sum is infinite."""
    return Solution(
        values.copy(), np.full(samples, np.inf), np.zeros((samples, values.size)), np.zeros(values.size, bool)
    )


def _hold(problem: Problem, start: np.ndarray, held: np.ndarray, most: int | None) -> Solution:
    fit = _fit(problem, np.where(held, problem.floor, start), problem.free & ~held, most)
    return fit._replace(at_bound=held)


def _at(problem: Problem, start: Solution, index: int, value: float) -> Solution:
    """The least sum with one more parameter held at a value, bounds heeded."""
    free = problem.free.copy()
    free[index] = False
    values = start.values.copy()
    values[index] = value
    return minimise(problem._replace(free=free), values)


def _subsets(candidates: np.ndarray) -> list[np.ndarray]:
    """Every way to choose at least one of the candidates."""
    places = np.flatnonzero(candidates)
    result = []
    for code in range(1, 2**places.size):
        chosen = np.zeros_like(candidates)
        chosen[[place for bit, place in enumerate(places) if code >> bit & 1]] = True
        result.append(chosen)
    return result


def _inverse(slopes: np.ndarray) -> np.ndarray:
    """(J^T J)^-1, by the scaled slopes."""
    scale = np.linalg.norm(slopes, axis=0)
    _, triangle = np.linalg.qr(slopes / scale)
    inverse = np.linalg.inv(triangle)
    return (inverse @ inverse.T) / np.outer(scale, scale)


def inflation(residual: np.ndarray) -> tuple[float, float]:
    """Lag-1 correlation of residuals, and by what it makes errors larger."""
    power = float(residual @ residual)
    lag = float(residual[1:] @ residual[:-1]) / power if power > 0.0 else 0.0
    coloured = lag > _COLOURED / np.sqrt(residual.size)
    return lag, float(np.sqrt((1.0 + lag) / (1.0 - lag))) if coloured else 1.0


def profile_end(
    problem: Problem, best: Solution, index: int, allowed: float, scale: float
) -> tuple[float, Solution]:
    """Upper end of a profile: the value at which the least sum has grown by `allowed`, and the fit there.

    scale : its standard error, in which steps are counted
    """
    begin = float(best.values[index])
    if scale == 0.0:  # data without any noise
        return begin, best

    highest = float(problem.highest[index])
    inside, low, reach = best, begin, scale
    while True:
        high = min(begin + reach, highest)
        found = _at(problem, inside, index, high)
        if found.sum - best.sum > allowed:
            break
        if high == highest:  # where the model ends
            return highest, found
        inside, low, reach = found, high, 2.0 * reach
    while high - low > _PROFILE * scale:  # halved, as there may be no model next to what is allowed
        middle = 0.5 * (low + high)
        found = _at(problem, inside, index, middle)
        if found.sum - best.sum > allowed:
            high = middle
        else:
            inside, low = found, middle
    return high, inside

"""Estimates from a record of any shape: errors, intervals, verdict and warnings."""

from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from ...errors import InputError
from ..statistics.cautions import bound_warnings, correlation_warnings, interval_warnings
from ..statistics.least_squares import Errors, Solution, errors, minimise, two_sided, undetermined
from ..statistics.levels import CHANCE, FOUND
from .fit import CHANCE as GROWTH
from .fit import HistoryFit
from .model import MU, NAMED, NAMES, OFFSET, X_F, ZETA

#: Singular values of scaled slopes below this share of the largest: not identifiable.
_CONDITION = 1e-6

#: Fewest slides that determine friction.
_SLIDES = 3

#: Share of the record at rest beyond which little is left to fit.
_STUCK = 0.7

#: Steps to the end of an interval from its profile, in standard errors, and how near ends are found.
_STEPS, _NEAR = 8, 0.01

#: Chi square within which another minimum is possible as well.
_POSSIBLE = 10.0

#: Longest step along the profile of mu, whose standard error is 0 or without bound where nothing sticks.
_STEP_OF_MU = 0.1

#: Values of mu from which one is looked for that explains a record better than the one that is held.
_STATIC = (1.1, 1.3)

#: Events that are starts from rest.
_START = 2.0

VERDICTS = {
    "no_friction_found": "no friction found",
    "continuous": "friction found, the mass never sticks",
    "stick_slip": "friction found, and the mass sticks and slips",
    "spring_found": "friction found, in a contact with a spring",
    "not_explained": "not explained: residuals exceed the noise, and errors were multiplied for that",
}


class Outcome(NamedTuple):
    """A fit, and what is said about it."""

    fit: HistoryFit
    errors: Errors
    code: str
    condition: float
    warnings: list[str]


def judged(fit: HistoryFit, shown: list[str], given_sigma: bool) -> Outcome:
    """The outcome of a fit.

    given_sigma : whether the noise of x was given
    """
    _check_slides(fit)
    _check_starts(fit)
    _check_identifiable(fit)
    freedom = fit.solution.residual.size - int(fit.problem.free.sum())
    explained = not given_sigma or chdtrc(freedom, fit.solution.sum) >= CHANCE
    found = errors(fit.problem, fit.solution, 1.0 if given_sigma and explained else None)
    words = _warnings(fit, found, shown, bool(explained))
    if np.isnan(fit.held[MU]) and np.isfinite(found.standard_error[MU]):
        found = _with_profile(fit, found, MU)
        words += interval_warnings("mu", 1.0, bool(found.lower[MU] > 1.0))
    if not explained or found.inflation > 1.0:
        words += _static_friction(fit, found)
    found, more = _covering(fit, found)
    code = _code(fit, found, bool(explained))
    return Outcome(fit, found, code, _condition(fit), words + more)


def _static_friction(fit: HistoryFit, found: Errors) -> list[str]:
    """Advise to fit mu that is held, where another one explains the record better.

    The motion has no slope by mu at mu = 1, as it then starts without acceleration: only a descent shows it.
    """
    if fit.given.elastic or np.isnan(fit.held[MU]) or fit.course.stuck == 0.0:
        return []
    free = fit.problem.free.copy()
    free[MU] = True
    starts = np.repeat(fit.solution.values[np.newaxis], len(_STATIC), axis=0)
    starts[:, MU] = _STATIC
    ends = [minimise(fit.problem._replace(free=free), one) for one in starts]
    best = min(ends, key=lambda one: one.sum)
    if not fit.solution.sum - best.sum > FOUND**2 * found.variance:
        return []
    return [
        f"static friction explains the record better, mu {best.values[MU]:.3g} instead of {fit.held[MU]:g}: "
        "name mu in free and omit known.mu"
    ]


def _check_slides(fit: HistoryFit) -> None:
    """Refuse friction from less than three slides, or from slides to one side only."""
    if not np.isnan(fit.held[X_F]):
        return
    slides = slides_of(fit)
    if slides < _SLIDES:
        raise InputError(
            f"cannot fit x_F: the mass slides {slides} times in the record, {_SLIDES} needed; "
            "measure longer, or with more motion"
        )
    phases = fit.course.motion.state[:, -1]
    if not ((phases > 0.0).any() and (phases < 0.0).any()):
        raise InputError(
            "cannot fit x_F: the mass slides to one side only, so that friction and offset act alike; "
            "measure a motion that turns back"
        )


def slides_of(fit: HistoryFit) -> int:
    """Slides of the fitted motion."""
    phases = np.sign(fit.course.motion.state[:, -1])
    begun = int(phases[0] != 0.0)
    events = fit.course.motion.events[: int(fit.course.motion.counts[0]), 2]
    return begun + int(np.sum(events != 0.0))


def _check_starts(fit: HistoryFit) -> None:
    """Refuse mu from a motion in which nothing starts from rest: it acts nowhere else."""
    events = fit.course.motion.events[: int(fit.course.motion.counts[0]), 2]
    if np.isnan(fit.held[MU]) and not (events == _START).any():
        raise InputError(
            "cannot identify mu: not identifiable, as the mass never sticks and starts again in the record; "
            "hold it, known.mu"
        )


def _check_identifiable(fit: HistoryFit) -> None:
    together, deficient = undetermined(fit.problem, fit.solution, _CONDITION)
    names = [NAMES[k] for k in together if k < NAMED]
    if deficient and names:
        raise InputError(
            f"cannot identify {' and '.join(names)} together: not identifiable, as the motion of this record "
            f"depends on them alike; hold one of them, known.{names[-1]}"
        )


def _condition(fit: HistoryFit) -> float:
    """Least over largest singular value of the slopes, each over its length."""
    slopes = fit.solution.slopes[:, fit.problem.free]
    sizes = np.linalg.svd(slopes / np.linalg.norm(slopes, axis=0), compute_uv=False)
    return float(sizes[-1] / sizes[0])


def _held_sum(fit: HistoryFit, index: int, value: float, start: np.ndarray) -> Solution:
    free = fit.problem.free.copy()
    free[index] = False
    values = start.copy()
    values[index] = value
    return minimise(fit.problem._replace(free=free), values)


def _with_profile(fit: HistoryFit, found: Errors, index: int) -> Errors:
    """The interval of a parameter from the growth of the sum."""
    allowed = GROWTH * max(found.variance, 1.0)
    lower, upper = found.lower.copy(), found.upper.copy()
    step = min(float(found.standard_error[index]) or _STEP_OF_MU, _STEP_OF_MU)
    for ends, sense in ((lower, -1.0), (upper, 1.0)):
        ends[index] = _profile_end(fit, index, sense * step, allowed)
    errors_of = found.standard_error.copy()
    if lower[index] <= fit.problem.floor[index]:
        errors_of[index] = np.nan
    return found._replace(lower=lower, upper=upper, standard_error=errors_of)


def _profile_end(fit: HistoryFit, index: int, step: float, allowed: float) -> float:
    """The last value on one side at which the sum has not grown by more than `allowed`."""
    best, floor = float(fit.solution.values[index]), float(fit.problem.floor[index])
    inside, outside, start = best, best, fit.solution.values
    for k in range(1, _STEPS + 1):
        outside = max(best + k * step, floor)
        there = _held_sum(fit, index, outside, start)
        if there.sum - fit.solution.sum > allowed:
            break
        inside, start = outside, there.values
        if outside == floor:
            return floor
    else:
        return float(max(np.copysign(np.inf, step), floor))
    while abs(outside - inside) > _NEAR * abs(step):
        middle = 0.5 * (inside + outside)
        there = _held_sum(fit, index, middle, start)
        if there.sum - fit.solution.sum > allowed:
            outside = middle
        else:
            inside = middle
    return inside


def _covering(fit: HistoryFit, found: Errors) -> tuple[Errors, list[str]]:
    """Intervals that cover the other minima that are possible."""
    lower, upper, count = found.lower.copy(), found.upper.copy(), 0
    for other in fit.others:
        there = minimise(fit.problem, np.where(np.isnan(fit.held), other.values, fit.held))
        far = np.abs(there.values - fit.solution.values) > found.standard_error
        if there.sum - fit.solution.sum > _POSSIBLE or not far[fit.problem.free].any():
            continue
        reach = two_sided(int(found.freedom.max())) * found.standard_error
        lower = np.fmin(lower, there.values - reach)
        upper = np.fmax(upper, there.values + reach)
        count += 1
    words = [f"{count} other minima explain the record as well: intervals cover them"] if count else []
    return found._replace(lower=lower, upper=upper), words


def _code(fit: HistoryFit, found: Errors, explained: bool) -> str:
    friction, error = float(fit.solution.values[X_F]), float(found.standard_error[X_F])
    if not explained:
        return "not_explained"
    if friction <= FOUND * error:
        return "no_friction_found"
    if fit.given.elastic:
        return "spring_found"
    return "stick_slip" if fit.course.stuck > 0.0 else "continuous"


def _warnings(fit: HistoryFit, found: Errors, shown: list[str], explained: bool) -> list[str]:
    words = []
    if not explained:
        words.append(
            f"the model does not explain the record down to the noise: reduced chi square "
            f"{found.variance:.3g}, standard errors were multiplied by {np.sqrt(found.variance):.3g}"
        )
    if found.inflation > 1.0:
        words.append(
            f"residuals are correlated ({found.lag_correlation:.2f}): standard errors were multiplied by "
            f"{found.inflation:.3g}"
        )
    k = [NAMES.index(name) for name in shown]
    words += correlation_warnings(shown, found.correlation[np.ix_(k, k)])
    words += bound_warnings(shown, fit.problem.floor[k], fit.solution.at_bound[k])
    if fit.solution.values[X_F] <= found.standard_error[X_F] and np.isnan(fit.held[X_F]):
        words.append("x_F is 0 within its error: check the signs of both channels if friction is there")
    if not fit.given.elastic and fit.course.stuck > _STUCK:
        words.append(f"the mass sticks in {fit.course.stuck:.0%} of the record: little of it shows friction")
    if fit.solution.at_bound[ZETA]:
        words.append("zeta is 0: friction may stand for damping")
    if fit.given.order == 0 and not np.isnan(fit.held[OFFSET]) and fit.held[OFFSET] == 0.0:
        words.append("offset_x is held at 0")
    return words

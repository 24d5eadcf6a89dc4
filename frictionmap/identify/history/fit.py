"""The fit of a motion to a record: its minima, samples beside events, the noise of the drive."""

from itertools import product
from typing import NamedTuple

import numpy as np

from ..statistics.least_squares import Problem, Solution, minimise
from .drive import noise_above_band
from .model import MU, SPEED, STATE_OF_SPRING, X_F, Course, Measured, Model
from .problem import Whitening, beside_events, problem_of, white, with_drive, within_reach
from .starts import best_minima

#: Growth of chi square that one more unknown makes up for in 95 of 100 cases.
CHANCE = 3.84

#: Forces of a spring at the beginning, over x_F: a descent keeps the sign.
_SPRING_STARTS = (-0.9, -0.45, 0.0, 0.45, 0.9)

#: Friction and mu beside the least sum, where its neighbours are minima as well.
_CLOSE = (0.98, 1.0, 1.02), (-0.04, 0.0, 0.04)

#: How often samples beside events are chosen again, and the covariance is renewed.
_MASKED, _RENEWED = 3, 2

#: Standard deviations of chi square beyond which a record is not explained.
_UNEXPLAINED = 4.0

#: Minima whose chi square is larger by less than this are possible as well.
_POSSIBLE = 10.0

#: Minima are different if a parameter differs by this many standard errors of a sample's worth: by more than
#: descents that end at the same minimum do.
_DIFFERENT = 1e-3


class Noise(NamedTuple):
    """Standard deviations of noise, in the units of the model; None: from the record."""

    sigma_x: float | None
    sigma_drive: float | None
    mask: int  # samples left out on either side of events


class HistoryFit(NamedTuple):
    """The least sum, and what belongs to it."""

    model: Model
    held: np.ndarray
    problem: Problem
    solution: Solution
    whitening: Whitening
    course: Course
    others: list[Solution]  # minima that are possible as well, without the noise of the drive
    sigma_drive: float

    @property
    def given(self) -> Measured:
        """The record."""
        return self.model.given


def fit_history(given: Measured, held: np.ndarray, noise: Noise) -> HistoryFit:
    """Fit a record."""
    model = Model(given)
    minima = best_minima(model, held)
    best = minima[0]
    if given.elastic and np.isnan(held[STATE_OF_SPRING]):
        best = _with_spring_states(model, held, best)
    keep, best = _masked(model, held, best, noise.mask)
    held, best = _at_rest(model, held, best, keep)
    sigma = noise.sigma_x or float(np.sqrt(best.sum / (keep.size - np.isnan(held).sum())))
    others = _possible(minima, best, sigma)
    whitening = white(keep, sigma)
    drive = noise.sigma_drive
    drive = noise_above_band(given.drive.values) if drive is None else drive
    if drive > 0.0:
        whitening, best = _with_drive_noise(model, held, keep, (noise.sigma_x, drive), [best, *minima])
    problem = problem_of(model, held, whitening)
    best = minimise(problem, best.values) if drive == 0.0 else best
    if np.isnan(held[MU]):
        best = min([best, *(minimise(problem, one) for one in _close(held, best))], key=lambda one: one.sum)
    course = model.course(best.values)
    return HistoryFit(model, held, problem, best, whitening, course, others, drive)


def _with_drive_noise(
    model: Model,
    held: np.ndarray,
    keep: np.ndarray,
    sigmas: tuple[float | None, float],
    minima: list[Solution],
) -> tuple[Whitening, Solution]:
    """The least sum with the noise of the drive, and its covariance.

    The least of the `minima` without that noise, the first, may lie beside the least with it.  Where the
    record is not explained from there, the descent begins from the others too, and beside it.

    sigmas : of the mass, None: from the record; of the drive
    """
    best = minima[0]

    def renewed() -> tuple[Whitening, Problem]:
        whitening = with_drive(model, model.course(best.values), keep, *sigmas)
        return whitening, problem_of(model, held, whitening)

    for _ in range(_RENEWED):
        whitening, problem = renewed()
        best = minimise(problem, best.values)
    for _ in range(_RENEWED):
        if best.sum <= keep.size + _UNEXPLAINED * np.sqrt(2.0 * keep.size):
            break
        starts = [*(one.values for one in minima[1:]), *_neighbours(held, best)]
        least = min((minimise(problem, one) for one in starts), key=lambda one: one.sum)
        if not best.sum - least.sum > CHANCE:
            break
        best = least
        whitening, problem = renewed()
        best = minimise(problem, best.values)
    return whitening, best


def _neighbours(held: np.ndarray, best: Solution) -> list[np.ndarray]:
    """Starts with the other frictions beside the least sum."""
    return [one for one in _close(held, best) if one[X_F] != best.values[X_F] and one[MU] == best.values[MU]]


def _with_spring_states(model: Model, held: np.ndarray, best: Solution) -> Solution:
    problem = problem_of(model, held, white(within_reach(model.given, held), 1.0))
    found = [best]
    for state in _SPRING_STARTS:
        start = best.values.copy()
        start[STATE_OF_SPRING] = state
        found.append(minimise(problem, start))
    return min(found, key=lambda one: one.sum)


def _masked(model: Model, held: np.ndarray, best: Solution, mask: int) -> tuple[np.ndarray, Solution]:
    """Samples that count, and the least sum with these."""
    keep = within_reach(model.given, held)
    if not mask:
        return keep, best
    for _ in range(_MASKED):
        free = beside_events(model.course(best.values), model.given, mask)
        keep = within_reach(model.given, held)
        keep = keep[free[keep]]
        best = minimise(problem_of(model, held, white(keep, 1.0)), best.values)
    return keep, best


def _at_rest(model: Model, held: np.ndarray, best: Solution, keep: np.ndarray) -> tuple[np.ndarray, Solution]:
    """Hold the speed at the beginning at 0 if that explains the record as well."""
    resting = held.copy()
    resting[SPEED] = 0.0
    start = best.values.copy()
    start[SPEED] = 0.0
    found = minimise(problem_of(model, resting, white(keep, 1.0)), start)
    variance = best.sum / keep.size
    if not np.isnan(held[SPEED]) or found.sum - best.sum < CHANCE * variance:
        return resting, found
    return held, best


def _possible(minima: list[Solution], best: Solution, sigma: float) -> list[Solution]:
    """Other minima that the record does not exclude."""
    least = min(best.sum, minima[0].sum)
    result: list[Solution] = []
    for one in minima[1:]:
        near = (one.sum - least) / sigma**2 < _POSSIBLE
        if near and all(_differ(one, other) for other in (minima[0], *result)):
            result.append(one)
    return result


def _differ(one: Solution, other: Solution) -> bool:
    return abs(float(one.values[X_F] - other.values[X_F])) > _DIFFERENT * abs(float(other.values[X_F]))


def _close(held: np.ndarray, best: Solution) -> list[np.ndarray]:
    """Starts beside the least sum."""
    result = []
    for factor, step in product(*_CLOSE):
        start = best.values.copy()
        start[X_F] *= factor if np.isnan(held[X_F]) else 1.0
        start[MU] = max(start[MU] + step, 1.0)
        result.append(start)
    return result

"""Least squares of a record on the motion, with the noise of the drive as covariance of the residuals."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular
from scipy.optimize import minimize_scalar

from ..parameters import STIFFEST
from ..statistics.least_squares import Problem
from .model import (
    DELAY,
    F_N,
    GAIN,
    MU,
    NAMES,
    SPRING,
    STATE_OF_SPRING,
    STIFFNESS,
    X_F,
    ZETA,
    Course,
    Measured,
    Model,
)

#: Sampling steps by which the drive may be read earlier or later.
_MOST_STEPS = 5

#: Widest search for the noise of the mass, as a factor of the residuals' size.
_RANGE = 1e3


class Whitening(NamedTuple):
    """What makes the residuals of the samples that count independent, with variance 1."""

    keep: np.ndarray  # samples that count
    triangle: np.ndarray | None  # L of C = L L^T; None: all have the variance sigma_x^2
    sigma_x: float
    share: float  # of the drive in the variance

    def over(self, values: np.ndarray) -> np.ndarray:
        """Residuals or slopes of the samples that count, over the noise."""
        if self.triangle is None:
            return values / self.sigma_x
        return np.asarray(solve_triangular(self.triangle, values, lower=True, check_finite=False))


def white(keep: np.ndarray, sigma: float) -> Whitening:
    """Residuals of one size, independent."""
    return Whitening(keep, None, sigma, 0.0)


def with_drive(
    model: Model, course: Course, keep: np.ndarray, sigma_x: float | None, sigma_drive: float
) -> Whitening:
    """The covariance (H2) of the residuals; sigma_x of the largest likelihood if it is not given."""
    through = model.by_drive(course)[keep] * sigma_drive
    square = through @ through.T
    if sigma_x is None:
        sigma_x = _likely((course.x - model.given.x)[keep], square)
    mean = float(np.trace(square)) / keep.size
    triangle = cholesky(square + sigma_x**2 * np.eye(keep.size), lower=True, check_finite=False)
    return Whitening(keep, triangle, sigma_x, mean / (mean + sigma_x**2))


def _likely(residual: np.ndarray, square: np.ndarray) -> float:
    """The sigma_x at which residuals are most likely beside a covariance."""
    sizes, directions = eigh(square, check_finite=False)
    parts = (directions.T @ residual) ** 2

    def cost(log: float) -> float:
        every = np.maximum(sizes, 0.0) + np.exp(2.0 * log)
        return float(np.sum(np.log(every) + parts / every))

    top = float(np.log(np.sqrt(np.mean(residual**2))))
    found = minimize_scalar(cost, bounds=(top - np.log(_RANGE), top), method="bounded")
    return float(np.exp(found.x))


def frequencies(time: np.ndarray) -> tuple[float, float]:
    """Natural frequencies [Hz] that a record can show: a fifth of a cycle in it, two samples per cycle."""
    return 0.2 / float(time[-1] - time[0]), 0.5 / float(np.median(np.diff(time)))


def within_reach(given: Measured, held: np.ndarray) -> np.ndarray:
    """Samples that can be compared with the motion, wherever the drive is read."""
    far = longest_delay(given, held)
    time = given.drive.time
    return np.flatnonzero((given.time - far >= time[0]) & (given.time + far <= time[-1]))


def longest_delay(given: Measured, held: np.ndarray) -> float:
    """The largest delay to either side."""
    if not np.isnan(held[DELAY]):
        return abs(float(held[DELAY]))
    return _MOST_STEPS * float(np.median(np.diff(given.time)))


def beside_events(course: Course, given: Measured, steps: int) -> np.ndarray:
    """Samples that are not among the `steps` before or after an event, bool."""
    keep = np.ones(given.time.size, dtype=bool)
    clock = given.time - given.drive.time[0] - course.values[DELAY]
    after = np.searchsorted(clock, course.event_times)
    for k in range(-steps, steps):
        keep[np.clip(after + k, 0, keep.size - 1)] = False
    return keep


def problem_of(model: Model, held: np.ndarray, whitening: Whitening) -> Problem:
    """Residuals of a record by all parameters; held ones are not NaN."""
    given = model.given

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        course = model.course(values)
        keep = whitening.keep
        if not course.resolved:
            return np.full(keep.size, np.inf), np.zeros((keep.size, values.size))
        both = np.column_stack((course.x - given.x, course.slopes))[keep]
        both = whitening.over(both)
        return both[:, 0], both[:, 1:]

    floor, lowest, highest = (np.full(len(NAMES), edge) for edge in (-np.inf, -np.inf, np.inf))
    floor[[ZETA, MU]] = 0.0, 1.0
    lowest[[ZETA, MU, X_F, STATE_OF_SPRING]] = -0.2, 1.0, 0.0, -1.0
    lowest[[SPRING, STIFFNESS, GAIN]] = 1e-9  # above 0
    highest[[ZETA, STATE_OF_SPRING, SPRING]] = 2.0, 1.0, 1.0 / STIFFEST
    lowest[F_N], highest[F_N] = frequencies(given.time)
    far = longest_delay(given, held)
    lowest[DELAY], highest[DELAY] = -far, far
    return Problem(residuals, np.isnan(held), floor, lowest, highest)

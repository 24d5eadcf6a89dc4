"""The steady motion nearest to all samples of a record.

The base is measured, too: errors b of its harmonics, with covariance B, move the motion by J_b b, and the
residuals are correlated by that, s^2 V = s^2 I + J_b B J_b^T.  The least sum is that of V^(-1/2) times the
residuals: the most likely motion and base together, with b eliminated.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from .least_squares import Problem, Solution, minimise
from .phasors import Phasors
from .record_motion import (
    F_N,
    FLOOR,
    MU,
    PARAMETERS,
    Motion,
    Shaken,
    base_slopes,
    inner,
    motion,
    outer,
    places_and_slopes,
    shaken,
)
from .record_starts import starts

#: Starts that are followed, on so many samples; the best one goes on with all.
_FOLLOWED = 4
_SAMPLES = 600

#: The natural frequency lies within this factor of a start.
_RANGE = 1.5

#: Where straight lines go on below the floors, and where motions end: f_n apart.
_BELOW = np.array([0.0, -0.5, -np.inf, -1.0, -np.inf])
_HIGHEST = np.array([0.0, 10.0, np.inf, 16.0, np.inf])


#: Growth of the sum, over the variance of a sample, that one more unknown makes up for in 95 of 100 cases.
_CHANCE = 3.84


class Whitening(NamedTuple):
    """V^(-1/2) = I - U diag(shrink) U^T."""

    directions: np.ndarray  # U, shape (samples, harmonics)
    shrink: np.ndarray

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """V^(-1/2) times residuals or slopes."""
        along = (self.directions.T @ values).T * self.shrink
        return values - self.directions @ along.T


class Fit(NamedTuple):
    """A steady motion; the solution is in what is fitted, see `inner`, and its residuals are whitened."""

    mass: Shaken
    problem: Problem
    solution: Solution
    whitening: Whitening
    by_base: np.ndarray  # J_b, shape (samples, harmonics): real parts, then imaginary ones
    motion: Motion
    mu_told: bool  # False: it was free, but the mass never sticks

    @property
    def values(self) -> np.ndarray:
        """The parameters."""
        return outer(self.solution.values)


def fit_record(
    contact: str, damping_reference: str, phasors: Phasors, samples: np.ndarray, known: Mapping[str, float]
) -> Fit:
    """The least sum over all samples.

    samples : shape (samples, 2), times [s] and displacements
    """
    few = samples[:: max(1, samples.shape[0] // _SAMPLES)]
    free = _free(known)
    coarse = shaken(contact, damping_reference, phasors, few[:, 0])
    near = _nearest(coarse, few[:, 1], phasors, known)
    if free[MU]:  # near mu = 1 the motion hardly tells mu, and other parameters lead astray with it
        simple = _nearest(coarse, few[:, 1], phasors, {**known, "mu": 1.0})
        near = min(near, simple, key=lambda found: found.sum)
    mass = shaken(contact, damping_reference, phasors, samples[:, 0])
    by_base = base_slopes(mass, outer(near.values))
    whitening = _whitening(by_base, base_errors(mass, phasors), np.sqrt(near.sum / few.shape[0]))
    problem = _problem(mass, samples[:, 1], free, near.values, whitening)
    solution = minimise(problem, near.values)
    found = motion(mass, outer(solution.values))
    mu_told = True
    if free[MU]:
        without = problem._replace(free=free & (np.arange(free.size) != MU))
        begin = solution.values if found.stops == 0 else simple.values
        plain = minimise(without, np.where(np.arange(free.size) == MU, 0.0, begin))
        slides = motion(mass, outer(plain.values))
        # a motion that never sticks, in which mu has no part, and chance may have made it the farther one
        mu_told = slides.stops > 0 or plain.sum > solution.sum * (1.0 + _CHANCE / samples.shape[0])
        if not mu_told:
            problem, solution, found = without, plain, slides
    return Fit(mass, problem, solution, whitening, by_base, found, mu_told)


def _nearest(mass: Shaken, x: np.ndarray, phasors: Phasors, known: Mapping[str, float]) -> Solution:
    """The least sum from several starts."""
    free = _free(known)
    candidates = starts(mass.contact, mass.damping_reference, phasors, known)[:_FOLLOWED]
    problems = [(_problem(mass, x, free, inner(start)), inner(start)) for start in candidates]
    return min((minimise(_within(task), start) for task, start in problems), key=lambda found: found.sum)


def _free(known: Mapping[str, float]) -> np.ndarray:
    return np.array([name not in known for name in PARAMETERS])


def places_at(fit: Fit, phasors: Phasors, time: np.ndarray) -> np.ndarray:
    """The fitted motion at other times."""
    mass = shaken(fit.mass.contact, fit.mass.damping_reference, phasors, time)
    return motion(mass, fit.values).places


def _within(problem: Problem) -> Problem:
    """The same with no straight line below the floors: a fit that ends near them will do for a start."""
    return problem._replace(lowest=np.maximum(problem.lowest, FLOOR))


def base_errors(mass: Shaken, phasors: Phasors) -> np.ndarray:
    """Standard errors of the base's harmonics: of the real parts, then of the imaginary ones."""
    return np.tile(phasors.errors[0, : mass.base.size], 2)


def _whitening(by_base: np.ndarray, errors: np.ndarray, scatter: float) -> Whitening:
    """V^(-1/2), for residuals that scatter by that much on their own."""
    if scatter == 0.0:  # samples without any noise
        return Whitening(by_base[:, :0], errors[:0])
    directions, sizes, _ = np.linalg.svd(by_base * (errors / scatter), full_matrices=False)
    return Whitening(directions, 1.0 - 1.0 / np.hypot(1.0, sizes))


def _problem(
    mass: Shaken, x: np.ndarray, free: np.ndarray, start: np.ndarray, whitening: Whitening | None = None
) -> Problem:
    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        places, slopes = places_and_slopes(mass, values, free)
        if whitening is None:
            return places - x, slopes
        return whitening(places - x), whitening(slopes)

    lowest, highest = _BELOW.copy(), _HIGHEST.copy()
    lowest[F_N], highest[F_N] = start[F_N] / _RANGE, start[F_N] * _RANGE
    return Problem(residuals, free, FLOOR, lowest, highest)

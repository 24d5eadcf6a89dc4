"""Initial estimates: the record has many minima, so that the descent begins at many places."""

from itertools import product

import numpy as np

from ..statistics.least_squares import Problem, Solution, minimise
from .model import F_N, GAIN, MU, NAMES, OFFSET, PLACE, SPEED, SPRING, STIFFNESS, X_F, ZETA, Model
from .problem import problem_of, white, within_reach

#: Factors of the frequency of the motion without friction.
_FREQUENCIES = (0.8, 0.9, 1.0, 1.1, 1.25)

#: Friction, over the standard deviation of the displacement.
_FRICTIONS = (0.05, 0.15, 0.3, 0.6, 1.0, 1.6)

_MU, _SPRINGS = 1.1, (1.0, 4.0, 16.0)

#: Damping of the motion without friction, which stands for that by friction.
_DAMPINGS = (0.03, 0.1, 0.3)

#: Steps of a search for the frequency, and samples per cycle of the highest.
_RATIO, _LEAST_SAMPLES = 1.06, 8.0

#: Evaluations of a descent that only shows which starts are worth following, and how many of these.
_SHORT, _REFINED = 8, 6


def first_state(model: Model, at_rest: bool) -> tuple[float, float]:
    """Place and speed at the first sample, without the offset."""
    given = model.given
    if given.order or at_rest:
        return (0.0 if given.order else float(np.mean(given.x[:3]))), 0.0
    count = min(7, given.x.size)
    line = np.polynomial.Polynomial.fit(given.time[:count] - given.time[0], given.x[:count], 2)
    return float(line(0.0)), float(line.deriv()(0.0))


def _linear(model: Model, held: np.ndarray, f: float, zeta: float) -> tuple[float, np.ndarray]:
    """Sum of squares without friction, and parts of drive, state and offset."""
    values = np.where(np.isnan(held), 0.0, held)
    values[[F_N, ZETA, X_F, MU, STIFFNESS, GAIN]] = f, zeta, 0.0, 1.0, 1.0, 1.0
    course = model.course(values)
    scales = model.given.drive.is_force and np.isnan(held[STIFFNESS])
    columns = [course.slopes[:, k] for k in (PLACE, SPEED)]
    columns += [np.ones(course.x.size)] if model.given.order == 0 else []
    columns += [course.x] if scales else []
    basis = np.column_stack(columns)
    wanted = model.given.x - (0.0 if scales else course.x)
    parts = np.linalg.lstsq(basis, wanted, rcond=None)[0]
    return float(np.sum((wanted - basis @ parts) ** 2)), parts


def _frequency(model: Model, held: np.ndarray) -> tuple[float, float]:
    """Frequency and scale of the drive of the nearest motion without friction."""
    time = model.given.time
    lowest = 1.0 / float(time[-1] - time[0])
    highest = 1.0 / (_LEAST_SAMPLES * float(np.median(np.diff(time))))
    steps = int(np.log(highest / lowest) / np.log(_RATIO)) + 1
    grid = np.geomspace(lowest, highest, steps) if np.isnan(held[F_N]) else held[[F_N]]
    found = [(*_linear(model, held, f, zeta), f) for f, zeta in product(grid, _DAMPINGS)]
    _, parts, f = min(found, key=lambda one: one[0])
    return float(f), abs(float(parts[-1]))


def _starts(model: Model, held: np.ndarray) -> list[np.ndarray]:
    f_n, scale = _frequency(model, held)
    x = model.given.x
    size = float(np.std(x)) / ((2.0 * np.pi * f_n) ** model.given.order)
    place, speed = first_state(model, False)
    offset = float(np.mean(x)) if model.given.order == 0 else 0.0
    usual = np.zeros(len(NAMES))
    usual[[ZETA, MU, GAIN]] = 0.01, 1.0, 1.0
    usual[STIFFNESS] = 1.0 / scale if scale > 0.0 else 1.0
    shift = offset if np.isnan(held[OFFSET]) else float(held[OFFSET])
    base = model.given.drive.values[0] if model.given.drive.joined and model.given.order == 0 else 0.0
    usual[OFFSET], usual[PLACE], usual[SPEED] = offset, place - shift - base, speed
    springs = _SPRINGS if model.given.elastic and np.isnan(held[SPRING]) else (0.0,)
    result: list[np.ndarray] = []
    for factor, friction, spring in product(_FREQUENCIES, _FRICTIONS, springs):
        start = usual.copy()
        start[[F_N, X_F, MU, SPRING]] = factor * f_n, friction * size, _MU, spring
        start = np.where(np.isnan(held), start, held)
        if not any(np.array_equal(start, other) for other in result):
            result.append(start)
    return result


def best_minima(model: Model, held: np.ndarray) -> list[Solution]:
    """Minima without noise of the drive, the least first."""
    keep = within_reach(model.given, held)
    problem = problem_of(model, held, white(keep, 1.0))
    free = short_problem(problem)
    rough = sorted((minimise(free, one, _SHORT) for one in _starts(model, held)), key=lambda one: one.sum)
    return sorted((minimise(problem, one.values, 60) for one in rough[:_REFINED]), key=lambda one: one.sum)


def short_problem(problem: Problem) -> Problem:
    """The problem without its floors: where it leads decides nothing."""
    return problem._replace(floor=np.full(problem.free.size, -np.inf))

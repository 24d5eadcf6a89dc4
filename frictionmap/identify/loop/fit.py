"""The joint fit of displacement and force, with the noise of each from its residuals."""

from typing import NamedTuple

import numpy as np

from ..statistics.least_squares import Problem, Solution
from ..statistics.weights import freedom_by_kind
from .branches import Layout
from .descent import descend
from .problem import MU, DamperTest, problem
from .shape import shape_fit
from .starts import starts

#: Starts that are refined; evaluations while they are only compared.
_REFINED, _STEPS = 4, 60

#: Forces whose residuals are smaller [N] are exact: sums of them are rounding.
_EXACT = 1e-9

#: Rounds in which the noise of both channels is found.
_ROUNDS = 3


class LoopFit(NamedTuple):
    """A fitted loop."""

    test: DamperTest  # with the noise of both channels
    layout: Layout
    problem: Problem
    solution: Solution


class Begun(NamedTuple):
    """A test whose displacement was fitted alone, and fits of its force with that, the best first."""

    test: DamperTest
    layout: Layout
    shape: np.ndarray
    starts: list[Solution]


def begun(test: DamperTest, held: np.ndarray) -> Begun:
    """Fit the displacement, and then the force; `held`: (named,), NaN of parameters that are fitted.

    Where the force may drop as the contact breaks away, the sample at which it does hops with the
    parameters, and the sum has many minima.  The sum in which the measured force shows this sample has none
    of them, and nearly the same slopes.
    """
    layout, shape = shape_fit(test.time, test.moved, test.order)
    test = test._replace(
        sigma_moved=float(np.sqrt(shape.sum / (test.time.size - layout.size))),
        break_seen=bool(held[MU] != 1.0) or test.factors > 0,
    )
    return Begun(test, layout, shape.values, starts(test, layout, shape.values, held))


def fit_loop(begin: Begun, held: np.ndarray) -> LoopFit:
    """The joint fit, from the best starts; mu keeps the value of its start."""
    best = begin.starts[0]
    test = begin.test._replace(sigma_force=max(float(np.sqrt(best.sum / begin.test.time.size)), _EXACT))
    free = np.isnan(held) & (np.arange(held.size) != MU)
    task = problem(test, begin.layout, free)
    found = [descend(task, one.values, _STEPS) for one in begin.starts[:_REFINED]]
    best = min(found, key=lambda one: one.sum)
    return LoopFit(test, begin.layout, usable(task, best), best)


def settled(
    test: DamperTest, layout: Layout, free: np.ndarray, best: Solution, held_state: bool = False
) -> LoopFit:
    """The fit with the noise that its residuals show."""

    def task_of(test: DamperTest) -> Problem:
        task = problem(test, layout, free)
        task.free[test.named] &= not held_state
        return task

    n = test.time.size
    kind = np.repeat((0, 1), n)
    for _ in range(_ROUNDS):
        seen = usable(task_of(test), best)
        freedom = freedom_by_kind(best, seen.free, kind)
        squares = np.bincount(kind, best.residual**2)
        moved, force = np.sqrt(squares / freedom)
        test = test._replace(
            sigma_moved=test.sigma_moved * float(moved), sigma_force=test.sigma_force * float(force)
        )
        task = task_of(test)
        best = descend(task, best.values, _STEPS)
    return LoopFit(test, layout, usable(task, best), best)


def usable(task: Problem, best: Solution) -> Problem:
    """The problem without unknowns that no sample sees, such as a state within the play."""
    return task._replace(free=task.free & (np.abs(best.slopes).max(axis=0) > 0.0))

"""Static over kinetic friction: an interval, from the profile of the sum of squares.

The force drops by (mu - 1) F between two samples.  Which two changes by steps as mu grows, so that the sum
has no derivative by mu: it is the least for all mu of an interval.
"""

from typing import NamedTuple

import numpy as np

from ..statistics.least_squares import Solution, minimise
from .branches import motion
from .fit import LoopFit, settled
from .problem import FRICTION, MU, STIFFNESS, places_of

#: Growth of the sum, over the variance of a sample, that one more unknown makes up for in 95 of 100 cases.
_CHANCE = 3.84

#: Values of mu that are tried to either side, over the change of the spring's force between two samples.
_REACH, _VALUES = 0.6, 12

#: The ends are found to this share of the distance of the values tried.
_HALVINGS = 5

_STEPS = 30


class Static(NamedTuple):
    """Static over kinetic friction."""

    lower: float
    upper: float
    fit: LoopFit  # in the middle


def static_friction(fit: LoopFit) -> Static:
    """The interval of mu around the best value, and the fit there."""
    fit = _searched(_searched(fit))
    fit = settled(fit.test, fit.layout, fit.problem.free[: fit.test.named], fit.solution)
    step = _step(fit)
    grid = _grid(fit, step)
    tried = [(mu, _at(fit, mu)) for mu in grid]
    least = min(one.sum for _, one in tried)
    inside = [k for k, (_, one) in enumerate(tried) if one.sum <= least + _CHANCE]
    first, last = inside[0], inside[-1]
    lower = _end(fit, grid[first], grid[first - 1] if first else 1.0, least)
    upper = _end(fit, grid[last], grid[min(last + 1, grid.size - 1)], least)
    middle = _at(fit, 0.5 * (lower + upper))
    best = middle if middle.sum <= least + _CHANCE else tried[inside[len(inside) // 2]][1]
    return Static(lower, upper, fit._replace(solution=best))


def _searched(fit: LoopFit) -> LoopFit:
    step = _step(fit)
    tried = [_at(fit, mu) for mu in _grid(fit, step)]
    return fit._replace(solution=min(tried, key=lambda one: one.sum))


def _step(fit: LoopFit) -> float:
    """Change of the spring's force over F between two samples, as the contact breaks away."""
    values = fit.solution.values
    at = motion(fit.layout, values[places_of(fit.test).displacement :], fit.test.time)
    travel = float(np.median(np.abs(np.diff(at.derivatives[0]))))
    return travel * values[STIFFNESS] / values[FRICTION]


def _grid(fit: LoopFit, step: float) -> np.ndarray:
    mu = fit.solution.values[MU]
    return np.unique(np.maximum(mu + np.linspace(-_REACH, _REACH, 2 * _VALUES + 1) * step, 1.0))


def _at(fit: LoopFit, mu: float) -> Solution:
    values = fit.solution.values.copy()
    values[MU] = mu
    return minimise(fit.problem, values, _STEPS)


def _end(fit: LoopFit, inside: float, outside: float, least: float) -> float:
    """The value beyond which the sum is larger than chance makes it, on the outer side."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        if _at(fit, middle).sum <= least + _CHANCE:
            inside = middle
        else:
            outside = middle
    return outside

"""Starting values of the joint fit: what slides gives the friction, stiffnesses of the contact are tried."""

from itertools import product

import numpy as np

from ..statistics.least_squares import Solution
from .branches import Layout, motion
from .descent import descend
from .problem import (
    BACKLASH,
    FRICTION,
    MU,
    OFFSET,
    SPRING,
    STIFFNESS,
    DamperTest,
    modelled_force,
    places_of,
    problem,
)  # fmt: skip

#: The share of a branch, at its end, on which the contact is taken to slip.
_SLIDING = 0.4

#: Stiffnesses k_t that are tried, over F/range, and plays, over the range of the displacement.
_STIFFNESSES = (3.0, 6.0, 12.0, 25.0, 50.0, 100.0, 200.0, 400.0)
_PLAYS = (0.02, 0.08)

#: Factors of the speed law.
_FACTOR = 0.8

#: Evaluations of a fit with the displacement held.
_STEPS = 25


def starts(test: DamperTest, layout: Layout, shape: np.ndarray, held: np.ndarray) -> list[Solution]:
    """Fits of the force with the displacement held, the best one first.

    shape : unknowns of the displacement
    held : (named,) values that are held, NaN: fitted
    """
    begin = _sliding(test, layout, shape, held)
    begin[FRICTION] = abs(begin[FRICTION])
    free = np.isnan(held)
    reach = float(np.ptp(motion(layout, shape, test.time).derivatives[0]))
    stiffnesses = (
        [begin[FRICTION] / reach * one for one in _STIFFNESSES] if free[STIFFNESS] else [held[STIFFNESS]]
    )
    plays = [one * reach for one in _PLAYS] if free[BACKLASH] else [held[BACKLASH]]
    ratios = [_peak(test, layout, begin)] if free[MU] else [held[MU]]
    task = problem(test, layout, free & (np.arange(free.size) != MU), fixed_motion=True)
    found = []
    for stiffness, play, static in product(stiffnesses, plays, ratios):
        values = begin.copy()
        values[[STIFFNESS, BACKLASH, MU]] = stiffness, play, static
        values[test.named] = _state(test, layout, values)
        found.append(descend(task, values, _STEPS))
    return sorted(found, key=lambda one: one.sum)


def _sliding(test: DamperTest, layout: Layout, shape: np.ndarray, held: np.ndarray) -> np.ndarray:
    """All unknowns, with what is linear from the ends of the branches, where the contact slips."""
    values = np.concatenate((np.where(np.isnan(held), 0.0, held), [0.0], shape))
    law = slice(test.named - test.factors, test.named)
    values[law] = np.where(np.isnan(held[law]), _FACTOR, held[law])
    at = motion(layout, shape, test.time)
    nodes = layout.nodes(shape)
    share = (test.time - nodes[at.branch]) / np.diff(nodes)[at.branch]
    late = share > 1.0 - _SLIDING
    sense = np.sign(np.diff(shape[: layout.branches + 1]))[at.branch]
    unknown = [place for place in (FRICTION, SPRING, OFFSET) if np.isnan(held[place])]
    columns = {FRICTION: sense, SPRING: at.derivatives[0], OFFSET: np.ones(sense.size)}
    rest = test.force - sum(columns[p] * values[p] for p in columns if p not in unknown)
    matrix = np.stack([columns[place] for place in unknown], axis=1)[late]
    if unknown:
        values[unknown] = np.linalg.lstsq(matrix, rest[late])[0]
    return values


def _peak(test: DamperTest, layout: Layout, values: np.ndarray) -> float:
    """The largest force of all branches over the friction, below which mu cannot be: at least 1."""
    idle = values.copy()
    idle[[FRICTION, STIFFNESS, BACKLASH]] = 0.0, 1.0, 0.0
    rest = test.force - modelled_force(test, layout, idle).force
    shape = values[places_of(test).displacement :]
    branch = motion(layout, shape, test.time).branch
    sense = np.sign(np.diff(shape[: layout.branches + 1]))
    peaks = [
        float(np.max(sense[j] * rest[branch == j])) for j in range(layout.branches) if (branch == j).any()
    ]
    return max(float(np.max(peaks)) / values[FRICTION], 1.0)


def _state(test: DamperTest, layout: Layout, values: np.ndarray) -> float:
    """How far the spring of the contact is carried at the first sample, from its force."""
    idle = values.copy()
    idle[FRICTION] = 0.0
    idle[STIFFNESS] = 1.0
    idle[BACKLASH] = 0.0
    rest = float(test.force[0] - modelled_force(test, layout, idle).force[0])
    rest = float(np.clip(rest, -values[FRICTION], values[FRICTION]))
    # a force within a tenth of the friction may be zero, in the middle of a play
    side = float(np.sign(rest)) if abs(rest) > 0.1 * values[FRICTION] else 0.0
    return rest / values[STIFFNESS] + 0.5 * side * values[BACKLASH]

"""Tests in which nothing slips, and those in which the contact is too stiff for its stiffness to be seen."""

import numpy as np

from ..statistics.least_squares import Solution
from .branches import motion
from .descent import descend
from .fit import Begun, LoopFit, settled
from .problem import (
    ASYMMETRY,
    BACKLASH,
    DRIFT,
    FRICTION,
    MASS,
    MU,
    NAMES,
    OFFSET,
    SLOPE,
    SPRING,
    STIFFNESS,
    modelled_force,
    places_of,
    problem,
)  # fmt: skip

#: Growth of the sum by which friction is found: three standard errors of each of its two unknowns.
_FOUND = 18.0

#: Share of the samples that slip, beyond which a contact is not taken for one that never slips.
_MOST_SLIPS = 0.3

#: Growth of the sum at a one-sided limit of 95 %.
_ONE_SIDED = 2.71

#: The elastic travel 2 F/k_t is seen beyond this many deviations of the displacement, with this many samples
#: of a branch before it slips.
_SEEN, _SAMPLES = 3.0, 3

#: Steps of the stiffness in its profile, and how many at most.
_STEP, _MOST = 1.25, 40

#: Evaluations of a fit beside another one.
_EVALUATIONS = 30


def nothing_slips(begin: Begun, held: np.ndarray) -> bool:
    """Whether a spring alone, with what is linear in the motion, explains the force as well as friction."""
    test = begin.test
    u, velocity, acceleration, _ = motion(begin.layout, begin.shape, test.time).derivatives
    columns = [u, np.ones(u.size)]
    for place, column in ((SLOPE, velocity), (MASS, acceleration), (DRIFT, test.time)):
        if np.isnan(held[place]) or held[place] != 0.0:
            columns.append(column)
    matrix = np.stack(columns, axis=1)
    rest = test.force - matrix @ np.linalg.lstsq(matrix, test.force)[0]
    alone, least = float(rest @ rest), begin.starts[0].sum
    return alone - least < _FOUND * least / test.time.size


def is_stuck(fit: LoopFit, begin: Begun, held: np.ndarray) -> bool:
    """Whether a fit without slip explains both channels as well as one that slips at the extremes.

    With the displacement of its own fit, `nothing_slips`, an error of a turning point shifts the force of a
    branch, which slip there would do as well.
    """
    if modelled_force(fit.test, fit.layout, fit.solution.values).slips.mean() > _MOST_SLIPS:
        return False
    stuck = stuck_fit(begin, held)
    parts = np.split(stuck.solution.residual, 2)
    scales = stuck.test.sigma_moved / fit.test.sigma_moved, stuck.test.sigma_force / fit.test.sigma_force
    total = sum(scale**2 * float(part @ part) for scale, part in zip(scales, parts, strict=True))
    return total - fit.solution.sum < _FOUND


def stuck_fit(begin: Begun, held: np.ndarray) -> LoopFit:
    """The fit of a contact that never slips: its stiffness is that of both springs."""
    test, layout = begin.test, begin.layout
    free = np.isnan(held)
    free[[FRICTION, SPRING, BACKLASH, ASYMMETRY, MU]] = False
    free[len(NAMES) :] = False
    free[[STIFFNESS, OFFSET]] = True
    reach = float(np.ptp(test.force))
    values = begin.starts[0].values.copy()
    values[: test.named] = np.where(np.isnan(held), 0.0, held)
    values[MU] = 1.0
    values[[FRICTION, SPRING, BACKLASH]] = 10.0 * reach, 0.0, 0.0  # beyond what the force reaches
    span = float(np.ptp(motion(layout, begin.shape, test.time).derivatives[0]))
    values[[STIFFNESS, OFFSET, test.named]] = reach / span, float(test.force[0]), 0.0
    task = problem(test, layout, free)
    task.free[test.named] = False  # a spring that is carried from the beginning is an offset
    return settled(test, layout, free, descend(task, values, _EVALUATIONS), held_state=True)


def is_rigid(fit: LoopFit) -> bool:
    """Whether the elastic travel is hidden by the noise, or passed between two samples."""
    friction, stiffness = fit.solution.values[[FRICTION, STIFFNESS]]
    travel = 2.0 * friction / stiffness
    noise = fit.test.sigma_moved if fit.test.order == 0 else 0.0
    slips = modelled_force(fit.test, fit.layout, fit.solution.values).slips
    branch = motion(fit.layout, fit.solution.values[places_of(fit.test).displacement :], fit.test.time).branch
    before = np.bincount(branch[~slips], minlength=fit.layout.branches)
    return bool(travel <= _SEEN * noise or np.median(before) < _SAMPLES)


def least_stiffness(fit: LoopFit) -> float:
    """The stiffness below which the sum is larger than chance makes it, from its profile."""
    least, stiffness = fit.solution.sum, float(fit.solution.values[STIFFNESS])
    for _ in range(_MOST):
        lower = stiffness / _STEP
        found = _at(fit, lower)
        least = min(least, found.sum)
        if found.sum > least + _ONE_SIDED:
            return lower
        stiffness = lower
    return 0.0


def _at(fit: LoopFit, stiffness: float) -> Solution:
    values = fit.solution.values.copy()
    free = fit.problem.free.copy()
    free[STIFFNESS] = False
    # the spring carries the same force at the beginning
    values[places_of(fit.test).state] *= values[STIFFNESS] / stiffness
    values[STIFFNESS] = stiffness
    return descend(fit.problem._replace(free=free), values, _EVALUATIONS)

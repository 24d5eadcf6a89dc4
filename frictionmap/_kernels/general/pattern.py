"""What follows an event: which contacts are held, which slide, and in which sense.

With several contacts one arrival can make others let go, and a contact that lets go can stop another.  For
contacts with mu = 1 the answer is unique: the forces are those of the box law a = 0, |f| <= beta, or
f = beta sgn(a).  Contacts with mu > 1 are held first, and the one with the largest excess over its static
friction lets go, until none is above it.
"""

import math

import numpy as np

from ..compiler import kernel
from .laws.coulomb import TOGETHER
from .laws.kinds import has_constraint, is_constrained, keeps_force
from .laws.speed import factor_at, set_segments
from .problem import F, H, P, Q, force_row, slide_velocity
from .row import set_channels
from .series import factor_held, solve_held

#: Loads within this share of the largest excess let go together.
_TIED = 1e-9

_MOST_PIVOTS = 400

#: Rows of the scratch of `settle`: accelerations in the contacts without forces of the participants; forces
#: and accelerations of the participants; 1 for those that take part; kinetic friction; 1 for those that may
#: slide; static friction; forces that would hold all participants; 1 where a contact would do otherwise if
#: all overloaded ones were released at once; sense.
FREE, FORCE, ACCELERATION, PARTICIPATES, KINETIC, MAY_SLIDE, STATIC, HOLDING, ORDER_MATTERS, _SENSE = range(
    10
)
BOX_ROWS = 10


@kernel
def _free_accelerations(problem, row, motion, box):
    """Fill the accelerations FREE in the contacts with no force from those that take part."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    series = motion.series
    for j in range(contacts):
        box[FREE, j] = 0.0
        for d in range(channels):
            box[FREE, j] -= problem.base[j, d] * (2.0 * series[modes + d, 2])
    for m in range(modes):
        found = -row.stiffness[m] * motion.state[Q, m]
        if problem.coupled:
            for other in range(modes):
                found -= row.damping[m, other] * motion.state[P, other]
        else:
            found -= row.damping[m, m] * motion.state[P, m]
        for d in range(channels):
            found += row.push[d, m] * series[modes + d, 0]
        for j in range(contacts):
            if box[PARTICIPATES, j] == 0.0:
                found -= row.reaction[j, m] * series[force_row(problem, j), 0]
        for j in range(contacts):
            box[FREE, j] += problem.chi[j, m] * found


@kernel
def _forces_of_choice(problem, row, motion, box):
    """Fill FORCE and ACCELERATION of the participants for the choice in `motion.sense`."""
    contacts = motion.sense.size
    if not factor_held(problem, row, motion):
        return False
    right = motion.solve[contacts]
    for j in range(contacts):
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            box[FORCE, j] = motion.sense[j] * box[KINETIC, j]
    for a in range(motion.held[contacts]):
        j = motion.held[a]
        right[a] = box[FREE, j]
        for other in range(contacts):
            if box[PARTICIPATES, other] != 0.0 and motion.sense[other] != 0:
                right[a] -= row.mobility[j, other] * box[FORCE, other]
    solve_held(motion, right)
    for a in range(motion.held[contacts]):
        box[1, motion.held[a]] = right[a]
    for j in range(contacts):
        box[ACCELERATION, j] = 0.0
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            box[ACCELERATION, j] = box[FREE, j]
            for other in range(contacts):
                if box[PARTICIPATES, other] != 0.0:
                    box[ACCELERATION, j] -= row.mobility[j, other] * box[FORCE, other]
    return True


@kernel
def _box_law(problem, row, motion, box):
    """Flip the first contact that is wrong, of those that may slide, until none is."""
    contacts = motion.sense.size
    for _ in range(_MOST_PIVOTS):
        if not _forces_of_choice(problem, row, motion, box):
            return False
        flipped = False
        for j in range(contacts):
            if box[PARTICIPATES, j] == 0.0 or box[MAY_SLIDE, j] == 0.0:
                continue
            if motion.sense[j] == 0 and abs(box[FORCE, j]) > box[KINETIC, j]:
                motion.sense[j] = 1 if box[FORCE, j] > 0.0 else -1
                flipped = True
            elif motion.sense[j] != 0 and motion.sense[j] * box[ACCELERATION, j] < 0.0:
                motion.sense[j] = 0
                flipped = True
            if flipped:
                break
        if not flipped:
            return True
    return False


@kernel
def _release_loads(motion, box, least):
    """Let every held contact with mu > 1 slide whose force is at least `least` times its static friction."""
    for j in range(motion.sense.size):
        if (
            box[PARTICIPATES, j] != 0.0
            and box[MAY_SLIDE, j] == 0.0
            and abs(box[FORCE, j]) >= least * box[STATIC, j]
        ):
            box[MAY_SLIDE, j] = 1.0
            motion.sense[j] = 1 if box[FORCE, j] > 0.0 else -1


@kernel
def _overloads(motion, box):
    """Largest and smallest share, above 1, that the force of a held contact with mu > 1 has of its static
    friction; 1 where none is overloaded.
    """
    worst, least = 1.0, math.inf
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0 and box[MAY_SLIDE, j] == 0.0 and abs(box[FORCE, j]) > box[STATIC, j]:
            share = abs(box[FORCE, j]) / box[STATIC, j]
            worst, least = max(worst, share), min(least, share)
    return worst, min(least, worst)


@kernel
def _release(problem, row, motion, box, released, at_once):
    """Let contacts go until no load exceeds its static friction, beginning with all participants held.

    Parameters
    ----------
    problem, row, motion, box : see `settle`; FORCE holds all participants
    released : contact that is released; -1: none
    at_once : whether all overloaded contacts with mu > 1 let go at once; else the most overloaded one

    Returns
    -------
    (determined, several) : whether the contacts determine their forces; whether several were overloaded at
        once, and not tied
    """
    if released >= 0:
        box[MAY_SLIDE, released] = 1.0
        motion.sense[released] = 1 if box[FORCE, released] > 0.0 else -1
        _release_loads(motion, box, 1.0 - _TIED)
    if not _box_law(problem, row, motion, box):
        return False, False
    several = False
    for _ in range(motion.sense.size):
        worst, least = _overloads(motion, box)
        if worst == 1.0:
            break
        several = several or least < worst * (1.0 - _TIED)
        _release_loads(motion, box, (least if at_once else worst) * (1.0 - _TIED))
        if not _box_law(problem, row, motion, box):
            return False, several
    return True, several


@kernel
def _hold_participants(motion, box):
    """Hold all that take part; those with mu = 1 may slide."""
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0:
            motion.sense[j] = 0
        box[MAY_SLIDE, j] = 1.0 if box[STATIC, j] <= box[KINETIC, j] else 0.0


@kernel
def _mark_order(problem, row, motion, box, released):
    """Mark the contacts that would do otherwise if all overloaded ones were released at once: ORDER_MATTERS.

    The pattern stays that of the rule; see `settle`.
    """
    contacts = motion.sense.size
    for j in range(contacts):
        box[_SENSE, j] = motion.sense[j]
        box[FORCE, j] = box[HOLDING, j]
    _hold_participants(motion, box)
    determined, _ = _release(problem, row, motion, box, released, True)
    for j in range(contacts):
        box[ORDER_MATTERS, j] = 1.0 if determined and motion.sense[j] != box[_SENSE, j] else 0.0
        motion.sense[j] = int(box[_SENSE, j])
    return _forces_of_choice(problem, row, motion, box)


@kernel
def _arrives_too(problem, row, motion, box, j):
    """Whether a slider reaches velocity zero together with the contact whose arrival was found."""
    modes, channels = problem.push.shape
    series = motion.series
    w = -row.numbers[H] * problem.belt[j]
    size = abs(w)
    for m in range(modes):
        part = problem.chi[j, m] * motion.state[P, m]
        w += part
        size += abs(part)
    for d in range(channels):
        w -= problem.base[j, d] * series[modes + d, 1]
    return abs(w) <= TOGETHER * size and motion.sense[j] * box[FREE, j] <= 0.0


@kernel
def stop_exactly(problem, row, motion):
    """Take the rounding error of their velocities from the participants; `motion.held` lists them."""
    contacts, modes = problem.chi.shape
    right = motion.solve[contacts]
    for a in range(motion.held[contacts]):
        right[a] = slide_velocity(problem, row, motion, motion.held[a])
    solve_held(motion, right)
    for a in range(motion.held[contacts]):
        for m in range(modes):
            motion.state[P, m] -= row.reaction[motion.held[a], m] * right[a]


@kernel
def _take_part(problem, row, friction, tau, motion, box):
    """Decide which contacts take part in what follows an event, and their friction there."""
    contacts = motion.sense.size
    series = motion.series
    set_channels(problem, row, tau, -1, motion)
    for j in range(contacts):
        nu = 1.0
        for d in range(problem.push.shape[1]):
            nu += problem.normal[j, d] * series[problem.push.shape[0] + d, 0]
        box[KINETIC, j] = friction.kinetic[j] * nu
        box[STATIC, j] = friction.static[j] * nu
        box[PARTICIPATES, j] = 0.0
        if is_constrained(problem, motion, j):
            box[PARTICIPATES, j] = 1.0
        series[force_row(problem, j), 0] = motion.sense[j] * box[KINETIC, j]
        if motion.sense[j] != 0:
            series[force_row(problem, j), 0] *= factor_at(problem, row, motion, j)
        if keeps_force(problem, motion, j):
            series[force_row(problem, j), 0] = motion.state[F, j]
    _free_accelerations(problem, row, motion, box)
    for j in range(contacts):
        if (
            box[PARTICIPATES, j] == 0.0
            and has_constraint(problem, j)
            and _arrives_too(problem, row, motion, box, j)
        ):
            box[PARTICIPATES, j] = 1.0


@kernel
def settle(problem, row, friction, tau, motion, box, arrived, released):
    """Decide the pattern after a contact has arrived at velocity zero, or was released with a drop of force.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau : phase of the load
    motion : Motion; state and pattern of the instant; the pattern is replaced
    box : (BOX_ROWS, N) scratch, see FREE
    arrived : contact that has arrived; -1: none
    released : contact that is released; -1: none

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    contacts = motion.sense.size
    _take_part(problem, row, friction, tau, motion, box)
    if arrived >= 0:
        box[PARTICIPATES, arrived] = 1.0
    _free_accelerations(problem, row, motion, box)
    _hold_participants(motion, box)
    if not _forces_of_choice(problem, row, motion, box):
        return False
    for j in range(contacts):
        box[HOLDING, j] = box[FORCE, j]
        box[ORDER_MATTERS, j] = 0.0
    stop_exactly(problem, row, motion)
    determined, several = _release(problem, row, motion, box, released, False)
    if determined and several:
        return _mark_order(problem, row, motion, box, released)
    return determined


@kernel
def begin(problem, row, friction, tau, motion, box):
    """Decide the pattern of a state at the start, from its velocities; elastic contacts begin at rest, their
    springs unloaded.
    """
    motion.clock[0] = math.nan
    set_channels(problem, row, tau, -1, motion)
    for j in range(motion.sense.size):
        w = slide_velocity(problem, row, motion, j)
        motion.fresh[j] = 0
        motion.sense[j] = int(np.sign(w)) if has_constraint(problem, j) else 0
    set_segments(problem, row, motion)
    if not settle(problem, row, friction, tau, motion, box, -1, -1):
        return False
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            motion.fresh[j] = 1
            motion.segment[j] = 0
    return True

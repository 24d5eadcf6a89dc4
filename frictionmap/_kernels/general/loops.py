"""Rigid contacts that close loops: their forces, and which of them are held after an event; mu = 1.

Where held contacts close a loop their mobility D is singular, and single forces are not determined.  The
accelerations are, and so the motion: the forces minimise f.D f/2 - b.f within their limits, and two of them
with the least value differ by forces without an effect.  As many held contacts as are independent have a
constraint each; the others, which these keep at rest, have constant forces: they are `idle`.

At an event the forces that follow are found from those before it.  Some of them are free, and lead to where
the accelerations of their contacts vanish; the others keep their value, until that is the worst.  Where no
force jumps the same holds for the rates of the forces: contacts at their limit stay with a rate that leads
inside, or go.
"""

import math

import numpy as np

from ..compiler import kernel, late_kernel
from .crossings import slope_at
from .laws.coulomb import TOGETHER
from .laws.kinds import has_constraint
from .laws.speed import set_segments
from .pattern import (
    ACCELERATION,
    FORCE,
    FREE,
    HOLDING,
    KINETIC,
    LOWER,
    ORDER_MATTERS,
    PARTICIPATES,
    TERMS_SIZE,
    UPPER,
    WHOLE,
    fill_free_accelerations,
    settle,
    stop_exactly,
    take_part,
)
from .problem import F, P, Q, force_row, slide_velocity
from .row import set_channels
from .series import factor_held, solve_held

#: Share of its own mobility that a contact has, at least, beside those that it is independent of.
_INDEPENDENT = 1e-10

#: Orders of rates that may decide, plus 1.
_MOST_ORDERS = 7

#: Steps to the forces, at most.
_MOST_STEPS = 2000


@kernel
def _is_independent(row, motion, j):
    """Whether the held contacts that are factored do not keep contact j at rest."""
    contacts = motion.sense.size
    right = motion.solve[contacts]
    for a in range(motion.held[contacts]):
        right[a] = row.mobility[motion.held[a], j]
    solve_held(motion, right)
    rest = row.mobility[j, j]
    for a in range(motion.held[contacts]):
        rest -= row.mobility[motion.held[a], j] * right[a]
    return rest > _INDEPENDENT * row.mobility[j, j]


@kernel
def _is_inside(box, j):
    """Whether a force is inside its limits, and not at one of them."""
    share = 1.0 - TOGETHER
    return box[LOWER, j] * share < box[FORCE, j] and box[FORCE, j] < box[UPPER, j] * share


@kernel
def _extend_basis(problem, row, motion, box, inside):
    """Give constraints to further held contacts, for as long as they are independent; False if singular.

    Parameters
    ----------
    problem, row, motion, box : see `_find_forces`
    inside : whether to those alone whose forces are inside their limits
    """
    if not factor_held(problem, row, motion):
        return False
    for j in range(motion.sense.size):
        chosen = motion.sense[j] == 0 and motion.idle[j] and (not inside or _is_inside(box, j))
        if chosen and _is_independent(row, motion, j):
            motion.idle[j] = False
            if not factor_held(problem, row, motion):
                return False
    return True


@kernel
def _complete_basis(problem, row, motion, box):
    """`_extend_basis` by all contacts, those inside their limits first.

    One at its limit whose force does not change would be at its limit again in every step.
    """
    return _extend_basis(problem, row, motion, box, True) and _extend_basis(problem, row, motion, box, False)


@kernel
def _hold_none(motion):
    """Begin the choice of the contacts that have constraints.

    Those that slide have the force of their slide, never one that is kept from before.
    """
    for j in range(motion.sense.size):
        motion.idle[j] = motion.sense[j] == 0


@kernel
def factor_independent(problem, row, motion, box):
    """`factor_held`, of held contacts that may close loops; `box`: scratch."""
    if not problem.loops:
        return factor_held(problem, row, motion)
    _hold_none(motion)
    return _extend_basis(problem, row, motion, box, False)


@kernel
def _step(row, motion, box):
    """Move the free forces to where the accelerations vanish, or to the first limit; its contact, or -1."""
    contacts = motion.sense.size
    right, count = motion.solve[contacts], motion.held[contacts]
    for a in range(count):
        j = motion.held[a]
        right[a] = box[FREE, j]
        for other in range(contacts):
            if box[PARTICIPATES, other] != 0.0 and motion.idle[other]:
                right[a] -= row.mobility[j, other] * box[FORCE, other]
    solve_held(motion, right)
    share, first = 1.0, -1
    for a in range(count):
        j = motion.held[a]
        limit = min(max(right[a], box[LOWER, j]), box[UPPER, j])
        if limit != right[a]:
            part = (limit - box[FORCE, j]) / (right[a] - box[FORCE, j])
            if part < share:
                share, first = part, j
    for a in range(count):
        j = motion.held[a]
        if first < 0:
            box[FORCE, j] = right[a]
        else:
            force = box[FORCE, j] + share * (right[a] - box[FORCE, j])
            if j == first:
                force = box[UPPER, j] if right[a] > box[UPPER, j] else box[LOWER, j]
            box[FORCE, j] = min(max(force, box[LOWER, j]), box[UPPER, j])
    return first


@kernel
def _fill_whole(problem, row, motion, box, rates):
    """Fill the size of the terms of the accelerations of all modes, as they move each contact: a contact that
    does not move has the rounding errors of these.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    box : scratch of `settle`, with the limits of the forces, or in HOLDING the rates of the forces
    rates : whether the accelerations are those by rates of the forces alone
    """
    modes, channels = problem.push.shape
    contacts, whole = motion.sense.size, 0.0
    for m in range(modes):
        size = 0.0
        if not rates:
            size = abs(row.stiffness[m] * motion.state[Q, m])
            for other in range(modes):
                size += abs(row.damping[m, other] * motion.state[P, other])
            for d in range(channels):
                size += abs(row.push[d, m] * motion.series[modes + d, 0])
        for j in range(contacts):
            size += abs(row.reaction[j, m] * (box[HOLDING, j] if rates else box[UPPER, j]))
        whole += size * size
    for j in range(contacts):
        own = 0.0
        for m in range(modes):
            own += problem.chi[j, m] ** 2
        box[WHOLE, j] = math.sqrt(own * whole)


@kernel
def _fill_accelerations(row, motion, box):
    """Fill ACCELERATION of the participants, and the size of its terms."""
    contacts = motion.sense.size
    for j in range(contacts):
        if box[PARTICIPATES, j] == 0.0:
            continue
        box[ACCELERATION, j], box[TERMS_SIZE, j] = box[FREE, j], max(abs(box[FREE, j]), box[WHOLE, j])
        for other in range(contacts):
            if box[PARTICIPATES, other] != 0.0:
                part = row.mobility[j, other] * box[FORCE, other]
                box[ACCELERATION, j] -= part
                box[TERMS_SIZE, j] += abs(part)


@kernel
def _accelerates(box, j):
    """Whether a participant has an acceleration that is not rounding error."""
    return abs(box[ACCELERATION, j]) > TOGETHER * box[TERMS_SIZE, j]


@kernel
def _worst(motion, box):
    """The participant with a constant force that could do most against its acceleration; -1: none can."""
    worst, found = 0.0, -1
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] == 0.0 or not motion.idle[j] or not _accelerates(box, j):
            continue
        up = box[ACCELERATION, j] > 0.0
        room = box[FORCE, j] < box[UPPER, j] if up else box[FORCE, j] > box[LOWER, j]
        share = abs(box[ACCELERATION, j]) / box[TERMS_SIZE, j]
        if room and share > worst:
            worst, found = share, j
    return found


@kernel
def _find_forces(problem, row, motion, box):
    """Find the forces of the participants, all of which are held, within LOWER and UPPER; see the module.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion; the free forces are of those that are not idle
    box : scratch of `settle`; FORCE begins within the limits

    Returns
    -------
    bool : False if they were not found
    """
    for _ in range(_MOST_STEPS):
        if not factor_held(problem, row, motion):
            return False
        first = _step(row, motion, box)
        if first >= 0:
            motion.idle[first] = True
            continue
        _fill_accelerations(row, motion, box)
        worst = _worst(motion, box)
        if worst < 0:
            return True
        motion.idle[worst] = False
    return False


@kernel
def _release_accelerated(problem, row, motion, box, zeros):
    """Let the participants slide that accelerate, and give the others constraints or constant forces.

    zeros : leading terms of the velocities that are zero
    """
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] == 0.0:
            continue
        motion.segment[j] = motion.fresh[j] = 0
        if motion.idle[j] and _accelerates(box, j):
            motion.sense[j] = 1 if box[ACCELERATION, j] > 0.0 else -1
            motion.idle[j] = False
            motion.fresh[j] = zeros
    return _complete_basis(problem, row, motion, box)


@kernel
def _is_still(problem, row, motion, j):
    """Whether the velocity in a contact is zero, up to rounding errors.

    Where a loop comes to rest all modes that move its contacts do: their velocities are then rounding errors
    of the whole motion.
    """
    own, whole = 0.0, 0.0
    for m in range(problem.push.shape[0]):
        own += problem.chi[j, m] ** 2
        whole += motion.state[Q, m] ** 2 + motion.state[P, m] ** 2
    return abs(slide_velocity(problem, row, motion, j)) <= TOGETHER * math.sqrt(own * whole)


@late_kernel(bool)
def _settle_loops(problem, row, friction, tau, motion, box, forces, arrived):
    """`settle` for contacts that may close loops.

    Parameters
    ----------
    problem, row, friction, tau, motion, box, arrived : see `settle`
    forces : (N,) those before the event
    """
    contacts = motion.sense.size
    take_part(problem, row, friction, tau, motion, box)
    for j in range(contacts):
        if motion.sense[j] == 0 or j == arrived or _is_still(problem, row, motion, j):
            box[PARTICIPATES, j] = 1.0  # sliders that close a loop with held contacts arrive together
    fill_free_accelerations(problem, row, motion, box)
    for j in range(contacts):
        limit = box[KINETIC, j]
        box[LOWER, j], box[UPPER, j], box[HOLDING, j], box[ORDER_MATTERS, j] = -limit, limit, limit, 0.0
        if box[PARTICIPATES, j] != 0.0:
            motion.sense[j] = 0
            box[FORCE, j] = min(max(forces[j], -limit), limit)
    _fill_whole(problem, row, motion, box, False)
    _hold_none(motion)
    if not _complete_basis(problem, row, motion, box):
        return False
    stop_exactly(problem, row, motion)
    if not _find_forces(problem, row, motion, box) or not _release_accelerated(problem, row, motion, box, 1):
        return False
    for j in range(contacts):
        if box[PARTICIPATES, j] != 0.0:
            motion.state[F, j] = box[FORCE, j]
    return True


@kernel
def settle_contacts(problem, row, friction, tau, motion, box, forces, arrived, released):
    """Decide the pattern after an event at which forces jump.

    Parameters
    ----------
    problem, row, friction, tau, motion, box, arrived, released : see `settle`
    forces : (N,) forces before the event

    Returns
    -------
    bool : False if the contacts do not determine their forces, or these were not found
    """
    if problem.loops:
        return _settle_loops(problem, row, friction, tau, motion, box, forces, arrived)
    return settle(problem, row, friction, tau, motion, box, arrived, released)


@kernel
def _is_flat(problem, friction, motion, j, order):
    """Whether the terms of a force before this order, except the first one, are rounding errors."""
    flat, at = True, force_row(problem, j)
    for k in range(1, order):
        flat = flat and abs(motion.series[at, k]) <= TOGETHER * friction.kinetic[j]
    return flat


@kernel
def _fill_rates(problem, row, friction, motion, forces, x, order, box):
    """Fill the rates of the forces of held contacts that have constraints, and the limits of the rates.

    Parameters
    ----------
    problem, row, friction, motion, forces, x, box : see `release_in_loops`
    order : of the rates: 1, or where those of lower orders decide nothing a higher one
    """
    contacts = motion.sense.size
    for j in range(contacts):
        box[PARTICIPATES, j] = 1.0 if motion.sense[j] == 0 else 0.0
        box[LOWER, j], box[UPPER, j] = -math.inf, math.inf
        at_limit = abs(forces[j]) >= friction.kinetic[j] * (1.0 - TOGETHER)
        if at_limit and _is_flat(problem, friction, motion, j, order):
            if forces[j] >= 0.0:
                box[UPPER, j] = 0.0
            if forces[j] <= 0.0:
                box[LOWER, j] = 0.0
        rate = 0.0
        if motion.sense[j] == 0 and order == 1:
            rate = slope_at(motion.series, force_row(problem, j), x)
        elif motion.sense[j] == 0:
            rate = motion.series[force_row(problem, j), order]
        box[HOLDING, j] = rate
        box[FORCE, j] = min(max(rate, box[LOWER, j]), box[UPPER, j])
    for j in range(contacts):
        box[FREE, j] = 0.0
        for other in range(contacts):
            box[FREE, j] += row.mobility[j, other] * box[HOLDING, other]
    _fill_whole(problem, row, motion, box, True)


@kernel
def _decides_nothing(motion, box):
    """Whether the pattern is the one before: all held contacts are, and the same ones have constraints."""
    same = True
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0:
            was_idle = box[ORDER_MATTERS, j] != 0.0
            same = same and motion.sense[j] == 0 and motion.idle[j] == was_idle
    return same


@late_kernel(bool)
def release_in_loops(problem, row, friction, motion, forces, x, box):
    """Decide by rates what follows where a force reaches its limit, and none jumps.

    A force that stays at its limit may leave it later than with its rate, where others begin to slide: a step
    then begins with it, and rates of higher order decide.

    Parameters
    ----------
    problem, row, friction, motion : Problem, Row, Friction, Motion with the series of the step
    forces : (N,) forces at the event
    x : its place in the step
    box : scratch of `settle`

    Returns
    -------
    bool : False if it is not determined
    """
    contacts = motion.sense.size
    for j in range(contacts):
        box[ORDER_MATTERS, j] = 1.0 if motion.idle[j] else 0.0
    for order in range(1, _MOST_ORDERS if x == 0.0 else 2):
        _fill_rates(problem, row, friction, motion, forces, x, order, box)
        if not _find_forces(problem, row, motion, box):
            return False
        for j in range(contacts):
            if box[PARTICIPATES, j] != 0.0:
                limit = friction.kinetic[j]
                motion.state[F, j] = min(max(forces[j], -limit), limit)
        if not _release_accelerated(problem, row, motion, box, order + 1):
            return False
        if not _decides_nothing(motion, box):
            break
    for j in range(contacts):
        box[ORDER_MATTERS, j] = 0.0
    return True


@kernel
def prepare_loops(problem, row, friction, tau, motion, box):
    """Find the forces in the contacts that are held in a state; False if they are not found."""
    if not problem.loops:
        return True
    forces = motion.event[0]
    for j in range(forces.size):
        forces[j] = 0.0
    return _settle_loops(problem, row, friction, tau, motion, box, forces, -1)


@kernel
def begin(problem, row, friction, tau, motion, box):
    """Decide the pattern of a state at the start, from its velocities; elastic contacts begin at rest, their
    springs unloaded.
    """
    motion.clock[0] = math.nan
    set_channels(problem, row, tau, -1, motion)
    forces = motion.event[0]
    for j in range(motion.sense.size):
        w = slide_velocity(problem, row, motion, j)
        motion.fresh[j] = 0
        forces[j] = 0.0
        motion.sense[j] = int(np.sign(w)) if has_constraint(problem, j) else 0
    set_segments(problem, row, motion)
    if not settle_contacts(problem, row, friction, tau, motion, box, forces, -1, -1):
        return False
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            motion.fresh[j] = 1
            motion.segment[j] = 0
    return True

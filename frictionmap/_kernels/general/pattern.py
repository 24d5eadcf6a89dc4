"""What follows an event: which contacts are held, which slide, and in which sense.

With several contacts one arrival can make others let go, and a contact that lets go can stop another.  For
contacts with mu = 1 the answer is unique: the forces are those of the box law a = 0, |f| <= beta, or
f = beta sgn(a).  Contacts with mu > 1 are held first, and the one with the largest excess over its static
friction lets go, until none is above it.
"""

import math

import numpy as np

from ..compiler import kernel
from .problem import set_channels
from .series import factor_held, first_contact_row, solve_held

#: A slider with a velocity below this share of the velocities in it, on its way to zero, arrives with the
#: contact whose arrival was found: in symmetric systems contacts arrive together.
_TOGETHER = 1e-11

#: Loads within this share of the largest excess let go together.
_TIED = 1e-9

_MOST_PIVOTS = 400


@kernel
def _free_accelerations(problem, row, work, law):
    """Fill law[0]: accelerations in the contacts with no force from those that take part (law[3] = 1)."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    series, first = work.series, first_contact_row(problem)
    for j in range(contacts):
        law[0, j] = 0.0
        for d in range(channels):
            law[0, j] -= problem.base[j, d] * (2.0 * series[modes + d, 2])
    for m in range(modes):
        found = -row.stiffness[m] * work.state[0, m]
        if problem.coupled:
            for other in range(modes):
                found -= row.damping[m, other] * work.state[1, other]
        else:
            found -= row.damping[m, m] * work.state[1, m]
        for d in range(channels):
            found += row.push[d, m] * series[modes + d, 0]
        for j in range(contacts):
            if law[3, j] == 0.0:
                found -= row.reaction[j, m] * series[first + 2 * contacts + j, 0]
        for j in range(contacts):
            law[0, j] += problem.chi[j, m] * found


@kernel
def _forces_of_choice(problem, row, work, law):
    """Fill the forces law[1] and accelerations law[2] of the participants for the choice in `work.sense`."""
    contacts = work.sense.size
    if not factor_held(problem, row, work):
        return False
    right = work.solve[contacts]
    for j in range(contacts):
        if law[3, j] != 0.0 and work.sense[j] != 0:
            law[1, j] = work.sense[j] * law[4, j]
    for a in range(work.held[contacts]):
        j = work.held[a]
        right[a] = law[0, j]
        for other in range(contacts):
            if law[3, other] != 0.0 and work.sense[other] != 0:
                right[a] -= row.mobility[j, other] * law[1, other]
    solve_held(work, right)
    for a in range(work.held[contacts]):
        law[1, work.held[a]] = right[a]
    for j in range(contacts):
        law[2, j] = 0.0
        if law[3, j] != 0.0 and work.sense[j] != 0:
            law[2, j] = law[0, j]
            for other in range(contacts):
                if law[3, other] != 0.0:
                    law[2, j] -= row.mobility[j, other] * law[1, other]
    return True


@kernel
def _box_law(problem, row, work, law):
    """Flip the first contact that is wrong until none is; law[5] = 1 marks those that may slide."""
    contacts = work.sense.size
    for _ in range(_MOST_PIVOTS):
        if not _forces_of_choice(problem, row, work, law):
            return False
        flipped = False
        for j in range(contacts):
            if law[3, j] == 0.0 or law[5, j] == 0.0:
                continue
            if work.sense[j] == 0 and abs(law[1, j]) > law[4, j]:
                work.sense[j] = 1 if law[1, j] > 0.0 else -1
                flipped = True
            elif work.sense[j] != 0 and work.sense[j] * law[2, j] < 0.0:
                work.sense[j] = 0
                flipped = True
            if flipped:
                break
        if not flipped:
            return True
    return False


@kernel
def _let_go(work, law, least):
    """Let every held contact with mu > 1 slide whose force is at least `least` times its static friction."""
    for j in range(work.sense.size):
        if law[3, j] != 0.0 and law[5, j] == 0.0 and abs(law[1, j]) >= least * law[6, j]:
            law[5, j] = 1.0
            work.sense[j] = 1 if law[1, j] > 0.0 else -1


@kernel
def _overloads(work, law):
    """Largest and smallest share, above 1, that the force of a held contact with mu > 1 has of its static
    friction, law[6]; 1 where none is overloaded.
    """
    worst, least = 1.0, math.inf
    for j in range(work.sense.size):
        if law[3, j] != 0.0 and law[5, j] == 0.0 and abs(law[1, j]) > law[6, j]:
            share = abs(law[1, j]) / law[6, j]
            worst, least = max(worst, share), min(least, share)
    return worst, min(least, worst)


@kernel
def _release(problem, row, work, law, released, at_once):
    """Let contacts go until no load exceeds its static friction, beginning with all participants held.

    Parameters
    ----------
    problem, row, work, law : see `settle`; law[1] holds the forces that hold all participants
    released : contact that is released; -1: none
    at_once : whether all overloaded contacts with mu > 1 let go at once; else the most overloaded one

    Returns
    -------
    (determined, several) : whether the contacts determine their forces; whether several were overloaded at
        once, and not tied
    """
    if released >= 0:
        law[5, released] = 1.0
        work.sense[released] = 1 if law[1, released] > 0.0 else -1
        _let_go(work, law, 1.0 - _TIED)
    if not _box_law(problem, row, work, law):
        return False, False
    several = False
    for _ in range(work.sense.size):
        worst, least = _overloads(work, law)
        if worst == 1.0:
            break
        several = several or least < worst * (1.0 - _TIED)
        _let_go(work, law, (least if at_once else worst) * (1.0 - _TIED))
        if not _box_law(problem, row, work, law):
            return False, several
    return True, several


@kernel
def _hold_participants(work, law):
    """Hold all that take part; those with mu = 1 may slide."""
    for j in range(work.sense.size):
        if law[3, j] != 0.0:
            work.sense[j] = 0
        law[5, j] = 1.0 if law[6, j] <= law[4, j] else 0.0


@kernel
def _mark_order(problem, row, work, law, released):
    """Mark in law[8] the contacts that would do otherwise if all overloaded ones let go at once.

    The pattern stays that of the rule; see `settle`.
    """
    contacts = work.sense.size
    for j in range(contacts):
        law[9, j] = work.sense[j]
        law[1, j] = law[7, j]
    _hold_participants(work, law)
    determined, _ = _release(problem, row, work, law, released, True)
    for j in range(contacts):
        law[8, j] = 1.0 if determined and work.sense[j] != law[9, j] else 0.0
        work.sense[j] = int(law[9, j])
    return _forces_of_choice(problem, row, work, law)


@kernel
def _arrives_too(problem, row, work, law, j):
    """Whether a slider reaches velocity zero together with the contact whose arrival was found."""
    modes, channels = problem.push.shape
    series = work.series
    w = -row.numbers[0] * problem.belt[j]
    size = abs(w)
    for m in range(modes):
        part = problem.chi[j, m] * work.state[1, m]
        w += part
        size += abs(part)
    for d in range(channels):
        w -= problem.base[j, d] * series[modes + d, 1]
    return abs(w) <= _TOGETHER * size and work.sense[j] * law[0, j] <= 0.0


@kernel
def stop_exactly(problem, row, work):
    """Take the rounding error of their velocities from the participants; `work.held` lists them."""
    modes, channels = problem.push.shape
    contacts = work.sense.size
    series, right = work.series, work.solve[contacts]
    for a in range(work.held[contacts]):
        j = work.held[a]
        right[a] = -row.numbers[0] * problem.belt[j]
        for m in range(modes):
            right[a] += problem.chi[j, m] * work.state[1, m]
        for d in range(channels):
            right[a] -= problem.base[j, d] * series[modes + d, 1]
    solve_held(work, right)
    for a in range(work.held[contacts]):
        for m in range(modes):
            work.state[1, m] -= row.reaction[work.held[a], m] * right[a]


@kernel
def _take_part(problem, row, friction, tau, work, law):
    """Decide which contacts take part in what follows an event (law[3]), and their friction there."""
    contacts = work.sense.size
    series, first = work.series, first_contact_row(problem)
    set_channels(problem, row, tau, -1, work)
    for j in range(contacts):
        nu = 1.0
        for d in range(problem.push.shape[1]):
            nu += problem.normal[j, d] * series[problem.push.shape[0] + d, 0]
        law[4, j] = friction.kinetic[j] * nu
        law[6, j] = friction.static[j] * nu
        law[3, j] = 0.0
        if problem.spring[j] == 0.0 and work.sense[j] == 0:
            law[3, j] = 1.0
        series[first + 2 * contacts + j, 0] = work.sense[j] * law[4, j]
        if problem.spring[j] != 0.0 and work.sense[j] == 0:
            series[first + 2 * contacts + j, 0] = work.state[2, j]
    _free_accelerations(problem, row, work, law)
    for j in range(contacts):
        if law[3, j] == 0.0 and problem.spring[j] == 0.0 and _arrives_too(problem, row, work, law, j):
            law[3, j] = 1.0


@kernel
def settle(problem, row, friction, tau, work, law, arrived, released):
    """Decide the pattern after a contact has arrived at velocity zero, or was released with a drop of force.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau : phase of the load
    work : Work; state and pattern of the instant; the pattern is replaced
    law : (10, N) scratch: accelerations, forces, accelerations of sliders, participants, kinetic friction,
        whether a participant may slide, static friction, forces that would hold all participants, whether
        the contact would do otherwise if all overloaded ones let go at once, pattern
    arrived : contact that has arrived; -1: none
    released : contact that is released; -1: none

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    contacts = work.sense.size
    _take_part(problem, row, friction, tau, work, law)
    if arrived >= 0:
        law[3, arrived] = 1.0
    _free_accelerations(problem, row, work, law)
    _hold_participants(work, law)
    if not _forces_of_choice(problem, row, work, law):
        return False
    for j in range(contacts):
        law[7, j] = law[1, j]
        law[8, j] = 0.0
    stop_exactly(problem, row, work)
    determined, several = _release(problem, row, work, law, released, False)
    if determined and several:
        return _mark_order(problem, row, work, law, released)
    return determined


@kernel
def _ends_rest(problem, work, j):
    """Whether the contacts that keep both ends of a spring at rest are all held."""
    tied = False
    for i in range(work.sense.size):
        if problem.ties[j, i]:
            tied = True
            if work.sense[i] != 0:
                return False
    return tied


@kernel
def rest_springs(problem, friction, work, order):
    """Bring springs to rest between ends that are at rest now, and let those go whose ends are not any more.

    Between ends at rest the velocity is zero for as long as they rest, and the force constant: neither is
    watched, because what is computed of them is rounding error.  A slip ends with the motion of the ends.
    A force that is at its limit when an end lets go either slips on or falls; which of them is decided by the
    first term of the velocity that is not zero.

    Parameters
    ----------
    problem, friction : Problem, Friction
    work : Work; senses, forces and `fresh` of the springs are set
    order : number of leading terms of the velocities that are zero where ends begin to move: 1 after a jump
        of a force, else 2
    """
    for j in range(work.sense.size):
        rests = _ends_rest(problem, work, j)
        limit = friction.kinetic[j]
        if rests and work.sense[j] != 0:
            work.state[2, j] = work.sense[j] * limit
            work.sense[j] = 0
        if rests:
            work.fresh[j] = 0
        elif work.idle[j] and abs(work.state[2, j]) >= limit:  # beyond it by rounding error
            sign = 1 if work.state[2, j] > 0.0 else -1
            work.state[2, j] = sign * limit
            work.fresh[j] = sign * (1 + order)
        work.idle[j] = rests


@kernel
def begin(problem, row, friction, tau, work, law):
    """Decide the pattern of a state at the start, from its velocities; elastic contacts begin at rest, their
    springs unloaded.
    """
    modes, channels = problem.push.shape
    contacts = work.sense.size
    work.clock[0] = math.nan
    set_channels(problem, row, tau, -1, work)
    for j in range(contacts):
        w = -row.numbers[0] * problem.belt[j]
        for m in range(modes):
            w += problem.chi[j, m] * work.state[1, m]
        for d in range(channels):
            w -= problem.base[j, d] * work.series[modes + d, 1]
        work.fresh[j] = 0
        work.sense[j] = int(np.sign(w)) if problem.spring[j] == 0.0 else 0
    if not settle(problem, row, friction, tau, work, law, -1, -1):
        return False
    for j in range(contacts):
        if law[3, j] != 0.0 and work.sense[j] != 0:
            work.fresh[j] = 1
    return True

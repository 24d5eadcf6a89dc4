"""Springs of contacts under varying normal loads, where an interval of a record begins.

There the normal load may jump, and its slope.  A slider has no mass: where the limit falls below the force of
its spring it slips at once until the force is at the limit, and the spring does this work.  Where the limit
rises from the force of a slider that slips, or rises faster than the force, the slider stops.  A contact
without load for a whole interval is open: its slider follows it without a force, and turns with it.

A load that displaces a contact beside the modes does so at once: where it jumps, or its slope, so does the
place or the velocity of the wall, and what holds of limits holds of walls.
"""

import math

from ..compiler import kernel
from ..general.laws.coupled import is_coupled
from ..general.laws.elastic import ends_rest
from ..general.laws.kinds import has_force
from ..general.problem import LOAD_TERMS, F, slide_velocity, varies, velocity_row
from ..general.row import set_channels
from .kept import OF_BASE, add_slide, list_changes

#: Share of the terms of a normal load that is rounding error of their sum.
_SAME = 1e-13

#: Leading terms of a velocity that may be zero at most.
_MOST_ZEROS = 7

#: A spring whose force is below this share of its limit does not slip; one above that share exceeds it.
_BELOW, _ABOVE = 1.0 - 1e-9, 1.0 + 1e-9

#: A speed of a slider within this share of its terms is rest.
_AT_REST = 1e-12


@kernel
def has_varying_spring(problem):
    """Whether the normal load of a contact with a spring varies."""
    found = False
    for j in range(problem.spring.size):
        found = found or (has_force(problem, j) and varies(problem, j))
    return found


@kernel
def has_open_spring(problem, friction):
    """Whether a contact with a spring may be without load: where it varies, and always without friction."""
    found = has_varying_spring(problem)
    for j in range(problem.spring.size):
        found = found or (has_force(problem, j) and friction.kinetic[j] == 0.0 and not is_coupled(problem))
    return found


@kernel
def bends(direct):
    """Whether the place or the velocity of a wall may jump; `direct`: rows of that of `course.Course`."""
    found = False
    for j in range(direct.shape[0]):
        for d in range(direct.shape[1]):
            found = found or direct[j, d] != 0.0
    return found


@kernel
def _limit(problem, row, friction, j):
    """(limit, its slope, rounding error of the limit) of a contact where the interval begins."""
    nu, rate, size = 1.0, 0.0, 1.0
    for d in range(problem.normal.shape[1]):
        share = problem.normal[j, d]
        if share != 0.0:
            nu += share * row.loads[d, 0]
            rate += share * row.loads[d, 1]
            for k in range(row.intervals[LOAD_TERMS]):
                size += abs(share * row.loads[d, k])
    kinetic = friction.kinetic[j]
    return kinetic * max(nu, 0.0), kinetic * rate, _SAME * kinetic * size


@kernel
def _jump(problem, row, friction, motion, kept):
    """Let sliders stop whose limits rise, and others begin to slip whose limits fall below their forces."""
    for j in range(motion.sense.size):
        if not (has_force(problem, j) and varies(problem, j)):
            continue
        limit, _, error = _limit(problem, row, friction, j)
        if motion.sense[j] != 0:
            motion.state[F, j] = kept.forces[j]
        force = motion.state[F, j]
        if abs(force) > limit + error:
            motion.sense[j] = 1 if force > 0.0 else -1
            motion.fresh[j] = 0
        elif abs(force) < limit - error:
            motion.sense[j] = 0


@kernel
def follow_walls(problem, row, friction, motion, leaps, kept):
    """Let springs follow walls that jump: beyond their limits, sliders begin to slip.

    Parameters
    ----------
    problem, row, friction, motion, kept : see `motions_in_time.follow_record`; the polynomials are in
        `row.loads`
    leaps : (N,) how far the walls jump; filled with what sliders slip at once, see `slip_with_walls`
    """
    for j in range(motion.sense.size):
        leap, leaps[j] = leaps[j], 0.0
        if leap == 0.0:
            continue
        limit, _, _ = _limit(problem, row, friction, j)
        before = motion.state[F, j]
        if motion.sense[j] != 0 and not varies(problem, j):  # the state has no forces of sliders
            before = motion.sense[j] * limit
        force = before - problem.spring[j] * leap
        leaps[j] = max(0.0, abs(force) - limit) / problem.spring[j]
        motion.sense[j] = 0
        motion.fresh[j] = 0
        if leaps[j] > 0.0:
            motion.sense[j] = 1 if force > 0.0 else -1
            force = motion.sense[j] * limit
        motion.state[F, j] = force
        kept.works[OF_BASE] += 0.5 * (force * force - before * before) / problem.spring[j] + limit * leaps[j]


@kernel
def slip_with_walls(problem, row, friction, leaps, kept):
    """Add what sliders slip at once with walls that jump."""
    for j in range(leaps.size):
        if leaps[j] > 0.0:
            limit, _, _ = _limit(problem, row, friction, j)
            add_slide(kept, j, leaps[j], limit * leaps[j])


@kernel
def _slip_at_once(problem, row, friction, motion, kept):
    """Let sliders slip until their forces are at their limits."""
    for j in range(motion.sense.size):
        if motion.sense[j] == 0 or not (has_force(problem, j) and varies(problem, j)):
            continue
        limit, _, _ = _limit(problem, row, friction, j)
        force = abs(motion.state[F, j])
        way = max(0.0, force - limit) / problem.spring[j]
        add_slide(kept, j, way, 0.5 * (force + limit) * way)
        motion.state[F, j] = motion.sense[j] * limit


@kernel
def slip_at_start(problem, row, friction, motion, kept):
    """Adapt springs of a motion that goes on to their friction, which may be another; whether they can be.

    Sliders slip at once until the forces are at lower limits, and rest below higher ones.  Where a residual
    flexibility couples them, what one slips at once moves the others: that is not followed.
    """
    coupled = is_coupled(problem)
    for j in range(motion.sense.size):
        if not has_force(problem, j):
            continue
        limit, _, error = _limit(problem, row, friction, j)
        force = motion.state[F, j]
        if abs(force) > limit + error:
            if coupled and abs(force) > limit * _ABOVE:
                return False
            way = (abs(force) - limit) / problem.spring[j]
            add_slide(kept, j, way, 0.5 * (abs(force) + limit) * way)
            motion.state[F, j] = math.copysign(limit, force)
        elif abs(force) < limit * _BELOW:
            motion.sense[j] = 0
    return True


@kernel
def _is_constant(problem, row, j):
    """Whether the normal load of a contact is constant in the interval."""
    constant = True
    for d in range(problem.normal.shape[1]):
        for k in range(1, row.intervals[LOAD_TERMS] if problem.normal[j, d] != 0.0 else 1):
            constant = constant and row.loads[d, k] == 0.0
    return constant


@kernel
def _is_open(problem, row, friction, j):
    """Whether a contact with a spring is without load, or friction, throughout the interval."""
    if not varies(problem, j):
        return friction.kinetic[j] == 0.0 and has_force(problem, j)
    nu = 1.0
    for d in range(problem.normal.shape[1]):
        nu += problem.normal[j, d] * row.loads[d, 0]
    return nu == 0.0 and has_force(problem, j) and _is_constant(problem, row, j)


@kernel
def _rests(problem, row, motion, ties, j):
    """Whether nothing moves in a spring: its limit is constant, and its ends are held."""
    tied = False
    for i in range(motion.sense.size):
        if ties[j, i]:
            tied = True
            if motion.sense[i] != 0:
                return False
    return tied and _is_constant(problem, row, j)


@kernel
def rest_tied(problem, row, friction, motion, ties, rests, order):
    """Bring springs to rest between ends at rest under constant limits; see `elastic.rest_springs`.

    Parameters
    ----------
    problem, row, friction, motion, ties : see `motions_in_time.follow_record`
    rests : (N,) bool: whether they are at rest
    order : as of `rest_springs`; 0 where an interval begins, at which limits begin to change
    """
    for j in range(motion.sense.size):
        if not (has_force(problem, j) and varies(problem, j)):
            continue
        rested, rests[j] = rests[j], _rests(problem, row, motion, ties, j)
        limit, _, error = _limit(problem, row, friction, j)
        if rests[j]:
            if motion.sense[j] != 0:
                motion.state[F, j] = motion.sense[j] * limit
            motion.sense[j] = motion.fresh[j] = 0
            motion.idle[j] = True
        elif rested:
            motion.idle[j] = False
            if order > 0 and abs(motion.state[F, j]) >= limit - error:
                sign = 1 if motion.state[F, j] > 0.0 else -1
                motion.state[F, j] = sign * limit
                motion.fresh[j] = sign * (1 + order)


@kernel
def _bend(problem, row, friction, motion, direct):
    """Stop sliders whose limits rise faster than their forces, or turn them at a limit of 0."""
    for j in range(motion.sense.size):
        if not (has_force(problem, j) and (varies(problem, j) or bends(direct[j : j + 1]))):
            continue
        limit, rate, error = _limit(problem, row, friction, j)
        w, lag = slide_velocity(problem, row, motion, j), rate / problem.spring[j]
        if limit <= error:  # no force, and the velocity alone decides
            motion.state[F, j] = 0.0
            motion.fresh[j] = 0
            motion.sense[j] = (1 if w > 0.0 else -1) if abs(w) > lag else 0
        elif motion.sense[j] != 0 and motion.sense[j] * w - lag < -_AT_REST * (abs(w) + abs(lag)):
            motion.fresh[j] = motion.sense[j]
            motion.sense[j] = 0
        motion.idle[j] = motion.sense[j] == 0 and _is_open(problem, row, friction, j)


@kernel
def turn_open(problem, row, friction, motion, before):
    """Let sliders of open contacts turn where they would stop, and rest where they rested before an event."""
    for j in range(motion.sense.size):
        if motion.sense[j] == 0 and _is_open(problem, row, friction, j):
            motion.sense[j] = -int(before[j])
            motion.idle[j] = before[j] == 0
            motion.fresh[j] = 0 if motion.idle[j] else 1


@kernel
def follow_open(problem, row, friction, motion, before):
    """Let sliders of open contacts move as these do in the present step; `before` takes their senses.

    Returns
    -------
    bool : whether one has left its rest: the series of the step are those with its spring
    """
    left = False
    for j in range(motion.sense.size):
        before[j] = motion.sense[j]
        if not _is_open(problem, row, friction, j):
            continue
        first, w = motion.fresh[j], velocity_row(problem, j)
        while first < _MOST_ZEROS and motion.series[w, first] == 0.0:
            first += 1
        rests = first == _MOST_ZEROS or (not varies(problem, j) and ends_rest(problem, motion, j))
        motion.sense[j] = 0 if rests else (1 if motion.series[w, first] > 0.0 else -1)
        motion.fresh[j] = 0 if rests else first
        motion.idle[j] = rests
        left = left or (before[j] == 0 and not rests)
    return left


@kernel
def begin_springs(problem, row, friction, motion, kept, before, course, rests, leaps):
    """Decide what springs do under varying normal loads, or at walls that bend, where an interval begins.

    Parameters
    ----------
    problem, row, friction, motion, kept : see `motions_in_time.follow_record`; the polynomials are in
        `row.loads`
    before : (N,) scratch
    course, leaps : see `course.Course`, `follow_walls`
    rests : see `rest_tied`
    """
    motion.clock[0] = math.nan
    set_channels(problem, row, 0.0, 0, motion)
    for part in range(2):
        for j in range(motion.sense.size):
            before[j] = motion.sense[j]
        if part == 0:
            _jump(problem, row, friction, motion, kept)
            follow_walls(problem, row, friction, motion, leaps, kept)
        else:
            _slip_at_once(problem, row, friction, motion, kept)
            slip_with_walls(problem, row, friction, leaps, kept)
            _bend(problem, row, friction, motion, course.direct)
            rest_tied(problem, row, friction, motion, course.ties, rests, 0)
        list_changes(row, motion, before, 0.0, kept)

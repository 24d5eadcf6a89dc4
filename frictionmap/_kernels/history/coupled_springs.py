"""Coupled springs where an interval of a record begins.

A load that displaces contacts beside the modes does so at once.  Where its slope jumps, so do the rates of
all forces, and the velocities of sliders: each of these slips on, or stops.  Where the load itself jumps,
forces and sliders follow as they follow the same change in a time that is short beside all periods, in which
the modes stay: in straight pieces, each of which ends where one more force is at its limit.
"""

import math

from ..compiler import kernel, late_kernel
from ..general.laws.coupled import (
    ALONG,
    FORCE,
    FREE,
    LEAP,
    LIMIT,
    OWN,
    SIDE,
    SIZE,
    SLIDE,
    begin_phases,
    find_pattern,
)
from ..general.problem import F, H, P, slide_velocity
from ..general.row import set_channels
from .kept import OF_BASE, add_slide, list_changes

#: Pieces of the way of a jump, at most: each contact reaches its limits a few times.
_MOST_PIECES = 2000


@kernel
def _fill_sides(problem, friction, motion, box):
    """Fill the sides of the contacts at their limits, which are constant, and the sizes of rates by OWN."""
    contacts, flexibility = motion.sense.size, problem.coupling.flexibility
    for j in range(contacts):
        box[SIDE, j] = motion.sense[j]
        if motion.sense[j] == 0 and motion.fresh[j] != 0:  # a spring that is at its limit
            box[SIDE, j] = 1 if motion.fresh[j] > 0 else -1
        box[ALONG, j], box[LIMIT, j] = 0.0, friction.kinetic[j]
        box[SIZE, j] = 0.0
        for i in range(contacts):
            box[SIZE, j] += abs(flexibility[j, i]) * problem.coupling.stiffest[i] * box[OWN, i]


@kernel
def _fill_rates(problem, row, motion, box):
    """Fill the velocities in the contacts without forces, and the sizes of their terms."""
    modes, channels = problem.push.shape
    for j in range(motion.sense.size):
        box[FREE, j] = slide_velocity(problem, row, motion, j)
        box[OWN, j] = abs(row.numbers[H] * problem.belt[j])
        for m in range(modes):
            box[OWN, j] += abs(problem.chi[j, m] * motion.state[P, m])
        for d in range(channels):
            box[OWN, j] += abs(problem.base[j, d] * motion.series[modes + d, 1])


@kernel
def _bend(problem, row, friction, motion, box):
    """Let sliders stop or slip on with the present velocities; False if no pattern was found."""
    _fill_rates(problem, row, motion, box)
    _fill_sides(problem, friction, motion, box)
    at_limit = False
    for j in range(motion.sense.size):
        at_limit = at_limit or box[SIDE, j] != 0.0
    if not at_limit:
        return True
    if not find_pattern(problem, motion, box):
        return False
    begin_phases(problem, motion, -1, box)
    return True


@kernel
def _next_limit(motion, box, left):
    """Return (step, contact, side) of the next force at a limit on the rest of the way; -1: none."""
    step, contact, side = left, -1, 0
    for j in range(motion.sense.size):
        rate = box[FORCE, j]
        if motion.sense[j] != 0 or rate == 0.0 or box[SIDE, j] * rate > 0.0:
            continue  # it slips, or its rate is rounding error
        sign = 1 if rate > 0.0 else -1
        reach = max(0.0, box[LIMIT, j] - sign * motion.state[F, j]) / abs(rate)
        if reach < step:
            step, contact, side = reach, j, sign
    return step, contact, side


@kernel
def _take_piece(motion, box, step, kept):
    """Take a piece of the way: forces, slides, work on the walls."""
    for j in range(motion.sense.size):
        before = motion.state[F, j]
        if motion.sense[j] != 0:
            way = step * abs(box[SLIDE, j])
            motion.state[F, j] = motion.sense[j] * box[LIMIT, j]
            add_slide(kept, j, way, way * box[LIMIT, j])
        else:
            motion.state[F, j] = before + step * box[FORCE, j]
            if box[SIDE, j] * box[FORCE, j] < 0.0:
                box[SIDE, j] = 0.0
        kept.works[OF_BASE] += 0.5 * step * box[FREE, j] * (before + motion.state[F, j])


@kernel
def _jump(problem, row, friction, motion, kept, before, box):
    """Follow walls that jump; False if no pattern was found.

    Parameters
    ----------
    problem, row, friction, motion, kept, before, box : see `begin_coupled`
    """
    jumps = False
    for j in range(motion.sense.size):
        box[FREE, j], box[OWN, j] = -box[LEAP, j], abs(box[LEAP, j])
        jumps = jumps or box[LEAP, j] != 0.0
    if not jumps:
        return True
    _fill_sides(problem, friction, motion, box)
    left = 1.0
    for _ in range(_MOST_PIECES):
        if not find_pattern(problem, motion, box):
            return False
        list_changes(row, motion, before, 0.0, kept)
        step, contact, side = _next_limit(motion, box, left)
        _take_piece(motion, box, step, kept)
        left -= step
        for j in range(motion.sense.size):
            before[j] = motion.sense[j]
            motion.fresh[j] = int(2.0 * box[SIDE, j]) if motion.sense[j] == 0 else 0
        if contact < 0:
            return True
        motion.state[F, contact] = side * box[LIMIT, contact]
        motion.sense[contact], box[SIDE, contact] = side, side
    return False


@late_kernel(bool)
def begin_coupled(problem, row, friction, motion, kept, before, box):
    """Decide what coupled springs do at a jump of the load, or of its slope, where an interval begins.

    Parameters
    ----------
    problem, row, friction, motion, kept : see `motions_in_time.follow_record`; the polynomials are in
        `row.loads`, and no normal load varies
    before : (N,) scratch
    box : (BOX_ROWS, N) scratch; its row LEAP holds how far the walls jump

    Returns
    -------
    bool : False if no pattern was found
    """
    motion.clock[0] = math.nan
    set_channels(problem, row, 0.0, 0, motion)
    for j in range(motion.sense.size):
        before[j] = motion.sense[j]
    if not _jump(problem, row, friction, motion, kept, before, box):
        return False
    if not _bend(problem, row, friction, motion, box):
        return False
    list_changes(row, motion, before, 0.0, kept)
    return True

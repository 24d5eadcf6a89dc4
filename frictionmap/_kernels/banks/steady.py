"""The steady motion of one cell."""

import math
from typing import NamedTuple

import numpy as np

from ... import regimes
from ..compiler import kernel
from ..general.problem import SECTION
from ..phases.problem import FIRST, LAST
from .follow import FOLLOWED, begin_state, follow
from .level import displacement, slipping
from .orbit import (
    copy_state,
    find_orbit,
    go_round,
    keep_orbit,
    leads_there,
    move_orbit,
    put_multiplier,
    state_size,
)
from .record import clear_record
from .step import put_waves

#: Change in a period, over the size of the motion, at which Newton's method is tried; it must have fallen by
#: a factor before it is tried again.
_NEAR, _AGAIN = 0.1, 0.2

#: Change in a period, over the size of the motion, and over the change in the period before, of a motion
#: that has settled except for sliders that creep to a place at their limit.  Each slip is shorter than the
#: one before by less and less, so that they never arrive.
_CREEPS, _SLOW = 1e-6, 0.8

#: Periods between attempts while sliders creep.
_EVERY = 16

#: Change in a period, over the size of the motion, with which a motion counts as steady: from the first
#: attempt of Newton's method, and from a second one to the limits of rounding.
_RETURNS, _RETURNS_AT_LAST = 1e-13, 1e-11

#: Change in a period, over the size of the motion, that is rounding error of a motion that has arrived.
_STILL = 1e-14


class Found(NamedTuple):
    """A steady motion."""

    status: int
    cycles: int  # periods followed
    multiplier: float


@kernel
def _begin(problem, row, cell, motion, grid):
    """Follow a motion from its start, with elements without force, to the section; its code."""
    start, begin = grid.start, grid.begin
    now = motion.now
    for i in range(problem.squares.size):
        now.q[i], now.p[i] = start[0, i], start[1, i]
    put_waves(row, begin, motion)
    motion.tangent.count[0] = 0
    for j in range(problem.moved.size):
        now.level[j], now.sense[j], now.lead[j] = 0, 1, 1
        motion.counts[LAST, j] = motion.counts[FIRST, j] = 0.0
        z = displacement(problem, motion, j)
        for i in range(problem.first[j], problem.first[j + 1]):
            now.place[i], now.side[i], now.turn[i] = z, 0.0, 0
    begin_state(problem, row, cell, begin, motion)
    end = SECTION if begin <= SECTION else SECTION + 2.0 * math.pi
    return follow(problem, row, cell, begin, end, motion)


@kernel
def _put_record(problem, row, cell, motion, memory):
    """Record the orbit from the state in `motion`; its code."""
    clear_record(motion.record)
    motion.tangent.count[0] = 0
    motion.record.active[0] = 1
    code = go_round(problem, row, cell, motion, memory, False)
    motion.record.active[0] = 0
    return code


@kernel
def _arrives(problem, row, cell, motion, memory, search, creeps):
    """Whether the motion from its state, kept as `last`, goes to an orbit that is known, or is found.

    If so, `motion` is there.

    Parameters
    ----------
    problem, row, cell, motion, memory : Problem, Row, Cell, Motion, Memory
    search : whether an orbit is looked for, if none is known
    creeps : see `leads_there`
    """
    copy_state(motion.now, memory.last)
    if memory.known[0] != 0:
        move_orbit(problem, row, cell, motion, memory)
    if memory.known[0] != 0 and leads_there(problem, row, cell, motion, memory, creeps):
        return True
    if creeps:  # sliders come to rest at an edge that the orbit does not know
        memory.known[0] = 0
    copy_state(memory.last, motion.now)
    if memory.known[0] == 0 and search:
        if find_orbit(problem, row, cell, motion, memory, False, False) > 0:
            put_multiplier(motion, memory, False)
            keep_orbit(motion, memory)
            if leads_there(problem, row, cell, motion, memory, creeps):
                return True
        motion.tangent.count[0] = 0
        copy_state(memory.last, motion.now)
    return False


@kernel
def all_slip(problem, motion):
    """Whether all elements of all contacts slip both ways in the last period."""
    for j in range(problem.moved.size):
        if slipping(motion, j) < problem.first[j + 1] - problem.first[j]:
            return False
    return True


@kernel
def find_ahead(problem, row, cell, motion, memory):
    """Find the steady motion near a state at the section, and record it.

    It is the only one up to the places of elements that never slip.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion, memory : Motion, with the state; Memory

    Returns
    -------
    int
        Periods and half periods followed; 0 if none was found.
    """
    passes = 0
    for attempt in range(2):
        count = find_orbit(problem, row, cell, motion, memory, row.odd, attempt == 0)
        if count == 0:
            break
        put_multiplier(motion, memory, row.odd)
        if _put_record(problem, row, cell, motion, memory) != FOLLOWED:
            break
        passes += count + 1
        if memory.off[0] <= (_RETURNS if attempt == 0 else _RETURNS_AT_LAST) * state_size(row, motion.now):
            return passes
    motion.tangent.count[0] = 0
    return 0


@kernel
def find_steady(problem, row, cell, motion, memory, grid):
    """Find the steady motion that a start leads to, and record it.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion : Motion
    memory : Memory, whose orbit may be known up to the places of elements that never slip
    grid : Grid, with the start and the periods followed at most

    Returns
    -------
    Found
    """
    near, before, code = _NEAR, np.inf, _begin(problem, row, cell, motion, grid)
    for cycle in range(grid.cycles):
        if code != FOLLOWED:
            return Found(regimes.TOO_MANY_EVENTS, cycle, np.nan)
        code = go_round(problem, row, cell, motion, memory, False)
        size, off = state_size(row, motion.now), memory.off[0]
        creeps, before = off <= _CREEPS * size and off > _SLOW * before, off
        if code != FOLLOWED:
            continue
        # sliders that creep hardly come nearer
        search = off <= near * size or (creeps and cycle % _EVERY == 0)
        near = min(near, _AGAIN * off / size) if search else near
        found = _arrives(problem, row, cell, motion, memory, search, creeps)
        if found or off <= _STILL * size:
            copy_state(motion.now, memory.last)
            if _put_record(problem, row, cell, motion, memory) == FOLLOWED:
                return Found(regimes.RESOLVED, cycle + 1, memory.radius[0] if found else np.nan)
            copy_state(memory.last, motion.now)
    return Found(regimes.NOT_REACHED, grid.cycles, np.nan)

"""The steady motion of one cell."""

import math
from typing import NamedTuple

import numpy as np

from ... import regimes
from ..compiler import kernel
from ..general.problem import SECTION
from ..phases.problem import FIRST, LAST
from .follow import FOLLOWED, begin_state, follow
from .level import displacement
from .orbit import (
    copy_state,
    find_orbit,
    go_round,
    keep_orbit,
    leads_there,
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
    code = go_round(problem, row, cell, motion, memory)
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
    if memory.known[0] != 0 and leads_there(problem, row, cell, motion, memory, creeps):
        return True
    copy_state(memory.last, motion.now)
    if memory.known[0] == 0 and search:
        if find_orbit(problem, row, cell, motion, memory):
            keep_orbit(motion, memory)
            if leads_there(problem, row, cell, motion, memory, creeps):
                return True
        motion.tangent.count[0] = 0
        copy_state(memory.last, motion.now)
    return False


@kernel
def find_steady(problem, row, cell, motion, memory, grid):
    """Find the steady motion that a start leads to, and record it.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion, memory : Motion, Memory
    grid : Grid, with the start and the periods followed at most

    Returns
    -------
    Found
    """
    near, before, code = _NEAR, np.inf, _begin(problem, row, cell, motion, grid)
    memory.known[0] = 0
    for cycle in range(grid.cycles):
        if code != FOLLOWED:
            return Found(regimes.TOO_MANY_EVENTS, cycle, np.nan)
        code = go_round(problem, row, cell, motion, memory)
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

"""The steady motion of one cell under a periodic load."""

from typing import NamedTuple

import numpy as np

from ... import regimes
from ..compiler import kernel
from .change import clear_counts
from .follow import CHATTERS, FOLLOWED, follow_period, follow_to_section
from .orbit import (
    LONGEST,
    begin_return,
    distance,
    find_orbit,
    go_round,
    multiplier,
    put_state,
    rests,
    state_size,
    take_state,
)
from .pattern import begin_pattern
from .problem import MOVED, OPEN, put_loads
from .record import clear_record

#: Distance from an earlier state, over the size of the motion, at which Newton's method is tried, and for
#: longer periods, which irregular motions seem to have now and then.
_NEAR, _NEAR_LONG = 1e-2, 1e-6
_SHORT = 16

#: The distance must have fallen by this factor before it is tried again.
_AGAIN = 0.1

#: A motion with a larger multiplier is unstable: 1, and the errors of a multiplier of 1.
_STABLE = 1.0 + 1e-7

#: The orbit found is where the motion goes if it is nearer than this, in distances between its returns.
_REACHED = 20.0

#: States that differ by less, over the size of the motion, are the same.
_SAME = 1e-9

#: Returns that a motion is followed over to an orbit in which contacts rest, at most, and distance at which
#: it is there; a contact that slips ever less, and rests in the end, is this far from its place.
_MOST_RETURNS, _ARRIVED = 2000, 1e-11

#: Periods over which a motion that does not return is averaged, at most.
_AVERAGED = 200


class Found(NamedTuple):
    """A steady motion."""

    status: int
    period: int  # in periods of the load; 0 without one
    cycles: int  # periods followed
    multiplier: float
    averaged: int  # periods of the record


@kernel
def _copy_state(state, pattern, into, into_pattern):
    """Copy a state and its pattern."""
    for a in range(state.size):
        into[a] = state[a]
    for a in range(pattern.size):
        into_pattern[a] = pattern[a]


@kernel
def _keep(memory):
    """Keep the state at the section."""
    slot = memory.count[0] % LONGEST
    _copy_state(memory.start, memory.pattern, memory.kept[slot], memory.kept_patterns[slot])
    memory.count[0] += 1


@kernel
def _last_state(memory):
    """Go back to the last state kept."""
    slot = (memory.count[0] - 1) % LONGEST
    _copy_state(memory.kept[slot], memory.kept_patterns[slot], memory.start, memory.pattern)


@kernel
def _distance_back(problem, row, memory, back):
    """Distance of the last state kept from that `back` periods before; infinite if the pattern differs."""
    now, then = (memory.count[0] - 1) % LONGEST, (memory.count[0] - 1 - back) % LONGEST
    for a in range(memory.pattern.size):
        if memory.kept_patterns[now, a] != memory.kept_patterns[then, a]:
            return np.inf
    return distance(problem, row, memory.kept[now], memory.kept[then])


@kernel
def _find_return(problem, row, memory):
    """Periods since an earlier state that the last one nearly equals, and their distance; 0 without one."""
    size = state_size(problem, row, memory.start)
    for back in range(1, min(memory.count[0] - 1, LONGEST - 1) + 1):
        off = _distance_back(problem, row, memory, back)
        if off <= memory.near[back] * size:
            memory.near[back] = _AGAIN * off / size
            return back, off
    return 0, 0.0


@kernel
def _begin(problem, row, cell, motion, memory, start):
    """Follow a motion from its start at tau = 0 to the section; its code."""
    for i in range(problem.squares.size):
        motion.q[i], motion.p[i] = start[0, i], row.h * start[1, i]
    for j in range(problem.law.size):
        motion.f[j] = 0.0
        for which in range(3):
            motion.lead[j, which] = 0
    memory.count[0] = 0
    for back in range(memory.near.size):
        memory.near[back] = _NEAR if back <= _SHORT else _NEAR_LONG
    put_loads(row, 0.0, motion.drive)
    if not begin_pattern(problem, row, cell, motion):
        return CHATTERS
    code = follow_to_section(problem, row, cell, 0.0, motion)
    take_state(problem, motion, memory.start, memory.pattern)
    return code


@kernel
def _put_record(problem, row, cell, motion, memory, periods):
    """Record some periods of the motion from the state in `memory`; its code."""
    begin_return(problem, row, cell, motion, memory)
    clear_record(motion.record)
    motion.record.active[0] = 1
    code = go_round(problem, row, cell, motion, periods, False)
    motion.record.active[0] = 0
    return code


@kernel
def _least_period(problem, row, cell, motion, memory, periods):
    """The least number of periods after which the orbit in `memory` returns; 0 if it cannot be followed."""
    for shorter in range(1, periods):
        if periods % shorter != 0:
            continue
        begin_return(problem, row, cell, motion, memory)
        if go_round(problem, row, cell, motion, shorter, False) != FOLLOWED:
            return 0
        take_state(problem, motion, memory.end, memory.end_pattern)
        size = state_size(problem, row, memory.start)
        if distance(problem, row, memory.start, memory.end) <= _SAME * size:
            return shorter if find_orbit(problem, row, cell, motion, memory, shorter) else 0
    return periods


@kernel
def _mark_rests(problem, motion):
    """Mark the contacts that rest in the whole orbit; their number."""
    count = 0
    for j in range(problem.law.size):
        motion.trial[1, j] = 1 if rests(problem, motion, j) else 0
        count += motion.trial[1, j]
    return count


@kernel
def _slipped(motion):
    """Whether a contact that is marked has slipped or been open."""
    for j in range(motion.sense.size):
        counts = motion.counts
        if motion.trial[1, j] != 0 and (counts[MOVED, j] != 0.0 or counts[OPEN, j] != 0.0):
            return True
    return False


@kernel
def _keeps_places(problem, row, cell, motion, memory, periods):
    """Whether contacts that rest in the orbit in `memory` do not slip on the way there from the last state.

    Their places decide where the orbit is, and are those of the last slip.
    """
    begin_return(problem, row, cell, motion, memory)
    if go_round(problem, row, cell, motion, periods, False) != FOLLOWED:
        return False
    if _mark_rests(problem, motion) == 0:
        return True
    orbit, pattern = memory.kept[LONGEST], memory.kept_patterns[LONGEST]
    _copy_state(memory.start, memory.pattern, orbit, pattern)
    size = state_size(problem, row, orbit)
    _last_state(memory)
    arrives = distance(problem, row, memory.start, orbit) <= _ARRIVED * size
    for _ in range(_MOST_RETURNS):
        if arrives:
            break
        begin_return(problem, row, cell, motion, memory)
        if go_round(problem, row, cell, motion, periods, False) != FOLLOWED or _slipped(motion):
            break
        take_state(problem, motion, memory.start, memory.pattern)
        arrives = distance(problem, row, memory.start, orbit) <= _ARRIVED * size
    _copy_state(orbit, pattern, memory.start, memory.pattern)
    return arrives


@kernel
def _try_orbit(problem, row, cell, motion, memory, back, off):
    """Look for the orbit near the last state; its periods, 0 without one, and its multiplier.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion, memory : Motion, Memory; if one is found, `start` is its state
    back : periods after which the motion nearly returned
    off : distance of that return
    """
    if not find_orbit(problem, row, cell, motion, memory, back):
        return 0, 0.0
    found = multiplier(problem, motion, memory)
    last = memory.kept[(memory.count[0] - 1) % LONGEST]
    way = distance(problem, row, memory.start, last)
    # with the multiplier m, returns sum up to 1/(1 - m) times the last one
    near = way * max(1.0 - found, 1e-3) <= _REACHED * off
    if not (found <= _STABLE and (near or way <= _SAME * state_size(problem, row, memory.start))):
        return 0, 0.0
    periods = _least_period(problem, row, cell, motion, memory, back)
    if 0 < periods < back:
        found = multiplier(problem, motion, memory)
    if periods > 0 and not _keeps_places(problem, row, cell, motion, memory, periods):
        return 0, 0.0
    return periods, found


@kernel
def find_steady(problem, row, cell, motion, memory, start, cycles):
    """Find the steady motion that a start leads to, and record it.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion, memory : Motion, Memory
    start : (2, m) modes and their velocities q' at tau = 0
    cycles : periods followed at most

    Returns
    -------
    Found
    """
    code = _begin(problem, row, cell, motion, memory, start)
    for cycle in range(cycles):
        if code != FOLLOWED:
            return Found(regimes.TOO_MANY_EVENTS, 0, cycle, np.nan, 0)
        _keep(memory)
        back, off = _find_return(problem, row, memory)
        if back > 0:
            periods, found = _try_orbit(problem, row, cell, motion, memory, back, off)
            if periods > 0 and _put_record(problem, row, cell, motion, memory, periods) == FOLLOWED:
                return Found(regimes.RESOLVED, periods, cycle, found, periods)
            _last_state(memory)
        put_state(problem, motion, memory.start, memory.pattern)
        begin_return(problem, row, cell, motion, memory)
        code = follow_period(problem, row, cell, motion, False)
        take_state(problem, motion, memory.start, memory.pattern)
    if code != FOLLOWED:
        return Found(regimes.TOO_MANY_EVENTS, 0, cycles, np.nan, 0)
    clear_counts(motion)
    many = min(cycles, _AVERAGED)
    if _put_record(problem, row, cell, motion, memory, many) != FOLLOWED:
        return Found(regimes.TOO_MANY_EVENTS, 0, cycles, np.nan, 0)
    return Found(regimes.IRREGULAR, 0, cycles, np.nan, many)

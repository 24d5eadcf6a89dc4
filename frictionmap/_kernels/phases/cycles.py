"""Motions on belts without a load: whether they settle, and the cycles that they go to, of unknown period.

Time is counted in steps, h over omega_1.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..spectral_radius import spectral_radius
from .change import clear_counts
from .follow import FOLLOWED, INSTANT, MOST_IMMEDIATE, follow_time, pass_event, step_on
from .orbit import (
    begin_return,
    distance,
    keep_places,
    put_state,
    remove_rests,
    rests,
    solve,
    state_size,
    take_state,
)
from .pattern import begin_pattern, rest_tied
from .problem import MOVED, OPEN
from .record import clear_record
from .series import begin_terms, factor_held
from .tangent import begin_tangent

#: Events that are kept.
_KEPT = 96

#: Distance from the state at an earlier event, over the size of the motion, at which Newton's method is
#: tried; it must have fallen by the factor before it is tried again.
_NEAR, _AGAIN = 1e-2, 0.1

#: Steps of Newton's method, at most, and change on return, over the size, that is rounding error, or is
#: accepted where it does not fall any more.
_MOST_STEPS = 15
_CONVERGED, _ACCEPTED = 1e-14, 1e-11

#: A cycle with a larger multiplier is unstable; the orbit found is where the motion goes if it is nearer than
#: this, in distances between its returns.
_STABLE = 1.0 + 1e-7
_REACHED = 20.0

#: States that differ by less, over the size of the motion, are the same; and parts of a period tried.
_SAME = 1e-9
_MOST_PARTS = 8

#: Returns over which contacts that rest in a cycle must not slip on the way there.
_RETURNS = 40

#: Slowest periods without an event, over which the velocities fall, after which a motion settles.
_QUIET = 2.0

#: Rows of `Motion.scratch`: rates of the coordinates at both ends of a cycle.
_FLOW, _END_FLOW = 3, 4

#: What becomes of a motion.
SETTLES, REPEATS, WANDERS, FAILS = 0, 1, 2, 3


class Events(NamedTuple):
    """The last events of a motion."""

    states: np.ndarray  # (_KEPT, size)
    kinds: np.ndarray  # (_KEPT,) int
    times: np.ndarray  # (_KEPT,) in steps
    near: np.ndarray  # (_KEPT,) distance at which Newton's method is tried, per number of events
    count: np.ndarray  # (1,) int
    leads: np.ndarray  # (N, 3) int, as in a motion just after the last one
    lead_springs: np.ndarray  # (S, 2) int


@entry
def make_events(problem, size):
    """Allocate the last events."""
    contacts, springs = problem.law.size, problem.along.shape[0]
    return Events(
        np.zeros((_KEPT, size)), np.zeros(_KEPT, np.int64), np.zeros(_KEPT), np.zeros(_KEPT),
        np.zeros(1, np.int64), np.zeros((contacts, 3), np.int64), np.zeros((springs, 2), np.int64),
    )  # fmt: skip


class Cycle(NamedTuple):
    """A steady motion without a load."""

    code: int  # SETTLES, REPEATS, WANDERS or FAILS
    time: float  # of the cycle, or of the record; in steps
    multiplier: float


@kernel
def _kind(motion, who, what):
    """A number of an event and of the pattern before it."""
    number = 3 * who + what
    for j in range(motion.sense.size):
        number = 6 * number + 2 * (motion.sense[j] + 1) + motion.open[j]
    for s in range(motion.piece.size):
        number = 32 * number + motion.piece[s]
    return number


@kernel
def _keep_event(problem, motion, memory, events, kind, time):
    """Keep the state at an event, before its pattern changes."""
    slot = events.count[0] % _KEPT
    take_state(problem, motion, events.states[slot], memory.end_pattern)
    events.kinds[slot], events.times[slot] = kind, time
    events.count[0] += 1


@kernel
def _find_return(problem, row, events):
    """Events since the last one with nearly the same state, and the distance; 0 without one."""
    last = (events.count[0] - 1) % _KEPT
    size = state_size(problem, row, events.states[last])
    for back in range(1, min(events.count[0] - 1, _KEPT - 2) + 1):
        slot = (events.count[0] - 1 - back) % _KEPT
        if events.kinds[slot] != events.kinds[last] or events.times[slot] == events.times[last]:
            continue
        off = distance(problem, row, events.states[last], events.states[slot])
        if off <= events.near[back] * size:
            events.near[back] = _AGAIN * off / size
            return back, off
    return 0, 0.0


@kernel
def _longest_phase(events, back):
    """Time from the event `back` events ago to the middle of the longest phase since."""
    begin = events.times[(events.count[0] - 1 - back) % _KEPT]
    longest, middle = -1.0, 0.0
    for k in range(back):
        first = events.times[(events.count[0] - 1 - back + k) % _KEPT]
        second = events.times[(events.count[0] - back + k) % _KEPT]
        if second - first > longest:
            longest, middle = second - first, 0.5 * (first + second) - begin
    return middle


@kernel
def _put_flow(problem, row, cell, motion, out):
    """Rates of the coordinates by the time in steps."""
    modes = problem.squares.size
    begin_terms(problem, row, cell, motion, 2)
    for i in range(modes):
        out[i], out[modes + i] = motion.p[i], 2.0 * motion.terms.moves[2, i]
    for j in range(problem.law.size):
        if problem.place[j] >= 0:
            out[problem.place[j]] = motion.terms.force[1, j]


@kernel
def _put_equations(problem, motion, memory):
    """Fill the equations for the changes of the state and of the period."""
    size = motion.tangent.shape[0]
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = (1.0 if a == b else 0.0) - motion.tangent[a, b]
        memory.matrix[a, size] = -motion.scratch[_END_FLOW, a]
        memory.matrix[size, a] = motion.scratch[_FLOW, a]
        memory.right[a] = memory.end[a] - memory.start[a]
    memory.matrix[size, size] = memory.right[size] = 0.0
    for j in range(problem.law.size):
        place = problem.place[j]
        if place >= 0 and (memory.pattern[j] != 0 or memory.pattern[problem.law.size + j] != 0):
            for b in range(size + 1):
                memory.matrix[place, b] = 1.0 if b == place else 0.0
            memory.right[place] = 0.0


@kernel
def _find_cycle(problem, row, cell, motion, memory, time):
    """Find the state that returns, and its period, from the state in `memory`; the period, or -1.

    `tangent` becomes that of the cycle.
    """
    size, last = motion.tangent.shape[0], np.inf
    for _ in range(_MOST_STEPS):
        if not begin_return(problem, row, cell, motion, memory):
            return -1.0
        begin_tangent(problem, row, motion)
        _put_flow(problem, row, cell, motion, motion.scratch[_FLOW])
        if follow_time(problem, row, cell, time, motion, True) != FOLLOWED:
            return -1.0
        take_state(problem, motion, memory.end, memory.end_pattern)
        _put_flow(problem, row, cell, motion, motion.scratch[_END_FLOW])
        whole = state_size(problem, row, memory.start)
        off = distance(problem, row, memory.start, memory.end)
        if off <= _CONVERGED * whole or (off <= _ACCEPTED * whole and off > 0.25 * last):
            return time
        if off > whole or off > 100.0 * last:
            return -1.0
        last = off
        _put_equations(problem, motion, memory)
        keep_places(problem, motion, memory, size)
        solve(memory)
        for a in range(size):
            memory.start[a] += memory.right[a]
        change = memory.right[size]
        if abs(change) > 0.5 * time:
            return -1.0
        time += change
    return -1.0


@kernel
def _multiplier(problem, motion, memory):
    """Largest modulus of the multipliers, without the 1 along the orbit and those of contacts that rest."""
    size, flow = motion.tangent.shape[0], motion.scratch[_FLOW]
    square = 0.0
    for a in range(size):
        square += flow[a] * flow[a]
        for b in range(size):
            memory.matrix[a, b] = motion.tangent[a, b]
    for b in range(size):
        sum_ = 0.0
        for a in range(size):
            sum_ += flow[a] * motion.tangent[a, b]
        for a in range(size):
            memory.matrix[a, b] -= flow[a] * sum_ / square
    remove_rests(problem, motion, memory, size)
    return spectral_radius(memory.matrix, size, memory.square, 0.0)


@kernel
def _least_time(problem, row, cell, motion, memory, time):
    """The least part of a period after which the cycle in `memory` returns; -1 if it cannot be followed."""
    for parts in range(_MOST_PARTS, 1, -1):
        begin_return(problem, row, cell, motion, memory)
        if follow_time(problem, row, cell, time / parts, motion, False) != FOLLOWED:
            return -1.0
        take_state(problem, motion, memory.end, memory.end_pattern)
        whole = state_size(problem, row, memory.start)
        if distance(problem, row, memory.start, memory.end) <= _SAME * whole:
            return _find_cycle(problem, row, cell, motion, memory, time / parts)
    return _find_cycle(problem, row, cell, motion, memory, time)


@kernel
def _keeps_places(problem, row, cell, motion, memory, guess, period):
    """Whether contacts that rest in the cycle just followed do not slip on the way there; see `steady`.

    Parameters
    ----------
    problem, row, cell, motion, memory : Problem, Row, Cell, Motion, Memory
    guess : state from which the cycle was found
    period : time of a return
    """
    resting = motion.trial[1]
    any_rests = False
    for j in range(problem.law.size):
        resting[j] = 1 if rests(problem, motion, j) else 0
        any_rests = any_rests or resting[j] != 0
    if not any_rests:
        return True
    orbit, keeps = memory.kept[2], True
    for a in range(orbit.size):
        orbit[a], memory.start[a] = memory.start[a], guess[a]
    for a in range(memory.pattern.size):
        memory.kept_patterns[2, a] = memory.pattern[a]
    begin_return(problem, row, cell, motion, memory)
    for _ in range(_RETURNS):
        keeps = keeps and follow_time(problem, row, cell, period, motion, False) == FOLLOWED
    for j in range(problem.law.size):
        slips = motion.counts[MOVED, j] != 0.0 or motion.counts[OPEN, j] != 0.0
        keeps = keeps and not (resting[j] != 0 and slips)
    for a in range(orbit.size):
        memory.start[a] = orbit[a]
    for a in range(memory.pattern.size):
        memory.pattern[a] = memory.kept_patterns[2, a]
    return keeps


@kernel
def _try_cycle(problem, row, cell, motion, memory, events, back, off):
    """Look for a cycle near the last event; its period and its multiplier, or -1.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion : Motion just after the last event
    memory : Memory; if a cycle is found, `start` is a state of it
    events : Events
    back : events since the motion was nearly in this state
    off : distance of that return
    """
    now = events.times[(events.count[0] - 1) % _KEPT]
    period = now - events.times[(events.count[0] - 1 - back) % _KEPT]
    if follow_time(problem, row, cell, _longest_phase(events, back), motion, False) != FOLLOWED:
        return -1.0, 0.0
    take_state(problem, motion, memory.start, memory.pattern)
    guess = memory.kept[0]
    for a in range(memory.start.size):
        guess[a] = memory.start[a]
    time = _find_cycle(problem, row, cell, motion, memory, period)
    if time < 0.0:
        return -1.0, 0.0
    found = _multiplier(problem, motion, memory)
    way = distance(problem, row, memory.start, guess)
    near = way * max(1.0 - found, 1e-3) <= _REACHED * off
    if found > _STABLE or not (near or way <= _SAME * state_size(problem, row, memory.start)):
        return -1.0, 0.0
    time = _least_time(problem, row, cell, motion, memory, time)
    if time < 0.0:
        return -1.0, 0.0
    found = _multiplier(problem, motion, memory)
    if not _keeps_places(problem, row, cell, motion, memory, guess, period):
        return -1.0, 0.0
    return time, found


@kernel
def _save(problem, motion, memory, events):
    """Keep a motion just after an event."""
    take_state(problem, motion, memory.kept[1], memory.kept_patterns[1])
    for j in range(problem.law.size):
        for which in range(3):
            events.leads[j, which] = motion.lead[j, which]
    for s in range(motion.piece.size):
        for which in range(2):
            events.lead_springs[s, which] = motion.lead_spring[s, which]


@kernel
def _restore(problem, cell, motion, memory, events):
    """Go back to the motion that was kept."""
    put_state(problem, motion, memory.kept[1], memory.kept_patterns[1])
    rest_tied(problem, cell, motion)
    for j in range(problem.law.size):
        for which in range(3):
            motion.lead[j, which] = events.leads[j, which]
    for s in range(motion.piece.size):
        for which in range(2):
            motion.lead_spring[s, which] = events.lead_springs[s, which]


@kernel
def _speed(problem, motion):
    """Largest velocity of the modes."""
    found = 0.0
    for i in range(problem.squares.size):
        found = max(found, abs(motion.p[i]))
    return found


@kernel
def _record(problem, row, cell, motion, memory, time):
    """Record a motion from the state in `memory` for some time; its code."""
    begin_return(problem, row, cell, motion, memory)
    clear_record(motion.record)
    motion.record.active[0] = 1
    code = follow_time(problem, row, cell, time, motion, False)
    motion.record.active[0] = 0
    return code


@kernel
def _begin(problem, row, cell, motion, events, start):
    """Begin a motion; False if its pattern is not determined."""
    for i in range(problem.squares.size):
        motion.q[i], motion.p[i] = start[0, i], row.h * start[1, i]
    for j in range(problem.law.size):
        motion.f[j] = 0.0
        for which in range(3):
            motion.lead[j, which] = 0
    clear_counts(motion)
    events.count[0] = 0
    for back in range(_KEPT):
        events.near[back] = _NEAR
    return begin_pattern(problem, row, cell, motion)


@kernel
def find_cycle(problem, row, cell, motion, memory, events, start, limits):
    """Find the steady motion that a start leads to, and record it.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion, memory, events : Motion; Memory, Events for one more coordinate than a state has
    start : (2, m) modes and their velocities
    limits : slowest period of small vibrations and time that a motion is followed at most, in steps, and
        whether a motion may settle

    Returns
    -------
    Cycle
    """
    slowest, longest, settles = limits
    if not _begin(problem, row, cell, motion, events, start):
        return Cycle(FAILS, 0.0, np.nan)
    time, quiet, before, highest, immediate = 0.0, 0.0, np.inf, 0.0, 0
    while time < longest:
        step, who, what = step_on(problem, row, cell, 0.0, -1, 1.0, motion, False)
        time += step
        immediate = immediate + 1 if step <= INSTANT else 0
        if immediate > MOST_IMMEDIATE:
            return Cycle(FAILS, time, np.nan)
        if who < 0:
            highest = max(highest, _speed(problem, motion))
            if time - quiet > _QUIET * slowest:
                if settles and highest < before < np.inf:
                    take_state(problem, motion, memory.start, memory.pattern)
                    return Cycle(SETTLES, time, np.nan)
                quiet, before, highest = time, highest, 0.0
            continue
        quiet, before, highest = time, np.inf, 0.0
        _keep_event(problem, motion, memory, events, _kind(motion, who, what), time)
        if not pass_event(problem, row, cell, 0.0, motion, who, what, False):
            return Cycle(FAILS, time, np.nan)
        back, off = _find_return(problem, row, events)
        if back == 0:
            continue
        _save(problem, motion, memory, events)
        period, found = _try_cycle(problem, row, cell, motion, memory, events, back, off)
        if period > 0.0 and _record(problem, row, cell, motion, memory, period) == FOLLOWED:
            return Cycle(REPEATS, period, found)
        _restore(problem, cell, motion, memory, events)
        if not factor_held(problem, row, motion):
            return Cycle(FAILS, time, np.nan)
    take_state(problem, motion, memory.start, memory.pattern)
    averaged = 0.1 * longest
    if _record(problem, row, cell, motion, memory, averaged) != FOLLOWED:
        return Cycle(FAILS, time, np.nan)
    return Cycle(WANDERS, averaged, np.nan)

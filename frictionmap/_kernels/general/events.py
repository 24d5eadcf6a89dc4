"""Turns, stops and the slowest instants of slides, from one phase of the load to another.

A slide in which the speed has a least value above zero is near to a stop there; see `theory.md` 11.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..compiler.vectors import LANES, filled, load, magnitude, total
from .crossings import first_zero, next_turn, slope_at, value_at
from .problem import TERMS, WIDTH, H, first_contact_row

#: Turns, and stops, that are listed; further ones are counted.
MOST = 256

#: Columns of `turns` and `stops`.  A stop that began before the time listed has a negative begin.
CONTACT, TIME, LENGTH = 0, 1, 2

#: Places in `counts`.
TURNS_LISTED, STOPS_LISTED = 0, 1

#: Rows of `speeds`: least at a minimum inside a slide, infinite where there is none; and largest, of both in
#: units of the interval.
SLOWEST, FASTEST = 0, 1

#: Rows of `last`: sense in the last step, NaN before the first; its slope of the speed at the end; begin of
#: the present stop; whether the contact has moved up, and down.
_SENSE, _SLOPE, _BEGIN, UP, DOWN = 0, 1, 2, 3, 4

_RATE = 5  # row of the scratch


class Events(NamedTuple):
    """What N contacts do over some time."""

    clock: np.ndarray  # (1,) time since the beginning
    counts: np.ndarray  # (2,) int
    turns: np.ndarray  # (MOST, 2) in their order
    stops: np.ndarray  # (MOST, 3)
    speeds: np.ndarray  # (2, N)
    last: np.ndarray  # (5, N)


@entry
def make_events(contacts, most):
    """Allocate the lists of N contacts, for `most` turns and as many stops."""
    return Events(
        np.zeros(1), np.zeros(2, np.int64), np.zeros((most, 2)), np.zeros((most, 3)), np.zeros((2, contacts)),
        np.zeros((5, contacts)),
    )  # fmt: skip


@kernel
def clear_events(events):
    """Begin a list."""
    events.clock[0] = 0.0
    events.counts[TURNS_LISTED] = events.counts[STOPS_LISTED] = 0
    for j in range(events.last.shape[1]):
        events.last[_SENSE, j] = math.nan
        events.last[_SLOPE, j] = events.last[UP, j] = events.last[DOWN, j] = 0.0
        events.last[_BEGIN, j] = -1.0
        events.speeds[SLOWEST, j] = math.inf
        events.speeds[FASTEST, j] = 0.0


@kernel
def _list_turn(events, j):
    """List a turn of contact j."""
    k = events.counts[TURNS_LISTED]
    if k < events.turns.shape[0]:
        events.turns[k, CONTACT] = j
        events.turns[k, TIME] = events.clock[0]
    events.counts[TURNS_LISTED] = k + 1


@kernel
def _list_stop(events, j, begin, length):
    """List a stop of contact j."""
    k = events.counts[STOPS_LISTED]
    if k < events.stops.shape[0]:
        events.stops[k, CONTACT] = j
        events.stops[k, TIME] = begin
        events.stops[k, LENGTH] = length
    events.counts[STOPS_LISTED] = k + 1


@kernel
def _list_change(events, j, before, sense):
    """List what happened when the sense of contact j changed."""
    begin = events.last[_BEGIN, j]
    if sense == 0:
        events.last[_BEGIN, j] = events.clock[0]
    elif before == 0.0:
        _list_stop(events, j, begin, events.clock[0] - max(begin, 0.0))
    else:
        _list_turn(events, j)


@kernel
def _lowest(series, at, sense):
    """A value that a series, times the sense, is nowhere in its step below."""
    varies = filled(0.0)
    for k in range(0, WIDTH, LANES):
        varies = varies + magnitude(load(series, at * WIDTH + k))
    return sense * series[at, 0] - (total(varies) - abs(series[at, 0]))


@kernel
def _keep_minima(series, at, end, sense, scratch, events, j):
    """Include the minima of a speed inside the present step.

    Parameters
    ----------
    series, at : series and the row of the velocity
    end : end of the step in x
    sense : of the slide
    scratch : scratch
    events, j : Events, contact
    """
    first = 0
    while first < TERMS - 2 and series[at, first + 1] == 0.0:
        first += 1
    sign = sense if series[at, first + 1] > 0.0 else -sense
    for k in range(TERMS):
        scratch[_RATE, k] = 0.0
    for k in range(TERMS - first - 1):
        scratch[_RATE, k] = sense * sign * (k + first + 1.0) * series[at, k + first + 1]
    x = first_zero(scratch, _RATE)
    while x < end:
        if sign < 0.0:
            events.speeds[SLOWEST, j] = min(events.speeds[SLOWEST, j], sense * value_at(series, at, x))
        sign = -sign
        x = next_turn(series, at, x, sense * sign, scratch, _RATE)


@kernel
def _keep_speeds(series, at, end, sense, goes_on, scratch, events, j):
    """Include the speeds of a slide in the present step.

    Where another contact changes its sense, the slope of the speed jumps: a minimum may lie there.

    Parameters
    ----------
    series, at : series and the row of the velocity
    end : end of the step in x
    sense : of the slide
    goes_on : whether the slide began before the step
    scratch : scratch
    events, j : Events, contact
    """
    speed = sense * series[at, 0]
    if goes_on and events.last[_SLOPE, j] < 0.0 and sense * series[at, 1] >= 0.0:
        events.speeds[SLOWEST, j] = min(events.speeds[SLOWEST, j], speed)
    events.speeds[FASTEST, j] = max(events.speeds[FASTEST, j], speed)
    events.last[_SLOPE, j] = sense * slope_at(series, at, end)
    if _lowest(series, at, sense) < events.speeds[SLOWEST, j]:
        _keep_minima(series, at, end, sense, scratch, events, j)


@kernel
def list_step(problem, row, motion, end, events):
    """List what happened at the beginning of the present step, and what happens in it, up to `end` in x."""
    if end == 0.0:  # of several events at one instant the last one counts
        return
    contacts = problem.spring.size
    velocity = first_contact_row(problem) + contacts
    for j in range(contacts):
        sense, before = motion.sense[j], events.last[_SENSE, j]
        changed = sense != before
        if changed and before == before:
            _list_change(events, j, before, sense)
        if sense != 0:
            events.last[UP if sense > 0 else DOWN, j] = 1.0
            _keep_speeds(
                motion.series, velocity + j, end, float(sense), not changed, motion.scratch, events, j
            )
        events.last[_SENSE, j] = sense
    events.clock[0] += end * row.numbers[H]


@kernel
def close_lists(events):
    """End the lists after a whole period, or half of one after which the motion is its mirror image: a stop
    at the end goes on at the beginning.
    """
    whole = events.clock[0]
    listed = min(events.counts[STOPS_LISTED], events.stops.shape[0])
    for j in range(events.last.shape[1]):
        open_ = -1
        for k in range(listed):
            if events.stops[k, CONTACT] == j and events.stops[k, TIME] < 0.0:
                open_ = k
        if open_ >= 0:
            events.stops[open_, TIME] = 0.0
        if events.last[_SENSE, j] != 0.0:
            continue
        begin = max(events.last[_BEGIN, j], 0.0)
        if open_ >= 0:
            events.stops[open_, TIME] = begin - whole
            events.stops[open_, LENGTH] += whole - begin
        else:
            _list_stop(events, j, begin, whole - begin)

"""What a motion does in every period of the load, and its averages if it does not return."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel, late_kernel
from ..logs import CAPACITY, LENGTH, USED, clear_log, is_stationary, make_log, mean_stops, mean_stuck, opened
from .counts import (
    COUNT_ROWS,
    CROSSINGS,
    FIRST_SENSE,
    LAST_SENSE,
    MOVED,
    RELEASE_ORDER,
    REVERSALS,
    SLIPS,
    STOPS,
    STOPS_ERROR,
    STUCK,
    STUCK_ERROR,
    TURNS,
)
from .follow import FOLLOWED, follow
from .laws.speed import count_rows
from .record import HIGH, LEAST_SLIP, LOW, NOTHING, OF_FRICTION, OF_WALL, RANGES, begin_cycle, clear_record
from .recurrence import keep
from .return_map import base_halves, forget_places, put_state, take_state

#: Columns of the log, each for all contacts: numbers that are added over the time ...
_STOPS, _TURNS, _STUCK, _SLIPS, _REVERSALS, _DISTANCE, _WORK, _WALL_WORK = 0, 1, 2, 3, 4, 5, 6, 7
_CROSSINGS = 8
_SUMS = 9  # after them the time in every segment of a friction law

#: ... and, after all of them, those of which the largest counts; then the highest displacements of contacts
#: and masses, and minus the lowest ones.
_MOVED, _RELEASE_ORDER, _MINUS_LEAST_SLIP, _LARGEST = 0, 1, 2, 3
_LARGEST_PER_CONTACT = 4


class Course(NamedTuple):
    """A motion that is followed, cycle by cycle."""

    log: np.ndarray  # (..., columns), see `logs`
    counts: np.ndarray  # counters of the present cycle
    begun: np.ndarray  # (1,) int: periods followed before the log begins
    window: np.ndarray  # (2,) int: slots of the log that averages are of: first, and the one after the last


@entry
def make_course(problem, masses):
    """Allocate a log; `masses` (n, m): see `make_record`."""
    contacts = problem.spring.size
    counts = np.zeros((count_rows(problem), contacts))
    columns = _sums(counts) + _LARGEST_PER_CONTACT * contacts + 2 * (contacts + masses.shape[0])
    return Course(make_log(columns), counts, np.zeros(1, np.int64), np.zeros(2, np.int64))


@kernel
def _segments(counts):
    """Segments of a friction law."""
    return counts.shape[0] - COUNT_ROWS


@kernel
def _sums(counts):
    """Columns of the log that are added over the time, and so the first of those whose largest counts."""
    return (_SUMS + _segments(counts)) * counts.shape[1]


@kernel
def begin_course(followed, memory, record, course):
    """Begin a log after `followed` periods of the load."""
    clear_log(course.log)
    clear_record(record)
    course.begun[0] = followed
    for j in range(memory.senses.size):
        course.counts[LAST_SENSE, j] = memory.senses[j]


@kernel
def _log_cycle(counts, record, log, slot):
    """Add the counters and the record of one cycle to a slot."""
    contacts, first = counts.shape[1], _sums(counts)
    for j in range(contacts):
        log[slot, _STOPS * contacts + j] += counts[STOPS, j]
        log[slot, _TURNS * contacts + j] += counts[TURNS, j]
        log[slot, _STUCK * contacts + j] += counts[STUCK, j]
        log[slot, _SLIPS * contacts + j] += counts[SLIPS, j]
        log[slot, _REVERSALS * contacts + j] += counts[REVERSALS, j]
        log[slot, _DISTANCE * contacts + j] += record.distance[j]
        log[slot, _WORK * contacts + j] += record.works[OF_FRICTION, j]
        log[slot, _WALL_WORK * contacts + j] += record.works[OF_WALL, j]
        log[slot, _CROSSINGS * contacts + j] += counts[CROSSINGS, j]
        for k in range(_segments(counts)):
            log[slot, (_SUMS + k) * contacts + j] += counts[COUNT_ROWS + k, j]
        _raise(log, slot, first + _MOVED * contacts + j, counts[MOVED, j])
        _raise(log, slot, first + _RELEASE_ORDER * contacts + j, counts[RELEASE_ORDER, j])
        _raise(log, slot, first + _MINUS_LEAST_SLIP * contacts + j, -record.slips[LEAST_SLIP, j])
        largest = max(record.ranges[HIGH, j], -record.ranges[LOW, j])
        _raise(log, slot, first + _LARGEST * contacts + j, largest)
    places, first = record.ranges.shape[1], first + _LARGEST_PER_CONTACT * contacts
    for i in range(places):
        _raise(log, slot, first + i, record.ranges[HIGH, i])
        _raise(log, slot, first + places + i, -record.ranges[LOW, i])


@kernel
def _raise(log, slot, column, value):
    """Keep the largest value of a slot."""
    log[slot, column] = max(log[slot, column], value)


@late_kernel(int)
def follow_cycle(problem, friction, followed, workspace):
    """Follow the motion from `memory.start` for a period of the load, and log it.

    Parameters
    ----------
    problem, friction : Problem, Friction
    followed : periods of the load before this one
    workspace : Workspace; `memory.start` is replaced by the state at the end, and the states at the section
        are kept

    Returns
    -------
    int : code of `follow`
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    ring, course = workspace.ring, workspace.course
    counts = course.counts
    put_state(memory.start, memory.senses, motion)
    begin_cycle(record)
    for part in range(counts.shape[0]):
        if part != LAST_SENSE and part != FIRST_SENSE:
            for j in range(counts.shape[1]):
                counts[part, j] = 0.0
    code = FOLLOWED
    record.active[0] = RANGES
    for half in range(2):
        if code == FOLLOWED:
            code = follow(
                problem, row, friction, half * row.intervals[0], row.intervals[0], motion, memory.box, counts,
                record, False,
            )  # fmt: skip
            if half == 1:
                take_state(motion, memory.start, memory.senses, 1.0)
                forget_places(problem, memory.start)
                keep(memory, ring)
            elif base_halves(problem) == 1:  # states are kept with the sign of `go_round`
                take_state(motion, memory.start, memory.senses, -1.0)
                forget_places(problem, memory.start)
                keep(memory, ring)
    record.active[0] = NOTHING
    slot = int((followed - course.begun[0]) / course.log[CAPACITY, LENGTH])
    slot = opened(course.log, slot, _sums(counts), -math.inf)
    _log_cycle(counts, record, course.log, slot)
    return code


@kernel
def set_window(followed, course):
    """Set the window to the last two thirds of the periods followed; the log must contain them."""
    length = course.log[CAPACITY, LENGTH]
    last = min(int((followed - course.begun[0]) / length), int(course.log[CAPACITY, USED]))
    wanted = int((followed - followed // 3) / length)
    course.window[0], course.window[1] = last - min(last, max(wanted, 1)), last


@kernel
def _total(course, column):
    """Sum of a column over the window."""
    total = 0.0
    for k in range(course.window[0], course.window[1]):
        total += course.log[k, column]
    return total


@kernel
def _most(course, column):
    """Largest value of a column over the window."""
    most = -math.inf
    for k in range(course.window[0], course.window[1]):
        most = max(most, course.log[k, column])
    return most


@kernel
def window_stops(course):
    """Whether any contact stops, or slips, in the window."""
    contacts = course.counts.shape[1]
    stops = 0.0
    for j in range(contacts):
        stops += _total(course, _STOPS * contacts + j) + _total(course, _SLIPS * contacts + j)
    return stops > 0.0


@kernel
def window_is_stationary(course):
    """Whether both halves of the window agree in every contact."""
    contacts = course.counts.shape[1]
    largest = _sums(course.counts) + _LARGEST * contacts
    first, last = course.window[0], course.window[1]
    for j in range(contacts):
        columns = (_STOPS * contacts + j, _STUCK * contacts + j, largest + j)
        if not is_stationary(course.log, columns, first, last):
            return False
    return True


@kernel
def take_window(course, counts, record):
    """Fill the counters and the record with those of the whole window; return its half periods."""
    contacts, most = counts.shape[1], _sums(counts)
    first, last = course.window[0], course.window[1]
    for j in range(contacts):
        stops, stuck = _STOPS * contacts + j, _STUCK * contacts + j
        counts[STOPS, j] = _total(course, stops)
        counts[STOPS_ERROR, j] = mean_stops(course.log, stops, first, last).error
        counts[TURNS, j] = _total(course, _TURNS * contacts + j)
        counts[STUCK, j] = _total(course, stuck)
        counts[STUCK_ERROR, j] = mean_stuck(course.log, stuck, first, last).error
        counts[SLIPS, j] = _total(course, _SLIPS * contacts + j)
        counts[REVERSALS, j] = _total(course, _REVERSALS * contacts + j)
        counts[CROSSINGS, j] = _total(course, _CROSSINGS * contacts + j)
        for k in range(_segments(counts)):
            counts[COUNT_ROWS + k, j] = _total(course, (_SUMS + k) * contacts + j)
        counts[MOVED, j] = _most(course, most + _MOVED * contacts + j)
        counts[RELEASE_ORDER, j] = _most(course, most + _RELEASE_ORDER * contacts + j)
        record.distance[j] = _total(course, _DISTANCE * contacts + j)
        record.works[OF_FRICTION, j] = _total(course, _WORK * contacts + j)
        record.works[OF_WALL, j] = _total(course, _WALL_WORK * contacts + j)
    halves = int(2.0 * course.log[CAPACITY, LENGTH] * (last - first))
    for j in range(contacts):
        least = -_most(course, most + _MINUS_LEAST_SLIP * contacts + j)
        if least == math.inf:  # as in `join_slips`
            least = 2.0 * record.distance[j] / halves if counts[STUCK, j] == 0.0 else 0.0
        record.slips[LEAST_SLIP, j] = least
    places, most = record.ranges.shape[1], most + _LARGEST_PER_CONTACT * contacts
    for i in range(places):
        record.ranges[HIGH, i] = _most(course, most + i)
        record.ranges[LOW, i] = -_most(course, most + places + i)
    return halves

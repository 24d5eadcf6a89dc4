"""Stops, time stuck and largest displacement of every excitation period that a motion was followed.

A motion that does not repeat is described by their means over the last two thirds of the time, with standard
errors.  When the log is full, neighbouring slots are joined, so that its size limits no motion.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from .records import SHORTEST_STOP, TURN

#: Slots of a log; even.
_CAPACITY = 2048

#: Columns of a log, one slot per row: stops, time stuck in tau, largest displacement; and of its last row:
#: excitation periods per slot, and slots in use.
STOPS, STUCK, LARGEST = 0, 1, 2
LENGTH, USED = 0, 1

#: Batches of a window whose means give its standard error.
_BATCHES = 10

#: Correlations are summed up to this many correlation times (Sokal).
_CORRELATION_TIMES = 5.0

#: Uncertainty in a count of stops, and in cycles stuck, because a window begins and ends at any moment of
#: the motion.
_EDGE_STOPS, _EDGE_STUCK = 0.7, 0.35

#: Standard errors by which the means of both halves of a window may differ.
_ALIKE = 3.0


class Mean(NamedTuple):
    """Mean per excitation period, and its standard error."""

    value: float
    error: float


class Averages(NamedTuple):
    """Averages over the last two thirds of the time followed."""

    stops: Mean
    stuck: Mean
    largest: float
    stationary: bool  # whether both halves of that time agree


@kernel
def clear_log(log):
    """Empty a log."""
    log[_CAPACITY, LENGTH], log[_CAPACITY, USED] = 1.0, 0.0


@entry
def make_log():
    """Allocate an empty log, (_CAPACITY + 1, 3); its last row says how far it is filled."""
    log = np.empty((_CAPACITY + 1, 3))
    clear_log(log)
    return log


@kernel
def _join_slots(log):
    """Join neighbouring slots of a full log."""
    for k in range(_CAPACITY // 2):
        log[k, STOPS] = log[2 * k, STOPS] + log[2 * k + 1, STOPS]
        log[k, STUCK] = log[2 * k, STUCK] + log[2 * k + 1, STUCK]
        log[k, LARGEST] = max(log[2 * k, LARGEST], log[2 * k + 1, LARGEST])
    log[_CAPACITY, LENGTH] *= 2.0
    log[_CAPACITY, USED] = _CAPACITY // 2


@kernel
def _opened(log, slot):
    """Open the slots up to this one; return its number, which changes where slots are joined."""
    while log[_CAPACITY, USED] <= slot:
        used = int(log[_CAPACITY, USED])
        if used == _CAPACITY:
            _join_slots(log)
            slot //= 2
        else:
            log[used, STOPS] = log[used, STUCK] = log[used, LARGEST] = 0.0
            log[_CAPACITY, USED] += 1.0
    return slot


@kernel
def _slot_at(log, time):
    """Return the slot of a time, which is open afterwards."""
    return _opened(log, int(time / (TURN * log[_CAPACITY, LENGTH])))


@kernel
def log_stop(log, time, wait):
    """Add the time of a stop that begins at `time`, to every slot its share."""
    end = time + wait
    slot = _slot_at(log, time)
    while True:
        until = TURN * log[_CAPACITY, LENGTH] * (slot + 1.0)
        if end <= until:
            log[slot, STUCK] += end - time
            break
        log[slot, STUCK] += until - time
        time = until
        slot = _opened(log, slot + 1)


@kernel
def log_event(log, time, size, stopped, wait):
    """Add a slide that ended at `time` with displacement `size`, and the stop after it."""
    slot = _slot_at(log, time)
    log[slot, LARGEST] = max(log[slot, LARGEST], size)
    if stopped:
        if wait > SHORTEST_STOP:
            log[slot, STOPS] += 1.0
        log_stop(log, time, wait)


@kernel
def _mean(log, column, first, last):
    """Mean of a column over slots first..last-1."""
    total = 0.0
    for k in range(first, last):
        total += log[k, column]
    return total / (last - first)


@kernel
def _correlated_error(log, column, first, last, mean):
    """Standard error of a mean from the correlation time of the values."""
    n = last - first
    variance = 0.0
    for k in range(first, last):
        variance += (log[k, column] - mean) ** 2
    if variance == 0.0:
        return 0.0
    time = 0.5  # correlation time in slots
    for lag in range(1, n // 2):
        if lag > _CORRELATION_TIMES * time:
            break
        total = 0.0
        for k in range(first, last - lag):
            total += (log[k, column] - mean) * (log[k + lag, column] - mean)
        time += total / variance
    return math.sqrt(2.0 * max(time, 0.0) * variance) / n


@kernel
def _batch_error(log, column, first, last, mean):
    """Standard error of a mean from the scatter of the means of batches."""
    size = (last - first) // _BATCHES
    if size == 0:
        return math.inf
    total = 0.0
    for batch in range(_BATCHES):
        begin = last - (batch + 1) * size
        total += (_mean(log, column, begin, begin + size) - mean) ** 2
    return math.sqrt(total / (_BATCHES * (_BATCHES - 1.0)))


@kernel
def mean_and_error(log, column, first, last):
    """Mean over slots first..last-1, and the larger of two estimates of its standard error."""
    mean = _mean(log, column, first, last)
    error = max(
        _batch_error(log, column, first, last, mean), _correlated_error(log, column, first, last, mean)
    )
    return Mean(mean, error)


@kernel
def _halves_agree(log, column, first, last, edge):
    """Whether the means of both halves of a window agree."""
    middle = (first + last) // 2
    one = mean_and_error(log, column, first, middle)
    other = mean_and_error(log, column, middle, last)
    error = math.hypot(max(one.error, edge / (middle - first)), max(other.error, edge / (last - middle)))
    return abs(one.value - other.value) <= _ALIKE * error


@kernel
def averages(log, time):
    """Average over the last two thirds of the full slots of a motion followed up to `time`.

    Returns
    -------
    Averages : of NaN if not one slot is full
    """
    length = log[_CAPACITY, LENGTH]
    last = min(int(time / (TURN * length)), int(log[_CAPACITY, USED]))
    first = last // 3
    if last == first:
        nan = math.nan
        return Averages(Mean(nan, nan), Mean(nan, nan), nan, False)
    stops = mean_and_error(log, STOPS, first, last)
    stuck = mean_and_error(log, STUCK, first, last)
    largest = 0.0
    for k in range(first, last):
        largest = max(largest, log[k, LARGEST])
    cycles = (last - first) * length
    stationary = (
        _halves_agree(log, STOPS, first, last, _EDGE_STOPS)
        and _halves_agree(log, STUCK, first, last, _EDGE_STUCK * TURN)
        and _halves_agree(log, LARGEST, first, last, 0.0)
    )
    return Averages(
        Mean(stops.value / length, max(stops.error / length, _EDGE_STOPS / cycles)),
        Mean(stuck.value / (TURN * length), max(stuck.error / (TURN * length), _EDGE_STUCK / cycles)),
        largest,
        stationary,
    )

"""Numbers of every excitation period of a motion that does not repeat; their means and standard errors.

A log has one row per slot of time, and a last row that says how far it is filled.  When it is full,
neighbouring slots are joined, so that its size limits no motion.
"""

import math
from typing import NamedTuple

import numpy as np

from .compiler import entry, kernel

#: Slots of a log; even.
CAPACITY = 2048

#: Columns of the last row: excitation periods per slot, and slots in use.
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

_TURN = 2.0 * math.pi


class Mean(NamedTuple):
    """Mean per excitation period, and its standard error."""

    value: float
    error: float


@kernel
def clear_log(log):
    """Empty a log."""
    log[CAPACITY, LENGTH], log[CAPACITY, USED] = 1.0, 0.0


@entry
def make_log(columns):
    """Allocate an empty log, (CAPACITY + 1, columns)."""
    log = np.empty((CAPACITY + 1, columns))
    clear_log(log)
    return log


@kernel
def _join_slots(log, sums):
    """Join neighbouring slots of a full log."""
    for k in range(CAPACITY // 2):
        for column in range(log.shape[1]):
            one, other = log[2 * k, column], log[2 * k + 1, column]
            log[k, column] = one + other if column < sums else max(one, other)
    log[CAPACITY, LENGTH] *= 2.0
    log[CAPACITY, USED] = CAPACITY // 2


@kernel
def opened(log, slot, sums, least):
    """Open the slots up to this one; return its number, which changes where slots are joined.

    Parameters
    ----------
    log : see `make_log`
    slot : number of a slot
    sums : columns that are added where slots are joined; of the others the largest value is kept
    least : value that those begin with
    """
    while log[CAPACITY, USED] <= slot:
        used = int(log[CAPACITY, USED])
        if used == CAPACITY:
            _join_slots(log, sums)
            slot //= 2
        else:
            for column in range(log.shape[1]):
                log[used, column] = 0.0 if column < sums else least
            log[CAPACITY, USED] += 1.0
    return slot


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
def mean_stops(log, column, first, last):
    """Stops per excitation period over slots first..last-1 of a column that counts them."""
    length = log[CAPACITY, LENGTH]
    stops = mean_and_error(log, column, first, last)
    cycles = (last - first) * length
    return Mean(stops.value / length, max(stops.error / length, _EDGE_STOPS / cycles))


@kernel
def mean_stuck(log, column, first, last):
    """Share stuck over slots first..last-1 of a column of the time stuck in tau."""
    length = log[CAPACITY, LENGTH]
    stuck = mean_and_error(log, column, first, last)
    cycles = (last - first) * length
    return Mean(stuck.value / (_TURN * length), max(stuck.error / (_TURN * length), _EDGE_STUCK / cycles))


@kernel
def _halves_agree(log, column, first, last, edge):
    """Whether the means of both halves of a window agree."""
    middle = (first + last) // 2
    one = mean_and_error(log, column, first, middle)
    other = mean_and_error(log, column, middle, last)
    error = math.hypot(max(one.error, edge / (middle - first)), max(other.error, edge / (last - middle)))
    return abs(one.value - other.value) <= _ALIKE * error


@kernel
def is_stationary(log, columns, first, last):
    """Whether both halves of a window agree in the columns of stops, time stuck and largest displacement."""
    stops, stuck, largest = columns
    return (
        _halves_agree(log, stops, first, last, _EDGE_STOPS)
        and _halves_agree(log, stuck, first, last, _EDGE_STUCK * _TURN)
        and _halves_agree(log, largest, first, last, 0.0)
    )

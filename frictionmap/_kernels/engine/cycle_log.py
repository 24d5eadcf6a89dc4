"""Stops, time stuck and largest displacement of every excitation period that a motion was followed.

A motion that does not repeat is described by their means over the last two thirds of the time, with standard
errors.
"""

import math
from typing import NamedTuple

from ..compiler import kernel, late_kernel
from ..logs import CAPACITY, LENGTH, USED, Mean, is_stationary, mean_stops, mean_stuck, opened
from ..long_periods import enough_cycles
from .records import SHORTEST_STOP, TURN

#: Columns of a log: stops, time stuck in tau, which are added; largest displacement; and their number.
STOPS, STUCK, LARGEST = 0, 1, 2
LOGGED = 3
_SUMS = 2


class Averages(NamedTuple):
    """Averages over the last two thirds of the time followed."""

    stops: Mean
    stuck: Mean
    largest: float
    stationary: bool  # whether both halves of that time agree


@kernel
def first_averaged(cycles):
    """Time in tau before which nothing needs to be logged, of a motion that may be followed for `cycles`: the
    averages begin at a third of the time followed.
    """
    return TURN * math.floor(0.25 * min(cycles, enough_cycles(cycles)))


@kernel
def _slot_at(log, time):
    """Return the slot of a time, which is open afterwards."""
    return opened(log, int(time / (TURN * log[CAPACITY, LENGTH])), _SUMS, 0.0)


@late_kernel(None)
def log_stop(log, time, wait):
    """Add the time of a stop that begins at `time`, to every slot its share."""
    end = time + wait
    slot = _slot_at(log, time)
    while True:
        until = TURN * log[CAPACITY, LENGTH] * (slot + 1.0)
        if end <= until:
            log[slot, STUCK] += end - time
            break
        log[slot, STUCK] += until - time
        time = until
        slot = opened(log, slot + 1, _SUMS, 0.0)


@late_kernel(None)
def log_event(log, time, size, stopped, wait):
    """Add a slide that ended at `time` with displacement `size`, and the stop after it."""
    slot = _slot_at(log, time)
    log[slot, LARGEST] = max(log[slot, LARGEST], size)
    if stopped:
        if wait > SHORTEST_STOP:
            log[slot, STOPS] += 1.0
        log_stop(log, time, wait)


@kernel
def averages(log, time):
    """Average over the last two thirds of the full slots of a motion followed up to `time`.

    Returns
    -------
    Averages : of NaN if not one slot is full
    """
    last = min(int(time / (TURN * log[CAPACITY, LENGTH])), int(log[CAPACITY, USED]))
    first = last // 3
    if last == first:
        nan = math.nan
        return Averages(Mean(nan, nan), Mean(nan, nan), nan, False)
    largest = 0.0
    for k in range(first, last):
        largest = max(largest, log[k, LARGEST])
    return Averages(
        mean_stops(log, STOPS, first, last), mean_stuck(log, STUCK, first, last), largest,
        is_stationary(log, (STOPS, STUCK, LARGEST), first, last),
    )  # fmt: skip

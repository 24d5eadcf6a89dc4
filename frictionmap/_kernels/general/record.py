"""What is kept of a steady motion while it is followed: extreme displacements, and sliding distances."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from .crossings import NONE, approach, first_zero
from .problem import LONG, TERMS
from .series import first_contact_row

_SLOPE, _VALUE = 5, 6  # rows of the scratch


class Record(NamedTuple):
    """Extremes of the displacements in N contacts, then of the n masses."""

    active: np.ndarray  # (1,) int: whether anything is kept
    lowest: np.ndarray  # (N + n,)
    highest: np.ndarray  # (N + n,)
    distance: np.ndarray  # (N,) sliding distances
    masses: np.ndarray  # (n, m) displacement of the masses per mode


@entry
def make_record(contacts, masses):
    """Allocate a record; `masses` (n, m) are the displacements of the masses per mode."""
    size = contacts + masses.shape[0]
    return Record(
        np.zeros(1, np.int64), np.zeros(size), np.zeros(size), np.zeros(contacts), masses
    )  # fmt: skip


@kernel
def clear_record(record):
    """Begin a record."""
    for i in range(record.lowest.size):
        record.lowest[i] = np.inf
        record.highest[i] = -np.inf
    for j in range(record.distance.size):
        record.distance[j] = 0.0


@kernel
def displacement_at(series, at, x):
    """Value of a displacement."""
    value = 0.0
    for k in range(LONG - 1, -1, -1):
        value = value * x + series[at, k]
    return value


@kernel
def _include(record, i, value):
    record.lowest[i] = min(record.lowest[i], value)
    record.highest[i] = max(record.highest[i], value)


@kernel
def _next_turn(series, at, x, sign, scratch):
    """First zero after x > 0 of the slope of a displacement that is zero at x and then has this sign."""
    for k in range(TERMS):
        scratch[_SLOPE, k] = sign * (k + 1.0) * series[at, k + 1]
    bend = 0.0
    bound = 0.0
    for k in range(TERMS - 1, 0, -1):
        bend = bend * x + k * scratch[_SLOPE, k]
        bound += k * (k - 1.0) * abs(scratch[_SLOPE, k])
    if bend <= 0.0:
        return NONE
    x = x + 2.0 * bend / bound if bound > 0.0 else NONE
    return approach(scratch, _SLOPE, x) if x < 1.0 else NONE


@kernel
def _keep_range(series, at, end, i, record, scratch):
    """Include a displacement between 0 and `end` of the present step."""
    _include(record, i, series[at, 0])
    _include(record, i, displacement_at(series, at, end))
    sign = 1.0
    for k in range(1, LONG):
        if series[at, k] != 0.0:
            sign = 1.0 if series[at, k] > 0.0 else -1.0
            break
    shift = 0
    while shift < TERMS - 2 and series[at, shift + 1] == 0.0:
        shift += 1
    for k in range(TERMS):
        scratch[_SLOPE, k] = 0.0
    for k in range(TERMS - shift):
        scratch[_SLOPE, k] = sign * (k + shift + 1.0) * series[at, k + shift + 1]
    x = first_zero(scratch, _SLOPE)
    while x < end:
        _include(record, i, displacement_at(series, at, x))
        sign = -sign
        x = _next_turn(series, at, x, sign, scratch)


@kernel
def record_step(problem, work, end, record):
    """Include the present step, up to `end` in x."""
    modes = problem.push.shape[0]
    contacts = problem.spring.size
    first = first_contact_row(problem)
    series, scratch = work.series, work.scratch
    for j in range(contacts):
        _keep_range(series, first + j, end, j, record, scratch)
        if work.sense[j] != 0:
            way = 0.0
            for k in range(TERMS - 1, -1, -1):
                way = way * end + series[first + contacts + j, k] / (k + 1.0)
            record.distance[j] += abs(way * end)
    for i in range(record.masses.shape[0]):
        for k in range(LONG):
            scratch[_VALUE, k] = 0.0
        for m in range(modes):
            share = record.masses[i, m]
            for k in range(LONG):
                scratch[_VALUE, k] += share * series[m, k]
        _keep_range(scratch, _VALUE, end, contacts + i, record, scratch)

"""Peaks and stops of eight oscillators with friction under one record."""

import math

import numpy as np

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..compiler.vectors import LANES
from .spectrum_lanes import (
    ACC,
    BETA,
    DAMPING,
    FORCE,
    OLD_ACC,
    OLD_PEAK,
    OLD_V,
    OLD_X,
    PEAK,
    RATE,
    SERIES,
    SLIDES,
    SQUARE,
    STATIC,
    TABLE_ROWS,
    Lanes,
    V,
    X,
    fill_tables,
    pass_quiet,
)
from .spectrum_rest import rest
from .spectrum_sample import follow_sample, stick

#: Oscillators that are followed: rows of their w, zeta, beta, mu.
FREQUENCY, RATIO, FRICTION, STATIC_RATIO = 0, 1, 2, 3


@kernel
def _put(lanes, cells):
    """Put eight oscillators at rest in the lanes."""
    state = lanes.state
    for i in range(LANES):
        w, zeta = cells[FREQUENCY, i], cells[RATIO, i]
        state[SQUARE, i], state[DAMPING, i] = w * w, 2.0 * zeta * w
        state[RATE, i] = w * (zeta + math.sqrt((zeta - 1.0) * (zeta + 1.0)) if zeta > 1.0 else 1.0)
        state[BETA, i], state[STATIC, i] = cells[FRICTION, i], cells[STATIC_RATIO, i] * cells[FRICTION, i]
        stick(state, i)


@kernel
def _follow_curved(record, lanes, k):
    """Follow all lanes through a sample in which the load is curved."""
    state = lanes.state
    for i in range(LANES):
        if record.jumps[k]:
            resist = state[FORCE, i] + state[DAMPING, i] * state[V, i] + state[SQUARE, i] * state[X, i]
            state[ACC, i] = state[SLIDES, i] * (record.begins[k] - resist)
        state[OLD_X, i], state[OLD_V, i] = state[X, i], state[V, i]
        state[OLD_ACC, i], state[OLD_PEAK, i] = state[ACC, i], state[PEAK, i]
        follow_sample(record, lanes, i, k)


@kernel
def _follow_straight(record, lanes):
    """Follow all lanes through a record of straight lines."""
    k = 0
    while True:
        k, found = pass_quiet(record, lanes, k)
        if k == record.ends.size:
            return
        for i in range(LANES):
            if found >> i & 1:
                follow_sample(record, lanes, i, k)
        k += 1


@entry
def follow_lanes(record, lengths, cells, state, begins):
    """Follow eight oscillators through a record, or through a block of its samples.

    Parameters
    ----------
    record : Load
    lengths : (T,) distinct lengths of samples
    cells : (4, LANES) w, zeta, beta, mu
    state : (STATE_ROWS, LANES) see `spectrum_lanes`; at the end of the block
    begins : whether it is the first block, at whose beginning all are at rest
    """
    lanes = Lanes(
        state, np.zeros((lengths.size, TABLE_ROWS, LANES)), np.zeros((3, SERIES)), record.terms.shape[1]
    )
    _follow(record, lanes, lengths, cells, begins)


@kernel
def _follow(record, lanes, lengths, cells, begins):
    """See `follow_lanes`, which keeps the arrays."""
    record, lanes = packed(record), packed(lanes)
    if begins:
        _put(lanes, cells)
    fill_tables(lanes, lengths, record.curved)
    if record.curved:
        for k in range(record.ends.size):
            _follow_curved(record, lanes, k)
    else:
        _follow_straight(record, lanes)


@entry
def rest_lanes(state, duration):
    """Follow eight oscillators after their record, which ends at `duration`, until they rest permanently."""
    lanes = Lanes(state, np.zeros((0, TABLE_ROWS, LANES)), np.zeros((3, SERIES)), 1)
    _rest(lanes, duration)


@kernel
def _rest(lanes, duration):
    """See `rest_lanes`, which keeps the arrays."""
    lanes = packed(lanes)
    for i in range(LANES):
        rest(lanes, i, duration)

"""Eight oscillators of one mass with one rigid contact each, side by side in a register.

    x'' + c x' + w^2 x + f = L(t),   f = beta sgn(x'),   abs(f) <= mu beta where x' = 0

L is the load, or minus the acceleration of the base.  w = 0 is a block without a spring: nothing divides by
w.  A sample without an event is one step of a table: from v = x' and v' at its beginning, and from the rise
of the load,

    v(t) = v + v C(t) + v' S(t) + rise R(t),   v'' + c v' + w^2 v = rise/h.

The table holds what is added to x and v, not the new x and v themselves, so that an undamped motion keeps its
amplitude.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, filled, least, load, magnitude, mask_above, most, store
from ..general.problem import PIECE_TERMS

#: Largest angle of the fastest part of the motion in a sample; longer ones are divided.
TURN = 1.0

#: Terms of series: 1/24! is below the rounding error of 1/2.
MOST_TERMS = 24

#: Terms of a series of v beyond those without a load: of a cubic, of records of samples; and of all loads:
#: both turn by 3 together at most, and 3^30/30! = 8e-19.
_CUBIC, _MOST_WITH_LOAD = 3, 30

#: Terms below this share are rounding error.
_NEGLIGIBLE = 1e-18

#: Rows of `Lanes.state`: what every sample changes, with the modulus A of the acceleration and its peak ...
X, V, ACC, A, PEAK = 0, 1, 2, 3, 4
#: ... what it was at the beginning of the sample that is looked into ...
OLD_X, OLD_V, OLD_ACC, OLD_PEAK = 5, 6, 7, 8
#: ... what events change: sense of the slide, 1 where it slides, 1 where it is held, friction force, and the
#: largest force while it is held ...
SENSE, SLIDES, HELD, FORCE, LIMIT = 9, 10, 11, 12, 13
#: ... where the slide began, and what is kept ...
FROM, REACH, DISTANCE, STOPS, TURNS, ASLEEP, STATUS = 14, 15, 16, 17, 18, 19, 20
#: ... and the oscillator: kinetic and static friction, c, w^2, and rate of the fastest part.
BETA, STATIC, DAMPING, SQUARE, RATE = 21, 22, 23, 24, 25
STATE_ROWS = 26

#: Rows of a table: added to x and to v by v, v', rise ...
XV, XA, XD, VV, VA, VD = 0, 1, 2, 3, 4, 5
#: ... h^4/384 times the bound on v'''', and h^2/8 times that on the second derivative of the acceleration, by
#: the moduli of v, v', rise; terms of a series.
FOURTH_V, FOURTH_A, FOURTH_D, SECOND_V, SECOND_A, SECOND_D, TERMS = 6, 7, 8, 9, 10, 11, 12
TABLE_ROWS = 13

#: Rows of `Lanes.series`: v, the load, what is watched; numbers in a row.
RATES, LOAD, WATCHED = 0, 1, 2
SERIES = 32

#: 1/k, and 1/((k+1)(k+2)).
INVERSE = np.array([0.0] + [1.0 / k for k in range(1, SERIES)])
_PAIRS = np.array([1.0 / ((k + 1.0) * (k + 2.0)) for k in range(SERIES)])

_ALL = 2**LANES - 1


class Load(NamedTuple):
    """A record as polynomials over K samples."""

    begins: np.ndarray  # (K,) value at the beginning of a sample
    ends: np.ndarray  # (K,) and at its end
    steps: np.ndarray  # (K,) lengths
    which: np.ndarray  # (K,) int: number of the length among the distinct ones
    jumps: np.ndarray  # (K,) bool: whether the load jumps where the sample begins
    terms: np.ndarray  # (K, terms) polynomials in (t - t_k)/h_k
    curved: bool  # whether some are not straight
    base: bool  # whether it is minus the acceleration of the base


class Lanes(NamedTuple):
    """Eight oscillators."""

    state: np.ndarray  # (STATE_ROWS, LANES)
    tables: np.ndarray  # (lengths, TABLE_ROWS, LANES)
    series: np.ndarray  # (3, SERIES)
    load_terms: int  # of the load in a sample


@kernel
def series_terms(angle, more):
    """Number of terms of a series over `angle` of the fastest part, and `more` for those of the load."""
    terms = 4
    size = angle**4 / 24.0
    while size > _NEGLIGIBLE and terms < MOST_TERMS:
        terms += 1
        size *= angle / terms
    return min(terms + more, _MOST_WITH_LOAD)


@inner_kernel
def fill_rates(series, h, damping, square, terms):
    """Fill the series of v from its first two terms and the series of the load."""
    rates, given = series[RATES], series[LOAD]
    drag, spring = h * damping, h * h * square
    before, last = rates[0], rates[1]
    for j in range(terms - 2):
        known = INVERSE[j + 2] * h * given[j + 1] - _PAIRS[j] * spring * before
        before, last = last, known - INVERSE[j + 2] * drag * last
        rates[j + 2] = last


@kernel
def _fill_steps(lanes, t, h, i, more):
    """Fill what is added to x and v in a sample of length h."""
    series, table = lanes.series, lanes.tables[t]
    damping, square = lanes.state[DAMPING, i], lanes.state[SQUARE, i]
    terms = series_terms(lanes.state[RATE, i] * h, more)
    table[TERMS, i] = terms
    for unit in range(3):
        for k in range(SERIES):
            series[RATES, k] = series[LOAD, k] = 0.0
        series[RATES, 0] = 1.0 if unit == 0 else 0.0
        series[RATES, 1] = h if unit == 1 else 0.0
        series[LOAD, 1] = 1.0 if unit == 2 else 0.0
        fill_rates(series, h, damping, square, terms)
        place = rate = 0.0
        for k in range(terms - 1, 0, -1):
            rate += series[RATES, k]
            place += series[RATES, k] / (k + 1.0)
        table[VV + unit, i] = rate
        table[XV + unit, i] = h * (place + series[RATES, 0])


@kernel
def _fill_bounds(lanes, t, h, i):
    """Fill the bounds on the derivatives.

    In a sample w^2 v^2 + v'^2 <= N^2 with N = w abs(v) + abs(v') + abs(rise) at its beginning, as damping
    lowers it and the slope of the load raises its root by abs(rise) at most; the equation gives the rest.
    """
    table, square, damping = lanes.tables[t], lanes.state[SQUARE, i], lanes.state[DAMPING, i]
    w = math.sqrt(square)
    third = damping * (w + damping) + square
    fourth = damping * third + square * (w + damping)
    scale = h * h * h * h / 384.0
    table[FOURTH_V, i], table[FOURTH_A, i] = scale * fourth * w, scale * fourth
    table[FOURTH_D, i] = scale * (fourth + (damping * damping + square) / h)
    scale = h * h / 8.0
    table[SECOND_V, i], table[SECOND_A, i] = scale * third * w, scale * third
    table[SECOND_D, i] = scale * (third + damping / h)


@kernel
def fill_tables(lanes, lengths, curved):
    """Fill the tables of all distinct lengths of samples."""
    more = 0
    if curved:
        more = _CUBIC if lanes.load_terms <= PIECE_TERMS else lanes.load_terms - 1
    for t in range(lengths.size):
        for i in range(LANES):
            _fill_steps(lanes, t, lengths[t], i, more)
            _fill_bounds(lanes, t, lengths[t], i)


@inner_kernel
def _may_turn(before, after, fourth, third):
    """Lanes, as bits, whose acceleration may have an extremum within a sample.

    Between its ends the slope of the acceleration leaves its chord by h^2/8 times a bound at most.
    before, after : that slope at both ends
    fourth, third : h^4/384 times the bound; h/3
    """
    farthest = fourth * (16.0 / (3.0 * third * third))  # 48/h^2
    slower = least(magnitude(before), magnitude(after))
    return _ALL & ~(mask_above(before * after, 0.0) & mask_above(slower, farthest))


@inner_kernel
def pass_quiet(record, lanes, first):
    """Follow all lanes through samples without events, from sample `first` on.

    Parameters
    ----------
    record, lanes : Load that is not curved, and Lanes
    first : number of a sample

    Returns
    -------
    (k, lanes) : the sample that is not quiet, or their number; the lanes, as bits, that may have an event in
        it, or a peak of the acceleration within it.  `lanes.state` is that after the sample, but not true for
        these lanes, and the rows OLD_X to OLD_PEAK are those before it.
    """
    state, tables = lanes.state, lanes.tables
    x, v, acc = load(state, X * LANES), load(state, V * LANES), load(state, ACC * LANES)
    a, peak = load(state, A * LANES), load(state, PEAK * LANES)
    sense, slides = load(state, SENSE * LANES), load(state, SLIDES * LANES)
    held, force, limit = load(state, HELD * LANES), load(state, FORCE * LANES), load(state, LIMIT * LANES)
    damping, square = load(state, DAMPING * LANES), load(state, SQUARE * LANES)
    rests = mask_above(held, filled(0.0))
    ahead = v * sense
    for k in range(first, record.ends.size):
        at, third, end = record.which[k] * TABLE_ROWS * LANES, record.steps[k] / 3.0, record.ends[k]
        rise = end - record.begins[k]
        over = 0
        if record.jumps[k]:
            resist = force + v * damping + x * square
            pull = record.begins[k] - resist
            over = mask_above(magnitude(pull), limit)
            acc = pull * slides
            a = magnitude(resist * slides + held * record.begins[k]) if record.base else magnitude(acc)
        part = slides * rise
        new_x = x + (v * load(tables, at + XV * LANES) + acc * load(tables, at + XA * LANES)
                     + part * load(tables, at + XD * LANES))  # fmt: skip
        new_v = v + (v * load(tables, at + VV * LANES) + acc * load(tables, at + VA * LANES)
                     + part * load(tables, at + VD * LANES))  # fmt: skip
        resist = force + new_v * damping + new_x * square
        pull = end - resist
        new_acc = pull * slides
        new_ahead = new_v * sense
        speed, pace, change = magnitude(v), magnitude(acc), abs(rise)
        fourth = (speed * load(tables, at + FOURTH_V * LANES) + pace * load(tables, at + FOURTH_A * LANES)
                  + load(tables, at + FOURTH_D * LANES) * change)  # fmt: skip
        inner = least(ahead + acc * sense * third, new_ahead - new_acc * sense * third)
        forward = mask_above(least(inner, least(ahead, new_ahead)), fourth)
        events = _ALL & ~(forward | rests) | over | mask_above(magnitude(pull), limit)
        new_a = magnitude(resist * slides + held * end) if record.base else magnitude(new_acc)
        ends = most(a, new_a)
        new_peak = most(peak, ends)
        second = (speed * load(tables, at + SECOND_V * LANES) + pace * load(tables, at + SECOND_A * LANES)
                  + load(tables, at + SECOND_D * LANES) * change)  # fmt: skip
        peaks = mask_above(ends + second, new_peak) & ~rests
        if peaks != 0:
            slope = 0.0 if record.base else rise / record.steps[k]
            before = acc * damping + v * square - slope
            peaks &= _may_turn(before, new_acc * damping + new_v * square - slope, fourth, third)
        if events | peaks != 0:
            _store_old(state, x, v, acc, peak)
            _store_new(state, new_x, new_v, new_acc, new_a, new_peak)
            return k, events | peaks
        x, v, acc, a, peak, ahead = new_x, new_v, new_acc, new_a, new_peak, new_ahead
    _store_new(state, x, v, acc, a, peak)
    return record.ends.size, 0


@kernel
def _store_old(state, x, v, acc, peak):
    """Store the state at the beginning of a sample."""
    store(x, state, OLD_X * LANES)
    store(v, state, OLD_V * LANES)
    store(acc, state, OLD_ACC * LANES)
    store(peak, state, OLD_PEAK * LANES)


@kernel
def _store_new(state, x, v, acc, a, peak):
    """Store the state at the end of a sample."""
    store(x, state, X * LANES)
    store(v, state, V * LANES)
    store(acc, state, ACC * LANES)
    store(a, state, A * LANES)
    store(peak, state, PEAK * LANES)

"""The constants of one r, and the memory of a motion: allocated, filled; series of the load."""

import math

import numpy as np

from ..compiler import entry, kernel
from ..compiler.vectors import LANES, filled, load, store
from .keys import forget_keys, make_keys
from .laws.contact import force_weight
from .laws.kinds import state_size
from .laws.speed import has_law, key_bits
from .problem import (
    LOAD_TERMS,
    LONG,
    MANY,
    SECTION,
    SIZE,
    TERMS,
    TURN,
    WIDTH,
    H,
    Motion,
    Parts,
    R,
    Row,
    padded,
)

#: Intervals of a period whose load is kept.
_KEPT_INTERVALS = 512

#: Contacts all of whose patterns are kept; of more as many as the numbers of their tables allow, at least and
#: at most so many.
_KEPT_WHOLE = 6
_KEPT_NUMBERS = 1 << 27
_LEAST_KEPT, _MOST_KEPT = 16, 256

#: The same without parts of intervals: in a period, motions of 20 contacts have some hundred patterns, and
#: filling tables anew takes most of the time where they do not fit.
_KEPT_NUMBERS_ALONE = 1 << 24
_LEAST_KEPT_ALONE, _MOST_KEPT_ALONE = 256, 1024

#: Contacts for whose patterns parts of intervals are kept, at most: more have so many patterns that few of
#: them come back often enough, and filling parts takes as long as some 100 intervals.
_MOST_WITH_PARTS = 8

#: Patterns that are kept where friction depends on the speed.
_KEPT_SEGMENTS = 64


@kernel
def intervals_of(rate):
    """Intervals of half a period for a rate of the fastest part of the motion."""
    return int(math.ceil(math.pi * rate / TURN))


@kernel
def most_intervals(problem, limit):
    """Largest number of intervals of a period over r, of those numbers that do not exceed a limit."""
    most = 0
    for i in range(problem.r.size):
        count = 2 * intervals_of(problem.rates[i])
        if count <= limit:
            most = max(most, count)
    return most


@kernel
def keeps_parts(problem):
    """Whether parts of intervals are kept, see `glide`; for the same system always or never, so that the bits
    of a cell do not depend on the cells before it.
    """
    return not has_law(problem) and problem.spring.size <= _MOST_WITH_PARTS


@entry
def _make_parts(problem, kept, most):
    """Allocate the parts of `kept` patterns and at most `most` intervals of a period."""
    contacts, modes = problem.chi.shape
    size = state_size(problem)
    units, loads = kept * contacts * (size + contacts), kept * most
    return Parts(
        np.empty((units, WIDTH)), np.empty(units), np.empty((kept * contacts, size)),
        np.zeros(kept, np.int64), np.empty((loads * contacts, WIDTH)), np.empty(loads * contacts),
        np.empty((loads, size)), np.zeros(loads, np.int64), np.zeros(contacts),
        np.zeros((3, padded(max(modes, contacts)))),
    )  # fmt: skip


@kernel
def _kept_patterns(problem, most):
    """Number of patterns whose tables are kept; `most`: intervals of a period."""
    contacts, modes = problem.chi.shape
    if has_law(problem):
        return _KEPT_SEGMENTS
    if contacts <= _KEPT_WHOLE:
        return 1 << contacts
    size = state_size(problem)
    numbers = (LONG * modes + size + contacts) * padded(size)
    if not keeps_parts(problem):
        return min(max(_KEPT_NUMBERS_ALONE // numbers, _LEAST_KEPT_ALONE), _MOST_KEPT_ALONE)
    numbers += WIDTH * contacts * (size + contacts) + most * (WIDTH * contacts + size)
    kept = min(max(_KEPT_NUMBERS // numbers, _LEAST_KEPT), _MOST_KEPT)
    return kept - kept % _LEAST_KEPT


@entry
def make_row(problem):
    """Allocate the constants of one r."""
    contacts, modes = problem.chi.shape
    channels, harmonics = problem.push.shape[1], problem.orders.size
    width, size = padded(modes), state_size(problem)
    most = most_intervals(problem, _KEPT_INTERVALS)
    kept = _kept_patterns(problem, most)
    return Row(
        np.empty(3), np.zeros(2, np.int64), np.empty(modes), np.empty((modes, modes)),
        np.zeros((TERMS, width)), np.zeros((TERMS, width)), np.zeros((modes, width)),
        np.zeros((channels, width)), np.zeros((contacts, width)), np.zeros((contacts, width)),
        np.empty((contacts, contacts)), np.zeros(contacts), np.zeros((harmonics, WIDTH)),
        np.zeros((harmonics, WIDTH)),
        np.empty((2, channels, harmonics)), np.empty((most * channels, WIDTH)), np.zeros(kept, np.int64),
        np.empty((kept, LONG, modes, padded(size))), np.empty((kept, size, padded(size))),
        np.empty((1 if keeps_parts(problem) else kept, 3, modes, modes)),
        np.empty((kept, contacts, padded(size))),
        _make_parts(problem, kept if keeps_parts(problem) else 1, most),
        np.zeros(contacts), make_keys(contacts, key_bits(problem), kept),
    )  # fmt: skip


@entry
def make_motion(problem):
    """Allocate the memory of one motion."""
    contacts, modes = problem.chi.shape
    size = state_size(problem)
    width = padded(modes)
    rows = padded(size)
    units = modes + problem.push.shape[1]
    together = contacts >= MANY
    return Motion(
        np.zeros((3, padded(max(modes, contacts)))), np.zeros(contacts, np.int64),
        np.zeros(contacts, np.int64), np.zeros(contacts, np.bool_),
        np.zeros((modes + problem.push.shape[1] + 4 * contacts + 1, WIDTH)),
        np.zeros((LONG, width)), np.zeros((contacts + 1, contacts)), np.zeros(contacts + 1, np.int64),
        np.zeros((8, WIDTH)), np.zeros(1), np.zeros((size, rows)), np.zeros((2, size, rows)),
        np.zeros((contacts, rows)), np.zeros(rows), np.zeros(size + contacts),
        np.zeros(contacts, np.int64), np.zeros(contacts), np.zeros((4, contacts)),
        np.zeros(contacts + 1, np.int64), np.zeros((contacts + 1, contacts)), np.zeros((4 * modes, rows)),
        np.zeros((contacts, padded(units)) if together else (1, LANES)),
        np.zeros((units + 1, width + padded(contacts)) if together else (1, LANES)),
    )  # fmt: skip


@kernel
def _set_waves(problem, row):
    """Fill the series of cos(n h x) and sin(n h x)."""
    h = row.numbers[H]
    for n in range(problem.orders.size):
        angle = problem.orders[n] * h
        term = 1.0
        for k in range(LONG):
            if k % 2 == 0:
                row.cosines[n, k] = term
                term *= angle / (k + 1.0)
            else:
                row.sines[n, k] = term
                term *= -angle / (k + 1.0)


@kernel
def _set_modes(problem, row, turn):
    """Fill the constants of the modes; `turn` is h/r."""
    contacts, modes = problem.chi.shape
    for m in range(modes):
        row.stiffness[m] = turn * turn * problem.squares[m]
        for other in range(modes):
            row.damping[m, other] = turn * problem.damping[m, other]
            row.coupling[other, m] = row.damping[m, other]
        own = 0.0 if problem.coupled else row.damping[m, m]
        for k in range(TERMS):
            inverse = 1.0 / ((k + 1.0) * (k + 2.0))
            row.velocity_term[k, m] = -own * (k + 1.0) * inverse
            row.place_term[k, m] = -row.stiffness[m] * inverse
        for d in range(problem.push.shape[1]):
            row.push[d, m] = turn * turn * problem.push[m, d]
        for j in range(contacts):
            row.chi[j, m] = problem.chi[j, m]
            row.reaction[j, m] = turn * turn * problem.chi[j, m]


@kernel
def _fill_channels(problem, row, tau, series, first):
    """Fill the series of the channels, which begin at the phase tau, in `series` from its row `first`."""
    channels = problem.push.shape[1]
    for d in range(channels):
        for k in range(0, WIDTH, LANES):
            store(filled(0.0), series, (first + d) * WIDTH + k)
    for n in range(problem.orders.size):
        angle = problem.orders[n] * tau
        c, s = math.cos(angle), math.sin(angle)
        for d in range(channels):
            even = row.phasors[0, d, n] * c + row.phasors[1, d, n] * s
            odd = row.phasors[1, d, n] * c - row.phasors[0, d, n] * s
            if even == 0.0 and odd == 0.0:
                continue
            for k in range(0, WIDTH, LANES):
                at = (first + d) * WIDTH + k
                wave = load(row.cosines, n * WIDTH + k) * even + load(row.sines, n * WIDTH + k) * odd
                store(load(series, at) + wave, series, at)


@kernel
def shift_piece(series, at, x, terms):
    """Replace the polynomial in row `at`, of `terms` terms, by the same one from x on."""
    for i in range(terms - 1):
        for k in range(terms - 2, i - 1, -1):
            series[at, k] += x * series[at, k + 1]


@kernel
def put_part(into, pieces, begin, parts):
    """Put the polynomials of one of the equal parts of an interval of a record in rows.

    Parameters
    ----------
    into : (D, ...) coefficients of powers of the place in the part
    pieces : (D, terms) those over the whole interval
    begin : where the part begins, in lengths of the interval; beyond 1 after the record, because walls whose
        velocity is not zero at its end go on
    parts : number of parts of the interval
    """
    share, terms = 1.0 / parts, pieces.shape[1]
    for d in range(pieces.shape[0]):
        for k in range(terms):
            into[d, k] = pieces[d, k]
        if begin != 0.0:
            shift_piece(into, d, begin, terms)
        scale = 1.0
        for k in range(terms):
            into[d, k] *= scale
            scale *= share


@kernel
def _shift_pieces(row, x, series, first, channels):
    """Fill the series of channels that are polynomials over the interval, kept in `row.loads`, from x on."""
    for d in range(channels):
        for k in range(0, WIDTH, LANES):
            store(load(row.loads, d * WIDTH + k), series, (first + d) * WIDTH + k)
        if x != 0.0:
            shift_piece(series, first + d, x, row.intervals[LOAD_TERMS])


@kernel
def set_interval(problem, i, row, h):
    """Fill the constants of r[i] for intervals of the length h, all but those of the load."""
    row.numbers[H], row.numbers[R], row.numbers[SIZE] = h, problem.r[i], problem.sizes[i]
    contacts, modes = problem.chi.shape
    _set_modes(problem, row, h / problem.r[i])
    for a in range(contacts):
        for b in range(contacts):
            row.mobility[a, b] = 0.0
            for m in range(modes):
                row.mobility[a, b] += problem.chi[a, m] * row.reaction[b, m]
    for j in range(contacts):
        row.yields[j] = force_weight(problem, row, j)
    forget_keys(row.keys)
    for k in range(row.patterns.size):
        row.patterns[k] = 0
    for k in range(row.parts.known.size):
        row.parts.known[k] = 0
    for k in range(row.parts.loads_known.size):
        row.parts.loads_known[k] = 0


@kernel
def set_row(problem, i, row):
    """Fill the constants of r[i]."""
    set_row_with(problem, i, intervals_of(problem.rates[i]), row)


@kernel
def set_row_with(problem, i, intervals, row):
    """Fill the constants of r[i] for a number of intervals of half a period."""
    row.intervals[0] = intervals
    h = math.pi / row.intervals[0]
    set_interval(problem, i, row, h)
    _set_waves(problem, row)
    for part in range(2):
        for d in range(problem.push.shape[1]):
            for n in range(problem.orders.size):
                row.phasors[part, d, n] = problem.phasors[i, part, d, n]
    channels = problem.push.shape[1]
    if 2 * row.intervals[0] * channels <= row.loads.shape[0]:
        for k in range(2 * row.intervals[0]):
            _fill_channels(problem, row, SECTION + k * h, row.loads, k * channels)


@kernel
def normal_at_section(problem, row, j):
    """Normal load nu of a contact at the section."""
    nu = 1.0
    for n in range(problem.orders.size):
        c, s = math.cos(problem.orders[n] * SECTION), math.sin(problem.orders[n] * SECTION)
        for d in range(problem.normal.shape[1]):
            nu += problem.normal[j, d] * (row.phasors[0, d, n] * c + row.phasors[1, d, n] * s)
    return nu


@kernel
def set_channels(problem, row, tau, interval, motion):
    """Put the series of the channels, which begin at the phase tau, after those of the modes in the motion.

    Parameters
    ----------
    problem, row : Problem, Row
    tau : phase of the load; without harmonics the time since the beginning of the interval of a record
    interval : of the row, if tau is its beginning; else -1
    motion : Motion
    """
    if motion.clock[0] == tau:
        return
    motion.clock[0] = tau
    modes, channels = problem.push.shape
    if problem.orders.size == 0:
        _shift_pieces(row, tau / row.numbers[H], motion.series, modes, channels)
        return
    if interval < 0 or 2 * row.intervals[0] * channels > row.loads.shape[0]:
        _fill_channels(problem, row, tau, motion.series, modes)
        return
    for k in range(0, channels * WIDTH, LANES):
        store(load(row.loads, interval * channels * WIDTH + k), motion.series, modes * WIDTH + k)

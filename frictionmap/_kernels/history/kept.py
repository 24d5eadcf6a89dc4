"""What is kept of a motion in time: peaks, works, slides, events, states at samples."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, magnitude, store, total
from ..general.crossings import value_at
from ..general.problem import (
    LOAD_TERMS,
    LONG,
    NEXT,
    SIZE,
    TERMS,
    WIDTH,
    H,
    P,
    Q,
    first_contact_row,
    force_row,
    padded,
)
from ..general.record import HIGH, HIGH_AT, LOW, LOW_AT, OF_FRICTION, Record, keep_range, keep_works

STOP, START, TURN = 0, 1, 2

#: Columns of `events`.
TIME, CONTACT, KIND = 0, 1, 2

#: Rows of `slides`: sliding distance of the present slide and of the largest one.
PRESENT, LARGEST = 0, 1

#: Places in `works`.
OF_LOAD, OF_BASE = 0, 1

#: Rows of `units` and `sums`: values at the begin and at the end of a step, and how much farther than these a
#: value between them can be.
BEGIN, END, BEND = 0, 1, 2

#: Between its ends a function exceeds them by this share of its largest second derivative at most.
OVERSHOOT = 1.0 / 8.0

#: Factors of the second and third derivatives of a series.
_SECOND = np.array([k * (k - 1.0) for k in range(WIDTH)])
_THIRD = np.array([k * (k - 1.0) * (k - 2.0) for k in range(WIDTH)])

#: Row of the scratch for the quantity watched.
VALUE = 6


class Kept(NamedTuple):
    """What is kept of a motion of m modes, N contacts, D channels.

    A quantity that is watched is a sum of modes, their velocities, forces in contacts, and channels.
    """

    weights: np.ndarray  # (Q, 2 m + N + D) of the quantities
    rounding: np.ndarray  # (Q,) rounding errors of the quantities: peaks are not looked for within them
    peaks: np.ndarray  # (4, Q) lowest, highest, and where in the step they are
    times: np.ndarray  # (2, Q) when they are
    record: Record  # sliding distances and works of the contacts
    works: np.ndarray  # (2,) of the load, and of the walls that move with the base
    slides: np.ndarray  # (2, N)
    changes: np.ndarray  # (3, N) stops, starts, turns
    events: np.ndarray  # (room, 3)
    states: np.ndarray  # (room, 1 + 2 m + N + D) time, q, q', f, L
    senses: np.ndarray  # (room, N)
    counts: np.ndarray  # (2,) int: events and states there were; those beyond the room are not listed
    columns: np.ndarray  # (2 m + N + D, Q) the weights again; filled up to vectors, as the next two
    units: np.ndarray  # (3, 2 m + N + D) see BEGIN
    sums: np.ndarray  # (3, Q) the same of the watched quantities; their ends are those of the interval, too
    forces: np.ndarray  # (N,) forces in the contacts there
    clock: np.ndarray  # (1,) time at the beginning of the interval
    first: np.ndarray  # (1,) when the first slide begins; NaN: none


@entry
def make_kept(problem, weights, rounding, record, room):
    """Allocate it for the numbers of events and states in `room`.

    weights, rounding : see `Kept`; record : of no masses, see `general.record.make_record`
    """
    contacts, modes = problem.chi.shape
    columns = 1 + 2 * modes + contacts + problem.push.shape[1]
    watched = weights.shape[0]
    peaks = np.zeros((4, watched))
    peaks[LOW], peaks[HIGH] = np.inf, -np.inf
    by_unit, sums = np.zeros((columns - 1, padded(watched))), np.full((3, padded(watched)), np.nan)
    by_unit[:, :watched] = weights.T
    return Kept(
        weights, rounding, peaks, np.zeros((2, watched)), record, np.zeros(2), np.zeros((2, contacts)),
        np.zeros((3, contacts)), np.zeros((room[0], 3)), np.zeros((room[1], columns)),
        np.zeros((room[1], contacts), np.int8), np.zeros(2, np.int64),
        by_unit, np.zeros((3, columns - 1)), sums, np.zeros(contacts), np.zeros(1), np.full(1, np.nan),
    )  # fmt: skip


@kernel
def fill_watched(problem, row, motion, kept, i):
    """Fill the series of quantity i in the scratch."""
    contacts, modes = problem.chi.shape
    series, scratch, weights = motion.series, motion.scratch, kept.weights
    first = first_contact_row(problem)
    for k in range(0, WIDTH, LANES):
        store(filled(0.0), scratch, VALUE * WIDTH + k)
    for m in range(modes):
        place, rate = weights[i, m], weights[i, modes + m] / row.numbers[H]
        if place != 0.0:
            for k in range(0, WIDTH, LANES):
                at = VALUE * WIDTH + k
                store(load(scratch, at) + load(series, m * WIDTH + k) * place, scratch, at)
        if rate != 0.0:
            for k in range(0, TERMS, LANES):
                at = VALUE * WIDTH + k
                part = load(NEXT, k) * rate * load(series, m * WIDTH + k + 1)
                store(load(scratch, at) + part, scratch, at)
            scratch[VALUE, TERMS] += rate * (TERMS + 1.0) * series[m, TERMS + 1]
    for j in range(contacts):
        share = weights[i, 2 * modes + j]
        if share != 0.0:
            for k in range(0, TERMS, LANES):
                at = VALUE * WIDTH + k
                store(
                    load(scratch, at) + load(series, (first + 2 * contacts + j) * WIDTH + k) * share,
                    scratch,
                    at,
                )
    for d in range(problem.push.shape[1]):
        share = weights[i, 2 * modes + contacts + d]
        if share != 0.0:
            for k in range(row.intervals[LOAD_TERMS]):
                scratch[VALUE, k] += share * series[modes + d, k]


@kernel
def begin_step(problem, row, motion, kept):
    """Keep what the watched quantities are sums of at the begin of the present step."""
    contacts, modes = problem.chi.shape
    units = kept.units[BEGIN]
    for m in range(modes):
        units[m], units[modes + m] = motion.state[Q, m], motion.state[P, m] / row.numbers[H]
    for j in range(contacts):
        units[2 * modes + j] = motion.series[force_row(problem, j), 0]
    for d in range(problem.push.shape[1]):
        units[2 * modes + contacts + d] = motion.series[modes + d, 0]


@kernel
def _bend(series, at):
    """How much farther than its ends a series can be in its step."""
    sum_ = filled(0.0)
    for k in range(0, WIDTH, LANES):
        sum_ = sum_ + magnitude(load(series, at * WIDTH + k)) * load(_SECOND, k)
    return OVERSHOOT * total(sum_)


@kernel
def _bend_modes(problem, row, motion, share, kept):
    """Fill the bounds of the modes and their velocities over a share of the step."""
    modes = problem.squares.size
    bends, width = kept.units[BEND], row.chi.shape[1]
    for first in range(0, width, LANES):
        place, rate = filled(0.0), filled(0.0)
        for k in range(2, LONG):
            size = magnitude(load(motion.moves, k * width + first))
            place, rate = place + size * _SECOND[k], rate + size * _THIRD[k]
        store(place * (OVERSHOOT * share), motion.scratch, VALUE * WIDTH)
        store(rate * (OVERSHOOT * share / row.numbers[H]), motion.scratch, VALUE * WIDTH + LANES)
        for m in range(first, min(first + LANES, modes)):
            bends[m] = motion.scratch[VALUE, m - first]
            bends[modes + m] = motion.scratch[VALUE, LANES + m - first]


@kernel
def _end_step(problem, row, motion, end, kept):
    """Keep what the watched quantities are sums of at the end of a step, where the state is, and between."""
    contacts, modes = problem.chi.shape
    series, share = motion.series, end * end
    units, bends = kept.units[END], kept.units[BEND]
    _bend_modes(problem, row, motion, share, kept)
    for m in range(modes):
        units[m], units[modes + m] = motion.state[Q, m], motion.state[P, m] / row.numbers[H]
    for i in range(contacts + problem.push.shape[1]):
        at, source = 2 * modes + i, force_row(problem, i) if i < contacts else modes + i - contacts
        units[at], bends[at] = value_at(series, source, end), share * _bend(series, source)


@kernel
def add_up(kept):
    """Fill the sums of the units, and of the moduli of their bounds."""
    width = kept.sums.shape[1]
    for r in range(0, width, LANES):
        begin, end, bend = filled(0.0), filled(0.0), filled(0.0)
        for q in range(kept.units.shape[1]):
            weight = load(kept.columns, q * width + r)
            begin = begin + weight * kept.units[BEGIN, q]
            end = end + weight * kept.units[END, q]
            bend = bend + magnitude(weight) * kept.units[BEND, q]
        store(begin, kept.sums, BEGIN * width + r)
        store(end, kept.sums, END * width + r)
        store(bend, kept.sums, BEND * width + r)


@inner_kernel
def stays_within(kept, i, begin, end, bend):
    """Whether quantity i does not exceed its peaks so far, but by rounding error, between two values."""
    low, high = kept.peaks[LOW, i] - kept.rounding[i], kept.peaks[HIGH, i] + kept.rounding[i]
    return low <= min(begin, end) - bend and max(begin, end) + bend <= high


@inner_kernel
def keep_end(row, kept, i, value):
    """Include a value of quantity i at the end of an interval in which it is monotone."""
    time = kept.clock[0] + row.numbers[H]
    if value < kept.peaks[LOW, i]:
        kept.peaks[LOW, i], kept.times[LOW, i] = value, time
    if value > kept.peaks[HIGH, i]:
        kept.peaks[HIGH, i], kept.times[HIGH, i] = value, time


@kernel
def keep_peak(scratch, begin, end, length, size, kept, i):
    """Include quantity i in the present step; its series is in the scratch.

    Parameters
    ----------
    scratch : (..., WIDTH)
    begin, end : where the step begins in the interval, and its end in x after it
    length : of the interval
    size : displacement beside which a variation is rounding error
    kept, i : Kept and the quantity
    """
    kept.peaks[LOW_AT, i] = kept.peaks[HIGH_AT, i] = -1.0
    keep_range(scratch, VALUE, end, size, kept.peaks, i, scratch)
    for side in range(2):
        at = kept.peaks[LOW_AT + side, i]
        if at >= 0.0:
            kept.times[side, i] = kept.clock[0] + (begin + at) * length


@kernel
def _keep_peaks(problem, row, motion, begin, end, kept):
    """Include the watched quantities of the present step.

    Parameters
    ----------
    problem, row, motion, kept : see `motions_in_time.follow_record`; the state is that at the end
    begin, end : where the step begins in the interval, and its end in x after it
    """
    _end_step(problem, row, motion, end, kept)
    add_up(kept)
    for i in range(kept.weights.shape[0]):
        if stays_within(kept, i, kept.sums[BEGIN, i], kept.sums[END, i], kept.sums[BEND, i]):
            continue
        fill_watched(problem, row, motion, kept, i)
        keep_peak(motion.scratch, begin, end, row.numbers[H], row.numbers[SIZE], kept, i)


@kernel
def integral_by_slope(rate, place, end, terms):
    """Integral over [0, end] of the derivative of the first series, of `terms` terms, times the second.

    rate, place : (WIDTH,) series
    """
    sum_ = 0.0
    for i in range(terms - 1):
        if rate[i + 1] != 0.0:
            part = 0.0
            for k in range(TERMS - 1, -1, -1):
                part = part * end + place[k] / (i + k + 1.0)
            sum_ += (i + 1.0) * rate[i + 1] * part * end ** (i + 1)
    return sum_


@kernel
def fill_pushed(problem, motion, d):
    """Fill the series of the displacement that a channel pushes in the scratch; whether it pushes any."""
    scratch, pushes = motion.scratch, False
    for k in range(WIDTH):
        scratch[VALUE, k] = 0.0
    for m in range(problem.squares.size):
        push = problem.push[m, d]
        if push != 0.0:
            pushes = True
            for k in range(0, WIDTH, LANES):
                at = VALUE * WIDTH + k
                store(load(scratch, at) + load(motion.series, m * WIDTH + k) * push, scratch, at)
    return pushes


@kernel
def _keep_works(problem, row, motion, end, kept):
    """Add the works of the present step, and the sliding distances."""
    contacts, modes = problem.chi.shape
    channels = problem.push.shape[1]
    series, scratch, first = motion.series, motion.scratch, first_contact_row(problem)
    terms = row.intervals[LOAD_TERMS]
    for j in range(contacts):
        kept.slides[PRESENT, j] -= kept.record.distance[j]
    keep_works(problem, row, motion, end, kept.record, first)
    for j in range(contacts):
        kept.slides[PRESENT, j] += kept.record.distance[j]
        if motion.sense[j] != 0:
            kept.slides[LARGEST, j] = max(kept.slides[LARGEST, j], kept.slides[PRESENT, j])
    for d in range(channels):
        wall = series[modes + d]
        if fill_pushed(problem, motion, d):
            pushed = scratch[VALUE]
            ends = value_at(scratch, VALUE, end) * value_at(series, modes + d, end) - pushed[0] * wall[0]
            kept.works[OF_LOAD] += ends - integral_by_slope(wall, pushed, end, terms)
        for j in range(contacts):
            if problem.base[j, d] != 0.0:
                force = series[force_row(problem, j)]
                kept.works[OF_BASE] -= problem.base[j, d] * integral_by_slope(wall, force, end, terms)


@kernel
def add_slide(kept, j, way, work):
    """Add a slide that takes no time."""
    kept.record.distance[j] += way
    kept.record.works[OF_FRICTION, j] += work
    kept.slides[PRESENT, j] += way
    kept.slides[LARGEST, j] = max(kept.slides[LARGEST, j], kept.slides[PRESENT, j])


@kernel
def keep_step(problem, row, motion, begin, end, kept):
    """Include the present step, from `begin` in the interval, to `end` in x after it, where the state is."""
    _keep_peaks(problem, row, motion, begin, end, kept)
    _keep_works(problem, row, motion, end, kept)


@kernel
def keep_present(problem, row, motion, x, at, kept):
    """Keep the state at `at` of the present step, which is at x in the interval."""
    keep_ends(problem, motion, at, kept)
    store_state(problem, row, motion, x, kept)


@kernel
def store_state(problem, row, motion, x, kept):
    """Keep the state at x in the interval; the forces there are those in `kept.forces`."""
    k = kept.counts[1]
    kept.counts[1] = k + 1
    if k >= kept.states.shape[0]:
        return
    contacts, modes = problem.chi.shape
    kept.states[k, 0] = kept.clock[0] + x * row.numbers[H]
    for m in range(modes):
        kept.states[k, 1 + m] = motion.state[Q, m]
        kept.states[k, 1 + modes + m] = motion.state[P, m] / row.numbers[H]
    for j in range(contacts):
        kept.states[k, 1 + 2 * modes + j] = kept.forces[j]
        kept.senses[k, j] = motion.sense[j]
    for d in range(problem.push.shape[1]):
        load_ = 0.0
        for i in range(row.intervals[LOAD_TERMS] - 1, -1, -1):
            load_ = load_ * x + row.loads[d, i]
        kept.states[k, 1 + 2 * modes + contacts + d] = load_


@kernel
def keep_ends(problem, motion, x, kept):
    """Keep the forces in the contacts at x of the present step."""
    for j in range(motion.sense.size):
        kept.forces[j] = value_at(motion.series, force_row(problem, j), x)


@kernel
def list_event(kept, time, contact, kind):
    """List an event."""
    k = kept.counts[0]
    kept.counts[0] = k + 1
    if k < kept.events.shape[0]:
        kept.events[k, TIME] = time
        kept.events[k, CONTACT] = contact
        kept.events[k, KIND] = kind


@kernel
def list_changes(row, motion, before, begin, kept):
    """List the contacts whose sense is not that of `before`, at `begin` in the interval."""
    for j in range(motion.sense.size):
        old, new = int(before[j]), motion.sense[j]
        if old == new:
            continue
        kind = STOP if new == 0 else (START if old == 0 else TURN)
        kept.changes[kind, j] += 1.0
        kept.slides[PRESENT, j] = 0.0
        time = kept.clock[0] + begin * row.numbers[H]
        if kind == START and not (kept.first[0] <= time):
            kept.first[0] = time
        list_event(kept, time, j, kind)

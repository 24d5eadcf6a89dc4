"""What is kept of a motion in time: peaks, works, slides, events, states at samples."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, store
from ..general.crossings import slope_at, value_at
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
)
from ..general.record import HIGH, HIGH_AT, LOW, LOW_AT, Record, keep_range, keep_works

STOP, START, TURN = 0, 1, 2

#: Columns of `events`.
TIME, CONTACT, KIND = 0, 1, 2

#: Rows of `slides`: sliding distance of the present slide and of the largest one.
PRESENT, LARGEST = 0, 1

#: Places in `works`.
OF_LOAD, OF_BASE = 0, 1

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
    ends: np.ndarray  # (Q,) the watched quantities at the end of the interval
    sizes: np.ndarray  # (2 m + N + D,) bounds on what they are sums of, over the present step
    units: np.ndarray  # (2 m + N + D,) the same at its end
    forces: np.ndarray  # (N,) forces in the contacts there
    clock: np.ndarray  # (1,) time at the beginning of the interval


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
    return Kept(
        weights, rounding, peaks, np.zeros((2, watched)), record, np.zeros(2), np.zeros((2, contacts)),
        np.zeros((3, contacts)), np.zeros((room[0], 3)), np.zeros((room[1], columns)),
        np.zeros((room[1], contacts), np.int8), np.zeros(2, np.int64),
        np.full(watched, np.nan), np.zeros(columns - 1), np.zeros(columns - 1), np.zeros(contacts),
        np.zeros(1),
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


@inner_kernel
def _bound(series, at, terms):
    """Bound on a series of this number of terms over its step."""
    sum_ = 0.0
    for k in range(terms):
        sum_ += abs(series[at, k])
    return sum_


@kernel
def _fill_units(problem, row, motion, end, kept):
    """Fill what the watched quantities are sums of: bounds over the present step, values at its end."""
    contacts, modes = problem.chi.shape
    series, sizes, units, h = motion.series, kept.sizes, kept.units, row.numbers[H]
    for m in range(modes):
        sizes[m], units[m] = _bound(series, m, LONG), value_at(series, m, end)
        rate = 0.0
        for k in range(1, TERMS):
            rate += k * abs(series[m, k])
        sizes[modes + m], units[modes + m] = rate / h, slope_at(series, m, end) / h
    for j in range(contacts):
        source = force_row(problem, j)
        sizes[2 * modes + j], units[2 * modes + j] = (
            _bound(series, source, TERMS),
            value_at(series, source, end),
        )
    for d in range(problem.push.shape[1]):
        at = 2 * modes + contacts + d
        sizes[at] = _bound(series, modes + d, row.intervals[LOAD_TERMS])
        units[at] = value_at(series, modes + d, end)


@inner_kernel
def _can_exceed(kept, i):
    """Whether quantity i can exceed its peaks so far in the present step; its value at the end is kept."""
    bound, value = 0.0, 0.0
    for q in range(kept.units.size):
        bound += abs(kept.weights[i, q]) * kept.sizes[q]
        value += kept.weights[i, q] * kept.units[q]
    kept.ends[i] = value
    return not (bound <= min(kept.peaks[HIGH, i], -kept.peaks[LOW, i]) + kept.rounding[i])


@kernel
def _keep_peaks(problem, row, motion, begin, end, kept):
    """Include the watched quantities of the present step.

    Parameters
    ----------
    problem, row, motion, kept : see `motion.follow_record`
    begin, end : where the step begins in the interval, and its end in x after it
    """
    _fill_units(problem, row, motion, end, kept)
    for i in range(kept.weights.shape[0]):
        if not _can_exceed(kept, i):
            continue
        fill_watched(problem, row, motion, kept, i)
        kept.peaks[LOW_AT, i] = kept.peaks[HIGH_AT, i] = -1.0
        kept.ends[i] = value_at(motion.scratch, VALUE, end)
        keep_range(motion.scratch, VALUE, end, row.numbers[SIZE], kept.peaks, i, motion.scratch)
        for side in range(2):
            at = kept.peaks[LOW_AT + side, i]
            if at >= 0.0:
                kept.times[side, i] = kept.clock[0] + (begin + at) * row.numbers[H]


@kernel
def _integral(rate, place, end, terms):
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
            kept.works[OF_LOAD] += ends - _integral(wall, pushed, end, terms)
        for j in range(contacts):
            if problem.base[j, d] != 0.0:
                force = series[force_row(problem, j)]
                kept.works[OF_BASE] -= problem.base[j, d] * _integral(wall, force, end, terms)


@kernel
def keep_step(problem, row, motion, begin, end, kept):
    """Include the present step, from `begin` in the interval, up to `end` in x after it."""
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
def list_changes(row, motion, before, begin, kept):
    """List the contacts whose sense is not that of `before`, at `begin` in the interval."""
    for j in range(motion.sense.size):
        old, new = int(before[j]), motion.sense[j]
        if old == new:
            continue
        kind = STOP if new == 0 else (START if old == 0 else TURN)
        kept.changes[kind, j] += 1.0
        kept.slides[PRESENT, j] = 0.0
        k = kept.counts[0]
        kept.counts[0] = k + 1
        if k < kept.events.shape[0]:
            kept.events[k, TIME] = kept.clock[0] + begin * row.numbers[H]
            kept.events[k, CONTACT] = j
            kept.events[k, KIND] = kind

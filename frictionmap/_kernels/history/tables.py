"""Intervals of a record in which no contact changes what it does, passed by tables.

The motion in an interval depends linearly on units: the state at its beginning, the friction of contacts that
slide, and the terms of the load.  For every set of held contacts the part of each unit is kept in

- the change of the state (E - I: the rounding of E would grow with the number of intervals),
- the control points of the cubic that bounds the velocity or force watched in each contact, up to a share of
  its fourth derivative (see `crossings`),
- the quantities whose peaks are kept, at the end; between the ends they exceed these by an eighth of their
  second derivative at most, and not at all where their slope keeps its sign, by its ends and an eighth of the
  third derivative,
- integrals of the displacements that the load pushes, for its work, and of the forces of held contacts on
  walls that move, for theirs.

Where there are belts, the last unit is their motion: it loads springs, and changes the velocities watched in
contacts that slide.

An interval in which nothing watched can reach its limit, and no quantity its peak so far inside, is passed by
sums of these parts.  Others are followed by their series.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.packed import packed
from ..compiler.vectors import LANES, filled, load, store
from ..general.counts import STUCK
from ..general.crossings import slope_at, value_at
from ..general.glide import begin_with
from ..general.laws.coupled import is_coupled
from ..general.laws.kinds import has_force, state_size
from ..general.laws.speed import has_law
from ..general.problem import (
    LOAD_TERMS,
    LONG,
    TERMS,
    F,
    H,
    P,
    Problem,
    Q,
    first_contact_row,
    force_row,
    padded,
    varies,
)  # fmt: skip
from ..general.record import OF_FRICTION, OF_WALL
from ..general.series import Friction, expand
from .kept import (
    BEGIN,
    BEND,
    END,
    LARGEST,
    OF_BASE,
    OF_LOAD,
    OVERSHOOT,
    PRESENT,
    VALUE,
    fill_pushed,
    fill_watched,
    keep_end,
    stays_within,
)

#: Sets of held contacts whose tables are kept, and numbers in all tables, at most.
_MOST_SETS, _MOST_NUMBERS = 64, 1 << 22

#: Error of a cubic over the interval by its fourth derivative.
_HERMITE = 1.0 / 384.0

#: Contacts of a system with tables, at most: a set of them is a number, see `_slot`.
_MOST_HELD = 61


class Tables(NamedTuple):
    """Tables of S sets of held contacts for each of I lengths of intervals.

    U units, B rows of parts, G rows of bounds, filled up to vectors; places are I S.
    """

    parts: np.ndarray  # (I S U, B)
    bounds: np.ndarray  # (I S U, G)
    slopes: np.ndarray  # (I S U, 3, Q) of the quantities: at the begin and the end, and how far beyond these
    known: np.ndarray  # (I S,) int: which set is there, plus 1; 0: none
    lengths: np.ndarray  # (I,) lengths of intervals; 0: none yet
    place: np.ndarray  # (1,) int: number of the present length
    units: np.ndarray  # (U,) the units of an interval
    sums: np.ndarray  # (B,)
    most: np.ndarray  # (G,)
    unit: np.ndarray  # (N,) friction; scratch
    state: np.ndarray  # (3, ...) a state; scratch
    still: Problem  # the same without belts


@kernel
def _has_moving_wall(problem, j):
    """Whether the wall of a contact moves."""
    moving = problem.belt[j] != 0.0
    for d in range(problem.push.shape[1]):
        moving = moving or problem.base[j, d] != 0.0
    return moving


@kernel
def _has_belts(problem):
    """Whether a wall moves at constant velocity."""
    moving = False
    for j in range(problem.belt.size):
        moving = moving or problem.belt[j] != 0.0
    return moving


@kernel
def _sizes(problem, watched, terms):
    """(units, rows of parts) of a system that watches this number of quantities."""
    contacts, channels = problem.spring.size, problem.push.shape[1]
    moments = channels
    for j in range(contacts):
        if _has_moving_wall(problem, j):
            moments += 1
    units = state_size(problem) + contacts + channels * terms
    return units + _has_belts(problem), state_size(problem) + 4 * contacts + watched + moments * (terms - 1)


@entry
def make_tables(problem, still, watched, terms, lengths):
    """Allocate them.

    problem, still : Problem with and without its belts
    watched : number of quantities with kept peaks
    terms : of the load in an interval, >= 2
    lengths : number of distinct lengths of intervals; 0: no tables
    """
    contacts, modes = problem.chi.shape
    units, rows = _sizes(problem, watched, terms)
    width, bounds = padded(rows), padded(contacts + watched)
    sets = min(1 << min(contacts, 6), _MOST_SETS)
    numbers = units * (width + bounds + 3 * watched)
    sets = max(1, min(sets, _MOST_NUMBERS // (max(1, lengths) * numbers))) * lengths
    return Tables(
        np.zeros((sets * units, width)), np.zeros((sets * units, bounds)),
        np.zeros((sets * units, 3, watched)), np.zeros(sets, np.int64),
        np.zeros(lengths), np.zeros(1, np.int64),
        np.zeros(units), np.zeros(width), np.zeros(bounds), np.zeros(contacts),
        np.zeros((3, padded(max(modes, contacts)))), still,
    )  # fmt: skip


@kernel
def has_tables(problem):
    """Whether tables hold: constant normal loads, no friction over speed; sets are numbers."""
    possible = not has_law(problem) and problem.spring.size <= _MOST_HELD
    for j in range(problem.spring.size):
        possible = possible and not varies(problem, j)
    return possible


@kernel
def set_tables(tables, h):
    """Take the tables of intervals of the length h."""
    for i in range(tables.lengths.size):
        if tables.lengths[i] == h or tables.lengths[i] == 0.0:
            tables.lengths[i] = h
            tables.place[0] = i
            return


@kernel
def _weighted(series, at, order):
    """Bound on the derivative of this order of a series on its step."""
    sum_ = 0.0
    for k in range(order, TERMS):
        factor = 1.0
        for i in range(order):
            factor *= k - i
        sum_ += factor * abs(series[at, k])
    return sum_


@kernel
def _begin_with(problem, row, motion, unit, q):
    """Set one unit to 1 and all others to zero; see `Tables`."""
    begin_with(problem, motion, unit, q)
    at, terms = q - state_size(problem) - problem.spring.size, row.intervals[LOAD_TERMS]
    if 0 <= at < problem.push.shape[1] * terms:
        motion.series[problem.push.shape[0] + at // terms, at % terms] = 1.0


@kernel
def _fill_unit(problem, row, motion, kept, tables, at):
    """Fill the parts of a unit, whose series are there, in row `at`."""
    channels = problem.push.shape[1]
    size, contacts = state_size(problem), problem.spring.size
    parts, bounds, series = tables.parts, tables.bounds, motion.series
    place = size
    for j in range(contacts):
        source = first_contact_row(problem) + 2 * contacts + j
        if motion.sense[j] != 0:
            source -= contacts
        slope = 0.0
        for k in range(1, TERMS):
            slope += k * series[source, k]
        end = value_at(series, source, 1.0)
        parts[at, place] = series[source, 0]
        parts[at, place + 1] = series[source, 0] + series[source, 1] / 3.0
        parts[at, place + 2] = end - slope / 3.0
        parts[at, place + 3] = end
        bounds[at, j] = _HERMITE * _weighted(series, source, 4)
        place += 4
    for i in range(kept.weights.shape[0]):
        fill_watched(problem, row, motion, kept, i)
        parts[at, place + i] = value_at(motion.scratch, VALUE, 1.0)
        bounds[at, contacts + i] = OVERSHOOT * _weighted(motion.scratch, VALUE, 2)
        tables.slopes[at, BEGIN, i] = motion.scratch[VALUE, 1]
        tables.slopes[at, END, i] = slope_at(motion.scratch, VALUE, 1.0)
        tables.slopes[at, BEND, i] = OVERSHOOT * _weighted(motion.scratch, VALUE, 3)
    place += kept.weights.shape[0]
    terms = row.intervals[LOAD_TERMS]
    for d in range(channels):
        fill_pushed(problem, motion, d)
        _fill_moments(motion.scratch[VALUE], terms, parts, at, place)
        place += terms - 1
    for j in range(contacts):
        if _has_moving_wall(problem, j):
            _fill_moments(series[force_row(problem, j)], terms, parts, at, place)
            place += terms - 1
    _fill_change(problem, motion, parts, at)


@kernel
def _fill_moments(values, terms, parts, at, place):
    """Fill the integrals of a series times 1, x, ... x^(terms - 2)."""
    for i in range(terms - 1):
        sum_ = 0.0
        for k in range(LONG):
            sum_ += values[k] / (i + k + 1.0)
        parts[at, place + i] = sum_


@kernel
def _fill_change(problem, motion, parts, at):
    """Fill the change of the state: sums of the terms of the series after those that the state holds."""
    modes = problem.push.shape[0]
    for m in range(modes):
        place, rate = 0.0, 0.0
        for k in range(LONG - 1, 1, -1):
            place += motion.moves[k, m]
            rate += k * motion.moves[k, m]
        parts[at, m] = place + motion.moves[1, m]
        parts[at, modes + m] = rate
    for j in range(state_size(problem) - 2 * modes):
        sum_ = 0.0
        if motion.sense[j] == 0 and has_force(problem, j):
            for k in range(TERMS - 1, 0, -1):
                sum_ += motion.series[force_row(problem, j), k]
        parts[at, 2 * modes + j] = sum_


@kernel
def _fill_set(problem, row, motion, kept, tables, slot):
    """Fill the tables of the present set of held contacts; the state stays."""
    count = tables.units.size
    unit = packed(Friction(tables.unit, tables.unit))
    for part in range(3):
        for i in range(motion.state.shape[1]):
            tables.state[part, i] = motion.state[part, i]
    for q in range(count):
        _begin_with(problem, row, motion, unit, q)
        if q == count - 1 and _has_belts(problem):
            expand(problem, row, unit, 0.0, -1, motion, True)
        else:
            expand(tables.still, row, unit, 0.0, -1, motion, True)
        _fill_unit(problem, row, motion, kept, tables, slot * count + q)
    for part in range(3):
        for i in range(motion.state.shape[1]):
            motion.state[part, i] = tables.state[part, i]
    motion.clock[0] = math.nan


@kernel
def _slot(problem, row, motion, kept, tables):
    """Place of the present set of held contacts in the tables, filled if it is new there."""
    held = 0
    for j in range(motion.sense.size):
        if motion.sense[j] == 0:
            held += 1 << j
    sets = tables.known.size // tables.lengths.size
    slot = tables.place[0] * sets + held % sets
    if tables.known[slot] != held + 1:
        _fill_set(problem, row, motion, kept, tables, slot)
        tables.known[slot] = held + 1
    return slot


@inner_kernel
def _put_units(problem, row, friction, motion, units):
    """Put the state, the friction forces and the terms of the load in one row."""
    modes, channels = problem.push.shape
    size, contacts = state_size(problem), problem.spring.size
    terms = row.intervals[LOAD_TERMS]
    for m in range(modes):
        units[m] = motion.state[Q, m]
        units[modes + m] = motion.state[P, m]
    for j in range(size - 2 * modes):
        units[2 * modes + j] = motion.state[F, j] if motion.sense[j] == 0 else 0.0
    for j in range(contacts):
        units[size + j] = motion.sense[j] * friction.kinetic[j]
    for d in range(channels):
        for k in range(terms):
            units[size + contacts + d * terms + k] = row.loads[d, k]
    if units.size > size + contacts + channels * terms:
        units[units.size - 1] = 1.0


@inner_kernel
def _add_up(tables, slot):
    """Fill the sums of the parts, and of the bounds, over the units."""
    count = tables.units.size
    for r in range(0, tables.sums.size, LANES):
        sum_ = filled(0.0)
        for q in range(count):
            sum_ = sum_ + load(tables.parts, (slot * count + q) * tables.sums.size + r) * tables.units[q]
        store(sum_, tables.sums, r)
    for r in range(0, tables.most.size, LANES):
        sum_ = filled(0.0)
        for q in range(count):
            size = abs(tables.units[q])
            sum_ = sum_ + load(tables.bounds, (slot * count + q) * tables.most.size + r) * size
        store(sum_, tables.most, r)


@inner_kernel
def _stays(friction, motion, tables, first, j):
    """Whether what is watched in contact j stays inside its limits."""
    sums = tables.sums
    low, high = math.inf, -math.inf
    for i in range(4):
        low, high = min(low, sums[first + 4 * j + i]), max(high, sums[first + 4 * j + i])
    bound = tables.most[j]
    if motion.sense[j] > 0:
        return low > bound
    if motion.sense[j] < 0:
        return high < -bound
    limit = friction.static[j] - bound
    return low > -limit and high < limit


@inner_kernel
def _is_monotone(tables, slot, i):
    """Whether the slope of quantity i keeps its sign over the interval."""
    begin, end, bend = 0.0, 0.0, 0.0
    for q in range(tables.units.size):
        unit, at = tables.units[q], slot * tables.units.size + q
        begin += unit * tables.slopes[at, BEGIN, i]
        end += unit * tables.slopes[at, END, i]
        bend += abs(unit) * tables.slopes[at, BEND, i]
    return min(begin, end) > bend or max(begin, end) < -bend


@kernel
def pass_by_tables(problem, row, friction, motion, counts, kept, tables):
    """Move the motion to the end of an interval, if nothing happens there that must be looked into.

    Parameters
    ----------
    problem, row, friction, motion, counts, kept : see `motions_in_time.follow_record`; the terms of the load
        over the interval are in `row.loads`
    tables : Tables

    Returns
    -------
    bool : whether it was moved
    """
    contacts = problem.spring.size
    for j in range(contacts):
        if motion.fresh[j] != 0 or motion.idle[j]:
            return False
    slot = _slot(problem, row, motion, kept, tables)
    _put_units(problem, row, friction, motion, tables.units)
    _add_up(tables, slot)
    size = state_size(problem)
    for j in range(contacts):
        if not _stays(friction, motion, tables, size, j):
            return False
    first = size + 4 * contacts
    for i in range(kept.weights.shape[0]):
        # the value at the beginning was included by the interval before, or is that of the start or a jump
        begin, end = kept.sums[END, i], tables.sums[first + i]
        if not stays_within(kept, i, begin, end, tables.most[contacts + i]):
            if begin != begin or not _is_monotone(tables, slot, i):
                return False
            keep_end(row, kept, i, end)
    _take(problem, row, friction, motion, counts, kept, tables)
    return True


@inner_kernel
def _rise(problem, row, units, d):
    """Change of a channel over the interval."""
    first = state_size(problem) + problem.spring.size + d * row.intervals[LOAD_TERMS]
    sum_ = 0.0
    for i in range(1, row.intervals[LOAD_TERMS]):
        sum_ += units[first + i]
    return sum_


@inner_kernel
def _slide(problem, row, motion, tables, j):
    """Way of contact j relative to its wall; of a coupled spring, that of its slider."""
    way = -row.numbers[H] * problem.belt[j]
    for m in range(problem.chi.shape[1]):
        way += problem.chi[j, m] * tables.sums[m]
    for d in range(problem.push.shape[1]):
        if problem.base[j, d] != 0.0:
            way -= problem.base[j, d] * _rise(problem, row, tables.units, d)
    for i in range(problem.spring.size if is_coupled(problem) else 0):
        if motion.sense[i] == 0:
            way -= problem.coupling.flexibility[j, i] * tables.sums[2 * problem.squares.size + i]
    return way


@inner_kernel
def _rate_moment(problem, row, tables, d, at):
    """Integral of the derivative of a channel times what has its moments from the row `at` on."""
    first = state_size(problem) + problem.spring.size + d * row.intervals[LOAD_TERMS]
    sum_ = 0.0
    for i in range(row.intervals[LOAD_TERMS] - 1):
        sum_ += (i + 1.0) * tables.units[first + i + 1] * tables.sums[at + i]
    return sum_


@kernel
def _add_works(problem, row, friction, motion, kept, tables):
    """Add the works of the load and of walls that move; see `kept` for those of a step.

    Parameters
    ----------
    problem, row, friction, motion, kept, tables : see `pass_by_tables`
    """
    contacts, modes = problem.chi.shape
    channels, terms = problem.push.shape[1], row.intervals[LOAD_TERMS]
    size, sums, units = state_size(problem), tables.sums, tables.units
    at = size + 4 * contacts + kept.weights.shape[0]
    for d in range(channels):
        start, gain = 0.0, 0.0
        for m in range(modes):
            start += problem.push[m, d] * units[m]
            gain += problem.push[m, d] * sums[m]
        before = units[size + contacts + d * terms]
        after = before + _rise(problem, row, units, d)
        work = after * (start + gain) - before * start - _rate_moment(problem, row, tables, d, at)
        kept.works[OF_LOAD] += work
        at += terms - 1
    for j in range(contacts):
        if not _has_moving_wall(problem, j):
            continue
        for d in range(channels):
            if problem.base[j, d] != 0.0:
                kept.works[OF_BASE] -= problem.base[j, d] * _rate_moment(problem, row, tables, d, at)
        kept.record.works[OF_WALL, j] -= sums[at] * row.numbers[H] * problem.belt[j]
        at += terms - 1


@inner_kernel
def _take(problem, row, friction, motion, counts, kept, tables):
    """Move the state, and add what is summed over the motion.

    Parameters
    ----------
    problem, row, friction, motion, counts, kept, tables : see `pass_by_tables`
    """
    contacts, modes = problem.chi.shape
    size, sums, units = state_size(problem), tables.sums, tables.units
    _add_works(problem, row, friction, motion, kept, tables)
    for j in range(contacts):
        kept.forces[j] = motion.sense[j] * friction.kinetic[j]
        if motion.sense[j] != 0:
            way = abs(_slide(problem, row, motion, tables, j))
            kept.record.distance[j] += way
            kept.record.works[OF_FRICTION, j] += way * friction.kinetic[j]
            kept.slides[PRESENT, j] += way
            kept.slides[LARGEST, j] = max(kept.slides[LARGEST, j], kept.slides[PRESENT, j])
        else:
            kept.forces[j] = sums[size + 4 * j + 3]
            counts[STUCK, j] += row.numbers[H]
    for m in range(modes):
        motion.state[Q, m] = units[m] + sums[m]
        motion.state[P, m] = units[modes + m] + sums[modes + m]
    for j in range(size - 2 * modes):
        if motion.sense[j] == 0 and has_force(problem, j):
            motion.state[F, j] = units[2 * modes + j] + sums[2 * modes + j]
            kept.forces[j] = motion.state[F, j]
    for i in range(kept.weights.shape[0]):
        kept.sums[END, i] = sums[size + 4 * contacts + i]

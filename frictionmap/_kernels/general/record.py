"""What is kept of a steady motion while it is followed: extreme displacements, sliding distances, events."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel, late_kernel
from ..compiler.vectors import LANES, filled, load, magnitude, store, total
from .crossings import first_zero, next_turn, value_at
from .events import MOST, Events, list_step, make_events
from .laws.contact import moves_one_way
from .laws.kinds import has_force
from .laws.speed import has_law
from .problem import LONG, SIZE, TERMS, WIDTH, H, Q, R, first_contact_row, force_row, varies

NOTHING, RANGES, STEPS, FORCES, EVENTS = 0, 1, 2, 3, 4

#: RANGES of a motion whose multipliers are not wanted.
RANGES_ALONE = 5

_SLOPE, _VALUE = 5, 6  # rows of the scratch

#: Rows of ranges, and of `works`.
LOW, HIGH, LOW_AT, HIGH_AT = 0, 1, 2, 3
OF_FRICTION, OF_WALL = 0, 1

#: Rows of `slips`.
LEAST_SLIP, _PRESENT, _EDGE = 0, 1, 2

#: Sum of all variations of a series, relative to its size, that is rounding error of its terms.
_ROUNDING = 2.0**-50

#: Nodes and weights on [0, 1]: exact to rounding for products of two series of a step.
_LEGENDRE = np.polynomial.legendre.leggauss(14)
NODES = 0.5 * (1.0 + _LEGENDRE[0])
WEIGHTS = 0.5 * _LEGENDRE[1]


class Record(NamedTuple):
    """Extremes of the displacements in N contacts, then of n masses, sums of displacements, or forces.

    The rows of `masses` are their shares of the modes; more columns are shares of the channels, then perhaps
    those of the friction forces, and whether a row is a force: a sum of r^2 q'' and of channels.
    """

    active: np.ndarray  # (1,) int: NOTHING, RANGES, STEPS, FORCES or EVENTS
    ranges: np.ndarray  # (2, N + n) lowest and highest
    distance: np.ndarray  # (N,) sliding distances
    slips: np.ndarray  # (3, N) sliding distances of single slips, see `_keep_slip`
    works: np.ndarray  # (2, N) work of friction, and of the walls that move at constant velocity
    masses: np.ndarray  # (n, m) displacement of the masses per mode, or (n, m + D + 1), (n, m + D + N + 1)
    steps: np.ndarray  # (most, rows, WIDTH) the series of every step
    patterns: np.ndarray  # (most, N + 1) sense of every contact, then the length of the step in x
    count: np.ndarray  # (1,) steps there were; more than `most` do not fit
    forces: np.ndarray  # (2, 2 N) lowest and highest f - limit nu, f + limit nu, where FORCES are kept
    limits: np.ndarray  # (N,) limit of every contact; 0: lowest and highest force
    events: Events  # where EVENTS are kept; see `make_list`
    drift: np.ndarray  # (N,) displacement in contacts by rigid-body modes over the half periods measured


@entry
def _make(problem, masses, most, listed):
    """Allocate a record; see `make_record`, `make_list`."""
    contacts = problem.spring.size
    size = contacts + masses.shape[0]
    rows = problem.push.shape[0] + problem.push.shape[1] + 4 * contacts
    return Record(
        np.zeros(1, np.int64), np.zeros((2, size)), np.zeros(contacts), np.zeros((3, contacts)),
        np.zeros((2, contacts)), masses, np.zeros((most, rows, WIDTH)), np.zeros((most, contacts + 1)),
        np.zeros(1, np.int64), np.zeros((2, 2 * contacts)), np.zeros(contacts),
        make_events(contacts, listed), np.zeros(contacts),
    )  # fmt: skip


@entry
def make_record(problem, masses, most):
    """Allocate a record for `most` steps; `masses` (n, m) or (n, m + D + 1): see `Record`."""
    return _make(problem, masses, most, 0)


@entry
def make_list(problem):
    """Allocate a record of events alone."""
    return _make(problem, np.empty((0, problem.squares.size)), 0, MOST)


@kernel
def begin_cycle(record):
    """Begin a cycle of a longer record: a slip under way goes on."""
    for i in range(record.ranges.shape[1]):
        record.ranges[LOW, i] = np.inf
        record.ranges[HIGH, i] = -np.inf
    for j in range(record.distance.size):
        record.distance[j] = 0.0
        record.slips[LEAST_SLIP, j] = np.inf
        record.works[OF_FRICTION, j] = 0.0
        record.works[OF_WALL, j] = 0.0


@kernel
def clear_record(record):
    """Begin a record."""
    begin_cycle(record)
    for j in range(record.distance.size):
        record.slips[_PRESENT, j] = 0.0
        record.slips[_EDGE, j] = np.inf
    for i in range(record.forces.shape[1]):
        record.forces[LOW, i] = np.inf
        record.forces[HIGH, i] = -np.inf
    record.count[0] = 0


@kernel
def include(ends, i, value):
    """Widen range i of `ends` (2, ...) to include a value."""
    ends[LOW, i] = min(ends[LOW, i], value)
    ends[HIGH, i] = max(ends[HIGH, i], value)


@kernel
def _include_at(ends, i, value, x):
    """Widen a range; where `ends` has four rows, the last two take the place x of the new end."""
    if ends.shape[0] == 4:
        if value < ends[LOW, i]:
            ends[LOW_AT, i] = x
        if value > ends[HIGH, i]:
            ends[HIGH_AT, i] = x
    include(ends, i, value)


@kernel
def _is_still(series, at, size):
    """Whether a displacement varies by no more than rounding, beside itself and a motion of this size."""
    varies = 0.0
    for k in range(1, LONG):
        varies += abs(series[at, k])
    return varies <= _ROUNDING * (abs(series[at, 0]) + size)


@kernel
def _is_within(series, at, ends, i):
    """Whether a series can nowhere in its step leave a range."""
    varies = filled(0.0)
    for k in range(0, WIDTH, LANES):
        varies = varies + magnitude(load(series, at * WIDTH + k))
    most = total(varies) - abs(series[at, 0])
    return series[at, 0] + most <= ends[HIGH, i] and series[at, 0] - most >= ends[LOW, i]


@kernel
def keep_range(series, at, end, size, ends, i, scratch):
    """Include a displacement or a force of the present step in its range.

    Parameters
    ----------
    series, at : series and the row of the displacement
    end : end of the step in x
    size : size beside which its variation may be rounding error
    ends, i : lowest and highest values (2, ...), or these and their places in the step (4, ...), and the
        column in them
    scratch : scratch
    """
    _include_at(ends, i, series[at, 0], 0.0)
    if _is_within(series, at, ends, i) or _is_still(series, at, size):
        return
    _include_at(ends, i, value_at(series, at, end), end)
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
        _include_at(ends, i, value_at(series, at, x), x)
        sign = -sign
        x = next_turn(series, at, x, sign, scratch, _SLOPE)


@kernel
def _integral(series, at, end):
    """Integral over [0, end] of a series."""
    sum_ = 0.0
    for k in range(TERMS - 1, -1, -1):
        sum_ = sum_ * end + series[at, k] / (k + 1.0)
    return sum_ * end


@kernel
def _integral_of_product(series, a, b, end):
    """Integral over [0, end] of the product of two series."""
    sum_ = 0.0
    for i in range(NODES.size):
        x = end * NODES[i]
        sum_ += WEIGHTS[i] * value_at(series, a, x) * value_at(series, b, x)
    return end * sum_


@kernel
def _keep_slip(record, j):
    """End the present slip of an elastic contact that is elastic.

    The first slip may have begun before the record: its length so far is kept apart, and is infinite until
    the contact has been elastic once.
    """
    slips = record.slips
    if slips[_EDGE, j] == np.inf:
        slips[_EDGE, j] = slips[_PRESENT, j]
    elif slips[_PRESENT, j] > 0.0:
        slips[LEAST_SLIP, j] = min(slips[LEAST_SLIP, j], slips[_PRESENT, j])
    slips[_PRESENT, j] = 0.0


@kernel
def join_slips(record, halves):
    """Join the last slip of a period with the first one; record.slips[LEAST_SLIP] is then the least of all.

    It is 0 where there is none, and the distance per period of the load where a contact slips throughout.
    """
    slips = record.slips
    for j in range(slips.shape[1]):
        if slips[_EDGE, j] == np.inf:
            slips[LEAST_SLIP, j] = 2.0 * slips[_PRESENT, j] / halves
            continue
        joined = slips[_EDGE, j] + slips[_PRESENT, j]
        if joined > 0.0:
            slips[LEAST_SLIP, j] = min(slips[LEAST_SLIP, j], joined)
        if slips[LEAST_SLIP, j] == np.inf:
            slips[LEAST_SLIP, j] = 0.0


@kernel
def _taken_by_spring(problem, series, force, end, j):
    """Part of the displacement in a sliding contact that its spring takes as the friction changes; the rest
    is the way of the slider.
    """
    if not has_force(problem, j) or not varies(problem, j):
        return 0.0
    return (value_at(series, force, end) - series[force, 0]) / problem.spring[j]


@kernel
def _kept_in_spring(problem, series, force, end, j):
    """Part of the work in a sliding contact that its spring keeps."""
    mean = 0.5 * (value_at(series, force, end) + series[force, 0])
    return mean * _taken_by_spring(problem, series, force, end, j)


@late_kernel(None)
def keep_works(problem, row, motion, end, record, first):
    """Add the sliding distances and works of the present step."""
    contacts = problem.spring.size
    series = motion.series
    for j in range(contacts):
        belt = row.numbers[H] * problem.belt[j]
        force = first + 2 * contacts + j
        if motion.sense[j] != 0:
            way = value_at(series, first + j, end) - series[first + j, 0] - belt * end
            way -= _taken_by_spring(problem, series, force, end, j)
            record.distance[j] += abs(way)
            record.slips[_PRESENT, j] += abs(way)
            if varies(problem, j) or has_law(problem):
                record.works[OF_FRICTION, j] += _integral_of_product(series, force, first + contacts + j, end)
                record.works[OF_FRICTION, j] -= _kept_in_spring(problem, series, force, end, j)
            else:
                record.works[OF_FRICTION, j] += series[force, 0] * way
        elif has_force(problem, j):
            _keep_slip(record, j)
        if belt != 0.0:
            record.works[OF_WALL, j] -= _integral(series, force, end) * belt


@kernel
def _keep_step(motion, end, record):
    """Keep the series of the present step."""
    k = record.count[0]
    if k < record.steps.shape[0]:
        for i in range(record.steps.shape[1]):
            for n in range(WIDTH):
                record.steps[k, i, n] = motion.series[i, n]
        for j in range(motion.sense.size):
            record.patterns[k, j] = motion.sense[j]
        record.patterns[k, motion.sense.size] = end
    record.count[0] = k + 1


@kernel
def _keep_forces(problem, motion, end, record):
    """Include the forces of the present step, less and plus the limits."""
    contacts = problem.spring.size
    first = first_contact_row(problem)
    series, scratch = motion.series, motion.scratch
    for i in range(2 * contacts):
        j = i % contacts
        limit = record.limits[j] if i >= contacts else -record.limits[j]
        if i >= contacts and limit == 0.0:  # both are the force itself
            record.forces[LOW, i], record.forces[HIGH, i] = record.forces[LOW, j], record.forces[HIGH, j]
            continue
        force, nu = (first + 2 * contacts + j) * WIDTH, (first + 3 * contacts + j) * WIDTH
        for k in range(0, WIDTH, LANES):
            store(load(series, force + k) + load(series, nu + k) * limit, scratch, _VALUE * WIDTH + k)
        keep_range(scratch, _VALUE, end, 0.0, record.forces, i, scratch)


@kernel
def mirror(record):
    """Widen the ranges by those of the half period that mirrors the one recorded."""
    for i in range(record.ranges.shape[1]):
        include(record.ranges, i, -record.ranges[LOW, i])
        include(record.ranges, i, -record.ranges[HIGH, i])


@kernel
def is_force(problem, record, i):
    """Whether row i of the masses is a force, see `Record`."""
    columns = record.masses.shape[1]
    return columns > problem.squares.size and record.masses[i, columns - 1] != 0.0


@kernel
def displaced_by(problem, record, moved, i):
    """Change of range i by displacements `moved` (m,) of the modes."""
    contacts, sum_ = problem.spring.size, 0.0
    if i >= contacts and is_force(problem, record, i - contacts):
        return sum_
    for m in range(problem.squares.size):
        sum_ += (problem.chi[i, m] if i < contacts else record.masses[i - contacts, m]) * moved[m]
    return sum_


@inner_kernel
def shares_of_forces(problem, record):
    """Number of friction forces that displacements of masses have shares of: all or none."""
    modes, channels = problem.push.shape
    return max(0, record.masses.shape[1] - modes - channels - 1)


@kernel
def pushed_by(problem, record, change, i):
    """Change of range i by changes of the friction forces (N,), beside that by modes."""
    modes, channels = problem.push.shape
    contacts, sum_ = problem.spring.size, 0.0
    for j in range(shares_of_forces(problem, record) if i >= contacts else 0):
        sum_ += record.masses[i - contacts, modes + channels + j] * change[j]
    return sum_


@kernel
def _differentiate_twice(scratch, at, rate):
    """Replace a series by its second derivative, times a rate."""
    for k in range(LONG - 2):
        scratch[at, k] = rate * (k + 1.0) * (k + 2.0) * scratch[at, k + 2]
    for k in range(LONG - 2, WIDTH):
        scratch[at, k] = 0.0


@kernel
def _finish_row(problem, row, motion, record, i):
    """Complete row i of the masses, whose sum of modes is in the scratch; the size of its rounding errors."""
    modes, channels = problem.push.shape
    size = row.numbers[SIZE]
    if record.masses.shape[1] == modes:
        return size
    if is_force(problem, record, i):
        rate = (row.numbers[R] / row.numbers[H]) ** 2
        _differentiate_twice(motion.scratch, _VALUE, rate)
        size *= rate
    for d in range(channels):
        share = record.masses[i, modes + d]
        for k in range(WIDTH if share != 0.0 else 0):
            motion.scratch[_VALUE, k] += share * motion.series[modes + d, k]
    for j in range(shares_of_forces(problem, record)):
        share = record.masses[i, modes + channels + j]
        for k in range(WIDTH if share != 0.0 else 0):
            motion.scratch[_VALUE, k] += share * motion.series[force_row(problem, j), k]
    return size


@kernel
def keep_drift(problem, way, halves, record):
    """Keep how far rigid-body modes moved the contacts; after odd half periods their mirror image moves them
    back, and the ranges become those of the motion about its middle.

    Parameters
    ----------
    problem, record : Problem, Record
    way : (m,) displacement of rigid-body modes over the half periods measured, else 0
    halves : number of these
    """
    for j in range(record.drift.size):
        record.drift[j] = displaced_by(problem, record, way, j) if halves % 2 == 0 else 0.0
    for i in range(record.ranges.shape[1] if halves % 2 == 1 else 0):
        shift = -0.5 * displaced_by(problem, record, way, i)
        if shift != 0.0:  # else the ranges of other structures keep their bits
            record.ranges[LOW, i] += shift
            record.ranges[HIGH, i] += shift


@kernel
def needs_ends(problem, record):
    """Whether all that is recorded of an interval in which nothing happens follows from its ends."""
    if record.active[0] == NOTHING:
        return True
    ends = record.active[0] == RANGES and record.masses.shape[0] == 0
    for j in range(problem.spring.size):
        ends = ends and moves_one_way(problem, j)
    return ends


@kernel
def keep_displacements(problem, row, motion, interval, places):
    """Fill the displacements in the contacts at the beginning of an interval of the load."""
    modes, channels = problem.push.shape
    load_at = interval % (2 * row.intervals[0]) * channels
    for j in range(problem.spring.size):
        places[j] = 0.0
        for m in range(modes):
            places[j] += problem.chi[j, m] * motion.state[Q, m]
        for d in range(channels):
            places[j] -= problem.base[j, d] * row.loads[load_at + d, 0]


@kernel
def record_ends(problem, friction, motion, before, after, record):
    """Include an interval in which nothing happens, see `needs_ends`; normal loads are constant.

    before, after : displacements in the contacts at its ends, see `keep_displacements`
    """
    for j in range(problem.spring.size):
        include(record.ranges, j, before[j])
        include(record.ranges, j, after[j])
        if motion.sense[j] != 0:
            way = after[j] - before[j]
            record.distance[j] += abs(way)
            record.slips[_PRESENT, j] += abs(way)
            record.works[OF_FRICTION, j] += motion.sense[j] * friction.kinetic[j] * way


@kernel
def record_step(problem, row, motion, end, record):
    """Include the present step, up to `end` in x."""
    if record.active[0] == EVENTS:
        list_step(problem, row, motion, end, record.events)
        return
    if record.active[0] == FORCES:
        _keep_forces(problem, motion, end, record)
        return
    if record.active[0] == STEPS:
        _keep_step(motion, end, record)
    modes = problem.push.shape[0]
    contacts = problem.spring.size
    first = first_contact_row(problem)
    series, scratch = motion.series, motion.scratch
    for j in range(contacts):
        if moves_one_way(problem, j):
            include(record.ranges, j, series[first + j, 0])
            include(record.ranges, j, value_at(series, first + j, end))
        else:
            keep_range(series, first + j, end, row.numbers[SIZE], record.ranges, j, scratch)
    keep_works(problem, row, motion, end, record, first)
    for i in range(record.masses.shape[0]):
        for k in range(0, WIDTH, LANES):
            place = filled(0.0)
            for m in range(modes):
                place = place + load(series, m * WIDTH + k) * record.masses[i, m]
            store(place, scratch, _VALUE * WIDTH + k)
        size = _finish_row(problem, row, motion, record, i)
        keep_range(scratch, _VALUE, end, size, record.ranges, contacts + i, scratch)

"""Whole intervals of the load in which no contact changes what it does, passed by tables.

The motion in an interval depends linearly on the state at its beginning, on the friction of the contacts that
slide, and on the load.  For every pattern the part of each in the state at the end, and in the velocity or
force watched in every contact, is kept: of the latter the control points of the cubics between nine nodes,
which bound it (see `crossings`).  An interval in which nothing watched can reach its limit is passed by sums
of these parts; others are followed by their series.
"""

import math

from ..compiler import inner_kernel, kernel, late_kernel
from ..compiler.packed import packed
from ..compiler.vectors import LANES, filled, least, load, mask_above, most, store
from .crossings import fill_controls
from .laws.contact import has_tables
from .laws.kinds import state_size
from .problem import SECTION, WIDTH, F, H, P, Q, first_contact_row, varies
from .row import keeps_parts
from .series import Friction, advance, expand
from .tangent import pattern_slot

_ALL = 2**LANES - 1


@inner_kernel
def can_glide(problem, row):
    """Whether intervals can be passed: loads and parts are kept, normal loads constant, no spring is behind a
    belt, no friction depends on the speed, and no contacts close loops.
    """
    if not keeps_parts(problem) or 2 * row.intervals[0] * problem.push.shape[1] > row.loads.shape[0]:
        return False
    possible = not problem.loops
    for j in range(problem.spring.size):
        possible = possible and has_tables(problem, j) and not varies(problem, j)
    return possible


@kernel
def _keep_controls(problem, row, motion, linear, table, bounds, at, step):
    """Keep the control points of each quantity watched, in rows at, at + step, ... of a table.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion with the series of the interval
    linear : whether the velocities of belts are left out
    table, bounds : control points, and bounds on their error
    at, step : first row, and distance of the rows of the contacts
    """
    contacts = problem.spring.size
    for j in range(contacts):
        source = first_contact_row(problem) + 2 * contacts + j
        if motion.sense[j] != 0:
            source -= contacts
            if linear:
                motion.series[source, 0] += row.numbers[H] * problem.belt[j]
        bounds[at + j * step] = fill_controls(motion.series, source, table, at + j * step)


@kernel
def _keep_end(problem, motion, table, at):
    """Copy the state to a row of a table."""
    modes = problem.push.shape[0]
    for m in range(modes):
        table[at, m] = motion.state[Q, m]
        table[at, modes + m] = motion.state[P, m]
    for j in range(state_size(problem) - 2 * modes):
        table[at, 2 * modes + j] = motion.state[F, j]


@kernel
def begin_with(problem, motion, unit, q):
    """Set one unit to 1, and all others and the load to zero.

    Parameters
    ----------
    problem, motion : Problem, Motion
    unit : Friction, replaced
    q : coordinate of the state, or after these the contact whose friction force is 1; -1: none
    """
    modes, channels = problem.push.shape
    size = state_size(problem)
    for part in range(3):
        for i in range(motion.state.shape[1]):
            motion.state[part, i] = 0.0
    for j in range(problem.spring.size):
        unit.kinetic[j] = motion.sense[j] if q == size + j else 0.0
    if 0 <= q < 2 * modes:
        motion.state[q // modes, q % modes] = 1.0
    elif q < size:
        motion.state[F, q - 2 * modes] = 1.0
    motion.clock[0] = 0.0
    for k in range(0, channels * WIDTH, LANES):
        store(filled(0.0), motion.series, modes * WIDTH + k)


@kernel
def _fill_units(problem, row, motion, unit, slot):
    """Fill the parts of the state and of friction for the present pattern.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    unit : Friction, scratch
    slot : place of the pattern
    """
    contacts, size = problem.spring.size, state_size(problem)
    units = size + contacts
    parts = row.parts
    for q in range(units):
        if q >= size and motion.sense[q - size] == 0:
            continue
        begin_with(problem, motion, unit, q)
        expand(problem, row, unit, 0.0, -1, motion, False)
        first = slot * contacts * units + q
        _keep_controls(problem, row, motion, True, parts.controls, parts.bounds, first, units)
        if q >= size:
            advance(problem, row, 1.0, motion)
            _keep_end(problem, motion, parts.ends, slot * contacts + q - size)


@kernel
def _fill_load(problem, row, motion, unit, interval, at):
    """Fill the part of the load in an interval for the present pattern.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    unit : Friction, scratch
    interval : number of the interval
    at : place of pattern and interval
    """
    contacts = problem.spring.size
    parts = row.parts
    begin_with(problem, motion, unit, state_size(problem) + contacts)
    motion.clock[0] = math.nan
    expand(problem, row, unit, SECTION + interval * row.numbers[H], interval, motion, False)
    _keep_controls(problem, row, motion, False, parts.load_controls, parts.load_bounds, at * contacts, 1)
    advance(problem, row, 1.0, motion)
    _keep_end(problem, motion, parts.load_ends, at)


@kernel
def _fill(problem, row, motion, slot, interval, at):
    """Fill the missing parts of the present pattern and interval; the state is as before.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    slot : place of the pattern
    interval : number of the interval
    at : place of both
    """
    parts = row.parts
    pattern = row.patterns[slot]  # the senses of sliding contacts do not matter
    unit = packed(Friction(parts.unit, parts.unit))
    for part in range(3):
        for i in range(motion.state.shape[1]):
            parts.kept[part, i] = motion.state[part, i]
    if parts.known[slot] != pattern:
        _fill_units(problem, row, motion, unit, slot)
        parts.known[slot] = pattern
    _fill_load(problem, row, motion, unit, interval, at)
    parts.loads_known[at] = pattern
    for part in range(3):
        for i in range(motion.state.shape[1]):
            motion.state[part, i] = parts.kept[part, i]
    motion.clock[0] = math.nan


@inner_kernel
def _coordinates(problem, friction, motion):
    """Put the state, and then the friction forces, in one row: `motion.units`."""
    modes = problem.push.shape[0]
    size = state_size(problem)
    for m in range(modes):
        motion.units[m] = motion.state[Q, m]
        motion.units[modes + m] = motion.state[P, m]
    for j in range(size - 2 * modes):
        motion.units[2 * modes + j] = motion.state[F, j]
    for j in range(problem.spring.size):
        motion.units[size + j] = motion.sense[j] * friction.kinetic[j]


@inner_kernel
def _stays(row, friction, motion, j, first, units, at):
    """Whether what is watched in contact j stays inside its limits.

    Parameters
    ----------
    row, friction, motion : Row, Friction, Motion with `units`
    j : contact
    first : row of the first unit in the table
    units : number of units
    at : row of the load
    """
    parts = row.parts
    bound = parts.load_bounds[at]
    low = filled(math.inf)
    high = filled(-math.inf)
    for part in range(0, WIDTH, LANES):
        sum_ = load(parts.load_controls, at * WIDTH + part)
        for q in range(units):
            if motion.units[q] != 0.0:
                sum_ = sum_ + load(parts.controls, (first + q) * WIDTH + part) * motion.units[q]
        low = least(low, sum_)
        high = most(high, sum_)
    for q in range(units):
        if motion.units[q] != 0.0:
            bound += abs(motion.units[q]) * parts.bounds[first + q]
    if motion.sense[j] > 0:
        return mask_above(low, bound) == _ALL
    if motion.sense[j] < 0:
        return mask_above(-bound, high) == _ALL
    limit = friction.static[j] - bound
    return mask_above(low, -limit) == _ALL and mask_above(limit, high) == _ALL


@late_kernel(bool)
def glide(problem, row, friction, interval, motion):
    """Move the state to the end of an interval, if nothing watched can reach its limit there.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    interval : number of the interval
    motion : Motion; the state is that at the beginning of the interval

    Returns
    -------
    bool : whether it was moved
    """
    for j in range(motion.sense.size):
        if motion.fresh[j] != 0:
            return False
    contacts, size = problem.spring.size, state_size(problem)
    slot = pattern_slot(problem, row, motion)
    at = slot * 2 * row.intervals[0] + interval
    parts = row.parts
    if parts.loads_known[at] != row.patterns[slot] or parts.known[slot] != row.patterns[slot]:
        _fill(problem, row, motion, slot, interval, at)
    _coordinates(problem, friction, motion)
    units = size + contacts
    for j in range(contacts):
        if motion.idle[j]:
            continue
        first = (slot * contacts + j) * units
        if not _stays(row, friction, motion, j, first, units, at * contacts + j):
            return False
    _move(problem, row, motion, slot, at)
    return True


@inner_kernel
def _move(problem, row, motion, slot, at):
    """Set the state to that at the end of the interval."""
    modes, contacts, size = problem.push.shape[0], problem.spring.size, state_size(problem)
    parts = row.parts
    for a in range(size):
        end = parts.load_ends[at, a]
        for b in range(size):
            end += row.onward[slot, a, b] * motion.units[b]
        for j in range(contacts):
            if motion.sense[j] != 0:
                end += parts.ends[slot * contacts + j, a] * motion.units[size + j]
        if a < 2 * modes:
            motion.state[a // modes, a % modes] = end
        elif motion.sense[a - 2 * modes] == 0 and not motion.idle[a - 2 * modes]:
            motion.state[F, a - 2 * modes] = end

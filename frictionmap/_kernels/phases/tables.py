"""Tables of the phases of one r: series of a step and its end by the coordinates at its beginning.

Everything in a step is linear in its units: the coordinates, constant accelerations of the modes, cos and sin
of every harmonic of the load at its beginning, and 1.  Tables are filled where a phase is met first.
"""

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, filled, least, load, mask_above, store
from ..general.crossings import fill_controls, value_at
from ..general.problem import LONG, TERMS, WIDTH
from .problem import NORMAL, SMOOTH, W, observed_row, put_growth, row_count, watch_row
from .series import expand, observe
from .watch import is_watched, put_watched

_ALL = 2**LANES - 1


@kernel
def forget_tables(tables, cell):
    """Forget all tables where the ratio of static to kinetic friction, which is in them, is another one."""
    same = True
    for j in range(cell.static.size):
        same = same and tables.zero.static[j] == cell.static[j]
        tables.zero.static[j] = cell.static[j]
    if not same:
        for k in range(tables.keys.size):
            tables.keys[k] = -1
        tables.last[0] = tables.last[1] = 0


@inner_kernel
def _key(problem, motion):
    """Number of a phase."""
    key = 0
    for j in range(problem.law.size):
        key = 8 * key + (3 if motion.open[j] != 0 else motion.sense[j] + 1) + (4 if motion.idle[j] else 0)
    for s in range(motion.piece.size):
        key = 32 * key + motion.piece[s]
    return key


@kernel
def _begin_unit(problem, row, motion, tables, unit):
    """Begin the series of a unit; 1.0 if it is driven, 0.0 if it is a coordinate."""
    modes, size = problem.squares.size, motion.tangent.shape[0]
    column, zero = motion.column, tables.zero
    for k in range(LONG):
        for i in range(modes + 1):
            motion.drive[k, i] = 0.0
    for i in range(modes):
        zero.constant[i] = 0.0
        column.moves[0, i] = 1.0 if unit == i else 0.0
        column.moves[1, i] = 1.0 if unit == modes + i else 0.0
    for j in range(problem.law.size):
        column.force[0, j] = 1.0 if problem.place[j] == unit else 0.0
    if unit < size:
        return 0.0
    rest = unit - size
    if rest < modes:
        zero.constant[rest] = 1.0
    elif rest < modes + 2 * row.orders.size:
        n = (rest - modes) // 2
        put_growth(row, n, 1.0 - (rest - modes) % 2, 1.0 * ((rest - modes) % 2), motion.drive)
    return 1.0


@kernel
def _put_rows(problem, motion, columns, at):
    """Copy the series of a unit to its rows."""
    contacts, modes, springs = problem.law.size, problem.squares.size, problem.along.shape[0]
    moves = motion.column.moves
    for j in range(3 * contacts + springs):
        for k in range(WIDTH):
            columns[at + j, k] = motion.series[W * contacts + j, k]
    first = at + 3 * contacts + springs
    for i in range(modes):
        for k in range(LONG):
            columns[first + i, k] = moves[k, i]
            columns[first + modes + i, k] = (k + 1.0) * moves[k + 1, i] if k + 1 < LONG else 0.0


@kernel
def _expand_unit(problem, row, motion, tables, unit):
    """Fill the series of a unit in `Motion.series`, all that may be watched."""
    contacts, column = problem.law.size, motion.column
    driven = _begin_unit(problem, row, motion, tables, unit)
    expand(problem, row, tables.zero, motion, column, TERMS, driven)
    for k in range(LONG):
        for i in range(problem.squares.size):
            motion.terms.moves[k, i] = column.moves[k, i]
        for j in range(contacts):
            motion.terms.force[k, j] = column.force[k, j]
    observe(problem, row, motion, True)
    if driven == 0.0:
        for j in range(contacts):
            motion.series[W * contacts + j, 0] += row.belt[j]
    return driven


@kernel
def _fill(problem, row, motion, tables, index):
    """Fill the tables of the present phase; `one` is the last unit, whose part is taken from driven ones."""
    units, rows = tables.units.size, row_count(problem)
    modes, contacts = problem.squares.size, problem.law.size
    one = (index * units + units - 1) * rows
    for back in range(units):
        unit = units - 1 - back
        at = (index * units + unit) * rows
        driven = _expand_unit(problem, row, motion, tables, unit)
        _put_rows(problem, motion, tables.columns, at)
        if driven != 0.0 and back > 0:
            for j in range(rows):
                for k in range(WIDTH):
                    tables.columns[at + j, k] -= tables.columns[one + j, k]
        _fill_watched(problem, motion, tables, index, unit)
        first = at + 3 * contacts + problem.along.shape[0]
        for i in range(modes):
            tables.onward[index, i, unit] = value_at(tables.columns, first + i, 1.0)
            tables.onward[index, modes + i, unit] = value_at(tables.columns, first + modes + i, 1.0)
        for j in range(contacts):
            if problem.place[j] >= 0:
                tables.onward[index, problem.place[j], unit] = value_at(
                    tables.columns, at + contacts + j, 1.0
                )


@kernel
def _fill_watched(problem, motion, tables, index, unit):
    """Fill the control points of what is watched for a unit."""
    contacts, springs = problem.law.size, problem.along.shape[0]
    rows, slots = row_count(problem), 3 * contacts + 2 * springs
    at, units = watch_row(problem), tables.units.size
    for j in range(3 * contacts + springs):
        for k in range(WIDTH):
            motion.series[W * contacts + j, k] = tables.columns[(index * units + unit) * rows + j, k]
    into = (index * units + unit) * slots
    for j in range(contacts):
        for which in range(3):
            if is_watched(problem, motion, j, which):
                put_watched(problem, tables.zero, motion, j, which)
                slot = into + 3 * j + which
                tables.bounds[slot] = fill_controls(motion.series, at, tables.controls, slot)
    for s in range(springs):
        for k in range(TERMS + 1):  # the distance from a knot at 0, with the sign of that above
            motion.series[at, k] = -motion.series[observed_row(problem) + s, k]
        slot = into + 3 * contacts + 2 * s
        tables.bounds[slot] = fill_controls(motion.series, at, tables.controls, slot)
        for k in range(TERMS + 1):
            motion.series[at, k] = -motion.series[at, k]
        tables.bounds[slot + 1] = fill_controls(motion.series, at, tables.controls, slot + 1)


@kernel
def find_table(problem, row, motion):
    """Number of the tables of the present phase; -1 without any."""
    tables = motion.tables
    if tables.keys.size == 0:
        return -1
    key = _key(problem, motion)
    if tables.keys[tables.last[0]] == key:
        return tables.last[0]
    count = tables.last[1]
    for index in range(count):
        if tables.keys[index] == key:
            tables.last[0] = index
            return index
    if count == tables.keys.size:
        return -1
    tables.keys[count] = key
    tables.last[0], tables.last[1] = count, count + 1
    _fill(problem, row, motion, tables, count)
    return count


@kernel
def put_units(problem, row, cell, tau, motion):
    """Fill the units of the step that begins at the phase tau."""
    units, modes, contacts = motion.tables.units, problem.squares.size, problem.law.size
    size = motion.tangent.shape[0]
    for i in range(modes):
        units[i], units[modes + i] = motion.q[i], motion.p[i]
        units[size + i] = cell.constant[i]
    for j in range(contacts):
        if problem.place[j] >= 0:
            held = motion.open[j] == 0 and motion.sense[j] == 0
            units[problem.place[j]] = motion.f[j] if held else 0.0
        force = motion.sense[j] * cell.limit[j]
        change = -max(cell.preload[j], 0.0) if motion.open[j] != 0 else min(cell.preload[j], 0.0)
        for i in range(modes):
            units[size + i] -= row.reaction[j, i] * force
            if problem.presses[j]:
                units[size + i] -= row.push[j, i] * change
    for n in range(row.orders.size):
        units[size + modes + 2 * n] = np.cos(row.orders[n] * tau)
        units[size + modes + 2 * n + 1] = np.sin(row.orders[n] * tau)
    units[units.size - 1] = 1.0


@inner_kernel
def _is_positive(tables, first, slots, constant):
    """Whether what is watched stays positive in the whole step."""
    units = tables.units
    a, b, c, d = filled(constant), filled(constant), filled(constant), filled(constant)
    bound = 0.0
    for u in range(units.size):
        value = units[u]
        at = first + u * slots
        place = at * WIDTH
        a = a + load(tables.controls, place) * value
        b = b + load(tables.controls, place + LANES) * value
        c = c + load(tables.controls, place + 2 * LANES) * value
        d = d + load(tables.controls, place + 3 * LANES) * value
        bound += abs(value) * tables.bounds[at]
    return mask_above(least(least(a, b), least(c, d)), bound) == _ALL


@kernel
def is_quiet(problem, cell, motion, index):
    """Whether no event is in the whole step that the units begin."""
    tables, contacts = motion.tables, problem.law.size
    slots = 3 * contacts + 2 * problem.along.shape[0]
    first = index * tables.units.size * slots
    for j in range(contacts):
        for which in range(3):
            if not is_watched(problem, motion, j, which):
                continue
            if which == NORMAL:
                constant = -cell.preload[j] if motion.open[j] != 0 else cell.preload[j]
            else:
                constant = cell.static[j] * cell.limit[j] if motion.sense[j] == 0 else 0.0
            if not _is_positive(tables, first + 3 * j + which, slots, constant):
                return False
    for s in range(problem.along.shape[0]):
        for which in range(2):
            if motion.piece[s] == (problem.knot_count[s] if which == 0 else 0):
                continue
            knot = motion.piece[s] if which == 0 else motion.piece[s] - 1
            constant = problem.knots[s, knot] if which == 0 else -problem.knots[s, knot]
            if not _is_positive(tables, first + 3 * contacts + 2 * s + which, slots, constant):
                return False
    return True


@kernel
def _combine(tables, index, rows, r, series, at):
    """Fill a series from the columns of the units."""
    units = tables.units
    first = index * units.size * rows + r
    a, b, c, d = filled(0.0), filled(0.0), filled(0.0), filled(0.0)
    for u in range(units.size):
        place = (first + u * rows) * WIDTH
        a = a + load(tables.columns, place) * units[u]
        b = b + load(tables.columns, place + LANES) * units[u]
        c = c + load(tables.columns, place + 2 * LANES) * units[u]
        d = d + load(tables.columns, place + 3 * LANES) * units[u]
    store(a, series, at * WIDTH)
    store(b, series, at * WIDTH + LANES)
    store(c, series, at * WIDTH + 2 * LANES)
    store(d, series, at * WIDTH + 3 * LANES)


@kernel
def observe_by_table(problem, motion, index):
    """Fill the series of what is watched."""
    contacts, rows = problem.law.size, row_count(problem)
    for j in range(contacts):
        slides, closed = motion.sense[j] != 0, motion.open[j] == 0
        for group in range(3):
            needed = problem.presses[j]
            if group < 2:
                needed = closed and problem.law[j] != SMOOTH and slides == (group == 0)
            if needed:
                r = group * contacts + j
                _combine(motion.tables, index, rows, r, motion.series, W * contacts + r)
    for s in range(problem.along.shape[0]):
        r = 3 * contacts + s
        _combine(motion.tables, index, rows, r, motion.series, W * contacts + r)


@kernel
def advance_by_table(problem, motion, index, x):
    """Move the state on by x of the present step."""
    tables, modes, rows = motion.tables, problem.squares.size, row_count(problem)
    size, units = motion.tangent.shape[0], tables.units
    end = motion.scratch[5]
    if x == 1.0:
        for a in range(size):
            end[a] = 0.0
            for u in range(units.size):
                end[a] += tables.onward[index, a, u] * units[u]
    else:
        at = watch_row(problem)
        first = 3 * problem.law.size + problem.along.shape[0]
        for a in range(2 * modes):
            _combine(tables, index, rows, first + a, motion.series, at)
            end[a] = value_at(motion.series, at, x)
        for j in range(problem.law.size):
            if problem.place[j] >= 0:
                _combine(tables, index, rows, problem.law.size + j, motion.series, at)
                end[problem.place[j]] = value_at(motion.series, at, x)
    for i in range(modes):
        motion.q[i], motion.p[i] = end[i], end[modes + i]
    for j in range(problem.law.size):
        if problem.place[j] >= 0:
            motion.f[j] = end[problem.place[j]]


@kernel
def advance_tangent_by_table(problem, motion, index, x):
    """Move the derivatives on by x of the present step."""
    tables, modes, rows = motion.tables, problem.squares.size, row_count(problem)
    size, contacts = motion.tangent.shape[0], problem.law.size
    part, tangent, result = tables.parts[0], motion.tangent, tables.parts[1]
    first = 3 * contacts + problem.along.shape[0]
    for u in range(size):
        at = (index * tables.units.size + u) * rows
        if x == 1.0:
            for a in range(size):
                part[a, u] = tables.onward[index, a, u]
            continue
        for a in range(2 * modes):
            part[a, u] = value_at(tables.columns, at + first + a, x)
        for j in range(contacts):
            if problem.place[j] >= 0:
                part[problem.place[j], u] = value_at(tables.columns, at + contacts + j, x)
    for a in range(size):
        for b in range(size):
            result[a, b] = 0.0
        for u in range(size):
            for b in range(size):
                result[a, b] += part[a, u] * tangent[u, b]
    for a in range(size):
        for b in range(size):
            tangent[a, b] = result[a, b]

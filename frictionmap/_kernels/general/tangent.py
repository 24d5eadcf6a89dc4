"""Derivatives of the motion by its state at the section, carried through steps and events.

Between events a motion is linear: its derivatives over a step depend on the pattern and on the length of the
step alone, not on the motion.  One rule serves every event: it is shifted in time by -(g J)/g', where g is
the watched quantity, and for so long the motion follows its equation of after the event in place of that of
before it.
"""

from ..compiler import inner_kernel, kernel, late_kernel
from ..compiler.vectors import LANES, filled, load, store
from .cholesky import solve_columns
from .keys import begin_key, find_key, put_digit
from .laws.coupled import is_coupled
from .laws.kinds import has_force, holding_stiffness, is_spare, is_spring, keeps_force, state_size
from .laws.speed import has_law, key_bits
from .left_free import advance_free, fill_free, hold_free, leaves_few
from .problem import INVERSE, LONG, TERMS

#: Rows of a product that are computed side by side.
_ROWS = 4


@kernel
def identity(problem, motion):
    """Begin: the derivatives at the section itself; the force of an elastic contact that slips is given."""
    size = state_size(problem)
    for a in range(size):
        for b in range(motion.tangent.shape[1]):
            motion.tangent[a, b] = 1.0 if a == b else 0.0
    for j in range(motion.sense.size):
        a = 2 * problem.push.shape[0] + j
        if motion.sense[j] != 0 and a < size:
            motion.tangent[a, a] = 0.0


@inner_kernel
def _spring_term(problem, row, motion, k, first):
    """Take the derivatives of the forces of contacts that act as springs from term k + 2."""
    modes = problem.push.shape[0]
    columns, size = row.columns, motion.tangent.shape[1]
    inverse = INVERSE[k]
    for j in range(problem.spring.size):
        if not is_spring(problem, motion, j):
            continue
        stiffness = holding_stiffness(problem, j)
        for i in range(0, size, LANES):
            force = filled(0.0)
            for m in range(modes):
                if k > 0:
                    place = load(columns, first + (k * modes + m) * size + i)
                    force = force + place * (stiffness * problem.chi[j, m])
            for m in range(modes):
                at = first + ((k + 2) * modes + m) * size + i
                store(load(columns, at) - force * (inverse * row.reaction[j, m]), columns, at)


@inner_kernel
def _coupled_term(problem, row, motion, k, first):
    """Take the derivatives of the forces of coupled springs from term k + 2."""
    modes = problem.push.shape[0]
    columns, size = row.columns, motion.tangent.shape[1]
    count = motion.springs[problem.spring.size]
    for a in range(count):
        for i in range(0, size, LANES):
            part = filled(0.0)
            for m in range(modes):
                place = load(columns, first + (k * modes + m) * size + i)
                part = part + place * problem.chi[motion.springs[a], m]
            store(part, motion.forces, a * size + i)
    solve_columns(motion.grip, count, motion.forces)
    for a in range(count):
        for m in range(modes):
            pull = INVERSE[k] * row.reaction[motion.springs[a], m]
            for i in range(0, size, LANES):
                at = first + ((k + 2) * modes + m) * size + i
                store(load(columns, at) - load(motion.forces, a * size + i) * pull, columns, at)


@inner_kernel
def _own_force(problem, row, motion, slot):
    """Take from term 2 the forces that contacts begin with and keep, which are coordinates of the state."""
    modes = problem.push.shape[0]
    for j in range(problem.spring.size):
        if keeps_force(problem, motion, j):
            for m in range(modes):
                row.columns[slot, 2, m, 2 * modes + j] -= INVERSE[0] * row.reaction[j, m]


@inner_kernel
def _free_columns(problem, row, motion, k, first):
    """Fill term k + 2 of the columns without forces of held contacts."""
    modes = problem.push.shape[0]
    columns, size = row.columns, motion.tangent.shape[1]
    inverse = INVERSE[k]
    for m in range(modes):
        of_place, of_velocity = row.place_term[k, m], row.velocity_term[k, m]
        for i in range(0, size, LANES):
            part = load(columns, first + (k * modes + m) * size + i) * of_place
            part = part + load(columns, first + ((k + 1) * modes + m) * size + i) * of_velocity
            if problem.coupled:
                for other in range(modes):
                    rate = (k + 1.0) * inverse * row.damping[m, other]
                    part = part - load(columns, first + ((k + 1) * modes + other) * size + i) * rate
            store(part, columns, first + ((k + 2) * modes + m) * size + i)


@inner_kernel
def _law_term(problem, row, motion, k, first):
    """Take the derivatives of friction forces by the velocities of sliding contacts from term k + 2."""
    modes = problem.push.shape[0]
    columns, size = row.columns, motion.tangent.shape[1]
    for j in range(problem.spring.size):
        if motion.law_damping[j] == 0.0:
            continue
        rate = (k + 1.0) * motion.law_damping[j]
        for i in range(0, size, LANES):
            force = filled(0.0)
            for m in range(modes):
                place = load(columns, first + ((k + 1) * modes + m) * size + i)
                force = force + place * (rate * problem.chi[j, m])
            for m in range(modes):
                at = first + ((k + 2) * modes + m) * size + i
                store(load(columns, at) - force * (INVERSE[k] * row.reaction[j, m]), columns, at)


@inner_kernel
def _holding_columns(problem, row, motion, k, first):
    """Fill the derivatives of the holding forces, over (k+1)(k+2), and take them from term k + 2."""
    modes = problem.push.shape[0]
    columns, size = row.columns, motion.tangent.shape[1]
    count = motion.held[problem.spring.size]
    for i in range(0, size, LANES):
        for a in range(0, count - 1, 2):  # each part is a chain of sums: two side by side
            j, other = motion.held[a], motion.held[a + 1]
            part, beside = filled(0.0), filled(0.0)
            for m in range(modes):
                place = load(columns, first + ((k + 2) * modes + m) * size + i)
                part = part + place * problem.chi[j, m]
                beside = beside + place * problem.chi[other, m]
            store(part, motion.forces, a * size + i)
            store(beside, motion.forces, (a + 1) * size + i)
        for a in range(count - count % 2, count):
            part = filled(0.0)
            for m in range(modes):
                place = load(columns, first + ((k + 2) * modes + m) * size + i)
                part = part + place * problem.chi[motion.held[a], m]
            store(part, motion.forces, a * size + i)
    solve_columns(motion.solve, count, motion.forces)
    for i in range(0, size, LANES):
        for m in range(modes):
            at = first + ((k + 2) * modes + m) * size + i
            rest = load(columns, at)
            for a in range(count):
                rest = rest - load(motion.forces, a * size + i) * row.reaction[motion.held[a], m]
            store(rest, columns, at)


@inner_kernel
def _onward(problem, row, motion, slot, x, table, at):
    """Fill the derivatives over x of a step with the present pattern, from their series.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    slot : place of the pattern in the row
    x : length of the step
    table, at : (..., size, S), and the place in it that is filled
    """
    modes, contacts = problem.push.shape[0], problem.spring.size
    columns, size = row.columns, motion.tangent.shape[1]
    count = state_size(problem)
    first = slot * LONG * modes * size
    into = at * count * size
    for m in range(modes):
        for i in range(0, size, LANES):
            place = filled(0.0)
            velocity = filled(0.0)
            for k in range(LONG - 1, -1, -1):
                velocity = velocity * x + place
                place = place * x + load(columns, first + (k * modes + m) * size + i)
            store(place, table, into + m * size + i)
            store(velocity, table, into + (modes + m) * size + i)
    if count == 2 * modes:
        return
    if is_coupled(problem):
        _onward_coupled(problem, motion, table, at)
        return
    for j in range(contacts):
        for i in range(size):
            force = 1.0 if i == 2 * modes + j else 0.0
            if is_spring(problem, motion, j):
                for m in range(modes):
                    moved = table[at, m, i] - (1.0 if i == m else 0.0)
                    force += holding_stiffness(problem, j) * problem.chi[j, m] * moved
            table[at, 2 * modes + j, i] = force


@inner_kernel
def _onward_coupled(problem, motion, table, at):
    """Fill the rows of the forces of coupled contacts after those of the modes; see `_onward`."""
    modes, contacts = problem.push.shape[0], problem.spring.size
    size, count = motion.tangent.shape[1], motion.springs[contacts]
    for a in range(count):
        for i in range(size):
            motion.forces[a, i] = 0.0
            for m in range(modes):
                moved = table[at, m, i] - (1.0 if i == m else 0.0)
                motion.forces[a, i] += problem.chi[motion.springs[a], m] * moved
    solve_columns(motion.grip, count, motion.forces)
    for j in range(contacts):
        for i in range(size):
            table[at, 2 * modes + j, i] = 1.0 if i == 2 * modes + j else 0.0
    for a in range(count):
        for i in range(size):
            table[at, 2 * modes + motion.springs[a], i] += motion.forces[a, i]


@kernel
def _fill_pattern(problem, row, motion, slot):
    """Fill the derivatives of motions with the present pattern by the state at their beginning."""
    modes, contacts = problem.push.shape[0], problem.spring.size
    size = motion.tangent.shape[1]
    first = slot * LONG * modes * size
    for m in range(modes):
        for i in range(size):
            row.columns[slot, 0, m, i] = 1.0 if i == m else 0.0
            row.columns[slot, 1, m, i] = 1.0 if i == modes + m else 0.0
    few = leaves_few(problem, motion)
    for k in range(1 if few else TERMS):
        _free_columns(problem, row, motion, k, first)
        if k == 0:
            _own_force(problem, row, motion, slot)
        if not is_coupled(problem):
            _spring_term(problem, row, motion, k, first)
        elif k > 0:
            _coupled_term(problem, row, motion, k, first)
        if has_law(problem):
            _law_term(problem, row, motion, k, first)
        if motion.held[contacts] > 0:
            _holding_columns(problem, row, motion, k, first)
        if k == 0:
            for a in range(motion.held[contacts]):
                for i in range(size):
                    row.grips[slot, motion.held[a], i] = 2.0 * motion.forces[a, i]
    if few:
        fill_free(problem, row, motion, slot)
    else:
        _onward(problem, row, motion, slot, 1.0, row.onward, slot)


@kernel
def _put_key(problem, row, motion):
    """Put the present pattern in the keys: which contacts are held, or in which segments they slide."""
    bits = key_bits(problem)
    begin_key(row.keys)
    for j in range(motion.sense.size):
        if bits == 1:
            digit = 1 if motion.sense[j] == 0 and not is_spare(problem, motion, j) else 0
        else:
            digit = motion.segment[j] + 1 if motion.sense[j] != 0 else 0
        put_digit(row.keys, bits, j, digit)


@kernel
def pattern_slot(problem, row, motion):
    """Place of the present pattern in the tables of the row, filled if it is new there."""
    _put_key(problem, row, motion)
    direct = key_bits(problem) == 1 and motion.sense.size < 32 and 1 << motion.sense.size <= row.patterns.size
    slot, new = find_key(row.keys, direct)
    if new or row.patterns[slot] == 0:
        _fill_pattern(problem, row, motion, slot)
        row.patterns[slot] = row.keys.used[row.patterns.size]
    return slot


@kernel
def advance_tangent(problem, row, motion, x):
    """Carry the derivatives through x of the present step."""
    slot = pattern_slot(problem, row, motion)
    if leaves_few(problem, motion):
        advance_free(problem, row, motion, slot, x)
    elif x == 1.0:
        _multiply(problem, row.onward, slot, motion)
    else:
        _onward(problem, row, motion, slot, x, motion.onward, 0)
        _multiply(problem, motion.onward, 0, motion)


@inner_kernel
def _multiply(problem, table, at, motion):
    """Multiply the derivatives by those over a step, which are at this place of a table."""
    count, size = state_size(problem), motion.tangent.shape[1]
    product = count * size  # the second half of the scratch
    whole = count - count % _ROWS
    for i in range(0, size, LANES):
        for a in range(0, whole, _ROWS):  # each part is a chain of sums: several side by side
            one, two, three, four = filled(0.0), filled(0.0), filled(0.0), filled(0.0)
            for b in range(count):
                column = load(motion.tangent, b * size + i)
                one = one + column * table[at, a, b]
                two = two + column * table[at, a + 1, b]
                three = three + column * table[at, a + 2, b]
                four = four + column * table[at, a + 3, b]
            store(one, motion.onward, product + a * size + i)
            store(two, motion.onward, product + (a + 1) * size + i)
            store(three, motion.onward, product + (a + 2) * size + i)
            store(four, motion.onward, product + (a + 3) * size + i)
        for a in range(whole, count):
            part = filled(0.0)
            for b in range(count):
                part = part + load(motion.tangent, b * size + i) * table[at, a, b]
            store(part, motion.onward, product + a * size + i)
        for a in range(count):
            store(load(motion.onward, product + a * size + i), motion.tangent, a * size + i)


@kernel
def watched_row(problem, row, motion, j, sign, out):
    """Derivative of the watched quantity of contact j: its velocity, or minus `sign` times its force.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion; the pattern is that of before the event
    j : contact
    sign : 0: its velocity is watched; 1, -1: the distance of its force from that side of its range
    out : (S,) filled
    """
    modes = problem.push.shape[0]
    size = motion.tangent.shape[1]
    slot = pattern_slot(problem, row, motion) if sign != 0 else 0
    for i in range(0, size, LANES):
        part = filled(0.0)
        if sign == 0:
            for m in range(modes):
                part = part + load(motion.tangent, (modes + m) * size + i) * problem.chi[j, m]
        elif has_force(problem, j):
            part = part - load(motion.tangent, (2 * modes + j) * size + i) * float(sign)
        else:
            for b in range(state_size(problem)):
                part = part - load(motion.tangent, b * size + i) * (sign * row.grips[slot, j, b])
        store(part, out, i)


@kernel
def through_event(problem, row, motion, drop, watched, slope):
    """Carry the derivatives through an event.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion; the pattern is that of after the event
    drop : (N,) forces after the event less those before it
    watched : (S,) derivatives of the watched quantity
    slope : its rate of change along the motion before the event
    """
    modes = problem.push.shape[0]
    size = motion.tangent.shape[1]
    for j in range(problem.spring.size):
        if drop[j] != 0.0:
            for m in range(modes):
                factor = -row.reaction[j, m] * drop[j] / slope
                for i in range(0, size, LANES):
                    at = (modes + m) * size + i
                    store(load(motion.tangent, at) + load(watched, i) * factor, motion.tangent, at)
        if has_force(problem, j) and motion.sense[j] != 0:
            for i in range(size):
                motion.tangent[2 * modes + j, i] = 0.0


@late_kernel(None)
def through_slip(problem, motion, jumps, watched, slope):
    """Carry the derivatives through the begin of a slip, at which the rates of coupled forces jump.

    Parameters
    ----------
    problem, motion : Problem, Motion; the pattern is that of after the event
    jumps : (N,) rates of the forces after the event less those before it
    watched, slope : see `through_event`
    """
    modes = problem.push.shape[0]
    for j in range(motion.sense.size):
        for i in range(motion.tangent.shape[1] if motion.sense[j] == 0 else 0):
            motion.tangent[2 * modes + j, i] += jumps[j] / slope * watched[i]


@kernel
def hold_tangent(problem, row, motion):
    """Take the velocities of held contacts from the derivatives: they are rounding error."""
    if leaves_few(problem, motion):
        hold_free(problem, row, motion, pattern_slot(problem, row, motion))
        return
    modes = problem.push.shape[0]
    size = motion.tangent.shape[1]
    count = motion.held[problem.spring.size]
    for a in range(count):
        for i in range(0, size, LANES):
            part = filled(0.0)
            for m in range(modes):
                part = part + load(motion.tangent, (modes + m) * size + i) * problem.chi[motion.held[a], m]
            store(part, motion.forces, a * size + i)
    solve_columns(motion.solve, count, motion.forces)
    for a in range(count):
        for m in range(modes):
            reaction = row.reaction[motion.held[a], m]
            for i in range(0, size, LANES):
                at = (modes + m) * size + i
                store(
                    load(motion.tangent, at) - load(motion.forces, a * size + i) * reaction,
                    motion.tangent,
                    at,
                )

"""Derivatives of motions in which many contacts are held, in the coordinates that these leave free.

With held contacts the velocities of the modes are p = B y', where the columns of B are orthonormal and
displace no held contact: the forces that hold them are normal to B, because the modes have unit masses.  Then

    y'' = G y + D y' + f,    G = -B^T W B,    D = -B^T C B,    f = -B^T W q0,

with n = m - H free coordinates of m modes, where H contacts are held.  Its solutions for the 2 n unit values
of f and y'(0) are far fewer numbers than those for the states of all modes: q(x) = q0 + B y, p(x) = B y'.
"""

import math

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, store
from .laws.kinds import state_size
from .laws.speed import has_law
from .problem import INVERSE, LONG, MANY, TERMS, padded

#: Least share of the modes that are held: below, the sums over all free coordinates take longer.
_LEAST_HELD = 1.0 / 3.0

#: Rows of a product that are computed side by side.
_ROWS = 4

#: Parts of `row.bases`: B, its transpose, and B^T W.
BASIS, TURNED, PULLED = 0, 1, 2


@kernel
def leaves_few(problem, motion):
    """Whether the tables of the present pattern are those of the free coordinates."""
    modes, contacts = problem.push.shape[0], problem.spring.size
    if contacts < MANY or has_law(problem) or state_size(problem) != 2 * modes:
        return False
    return motion.held[contacts] >= _LEAST_HELD * modes


@inner_kernel
def _reflect(mirrors, a, count, vector, at):
    """Reflect row `at` of `vector` by mirror a."""
    part = 0.0
    for m in range(count):
        part += mirrors[a, m] * vector[at, m]
    for m in range(count):
        vector[at, m] -= part * mirrors[a, m]


@kernel
def _fill_basis(problem, motion, basis, turned, mirrors):
    """Fill B and its transpose, by Householder's reflections of the rows of the held contacts."""
    modes = problem.push.shape[0]
    held = motion.held[problem.spring.size]
    for a in range(held):
        for m in range(modes):
            mirrors[a, m] = problem.chi[motion.held[a], m]
        for b in range(a):
            _reflect(mirrors, b, modes, mirrors, a)
        square = 0.0
        for m in range(modes):
            mirrors[a, m] = mirrors[a, m] if m >= a else 0.0
            square += mirrors[a, m] ** 2
        mirrors[a, a] += math.copysign(math.sqrt(square), mirrors[a, a])
        square = 0.0
        for m in range(a, modes):
            square += mirrors[a, m] ** 2
        scale = math.sqrt(2.0 / square)
        for m in range(a, modes):
            mirrors[a, m] *= scale
    for c in range(modes - held):
        for m in range(modes):
            turned[c, m] = 1.0 if m == held + c else 0.0
        for a in range(held - 1, -1, -1):
            _reflect(mirrors, a, modes, turned, c)
        for m in range(modes):
            basis[m, c] = turned[c, m]


@kernel
def _fill_forces(problem, row, motion, free, parts, stiffness, damping):
    """Fill B^T W, G and D, with the signs of accelerations.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    free : number of free coordinates: of the rows and columns that are filled
    parts : B and its transpose, and B^T W, which is filled
    stiffness, damping : G and D
    """
    modes = problem.push.shape[0]
    basis, turned, pulled = parts[BASIS], parts[TURNED], parts[PULLED]
    for c in range(free):
        for m in range(modes):
            pulled[c, m] = turned[c, m] * (row.place_term[0, m] / INVERSE[0])
    slowed = motion.reduced[2 * modes]  # a row of -B^T C
    for c in range(free):
        for m in range(modes):
            slowed[m] = turned[c, m] * (row.velocity_term[0, m] / INVERSE[0])
            for other in range(modes if problem.coupled else 0):
                slowed[m] -= turned[c, other] * row.damping[other, m]
        for d in range(free):
            of_place, of_velocity = 0.0, 0.0
            for m in range(modes):
                of_place += pulled[c, m] * basis[m, d]
                of_velocity += slowed[m] * basis[m, d]
            stiffness[c, d], damping[c, d] = of_place, of_velocity


@inner_kernel
def _term(series, first, free, width, stiffness, damping, k):
    """Fill term k + 2 of the free coordinates.

    Parameters
    ----------
    series, first : series, and the place of term 0, which has `free` rows of `width` numbers
    free, width : n, and 2 n rounded up to whole vectors
    stiffness, damping : G and D
    k : number of the term two before
    """
    whole = free * width
    here, rate = first + k * whole, k + 1.0
    for i in range(0, width, LANES):
        for c in range(free):
            one, two = filled(0.0), filled(0.0)
            for d in range(free):
                one = one + load(series, here + d * width + i) * stiffness[c, d]
                two = two + load(series, here + whole + d * width + i) * damping[c, d]
            store((one + two * rate) * INVERSE[k], series, here + 2 * whole + c * width + i)


@kernel
def fill_free(problem, row, motion, slot):
    """Fill the tables of the present pattern: B, and the series and the values over a whole interval of the
    free coordinates for unit values of f, then of y'(0).
    """
    modes = problem.push.shape[0]
    free = modes - motion.held[problem.spring.size]
    parts, scratch = row.bases[slot], motion.reduced
    _fill_basis(problem, motion, parts[BASIS], parts[TURNED], scratch)
    stiffness, damping = scratch[:modes], scratch[modes : 2 * modes]
    _fill_forces(problem, row, motion, free, parts, stiffness, damping)
    width = padded(2 * free)
    series, whole = row.columns, free * width
    first = slot * LONG * modes * motion.tangent.shape[1]
    for i in range(0, 2 * whole, LANES):
        store(filled(0.0), series, first + i)
    flat = series.reshape(series.size)
    for c in range(free):
        flat[first + whole + c * width + free + c] = 1.0
    for k in range(TERMS):
        _term(series, first, free, width, stiffness, damping, k)
        if k == 0:
            for c in range(free):
                flat[first + 2 * whole + c * width + c] += INVERSE[0]
    _values(row, motion, slot, free, 1.0, row.onward, slot)


@inner_kernel
def _values(row, motion, slot, free, x, table, at):
    """Fill y and y' at x, for unit values of f and y'(0), at a place of a table.

    Parameters
    ----------
    row, motion : Row, Motion
    slot : place of the pattern in the row
    free : n
    x : length of the step
    table, at : (..., size, S), and the place in it that is filled
    """
    modes, size = row.columns.shape[2], motion.tangent.shape[1]
    whole = free * padded(2 * free)
    first = slot * LONG * modes * size
    into = at * table.shape[1] * size
    for i in range(0, whole, LANES):
        place, velocity = filled(0.0), filled(0.0)
        for k in range(LONG - 1, -1, -1):
            velocity = velocity * x + place
            place = place * x + load(row.columns, first + k * whole + i)
        store(place, table, into + i)
        store(velocity, table, into + whole + i)


@inner_kernel
def _add_product(rows, matrix, begin, stride, terms, given, source, into, at, keeps):
    """Fill rows of a matrix with a product of two others, or add it to them.

    Parameters
    ----------
    rows : number of rows of the product
    matrix, begin, stride : numbers of the first factor, the place of its first row, and that of each next one
    terms : number of its columns
    given, source : second factor, in rows of `given` from row `source` on
    into, at : the product, in rows of `into` from row `at` on
    keeps : whether it is added to what is there
    """
    size = into.shape[1]
    for i in range(0, size, LANES):
        for a in range(0, rows, _ROWS):  # each part is a chain of sums: several side by side
            b, c, d = min(a + 1, rows - 1), min(a + 2, rows - 1), min(a + 3, rows - 1)
            one, two, three, four = filled(0.0), filled(0.0), filled(0.0), filled(0.0)
            if keeps:
                one, two = load(into, (at + a) * size + i), load(into, (at + b) * size + i)
                three, four = load(into, (at + c) * size + i), load(into, (at + d) * size + i)
            for k in range(terms):
                part = load(given, (source + k) * size + i)
                one = one + part * matrix[begin + a * stride + k]
                two = two + part * matrix[begin + b * stride + k]
                three = three + part * matrix[begin + c * stride + k]
                four = four + part * matrix[begin + d * stride + k]
            store(one, into, (at + a) * size + i)
            store(two, into, (at + b) * size + i)
            store(three, into, (at + c) * size + i)
            store(four, into, (at + d) * size + i)


@kernel
def advance_free(problem, row, motion, slot, x):
    """Carry the derivatives through x of a step with the tables of a pattern."""
    modes = problem.push.shape[0]
    free = modes - motion.held[problem.spring.size]
    table, at = row.onward, slot
    if x != 1.0:
        table, at = motion.onward, 0
        _values(row, motion, slot, free, x, table, at)
    size, width = motion.tangent.shape[1], padded(2 * free)
    values, begin = table.reshape(table.size), at * table.shape[1] * size
    parts = row.bases.reshape(row.bases.size)
    part = slot * 3 * modes * modes
    units, moves = motion.reduced, 2 * free
    turned, pulled = part + TURNED * modes * modes, part + PULLED * modes * modes
    _add_product(free, parts, pulled, modes, modes, motion.tangent, 0, units, 0, False)
    _add_product(free, parts, turned, modes, modes, motion.tangent, modes, units, free, False)
    _add_product(2 * free, values, begin, width, 2 * free, units, 0, units, moves, False)
    _add_product(modes, parts, part, modes, free, units, moves, motion.tangent, 0, True)
    _add_product(modes, parts, part, modes, free, units, moves + free, motion.tangent, modes, False)


@kernel
def hold_free(problem, row, motion, slot):
    """Take the velocities of held contacts from the derivatives with the tables of a pattern: p = B B^T p."""
    modes = problem.push.shape[0]
    free = modes - motion.held[problem.spring.size]
    parts = row.bases.reshape(row.bases.size)
    part = slot * 3 * modes * modes
    turned = part + TURNED * modes * modes
    _add_product(free, parts, turned, modes, modes, motion.tangent, modes, motion.reduced, 0, False)
    _add_product(modes, parts, part, modes, free, motion.reduced, 0, motion.tangent, modes, False)

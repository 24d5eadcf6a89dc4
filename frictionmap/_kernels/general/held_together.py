"""Forces that hold many contacts, in a term of a series: one product gives them and what they do to modes.

The forces are f = M^-1 (chi a - b u''), with the mobility M of the held contacts, the accelerations a of the
modes without these forces, and those of the walls, and the modes then have a - R f.  Both are linear in a and
u'': the matrix is formed once for all terms of a step.
"""

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, store
from .cholesky import solve_columns
from .problem import MANY, first_contact_row, padded

#: Held contacts from which on that is faster than a solution for every term.
_LEAST_HELD = 4

#: Vectors of a product that are computed side by side.
_SIDE = 4


@kernel
def holds_together(problem, motion):
    """Whether the forces of held contacts are found in this form."""
    contacts = problem.spring.size
    return contacts >= MANY and motion.held[contacts] >= _LEAST_HELD


@kernel
def fill_hold(problem, row, motion):
    """Fill the matrix for the held contacts, whose mobility is factored.

    Returns
    -------
    int : its rows: modes, and channels if any of these contacts is at a wall that they move
    """
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    width, count = row.chi.shape[1], motion.held[contacts]
    grips, hold = motion.grips, motion.hold
    units = modes
    for a in range(count):
        j = motion.held[a]
        for m in range(0, grips.shape[1]):
            grips[a, m] = row.chi[j, m] if m < modes else 0.0
        for d in range(channels):
            grips[a, modes + d] = problem.base[j, d]
            if problem.base[j, d] != 0.0:
                units = modes + channels
    solve_columns(motion.solve, count, grips)
    size = hold.shape[1]
    for m in range(units):
        for i in range(0, width, LANES):
            pull = filled(0.0)
            for a in range(count):
                pull = pull + load(row.reaction, motion.held[a] * width + i) * grips[a, m]
            store(pull, hold, m * size + i)
        for a in range(padded(count)):
            hold[m, width + a] = grips[a, m] if a < count else 0.0
    return units


@inner_kernel
def hold_term(problem, row, k, motion, units):
    """Fill term k of the forces that hold contacts, and take them from term k + 2 of the modes.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    k : number of the term
    units : see `fill_hold`
    """
    modes = problem.push.shape[0]
    contacts = problem.spring.size
    first = first_contact_row(problem) + 2 * contacts
    width, count = row.chi.shape[1], motion.held[contacts]
    hold, size = motion.hold, motion.hold.shape[1]
    last = width + padded(count) - LANES
    found = (hold.shape[0] - 1) * size
    for i in range(0, last + LANES, _SIDE * LANES):
        second, third, fourth = min(i + LANES, last), min(i + 2 * LANES, last), min(i + 3 * LANES, last)
        one, two, three, four = filled(0.0), filled(0.0), filled(0.0), filled(0.0)
        for m in range(units):
            part = motion.moves[k + 2, m] if m < modes else -motion.series[m, k + 2]
            one = one + load(hold, m * size + i) * part
            two = two + load(hold, m * size + second) * part
            three = three + load(hold, m * size + third) * part
            four = four + load(hold, m * size + fourth) * part
        store(one, hold, found + i)
        store(two, hold, found + second)
        store(three, hold, found + third)
        store(four, hold, found + fourth)
    for m in range(0, width, LANES):
        at = (k + 2) * width + m
        store(load(motion.moves, at) - load(hold, found + m), motion.moves, at)
    scale = (k + 1.0) * (k + 2.0)
    for a in range(count):
        motion.series[first + motion.held[a], k] = scale * hold[hold.shape[0] - 1, width + a]

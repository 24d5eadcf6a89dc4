"""Derivatives of the motion by its state at the section, carried through steps and events.

One rule serves every event: it is shifted in time by -(g J)/g', where g is the watched quantity, and for so
long the motion follows its equation of after the event in place of that of before it.
"""

from ..compiler import kernel
from .problem import TERMS


@kernel
def identity(problem, work):
    """Begin: the derivatives at the section itself; the force of an elastic contact that slips is given."""
    size = work.tangent.shape[0]
    for a in range(size):
        for b in range(size):
            work.tangent[a, b] = 1.0 if a == b else 0.0
    for j in range(work.sense.size):
        if work.sense[j] != 0:
            a = 2 * problem.push.shape[0] + j
            work.tangent[a, a] = 0.0


@kernel
def _solve_columns(work, right):
    """`solve_held` for all columns; rows 0.. of `right` belong to the held contacts in their order."""
    contacts = work.sense.size
    count = work.held[contacts]
    size = right.shape[1]
    for a in range(count):
        for c in range(a):
            factor = work.solve[a, c]
            for i in range(size):
                right[a, i] -= factor * right[c, i]
        inverse = 1.0 / work.solve[a, a]
        for i in range(size):
            right[a, i] *= inverse
    for a in range(count - 1, -1, -1):
        for c in range(a + 1, count):
            factor = work.solve[c, a]
            for i in range(size):
                right[a, i] -= factor * right[c, i]
        inverse = 1.0 / work.solve[a, a]
        for i in range(size):
            right[a, i] *= inverse


@kernel
def _accelerations(problem, row, work, k):
    """Fill term k + 2 of the columns with the derivatives of the accelerations, times (k+1)(k+2).

    `work.forces` then holds those of the held contacts' forces, in their order.
    """
    modes = problem.push.shape[0]
    contacts = problem.spring.size
    size = work.tangent.shape[0]
    columns = work.columns
    for m in range(modes):
        stiffness, damping = row.stiffness[m], (k + 1.0) * row.damping[m, m]
        for i in range(size):
            columns[k + 2, m, i] = -stiffness * columns[k, m, i] - damping * columns[k + 1, m, i]
        if problem.coupled:
            for other in range(modes):
                if other != m:
                    damping = (k + 1.0) * row.damping[m, other]
                    for i in range(size):
                        columns[k + 2, m, i] -= damping * columns[k + 1, other, i]
    for j in range(contacts):
        if problem.spring[j] != 0.0 and work.sense[j] == 0:
            if k == 0:
                for i in range(size):
                    work.forces[0, i] = work.tangent[2 * modes + j, i]
            else:
                for i in range(size):
                    work.forces[0, i] = 0.0
                for m in range(modes):
                    stiffness = problem.spring[j] * problem.chi[j, m]
                    for i in range(size):
                        work.forces[0, i] += stiffness * columns[k, m, i]
            for m in range(modes):
                reaction = row.reaction[j, m]
                for i in range(size):
                    columns[k + 2, m, i] -= reaction * work.forces[0, i]
    for a in range(work.held[contacts]):
        for i in range(size):
            work.forces[a, i] = 0.0
        for m in range(modes):
            chi = problem.chi[work.held[a], m]
            for i in range(size):
                work.forces[a, i] += chi * columns[k + 2, m, i]
    _solve_columns(work, work.forces)
    for a in range(work.held[contacts]):
        for m in range(modes):
            reaction = row.reaction[work.held[a], m]
            for i in range(size):
                columns[k + 2, m, i] -= reaction * work.forces[a, i]


@kernel
def _begin_columns(problem, work):
    modes = problem.push.shape[0]
    size = work.tangent.shape[0]
    for m in range(modes):
        for i in range(size):
            work.columns[0, m, i] = work.tangent[m, i]
            work.columns[1, m, i] = work.tangent[modes + m, i]


@kernel
def advance_tangent(problem, row, work, x):
    """Carry the derivatives through x of the present step."""
    modes = problem.push.shape[0]
    size = work.tangent.shape[0]
    columns, tangent = work.columns, work.tangent
    _begin_columns(problem, work)
    for k in range(TERMS):
        _accelerations(problem, row, work, k)
        inverse = 1.0 / ((k + 1.0) * (k + 2.0))
        for m in range(modes):
            for i in range(size):
                columns[k + 2, m, i] *= inverse
    for m in range(modes):
        for i in range(size):
            tangent[m, i] = 0.0
            tangent[modes + m, i] = 0.0
        for k in range(TERMS + 1, -1, -1):
            for i in range(size):
                tangent[modes + m, i] = tangent[modes + m, i] * x + tangent[m, i]
                tangent[m, i] = tangent[m, i] * x + columns[k, m, i]
    for j in range(problem.spring.size):
        if problem.spring[j] != 0.0 and work.sense[j] == 0:
            for m in range(modes):
                stiffness = problem.spring[j] * problem.chi[j, m]
                for i in range(size):
                    tangent[2 * modes + j, i] += stiffness * (tangent[m, i] - columns[0, m, i])


@kernel
def watched_row(problem, row, work, j, sign, out):
    """Derivative of the watched quantity of contact j: its velocity, or minus `sign` times its force.

    Parameters
    ----------
    problem, row, work : Problem, Row, Work; the pattern is that of before the event
    j : contact
    sign : 0: its velocity is watched; 1, -1: the distance of its force from that side of its range
    out : (size,) filled
    """
    modes = problem.push.shape[0]
    contacts = problem.spring.size
    size = work.tangent.shape[0]
    for i in range(size):
        out[i] = 0.0
    if sign == 0:
        for m in range(modes):
            chi = problem.chi[j, m]
            for i in range(size):
                out[i] += chi * work.tangent[modes + m, i]
    elif problem.spring[j] != 0.0:
        for i in range(size):
            out[i] = -sign * work.tangent[2 * modes + j, i]
    else:
        _begin_columns(problem, work)
        _accelerations(problem, row, work, 0)
        for a in range(work.held[contacts]):
            if work.held[a] == j:
                for i in range(size):
                    out[i] = -sign * work.forces[a, i]


@kernel
def through_event(problem, row, work, drop, watched, slope):
    """Carry the derivatives through an event.

    Parameters
    ----------
    problem, row, work : Problem, Row, Work; the pattern is that of after the event
    drop : (N,) forces after the event less those before it
    watched : (size,) derivatives of the watched quantity
    slope : its rate of change along the motion before the event
    """
    modes = problem.push.shape[0]
    size = work.tangent.shape[0]
    for j in range(problem.spring.size):
        if drop[j] != 0.0:
            for m in range(modes):
                factor = -row.reaction[j, m] * drop[j] / slope
                for i in range(size):
                    work.tangent[modes + m, i] += factor * watched[i]
        if problem.spring[j] != 0.0 and work.sense[j] != 0:
            for i in range(size):
                work.tangent[2 * modes + j, i] = 0.0


@kernel
def hold_tangent(problem, row, work):
    """Take the velocities of held contacts from the derivatives: they vanish but for rounding."""
    modes = problem.push.shape[0]
    size = work.tangent.shape[0]
    count = work.held[problem.spring.size]
    for a in range(count):
        for i in range(size):
            work.forces[a, i] = 0.0
        for m in range(modes):
            chi = problem.chi[work.held[a], m]
            for i in range(size):
                work.forces[a, i] += chi * work.tangent[modes + m, i]
    _solve_columns(work, work.forces)
    for a in range(count):
        for m in range(modes):
            reaction = row.reaction[work.held[a], m]
            for i in range(size):
                work.tangent[modes + m, i] -= reaction * work.forces[a, i]

"""Derivatives of the motion by its state at the section, carried through steps and events.

One rule serves every event: it is shifted in time by -(g J)/g', where g is the watched quantity, and for so
long the motion follows its equation of after the event in place of that of before it.
"""

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, store
from .problem import INVERSE, TERMS


@kernel
def identity(problem, work):
    """Begin: the derivatives at the section itself; the force of an elastic contact that slips is given."""
    for a in range(work.tangent.shape[0]):
        for b in range(work.tangent.shape[1]):
            work.tangent[a, b] = 1.0 if a == b else 0.0
    for j in range(work.sense.size):
        if work.sense[j] != 0:
            a = 2 * problem.push.shape[0] + j
            work.tangent[a, a] = 0.0


@inner_kernel
def _solve_columns(work, right):
    """`solve_held` for all columns; rows 0.. of `right` belong to the held contacts in their order."""
    count = work.held[work.sense.size]
    size = right.shape[1]
    for i in range(0, size, LANES):
        for a in range(count):
            part = load(right, a * size + i)
            for c in range(a):
                part = part - load(right, c * size + i) * work.solve[a, c]
            store(part * (1.0 / work.solve[a, a]), right, a * size + i)
        for a in range(count - 1, -1, -1):
            part = load(right, a * size + i)
            for c in range(a + 1, count):
                part = part - load(right, c * size + i) * work.solve[c, a]
            store(part * (1.0 / work.solve[a, a]), right, a * size + i)


@inner_kernel
def _elastic_term(problem, row, work, k):
    """Take the derivatives of the forces of elastic contacts that are held from term k + 2."""
    modes = problem.push.shape[0]
    columns, size = work.columns, work.tangent.shape[1]
    inverse = INVERSE[k]
    for j in range(problem.spring.size):
        if problem.spring[j] == 0.0 or work.sense[j] != 0:
            continue
        for i in range(0, size, LANES):
            force = load(work.tangent, (2 * modes + j) * size + i)
            if k > 0:
                force = filled(0.0)
                for m in range(modes):
                    place = load(columns, (k * modes + m) * size + i)
                    force = force + place * (problem.spring[j] * problem.chi[j, m])
            for m in range(modes):
                at = ((k + 2) * modes + m) * size + i
                store(load(columns, at) - force * (inverse * row.reaction[j, m]), columns, at)


@inner_kernel
def _free_columns(problem, row, work, k):
    """Fill term k + 2 of the columns without forces of held contacts."""
    modes = problem.push.shape[0]
    columns, size = work.columns, work.tangent.shape[1]
    inverse = INVERSE[k]
    for m in range(modes):
        of_place, of_velocity = row.place_term[k, m], row.velocity_term[k, m]
        for i in range(0, size, LANES):
            part = load(columns, (k * modes + m) * size + i) * of_place
            part = part + load(columns, ((k + 1) * modes + m) * size + i) * of_velocity
            if problem.coupled:
                for other in range(modes):
                    rate = (k + 1.0) * inverse * row.damping[m, other]
                    part = part - load(columns, ((k + 1) * modes + other) * size + i) * rate
            store(part, columns, ((k + 2) * modes + m) * size + i)


@inner_kernel
def _holding_columns(problem, row, work, k):
    """Fill the derivatives of the holding forces, over (k+1)(k+2), and take them from term k + 2."""
    modes = problem.push.shape[0]
    columns, size = work.columns, work.tangent.shape[1]
    count = work.held[problem.spring.size]
    for a in range(count):
        j = work.held[a]
        for i in range(0, size, LANES):
            part = filled(0.0)
            for m in range(modes):
                part = part + load(columns, ((k + 2) * modes + m) * size + i) * problem.chi[j, m]
            store(part, work.forces, a * size + i)
    _solve_columns(work, work.forces)
    for a in range(count):
        j = work.held[a]
        for m in range(modes):
            for i in range(0, size, LANES):
                at = ((k + 2) * modes + m) * size + i
                part = load(work.forces, a * size + i) * row.reaction[j, m]
                store(load(columns, at) - part, columns, at)


@inner_kernel
def _term(problem, row, work, k):
    """Fill term k + 2 of the columns."""
    _free_columns(problem, row, work, k)
    _elastic_term(problem, row, work, k)
    if work.held[problem.spring.size] > 0:
        _holding_columns(problem, row, work, k)


@inner_kernel
def _begin_columns(problem, work):
    modes = problem.push.shape[0]
    size = work.tangent.shape[1]
    for i in range(0, modes * size, LANES):
        store(load(work.tangent, i), work.columns, i)
        store(load(work.tangent, modes * size + i), work.columns, modes * size + i)


@inner_kernel
def advance_tangent(problem, row, work, x):
    """Carry the derivatives through x of the present step."""
    modes = problem.push.shape[0]
    columns, tangent = work.columns, work.tangent
    size = tangent.shape[1]
    _begin_columns(problem, work)
    for k in range(TERMS):
        _term(problem, row, work, k)
    for m in range(modes):
        for i in range(0, size, LANES):
            place = filled(0.0)
            velocity = filled(0.0)
            for k in range(TERMS + 1, -1, -1):
                velocity = velocity * x + place
                place = place * x + load(columns, (k * modes + m) * size + i)
            store(place, tangent, m * size + i)
            store(velocity, tangent, (modes + m) * size + i)
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
    out : (S,) filled
    """
    modes = problem.push.shape[0]
    size = work.tangent.shape[1]
    for i in range(size):
        out[i] = 0.0
    if sign == 0:
        for m in range(modes):
            for i in range(size):
                out[i] += problem.chi[j, m] * work.tangent[modes + m, i]
    elif problem.spring[j] != 0.0:
        for i in range(size):
            out[i] = -sign * work.tangent[2 * modes + j, i]
    else:
        _begin_columns(problem, work)
        _term(problem, row, work, 0)
        for a in range(work.held[problem.spring.size]):
            if work.held[a] == j:
                for i in range(size):
                    out[i] = -2.0 * sign * work.forces[a, i]


@kernel
def through_event(problem, row, work, drop, watched, slope):
    """Carry the derivatives through an event.

    Parameters
    ----------
    problem, row, work : Problem, Row, Work; the pattern is that of after the event
    drop : (N,) forces after the event less those before it
    watched : (S,) derivatives of the watched quantity
    slope : its rate of change along the motion before the event
    """
    modes = problem.push.shape[0]
    size = work.tangent.shape[1]
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
    """Take the velocities of held contacts from the derivatives: they are rounding error."""
    modes = problem.push.shape[0]
    size = work.tangent.shape[1]
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

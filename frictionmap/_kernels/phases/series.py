"""Taylor series of a step in the present phase, and the forces that hold rigid contacts."""

import numpy as np

from ..compiler import inner_kernel, kernel
from ..general.problem import LONG, TERMS
from .problem import ELASTIC, RIGID, SMOOTH, D, F, W, Z, observed_row, put_loads

#: Share of its mobility that a contact keeps when others are held, below which it is held with them.
_SINGULAR = 1e-12


@inner_kernel
def dot(rows, j, vector):
    """Product of row j of a table and a vector."""
    sum_ = 0.0
    for i in range(vector.size):
        sum_ += rows[j, i] * vector[i]
    return sum_


@inner_kernel
def is_held(problem, motion, j):
    """Whether friction holds a closed contact."""
    return problem.law[j] != SMOOTH and motion.sense[j] == 0 and motion.open[j] == 0


@inner_kernel
def limit_at(problem, cell, j, pressed):
    """Kinetic friction at a normal displacement d.x."""
    return cell.limit[j] + problem.lift[j] * pressed


@kernel
def factor_held(problem, row, motion):
    """List the rigid contacts that are held, and factor their mobility; False if it is singular."""
    count = 0
    for j in range(problem.law.size):
        if problem.law[j] == RIGID and is_held(problem, motion, j):
            motion.held[count] = j
            count += 1
    motion.held[problem.law.size] = count
    for a in range(count):
        for b in range(a + 1):
            rest = dot(row.reaction, motion.held[a], problem.chi[motion.held[b]])
            whole = rest
            for c in range(b):
                rest -= motion.factor[a, c] * motion.factor[b, c]
            if a > b:
                motion.factor[a, b] = rest / motion.factor[b, b]
            elif rest > _SINGULAR * whole:
                motion.factor[a, a] = np.sqrt(rest)
            else:
                return False
    return True


@kernel
def solve_held(problem, motion, right):
    """Solve for the forces that take these accelerations from the contacts held."""
    count = motion.held[problem.law.size]
    for a in range(count):
        for c in range(a):
            right[a] -= motion.factor[a, c] * right[c]
        right[a] /= motion.factor[a, a]
    for a in range(count - 1, -1, -1):
        for c in range(a + 1, count):
            right[a] -= motion.factor[c, a] * right[c]
        right[a] /= motion.factor[a, a]


@inner_kernel
def _put_forces(problem, row, cell, motion, terms, k, driven):
    """Fill term k of the friction forces and of the normal displacements.

    Parameters
    ----------
    problem, row, cell, motion : Problem, Row, Cell, Motion
    terms : Terms that are filled
    k : number of the term
    driven : 1.0 with loads, 0.0 for a difference of motions
    """
    modes = problem.squares.size
    for j in range(problem.law.size):
        pressed = dot(problem.normal, j, terms.moves[k]) if problem.presses[j] else 0.0
        terms.press[k, j] = pressed
        if motion.open[j] != 0 or problem.law[j] == SMOOTH:
            terms.force[k, j] = 0.0
        elif motion.sense[j] != 0:
            force = problem.lift[j] * pressed
            if k == 0:
                force += driven * cell.limit[j]
            terms.force[k, j] = motion.sense[j] * force
        elif problem.law[j] == RIGID:
            terms.force[k, j] = 0.0
        elif k > 0:
            z = dot(problem.chi, j, terms.moves[k])
            if driven != 0.0:
                z -= problem.moved[j] * motion.drive[k, modes] + (row.belt[j] if k == 1 else 0.0)
            terms.force[k, j] = problem.spring[j] * z


@inner_kernel
def normal_change(problem, cell, motion, terms, k, j, driven):
    """Term k of N - max(0, N0) of a contact.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion
    terms : Terms
    k : number of the term
    j : contact
    driven : as in `_put_forces`
    """
    if motion.open[j] != 0:
        return -driven * max(cell.preload[j], 0.0) if k == 0 else 0.0
    change = problem.pressed[j] * terms.press[k, j]
    return change + driven * min(cell.preload[j], 0.0) if k == 0 else change


@inner_kernel
def spring_force(problem, s, piece, displacement):
    """Force of a spring on the line of one of its pieces."""
    knot = max(piece - 1, 0)
    return problem.forces[s, knot] + problem.slopes[s, piece] * (displacement - problem.knots[s, knot])


@inner_kernel
def _spring_term(problem, motion, terms, k, s, driven):
    """Term k of the force of a spring."""
    piece = motion.piece[s]
    stretched = dot(problem.along, s, terms.moves[k])
    if k > 0 or driven == 0.0:
        return problem.slopes[s, piece] * stretched
    return spring_force(problem, s, piece, stretched)


@inner_kernel
def _hold(problem, row, motion, terms, k, driven):
    """Fill term k of the forces that hold rigid contacts, and take them from term k + 2 of the modes."""
    count, modes = motion.held[problem.law.size], problem.squares.size
    for a in range(count):
        j = motion.held[a]
        terms.right[a] = dot(problem.chi, j, terms.moves[k + 2])
        if driven != 0.0:
            terms.right[a] -= problem.moved[j] * motion.drive[k + 2, modes]
    solve_held(problem, motion, terms.right)
    for a in range(count):
        j = motion.held[a]
        terms.force[k, j] = (k + 1.0) * (k + 2.0) * terms.right[a]
        for i in range(modes):
            terms.moves[k + 2, i] -= row.reaction[j, i] * terms.right[a]


@kernel
def expand(problem, row, cell, motion, terms, count, driven):
    """Fill Taylor terms from the first two of the modes and the first of the elastic forces.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion : Motion, whose pattern and load are used
    terms : Terms that are filled
    count : number of terms of the accelerations, TERMS at most
    driven : 1.0 with loads, 0.0 for a difference of motions
    """
    modes, moves = problem.squares.size, terms.moves
    for k in range(count):
        _put_forces(problem, row, cell, motion, terms, k, driven)
        for i in range(modes):
            moves[k + 2, i] = -row.stiffness[i] * moves[k, i]
            for other in range(modes):
                moves[k + 2, i] -= row.damping[i, other] * ((k + 1.0) * moves[k + 1, other])
            if driven != 0.0:
                moves[k + 2, i] += motion.drive[k, i] + (cell.constant[i] if k == 0 else 0.0)
        for j in range(problem.law.size):
            force = terms.force[k, j]
            for i in range(modes):
                moves[k + 2, i] -= row.reaction[j, i] * force
            if problem.presses[j]:
                change = normal_change(problem, cell, motion, terms, k, j, driven)
                for i in range(modes):
                    moves[k + 2, i] -= row.push[j, i] * change
        for s in range(problem.along.shape[0]):
            force = _spring_term(problem, motion, terms, k, s, driven)
            for i in range(modes):
                moves[k + 2, i] -= row.pull[s, i] * force
        for i in range(modes):
            moves[k + 2, i] /= (k + 1.0) * (k + 2.0)
        if motion.held[problem.law.size] > 0:
            _hold(problem, row, motion, terms, k, driven)


@kernel
def begin_step(problem, row, cell, tau, interval, motion):
    """Fill the series of the step that begins at the phase tau; `interval` is its number, -1 within one."""
    if interval >= 0 and row.intervals > 0:
        for k in range(LONG):
            for i in range(motion.drive.shape[1]):
                motion.drive[k, i] = row.loads[interval, k, i]
    elif row.orders.size > 0:
        put_loads(row, tau, motion.drive)
    begin_terms(problem, row, cell, motion, TERMS)


@kernel
def begin_terms(problem, row, cell, motion, count):
    """Fill some terms of the step that begins at the present state; see `expand`."""
    for i in range(problem.squares.size):
        motion.terms.moves[0, i] = motion.q[i]
        motion.terms.moves[1, i] = motion.p[i]
    for j in range(problem.law.size):
        motion.terms.force[0, j] = motion.f[j]
    expand(problem, row, cell, motion, motion.terms, count, 1.0)


@kernel
def _put_displacement(rows, j, moves, series, at):
    """Fill the series of a displacement that is linear in the modes."""
    for k in range(LONG):
        series[at, k] = dot(rows, j, moves[k])


@kernel
def observe(problem, row, motion, whole):
    """Fill the series of what is watched; all of them, and the rows observed, if `whole`."""
    contacts, modes, series = problem.law.size, problem.squares.size, motion.series
    moves = motion.terms.moves
    for j in range(contacts):
        if whole or motion.sense[j] != 0:
            _put_displacement(problem.chi, j, moves, series, Z * contacts + j)
            for k in range(LONG):
                series[Z * contacts + j, k] -= problem.moved[j] * motion.drive[k, modes]
            for k in range(LONG - 1):
                series[W * contacts + j, k] = (k + 1.0) * series[Z * contacts + j, k + 1]
            series[W * contacts + j, 0] -= row.belt[j]
        for k in range(TERMS):
            series[F * contacts + j, k] = motion.terms.force[k, j]
        if problem.presses[j]:
            _put_displacement(problem.normal, j, moves, series, D * contacts + j)
    first = observed_row(problem)
    for s in range(problem.along.shape[0]):
        _put_displacement(problem.along, s, moves, series, first + s)
    if whole:
        first += problem.along.shape[0]
        for k in range(problem.observed.shape[0]):
            _put_displacement(problem.observed, k, moves, series, first + k)


@kernel
def advance(problem, cell, motion, x):
    """Move the state on by x of the present step."""
    for i in range(problem.squares.size):
        q, p = 0.0, 0.0
        for k in range(LONG - 1, -1, -1):
            p = p * x + q
            q = q * x + motion.terms.moves[k, i]
        motion.q[i], motion.p[i] = q, p
    for j in range(problem.law.size):
        if problem.law[j] == ELASTIC and is_held(problem, motion, j):
            f = 0.0
            for k in range(TERMS - 1, -1, -1):
                f = f * x + motion.terms.force[k, j]
            motion.f[j] = f
    slave_forces(problem, cell, motion)


@kernel
def slave_forces(problem, cell, motion):
    """Set the forces of elastic contacts that slip or are open."""
    for j in range(problem.law.size):
        if problem.law[j] != ELASTIC or motion.open[j] != 0:
            motion.f[j] = 0.0
        elif motion.sense[j] != 0:
            motion.f[j] = motion.sense[j] * limit_at(problem, cell, j, dot(problem.normal, j, motion.q))


@kernel
def is_tied(problem, motion, j):
    """Whether rigid contacts that are held keep both ends of an elastic contact at rest."""
    count = 0
    for i in range(problem.law.size):
        if problem.ties[j, i]:
            if not is_held(problem, motion, i):
                return False
            count += 1
    return count > 0


@kernel
def sliding_velocity(problem, row, motion, j):
    """Velocity in a contact relative to its wall; `drive` is that of the present time."""
    wall = problem.moved[j] * motion.drive[1, problem.squares.size] + row.belt[j]
    return dot(problem.chi, j, motion.p) - wall


@kernel
def stop_exactly(problem, row, motion):
    """Remove rounding errors, and those of Newton's method, from the velocities of contacts held."""
    right = motion.terms.right
    count = motion.held[problem.law.size]
    for a in range(count):
        right[a] = sliding_velocity(problem, row, motion, motion.held[a])
    solve_held(problem, motion, right)
    for a in range(count):
        for i in range(problem.squares.size):
            motion.p[i] -= row.reaction[motion.held[a], i] * right[a]

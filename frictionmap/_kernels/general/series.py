"""Taylor series of a step: modes, contacts and friction forces, from the state and the pattern at its start.

Term k of the accelerations follows from the terms up to k + 1 of the modes, by the equation of motion; the
forces that hold contacts are those for which the accelerations in these contacts vanish.  No case is special:
not resonance, not critical damping, not a combination of held contacts.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import inner_kernel, kernel
from .problem import LONG, TERMS, set_channels


class Friction(NamedTuple):
    """Friction of every contact in one cell, over the load's unit."""

    kinetic: np.ndarray  # (N,) beta_i
    static: np.ndarray  # (N,) mu_i beta_i


@inner_kernel
def first_contact_row(problem):
    """Row of the displacement z of the first contact; those of w, f and nu follow, N rows each."""
    return problem.push.shape[0] + problem.push.shape[1]


@kernel
def factor_held(problem, row, work):
    """List the rigid contacts that are held, and factor their mobility (Cholesky); False if it is singular."""
    contacts = work.sense.size
    count = 0
    for j in range(contacts):
        if work.sense[j] == 0 and problem.spring[j] == 0.0:
            work.held[count] = j
            count += 1
    work.held[contacts] = count
    for a in range(count):
        for b in range(a + 1):
            rest = row.mobility[work.held[a], work.held[b]]
            for c in range(b):
                rest -= work.solve[a, c] * work.solve[b, c]
            if a > b:
                work.solve[a, b] = rest / work.solve[b, b]
            elif rest > 0.0:
                work.solve[a, a] = np.sqrt(rest)
            else:
                return False
    return True


@inner_kernel
def solve_held(work, right):
    """Solve for the forces that hold contacts; `right` holds their accelerations and then the forces."""
    contacts = work.sense.size
    count = work.held[contacts]
    for a in range(count):
        for c in range(a):
            right[a] -= work.solve[a, c] * right[c]
        right[a] /= work.solve[a, a]
    for a in range(count - 1, -1, -1):
        for c in range(a + 1, count):
            right[a] -= work.solve[c, a] * right[c]
        right[a] /= work.solve[a, a]


@inner_kernel
def _displacement_term(problem, j, k, series, first):
    """Term k of the displacement in a contact."""
    modes = problem.push.shape[0]
    z = 0.0
    for m in range(modes):
        z += problem.chi[j, m] * series[m, k]
    for d in range(problem.push.shape[1]):
        z -= problem.base[j, d] * series[modes + d, k]
    series[first + j, k] = z
    return z


@inner_kernel
def _normal_loads(problem, series, first):
    """Fill the series of the normal loads."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    for j in range(contacts):
        nu = first + 3 * contacts + j
        for k in range(TERMS):
            series[nu, k] = 0.0
        series[nu, 0] = 1.0
        for d in range(channels):
            if problem.normal[j, d] != 0.0:
                for k in range(TERMS):
                    series[nu, k] += problem.normal[j, d] * series[modes + d, k]


@inner_kernel
def _sliding_forces(problem, friction, work, first):
    """Fill the forces of sliding contacts; those of held ones begin at 0, of elastic ones at their force."""
    contacts = problem.spring.size
    series = work.series
    for j in range(contacts):
        f, nu = first + 2 * contacts + j, first + 3 * contacts + j
        size = work.sense[j] * friction.kinetic[j]
        for k in range(TERMS):
            series[f, k] = size * series[nu, k]
        if work.sense[j] == 0 and problem.spring[j] != 0.0:
            series[f, 0] = work.state[2, j]


@inner_kernel
def _acceleration(problem, row, k, series, first, m):
    """Term k of the acceleration of mode m under all known forces."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    found = -row.stiffness[m] * series[m, k]
    if problem.coupled:
        for other in range(modes):
            found -= row.damping[m, other] * ((k + 1.0) * series[other, k + 1])
    else:
        found -= row.damping[m, m] * ((k + 1.0) * series[m, k + 1])
    for d in range(channels):
        found += row.push[m, d] * series[modes + d, k]
    for j in range(contacts):
        found -= row.reaction[j, m] * series[first + 2 * contacts + j, k]
    return found


@inner_kernel
def _holding_forces(problem, k, work, first):
    """Fill term k of the forces that hold contacts; accelerations are in term k + 2 of the modes."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    count = work.held[contacts]
    series, right = work.series, work.solve[contacts]
    for a in range(count):
        j = work.held[a]
        wanted = 0.0
        for d in range(channels):
            if problem.base[j, d] != 0.0:
                wanted += problem.base[j, d] * ((k + 1.0) * (k + 2.0) * series[modes + d, k + 2])
        right[a] = -wanted
        for m in range(modes):
            right[a] += problem.chi[j, m] * series[m, k + 2]
    solve_held(work, right)
    for a in range(count):
        series[first + 2 * contacts + work.held[a], k] = right[a]


@kernel
def expand(problem, row, friction, tau, work):
    """Fill the series of the step that begins at the phase tau with the state and pattern in `work`."""
    modes = problem.push.shape[0]
    contacts = problem.spring.size
    series, first = work.series, first_contact_row(problem)
    h = row.numbers[0]
    set_channels(problem, row, tau, series)
    _normal_loads(problem, series, first)
    _sliding_forces(problem, friction, work, first)
    for m in range(modes):
        series[m, 0] = work.state[0, m]
        series[m, 1] = work.state[1, m]
    for k in range(TERMS):
        for j in range(contacts):
            if work.sense[j] == 0 and problem.spring[j] != 0.0 and k > 0:
                z = _displacement_term(problem, j, k, series, first)
                series[first + 2 * contacts + j, k] = problem.spring[j] * (
                    z - h * problem.belt[j] if k == 1 else z
                )
        for m in range(modes):
            series[m, k + 2] = _acceleration(problem, row, k, series, first, m)
        if work.held[contacts] > 0:
            _holding_forces(problem, k, work, first)
            for a in range(work.held[contacts]):
                j = work.held[a]
                for m in range(modes):
                    series[m, k + 2] -= row.reaction[j, m] * series[first + 2 * contacts + j, k]
        inverse = 1.0 / ((k + 1.0) * (k + 2.0))
        for m in range(modes):
            series[m, k + 2] *= inverse
    _contact_motion(problem, work, first, h)


@inner_kernel
def _contact_motion(problem, work, first, h):
    """Fill the displacements in the contacts, and the velocities relative to their walls."""
    contacts = problem.spring.size
    series = work.series
    for j in range(contacts):
        for k in range(LONG):
            _displacement_term(problem, j, k, series, first)
        w = first + contacts + j
        for k in range(TERMS):
            series[w, k] = (k + 1.0) * series[first + j, k + 1]
        series[w, 0] -= h * problem.belt[j]


@kernel
def advance(problem, x, work):
    """Move the state on by x <= 1 of the present step."""
    first = first_contact_row(problem)
    contacts = problem.spring.size
    series = work.series
    for m in range(problem.push.shape[0]):
        place = 0.0
        velocity = 0.0
        for k in range(LONG - 1, -1, -1):
            velocity = velocity * x + place
            place = place * x + series[m, k]
        work.state[0, m] = place
        work.state[1, m] = velocity
    for j in range(contacts):
        if problem.spring[j] != 0.0 and work.sense[j] == 0:
            force = 0.0
            for k in range(TERMS - 1, -1, -1):
                force = force * x + series[first + 2 * contacts + j, k]
            work.state[2, j] = force

"""Newton's method for the state that returns, its multiplier, and what proves that a motion goes there.

The difference of two motions has the energy E = (r^2 |q'|^2 + |w q|^2 + sum f^2/k)/2, with the differences of
the forces f of all elements, and E falls (theory.md 12).  There is one steady motion up to constant forces in
elements that never slip.  These forces are those of the start: the motion from a state goes to the orbit
found if no such element slips on the way, which E proves.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..general.problem import SECTION
from ..spectral_radius import spectral_radius
from .follow import FOLLOWED, follow_period
from .level import displacement, slider, slipping
from .problem import MOST_MEMORIES, State, make_state
from .step import put_waves
from .tangent import begin_tangent, memories

#: Steps of Newton's method, at most.
_MOST_STEPS = 16

#: Change on return, over the size of the motion, that is rounding error, and that is accepted where it does
#: not fall any more: motions have some hundred steps.
_CONVERGED, _ACCEPTED = 1e-14, 1e-11

#: Share of the displacement under the load below which a motion is none: its rounding errors are those of the
#: load's forces, 1e-16 of that displacement in every step.
_NO_MOTION = 1e-4

#: Distance from the orbit, over the size of the motion, at which the motion is there.
_ARRIVED = 1e-11

#: Pivots below this share of the largest one belong to directions in which all states return.
_FREE = 1e-10


class Memory(NamedTuple):
    """States at the section, and what Newton's method needs."""

    start: State
    last: State  # of the motion followed
    orbit: State  # found last, if `known` is not 0
    most: np.ndarray  # (2, N) int: levels of the orbit, as of a `Motion`
    range: np.ndarray  # (2, N) its displacements
    radius: np.ndarray  # (1,) its multiplier
    known: np.ndarray  # (1,) int
    matrix: np.ndarray  # (size, size)
    square: np.ndarray  # (size, size)
    right: np.ndarray  # (size,)
    sliders: np.ndarray  # (2, E) places of the sliders of two states
    off: np.ndarray  # (1,) distance of the last return


@entry
def make_memory(problem):
    """Allocate the memory of a cell."""
    size, contacts = 2 * problem.squares.size + MOST_MEMORIES, problem.moved.size
    return Memory(
        make_state(problem), make_state(problem), make_state(problem), np.zeros((2, contacts), np.int64),
        np.zeros((2, contacts)), np.zeros(1), np.zeros(1, np.int64), np.zeros((size, size)),
        np.zeros((size, size)), np.zeros(size), np.zeros((2, problem.spring.size)), np.zeros(1),
    )  # fmt: skip


@kernel
def copy_state(state, into):
    """Copy a state."""
    for i in range(state.q.size):
        into.q[i], into.p[i] = state.q[i], state.p[i]
    for i in range(state.place.size):
        into.place[i], into.side[i], into.turn[i] = state.place[i], state.side[i], state.turn[i]
    for j in range(state.level.size):
        into.level[j], into.sense[j], into.lead[j] = state.level[j], state.sense[j], state.lead[j]


@kernel
def put_sliders(problem, row, cell, motion, out):
    """Set the places of the sliders of a state at the section."""
    put_waves(row, SECTION, motion)
    for j in range(problem.moved.size):
        z = displacement(problem, motion, j)
        for i in range(problem.first[j], problem.first[j + 1]):
            out[i] = slider(problem, cell, motion, j, i, z)


@kernel
def state_size(row, state):
    """Size of a motion, the unit of `distance`."""
    size = _NO_MOTION * row.size
    for i in range(state.q.size):
        size = max(size, abs(state.q[i]), abs(state.p[i]))
    return size


@kernel
def distance(state, other, sliders):
    """Largest difference of two states, as a displacement; sliders (2, E) are those of both."""
    off = 0.0
    for i in range(state.q.size):
        off = max(off, abs(state.q[i] - other.q[i]), abs(state.p[i] - other.p[i]))
    for i in range(sliders.shape[1]):
        off = max(off, abs(sliders[0, i] - sliders[1, i]))
    return off


@kernel
def go_round(problem, row, cell, motion, memory):
    """Follow a period from the state in `motion`, kept as `start`; its code, and `off`."""
    copy_state(motion.now, memory.start)
    put_sliders(problem, row, cell, motion, memory.sliders[0])
    code = follow_period(problem, row, cell, motion)
    put_sliders(problem, row, cell, motion, memory.sliders[1])
    memory.off[0] = distance(memory.start, motion.now, memory.sliders)
    return code


@kernel
def _put_equations(problem, motion, memory):
    """Fill the equations (I - J) dy = phi(y) - y; coordinates as in `begin_tangent`."""
    start, now, tangent, modes = memory.start, motion.now, motion.tangent, problem.squares.size
    size = tangent.count[0]
    for i in range(modes):
        memory.right[i], memory.right[modes + i] = now.q[i] - start.q[i], now.p[i] - start.p[i]
        for c in range(size):
            memory.square[i, c], memory.square[modes + i, c] = tangent.q[i, c], tangent.p[i, c]
    at = 2 * modes - 1
    for j in range(problem.moved.size):
        first = problem.first[j] + start.level[j]
        for i in range(first, problem.first[j + 1]):
            if start.turn[i] == 0 or (i > first and start.turn[i] == start.turn[i - 1]):
                continue
            at += 1
            memory.right[at] = memory.sliders[1, i] - memory.sliders[0, i]
            for c in range(size):
                slope = tangent.slider[i, c]
                if i < problem.first[j] + now.level[j]:  # its slider moves with the contact
                    slope = 0.0
                    for k in range(modes):
                        slope += problem.chi[j, k] * tangent.q[k, c]
                memory.square[at, c] = slope
    for a in range(size):
        for c in range(size):
            memory.matrix[a, c] = (1.0 if a == c else 0.0) - memory.square[a, c]


@kernel
def _solve(matrix, right, size):
    """Solve linear equations by elimination, the solution in `right`; False where they are singular."""
    first = 0.0
    for done in range(size):
        best = done
        for a in range(done + 1, size):
            if abs(matrix[a, done]) > abs(matrix[best, done]):
                best = a
        first = max(first, abs(matrix[best, done]))
        if abs(matrix[best, done]) <= _FREE * first:
            return False
        for c in range(size):
            matrix[done, c], matrix[best, c] = matrix[best, c], matrix[done, c]
        right[done], right[best] = right[best], right[done]
        for a in range(done + 1, size):
            share = matrix[a, done] / matrix[done, done]
            for c in range(done, size):
                matrix[a, c] -= share * matrix[done, c]
            right[a] -= share * right[done]
    for a in range(size - 1, -1, -1):
        for c in range(a + 1, size):
            right[a] -= matrix[a, c] * right[c]
        right[a] /= matrix[a, a]
    return True


@kernel
def _take_step(problem, motion, memory):
    """Set the state to that of a step of Newton's method, with the turns of the last return."""
    start, now, modes = memory.start, motion.now, problem.squares.size
    for i in range(modes):
        now.q[i] = start.q[i] + memory.right[i]
        now.p[i] = start.p[i] + memory.right[modes + i]
    at = 2 * modes - 1
    for j in range(problem.moved.size):
        first = problem.first[j] + start.level[j]
        for i in range(first, problem.first[j + 1]):
            if start.turn[i] != 0:
                if i == first or start.turn[i] != start.turn[i - 1]:
                    at += 1
                memory.sliders[0, i] += memory.right[at] - memory.sliders[1, i]
            else:
                memory.sliders[0, i] = 0.0
        for i in range(problem.first[j], first):
            memory.sliders[0, i] = 0.0
        first = problem.first[j] + now.level[j]
        shift = 0.0
        for i in range(first, problem.first[j + 1]):
            if now.turn[i] == 0:
                continue
            if i == first or now.turn[i] != now.turn[i - 1]:
                shift = memory.sliders[0, i]
            now.place[i] += shift


@kernel
def find_orbit(problem, row, cell, motion, memory):
    """Find the state that returns after a period, from that of `motion` after a period; whether it was.

    If so, `start` and `motion` have it, and the counts, levels and ranges are those of the orbit.
    """
    last = np.inf
    for _ in range(_MOST_STEPS):
        if memories(problem, motion) < 0:
            return False
        begin_tangent(problem, motion)
        code = go_round(problem, row, cell, motion, memory)
        size, off = state_size(row, memory.start), memory.off[0]
        if code != FOLLOWED or off > size or off > 100.0 * last:
            return False
        _put_equations(problem, motion, memory)
        if off <= _CONVERGED * size or (off <= _ACCEPTED * size and off > 0.25 * last):
            return True
        last = off
        if not _solve(memory.matrix, memory.right, motion.tangent.count[0]):
            return False
        _take_step(problem, motion, memory)
    return False


@kernel
def _multiplier(motion, memory):
    """Largest modulus of the multipliers of the orbit found last."""
    size = motion.tangent.count[0]
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = memory.square[a, b]
    return spectral_radius(memory.matrix, size, memory.square, 0.0)


@kernel
def _edge(motion, j, rank):
    """The side on which an element that rests in the orbit is at its limit: 1, -1, or 0; see `slipping`."""
    if rank < motion.most[1, j]:
        return 1
    return -1 if rank < motion.most[0, j] else 0


@kernel
def _margin(problem, cell, motion, sliders, j):
    """Least way of the sliders of contact j that rest in the orbit to limits that they are not at there."""
    found = np.inf
    for i in range(problem.first[j] + slipping(motion, j), problem.first[j + 1]):
        side = _edge(motion, j, i - problem.first[j])
        if side <= 0:
            found = min(found, cell.limit[i] - (motion.range[1, j] - sliders[i]))
        if side >= 0:
            found = min(found, cell.limit[i] - (sliders[i] - motion.range[0, j]))
    return found


@kernel
def _energy(problem, row, state, other, sliders, z):
    """Twice the energy of the difference of two states; sliders (2, E) and z (N, 2 or more) are of both."""
    total = 0.0
    for i in range(problem.squares.size):
        q, p = state.q[i] - other.q[i], state.p[i] - other.p[i]
        total += row.r * row.r * p * p + problem.squares[i] * q * q
    for j in range(problem.moved.size):
        for i in range(problem.first[j], problem.first[j + 1]):
            off = (z[j, 0] - sliders[0, i]) - (z[j, 1] - sliders[1, i])
            total += problem.spring[i] * off * off
    return total


@kernel
def keep_orbit(motion, memory):
    """Keep the orbit found, at whose end `motion` is."""
    copy_state(motion.now, memory.orbit)
    for j in range(memory.most.shape[1]):
        for which in range(2):
            memory.most[which, j], memory.range[which, j] = motion.most[which, j], motion.range[which, j]
    memory.radius[0] = _multiplier(motion, memory)
    memory.known[0] = 1
    motion.tangent.count[0] = 0


@kernel
def _put_both(problem, row, cell, motion, memory):
    """Set the sliders and displacements of the state `last` and of the orbit, and go to that."""
    for which in range(2):
        copy_state(memory.last if which == 0 else memory.orbit, motion.now)
        put_sliders(problem, row, cell, motion, memory.sliders[which])
        for j in range(problem.moved.size):
            motion.z[j, which] = displacement(problem, motion, j)
            motion.most[which, j], motion.range[which, j] = memory.most[which, j], memory.range[which, j]


@kernel
def _places_stay(problem, motion, sliders, creeps):
    """Whether the sliders that rest in the orbit are where they are there, or creep there; sliders (2, E)."""
    for j in range(problem.moved.size):
        for i in range(problem.first[j] + slipping(motion, j), problem.first[j + 1]):
            side = _edge(motion, j, i - problem.first[j])
            if side != 0 and not (creeps and side * (sliders[1, i] - sliders[0, i]) >= 0.0):
                return False
            if side == 0 and sliders[0, i] != sliders[1, i]:
                return False
    return True


@kernel
def leads_there(problem, row, cell, motion, memory, creeps):
    """Whether the motion from the state `last` goes to the orbit that is kept; if so, `motion` does.

    It does if the sliders that rest in the orbit are where they are there, and rest on the way: their margins
    are larger than the largest |z| of a difference with the energy of the present one.  With `creeps` the
    motion changes slowly only, as where sliders creep: they may slip towards a limit that they rest at there.
    """
    sliders = memory.sliders
    _put_both(problem, row, cell, motion, memory)
    if distance(memory.last, memory.orbit, sliders) <= _ARRIVED * state_size(row, memory.orbit):
        return True
    if not _places_stay(problem, motion, sliders, creeps):
        memory.known[0] = 0
        return False
    energy = _energy(problem, row, memory.last, memory.orbit, sliders, motion.z)
    for j in range(problem.moved.size):
        # the springs of sliders that rest are part of the energy
        rest = problem.left[problem.first[j] + j + slipping(motion, j)]
        most = energy * row.softness[j] / (1.0 + row.softness[j] * rest)
        if math.sqrt(most) >= _margin(problem, cell, motion, sliders[1], j):
            return False
    return True

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
from ..structure.newton import solve_linear
from .follow import FOLLOWED, follow_period
from .level import displacement, slider, slipping, slope_of
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
def go_round(problem, row, cell, motion, memory, half):
    """Follow a period, or half of one, from the state in `motion`, kept as `start`; its code, and `off`."""
    copy_state(motion.now, memory.start)
    put_sliders(problem, row, cell, motion, memory.sliders[0])
    code = follow_period(problem, row, cell, motion, half)
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
                    slope = slope_of(problem, tangent, j, c)
                memory.square[at, c] = slope
    for a in range(size):
        for c in range(size):
            memory.matrix[a, c] = (1.0 if a == c else 0.0) - memory.square[a, c]


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
def find_orbit(problem, row, cell, motion, memory, half, hasty):
    """Find the state that returns after a period, from that of `motion` after a period.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion, memory : Motion, Memory
    half : whether half a period is followed, see `follow_period`
    hasty : whether the state may be one that is expected to return, and has not been followed

    Returns
    -------
    int
        Returns followed; 0 if none was found.  `motion` has the state, and if not hasty nor half, the counts,
        levels and ranges of the orbit.
    """
    last = np.inf
    for count in range(1, _MOST_STEPS + 1):
        if memories(problem, motion) < 0:
            return 0
        begin_tangent(problem, motion)
        code = go_round(problem, row, cell, motion, memory, half)
        size, off = state_size(row, memory.start), memory.off[0]
        if code != FOLLOWED or off > size or off > 100.0 * last:
            return 0
        _put_equations(problem, motion, memory)
        if off <= _CONVERGED * size or (off <= _ACCEPTED * size and off > 0.25 * last):
            return count
        if not solve_linear(memory.matrix, memory.right, motion.tangent.count[0]):
            return 0
        _take_step(problem, motion, memory)
        # the steps converge quadratically
        if hasty and count > 1 and off * (off / last) ** 2 <= 0.1 * _CONVERGED * size:
            return count
        last = off
    return 0


@kernel
def put_multiplier(motion, memory, half):
    """Keep the largest modulus of the multipliers of the orbit found last, over half a period or all."""
    size = motion.tangent.count[0]
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = memory.square[a, b]
    radius = spectral_radius(memory.matrix, size, memory.square, 0.0)
    memory.radius[0] = radius * radius if half else radius
    motion.tangent.count[0] = 0


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
    memory.known[0] = 1


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
def _put_forces_at_rest(problem, motion, memory):
    """Fill the equations of the displacements by the forces of sliders at rest that are not where they are in
    the orbit: whether there are some, and whether others are at an edge; after `_put_both`.
    """
    chi, sliders, modes, moves, edges = problem.chi, memory.sliders, problem.squares.size, False, False
    for a in range(modes):
        memory.right[a] = 0.0
        for b in range(modes):
            memory.matrix[a, b] = problem.squares[a] if a == b else 0.0
    for j in range(problem.moved.size):
        at = problem.first[j] + slipping(motion, j)
        pull, left = 0.0, problem.left[at + j]
        for i in range(at, problem.first[j + 1]):
            if _edge(motion, j, i - problem.first[j]) != 0:
                edges = True
            elif sliders[0, i] != sliders[1, i]:
                moves = True
                pull += problem.spring[i] * (sliders[0, i] - sliders[1, i])
        for a in range(modes):
            memory.right[a] += chi[j, a] * pull
            for b in range(modes):
                memory.matrix[a, b] += chi[j, a] * left * chi[j, b]
    return moves, edges


@kernel
def move_orbit(problem, row, cell, motion, memory):
    """Move the orbit that is kept to the sliders at rest of the state `last`: by a static displacement.

    It is forgotten if sliders are at rest at an edge.
    """
    _put_both(problem, row, cell, motion, memory)
    moves, edges = _put_forces_at_rest(problem, motion, memory)
    if not moves:
        return
    orbit, modes = memory.orbit, problem.squares.size
    if edges or not solve_linear(memory.matrix, memory.right, modes):
        memory.known[0] = 0
        return
    for i in range(modes):
        orbit.q[i] += memory.right[i]
    for j in range(problem.moved.size):
        way, at = 0.0, problem.first[j] + slipping(motion, j)
        for i in range(modes):
            way += problem.chi[j, i] * memory.right[i]
        memory.range[0, j] += way
        memory.range[1, j] += way
        for i in range(problem.first[j], at):
            orbit.place[i] += way
        for i in range(at, problem.first[j + 1]):
            orbit.place[i], orbit.side[i], orbit.turn[i] = memory.sliders[0, i], 0.0, 0


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

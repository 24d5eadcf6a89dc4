"""Newton's method for the state that returns, and its multipliers."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..general.problem import SECTION
from ..spectral_radius import spectral_radius
from .change import clear_counts
from .follow import FOLLOWED, follow_period
from .pattern import repair_pattern
from .problem import MOVED, OPEN, SMOOTH, put_loads
from .series import is_held, stop_exactly
from .tangent import begin_tangent

#: Periods of the load after which a motion may return, at most.
LONGEST = 256

#: States kept, one per period.
_KEPT = LONGEST + 1

#: Steps of Newton's method, at most.
_MOST_STEPS = 12

#: Change on return, over the size of the motion, that is rounding error, and that is accepted where it does
#: not fall any more: motions have some hundred steps.
_CONVERGED, _ACCEPTED = 1e-14, 1e-11

#: Pivots below this share of the first one belong to directions in which all states return.
_FREE = 1e-10

#: Share of the displacement under the load below which a motion is none: its rounding errors are those of the
#: load's forces, 1e-16 of that displacement in every step.
_NO_MOTION = 1e-4


class Memory(NamedTuple):
    """States at the section, and what Newton's method needs."""

    start: np.ndarray  # (size,)
    pattern: np.ndarray  # (2 N + S,) int: senses, open contacts, pieces
    end: np.ndarray  # (size,)
    end_pattern: np.ndarray  # (2 N + S,) int
    matrix: np.ndarray  # (size, size)
    square: np.ndarray  # (size, size) scratch
    right: np.ndarray  # (size,)
    places: np.ndarray  # (size,) int: columns of the pivots
    kept: np.ndarray  # (_KEPT, size)
    kept_patterns: np.ndarray  # (_KEPT, 2 N + S) int
    near: np.ndarray  # (_KEPT,) distance at which Newton's method is tried, per number of periods
    count: np.ndarray  # (1,) int: states kept


@entry
def make_memory(problem, size):
    """Allocate the memory of a cell; `size` is the number of coordinates of a state."""
    pattern = 2 * problem.law.size + problem.along.shape[0]
    return Memory(
        np.zeros(size), np.zeros(pattern, np.int64), np.zeros(size), np.zeros(pattern, np.int64),
        np.zeros((size, size)), np.zeros((size, size)), np.zeros(size), np.zeros(size, np.int64),
        np.zeros((_KEPT, size)), np.zeros((_KEPT, pattern), np.int64), np.zeros(_KEPT), np.zeros(1, np.int64),
    )  # fmt: skip


@kernel
def take_state(problem, motion, state, pattern):
    """Copy the state and the pattern of a motion."""
    modes, contacts = problem.squares.size, problem.law.size
    for i in range(modes):
        state[i], state[modes + i] = motion.q[i], motion.p[i]
    for j in range(contacts):
        if problem.place[j] >= 0:
            state[problem.place[j]] = motion.f[j]
        pattern[j], pattern[contacts + j] = motion.sense[j], motion.open[j]
    for s in range(motion.piece.size):
        pattern[2 * contacts + s] = motion.piece[s]


@kernel
def put_state(problem, motion, state, pattern):
    """Set the state and the pattern of a motion."""
    modes, contacts = problem.squares.size, problem.law.size
    for i in range(modes):
        motion.q[i], motion.p[i] = state[i], state[modes + i]
    for j in range(contacts):
        motion.f[j] = state[problem.place[j]] if problem.place[j] >= 0 else 0.0
        motion.sense[j], motion.open[j] = pattern[j], pattern[contacts + j]
    for s in range(motion.piece.size):
        motion.piece[s] = pattern[2 * contacts + s]


@kernel
def state_size(problem, row, state):
    """Size of a motion, the unit of `distance`."""
    modes, size = problem.squares.size, _NO_MOTION * row.size
    for i in range(modes):
        size = max(size, abs(state[i]), abs(state[modes + i]) / row.h)
    return size


@kernel
def distance(problem, row, state, other):
    """Largest difference of two states, as a displacement."""
    modes, off = problem.squares.size, 0.0
    for i in range(modes):
        off = max(off, abs(state[i] - other[i]), abs(state[modes + i] - other[modes + i]) / row.h)
    for j in range(problem.law.size):
        if problem.place[j] >= 0:
            place = problem.place[j]
            off = max(off, abs(state[place] - other[place]) / problem.spring[j])
    return off


@kernel
def _pivot(memory, done):
    """Bring the largest entry of the rest of the matrix to its first place; its modulus."""
    matrix, size = memory.matrix, memory.right.size
    row, column, largest = done, done, 0.0
    for a in range(done, size):
        for b in range(done, size):
            if abs(matrix[a, b]) > largest:
                row, column, largest = a, b, abs(matrix[a, b])
    for b in range(size):
        matrix[done, b], matrix[row, b] = matrix[row, b], matrix[done, b]
    memory.right[done], memory.right[row] = memory.right[row], memory.right[done]
    for a in range(size):
        matrix[a, done], matrix[a, column] = matrix[a, column], matrix[a, done]
    memory.places[done], memory.places[column] = memory.places[column], memory.places[done]
    return largest


@kernel
def solve(memory):
    """Solve the linear equations in `matrix` and `right`; directions without an equation do not change."""
    matrix, right, size = memory.matrix, memory.right, memory.right.size
    for a in range(size):
        memory.places[a] = a
    first, rank = 0.0, size
    for done in range(size):
        largest = _pivot(memory, done)
        first = max(first, largest)
        if largest <= _FREE * first:
            rank = done
            break
        for a in range(done + 1, size):
            share = matrix[a, done] / matrix[done, done]
            for b in range(done, size):
                matrix[a, b] -= share * matrix[done, b]
            right[a] -= share * right[done]
    for a in range(size - 1, -1, -1):
        if a >= rank:
            right[a] = 0.0
            continue
        for b in range(a + 1, size):
            right[a] -= matrix[a, b] * right[b]
        right[a] /= matrix[a, a]
    for a in range(size):
        memory.end[memory.places[a]] = right[a]
    for a in range(size):
        right[a] = memory.end[a]


@kernel
def begin_return(problem, row, cell, motion, memory):
    """Begin at the state in `memory`, with a pattern that suits it; False if there is none."""
    if row.intervals > 0:
        put_loads(row, SECTION, motion.drive)
    put_state(problem, motion, memory.start, memory.pattern)
    if not repair_pattern(problem, row, cell, motion):
        return False
    stop_exactly(problem, row, motion)
    take_state(problem, motion, memory.start, memory.pattern)
    clear_counts(motion)
    return True


@kernel
def go_round(problem, row, cell, motion, periods, derive):
    """Follow a motion for some periods of the load; a code of `cross`."""
    code = FOLLOWED
    for _ in range(periods):
        if code == FOLLOWED:
            code = follow_period(problem, row, cell, motion, derive)
    return code


@kernel
def rests(problem, motion, j):
    """Whether friction has held a contact all the time."""
    counts = motion.counts
    free = problem.law[j] == SMOOTH or counts[MOVED, j] != 0.0 or counts[OPEN, j] != 0.0
    return not free and is_held(problem, motion, j)


@kernel
def _put_place(problem, j, left, size):
    """Fill the derivatives of the place of a contact, or of its slider; return their sum of squares."""
    modes, place, square = problem.squares.size, problem.place[j], 0.0
    for a in range(size):
        left[a] = 0.0
    for i in range(modes):
        left[i] = problem.chi[j, i] * (problem.spring[j] if place >= 0 else 1.0)
    if place >= 0:
        left[place] = -1.0
    for a in range(size):
        square += left[a] * left[a]
    return square


@kernel
def keep_places(problem, motion, memory, size):
    """Let Newton's method keep the places of contacts that rest: no motion moves them.

    With the place l, l (I - J) = 0: what is added makes l dy = 0 and changes no other equation.
    """
    left = memory.end  # its state is in the equations already
    for j in range(problem.law.size):
        if rests(problem, motion, j):
            square = _put_place(problem, j, left, size)
            for a in range(size):
                for b in range(size):
                    memory.matrix[a, b] += left[a] * left[b] / square


@kernel
def _put_equations(problem, motion, memory):
    """Fill the equations (I - J) dy = phi(y) - y."""
    size = memory.right.size
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = (1.0 if a == b else 0.0) - motion.tangent[a, b]
        memory.right[a] = memory.end[a] - memory.start[a]
    for j in range(problem.law.size):
        place = problem.place[j]
        given = place >= 0 and (memory.pattern[j] != 0 or memory.pattern[problem.law.size + j] != 0)
        if given:
            for b in range(size):
                memory.matrix[place, b] = 1.0 if b == place else 0.0
            memory.right[place] = 0.0


@kernel
def find_orbit(problem, row, cell, motion, memory, periods):
    """Find the state that returns after some periods, from that in `memory`; whether it was found.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion : Motion; `tangent` and `counts` become those of the orbit
    memory : Memory; `start` and `pattern` become those of the orbit
    periods : number of periods of the load
    """
    last = np.inf
    for _ in range(_MOST_STEPS):
        if not begin_return(problem, row, cell, motion, memory):
            return False
        begin_tangent(problem, row, motion)
        if go_round(problem, row, cell, motion, periods, True) != FOLLOWED:
            return False
        take_state(problem, motion, memory.end, memory.end_pattern)
        size = state_size(problem, row, memory.start)
        off = distance(problem, row, memory.start, memory.end)
        if off <= _CONVERGED * size or (off <= _ACCEPTED * size and off > 0.25 * last):
            return True
        if off > size or off > 100.0 * last:
            return False
        last = off
        _put_equations(problem, motion, memory)
        keep_places(problem, motion, memory, memory.right.size)
        solve(memory)
        for a in range(memory.right.size):
            memory.start[a] += memory.right[a]
    return False


@kernel
def remove_rests(problem, motion, memory, size):
    """Take the multipliers of the places of contacts that rest from `matrix`.

    A place is a left eigenvector of the multiplier 1; a rank-one change takes it to 0 and leaves the others.
    """
    left = memory.right
    for j in range(problem.law.size):
        if not rests(problem, motion, j):
            continue
        square = _put_place(problem, j, left, size)
        for a in range(size):
            sum_ = 0.0
            for b in range(size):
                sum_ += memory.matrix[a, b] * left[b]
            for b in range(size):
                memory.matrix[a, b] -= sum_ * left[b] / square


@kernel
def multiplier(problem, motion, memory):
    """Largest modulus of the multipliers, without those of the places of contacts that rest."""
    size = motion.tangent.shape[0]
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = motion.tangent[a, b]
    remove_rests(problem, motion, memory, size)
    return spectral_radius(memory.matrix, size, memory.square, 0.0)

"""Derivatives of the motion by its state at the section.

The state has the modes, their velocities, and the places of the turns that sliders remember.  Forces are
continuous, and an event moves no derivative but those of the sliders: at a turn the velocity is zero, and
they follow the place of the turn.
"""

from ..compiler import kernel
from ..general.problem import INVERSE
from .problem import MOST_MEMORIES
from .step import end_term, put_term


@kernel
def memories(problem, motion):
    """Number of turns of the last period that sliders remember; -1 where there are too many.

    Elements that held at one turn follow each other.
    """
    now, count = motion.now, 0
    for j in range(problem.moved.size):
        for i in range(problem.first[j] + now.level[j], problem.first[j + 1]):
            if now.turn[i] != 0 and (i == problem.first[j] + now.level[j] or now.turn[i] != now.turn[i - 1]):
                count += 1
    return count if count <= MOST_MEMORIES else -1


@kernel
def begin_tangent(problem, motion):
    """Begin with the derivatives of the state by itself."""
    now, tangent, modes = motion.now, motion.tangent, problem.squares.size
    size = 2 * modes + memories(problem, motion)
    tangent.count[0] = size
    for i in range(modes):
        for c in range(size):
            tangent.q[i, c] = 1.0 if c == i else 0.0
            tangent.p[i, c] = 1.0 if c == modes + i else 0.0
    at = 2 * modes - 1
    for j in range(problem.moved.size):
        for c in range(size):
            tangent.pull[j, c] = 0.0
        for i in range(problem.first[j], problem.first[j + 1]):
            for c in range(size):
                tangent.slider[i, c] = 0.0
            if i < problem.first[j] + now.level[j] or now.turn[i] == 0:
                continue
            if i == problem.first[j] + now.level[j] or now.turn[i] != now.turn[i - 1]:
                at += 1
            tangent.slider[i, at] = 1.0
            tangent.pull[j, at] += problem.spring[i]


@kernel
def _put_column(problem, row, motion, c, count, length):
    """Fill the series of one column over the present step."""
    modes, column, tangent, chi = problem.squares.size, motion.column, motion.tangent, problem.chi
    scale, damped = length * length / (row.r * row.r), length / row.r
    for i in range(modes):
        column[0, i], column[1, i] = tangent.q[i, c], length * tangent.p[i, c]
    for k in range(count - 2):
        for i in range(modes):
            column[k + 2, i] = 0.0
        put_term(problem, column, k, scale, damped)
        for j in range(problem.moved.size):
            z = 0.0
            for i in range(modes):
                z += chi[j, i] * column[k, i]
            force = problem.left[problem.first[j] + j + motion.now.level[j]] * z
            if k == 0:
                force -= tangent.pull[j, c]
            end_term(problem, column, k, j, scale * force)
        for i in range(modes):
            column[k + 2, i] *= INVERSE[k]


@kernel
def advance_tangent(problem, row, motion, count, length, x):
    """Move the derivatives on by x of the present step."""
    tangent, column = motion.tangent, motion.column
    for c in range(tangent.count[0]):
        _put_column(problem, row, motion, c, count, length)
        for i in range(problem.squares.size):
            q, p = 0.0, 0.0
            for k in range(count - 1, -1, -1):
                p = p * x + q
                q = q * x + column[k, i]
            tangent.q[i, c], tangent.p[i, c] = q, p / length

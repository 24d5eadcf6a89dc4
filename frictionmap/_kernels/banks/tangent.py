"""Derivatives of the motion by its state at the section.

The state has the modes, their velocities, and the places of the turns that sliders remember.  Forces are
continuous, and an event moves no derivative but those of the sliders: at a turn the velocity is zero, and
they follow the place of the turn.
"""

from ..compiler import kernel
from ..compiler.vectors import LANES, filled, load, store
from ..general.problem import INVERSE
from .problem import MOST_MEMORIES


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
        for i in range(problem.first[j], problem.first[j + 1]):
            for c in range(size):
                tangent.slider[i, c] = 0.0
            if i < problem.first[j] + now.level[j] or now.turn[i] == 0:
                continue
            if i == problem.first[j] + now.level[j] or now.turn[i] != now.turn[i - 1]:
                at += 1
            tangent.slider[i, at] = 1.0


@kernel
def _put_pushes(problem, motion, k, first):
    """Put term k of the forces in the columns from `first` on."""
    tangent, modes = motion.tangent, problem.squares.size
    for j in range(problem.moved.size):
        at = problem.first[j] + j + motion.now.level[j]
        force = filled(0.0)
        for i in range(modes):
            share = problem.left[at] * problem.chi[j, i]
            force = force + share * load(motion.column, (k * modes + i) * LANES)
        if k == 0:
            force = force - load(tangent.pull, at * tangent.pull.shape[1] + first)
        store(force, motion.push, j * LANES)


@kernel
def _put_columns(problem, row, motion, first, count, length):
    """Fill the series of the columns from `first` on over the present step."""
    modes, column, tangent = problem.squares.size, motion.column, motion.tangent
    scale, damped, width = length * length / (row.r * row.r), length / row.r, motion.tangent.q.shape[1]
    for i in range(modes):
        store(load(tangent.q, i * width + first), column, i * LANES)
        store(length * load(tangent.p, i * width + first), column, (modes + i) * LANES)
    for k in range(count - 2):
        _put_pushes(problem, motion, k, first)
        here, next_ = k * modes, (k + 1) * modes
        for i in range(modes):
            total = (-scale * problem.squares[i]) * load(column, (here + i) * LANES)
            for j in range(problem.moved.size):
                total = total - (scale * problem.chi[j, i]) * load(motion.push, j * LANES)
            for n in range(0 if problem.coupled else i, modes if problem.coupled else i + 1):
                drag = damped * (k + 1.0) * problem.damping[i, n]
                total = total - drag * load(column, (next_ + n) * LANES)
            store(INVERSE[k] * total, column, (next_ + modes + i) * LANES)


@kernel
def advance_tangent(problem, row, motion, count, length, x):
    """Move the derivatives on by x of the present step."""
    tangent, column, modes = motion.tangent, motion.column, problem.squares.size
    width = tangent.q.shape[1]
    for first in range(0, tangent.count[0], LANES):
        _put_columns(problem, row, motion, first, count, length)
        for i in range(modes):
            q, p = filled(0.0), filled(0.0)
            for k in range(count - 1, -1, -1):
                p = p * x + q
                q = q * x + load(column, (k * modes + i) * LANES)
            store(q, tangent.q, i * width + first)
            store((1.0 / length) * p, tangent.p, i * width + first)

"""Whether a motion without a load has ended for all contacts, and places that are held.

In a phase whose contacts are open or held the structure is linear and symmetric: the energy E of its
vibration about its place of rest never grows, and a quantity that is linear in the state stays within
G sqrt(2 E) of its value there.  If all that would end the phase stays positive, nothing ever does.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..history.course import ASLEEP, AWAKE, ELSEWHERE
from .kept import sense_of
from .problem import RIGID, SMOOTH
from .series import dot, is_held, solve_held


class Bed(NamedTuple):
    """The structure in one phase, under no load; s is the state q, q', f, 1."""

    pattern: np.ndarray  # (N + S,) int: senses, and pieces of the springs
    vibration: np.ndarray  # (V, 2 m + N + 1) e = vibration s, with 2 E = |e|^2
    margins: np.ndarray  # (R, 2 m + N + 1) at the place of rest: what ends the phase where it is zero
    gains: np.ndarray  # (R,) G
    active: np.ndarray  # (1,) int: whether it is defined


@kernel
def _product(memory, rows, at):
    """Product of row `at` with the state."""
    motion, modes = memory.motion, memory.motion.q.size
    sum_ = rows[at, rows.shape[1] - 1]
    for i in range(modes):
        sum_ += rows[at, i] * motion.q[i] + rows[at, modes + i] * motion.p[i] / memory.length[0]
    for j in range(motion.f.size):
        sum_ += rows[at, 2 * modes + j] * motion.f[j]
    return sum_


@kernel
def sleep_of(memory, problem, cell, kept, bed):
    """Whether no contact ever moves, opens or closes again, and no spring passes a knot: see AWAKE."""
    motion, contacts = memory.motion, problem.law.size
    for j in range(contacts):
        if motion.sense[j] != 0 and problem.law[j] != SMOOTH:
            return AWAKE
    for j in range(contacts):
        if bed.pattern[j] != sense_of(motion, j):
            return ELSEWHERE
    for s in range(motion.piece.size):
        if bed.pattern[contacts + s] != motion.piece[s]:
            return ELSEWHERE
    if bed.active[0] == 0:
        return AWAKE
    square = 0.0
    for v in range(bed.vibration.shape[0]):
        part = _product(memory, bed.vibration, v)
        square += part * part
    size = math.sqrt(square)
    for a in range(bed.margins.shape[0]):
        if _product(memory, bed.margins, a) < size * bed.gains[a]:
            return AWAKE
    return ASLEEP


@kernel
def _wall(problem, memory, j, x, time):
    """Place and velocity of the wall of a contact at x of the present part."""
    place, rate = 0.0, 0.0
    for d in range(memory.walls.size):
        if memory.walls[d] != 0.0:
            for k in range(memory.terms[0] - 1, -1, -1):
                rate = rate * x + place
                place = place * x + memory.channels[d, k]
    return problem.moved[j] * place + memory.belt[j] * time, problem.moved[j] * rate + memory.row.belt[j]


@kernel
def note_places(problem, memory, x, time):
    """Note the places of rigid contacts that are held from now on, and were not before an event."""
    for j in range(problem.law.size):
        if problem.law[j] == RIGID and is_held(problem, memory.motion, j) and memory.before[j] != 0:
            place, _ = _wall(problem, memory, j, x, time)
            memory.places[j] = dot(problem.chi, j, memory.motion.q) - place


@kernel
def keep_places(problem, memory, x, time):
    """Take the rounding error of a step, which ends at x, from rigid contacts that are held."""
    motion, row = memory.motion, memory.row
    count, right = motion.held[problem.law.size], motion.terms.right
    for part in range(2 if count > 0 else 0):
        into = motion.q if part == 0 else motion.p
        for a in range(count):
            j = motion.held[a]
            place, rate = _wall(problem, memory, j, x, time)
            right[a] = dot(problem.chi, j, into) - (place + memory.places[j] if part == 0 else rate)
        solve_held(problem, motion, right)
        for a in range(count):
            for i in range(problem.squares.size):
                into[i] -= row.reaction[motion.held[a], i] * right[a]

"""The steady motions of the last cells of a row, which the next one begins from."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..extrapolation import CELLS, reaches, weight
from ..general.problem import SECTION
from ..phases.problem import FIRST, LAST
from .level import displacement, pass_thresholds
from .step import put_waves


class Trail(NamedTuple):
    """States at the section, latest first."""

    values: np.ndarray  # (CELLS, 2 m + E) q, p and the places of turns
    side: np.ndarray  # (E,) of all of them, see `State`
    turn: np.ndarray  # (E,) int: of the latest
    sense: np.ndarray  # (N,) int: of all of them
    beta: np.ndarray  # (CELLS,)
    count: np.ndarray  # (1,) int: how many there are


@entry
def make_trail(problem):
    """Allocate the memory of the last cells."""
    contacts, modes = problem.chi.shape
    many = problem.spring.size
    return Trail(
        np.zeros((CELLS, 2 * modes + many)), np.zeros(many), np.zeros(many, np.int64),
        np.zeros(contacts, np.int64), np.zeros(CELLS), np.zeros(1, np.int64),
    )  # fmt: skip


@kernel
def remember(state, beta, trail):
    """Keep the state of a steady motion, and those before it if they have the same senses and sides."""
    same, modes = True, state.q.size
    for i in range(state.side.size):
        same = same and state.side[i] == trail.side[i]
        trail.side[i], trail.turn[i] = state.side[i], state.turn[i]
    for j in range(state.sense.size):
        same = same and state.sense[j] == trail.sense[j]
        trail.sense[j] = state.sense[j]
    trail.count[0] = min(trail.count[0] + 1, CELLS) if same else 1
    for k in range(trail.count[0] - 1, 0, -1):
        trail.beta[k] = trail.beta[k - 1]
        for a in range(trail.values.shape[1]):
            trail.values[k, a] = trail.values[k - 1, a]
    trail.beta[0] = beta
    for i in range(modes):
        trail.values[0, i], trail.values[0, modes + i] = state.q[i], state.p[i]
    for i in range(state.place.size):
        trail.values[0, 2 * modes + i] = state.place[i]


@kernel
def _ahead(trail, a, beta, count):
    """Value a at the polynomial in beta through the last `count` cells."""
    if count == 1:
        return trail.values[0, a]
    total = 0.0
    for k in range(count):
        total += weight(trail.beta, count, k, beta) * trail.values[k, a]
    return total


@kernel
def begin_ahead(problem, row, cell, motion, beta, trail):
    """Begin a cell where the last ones point, or at the last one, with the levels of its friction."""
    now, modes = motion.now, problem.squares.size
    count = trail.count[0] if reaches(trail.beta, trail.count[0], beta) else 1
    for i in range(modes):
        now.q[i], now.p[i] = _ahead(trail, i, beta, count), _ahead(trail, modes + i, beta, count)
    for i in range(problem.spring.size):
        now.place[i] = _ahead(trail, 2 * modes + i, beta, count)
        now.side[i], now.turn[i] = trail.side[i], trail.turn[i]
    put_waves(row, SECTION, motion)
    for j in range(problem.moved.size):
        now.level[j], now.sense[j], now.lead[j] = 0, trail.sense[j], 0
        pass_thresholds(problem, cell, motion, j, displacement(problem, motion, j))
        motion.counts[LAST, j] = motion.counts[FIRST, j] = 0.0

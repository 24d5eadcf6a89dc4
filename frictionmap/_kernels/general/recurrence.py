"""Recurrence detection: the last states at the section, and whether the motion has returned to one."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..long_periods import LONGEST_RECURRENCE, RETURNED_AFTER_LONG
from .laws.speed import count_rows
from .problem import SIZE, padded
from .return_map import base_halves, copy_motion, largest_difference, steady_period

#: Returns one after the other that a long period is recognised by.
_IN_A_ROW = 4

#: States that are kept, one per return to the section.
_KEPT = LONGEST_RECURRENCE + _IN_A_ROW

#: Largest distance from an earlier state at which Newton's method is tried, where the start matters, and how
#: many states ago that is at most.
_NEAR = 1e-2
_SOON = 32


class Ring(NamedTuple):
    """The last states at the section."""

    states: np.ndarray  # (_KEPT, 3, ...)
    senses: np.ndarray  # (_KEPT, N)
    count: np.ndarray  # (1,) states kept so far
    friction: np.ndarray  # (4, N) friction of contacts while they are held, see `creep`
    orbit: np.ndarray  # (3, ...) state of a steady state that the motion may go to
    orbit_senses: np.ndarray  # (N,) the pattern there
    orbit_counts: np.ndarray  # counters of it


@entry
def make_ring(problem):
    """Allocate the kept states."""
    contacts, modes = problem.chi.shape
    width = padded(max(modes, contacts))
    return Ring(
        np.zeros((_KEPT, 3, width)), np.zeros((_KEPT, contacts), np.int64), np.zeros(1, np.int64),
        np.zeros((4, contacts)), np.zeros((3, width)), np.zeros(contacts, np.int64),
        np.zeros((count_rows(problem), contacts)),
    )  # fmt: skip


@kernel
def keep(memory, ring):
    """Keep the state at the section."""
    slot = ring.count[0] % _KEPT
    copy_motion(memory.start, memory.senses, ring.states[slot], ring.senses[slot])
    ring.count[0] += 1


@kernel
def go_back(memory, ring, ago):
    """Go back to the state kept `ago` states before the last one, 0..LONGEST_RECURRENCE."""
    slot = (ring.count[0] - 1 - ago) % _KEPT
    copy_motion(ring.states[slot], ring.senses[slot], memory.start, memory.senses)


@kernel
def go_back_cycles(problem, memory, ring, cycles):
    """Go back by some periods of the load, or to the first state kept."""
    go_back(memory, ring, min(2 * cycles // base_halves(problem), ring.count[0] - 1))


@kernel
def distance_back(row, memory, ring, ago, back):
    """Distance of the state `ago` before the last one kept from that `back` before it, over its size."""
    now, then = (ring.count[0] - 1 - ago) % _KEPT, (ring.count[0] - 1 - ago - back) % _KEPT
    for j in range(memory.senses.size):
        if ring.senses[now, j] != ring.senses[then, j]:
            return math.inf
    size = row.numbers[SIZE]
    for part in range(2):
        for i in range(memory.start.shape[1]):
            size = max(size, abs(ring.states[now, part, i]))
    return largest_difference(row, ring.senses[now], ring.states[now], ring.states[then]) / size


@kernel
def find_recurrence(row, memory, ring, base):
    """Half periods since the earlier state that the present one nearly equals; 0 without one."""
    most = min(ring.count[0] - 1, _SOON)
    for back in range(1, most + 1):
        if distance_back(row, memory, ring, 0, back) < _NEAR:
            return back * base
    return 0


@kernel
def _returns_in_a_row(row, memory, ring, back):
    """Whether each of the last states was there `back` states before, to RETURNED_AFTER_LONG."""
    farthest = 0.0
    for ago in range(_IN_A_ROW):
        farthest = max(farthest, distance_back(row, memory, ring, ago, back))
    return farthest <= RETURNED_AFTER_LONG


@kernel
def find_long_recurrence(row, memory, ring, base):
    """Half periods, up to LONGEST_RECURRENCE, after which it has returned several times in a row; else 0."""
    most = min(ring.count[0] - _IN_A_ROW, LONGEST_RECURRENCE // base)
    for back in range(1, most + 1):
        halves = back * base
        if 2 * steady_period(halves) <= LONGEST_RECURRENCE and _returns_in_a_row(row, memory, ring, back):
            return halves
    return 0


@kernel
def distance_from_last(row, memory, ring):
    """Largest difference of the state in `memory.start` from the last one kept."""
    return largest_difference(row, memory.senses, ring.states[(ring.count[0] - 1) % _KEPT], memory.start)


@kernel
def put_orbit(memory, ring):
    """Keep the steady state in `memory.start`, and its counters."""
    copy_motion(memory.start, memory.senses, ring.orbit, ring.orbit_senses)
    for j in range(memory.senses.size):
        for part in range(memory.counts.shape[0]):
            ring.orbit_counts[part, j] = memory.counts[part, j]


@kernel
def take_orbit(memory, ring):
    """Go to the steady state that was kept, without its counters."""
    copy_motion(ring.orbit, ring.orbit_senses, memory.start, memory.senses)


@kernel
def distance_from_orbit(row, memory, ring):
    """Largest difference of the state in `memory.start` from the steady state kept."""
    return largest_difference(row, memory.senses, ring.orbit, memory.start)

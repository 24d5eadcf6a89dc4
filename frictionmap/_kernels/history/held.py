"""What is held stays where it is.

A constraint holds the acceleration of a contact, so that rounding errors would give it a velocity and carry
it away: by 1e-10 of the motion in 10^5 intervals.  After every step the error is taken from the state, in the
direction in which the force of the contact acts.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.vectors import LANES, load, store, total
from ..general.laws.kinds import is_constrained
from ..general.problem import LOAD_TERMS, H, P, Q, padded
from ..general.series import solve_held

#: Sets of held contacts whose grips are kept, at most.
_MOST_SETS = 64


class Places(NamedTuple):
    """Where contacts are held; M is m, filled up to vectors."""

    places: np.ndarray  # (N,) displacements in held contacts relative to their walls, also to belts
    grips: np.ndarray  # (S N, M) of S sets: change of the modes that moves one held contact by 1
    known: np.ndarray  # (S,) int: which set is there, plus 1; 0: none


@entry
def make_places(problem):
    """Allocate them."""
    contacts, modes = problem.chi.shape
    sets = min(1 << min(contacts, 6), _MOST_SETS)
    return Places(np.zeros(contacts), np.zeros((sets * contacts, padded(modes))), np.zeros(sets, np.int64))


@inner_kernel
def _wall(problem, row, j, x):
    """Place and velocity of the wall of a contact by the channels, at x in the interval."""
    place, rate = 0.0, 0.0
    for d in range(problem.base.shape[1]):
        if problem.base[j, d] != 0.0:
            value, slope = 0.0, 0.0
            for k in range(row.intervals[LOAD_TERMS] - 1, -1, -1):
                slope = slope * x + value
                value = value * x + row.loads[d, k]
            place += problem.base[j, d] * value
            rate += problem.base[j, d] * slope
    return place, rate


@kernel
def note_places(problem, row, motion, before, x, time, places):
    """Note the places of contacts that are held from now on.

    Parameters
    ----------
    problem, row, motion : Problem, Row, Motion
    before : (N,) senses before; those of contacts that were held are 0
    x, time : place in the interval, and time
    places : Places
    """
    for j in range(motion.sense.size):
        if before[j] != 0 and is_constrained(problem, motion, j):
            place, _ = _wall(problem, row, j, x)
            places.places[j] = -(place + problem.belt[j] * time)
            for m in range(problem.squares.size):
                places.places[j] += problem.chi[j, m] * motion.state[Q, m]


@kernel
def _fill_grips(row, motion, grips, first):
    """Fill the grips of the present set from row `first` on; the length of intervals does not matter."""
    contacts = motion.sense.size
    count, right = motion.held[contacts], motion.solve[contacts]
    for a in range(count):
        for b in range(count):
            right[b] = 1.0 if a == b else 0.0
        solve_held(motion, right)
        for m in range(row.stiffness.size):
            sum_ = 0.0
            for b in range(count):
                sum_ += row.reaction[motion.held[b], m] * right[b]
            grips[first + a, m] = sum_


@inner_kernel
def _grips(row, motion, places):
    """First row of the grips of the present set."""
    contacts = motion.sense.size
    held = 0
    for a in range(motion.held[contacts]):
        held += 1 << motion.held[a]
    slot = held % places.known.size
    if places.known[slot] != held + 1:
        _fill_grips(row, motion, places.grips, slot * contacts)
        places.known[slot] = held + 1
    return slot * contacts


@kernel
def keep_places(problem, row, motion, x, time, places):
    """Take the rounding error of a step from held contacts.

    Parameters
    ----------
    problem, row, motion, x, time, places : see `note_places`; x and time are those of the end of the step
    """
    contacts = motion.sense.size
    if motion.held[contacts] == 0:
        return
    first = _grips(row, motion, places)
    width, line = row.chi.shape[1], motion.state.shape[1]
    errors = motion.solve[contacts]
    for part in (Q, P):
        for a in range(motion.held[contacts]):
            j = motion.held[a]
            wall, rate = _wall(problem, row, j, x)
            if part == Q:
                errors[a] = -(wall + problem.belt[j] * time + places.places[j])
            else:
                errors[a] = -(rate + row.numbers[H] * problem.belt[j])
            for m in range(0, width, LANES):
                errors[a] += total(load(row.chi, j * width + m) * load(motion.state, part * line + m))
        for a in range(motion.held[contacts]):
            for m in range(0, width, LANES):
                at = part * line + m
                grip = load(places.grips, (first + a) * width + m)
                store(load(motion.state, at) - grip * errors[a], motion.state, at)

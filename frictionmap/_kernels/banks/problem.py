"""A structure whose contacts are banks of elastic elements, one cell, and the memory of a motion.

    r^2 q'' + r C q' + w^2 q + chi^T f = push(tau),   z = chi q - moved u(tau)

q are modes of unit modal mass.  An element i of a bank has a spring k_i and slips where its elongation
reaches u_i.  The elements of a contact are in the order of u_i, in which they slip after every turn: with the
first j of them at their limits the force is f = s H_j + T_j z - G_j, where H_j sums k_i u_i up to j, and T_j
and G_j sum k_i and k_i y_i beyond; y_i is the place of a slider.  A contact is at one of n + 1 levels j.

A slider was last at its limit at a turn: y_i = z_t - s_t u_i with the place and the sense of that turn.  With
sense s it slips from z_t + (s - s_t) u_i on: elements that were at their limits together are so again at
exactly the same place.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import entry
from ..compiler.vectors import LANES
from ..general.problem import LONG, WIDTH, padded

#: Memories of turns at the section that are unknowns of Newton's method, at most.
MOST_MEMORIES = 48


class Problem(NamedTuple):
    """A system of m modes and N contacts with E elements in all."""

    squares: np.ndarray  # (m,) w^2
    damping: np.ndarray  # (m, m)
    coupled: bool  # whether the damping couples modes
    chi: np.ndarray  # (N, m)
    moved: np.ndarray  # (N,) 1 where the wall moves with the base
    first: np.ndarray  # (N + 1,) int: first element of each contact, and their number
    spring: np.ndarray  # (E,) k
    left: np.ndarray  # (E + N,) T_j, from first[j] + j on for contact j
    observed: np.ndarray  # (R, m) further displacements whose extremes are wanted


class Row(NamedTuple):
    """The constants of one r; H harmonics."""

    r: float
    highest: float  # order
    damping: float  # norm of the damping
    square: float  # largest w^2
    size: float  # displacement that the load can be expected to cause
    odd: bool  # whether all orders are odd, so that half a period mirrors a steady motion
    orders: np.ndarray  # (H,)
    phasors: np.ndarray  # (2, H, m + 1) cos and sin parts of the load on the modes, and of the base motion
    softness: np.ndarray  # (N,) sum of chi^2/w^2
    weight: np.ndarray  # (N,) sum of chi^2


class Cell(NamedTuple):
    """Friction of one cell."""

    limit: np.ndarray  # (E,) u
    slid: np.ndarray  # (E + N,) H_j, from first[j] + j on


class State(NamedTuple):
    """A motion at one time."""

    q: np.ndarray  # (m,)
    p: np.ndarray  # (m,) q'
    place: np.ndarray  # (E,) z_t
    side: np.ndarray  # (E,) s_t; 0: y is `place`
    turn: np.ndarray  # (E,) int: number of that turn in this period, from 1; 0: before
    level: np.ndarray  # (N,) int: elements at their limits
    sense: np.ndarray  # (N,) int: 1 or -1
    lead: np.ndarray  # (N,) int: 1 where z' begins at 0


class Tangent(NamedTuple):
    """Derivatives of a motion by C coordinates at the section."""

    q: np.ndarray  # (m, C)
    p: np.ndarray  # (m, C)
    slider: np.ndarray  # (E, C) of y
    pull: np.ndarray  # (E + N, C) of G
    count: np.ndarray  # (1,) int: coordinates; 0 where derivatives are not carried


class Record(NamedTuple):
    """What is kept of a steady motion; nothing where `active` is 0."""

    active: np.ndarray  # (1,) int
    low: np.ndarray  # (R + N,) of the rows observed, and z
    high: np.ndarray
    work: np.ndarray  # (N,)
    distance: np.ndarray  # (N,) of the slider of the first element
    count: np.ndarray  # (1,) int: steps
    steps: np.ndarray  # (steps, LONG, m + N) terms of modes and friction
    times: np.ndarray  # (steps, 3) phase, length of the series, part of it
    patterns: np.ndarray  # (steps, 2 N) int: levels and senses


class Motion(NamedTuple):
    """A motion and its memory."""

    now: State
    pull: np.ndarray  # (E + N,) G_j, from first[j] + j on, of the levels that the contact may come to
    turns: np.ndarray  # (1,) int: turns so far in this period
    most: np.ndarray  # (2, N) int: highest level in this period with sense -1, and with 1
    range: np.ndarray  # (2, N) lowest and highest z at turns and at the section, in this period
    rate: np.ndarray  # (m,) accelerations
    waves: np.ndarray  # (2, H) cosines and sines of the load
    moves: np.ndarray  # (LONG, m)
    loads: np.ndarray  # (LONG, m + 1)
    z: np.ndarray  # (N, WIDTH)
    force: np.ndarray  # (N,) a term of the forces
    watch: np.ndarray  # (3, WIDTH)
    column: np.ndarray  # (LONG, m, LANES) derivatives by some coordinates
    push: np.ndarray  # (N, LANES) a term of the forces in them
    tangent: Tangent
    counts: np.ndarray  # (COUNT_ROWS, N)
    record: Record


@entry
def make_state(problem):
    """Allocate a state."""
    contacts, modes = problem.chi.shape
    many = problem.spring.size
    return State(
        np.zeros(modes), np.zeros(modes), np.zeros(many), np.zeros(many), np.zeros(many, np.int64),
        np.zeros(contacts, np.int64), np.ones(contacts, np.int64), np.zeros(contacts, np.int64),
    )  # fmt: skip


@entry
def make_motion(problem, harmonics, rows, steps):
    """Allocate a motion, whose record keeps this many steps; `rows` counters per contact."""
    contacts, modes = problem.chi.shape
    many, size = problem.spring.size, padded(2 * modes + MOST_MEMORIES)
    wide = problem.observed.shape[0] + contacts
    tangent = Tangent(
        np.zeros((modes, size)), np.zeros((modes, size)), np.zeros((many, size)),
        np.zeros((many + contacts, size)), np.zeros(1, np.int64),
    )  # fmt: skip
    record = Record(
        np.zeros(1, np.int64), np.zeros(wide), np.zeros(wide), np.zeros(contacts), np.zeros(contacts),
        np.zeros(1, np.int64), np.zeros((steps, LONG, modes + contacts)), np.zeros((steps, 3)),
        np.zeros((steps, 2 * contacts), np.int64),
    )  # fmt: skip
    return Motion(
        make_state(problem), np.zeros(many + contacts), np.zeros(1, np.int64),
        np.zeros((2, contacts), np.int64),
        np.zeros((2, contacts)), np.zeros(modes), np.zeros((2, harmonics)), np.zeros((LONG, modes)),
        np.zeros((LONG, modes + 1)), np.zeros((contacts, WIDTH)), np.zeros(contacts), np.zeros((3, WIDTH)),
        np.zeros((LONG, modes, LANES)), np.zeros((contacts, LANES)), tangent, np.zeros((rows, contacts)),
        record,
    )  # fmt: skip

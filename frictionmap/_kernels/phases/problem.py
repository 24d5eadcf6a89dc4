"""A system, the constants of one r, the friction of one cell, and the memory of a motion.

    r^2 q'' + r C q' + w^2 q + chi^T f + normal^T (N - max(0, N0)) + along^T F = push(tau)
    N = max(0, N0 + kn normal q),   |f| <= limit + lift normal q,   F piecewise linear over along q

q are modes of unit modal mass.  Time inside a step is x = (tau - tau_0)/h in [0, 1]; velocities are
p = dq/dx = h q', and loads and forces are multiplied by h^2/r^2.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..general.problem import LONG, SECTION, WIDTH

#: Laws of contacts: a rigid slider, one behind a spring, and none: normal force alone.
RIGID, ELASTIC, SMOOTH = 0, 1, 2

#: Columns of `Motion.lead`: quantities watched in a contact.
NORMAL, UP, DOWN = 0, 1, 2

#: Rows of `Motion.counts`, one number per contact.
STOPS, TURNS, SLIPS, REVERSALS, LIFTOFFS, STUCK, OPEN, MOVED, LAST, FIRST = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
COUNT_ROWS = 10

#: Groups of rows of `Motion.series`, N each: displacement and velocity in the contacts, friction, normal
#: displacement d.x; then the displacements of the springs, the rows observed, and scratch.
Z, W, F, D = 0, 1, 2, 3


#: Phases that have tables at most, and bytes of all tables.  Where fewer than _FEWEST fit, or a load has more
#: harmonics, every step is expanded on its own.
_MOST_PHASES, _FEWEST = 48, 6
_BYTES = 2**24
_MOST_HARMONICS = 3


class Problem(NamedTuple):
    """A system of m modes, N contacts and S springs of K knots at most."""

    squares: np.ndarray  # (m,) w^2
    damping: np.ndarray  # (m, m)
    chi: np.ndarray  # (N, m) displacement in the contact per mode
    normal: np.ndarray  # (N, m) d.x per mode
    along: np.ndarray  # (S, m) displacement of the spring per mode
    law: np.ndarray  # (N,) int: RIGID, ELASTIC or SMOOTH
    place: np.ndarray  # (N,) int: where the force of an elastic contact is in a state; else -1
    presses: np.ndarray  # (N,) bool: whether the normal force moves
    pressed: np.ndarray  # (N,) kn; 0 where the normal force is constant
    lift: np.ndarray  # (N,) phi kn
    spring: np.ndarray  # (N,) kt; 0: rigid
    moved: np.ndarray  # (N,) 1 where the wall moves with the base
    knots: np.ndarray  # (S, K) displacements, ascending
    forces: np.ndarray  # (S, K) forces there
    slopes: np.ndarray  # (S, K + 1)
    knot_count: np.ndarray  # (S,) int
    observed: np.ndarray  # (R, m) further displacements whose extremes are wanted
    ties: np.ndarray  # (N, N) bool: row of an elastic contact, the rigid ones that keep its ends at rest


class Row(NamedTuple):
    """The constants of one r, in units of the step; H harmonics."""

    h: float
    r: float
    intervals: int  # steps of a period of the load, from the section on
    size: float  # displacement that the load can be expected to cause
    stiffness: np.ndarray  # (m,)
    damping: np.ndarray  # (m, m)
    reaction: np.ndarray  # (N, m) acceleration per friction force
    push: np.ndarray  # (N, m) acceleration per normal force
    pull: np.ndarray  # (S, m) acceleration per force of a spring
    belt: np.ndarray  # (N,) velocity of the wall
    orders: np.ndarray  # (H,)
    growth: np.ndarray  # (H, LONG) (n h)^k/k!
    phasors: np.ndarray  # (2, H, m + 1) cos and sin parts of the load, and of the base motion
    loads: np.ndarray  # (intervals, LONG, m + 1) series of the load in every interval


class Cell(NamedTuple):
    """Friction and preload of one cell."""

    limit: np.ndarray  # (N,) kinetic friction where d.x = 0
    static: np.ndarray  # (N,) static over kinetic friction
    preload: np.ndarray  # (N,) N0
    constant: np.ndarray  # (m,) acceleration under constant loads


class Terms(NamedTuple):
    """Taylor terms of a step."""

    moves: np.ndarray  # (LONG, m)
    force: np.ndarray  # (LONG, N) friction
    press: np.ndarray  # (LONG, N) d.x
    right: np.ndarray  # (N,) scratch


class Record(NamedTuple):
    """What is kept of a steady motion; nothing where `active` is 0."""

    active: np.ndarray  # (1,) int
    low: np.ndarray  # (R + 2 N + S,) of the rows observed, z, N, displacements of springs
    high: np.ndarray
    work: np.ndarray  # (N,) of friction
    belt_work: np.ndarray  # (N,) of the wall
    distance: np.ndarray  # (N,)
    spring_force: np.ndarray  # (S,) largest modulus
    count: np.ndarray  # (1,) int: steps
    steps: np.ndarray  # (steps, LONG + 1, m + N or more) terms of modes and friction; last row: tau, length
    patterns: np.ndarray  # (steps, 2 N + S) int


class Tables(NamedTuple):
    """Tables of P phases, U units and R rows: velocities, friction, d.x, springs, modes and their rates."""

    keys: np.ndarray  # (P,) int: the phase; -1: none
    columns: np.ndarray  # (P U R, WIDTH) series
    controls: np.ndarray  # (P U (3 N + 2 S), WIDTH) control points of what is watched
    bounds: np.ndarray  # (P U (3 N + 2 S),) bounds on their errors
    onward: np.ndarray  # (P, size, U) state at the end of a step
    units: np.ndarray  # (U,)
    parts: np.ndarray  # (2, size, size) derivatives within a step; scratch
    last: np.ndarray  # (2,) int: the phase met last, and how many have tables
    zero: Cell  # a cell without friction and preload


class Motion(NamedTuple):
    """A motion and its memory."""

    q: np.ndarray  # (m,)
    p: np.ndarray  # (m,)
    f: np.ndarray  # (N,) friction of elastic contacts
    sense: np.ndarray  # (N,) int: 1, -1, or 0 where it is held or open
    open: np.ndarray  # (N,) int
    piece: np.ndarray  # (S,) int
    lead: np.ndarray  # (N, 3) int: zeros at the beginning of the series watched that are no events
    lead_spring: np.ndarray  # (S, 2) int
    terms: Terms
    column: Terms
    drive: np.ndarray  # (LONG, m + 1)
    held: np.ndarray  # (N + 1,) int: rigid contacts held; the last is their number
    factor: np.ndarray  # (N, N) of their mobility
    series: np.ndarray  # rows, see Z
    tangent: np.ndarray  # (size, size)
    scratch: np.ndarray  # (6, size + m + N)
    trial: np.ndarray  # (2, N) int
    counts: np.ndarray  # (COUNT_ROWS, N)
    crossings: np.ndarray  # (S,)
    record: Record
    tables: Tables
    idle: np.ndarray  # (N,) bool: elastic contacts whose ends rigid ones keep at rest


@kernel
def observed_row(problem):
    """Row of `Motion.series` at which the displacements of the springs begin; then the rows observed."""
    return 4 * problem.spring.size


@kernel
def watch_row(problem):
    """Row of `Motion.series` for the quantity watched; the next one is scratch."""
    return observed_row(problem) + problem.along.shape[0] + problem.observed.shape[0]


@entry
def make_terms(modes, contacts):
    """Allocate Taylor terms."""
    return Terms(
        np.zeros((LONG, modes)), np.zeros((LONG, contacts)), np.zeros((LONG, contacts)), np.zeros(contacts)
    )


@entry
def make_record(problem, steps):
    """Allocate a record of extremes, and of this many steps."""
    contacts, modes = problem.chi.shape
    springs, rows = problem.along.shape[0], problem.observed.shape[0]
    many = rows + 2 * contacts + springs
    return Record(
        np.zeros(1, np.int64), np.zeros(many), np.zeros(many), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros(springs), np.zeros(1, np.int64),
        np.zeros((steps, LONG + 1, max(modes + contacts, 2))),
        np.zeros((steps, 2 * contacts + springs), np.int64),
    )  # fmt: skip


@kernel
def unit_count(problem, row, size):
    """Number of units of a step."""
    return size + problem.squares.size + 2 * row.orders.size + 1


@kernel
def row_count(problem):
    """Number of rows of a unit."""
    return 3 * problem.law.size + problem.along.shape[0] + 2 * problem.squares.size


@entry
def make_tables(problem, row, size):
    """Allocate tables; of no phase where they are not used."""
    contacts, springs, modes = problem.law.size, problem.along.shape[0], problem.squares.size
    units, rows = unit_count(problem, row, size), row_count(problem)
    slots = 3 * contacts + 2 * springs
    phases = min(_MOST_PHASES, _BYTES // (8 * units * (rows + slots) * WIDTH))
    usable = phases >= _FEWEST and row.orders.size <= _MOST_HARMONICS
    for j in range(contacts):
        usable = usable and problem.moved[j] == 0.0
    if not usable:
        phases = 0
    return Tables(
        np.full(phases, -1), np.zeros((phases * units * rows, WIDTH)),
        np.zeros((phases * units * slots, WIDTH)), np.zeros(phases * units * slots),
        np.zeros((phases, size, units)), np.zeros(units), np.zeros((2, size, size)), np.zeros(2, np.int64),
        Cell(np.zeros(contacts), np.ones(contacts), np.zeros(contacts), np.zeros(modes)),
    )  # fmt: skip


@entry
def make_motion(problem, row, steps):
    """Allocate a motion, whose record keeps this many steps."""
    contacts, modes = problem.chi.shape
    springs = problem.along.shape[0]
    size = 2 * modes
    for j in range(contacts):
        size += problem.place[j] >= 0
    return Motion(
        np.zeros(modes), np.zeros(modes), np.zeros(contacts), np.zeros(contacts, np.int64),
        np.zeros(contacts, np.int64), np.zeros(springs, np.int64), np.zeros((contacts, 3), np.int64),
        np.zeros((springs, 2), np.int64), make_terms(modes, contacts), make_terms(modes, contacts),
        np.zeros((LONG, modes + 1)), np.zeros(contacts + 1, np.int64), np.zeros((contacts, contacts)),
        np.zeros((4 * contacts + springs + problem.observed.shape[0] + 2, WIDTH)),
        np.zeros((size, size)), np.zeros((6, size + modes + contacts)), np.zeros((2, contacts), np.int64),
        np.zeros((COUNT_ROWS, contacts)), np.zeros(springs), make_record(problem, steps),
        make_tables(problem, row, size), np.zeros(contacts, np.bool_),
    )  # fmt: skip


@kernel
def put_growth(row, n, cosine, sine, drive):
    """Add a harmonic of the load, by the cosine and the sine of its phase at the beginning of a step."""
    for k in range(LONG):
        c, s = row.growth[n, k] * cosine, row.growth[n, k] * sine
        for i in range(drive.shape[1]):
            drive[k, i] += row.phasors[0, n, i] * c + row.phasors[1, n, i] * s
        cosine, sine = -sine, cosine


@kernel
def put_loads(row, tau, drive):
    """Fill the series of the load, and of the base motion, in the step that begins at the phase tau."""
    for k in range(LONG):
        for i in range(drive.shape[1]):
            drive[k, i] = 0.0
    for n in range(row.orders.size):
        angle = row.orders[n] * tau
        put_growth(row, n, np.cos(angle), np.sin(angle), drive)


@entry
def make_row(problem, r, h, intervals, belt, orders, phasors):
    """The constants of one r.

    Parameters
    ----------
    problem : Problem
    r : frequency ratio
    h, intervals : length of a step, and steps of a period; no intervals without a load
    belt : (N,) velocity of the walls over tau
    orders, phasors : (H,), (2, H, m + 1) cos and sin parts of the load on the modes, and of the base motion
    """
    modes = problem.squares.size
    scale = h * h / (r * r)
    scaled = np.zeros(phasors.shape)
    size = 0.0
    for i in range(modes):
        load = 0.0
        for n in range(orders.size):
            load += abs(phasors[0, n, i]) + abs(phasors[1, n, i])
            scaled[0, n, i] = scale * phasors[0, n, i]
            scaled[1, n, i] = scale * phasors[1, n, i]
        size = max(size, load / (abs(problem.squares[i]) + r * r))
    for n in range(orders.size):
        scaled[0, n, modes] = phasors[0, n, modes]
        scaled[1, n, modes] = phasors[1, n, modes]
    growth = np.zeros((orders.size, LONG))
    for n in range(orders.size):
        size_of_term = 1.0
        for k in range(LONG):
            growth[n, k] = size_of_term
            size_of_term *= orders[n] * h / (k + 1.0)
    row = Row(
        h, r, intervals, size if size > 0.0 else 1.0, scale * problem.squares, h / r * problem.damping,
        scale * problem.chi, scale * problem.normal, scale * problem.along, h * belt, orders, growth, scaled,
        np.zeros((intervals, LONG, modes + 1)),
    )  # fmt: skip
    for k in range(intervals):
        put_loads(row, SECTION + k * h, row.loads[k])
    return row

"""A structure with its contacts and its load, as arrays, and the memory that a motion is followed in.

    r^2 q'' + r C q' + w^2 q = push L(tau) - chi^T f,   z = chi q - base L(tau),   |f| <= beta nu(tau)

q are the modes of the structure with all contacts free, of unit modal mass.  L(tau) are the *channels*: the
functions of time that drive anything, each a sum of harmonics.  A channel can push modes, move the wall of a
contact, or vary its normal load: nu = 1 + normal L(tau).

Time inside a step is x = (tau - tau_0)/h in [0, 1], and velocities are p = dq/dx = h q'.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..compiler.vectors import LANES, filled, load, store

#: Largest angle of the fastest part of the motion in one interval of the load [rad], a third of a turn ...
TURN = 2.1

#: ... for which series of forces with this many terms are exact to rounding: 2.1^24/24! = 9e-17.
#: Displacements have two more, because a force is their second derivative.
TERMS = 24
LONG = TERMS + 2

#: 1/((k+1)(k+2)): a term of a displacement per term of its acceleration.
INVERSE = np.array([1.0 / ((k + 1.0) * (k + 2.0)) for k in range(TERMS)])

#: Numbers kept per series: a whole number of vectors.
WIDTH = 32

#: k + 1: factors of a derivative.
NEXT = np.arange(1.0, WIDTH + 1.0)

#: Phase of the load at which states are compared: events gather at the extremes of the load, away from here.
SECTION = 0.37

#: Places in `Row.numbers`: length h of the intervals; r; displacement of the modes that the load can cause.
H, R, SIZE = 0, 1, 2

#: Rows of a state: the modes q, their velocities p, and the forces f of elastic contacts.
Q, P, F = 0, 1, 2

#: Intervals of a period whose load is kept, and patterns whose derivatives are.
_KEPT_INTERVALS = 512
_KEPT_PATTERNS = 64


class Problem(NamedTuple):
    """A system over r; m modes, N contacts, D channels, H harmonics."""

    squares: np.ndarray  # (m,) w^2
    damping: np.ndarray  # (m, m) C in modal coordinates
    coupled: bool  # whether C has entries outside its diagonal
    chi: np.ndarray  # (N, m) displacement in the contact per mode
    push: np.ndarray  # (m, D) load on the modes per channel
    base: np.ndarray  # (N, D) displacement of the wall per channel
    normal: np.ndarray  # (N, D) variation of the normal load per channel
    spring: np.ndarray  # (N,) contact stiffness; 0: rigid
    belt: np.ndarray  # (N,) velocity of the wall, over tau
    ties: np.ndarray  # (N, N) bool: row of a spring, the rigid contacts that keep both its ends at rest
    orders: np.ndarray  # (H,) orders n of the harmonics
    r: np.ndarray  # (n_r,)
    phasors: np.ndarray  # (n_r, 2, D, H) cos and sin parts of the channels
    rates: np.ndarray  # (n_r,) bound on the rate of the fastest part of the motion
    sizes: np.ndarray  # (n_r,) displacement of the modes that a load at this r can be expected to cause
    symmetric: bool  # L(tau + pi) = -L(tau), nothing else breaks the mirror symmetry


class Parts(NamedTuple):
    """Parts of the motion in an interval, see `glide`; P patterns, `size` coordinates of a state.

    Units are these coordinates, then the friction forces of the contacts.
    """

    controls: np.ndarray  # (P N units, WIDTH) control points of the quantity watched in a contact, per unit
    bounds: np.ndarray  # (P N units,) bounds on their error
    ends: np.ndarray  # (P N, S) state at the end by the friction force of a contact
    known: np.ndarray  # (P,) int: which pattern is there
    load_controls: np.ndarray  # (P 2 K N, WIDTH) the same of the load
    load_bounds: np.ndarray  # (P 2 K N,)
    load_ends: np.ndarray  # (P 2 K, S)
    loads_known: np.ndarray  # (P 2 K,) int: which pattern is there
    unit: np.ndarray  # (N,) friction; scratch
    kept: np.ndarray  # (3, ...) a state; scratch


class Row(NamedTuple):
    """The constants of one r, in units of the interval; M is m, filled up with zeros to whole vectors.

    A period of the load has 2 K intervals of the length h, from the section on.  The derivatives of a motion
    by its state at the beginning of an interval are the same for all intervals with one pattern; they are
    filled where a motion has it for the first time.
    """

    numbers: np.ndarray  # (3,) see H
    intervals: np.ndarray  # (1,) int: K
    stiffness: np.ndarray  # (m,) h^2 w^2/r^2
    damping: np.ndarray  # (m, m) h C/r
    velocity_term: np.ndarray  # (TERMS, M) what term k + 1 of a mode adds to term k + 2, by its own damping
    place_term: np.ndarray  # (TERMS, M) what term k adds to it
    coupling: np.ndarray  # (m, M) columns of h C/r where C couples modes
    push: np.ndarray  # (D, M) h^2/r^2 push
    chi: np.ndarray  # (N, M)
    reaction: np.ndarray  # (N, M) h^2/r^2 chi: acceleration of the modes per unit force
    mobility: np.ndarray  # (N, N) chi reaction^T: acceleration in the contacts per unit force
    yields: np.ndarray  # (N,) weight of changes of the force of a spring, see `_set_yields`; 0: rigid
    cosines: np.ndarray  # (H, WIDTH) series of cos(n h x)
    sines: np.ndarray  # (H, WIDTH) series of sin(n h x)
    phasors: np.ndarray  # (2, D, H)
    loads: np.ndarray  # (2 K D, WIDTH) series of the channels in every interval; none where there are many
    patterns: np.ndarray  # (P,) int: pattern of every place in the tables below, plus 1; 0: none yet
    columns: np.ndarray  # (P, LONG, m, S) series of the modes by the state; size = 2 m + N, or 2 m if rigid
    onward: np.ndarray  # (P, size, S) the state at the end of the interval by that at its beginning
    grips: np.ndarray  # (P, N, S) forces of rigid contacts that are held, by the state
    parts: Parts


class Motion(NamedTuple):
    """State of a motion, and the series of its present step.

    Rows of `series`, each a Taylor series in x: m displacements of modes; D channels; then for every contact
    its displacement z, velocity w = dz/dx - h v relative to the wall, friction force f, and the variation of
    the normal load.
    """

    state: np.ndarray  # (3, ...) see Q, P, F
    sense: np.ndarray  # (N,) int: 1, -1 sliding up, down; 0 held
    fresh: np.ndarray  # (N,) int: leading coefficients of the watched series that are zero by definition; of
    # a spring at its limit with the sign of that
    idle: np.ndarray  # (N,) bool: springs whose ends are both at rest, see `pattern.rest_springs`
    series: np.ndarray  # (m + D + 4 N, WIDTH)
    moves: np.ndarray  # (LONG, M) the displacements of modes, term by term
    solve: np.ndarray  # (N + 1, N) factors of the mobility of held contacts; its last row is scratch
    held: np.ndarray  # (N + 1,) int: contacts held by a constraint; the last: how many
    scratch: np.ndarray  # (8, WIDTH)
    clock: np.ndarray  # (1,) phase at which the series of the channels begin; NaN: there are none
    tangent: np.ndarray  # (size, S) derivatives of the state by that at the section
    onward: np.ndarray  # (2, size, S) derivatives over a part of an interval; scratch
    forces: np.ndarray  # (N, S) the derivatives of the forces
    watched: np.ndarray  # (S,) the derivatives of the watched quantity at an event
    units: np.ndarray  # (size + N,) the state, then the friction forces


@kernel
def padded(n):
    """Round up to whole vectors."""
    return LANES * ((n + LANES - 1) // LANES)


@kernel
def state_size(problem):
    """Number of coordinates of a state: modes, their velocities, and forces of springs if there are any."""
    contacts, modes = problem.chi.shape
    for j in range(contacts):
        if problem.spring[j] != 0.0:
            return 2 * modes + contacts
    return 2 * modes


@kernel
def _intervals(problem, i):
    """Intervals of half a period at r[i]."""
    return int(math.ceil(math.pi * problem.rates[i] / TURN))


@kernel
def most_intervals(problem, limit):
    """Largest number of intervals of a period over r, of those numbers that do not exceed a limit."""
    most = 0
    for i in range(problem.r.size):
        count = 2 * _intervals(problem, i)
        if count <= limit:
            most = max(most, count)
    return most


@entry
def _make_parts(problem, kept, most):
    """Allocate the parts of `kept` patterns and at most `most` intervals of a period."""
    contacts, modes = problem.chi.shape
    size = state_size(problem)
    units, loads = kept * contacts * (size + contacts), kept * most
    return Parts(
        np.zeros((units, WIDTH)), np.zeros(units), np.zeros((kept * contacts, size)),
        np.zeros(kept, np.int64), np.empty((loads * contacts, WIDTH)), np.empty(loads * contacts),
        np.empty((loads, size)), np.zeros(loads, np.int64), np.zeros(contacts),
        np.zeros((3, padded(max(modes, contacts)))),
    )  # fmt: skip


@entry
def make_row(problem):
    """Allocate the constants of one r."""
    contacts, modes = problem.chi.shape
    channels, harmonics = problem.push.shape[1], problem.orders.size
    width, size = padded(modes), state_size(problem)
    most = most_intervals(problem, _KEPT_INTERVALS)
    kept = min(1 << contacts, _KEPT_PATTERNS)
    return Row(
        np.empty(3), np.zeros(1, np.int64), np.empty(modes), np.empty((modes, modes)),
        np.zeros((TERMS, width)), np.zeros((TERMS, width)), np.zeros((modes, width)),
        np.zeros((channels, width)), np.zeros((contacts, width)), np.zeros((contacts, width)),
        np.empty((contacts, contacts)), np.zeros(contacts), np.zeros((harmonics, WIDTH)),
        np.zeros((harmonics, WIDTH)),
        np.empty((2, channels, harmonics)), np.empty((most * channels, WIDTH)), np.zeros(kept, np.int64),
        np.empty((kept, LONG, modes, padded(size))), np.empty((kept, size, padded(size))),
        np.empty((kept, contacts, padded(size))), _make_parts(problem, kept, most),
    )  # fmt: skip


@entry
def make_motion(problem):
    """Allocate the memory of one motion."""
    contacts, modes = problem.chi.shape
    size = state_size(problem)
    width = padded(modes)
    rows = padded(size)
    return Motion(
        np.zeros((3, padded(max(modes, contacts)))), np.zeros(contacts, np.int64),
        np.zeros(contacts, np.int64), np.zeros(contacts, np.bool_),
        np.zeros((modes + problem.push.shape[1] + 4 * contacts + 1, WIDTH)),
        np.zeros((LONG, width)), np.zeros((contacts + 1, contacts)), np.zeros(contacts + 1, np.int64),
        np.zeros((8, WIDTH)), np.zeros(1), np.zeros((size, rows)), np.zeros((2, size, rows)),
        np.zeros((contacts, rows)), np.zeros(rows), np.zeros(size + contacts),
    )  # fmt: skip


@kernel
def _set_waves(problem, row):
    """Fill the series of cos(n h x) and sin(n h x)."""
    h = row.numbers[H]
    for n in range(problem.orders.size):
        angle = problem.orders[n] * h
        term = 1.0
        for k in range(LONG):
            if k % 2 == 0:
                row.cosines[n, k] = term
                term *= angle / (k + 1.0)
            else:
                row.sines[n, k] = term
                term *= -angle / (k + 1.0)


@kernel
def _set_modes(problem, row, turn):
    """Fill the constants of the modes; `turn` is h/r."""
    contacts, modes = problem.chi.shape
    for m in range(modes):
        row.stiffness[m] = turn * turn * problem.squares[m]
        for other in range(modes):
            row.damping[m, other] = turn * problem.damping[m, other]
            row.coupling[other, m] = row.damping[m, other]
        own = 0.0 if problem.coupled else row.damping[m, m]
        for k in range(TERMS):
            inverse = 1.0 / ((k + 1.0) * (k + 2.0))
            row.velocity_term[k, m] = -own * (k + 1.0) * inverse
            row.place_term[k, m] = -row.stiffness[m] * inverse
        for d in range(problem.push.shape[1]):
            row.push[d, m] = turn * turn * problem.push[m, d]
        for j in range(contacts):
            row.chi[j, m] = problem.chi[j, m]
            row.reaction[j, m] = turn * turn * problem.chi[j, m]


@kernel
def _set_yields(problem, row):
    """Fill the weights of changes of the forces of springs beside changes of the modes.

    The weight is the displacement of a mode that moves the contact as far as the spring and the structure
    under this force.
    """
    square = row.numbers[R] * row.numbers[R]
    for j in range(problem.spring.size):
        flexibility, share = 0.0, 0.0
        for m in range(problem.squares.size):
            flexibility += problem.chi[j, m] * problem.chi[j, m] / (problem.squares[m] + square)
            share = max(share, abs(problem.chi[j, m]))
        row.yields[j] = 0.0
        if problem.spring[j] != 0.0 and share > 0.0:
            row.yields[j] = flexibility / ((1.0 + problem.spring[j] * flexibility) * share)


@kernel
def _fill_channels(problem, row, tau, series, first):
    """Fill the series of the channels, which begin at the phase tau, in `series` from its row `first`."""
    channels = problem.push.shape[1]
    for d in range(channels):
        for k in range(0, WIDTH, LANES):
            store(filled(0.0), series, (first + d) * WIDTH + k)
    for n in range(problem.orders.size):
        angle = problem.orders[n] * tau
        c, s = math.cos(angle), math.sin(angle)
        for d in range(channels):
            even = row.phasors[0, d, n] * c + row.phasors[1, d, n] * s
            odd = row.phasors[1, d, n] * c - row.phasors[0, d, n] * s
            if even == 0.0 and odd == 0.0:
                continue
            for k in range(0, WIDTH, LANES):
                at = (first + d) * WIDTH + k
                wave = load(row.cosines, n * WIDTH + k) * even + load(row.sines, n * WIDTH + k) * odd
                store(load(series, at) + wave, series, at)


@kernel
def set_row(problem, i, row):
    """Fill the constants of r[i]."""
    row.intervals[0] = _intervals(problem, i)
    h = math.pi / row.intervals[0]
    row.numbers[H], row.numbers[R], row.numbers[SIZE] = h, problem.r[i], problem.sizes[i]
    contacts, modes = problem.chi.shape
    _set_modes(problem, row, h / problem.r[i])
    for a in range(contacts):
        for b in range(contacts):
            row.mobility[a, b] = 0.0
            for m in range(modes):
                row.mobility[a, b] += problem.chi[a, m] * row.reaction[b, m]
    _set_yields(problem, row)
    _set_waves(problem, row)
    for part in range(2):
        for d in range(problem.push.shape[1]):
            for n in range(problem.orders.size):
                row.phasors[part, d, n] = problem.phasors[i, part, d, n]
    for k in range(row.patterns.size):
        row.patterns[k] = 0
        row.parts.known[k] = 0
    for k in range(row.parts.loads_known.size):
        row.parts.loads_known[k] = 0
    channels = problem.push.shape[1]
    if 2 * row.intervals[0] * channels <= row.loads.shape[0]:
        for k in range(2 * row.intervals[0]):
            _fill_channels(problem, row, SECTION + k * h, row.loads, k * channels)


@kernel
def set_channels(problem, row, tau, interval, motion):
    """Put the series of the channels, which begin at the phase tau, after those of the modes in the motion.

    Parameters
    ----------
    problem, row : Problem, Row
    tau : phase of the load
    interval : of the row, if tau is its beginning; else -1
    motion : Motion
    """
    if motion.clock[0] == tau:
        return
    motion.clock[0] = tau
    modes, channels = problem.push.shape
    if interval < 0 or 2 * row.intervals[0] * channels > row.loads.shape[0]:
        _fill_channels(problem, row, tau, motion.series, modes)
        return
    for k in range(0, channels * WIDTH, LANES):
        store(load(row.loads, interval * channels * WIDTH + k), motion.series, modes * WIDTH + k)

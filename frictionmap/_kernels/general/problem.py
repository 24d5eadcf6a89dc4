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

#: Largest angle of the fastest part of the motion in one step [rad] ...
TURN = 2.0

#: ... for which series of forces with this many terms are exact to rounding: 2^24/24! = 3e-17.  Displacements
#: have two more, because a force is their second derivative.
TERMS = 24
LONG = TERMS + 2

#: Numbers kept per series: a whole number of vectors.
WIDTH = 32


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
    orders: np.ndarray  # (H,) orders n of the harmonics
    r: np.ndarray  # (n_r,)
    phasors: np.ndarray  # (n_r, 2, D, H) cos and sin parts of the channels
    rates: np.ndarray  # (n_r,) bound on the rate of the fastest part of the motion
    sizes: np.ndarray  # (n_r,) displacement of the modes that a load at this r can be expected to cause
    symmetric: bool  # L(tau + pi) = -L(tau), nothing else breaks the mirror symmetry


class Row(NamedTuple):
    """The constants of one r, in units of the step."""

    numbers: np.ndarray  # (3,) step length h, r, size
    stiffness: np.ndarray  # (m,) h^2 w^2/r^2
    damping: np.ndarray  # (m, m) h C/r
    push: np.ndarray  # (m, D) h^2/r^2 push
    reaction: np.ndarray  # (N, m) h^2/r^2 chi: acceleration of the modes per unit force
    mobility: np.ndarray  # (N, N) chi reaction^T: acceleration in the contacts per unit force
    powers: np.ndarray  # (H, WIDTH) +-(n h)^k/k!, signs of cos and sin
    phasors: np.ndarray  # (2, D, H)


class Work(NamedTuple):
    """State of a motion, and the series of its present step.

    Rows of `series`, each a Taylor series in x: m displacements of modes; D channels; then for every contact
    its displacement z, velocity w = dz/dx - h v relative to the wall, friction force f, and the variation of
    the normal load.
    """

    state: np.ndarray  # (3, max(m, N)): q, p, and the force of every elastic contact
    sense: np.ndarray  # (N,) int: 1, -1 sliding up, down; 0 held
    fresh: np.ndarray  # (N,) int: leading coefficients of the watched series that are zero by definition
    series: np.ndarray  # (m + D + 4 N, WIDTH)
    solve: np.ndarray  # (N + 1, N) factors of the mobility of held contacts; its last row is scratch
    held: np.ndarray  # (N + 1,) int: contacts held by a constraint; the last: how many
    scratch: np.ndarray  # (8, WIDTH)
    tangent: np.ndarray  # (size, size) derivatives of the state by that at the section; size = 2 m + N
    columns: np.ndarray  # (LONG, m, size) their series
    forces: np.ndarray  # (N, size) the derivatives of the forces
    watched: np.ndarray  # (size,) the derivatives of what is watched at an event


@entry
def make_row(problem):
    """Allocate the constants of one r."""
    contacts, modes = problem.chi.shape
    channels, harmonics = problem.push.shape[1], problem.orders.size
    return Row(
        np.empty(3), np.empty(modes), np.empty((modes, modes)), np.empty((modes, channels)),
        np.empty((contacts, modes)), np.empty((contacts, contacts)), np.zeros((harmonics, WIDTH)),
        np.empty((2, channels, harmonics)),
    )  # fmt: skip


@entry
def make_work(problem):
    """Allocate the memory of one motion."""
    contacts, modes = problem.chi.shape
    size = 2 * modes + contacts
    return Work(
        np.zeros((3, max(modes, contacts))), np.zeros(contacts, np.int64), np.zeros(contacts, np.int64),
        np.zeros((modes + problem.push.shape[1] + 4 * contacts, WIDTH)), np.zeros((contacts + 1, contacts)),
        np.zeros(contacts + 1, np.int64), np.zeros((8, WIDTH)), np.zeros((size, size)),
        np.zeros((LONG, modes, size)), np.zeros((contacts, size)),
        np.zeros(size),
    )  # fmt: skip


@kernel
def _set_powers(orders, h, powers):
    """Fill the series of cos(n h x) (even powers) and sin(n h x) (odd powers)."""
    for n in range(orders.size):
        angle = orders[n] * h
        term = 1.0
        for k in range(LONG):
            powers[n, k] = term
            term *= angle / (k + 1.0) if k % 2 == 0 else -angle / (k + 1.0)


@kernel
def set_row(problem, i, row):
    """Fill the constants of r[i].

    cos: 1, -a^2/2!, a^4/4!, ...; sin: a, -a^3/3!, ...: the sign changes after every odd power.
    """
    r = problem.r[i]
    h = TURN / problem.rates[i]
    row.numbers[0] = h
    row.numbers[1] = r
    row.numbers[2] = problem.sizes[i]
    turn = h / r
    contacts, modes = problem.chi.shape
    for m in range(modes):
        row.stiffness[m] = turn * turn * problem.squares[m]
        for other in range(modes):
            row.damping[m, other] = turn * problem.damping[m, other]
        for d in range(problem.push.shape[1]):
            row.push[m, d] = turn * turn * problem.push[m, d]
        for j in range(contacts):
            row.reaction[j, m] = turn * turn * problem.chi[j, m]
    for i1 in range(contacts):
        for i2 in range(contacts):
            sum_ = 0.0
            for m in range(modes):
                sum_ += problem.chi[i1, m] * row.reaction[i2, m]
            row.mobility[i1, i2] = sum_
    _set_powers(problem.orders, h, row.powers)
    for part in range(2):
        for d in range(problem.push.shape[1]):
            for n in range(problem.orders.size):
                row.phasors[part, d, n] = problem.phasors[i, part, d, n]


@kernel
def set_channels(problem, row, tau, series):
    """Fill the series of the channels from the phase tau on."""
    modes, channels = problem.push.shape
    for d in range(channels):
        for k in range(LONG):
            series[modes + d, k] = 0.0
    for n in range(problem.orders.size):
        angle = problem.orders[n] * tau
        c, s = math.cos(angle), math.sin(angle)
        for d in range(channels):
            even = row.phasors[0, d, n] * c + row.phasors[1, d, n] * s
            odd = row.phasors[1, d, n] * c - row.phasors[0, d, n] * s
            for k in range(0, LONG, 2):
                series[modes + d, k] += row.powers[n, k] * even
                series[modes + d, k + 1] += row.powers[n, k + 1] * odd

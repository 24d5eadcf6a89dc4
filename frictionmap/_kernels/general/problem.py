"""A structure with its contacts and its load, as arrays, and the memory that a motion is followed in.

    r^2 q'' + r C q' + w^2 q = push L(tau) - chi^T f,   z = chi q - base L(tau),   |f| <= beta nu(tau)

q are the modes of the structure with all contacts free, of unit modal mass.  L(tau) are the *channels*: the
functions of time that drive anything, each a sum of harmonics, or, where there are none, a polynomial over
each interval of a record.  A channel can push modes, move the wall of a contact, or vary its normal load:
nu = 1 + normal L(tau).

Time inside a step is x = (tau - tau_0)/h in [0, 1], and velocities are p = dq/dx = h q'.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES
from .keys import Keys

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

#: Terms of a channel over an interval of a record of samples: a cubic, and two integrals of it.  Those of
#: records by a formula have more, up to TERMS of a load and LONG of the place of a wall.
PIECE_TERMS = 6

#: Contacts from which on work is done in forms that suit many: derivatives in the coordinates that held
#: contacts leave free, and kept for several Newton steps; forces of held contacts all at once.  Systems with
#: fewer keep their bits.
MANY = 9

#: Places in `Row.intervals`: number K of half a period; terms of a channel over an interval of a record.
HALF, LOAD_TERMS = 0, 1

#: k + 1: factors of a derivative.
NEXT = np.arange(1.0, WIDTH + 1.0)

#: Phase of the load at which states are compared: events gather at the extremes of the load, away from here.
SECTION = 0.37

#: Places in `Row.numbers`: length h of the intervals; r; displacement of the modes that the load can cause.
H, R, SIZE = 0, 1, 2

#: Rows of a state: the modes q, their velocities p, and the forces f of elastic contacts.
Q, P, F = 0, 1, 2

#: Row of `Motion.scratch` for the quantity watched in a contact.
WATCHED = 0


class Law(NamedTuple):
    """Friction over the speed, in S segments at most; S = 0 where no friction depends on it."""

    speed: np.ndarray  # (N, S) speed at which a segment begins, over omega_1 P/k_1
    constant: np.ndarray  # (N, S) friction of its line at speed 0, over that just above speed 0
    slope: np.ndarray  # (N, S)
    count: np.ndarray  # (N,) int: segments
    certified: np.ndarray  # (N,) kinetic friction up to which, in all contacts, there is one steady state
    steepest: np.ndarray  # (N,) damping of the modes by a contact per kinetic friction, at most
    norms: np.ndarray  # (2,) of the modal matrices: damping and stiffness


#: Friction that does not depend on the speed.
FLAT = Law(
    np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0)), np.zeros(0, np.int64), np.zeros(0), np.zeros(0),
    np.zeros(2),
)  # fmt: skip


class Coupling(NamedTuple):
    """How forces in elastic contacts displace others beside the modes, see `laws.coupled`."""

    flexibility: np.ndarray  # (N, N) F; (0, 0) where they do not
    stiffest: np.ndarray  # (N,) diagonal of its inverse


#: Contacts that only modes couple.
UNCOUPLED = Coupling(np.zeros((0, 0)), np.zeros(0))


class Turn(NamedTuple):
    """How sectors of a ring follow each other in a steady state, see `parts`."""

    modes: np.ndarray  # (m, m) T: q(tau) = T q(tau + pi/parts)
    contacts: np.ndarray  # (N,) int: the contact from whose motion that of each follows
    signs: np.ndarray  # (N,) with this sign


#: No sectors.
ALONE = Turn(np.zeros((0, 0)), np.zeros(0, np.int64), np.zeros(0))


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
    law: Law = FLAT
    loops: bool = False  # whether rigid contacts close loops
    coupling: Coupling = UNCOUPLED
    parts: int = 1  # of half a period, after each of which the motion is the same in the next sector
    turn: Turn = ALONE


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
    intervals: np.ndarray  # (2,) int: see HALF
    stiffness: np.ndarray  # (m,) h^2 w^2/r^2
    damping: np.ndarray  # (m, m) h C/r
    velocity_term: np.ndarray  # (TERMS, M) what term k + 1 of a mode adds to term k + 2, by its own damping
    place_term: np.ndarray  # (TERMS, M) what term k adds to it
    coupling: np.ndarray  # (m, M) columns of h C/r where C couples modes
    push: np.ndarray  # (D, M) h^2/r^2 push
    chi: np.ndarray  # (N, M)
    reaction: np.ndarray  # (N, M) h^2/r^2 chi: acceleration of the modes per unit force
    mobility: np.ndarray  # (N, N) chi reaction^T: acceleration in the contacts per unit force
    yields: np.ndarray  # (N,) weights of changes of forces that are coordinates, see `laws`; else 0
    cosines: np.ndarray  # (H, WIDTH) series of cos(n h x)
    sines: np.ndarray  # (H, WIDTH) series of sin(n h x)
    phasors: np.ndarray  # (2, D, H)
    loads: np.ndarray  # (2 K D, WIDTH) series of the channels in every interval; none where there are many
    patterns: np.ndarray  # (P,) int: number of the pattern of every place in the tables below; 0: none yet
    columns: np.ndarray  # (P, LONG, m, S) series of the modes by the state; size = 2 m + N, or 2 m if rigid
    onward: np.ndarray  # (P, size, S) the state at the end of the interval by that at its beginning
    bases: np.ndarray  # (P, 3, m, m) see `left_free`; one place where it is not used
    grips: np.ndarray  # (P, N, S) forces of rigid contacts that are held, by the state
    parts: Parts
    kinetic: np.ndarray  # (N,) kinetic friction of the tables where they depend on it, see `follow`
    keys: Keys  # the patterns of the places


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
    idle: np.ndarray  # (N,) bool: springs whose ends are both at rest, see `elastic.rest_springs`; held rigid
    # contacts that others keep at rest, see `loops`
    series: np.ndarray  # (m + D + 4 N, WIDTH)
    moves: np.ndarray  # (LONG, M) the displacements of modes, term by term
    solve: np.ndarray  # (N + 1, N) factors of the mobility of held contacts; its last row is scratch
    held: np.ndarray  # (N + 1,) int: contacts held by a constraint; the last: how many
    scratch: np.ndarray  # (8, WIDTH) series: see WATCHED, `record`, `events`
    clock: np.ndarray  # (1,) phase at which the series of the channels begin; NaN: there are none
    tangent: np.ndarray  # (size, S) derivatives of the state by that at the section
    onward: np.ndarray  # (2, size, S) derivatives over a part of an interval; scratch
    forces: np.ndarray  # (N, S) the derivatives of the forces
    watched: np.ndarray  # (S,) the derivatives of the watched quantity at an event
    units: np.ndarray  # (size + N,) the state, then the friction forces
    segment: np.ndarray  # (N,) int: segment of the friction law in which a contact slides
    law_damping: np.ndarray  # (N,) derivative of its force by dz/dx
    event: np.ndarray  # (4, N) scratch of an event, see `follow`
    springs: np.ndarray  # (N + 1,) int: coupled contacts that act as springs; the last: how many
    grip: np.ndarray  # (N + 1, N) factors of their flexibility; its last row is scratch
    reduced: np.ndarray  # (4 m, S) the derivatives in the coordinates of `left_free`; scratch
    grips: np.ndarray  # (N, ...) see `held_together`; one place where it is not used, as in the next
    hold: np.ndarray  # (m + D + 1, ...)


@kernel
def padded(n):
    """Round up to whole vectors."""
    return LANES * ((n + LANES - 1) // LANES)


@inner_kernel
def first_contact_row(problem):
    """Row of the displacement z of the first contact; those of w, f and nu follow, N rows each."""
    return problem.push.shape[0] + problem.push.shape[1]


@inner_kernel
def velocity_row(problem, j):
    """Row of the velocity w of a contact."""
    return first_contact_row(problem) + problem.spring.size + j


@inner_kernel
def force_row(problem, j):
    """Row of the friction force f of a contact."""
    return first_contact_row(problem) + 2 * problem.spring.size + j


@inner_kernel
def normal_row(problem, j):
    """Row of the normal load nu of a contact."""
    return first_contact_row(problem) + 3 * problem.spring.size + j


@kernel
def slide_velocity(problem, row, motion, j):
    """Velocity dz/dx of a contact relative to its wall; the series of the channels must be there."""
    modes, channels = problem.push.shape
    w = -row.numbers[H] * problem.belt[j]
    for m in range(modes):
        w += problem.chi[j, m] * motion.state[P, m]
    for d in range(channels):
        w -= problem.base[j, d] * motion.series[modes + d, 1]
    return w


@inner_kernel
def is_rigid(problem, m):
    """Whether no spring acts against mode m: a rigid-body mode, whose place changes nothing else."""
    return problem.squares[m] == 0.0


@inner_kernel
def is_free(problem):
    """Whether there are rigid-body modes; they come first."""
    return is_rigid(problem, 0)


@kernel
def moves_alone(problem, m):
    """Whether nothing but the load acts on mode m: neither springs nor contacts nor damping."""
    alone = is_rigid(problem, m)
    for j in range(problem.chi.shape[0]):
        alone = alone and problem.chi[j, m] == 0.0
    for k in range(problem.squares.size):
        alone = alone and problem.damping[m, k] == 0.0
    return alone


@kernel
def is_carried(problem, j):
    """Whether a rigid-body mode moves contact j: nothing brings it back to a place."""
    carried = False
    for m in range(problem.squares.size):
        carried = carried or (is_rigid(problem, m) and problem.chi[j, m] != 0.0)
    return carried


@kernel
def varies(problem, j):
    """Whether the normal load of a contact varies."""
    varies = False
    for d in range(problem.normal.shape[1]):
        varies = varies or problem.normal[j, d] != 0.0
    return varies

"""What a steady state does in a cycle: extremes and their phases, harmonics, works.

Asked for apart from `details`, and as they are, by the class of `wanted`: who asks for nothing of it compiles
nothing of it.  Results are in rows: the masses, one more force, the contact.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import by_class, entry, kernel
from ..one_mass.newton import full_period
from ..one_mass.sliding_orbit import continuous_amplitude, orbit_phase
from ..structure.newton import Workspace, make_workspace
from ..structure.oscillators import Scratch, make_scratch
from ..structure.sliding_orbit import Continuous
from ..structure.state import (
    DIRECT_COS,
    DIRECT_SIN,
    Z_RATE,
    Loads,
    Model,
    Structure,
    Z,
    make_structure,
)
from .answers import known_orbit
from .details import Nothing
from .extremes import (
    FOUND,
    PHASE,
    PHASE_BEGIN,
    PHASE_END,
    VALUE,
    Alone,
    Shapes,
    largest_in_contact,
    largest_moduli,
    turned_half,
)
from .harmonics import Spectrum, harmonics_of_continuous, harmonics_of_phases, make_spectrum
from .measure import measure
from .phase_table import continuous_phase, phase_columns
from .rests import rest_square
from .works import Dampers, sliding_distance, viscous_work

#: Columns of `Results.works`, per excitation cycle.
DISTANCE, BY_FRICTION, BY_LOAD, BY_DAMPING, EQUIVALENT = 0, 1, 2, 3, 4
WORKS = 5

#: Columns of `Results.firsts`.
MODULUS, LAG = 0, 1

#: Columns of `Results.rests`.
RMS, DISTORTION = 0, 1


class Results(NamedTuple):
    """What is asked for, over (mu, r, beta); what is not has no size.

    Rows are the masses, then a force, then the contact.  The force is the one transmitted to the ground, in
    `harmonics` the friction force.
    """

    extremes: np.ndarray  # (..., rows, FOUND)
    firsts: np.ndarray  # (..., rows, 2) modulus and lag of the first harmonics
    harmonics: np.ndarray  # (..., rows, N + 1) complex
    works: np.ndarray  # (..., WORKS)
    rests: np.ndarray  # (..., masses, 2) root mean square and distortion


class Linear(NamedTuple):
    """Phasors of motions with the contact held, or without friction; arrays (n_r, ...)."""

    held: np.ndarray  # (n_r, n_dof) complex, of the masses with the contact held
    force: np.ndarray  # (n_r,) complex, of the force that holds it
    growing: np.ndarray  # (n_r, rows) complex, directions of what grows without bound at a resonance


class Balance(NamedTuple):
    """Forces and works as functions of first harmonics X and F; arrays (n_r, ...)."""

    load: np.ndarray  # (n_r,) complex, sum of the loads
    inertia: np.ndarray  # (n_r, n_dof) r^2 times the mass
    power: np.ndarray  # (n_r, n_dof) complex; the work of the load is pi Im(power.X + power_alone - s F)
    power_alone: np.ndarray  # (n_r,) complex
    base_motion: float  # s
    dampers: Dampers  # of what the contact sees
    damped: bool  # whether they take any work
    damping_alone: np.ndarray  # (n_r,) work of the dampers of the modes that it does not see
    damping_held: np.ndarray  # (n_r,) work of all of them with the contact held


class Quantities(NamedTuple):
    """Quantities over a map."""

    r: np.ndarray
    model: Model
    loads: Loads
    orbit: Continuous
    steps: float
    at_wall: int  # the mass whose displacement is that in the contact, or -1
    shapes: Shapes  # of the masses and, if it is asked for, of the transmitted force
    alone: Alone
    linear: Linear
    balance: Balance
    out: Results
    harmonics: int


class QuantitiesHere(NamedTuple):
    """Quantities at one frequency; at r = 0 nothing moves, and the structure is that of another."""

    i: int
    st: Structure
    of: Quantities
    spectrum: Spectrum
    rows: np.ndarray  # (rows, N + 1) complex, harmonics of a cell; the force is that of friction
    extremes: np.ndarray  # (rows, FOUND) of a cell
    table: np.ndarray  # (1, columns) that of a continuous orbit
    work: Workspace
    scratch: Scratch


@kernel
def _nothing_at(wanted, i):
    return wanted


@entry
def _quantities_at(wanted, i):
    r = wanted.r[i] if wanted.r[i] > 0.0 else 1.0
    st = make_structure(wanted.model, wanted.loads, i, r, wanted.steps)
    rows = wanted.linear.growing.shape[1]
    return QuantitiesHere(
        i, st, wanted, make_spectrum(st, max(1, wanted.harmonics)),
        np.zeros((rows, max(1, wanted.harmonics) + 1), dtype=np.complex128), np.full((rows, FOUND), math.nan),
        np.empty((1, phase_columns(st.n))), make_workspace(st.n), make_scratch(st.n),
    )  # fmt: skip


@kernel
def _copy(rows, target):
    """Copy as many columns as the target has."""
    for k in range(target.shape[0]):
        for n in range(target.shape[1]):
            target[k, n] = rows[k, n]


@kernel
def _lag(x):
    """-arg x in (-pi, pi]; of nothing there is none."""
    if x == 0.0:
        return math.nan
    angle = math.atan2(-x.imag, x.real)
    return math.pi if angle == -math.pi else angle + 0.0  # not -0.0


@kernel
def _transmitted(here):
    """First harmonic of the transmitted force, the loads less the inertia."""
    balance, i = here.of.balance, here.i
    total = balance.load[i]
    for k in range(balance.inertia.shape[1]):
        total += balance.inertia[i, k] * here.rows[k, 1]
    return total


@kernel
def _rate(st, spectrum, n, i):
    """Harmonic of p of a free oscillator."""
    rate = complex(0.0, n * st.r) * spectrum.modes[n, i]
    return rate - complex(st.modes[DIRECT_COS, i], -st.modes[DIRECT_SIN, i]) if n == 1 else rate


@kernel
def _put_harmonics(here):
    """Harmonics of all rows from those of friction and modes."""
    st, spectrum, of = here.st, here.spectrum, here.of
    force = of.balance.inertia.shape[1]
    for n in range(spectrum.friction.size):
        for k in range(force):
            total = of.alone.sliding[here.i, k] if n == 1 else 0j
            for i in range(st.n):
                total += of.shapes.free[k, i] * spectrum.modes[n, i]
                total += of.shapes.free[k, st.n + i] * _rate(st, spectrum, n, i)
            here.rows[k, n] = total
        here.rows[force, n] = spectrum.friction[n]
        total = 0j
        for i in range(st.n):
            total += st.modes[Z, i] * spectrum.modes[n, i]
            total += st.modes[Z_RATE, i] * _rate(st, spectrum, n, i)
        here.rows[force + 1, n] = total


@kernel
def _put_held(here):
    """Harmonics of all rows with the contact held: of the oscillation, wherever the contact rests."""
    linear, i = here.of.linear, here.i
    force = linear.held.shape[1]
    for k in range(here.rows.shape[0]):
        for n in range(here.rows.shape[1]):
            here.rows[k, n] = 0j
    for k in range(force):
        here.rows[k, 1] = linear.held[i, k]
    here.rows[force, 1] = linear.force[i]


@kernel
def _extremes_of_one_harmonic(here):
    """Extremes of a motion that is its first harmonic."""
    force = here.of.balance.inertia.shape[1]
    for k in range(here.extremes.shape[0]):
        phasor = here.rows[k, 1] if k != force else _transmitted(here)
        here.extremes[k, VALUE], here.extremes[k, PHASE] = abs(phasor), _lag(phasor)
        here.extremes[k, PHASE_BEGIN], here.extremes[k, PHASE_END] = math.nan, math.nan


@kernel
def _store(here, m, j, beta, distance, damping):
    """Write what was asked for of a cell, from its rows; distance, damping : sliding distance and work."""
    of, out, i = here.of, here.of.out, here.i
    force = of.balance.inertia.shape[1]
    if out.extremes.size:
        _copy(here.extremes, out.extremes[m, i, j])
    if out.harmonics.size:
        _copy(here.rows, out.harmonics[m, i, j])
    if out.firsts.size:
        for k in range(here.rows.shape[0]):
            phasor = here.rows[k, 1] if k != force else _transmitted(here)
            out.firsts[m, i, j, k, MODULUS], out.firsts[m, i, j, k, LAG] = abs(phasor), _lag(phasor)
    if out.works.size:
        balance, amplitude = of.balance, here.extremes[force + 1, VALUE]
        fed = balance.power_alone[i] - balance.base_motion * here.rows[force, 1]
        for k in range(force):
            fed += balance.power[i, k] * here.rows[k, 1]
        works = out.works[m, i, j]
        works[DISTANCE], works[BY_FRICTION] = distance, beta * distance
        works[BY_LOAD], works[BY_DAMPING] = math.pi * fed.imag, damping
        square = math.pi * amplitude * amplitude
        works[EQUIVALENT] = beta * distance / square if square > 0.0 else math.nan


@kernel
def _store_rest(here, m, j, k, rest):
    """Write root mean square and distortion of a mass, `rest` the root mean square but for X_0 and X_1."""
    first = abs(here.rows[k, 1])
    out = here.of.out.rests[m, here.i, j, k]
    out[RMS] = math.hypot(math.hypot(here.rows[k, 0].real, first / math.sqrt(2.0)), rest)
    out[DISTORTION] = math.sqrt(2.0) * rest / first if first > 0.0 else math.nan


@kernel
def _no_rests(here, m, j):
    """Of a motion that is its first harmonic."""
    for k in range(here.of.out.rests.shape[3] if here.of.out.rests.size else 0):
        _store_rest(here, m, j, k, 0.0)


@kernel
def _rests(here, m, j, beta, table, halves):
    """Of a motion over its table of phases, so many half periods long."""
    of = here.of
    for k in range(of.out.rests.shape[3] if of.out.rests.size else 0):
        square = rest_square(
            here.st, beta, of.shapes, of.alone, here.i, k, here.rows[k, 0].real, here.rows[k, 1], table,
            here.work, here.scratch,
        )  # fmt: skip
        _store_rest(here, m, j, k, math.sqrt(square / (math.pi * halves)))


@kernel
def _no_stuck(here, m, j):
    pass


@kernel
def _stuck(here, m, j):
    """Where the contact sticks; what it is held at is no part of the oscillation."""
    _put_held(here)
    _extremes_of_one_harmonic(here)
    _store(here, m, j, 0.0, 0.0, here.of.balance.damping_held[here.i])
    _no_rests(here, m, j)


@kernel
def _look(here, beta, table):
    """The extremes of the rows but the contact's, if they were asked for."""
    of = here.of
    if of.out.extremes.size and not (of.shapes.static_shape.size == 1 and of.at_wall == 0):
        largest_moduli(
            here.st, beta, of.shapes, of.alone, here.i, of.at_wall, table, here.extremes, here.work,
            here.scratch,
        )  # fmt: skip
    if of.at_wall >= 0:
        for column in range(FOUND):
            here.extremes[of.at_wall, column] = here.extremes[here.extremes.shape[0] - 1, column]


@kernel
def _dampers(here, beta, table, halves):
    """The work of the dampers per cycle, if it was asked for, of a motion that slides."""
    balance = here.of.balance
    if not here.of.out.works.size:
        return 0.0
    total = balance.damping_alone[here.i]
    if balance.damped:
        spent = viscous_work(here.st, beta, balance.dampers, table, here.work, here.scratch)
        total += 2.0 / halves * spent
    return total


@kernel
def _no_continuous(here, m, j, beta):
    pass


@kernel
def _continuous(here, m, j, beta):
    """On the continuous orbit."""
    orbit, i = here.of.orbit, here.i
    contact = here.extremes[here.extremes.shape[0] - 1]
    if not orbit.v_abs[i] < math.inf:
        _growing(here, m, j, beta)
        return
    if beta == 0.0:  # linear; u may be infinite
        harmonics_of_continuous(here.st, 0.0, 0.0, here.spectrum)
        _put_harmonics(here)
        _extremes_of_one_harmonic(here)
        damping = here.of.balance.damping_alone[i] + _linear_damping(here)
        _store(here, m, j, 0.0, 4.0 * contact[VALUE], damping)
        _no_rests(here, m, j)
        return
    phase = orbit_phase(orbit.v_abs[i], orbit.v_arg[i], orbit.u[i], beta)
    harmonics_of_continuous(here.st, beta, phase, here.spectrum)
    _put_harmonics(here)
    contact[VALUE] = continuous_amplitude(orbit.v_abs[i], orbit.u[i], orbit.g[i], beta)
    contact[PHASE] = turned_half(phase, 1.0)
    contact[PHASE_BEGIN], contact[PHASE_END] = math.nan, math.nan
    continuous_phase(here.st, orbit, i, beta, phase, here.table[0], here.work)
    _look(here, beta, here.table)
    _store(here, m, j, beta, 4.0 * contact[VALUE], _dampers(here, beta, here.table, 1))
    _rests(here, m, j, beta, here.table, 1)


@kernel
def _linear_damping(here):
    """The work of the dampers without friction."""
    st, dampers = here.st, here.of.balance.dampers
    total = 0.0
    for k in range(dampers.weights.size):
        moved = complex(dampers.base[k], 0.0)
        for i in range(st.n):
            moved += dampers.place[k, i] * here.spectrum.modes[1, i]
            moved += dampers.place[k, st.n + i] * _rate(st, here.spectrum, 1, i)
        size = abs(moved)
        total += dampers.weights[k] * st.r * math.pi * size * size
    return total


@kernel
def _unbounded(direction):
    """Infinite along a direction; parts that it does not have stay 0."""
    re = math.copysign(math.inf, direction.real) if direction.real != 0.0 else 0.0
    im = math.copysign(math.inf, direction.imag) if direction.imag != 0.0 else 0.0
    return complex(re, im)


@kernel
def _growing(here, m, j, beta):
    """At an undamped resonance: the phases to which a motion goes that grows without bound."""
    of, out, i = here.of, here.of.out, here.i
    directions = of.linear.growing[i]
    contact = directions.size - 1
    harmonics_of_continuous(here.st, beta, _lag(directions[contact]), here.spectrum)
    _put_harmonics(here)
    for k in range(directions.size):
        if k != contact - 1:
            here.rows[k, 1] = _unbounded(directions[k])
        if out.extremes.size:
            out.extremes[m, i, j, k, VALUE], out.extremes[m, i, j, k, PHASE] = math.inf, _lag(directions[k])
        if out.firsts.size:
            out.firsts[m, i, j, k, MODULUS], out.firsts[m, i, j, k, LAG] = math.inf, _lag(directions[k])
    if out.harmonics.size:
        _copy(here.rows, out.harmonics[m, i, j])
    if out.works.size:
        works = out.works[m, i, j]
        works[DISTANCE], works[BY_LOAD] = math.inf, math.inf
        works[BY_FRICTION] = math.inf if beta > 0.0 else 0.0
        works[BY_DAMPING] = math.nan if of.balance.damped else of.balance.damping_alone[i]
        works[EQUIVALENT] = 0.0
    if out.rests.size:
        for k in range(out.rests.shape[3]):
            out.rests[m, i, j, k, RMS], out.rests[m, i, j, k, DISTORTION] = math.inf, 0.0


@kernel
def _no_orbit(here, motion, contact, found, m, j, beta):
    pass


@entry
def _orbit(here, motion, contact, found, m, j, beta):
    """On a periodic orbit, whose table of phases is written first."""
    table = np.empty((2 * found.slides, phase_columns(here.st.n)))
    orbit = known_orbit(found.at, found.event, found.sign, found.slides)
    table = table[: measure(motion, contact, orbit, table).phases]
    _phases(here, m, j, beta, table)


@kernel
def _phases(here, m, j, beta, table):
    """Of the steady state of a table of phases."""
    halves = harmonics_of_phases(here.st, beta, table, here.spectrum)
    _put_harmonics(here)
    largest_in_contact(table, here.extremes[here.extremes.shape[0] - 1])
    _look(here, beta, table)
    if full_period(halves) != 1:
        for k in range(here.extremes.shape[0]):
            for column in range(PHASE, FOUND):
                here.extremes[k, column] = math.nan
    distance = 2.0 / halves * sliding_distance(here.st, table, here.work)
    _store(here, m, j, beta, distance, _dampers(here, beta, table, halves))
    _rests(here, m, j, beta, table, halves)


# For the only cell of a map: an entry a branch, so that who has one cell compiles one branch.


@entry
def stuck_cell_quantities(wanted):
    """Write those of the only cell of a map, whose contact sticks."""
    _stuck(_quantities_at(wanted, 0), 0, 0)


@entry
def continuous_cell_quantities(wanted, beta):
    """Write those of the only cell of a map, on the continuous orbit of the closed form."""
    _continuous(_quantities_at(wanted, 0), 0, 0, beta)


@entry
def table_cell_quantities(wanted, beta, table):
    """Write those of the only cell of a map, of the steady state of a table of phases."""
    _phases(_quantities_at(wanted, 0), 0, 0, beta, table)


@by_class((Nothing, _nothing_at), (Quantities, _quantities_at))
def quantities_at(wanted, i):
    """The quantities at the i-th frequency."""


@by_class((Nothing, _no_stuck), (QuantitiesHere, _stuck))
def take_stuck(here, m, j):
    """Write those of a cell whose contact sticks."""


@by_class((Nothing, _no_continuous), (QuantitiesHere, _continuous))
def take_continuous(here, m, j, beta):
    """Write those of a cell on the continuous orbit."""


@by_class((Nothing, _no_orbit), (QuantitiesHere, _orbit))
def take_orbit(here, motion, contact, found, m, j, beta):
    """Write those of a cell on the periodic orbit that was found."""

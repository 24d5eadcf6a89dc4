"""Quantities of a steady state over one excitation cycle: extremes and their phases, harmonics, work,
distortion.

Rows of results are the masses, one force, and the contact.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..continuous_motion import continuous_amplitude, orbit_phase
from ..structure.newton import Workspace
from ..structure.oscillators import Scratch
from ..structure.sliding_orbit import Continuous
from ..structure.state import FEEDTHROUGH_COS, FEEDTHROUGH_SIN, Z_RATE, StructureAtFrequency, Z
from .dissipation import Dampers, sliding_distance, viscous_work
from .distortion import distortion_square
from .extremes import (
    FOUND,
    PHASE,
    PHASE_BEGIN,
    PHASE_END,
    VALUE,
    OutputMatrices,
    UncoupledResponse,
    largest_in_contact,
    largest_moduli,
    turned_half,
)
from .harmonics import Spectrum, harmonics_of_continuous, harmonics_of_segments, make_spectrum
from .periods import full_period
from .segment_table import continuous_segment, segment_columns

#: Columns of `Results.work_terms`, per excitation cycle.
DISTANCE, BY_FRICTION, BY_LOAD, BY_DAMPING, EQUIVALENT = 0, 1, 2, 3, 4
WORK_TERMS = 5

#: Columns of `Results.firsts`.
MODULUS, LAG = 0, 1

#: Columns of `Results.distortions`.
RMS, DISTORTION = 0, 1


class Results(NamedTuple):
    """Requested results over (mu, r, beta); arrays that are not requested have size 0.

    Rows are the masses, then a force, then the contact.  The force is the one transmitted to the ground; in
    `harmonics` it is the friction force.
    """

    extremes: np.ndarray  # (..., rows, FOUND)
    firsts: np.ndarray  # (..., rows, 2) modulus and phase lag of the first harmonics
    harmonics: np.ndarray  # (..., rows, N + 1) complex
    work_terms: np.ndarray  # (..., WORK_TERMS)
    distortions: np.ndarray  # (..., masses, 2) root mean square and distortion


class Linear(NamedTuple):
    """Phasors of the linear responses: with the contact held, and without friction; arrays (n_r, ...)."""

    held: np.ndarray  # (n_r, n_dof) complex displacements of the masses with the contact held
    force: np.ndarray  # (n_r,) complex force that holds the contact
    growth: np.ndarray  # (n_r, rows) complex directions of the growing motion at an undamped resonance


class Balance(NamedTuple):
    """Forces and work as functions of the first harmonics X of the masses and F of friction; arrays (n_r,
    ...).
    """

    load: np.ndarray  # (n_r,) complex, sum of the loads
    inertia: np.ndarray  # (n_r, n_dof) r^2 times the mass
    power: np.ndarray  # (n_r, n_dof) complex; the work of the load is pi Im(power.X + base_power - s F)
    base_power: np.ndarray  # (n_r,) complex
    base_motion: float  # s
    dampers: Dampers  # of the participating modes
    damped: bool  # whether any of them dissipates energy
    damping_uncoupled: np.ndarray  # (n_r,) work of the dampers of the modes that do not participate
    damping_held: np.ndarray  # (n_r,) work of all dampers with the contact held


class Quantities(NamedTuple):
    """Data for the quantities over a whole map."""

    wall_mass: int  # mass whose displacement equals the contact displacement, or -1
    outputs: OutputMatrices  # of the masses and, if requested, of the transmitted force
    uncoupled: UncoupledResponse
    linear: Linear
    balance: Balance
    out: Results
    harmonics: int


class QuantitiesAtFrequency(NamedTuple):
    """Data for the quantities at one frequency."""

    i: int
    st: StructureAtFrequency
    orbit: Continuous
    request: Quantities
    spectrum: Spectrum
    rows: np.ndarray  # (rows, N + 1) complex harmonics of one cell; the force is the friction force
    extremes: np.ndarray  # (rows, FOUND) extremes of one cell
    table: np.ndarray  # (1, columns) segment table of a continuous orbit
    work: Workspace
    scratch: Scratch


@entry
def quantities_at(quantities, common, shared):
    """Build the data for one frequency; `common` and `shared` as in `further`."""
    rows, harmonics, st = quantities.linear.growth.shape[1], max(1, quantities.harmonics), shared.st
    return QuantitiesAtFrequency(
        shared.i, st, common.orbit, quantities, make_spectrum(st, harmonics),
        np.zeros((rows, harmonics + 1), dtype=np.complex128), np.full((rows, FOUND), math.nan),
        np.empty((1, segment_columns(st.n))), shared.work, shared.scratch,
    )  # fmt: skip


@kernel
def _copy(rows, target):
    """Copy the leading columns of the rows into an array with at most as many columns."""
    for k in range(target.shape[0]):
        for n in range(target.shape[1]):
            target[k, n] = rows[k, n]


@kernel
def _lag(x):
    """Phase lag -arg x in (-pi, pi]; NaN for x = 0."""
    if x == 0.0:
        return math.nan
    angle = math.atan2(-x.imag, x.real)
    return math.pi if angle == -math.pi else angle + 0.0  # not -0.0


@kernel
def _transmitted(quantities):
    """First harmonic of the transmitted force: the loads less the inertia forces."""
    balance, i = quantities.request.balance, quantities.i
    total = balance.load[i]
    for k in range(balance.inertia.shape[1]):
        total += balance.inertia[i, k] * quantities.rows[k, 1]
    return total


@kernel
def _rate(st, spectrum, n, i):
    """n-th harmonic of the reduced velocity p of the i-th free oscillator."""
    rate = complex(0.0, n * st.r) * spectrum.modes[n, i]
    return rate - complex(st.modes[FEEDTHROUGH_COS, i], -st.modes[FEEDTHROUGH_SIN, i]) if n == 1 else rate


@kernel
def _put_harmonics(quantities):
    """Compute the harmonics of all rows from those of friction and modes."""
    st, spectrum, request = quantities.st, quantities.spectrum, quantities.request
    force = request.balance.inertia.shape[1]
    for n in range(spectrum.friction.size):
        for k in range(force):
            total = request.uncoupled.sliding[quantities.i, k] if n == 1 else 0j
            for i in range(st.n):
                total += request.outputs.free[k, i] * spectrum.modes[n, i]
                total += request.outputs.free[k, st.n + i] * _rate(st, spectrum, n, i)
            quantities.rows[k, n] = total
        quantities.rows[force, n] = spectrum.friction[n]
        total = 0j
        for i in range(st.n):
            total += st.modes[Z, i] * spectrum.modes[n, i]
            total += st.modes[Z_RATE, i] * _rate(st, spectrum, n, i)
        quantities.rows[force + 1, n] = total


@kernel
def _put_held(quantities):
    """Compute the harmonics of all rows with the contact held, without the position of the contact."""
    linear, i = quantities.request.linear, quantities.i
    force = linear.held.shape[1]
    for k in range(quantities.rows.shape[0]):
        for n in range(quantities.rows.shape[1]):
            quantities.rows[k, n] = 0j
    for k in range(force):
        quantities.rows[k, 1] = linear.held[i, k]
    quantities.rows[force, 1] = linear.force[i]


@kernel
def _extremes_of_one_harmonic(quantities):
    """Compute the extremes of a motion that equals its first harmonic."""
    force = quantities.request.balance.inertia.shape[1]
    for k in range(quantities.extremes.shape[0]):
        phasor = quantities.rows[k, 1] if k != force else _transmitted(quantities)
        quantities.extremes[k, VALUE], quantities.extremes[k, PHASE] = abs(phasor), _lag(phasor)
        quantities.extremes[k, PHASE_BEGIN], quantities.extremes[k, PHASE_END] = math.nan, math.nan


@kernel
def _store(quantities, m, j, beta, distance, damping):
    """Write the requested results of a cell, given its sliding distance and the work of its dampers."""
    request, out, i = quantities.request, quantities.request.out, quantities.i
    force = request.balance.inertia.shape[1]
    if out.extremes.size:
        _copy(quantities.extremes, out.extremes[m, i, j])
    if out.harmonics.size:
        _copy(quantities.rows, out.harmonics[m, i, j])
    if out.firsts.size:
        for k in range(quantities.rows.shape[0]):
            phasor = quantities.rows[k, 1] if k != force else _transmitted(quantities)
            out.firsts[m, i, j, k, MODULUS], out.firsts[m, i, j, k, LAG] = abs(phasor), _lag(phasor)
    if out.work_terms.size:
        balance, amplitude = request.balance, quantities.extremes[force + 1, VALUE]
        fed = balance.base_power[i] - balance.base_motion * quantities.rows[force, 1]
        for k in range(force):
            fed += balance.power[i, k] * quantities.rows[k, 1]
        work_terms = out.work_terms[m, i, j]
        work_terms[DISTANCE], work_terms[BY_FRICTION] = distance, beta * distance
        work_terms[BY_LOAD], work_terms[BY_DAMPING] = math.pi * fed.imag, damping
        square = math.pi * amplitude * amplitude
        work_terms[EQUIVALENT] = beta * distance / square if square > 0.0 else math.nan


@kernel
def _store_distortion(quantities, m, j, k, remainder):
    """Write rms value and distortion of a mass; `remainder` is the rms value without X_0 and X_1."""
    first = abs(quantities.rows[k, 1])
    out = quantities.request.out.distortions[m, quantities.i, j, k]
    out[RMS] = math.hypot(math.hypot(quantities.rows[k, 0].real, first / math.sqrt(2.0)), remainder)
    out[DISTORTION] = math.sqrt(2.0) * remainder / first if first > 0.0 else math.nan


@kernel
def _no_distortion(quantities, m, j):
    """Write rms values and zero distortion for a motion that equals its first harmonic."""
    for k in range(
        quantities.request.out.distortions.shape[3] if quantities.request.out.distortions.size else 0
    ):
        _store_distortion(quantities, m, j, k, 0.0)


@kernel
def _write_distortions(quantities, m, j, beta, table, halves):
    """Write rms values and distortions from a segment table that covers this many half periods."""
    request = quantities.request
    for k in range(request.out.distortions.shape[3] if request.out.distortions.size else 0):
        square = distortion_square(
            quantities.st, beta, request.outputs, request.uncoupled, quantities.i, k,
            quantities.rows[k, 0].real, quantities.rows[k, 1], table, quantities.work, quantities.scratch,
        )  # fmt: skip
        _store_distortion(quantities, m, j, k, math.sqrt(square / (math.pi * halves)))


@kernel
def stuck_quantities(quantities, m, j):
    """Write the quantities of a cell whose contact sticks; its static offset is not part of the vibration."""
    _put_held(quantities)
    _extremes_of_one_harmonic(quantities)
    _store(quantities, m, j, 0.0, 0.0, quantities.request.balance.damping_held[quantities.i])
    _no_distortion(quantities, m, j)


@kernel
def _find_extremes(quantities, beta, table):
    """Find the extremes of all requested rows but the contact's."""
    request = quantities.request
    if request.out.extremes.size and not (request.outputs.static_shape.size == 1 and request.wall_mass == 0):
        largest_moduli(
            quantities.st, beta, request.outputs, request.uncoupled, quantities.i, request.wall_mass, table,
            quantities.extremes, quantities.work, quantities.scratch,
        )  # fmt: skip
    if request.wall_mass >= 0:
        for column in range(FOUND):
            quantities.extremes[request.wall_mass, column] = quantities.extremes[
                quantities.extremes.shape[0] - 1, column
            ]


@kernel
def _viscous_work(quantities, beta, table, halves):
    """Work of the dampers per excitation cycle."""
    balance = quantities.request.balance
    if not quantities.request.out.work_terms.size:
        return 0.0
    total = balance.damping_uncoupled[quantities.i]
    if balance.damped:
        spent = viscous_work(quantities.st, beta, balance.dampers, table, quantities.work, quantities.scratch)
        total += 2.0 / halves * spent
    return total


@kernel
def continuous_quantities(quantities, m, j, beta):
    """Write the quantities of the continuous orbit."""
    orbit, i = quantities.orbit, quantities.i
    contact = quantities.extremes[quantities.extremes.shape[0] - 1]
    if not orbit.v_abs[i] < math.inf:
        _write_growing(quantities, m, j, beta)
        return
    if beta == 0.0:  # linear; u may be infinite
        harmonics_of_continuous(quantities.st, 0.0, 0.0, quantities.spectrum)
        _put_harmonics(quantities)
        _extremes_of_one_harmonic(quantities)
        damping = quantities.request.balance.damping_uncoupled[i] + _linear_damping(quantities)
        _store(quantities, m, j, 0.0, 4.0 * contact[VALUE], damping)
        _no_distortion(quantities, m, j)
        return
    phase = orbit_phase(orbit.v_abs[i], orbit.v_arg[i], orbit.u[i], beta)
    harmonics_of_continuous(quantities.st, beta, phase, quantities.spectrum)
    _put_harmonics(quantities)
    contact[VALUE] = continuous_amplitude(orbit.v_abs[i], orbit.u[i], orbit.g[i], beta)
    contact[PHASE] = turned_half(phase, 1.0)
    contact[PHASE_BEGIN], contact[PHASE_END] = math.nan, math.nan
    continuous_segment(quantities.st, orbit, i, beta, phase, quantities.table[0], quantities.work)
    _find_extremes(quantities, beta, quantities.table)
    _store(quantities, m, j, beta, 4.0 * contact[VALUE], _viscous_work(quantities, beta, quantities.table, 1))
    _write_distortions(quantities, m, j, beta, quantities.table, 1)


@kernel
def _linear_damping(quantities):
    """Work of the dampers per excitation cycle without friction."""
    st, dampers = quantities.st, quantities.request.balance.dampers
    total = 0.0
    for k in range(dampers.weights.size):
        moved = complex(dampers.base[k], 0.0)
        for i in range(st.n):
            moved += dampers.displacement[k, i] * quantities.spectrum.modes[1, i]
            moved += dampers.displacement[k, st.n + i] * _rate(st, quantities.spectrum, 1, i)
        size = abs(moved)
        total += dampers.weights[k] * st.r * math.pi * size * size
    return total


@kernel
def _unbounded(direction):
    """Infinity in the direction of a phasor; real or imaginary parts that are zero stay zero."""
    re = math.copysign(math.inf, direction.real) if direction.real != 0.0 else 0.0
    im = math.copysign(math.inf, direction.imag) if direction.imag != 0.0 else 0.0
    return complex(re, im)


@kernel
def _write_growing(quantities, m, j, beta):
    """Write the quantities at an undamped resonance: infinite amplitudes, with the phases that the growing
    motion approaches.
    """
    request, out, i = quantities.request, quantities.request.out, quantities.i
    directions = request.linear.growth[i]
    contact = directions.size - 1
    harmonics_of_continuous(quantities.st, beta, _lag(directions[contact]), quantities.spectrum)
    _put_harmonics(quantities)
    for k in range(directions.size):
        if k != contact - 1:
            quantities.rows[k, 1] = _unbounded(directions[k])
        if out.extremes.size:
            out.extremes[m, i, j, k, VALUE], out.extremes[m, i, j, k, PHASE] = math.inf, _lag(directions[k])
        if out.firsts.size:
            out.firsts[m, i, j, k, MODULUS], out.firsts[m, i, j, k, LAG] = math.inf, _lag(directions[k])
    if out.harmonics.size:
        _copy(quantities.rows, out.harmonics[m, i, j])
    if out.work_terms.size:
        work_terms = out.work_terms[m, i, j]
        work_terms[DISTANCE], work_terms[BY_LOAD] = math.inf, math.inf
        work_terms[BY_FRICTION] = math.inf if beta > 0.0 else 0.0
        work_terms[BY_DAMPING] = math.nan if request.balance.damped else request.balance.damping_uncoupled[i]
        work_terms[EQUIVALENT] = 0.0
    if out.distortions.size:
        for k in range(out.distortions.shape[3]):
            out.distortions[m, i, j, k, RMS], out.distortions[m, i, j, k, DISTORTION] = math.inf, 0.0


@entry
def periodic_quantities(quantities, m, j, beta, table):
    """Write the quantities of a periodic orbit from its segment table."""
    halves = harmonics_of_segments(quantities.st, beta, table, quantities.spectrum)
    _put_harmonics(quantities)
    largest_in_contact(table, quantities.extremes[quantities.extremes.shape[0] - 1])
    _find_extremes(quantities, beta, table)
    if full_period(halves) != 1:
        for k in range(quantities.extremes.shape[0]):
            for column in range(PHASE, FOUND):
                quantities.extremes[k, column] = math.nan
    distance = 2.0 / halves * sliding_distance(quantities.st, table, quantities.work)
    _store(quantities, m, j, beta, distance, _viscous_work(quantities, beta, table, halves))
    _write_distortions(quantities, m, j, beta, table, halves)

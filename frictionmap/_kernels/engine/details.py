"""What is asked for of steady states beyond their regime: amplitudes, multipliers, asymmetry.

All of it is read from their tables of phases.  Chosen by the class of `requested` (`kinds`): who asks for
nothing compiles nothing of it.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import entry, kernel
from ..kinds import by_class
from ..one_mass.sliding_orbit import orbit_phase
from ..structure.newton import Workspace, make_workspace
from ..structure.oscillators import Scratch, make_scratch
from ..structure.sliding_orbit import Continuous
from ..structure.state import Loads, Model, StructureAtFrequency, make_structure
from .extremes import FOUND, VALUE, OutputMatrices, UncoupledResponse, largest_moduli
from .floquet import asymmetry, continuous_multiplier, orbit_multiplier
from .measure import measure
from .policies import FINE_STEPS
from .records import known_orbit
from .segment_table import continuous_segment, segment_columns


class NotRequested(NamedTuple):
    """No details are asked for."""

    size: int


class Displacements(NamedTuple):
    """What the displacements of the masses are made of; arrays (n_r, n_dof)."""

    outputs: OutputMatrices
    uncoupled: UncoupledResponse
    held: np.ndarray  # phasor of the displacements with the contact held


class Details(NamedTuple):
    """Details over a map."""

    r: np.ndarray
    model: Model
    loads: Loads
    orbit: Continuous
    steps: float
    displacements: Displacements


class DetailsAtFrequency(NamedTuple):
    """Details at one frequency; at r = 0 nothing moves, and the structures are those of another."""

    i: int
    st: StructureAtFrequency
    fine: StructureAtFrequency
    orbit: Continuous
    displacements: Displacements
    extremes: np.ndarray  # (n_dof, FOUND) of a cell
    work: Workspace
    scratch: Scratch


@kernel
def _not_requested(requested, i):
    return requested


@entry
def _details_at(requested, i):
    r = requested.r[i] if requested.r[i] > 0.0 else 1.0
    st = make_structure(requested.model, requested.loads, i, r, requested.steps)
    fine = make_structure(requested.model, requested.loads, i, r, max(requested.steps, FINE_STEPS))
    work, scratch = make_workspace(st.n), make_scratch(st.n)
    extremes = np.empty((requested.displacements.held.shape[1], FOUND))
    return DetailsAtFrequency(i, st, fine, requested.orbit, requested.displacements, extremes, work, scratch)


@kernel
def _no_stuck(details, out, m, i, j, z):
    pass


@kernel
def _stuck(details, out, m, i, j, z):
    """Where the contact is held at z: the masses swing about where that puts them."""
    displacements = details.displacements
    for mass in range(out.amplitude.shape[3]):
        offset = abs(displacements.outputs.static_shape[mass] * z)
        out.amplitude[m, i, j, mass] = abs(displacements.held[i, mass]) + offset


@kernel
def _no_continuous(details, out, m, i, j, beta, mu_beta):
    pass


@entry
def _continuous(details, out, m, i, j, beta, mu_beta):
    """Of the continuous orbit."""
    fine, orbit, work, scratch = details.fine, details.orbit, details.work, details.scratch
    if not orbit.v_abs[i] < math.inf:
        if out.asymmetry.size:
            out.asymmetry[m, i, j] = 0.0
        if out.amplitude.size:
            out.amplitude[m, i, j, :] = math.inf
        return
    if out.asymmetry.size:
        out.asymmetry[m, i, j] = 0.0
    if out.multiplier.size:
        out.multiplier[m, i, j] = continuous_multiplier(fine, orbit, i, beta, mu_beta, work, scratch)
    if out.amplitude.size:
        table = np.empty((1, segment_columns(fine.n)))
        phase = orbit_phase(orbit.v_abs[i], orbit.v_arg[i], orbit.u[i], beta)
        continuous_segment(fine, orbit, i, beta, phase, table[0], work)
        _masses(details, out, m, i, j, beta, table)


@entry
def _masses(details, out, m, i, j, beta, table):
    """Amplitudes of the masses."""
    parts, found = details.displacements, details.extremes
    largest_moduli(
        details.st, beta, parts.outputs, parts.uncoupled, details.i, -1, table, found, details.work,
        details.scratch,
    )  # fmt: skip
    out.amplitude[m, i, j] = found[:, VALUE]


@kernel
def _no_orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Nothing; see `write_orbit_details` for its arguments."""


@entry
def _orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Of a periodic orbit, whose table of phases is written first; see `write_orbit_details` for its arguments."""
    st, work, scratch = details.st, details.work, details.scratch
    table = np.empty((2 * found.slides, segment_columns(st.n)))
    orbit = known_orbit(found.contact_state, found.event, found.sign, found.slides)
    table = table[: measure(motion, contact, orbit, table).segments]
    if out.multiplier.size:
        out.multiplier[m, i, j] = orbit_multiplier(st, beta, mu_beta, table, work, scratch)
    if out.asymmetry.size:
        out.asymmetry[m, i, j] = asymmetry(st, beta, table, amplitude, work, scratch)
    if out.amplitude.size:
        _masses(details, out, m, i, j, beta, table)


@by_class((NotRequested, _not_requested), (Details, _details_at))
def details_at(requested, i):
    """The details at the i-th frequency."""


@by_class((NotRequested, _no_stuck), (DetailsAtFrequency, _stuck))
def write_stuck_details(details, out, m, i, j, z):
    """Write those of a cell whose contact sticks at z."""


@by_class((NotRequested, _no_continuous), (DetailsAtFrequency, _continuous))
def write_continuous_details(details, out, m, i, j, beta, mu_beta):
    """Write those of a cell on the continuous orbit."""


@by_class((NotRequested, _no_orbit), (DetailsAtFrequency, _orbit))
def write_orbit_details(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Write those of a cell on the periodic orbit that was found.

    Eleven arguments: the cell's friction is told in units of the map, the contact's in those of the motion.
    """

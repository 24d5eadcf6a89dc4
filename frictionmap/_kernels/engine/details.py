"""Details of steady states requested beyond the basic outputs: amplitudes of the masses, multipliers,
asymmetry.

All of them are read from the segment table.  The implementation is chosen by the class of `requested`
(`by_class`): nothing is compiled for details that are not requested.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import by_class, entry, kernel
from ..continuous_motion import orbit_phase
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
    """Placeholder for details or quantities that are not requested."""

    size: int


class Displacements(NamedTuple):
    """Matrices and phasors that give the displacements of the masses."""

    outputs: OutputMatrices
    uncoupled: UncoupledResponse
    held: np.ndarray  # displacement phasors with the contact held


class Details(NamedTuple):
    """Data for the details over a whole map."""

    r: np.ndarray
    model: Model
    loads: Loads
    orbit: Continuous
    steps: float
    displacements: Displacements


class DetailsAtFrequency(NamedTuple):
    """Data for the details at one frequency; at r = 0 a placeholder (r = 1) that is never read."""

    i: int
    st: StructureAtFrequency
    fine: StructureAtFrequency
    orbit: Continuous
    displacements: Displacements
    extremes: np.ndarray  # (n_dof, FOUND) work array for one cell
    work: Workspace
    scratch: Scratch


@kernel
def _not_requested(requested, i):
    """Return the placeholder itself."""
    return requested


@entry
def _details_at(requested, i):
    """Build the data for the i-th frequency."""
    r = requested.r[i] if requested.r[i] > 0.0 else 1.0
    st = make_structure(requested.model, requested.loads, i, r, requested.steps)
    fine = make_structure(requested.model, requested.loads, i, r, max(requested.steps, FINE_STEPS))
    work, scratch = make_workspace(st.n), make_scratch(st.n)
    extremes = np.empty((requested.displacements.held.shape[1], FOUND))
    return DetailsAtFrequency(i, st, fine, requested.orbit, requested.displacements, extremes, work, scratch)


@kernel
def _no_stuck(details, out, m, i, j):
    """Write nothing."""
    pass


@kernel
def _stuck(details, out, m, i, j):
    """Write the amplitudes with the contact held; its static offset is not part of the vibration."""
    for mass in range(out.amplitude.shape[3]):
        out.amplitude[m, i, j, mass] = abs(details.displacements.held[i, mass])


@kernel
def _no_continuous(details, out, m, i, j, beta, mu_beta):
    """Write nothing.

    Parameters
    ----------
    details, out, m, i, j, beta, mu_beta : see `write_continuous_details`
    """
    pass


@entry
def _continuous(details, out, m, i, j, beta, mu_beta):
    """Write the details of the continuous orbit.

    Parameters
    ----------
    details, out, m, i, j, beta, mu_beta : see `write_continuous_details`
    """
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
    """Write the amplitudes of the masses.

    Parameters
    ----------
    details : DetailsAtFrequency
    out : named tuple of output arrays
    m, i, j : indices of mu, r and beta
    beta : kinetic friction force
    table : (segments, columns) segment table
    """
    parts, found = details.displacements, details.extremes
    largest_moduli(
        details.st, beta, parts.outputs, parts.uncoupled, details.i, -1, table, found, details.work,
        details.scratch,
    )  # fmt: skip
    out.amplitude[m, i, j] = found[:, VALUE]


@kernel
def _no_orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Write nothing.

    Parameters
    ----------
    details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude : see `write_orbit_details`
    """


@entry
def _orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Write the details of a periodic orbit from its segment table.

    Parameters
    ----------
    details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude : see `write_orbit_details`
    """
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
    """Build the data for the details at the i-th frequency."""


@by_class((NotRequested, _no_stuck), (DetailsAtFrequency, _stuck))
def write_stuck_details(details, out, m, i, j):
    """Write the details of a cell whose contact sticks."""


@by_class((NotRequested, _no_continuous), (DetailsAtFrequency, _continuous))
def write_continuous_details(details, out, m, i, j, beta, mu_beta):
    """Write the details of a cell on the continuous orbit.

    Parameters
    ----------
    details : DetailsAtFrequency or NotRequested
    out : named tuple of output arrays
    m, i, j : indices of mu, r and beta
    beta, mu_beta : kinetic and static friction force
    """


@by_class((NotRequested, _no_orbit), (DetailsAtFrequency, _orbit))
def write_orbit_details(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Write the details of a cell on a periodic orbit.

    Parameters
    ----------
    details : DetailsAtFrequency or NotRequested
    motion : a kind of motion, at the anchor of the orbit
    contact : Contact, in the units of the motion
    found : Cell
    out : named tuple of output arrays
    m, i, j : indices of mu, r and beta
    beta, mu_beta : kinetic and static friction force, in the units of the map
    amplitude : amplitude of z, in the units of the map
    """

"""Details of steady states requested beyond the basic outputs: amplitudes of the masses, multipliers,
asymmetry.

All of them are read from the segment table.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..continuous_motion import orbit_phase
from ..structure.newton import Workspace
from ..structure.oscillators import Scratch
from ..structure.sliding_orbit import Continuous
from ..structure.state import StructureAtFrequency, make_structure
from .extremes import FOUND, VALUE, OutputMatrices, UncoupledResponse, largest_moduli
from .floquet import asymmetry, continuous_multiplier, orbit_multiplier
from .policies import FINE_STEPS
from .segment_table import continuous_segment, segment_columns


class Displacements(NamedTuple):
    """Matrices and phasors that give the displacements of the masses."""

    outputs: OutputMatrices
    uncoupled: UncoupledResponse
    held: np.ndarray  # displacement phasors with the contact held


class DetailResults(NamedTuple):
    """Requested details over (mu, r, beta); arrays that are not requested have size 0."""

    amplitude: np.ndarray  # (..., masses)
    multiplier: np.ndarray
    asymmetry: np.ndarray


class Details(NamedTuple):
    """Data for the details over a whole map."""

    mu: np.ndarray
    displacements: Displacements
    out: DetailResults


class DetailsAtFrequency(NamedTuple):
    """Data for the details at one frequency."""

    i: int
    st: StructureAtFrequency
    fine: StructureAtFrequency
    orbit: Continuous
    request: Details
    extremes: np.ndarray  # (n_dof, FOUND) work array for one cell
    work: Workspace
    scratch: Scratch


@entry
def details_at(details, common, shared):
    """Build the data for one frequency; `common` and `shared` as in `further`."""
    steps = max(common.steps, FINE_STEPS)
    fine = make_structure(common.model, common.loads, shared.i, shared.r, steps)
    extremes = np.empty((details.displacements.held.shape[1], FOUND))
    return DetailsAtFrequency(
        shared.i, shared.st, fine, common.orbit, details, extremes, shared.work, shared.scratch
    )


@kernel
def stuck_details(details, m, j):
    """Write the amplitudes with the contact held; its static offset is not part of the vibration."""
    out, held = details.request.out, details.request.displacements.held
    for mass in range(out.amplitude.shape[3]):
        out.amplitude[m, details.i, j, mass] = abs(held[details.i, mass])


@entry
def continuous_details(details, m, j, beta):
    """Write the details of the continuous orbit."""
    fine, orbit, work, scratch, i = details.fine, details.orbit, details.work, details.scratch, details.i
    out = details.request.out
    if not orbit.v_abs[i] < math.inf:
        if out.asymmetry.size:
            out.asymmetry[m, i, j] = 0.0
        if out.amplitude.size:
            out.amplitude[m, i, j, :] = math.inf
        return
    if out.asymmetry.size:
        out.asymmetry[m, i, j] = 0.0
    if out.multiplier.size:
        mu_beta = details.request.mu[m] * beta
        out.multiplier[m, i, j] = continuous_multiplier(fine, orbit, i, beta, mu_beta, work, scratch)
    if out.amplitude.size:
        table = np.empty((1, segment_columns(fine.n)))
        phase = orbit_phase(orbit.v_abs[i], orbit.v_arg[i], orbit.u[i], beta)
        continuous_segment(fine, orbit, i, beta, phase, table[0], work)
        _masses(details, m, j, beta, table)


@entry
def _masses(details, m, j, beta, table):
    """Write the amplitudes of the masses from a segment table (segments, columns)."""
    parts, found = details.request.displacements, details.extremes
    largest_moduli(
        details.st, beta, parts.outputs, parts.uncoupled, details.i, -1, table, found, details.work,
        details.scratch,
    )  # fmt: skip
    details.request.out.amplitude[m, details.i, j] = found[:, VALUE]


@entry
def periodic_details(details, m, j, beta, table):
    """Write the details of a periodic orbit from its segment table."""
    st, work, scratch, i = details.st, details.work, details.scratch, details.i
    out = details.request.out
    if out.multiplier.size:
        mu_beta = details.request.mu[m] * beta
        out.multiplier[m, i, j] = orbit_multiplier(st, beta, mu_beta, table, work, scratch)
    if out.asymmetry.size:
        out.asymmetry[m, i, j] = asymmetry(st, beta, table, work, scratch)
    if out.amplitude.size:
        _masses(details, m, j, beta, table)

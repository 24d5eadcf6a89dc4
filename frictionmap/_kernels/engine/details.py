"""What is asked for of steady states beyond their regime: amplitudes, multipliers, asymmetry.

All of it is read from their tables of phases.  Chosen by the class of `wanted` (`by_class`): who asks for
nothing compiles nothing of it.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import by_class, entry, kernel
from ..one_mass.sliding_orbit import orbit_phase
from ..structure.newton import Workspace, make_workspace
from ..structure.oscillators import Scratch, make_scratch
from ..structure.sliding_orbit import Continuous
from ..structure.state import Loads, Model, Structure, make_structure
from .answers import known_orbit
from .extremes import FOUND, VALUE, Alone, Shapes, largest_moduli
from .floquet import asymmetry, continuous_multiplier, orbit_multiplier
from .measure import measure
from .phase_table import continuous_phase, phase_columns
from .policies import FINE_STEPS


class Nothing(NamedTuple):
    """No details are asked for."""

    size: int


class Displacements(NamedTuple):
    """What the displacements of the masses are made of; arrays (n_r, n_dof)."""

    shapes: Shapes
    alone: Alone
    held: np.ndarray  # phasor of the displacements with the contact held


class Details(NamedTuple):
    """Details over a map."""

    r: np.ndarray
    model: Model
    loads: Loads
    orbit: Continuous
    steps: float
    displacements: Displacements


class DetailsHere(NamedTuple):
    """Details at one frequency; at r = 0 nothing moves, and the structures are those of another."""

    i: int
    st: Structure
    fine: Structure
    orbit: Continuous
    displacements: Displacements
    extremes: np.ndarray  # (n_dof, FOUND) of a cell
    work: Workspace
    scratch: Scratch


@kernel
def _nothing_at(wanted, i):
    return wanted


@entry
def _details_at(wanted, i):
    r = wanted.r[i] if wanted.r[i] > 0.0 else 1.0
    st = make_structure(wanted.model, wanted.loads, i, r, wanted.steps)
    fine = make_structure(wanted.model, wanted.loads, i, r, max(wanted.steps, FINE_STEPS))
    work, scratch = make_workspace(st.n), make_scratch(st.n)
    extremes = np.empty((wanted.displacements.held.shape[1], FOUND))
    return DetailsHere(i, st, fine, wanted.orbit, wanted.displacements, extremes, work, scratch)


@kernel
def _no_stuck(details, out, m, i, j, z):
    pass


@kernel
def _stuck(details, out, m, i, j, z):
    """Where the contact is held at z: the masses swing about where that puts them."""
    displacements = details.displacements
    for mass in range(out.amplitude.shape[3]):
        offset = abs(displacements.shapes.static_shape[mass] * z)
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
        table = np.empty((1, phase_columns(fine.n)))
        phase = orbit_phase(orbit.v_abs[i], orbit.v_arg[i], orbit.u[i], beta)
        continuous_phase(fine, orbit, i, beta, phase, table[0], work)
        _masses(details, out, m, i, j, beta, table)


@entry
def _masses(details, out, m, i, j, beta, table):
    """Amplitudes of the masses."""
    parts, found = details.displacements, details.extremes
    largest_moduli(
        details.st, beta, parts.shapes, parts.alone, details.i, -1, table, found, details.work,
        details.scratch,
    )  # fmt: skip
    out.amplitude[m, i, j] = found[:, VALUE]


@kernel
def _no_orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Nothing; see `note_orbit` for its arguments."""


@entry
def _orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Of a periodic orbit, whose table of phases is written first; see `note_orbit` for its arguments."""
    st, work, scratch = details.st, details.work, details.scratch
    table = np.empty((2 * found.slides, phase_columns(st.n)))
    orbit = known_orbit(found.at, found.event, found.sign, found.slides)
    table = table[: measure(motion, contact, orbit, table).phases]
    if out.multiplier.size:
        out.multiplier[m, i, j] = orbit_multiplier(st, beta, mu_beta, table, work, scratch)
    if out.asymmetry.size:
        out.asymmetry[m, i, j] = asymmetry(st, beta, table, amplitude, work, scratch)
    if out.amplitude.size:
        _masses(details, out, m, i, j, beta, table)


@by_class((Nothing, _nothing_at), (Details, _details_at))
def details_at(wanted, i):
    """The details at the i-th frequency."""


@by_class((Nothing, _no_stuck), (DetailsHere, _stuck))
def note_stuck(details, out, m, i, j, z):
    """Write those of a cell whose contact sticks at z."""


@by_class((Nothing, _no_continuous), (DetailsHere, _continuous))
def note_continuous(details, out, m, i, j, beta, mu_beta):
    """Write those of a cell on the continuous orbit."""


@by_class((Nothing, _no_orbit), (DetailsHere, _orbit))
def note_orbit(details, motion, contact, found, out, m, i, j, beta, mu_beta, amplitude):
    """Write those of a cell on the periodic orbit that was found.

    Eleven arguments: the cell's friction is told in units of the map, the contact's in those of the motion.
    """

"""Records passed to and returned by the solver, in the units of force and displacement of the motion."""

import math
from typing import NamedTuple

from ...regimes import (
    CLOSED_FORM,
    CONTINUOUS,
    INTEGRATED,
    IRREGULAR,
    MARGINAL,
    NOT_REACHED,
    PERMANENT_STICKING,
    QUASI_STATIC,
    RESOLVED,
    STICK_SLIP,
    UNRESOLVED,
)
from ..compiler import kernel
from ..event_codes import REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from .periods import full_period

#: A stop shorter than this (in tau) counts as a turn without a stop: its duration is rounding error, about
#: 1e-15 for the load phase of one mass and up to 1e-13 for a sum over many modes.
SHORTEST_STOP = 1e-12

TURN = 2.0 * math.pi


class Limits(NamedTuple):
    """Limits of the solver, constant over a map."""

    cycles: float
    tolerance: float
    newton: bool  # solve for the periodic orbit; False: march until the motion recurs
    steps: float  # largest number of scan steps of a motion, including the search for its orbit


class Contact(NamedTuple):
    """Friction of the contact of one cell."""

    b: float  # kinetic friction
    mu_b: float  # static friction
    b_lim: float  # boundary of b to continuous motion
    unique: bool  # mu = 1: the steady state does not depend on the initial state


class ContactState(NamedTuple):
    """State at the contact; the modal coordinates of a structure are in the `state` of its motion."""

    z: float  # contact displacement
    w: float  # change of z per scan step; 0 at an anchor
    cos: float  # of the load phase
    sin: float
    contact_force: float  # contact force less the friction


class Orbit(NamedTuple):
    """Result of the search for a periodic orbit."""

    found: bool
    contact_state: ContactState  # at its anchor, the start of an upward slide
    event: int  # event that ended the preceding slide
    sign: float  # -1.0 where the anchor is the mirror image of the true motion
    slides: int  # slides per recurrence, or a multiple of that
    certain: bool  # whether the motion is known to approach this orbit; if False the caller must check
    contraction: float  # largest modulus of the multipliers of one recurrence, < 1; NaN where `certain`


class Cell(NamedTuple):
    """Steady state of one cell."""

    regime: int
    status: int
    origin: int
    stops: float  # per excitation period
    amplitude: float
    stuck: float  # share of the steady period
    period: int  # excitation periods
    cycles: float  # excitation periods followed
    contact_state: ContactState  # at the anchor of the steady state, or where the contact sticks
    event: int  # event that ended the slide before the anchor
    sign: float  # -1.0 where the anchor is the mirror image of the true motion
    slides: int  # slides per recurrence; 0 where stuck and for the closed form
    stops_error: float  # standard errors of averages; 0 of a steady state
    stuck_error: float


@kernel
def undefined_state():
    """Return a contact state of NaN."""
    nan = math.nan
    return ContactState(nan, nan, nan, nan, nan)


@kernel
def no_orbit():
    """Return the `Orbit` of a failed search."""
    return Orbit(False, undefined_state(), REVERSE, 1.0, 0, True, math.nan)


@kernel
def known_orbit(contact_state, event, sign, slides):
    """Return the `Orbit` of an anchor that the motion has already reached."""
    return Orbit(True, contact_state, event, sign, slides, True, math.nan)


@kernel
def stops_at(event):
    """Whether an event is a stop that ends."""
    return event == STOP_THEN_BACK or event == STOP_THEN_ON


@kernel
def turns_at(event):
    """Whether the motion reverses at an event, so that the slide that follows is mirrored."""
    return event == REVERSE or event == STOP_THEN_BACK


@kernel
def plain_cell(regime, status, origin, stops, amplitude, stuck, period, cycles):
    """Build a cell without an anchor; the error of an average that is NaN is NaN, too, and that of others 0.

    Parameters
    ----------
    regime, status, origin : codes of `regimes`
    stops : stops per excitation period
    amplitude : amplitude of z
    stuck : share of the steady period that the contact is stuck
    period : steady period [excitation periods]; 0 if unknown
    cycles : excitation periods followed
    """
    return Cell(
        regime, status, origin, stops, amplitude, stuck, period, cycles, undefined_state(), REVERSE, 1.0, 0,
        0.0 * stops, 0.0 * stuck,
    )  # fmt: skip


@kernel
def unresolved(status, time):
    """Build an unresolved cell, whose motion was followed over `time` in tau."""
    nan = math.nan
    return plain_cell(UNRESOLVED, status, INTEGRATED, nan, nan, nan, 0, time / TURN)


@kernel
def stuck_cell(origin, status, time, z, sign):
    """Build a cell whose contact sticks permanently at z."""
    nan = math.nan
    contact_state = ContactState(z, 0.0, nan, nan, nan)
    return Cell(
        PERMANENT_STICKING, status, origin, nan, 0.0, 1.0, 1, time / TURN, contact_state, REVERSE, sign, 0,
        nan, 0.0,
    )  # fmt: skip


@kernel
def continuous_cell(amplitude, marginal, origin, time):
    """Build a cell in continuous motion, from the closed form."""
    status = MARGINAL if marginal else RESOLVED
    return plain_cell(CONTINUOUS, status, origin, 0.0, amplitude, 0.0, 1, time / TURN)


@kernel
def quasi_static_cell():
    """Build a cell at r = 0 between the boundaries: stick-slip whose number of stops has no limit."""
    nan = math.nan
    return plain_cell(STICK_SLIP, QUASI_STATIC, CLOSED_FORM, nan, nan, nan, 0, 0.0)


@kernel
def periodic_cell(measured, stops, orbit, origin, time):
    """Build the cell of a periodic orbit, which recurs as itself or as its mirror image."""
    halves = measured.halves
    if halves < 1:
        return unresolved(NOT_REACHED, time)
    regime = STICK_SLIP if stops > 0 else CONTINUOUS
    return Cell(
        regime, RESOLVED, origin, 2.0 * stops / halves, measured.amplitude, measured.stuck,
        full_period(halves), time / TURN, orbit.contact_state, orbit.event, orbit.sign, measured.slides, 0.0,
        0.0,
    )  # fmt: skip


@kernel
def irregular_cell(averages, time):
    """Build the stick-slip cell of a motion that did not return while it was followed, from its averages.

    The cell is unresolved if the motion was followed for less than a period or did not stop.
    """
    if not averages.stops.value > 0.0:
        return unresolved(NOT_REACHED, time)
    return Cell(
        STICK_SLIP, IRREGULAR, INTEGRATED, averages.stops.value, averages.largest, averages.stuck.value, 0,
        time / TURN, undefined_state(), REVERSE, 1.0, 0, averages.stops.error, averages.stuck.error,
    )  # fmt: skip

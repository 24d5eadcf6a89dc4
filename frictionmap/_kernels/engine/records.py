"""What the driver takes and gives.  Forces and displacements are those of the kind of motion (`motion`)."""

import math
from typing import NamedTuple

from ...regimes import (
    CLOSED_FORM,
    CONTINUOUS,
    INTEGRATED,
    MARGINAL,
    NOT_PERIODIC,
    NOT_REACHED,
    PERMANENT_STICKING,
    QUASI_STATIC,
    RESOLVED,
    STICK_SLIP,
    UNRESOLVED,
)
from ..jit import kernel
from ..one_mass.events import REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from ..one_mass.newton import full_period

#: A stop shorter than this (in tau) is a grazing of no duration, told from none by rounding: that of one
#: mass's load phase is some 1e-15, of the sum over many modes up to 1e-13.
SHORTEST_STOP = 1e-12

TURN = 2.0 * math.pi


class Limits(NamedTuple):
    """When to give up; constant over a sweep."""

    cycles: float
    tolerance: float
    newton: bool  # solve for the periodic orbit instead of waiting for it


class Contact(NamedTuple):
    """The contact of one cell."""

    b: float  # kinetic friction
    mu_b: float  # static friction
    b_lim: float  # boundary of b to continuous motion
    unique: bool  # mu = 1: there is one steady state, whatever the start


class ContactState(NamedTuple):
    """Where a motion is, as far as numbers tell; a structure's modes are in its `state`."""

    z: float  # displacement in the contact
    w: float  # its change per scan step; 0 at an anchor
    cos: float  # of the load's phase
    sin: float
    contact_force: float  # force in the contact, friction taken off


class Orbit(NamedTuple):
    """What the search for a periodic orbit found."""

    found: bool
    contact_state: ContactState  # its anchor, the start of an upward slide
    event: int  # which ended the slide before
    sign: float  # -1.0 where that is the mirror image of the true motion
    slides: int  # until it returns, or a multiple of that
    certain: bool  # whether the motion that it was looked for from goes there; else that is to be seen
    contraction: float  # largest modulus of the multipliers of a return, < 1; not told where it is certain


class Cell(NamedTuple):
    """The steady state of one cell."""

    regime: int
    status: int
    origin: int
    stops: float  # per excitation period
    amplitude: float
    stuck: float  # share of the steady period
    period: int  # excitation periods
    cycles: float  # excitation periods followed
    contact_state: ContactState  # anchor from which the steady state starts over, or place where it sticks
    event: int  # which ended the slide before
    sign: float  # -1.0 where that is the mirror image of the true motion
    slides: int  # until it returns; 0 where stuck and for the closed form


@kernel
def undefined_state():
    """A moment that is none."""
    nan = math.nan
    return ContactState(nan, nan, nan, nan, nan)


@kernel
def no_orbit():
    """A search that failed."""
    return Orbit(False, undefined_state(), REVERSE, 1.0, 0, True, math.nan)


@kernel
def known_orbit(contact_state, event, sign, slides):
    """The orbit of an anchor that the motion is at already."""
    return Orbit(True, contact_state, event, sign, slides, True, math.nan)


@kernel
def stops_at(event):
    """Whether an event is a stop that ends."""
    return event == STOP_THEN_BACK or event == STOP_THEN_ON


@kernel
def turns_at(event):
    """Whether the motion goes back after an event: the slide that follows is a mirror image."""
    return event == REVERSE or event == STOP_THEN_BACK


@kernel
def plain_cell(regime, status, origin, stops, amplitude, stuck, period, cycles):
    """A cell with no anchor."""
    return Cell(
        regime, status, origin, stops, amplitude, stuck, period, cycles, undefined_state(), REVERSE, 1.0, 0
    )


@kernel
def unresolved(status, time):
    """Followed over `time` in vain."""
    nan = math.nan
    return plain_cell(UNRESOLVED, status, INTEGRATED, nan, nan, nan, 0, time / TURN)


@kernel
def stuck_cell(origin, status, time, z, sign):
    """Permanent sticking at z."""
    nan = math.nan
    contact_state = ContactState(z, 0.0, nan, nan, nan)
    return Cell(
        PERMANENT_STICKING, status, origin, nan, 0.0, 1.0, 1, time / TURN, contact_state, REVERSE, sign, 0
    )


@kernel
def continuous_cell(amplitude, marginal, origin, time):
    """Continuous motion, by the closed form."""
    status = MARGINAL if marginal else RESOLVED
    return plain_cell(CONTINUOUS, status, origin, 0.0, amplitude, 0.0, 1, time / TURN)


@kernel
def quasi_static_cell():
    """r = 0 between the boundaries: stick-slip whose number of stops has no limit."""
    nan = math.nan
    return plain_cell(STICK_SLIP, QUASI_STATIC, CLOSED_FORM, nan, nan, nan, 0, 0.0)


@kernel
def periodic_cell(measured, stops, orbit, origin, time):
    """A steady state that returns, as its mirror image if need be, as `measured` says."""
    halves = measured.halves
    if halves < 1:
        return unresolved(NOT_REACHED, time)
    regime = STICK_SLIP if stops > 0 else CONTINUOUS
    return Cell(
        regime, RESOLVED, origin, 2.0 * stops / halves, measured.amplitude, measured.stuck,
        full_period(halves), time / TURN, orbit.contact_state, orbit.event, orbit.sign, measured.slides,
    )  # fmt: skip


@kernel
def averaged_cell(windows, time, end):
    """Stick-slip that does not repeat, by what it did in the last whole window and the one under way.

    A motion that was left before its end, or did not stop at all in that time, is not decided.
    """
    last, now = windows.last, windows.now
    stops = last.stops + now.stops
    if stops == 0 or time < end:
        return unresolved(NOT_REACHED, time)
    measured = time - last.opened
    return plain_cell(
        STICK_SLIP, NOT_PERIODIC, INTEGRATED, stops * TURN / measured, max(last.largest, now.largest),
        (last.stuck + now.stuck) / measured, 0, time / TURN,
    )  # fmt: skip

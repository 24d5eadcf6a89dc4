"""The steady state of one cell: followed event by event, then solved as a periodic orbit.

Once the order of events repeats, Newton's method on the return map finishes in a few returns (`motion.seek`).
A motion that no longer stops approaches the continuous orbit of theory.md 2.  Two motions that both never
stick approach each other in the energy norm whatever mu is, so the approach is certain as soon as the
distance is less than that at which a stop is possible at all (`motion.stop_free`).
"""

import math
from typing import NamedTuple

from ...regimes import (
    INTEGRATED,
    MARGINAL,
    NOT_COMPUTED,
    PERIODIC_ORBIT,
    RESOLVED,
    TOO_MANY_EVENTS,
    UNRESOLVED,
)
from ..compiler import inner_kernel, kernel
from ..one_mass.events import GRAZING, NO_END, STUCK
from ..structure.events import NO_RELEASE
from .answers import (
    TURN,
    averaged_cell,
    continuous_cell,
    known_orbit,
    no_orbit,
    periodic_cell,
    stops_at,
    stuck_cell,
    turns_at,
    unresolved,
)
from .measure import certain_stops, measure
from .memory import Near, note_anchor, settled
from .motion import (
    after_turn,
    bring_back,
    creeps,
    distance_from,
    keep_state,
    lasting_vibration,
    note_state,
    off_continuous,
    seek,
    seek_nearby,
    slide_to_turn,
    stop_free,
)
from .policies import GOAL, NOW
from .returns import near_return
from .statistics import Windows, count_event, first_try, open_windows, put_off

#: Events per excitation period (over four scan steps, if that is less than 1) of a motion that only chatters.
_EVENTS_PER_CYCLE = 4096.0

#: Half periods of ever larger motion after which an undamped resonance counts as unbounded.
_GROWING = 64

#: Slides without a stop after which one that is not about the continuous orbit may be periodic.
_SLIDES_ON = 8

#: A motion this near to an orbit is there.
_ROUNDING = 1e-12

#: Slides at most to the next look at how far the continuous orbit is, and the share of those foretold.
_UNSEEN = 8.0
_FORETOLD = 0.75


class Trail(NamedTuple):
    """How a motion went so far."""

    time: float
    events: int
    sign: float  # -1.0 where the next slide is a mirror image
    slides: int  # since the last stop
    growing: int  # of these, the last ones each larger than the one before
    size: float  # of the last one
    windows: Windows


class Around(NamedTuple):
    """The continuous orbit that a motion may approach."""

    exists: bool
    amplitude: float
    phase: float
    radius: float  # no motion this near can stop


class Look(NamedTuple):
    """A look at how far from it a motion is."""

    arrived: bool
    distance: float
    events: int  # when that was
    due: int  # when the next look is


@inner_kernel
def _next_anchor(motion, contact, at, trail, moves, end, most_steps):
    """(event, z, moment, trail): a slide and what follows it; NO_END where that is not found."""
    time = trail.time
    if moves or trail.events > 0:
        steps, at = slide_to_turn(motion, contact, at, most_steps)
        if steps == NO_END:
            return NO_END, at.z, at, trail
        time += steps * motion.h
    z = at.z
    size = abs(z)
    event, at, wait = after_turn(motion, contact, at, end - time)
    sign = -trail.sign if turns_at(event) else trail.sign
    stopped = stops_at(event)
    windows = count_event(trail.windows, time, size, stopped, wait)
    column = trail.events % motion.memory.events.size
    if stopped:
        trail = Trail(time + wait, trail.events + 1, sign, 0, 0, size, windows)
    else:
        growing = trail.growing + 1 if size > trail.size else 0
        trail = Trail(time, trail.events + 1, sign, trail.slides + 1, growing, size, windows)
    note_anchor(motion.memory, column, event, at, trail.time, sign)
    note_state(motion, at, column)
    return event, z, at, trail


@kernel
def _around(motion, contact):
    """The continuous orbit of a cell, if there is one."""
    if not contact.b < contact.b_lim or math.isinf(motion.v_abs):
        return Around(False, 0.0, 0.0, 0.0)
    amplitude, phase, radius = stop_free(motion, contact)
    motion.scratch.left[0] -= TURN / motion.h  # about what that takes
    return Around(True, amplitude, phase, radius)


@kernel
def _look(motion, contact, around, at, trail, last, tolerance):
    """How far the continuous orbit is now, and when to look again: at the rate of approach, soon before."""
    distance, size = off_continuous(motion, contact, around.amplitude, around.phase, at)
    enough = max(around.radius, tolerance * size)
    if distance < around.radius or distance <= tolerance * size:
        return Look(True, distance, trail.events, 0)
    slides = trail.events - last.events
    soon = 1.0
    if slides < trail.slides and distance < last.distance:
        soon = _FORETOLD * slides * math.log(enough / distance) / math.log(distance / last.distance)
    soon = min(max(soon, 1.0), _UNSEEN)
    return Look(False, distance, trail.events, trail.events + int(soon))


@kernel
def _may_return(event, trail, around, unbounded):
    """Whether an anchor is one to look for returns at: a stop, or a turn where it no longer stops."""
    if event == GRAZING:
        return False
    return trail.slides == 0 or not (around.exists or unbounded or trail.slides < _SLIDES_ON)


@kernel
def _near(motion, contact, at, trail, tries, newton):
    """The nearest return; where a short one leads nowhere the closest is tried."""
    shortest = newton and tries.made % 2 == 0  # it is the better conditioned one
    near = near_return(motion, at, trail.events, contact.unique and newton, shortest)
    if trail.slides > 0 and trail.slides < 2 * near.lag:
        return Near(0, math.inf, 0)
    return near


@kernel
def _time_to_look(trail, look):
    """Whether to look now; the slide after a stop says nothing."""
    return (trail.slides > 1 or trail.events == trail.slides == 1) and (
        trail.slides == 2 or trail.events >= look.due
    )


@kernel
def _has_settled(near, last, tolerance):
    """Whether marching may end: two returns of one order of events, the rest of which is nothing."""
    if near.lag == 0 or near.lag != last.lag or near.distance > tolerance:
        return False
    return settled(near.distance, last.distance, tolerance)


@kernel
def _orbit_cell(motion, contact, orbit, origin, time):
    """The steady state that returns to the orbit's anchor after its number of slides, or sooner."""
    measured = measure(motion, contact, orbit, motion.no_table)
    return periodic_cell(measured, certain_stops(measured, contact), orbit, origin, time)


@kernel
def _goes_there(motion, contact, at, orbit, allowed):
    """Whether the motion, its state kept in NOW, goes to an orbit, whose state is kept in GOAL.

    A motion that passes by, or repeats in some multiple of the orbit's period, may be near it too.  What is
    heading there comes nearer with two returns in a row, each time about as fast as the orbit attracts.
    """
    bring_back(motion, NOW)
    stopped = stops_at(orbit.event)
    closer = 0.5 * (1.0 + orbit.contraction)
    before = math.inf
    slide = 0
    for last in range(0, 2 * orbit.slides + 1, orbit.slides):
        event = orbit.event
        while slide < last:
            steps, at = slide_to_turn(motion, contact, at, allowed / motion.h)
            if steps == NO_END:
                return False
            event, at, _ = after_turn(motion, contact, at, allowed)
            slide += 1
        if event != orbit.event:
            return False
        distance = distance_from(motion, GOAL, orbit.at, at, stopped)
        if not distance <= closer * before + _ROUNDING:
            return False
        before = distance
    return True


@kernel
def _seek(motion, contact, at, event, trail, near, tries, limits):
    """The periodic orbit that a motion goes to; if there is none, the motion stays where it is."""
    keep_state(motion, NOW)
    orbit = seek(motion, contact, at, event, trail.sign, trail.events, near, tries.made, limits)
    if orbit.certain:
        return orbit
    keep_state(motion, GOAL)
    if _goes_there(motion, contact, at, orbit, TURN * limits.cycles):
        bring_back(motion, GOAL)
        return orbit
    bring_back(motion, NOW)
    return no_orbit()


@kernel
def _follow(motion, contact, at, moves, limits, cancel):
    """The steady state reached from a moment, by following the motion."""
    end = TURN * limits.cycles
    most_steps = end / motion.h + 1.0
    most_events = _EVENTS_PER_CYCLE * limits.cycles * max(1.0, 0.25 / motion.h)
    wanders = lasting_vibration(motion)
    unbounded = math.isinf(motion.v_abs) and contact.b < contact.b_lim
    around = _around(motion, contact)
    look = Look(False, math.inf, 0, 0)
    trail = Trail(0.0, 0, 1.0, 0, 0, 0.0, open_windows(limits.cycles))
    tries = first_try()
    half = 0
    last = Near(0, math.inf, 0)
    while trail.time < end:
        if cancel[0] != 0:
            return unresolved(NOT_COMPUTED, trail.time)
        event, z, at, trail = _next_anchor(motion, contact, at, trail, moves, end, most_steps)
        if event == STUCK:
            status = MARGINAL if wanders else RESOLVED
            return stuck_cell(INTEGRATED, status, trail.time, z, trail.sign)
        if event == NO_END or event == NO_RELEASE:
            break
        if trail.events > most_events:
            return unresolved(TOO_MANY_EVENTS, trail.time)
        if contact.unique:
            creeping, z = creeps(motion, contact, trail.events)
            if creeping:
                return stuck_cell(INTEGRATED, RESOLVED, trail.time, z, trail.sign)
        if unbounded and trail.growing >= _GROWING:
            return continuous_cell(math.inf, False, INTEGRATED, trail.time)
        if around.exists and _time_to_look(trail, look):
            look = _look(motion, contact, around, at, trail, look, limits.tolerance)
            if look.arrived:
                return continuous_cell(around.amplitude, motion.marginal, INTEGRATED, trail.time)
        now = int(trail.time / math.pi)
        if now == half or not _may_return(event, trail, around, unbounded):
            continue  # once a half period is enough
        half = now
        if limits.newton and half < tries.due:
            continue
        near = _near(motion, contact, at, trail, tries, limits.newton)
        if limits.newton and (near.lag > 0 or contact.unique):
            orbit = _seek(motion, contact, at, event, trail, near, tries, limits)
            if orbit.found:
                return _orbit_cell(motion, contact, orbit, PERIODIC_ORBIT, trail.time)
            tries = put_off(tries, half)
        if not limits.newton:
            if _has_settled(near, last, limits.tolerance):
                orbit = known_orbit(at, event, trail.sign, near.lag)
                return _orbit_cell(motion, contact, orbit, INTEGRATED, trail.time)
            last = near
    if wanders or (motion.marginal and contact.b < contact.b_lim):
        return unresolved(MARGINAL, trail.time)
    return averaged_cell(trail.windows, trail.time, end)


@kernel
def steady_state(motion, contact, at, moves, limits, cancel):
    """The steady state of a cell, found within so many scan steps; else it is unresolved.

    Parameters
    ----------
    motion : a kind of motion, see `motion`; it becomes that of the anchor, where there is one
    contact : Contact; b > 0
    at : where it starts
    moves : whether it starts with a velocity; else with a turn
    limits : Limits
    cancel : (1,) set by another thread to end the work

    Returns
    -------
    Cell
    """
    motion.scratch.left[0] = limits.steps
    if contact.unique and limits.newton and contact.b >= contact.b_lim and not lasting_vibration(motion):
        orbit = seek_nearby(motion, contact, limits)
        if orbit.found:
            cell = _orbit_cell(motion, contact, orbit, PERIODIC_ORBIT, 0.0)
            if cell.regime != UNRESOLVED:
                return cell
    return _follow(motion, contact, at, moves, limits, cancel)

"""Steady state of one cell: follow the motion from event to event, then solve for the periodic orbit.

Once the sequence of events repeats, Newton's method on the return map converges in a few iterations
(`motion.seek`).  A motion that no longer stops approaches the continuous orbit of theory.md 2.  Two motions
that never stick approach each other in the energy norm for every mu; the approach is therefore certain once
the distance is below the radius within which no motion can stop (`motion.stop_free`).
"""

import math
from typing import NamedTuple

from ...regimes import (
    INTEGRATED,
    MARGINAL,
    NOT_COMPUTED,
    NOT_REACHED,
    PERIODIC_ORBIT,
    RESOLVED,
    TOO_MANY_EVENTS,
    UNRESOLVED,
)
from ..compiler import inner_kernel, kernel, late_kernel
from ..event_codes import GRAZING, NO_END, STUCK
from ..logs import clear_log
from ..long_periods import enough_cycles, first_search, next_search
from ..structure.events import NO_RELEASE
from .cycle_log import averages, first_averaged, log_event, log_stop
from .measure import measure, proven_stops
from .memory import Recurrence, record_anchor, relax_acceptance, reset_acceptance, settled
from .motion import (
    after_turn,
    creeps,
    distance_from,
    distance_from_continuous,
    lasting_vibration,
    record_state,
    restore_state,
    save_state,
    seek,
    seek_nearby,
    slide_to_turn,
    stop_free,
)
from .policies import GOAL, NOW
from .records import (
    TURN,
    Cell,
    continuous_cell,
    irregular_cell,
    known_orbit,
    no_orbit,
    periodic_cell,
    stops_at,
    stuck_cell,
    turns_at,
    unresolved,
)
from .recurrence import find_long_recurrence, find_recurrence
from .schedules import first_schedule, postpone

#: Events per excitation period (times one quarter over the scan step, if that exceeds 1) beyond which a
#: motion counts as chattering without end.
_EVENTS_PER_CYCLE = 4096.0

#: Successive slides of growing amplitude after which an undamped resonance counts as unbounded.
_GROWING = 64

#: Slides without a stop after which a motion away from the continuous orbit is also searched for recurrences.
_SLIDES_WITHOUT_STOP = 8

#: Relative distance from an orbit that is rounding error.
_ROUNDING = 1e-12

#: Time in tau after which a motion that has come near an orbit, but not well within the margin of its events,
#: is taken to approach it slowly: without this limit 40 more of 650,000 cells ended as irregular.
_LATE = 256.0 * TURN

#: Largest number of slides between two comparisons with the continuous orbit, and the share of the predicted
#: number of slides after which the next comparison is made.
_MOST_SLIDES_UNCHECKED = 8.0
_PREDICTED_SHARE = 0.75


class MotionHistory(NamedTuple):
    """Course of the motion up to the present anchor."""

    time: float
    events: int
    sign: float  # -1.0 where the next slide is mirrored
    slides: int  # since the last stop
    growing: int  # successive slides, each larger than the one before
    size: float  # displacement at the end of the last slide


class ContinuousOrbit(NamedTuple):
    """Continuous orbit that the motion may approach."""

    exists: bool
    amplitude: float
    phase: float
    radius: float  # no motion within this distance can stop


class OrbitCheck(NamedTuple):
    """Result of comparing the motion with the continuous orbit."""

    arrived: bool
    distance: float
    events: int  # number of events at this comparison
    due: int  # number of events at which the next one is made


@inner_kernel
def _next_anchor(motion, contact, contact_state, history, moves, logged, end, most_steps):
    """Follow one slide and what comes after it.

    Parameters
    ----------
    motion : a kind of motion
    contact : Contact
    contact_state : ContactState at the present anchor
    history : MotionHistory
    moves : whether the motion starts with a velocity
    logged : time in tau at which the log of events begins
    end : time in tau at which to give up
    most_steps : largest number of scan steps

    Returns
    -------
    (event, z, contact_state, history) : event code, or NO_END if it is not found; displacement at the end of
        the slide; the next anchor; the history up to it
    """
    time = history.time
    if moves or history.events > 0:
        steps, contact_state = slide_to_turn(motion, contact, contact_state, most_steps)
        if steps == NO_END:
            return NO_END, contact_state.z, contact_state, history
        time += steps * motion.h
    z = contact_state.z
    size = abs(z)
    event, contact_state, wait = after_turn(motion, contact, contact_state, end - time)
    sign = -history.sign if turns_at(event) else history.sign
    stopped = stops_at(event)
    if time + wait >= logged:
        log_event(motion.log, time, size, stopped, wait)
    if event == NO_RELEASE:  # within the time left
        log_stop(motion.log, time, end - time)
        time = end
    column = history.events % motion.memory.events.size
    if stopped:
        history = MotionHistory(time + wait, history.events + 1, sign, 0, 0, size)
    else:
        growing = history.growing + 1 if size > history.size else 0
        history = MotionHistory(time, history.events + 1, sign, history.slides + 1, growing, size)
    record_anchor(motion.memory, column, event, contact_state, history.time, sign)
    record_state(motion, contact_state, column)
    return event, z, contact_state, history


@kernel
def _continuous_orbit(motion, contact):
    """Find the continuous orbit of a cell, if it exists."""
    if not contact.b < contact.b_lim or math.isinf(motion.v_abs):
        return ContinuousOrbit(False, 0.0, 0.0, 0.0)
    amplitude, phase, radius = stop_free(motion, contact)
    motion.scratch.left[0] -= TURN / motion.h  # roughly the cost of `stop_free`
    return ContinuousOrbit(True, amplitude, phase, radius)


@kernel
def _check_approach(motion, contact, continuous, contact_state, history, last, tolerance):
    """Compare the motion with the continuous orbit, and schedule the next comparison from the rate of
    approach.

    Parameters
    ----------
    motion : a kind of motion
    contact : Contact
    continuous : ContinuousOrbit
    contact_state : ContactState at the present anchor
    history : MotionHistory
    last : OrbitCheck before this one
    tolerance : distance, relative to the motion, at which the orbit counts as reached

    Returns
    -------
    OrbitCheck
    """
    distance, size = distance_from_continuous(
        motion, contact, continuous.amplitude, continuous.phase, contact_state
    )
    enough = max(continuous.radius, tolerance * size)
    if distance < continuous.radius or distance <= tolerance * size:
        return OrbitCheck(True, distance, history.events, 0)
    slides = history.events - last.events
    soon = 1.0
    if slides < history.slides and distance < last.distance:
        soon = _PREDICTED_SHARE * slides * math.log(enough / distance) / math.log(distance / last.distance)
    soon = min(max(soon, 1.0), _MOST_SLIDES_UNCHECKED)
    return OrbitCheck(False, distance, history.events, history.events + int(soon))


@kernel
def _may_recur(event, history, continuous, unbounded):
    """Whether to look for recurrences at an anchor: at a stop, or at a turn if the motion no longer stops."""
    if event == GRAZING:
        return False
    return history.slides == 0 or not (
        continuous.exists or unbounded or history.slides < _SLIDES_WITHOUT_STOP
    )


@kernel
def _nearest_recurrence(motion, contact, contact_state, history, schedule, newton):
    """Find the nearest recurrence; if the shortest one led to no orbit, the closest one is tried."""
    if history.time > _LATE:
        relax_acceptance(motion.memory)
    shortest = newton and schedule.made % 2 == 0  # the shortest is better conditioned
    recurrence = find_recurrence(motion, contact_state, history.events, contact.unique and newton, shortest)
    if history.slides > 0 and history.slides < 2 * recurrence.lag:
        return Recurrence(0, math.inf, 0)
    return recurrence


@kernel
def _check_is_due(history, check):
    """Whether to compare with the continuous orbit now; the first slide after a stop is not informative."""
    return (history.slides > 1 or history.events == history.slides == 1) and (
        history.slides == 2 or history.events >= check.due
    )


@kernel
def _has_settled(recurrence, last, tolerance):
    """Whether marching may end: two recurrences with the same event sequence whose extrapolated remainder is
    below tolerance.
    """
    if recurrence.lag == 0 or recurrence.lag != last.lag or recurrence.distance > tolerance:
        return False
    return settled(recurrence.distance, last.distance, tolerance)


@kernel
def _orbit_cell(motion, contact, orbit, origin, time):
    """Build the cell of an orbit that returns to its anchor after at most its number of slides."""
    measured = measure(motion, contact, orbit, motion.no_table)
    return periodic_cell(measured, proven_stops(measured, contact), orbit, origin, time)


@late_kernel(Cell)
def _marched_cell(motion, contact, contact_state, event, history, lag):
    """Build the cell of the orbit that the motion has reached, which returns after `lag` slides."""
    orbit = known_orbit(contact_state, event, history.sign, lag)
    return _orbit_cell(motion, contact, orbit, INTEGRATED, history.time)


@late_kernel(bool)
def _approaches(motion, contact, contact_state, orbit, allowed):
    """Whether the motion, its state saved in NOW, approaches an orbit, whose state is saved in GOAL.

    A motion that merely passes by, or whose period is a multiple of the orbit's, may also be close to it.  A
    motion that approaches the orbit comes closer with two successive recurrences, each time at about the rate
    at which the orbit attracts.
    """
    restore_state(motion, NOW)
    stopped = stops_at(orbit.event)
    closer = 0.5 * (1.0 + orbit.contraction)
    before = math.inf
    slide = 0
    for last in range(0, 2 * orbit.slides + 1, orbit.slides):
        event = orbit.event
        while slide < last:
            steps, contact_state = slide_to_turn(motion, contact, contact_state, allowed / motion.h)
            if steps == NO_END:
                return False
            event, contact_state, _ = after_turn(motion, contact, contact_state, allowed)
            slide += 1
        if event != orbit.event:
            return False
        distance = distance_from(motion, GOAL, orbit.contact_state, contact_state, stopped)
        if not distance <= closer * before + _ROUNDING:
            return False
        before = distance
    return True


@kernel
def _seek(motion, contact, contact_state, event, history, recurrence, schedule, limits):
    """Find the periodic orbit that the motion approaches; without one, the state of the motion is left
    unchanged.

    Parameters
    ----------
    motion : a kind of motion
    contact : Contact
    contact_state : ContactState at the present anchor
    event : event that ended the slide before it
    history : MotionHistory
    recurrence : Recurrence of the present anchor
    schedule : NewtonSchedule
    limits : Limits

    Returns
    -------
    Orbit
    """
    save_state(motion, NOW)
    orbit = seek(
        motion, contact, contact_state, event, history.sign, history.events, recurrence, schedule.made, limits
    )
    if orbit.certain:
        return orbit
    save_state(motion, GOAL)
    if _approaches(motion, contact, contact_state, orbit, TURN * limits.cycles):
        restore_state(motion, GOAL)
        return orbit
    restore_state(motion, NOW)
    return no_orbit()


@kernel
def _is_marginal(motion, contact):
    """Whether there is a continuum of steady states, or a vibration that lasts in a stop."""
    return lasting_vibration(motion) or (motion.marginal and contact.b < contact.b_lim)


@late_kernel(Cell)
def _long_search(motion, contact, contact_state, event, history, schedule, limits):
    """Find the orbit of a long period that the motion is on, or recognise that it is irregular.

    Parameters
    ----------
    motion, contact, contact_state, event, history, schedule, limits : see `_seek`

    Returns
    -------
    Cell : unresolved where the motion is to be followed further
    """
    recurrence = find_long_recurrence(motion, contact_state, history.events)
    if recurrence.lag > 0:
        orbit = _seek(motion, contact, contact_state, event, history, recurrence, schedule, limits)
        if orbit.found:
            return _orbit_cell(motion, contact, orbit, PERIODIC_ORBIT, history.time)
    enough = TURN * enough_cycles(limits.cycles)
    if history.time >= enough and not _is_marginal(motion, contact):
        found = averages(motion.log, history.time)
        if found.stationary or history.time >= 2.0 * enough:
            return irregular_cell(found, history.time)
    return unresolved(NOT_REACHED, history.time)


@late_kernel(Cell)
def _unfinished(motion, contact, time, end):
    """Build the cell of a motion followed up to `time` in vain; `end`: the time allowed, both in tau."""
    if _is_marginal(motion, contact):
        return unresolved(MARGINAL, time)
    if time < end:
        return unresolved(NOT_REACHED, time)
    return irregular_cell(averages(motion.log, time), time)


@kernel
def _forget(motion):
    """Forget the motion before."""
    clear_log(motion.log)
    reset_acceptance(motion.memory)


@kernel
def _follow(motion, contact, contact_state, moves, limits, cancel):
    """Follow the motion from a contact state to the steady state."""
    end, logged = TURN * limits.cycles, first_averaged(limits.cycles)
    most_steps = end / motion.h + 1.0
    most_events = _EVENTS_PER_CYCLE * limits.cycles * max(1.0, 0.25 / motion.h)
    vibrates = lasting_vibration(motion)
    unbounded = math.isinf(motion.v_abs) and contact.b < contact.b_lim
    continuous = _continuous_orbit(motion, contact)
    _forget(motion)
    check = OrbitCheck(False, math.inf, 0, 0)
    history = MotionHistory(0.0, 0, 1.0, 0, 0, 0.0)
    schedule = first_schedule()
    half = 0
    search = first_search()
    last = Recurrence(0, math.inf, 0)
    while history.time < end:
        if cancel[0] != 0:
            return unresolved(NOT_COMPUTED, history.time)
        event, z, contact_state, history = _next_anchor(
            motion, contact, contact_state, history, moves, logged, end, most_steps
        )
        if event == STUCK:
            return stuck_cell(INTEGRATED, MARGINAL if vibrates else RESOLVED, history.time, z, history.sign)
        if event == NO_END or event == NO_RELEASE:
            break
        if history.events > most_events:
            return unresolved(TOO_MANY_EVENTS, history.time)
        if contact.unique:
            creeping, z = creeps(motion, contact, history.events)
            if creeping:
                return stuck_cell(INTEGRATED, RESOLVED, history.time, z, history.sign)
        if unbounded and history.growing >= _GROWING:
            return continuous_cell(math.inf, False, INTEGRATED, history.time)
        if continuous.exists and _check_is_due(history, check):
            check = _check_approach(
                motion, contact, continuous, contact_state, history, check, limits.tolerance
            )
            if check.arrived:
                return continuous_cell(continuous.amplitude, motion.marginal, INTEGRATED, history.time)
        now = int(history.time / math.pi)
        if now == half or not _may_recur(event, history, continuous, unbounded):
            continue  # one search per half period is enough
        half = now
        if now >= search and limits.newton and not contact.unique:
            cell = _long_search(motion, contact, contact_state, event, history, schedule, limits)
            if cell.regime != UNRESOLVED:
                return cell
            search = next_search(now)
        if limits.newton and half < schedule.due:
            continue
        recurrence = _nearest_recurrence(motion, contact, contact_state, history, schedule, limits.newton)
        if limits.newton and (recurrence.lag > 0 or contact.unique):
            orbit = _seek(motion, contact, contact_state, event, history, recurrence, schedule, limits)
            if orbit.found:
                return _orbit_cell(motion, contact, orbit, PERIODIC_ORBIT, history.time)
            schedule = postpone(schedule, half)
        if not limits.newton:
            if _has_settled(recurrence, last, limits.tolerance):
                return _marched_cell(motion, contact, contact_state, event, history, recurrence.lag)
            last = recurrence
    return _unfinished(motion, contact, history.time, end)


@kernel
def steady_state(motion, contact, contact_state, moves, limits, cancel):
    """Find the steady state of a cell; it is unresolved if `limits` are exceeded first.

    Parameters
    ----------
    motion : a kind of motion, see `motion`; afterwards it is at the anchor of the steady state, if there is
        one
    contact : Contact; b > 0
    contact_state : ContactState of the initial state
    moves : whether the initial state has a velocity; otherwise it is an anchor
    limits : Limits
    cancel : (1,) set by another thread to end the computation

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
    return _follow(motion, contact, contact_state, moves, limits, cancel)

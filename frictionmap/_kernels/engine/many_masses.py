"""A structure as a kind of motion: all its modes, with the contact sliding and held.

At a stop of one mass only the displacement is left of the state; the other modes of a structure keep moving.
Anchors are therefore compared, and solved for, with the whole state (`structure.newton`).
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..continuous_motion import continuous_amplitude, orbit_phase
from ..event_codes import NO_END, STOP_THEN_BACK, EventSequence
from ..logs import make_log
from ..long_periods import RETURNED_AFTER_LONG
from ..spectral_radius import contracts
from ..structure.event_margin import event_margin
from ..structure.events import UNDER_WAY, after_slide, slide_on
from ..structure.newton import (
    BETA,
    EARLIER_BETA,
    HALVES,
    PHASE_COS,
    PHASE_SIN,
    SIDE,
    SLIDES,
    Workspace,
    copy_state,
    follow_events,
    make_workspace,
    newton_step,
    solve_return,
)
from ..structure.oscillators import FELL, Scratch, make_scratch, make_state, padded
from ..structure.sliding_orbit import Continuous, make_wave, orbit_state, stop_free_radius
from ..structure.state import (
    Loads,
    Model,
    StructureAtFrequency,
    W,
    contact_displacement,
    energy,
    hold,
    make_structure,
    release_steady,
    vibrates_in_step,
)
from .cycle_log import LOGGED
from .memory import CLOSER, SHARE, STATE, Memory, Recurrence, make_memory, turned
from .policies import FINE_STEPS, SLOTS
from .records import TURN, Contact, ContactState, known_orbit, no_orbit, turns_at, undefined_state
from .segment_table import put_state

#: Largest distance of the load phases of a recurrence, also where any state may be used as first guess.
_NEAR_PHASE = 0.3

#: An orbit with a slide longer than this (in tau) is not solved for; the motion is followed to it instead.
_LONGEST_SLIDE = 8.0 * math.pi

#: Largest number of event sequences tried from a neighbour's orbit.
_MOST_ORDERS = 8

#: Recurrence distance, relative to the motion, below which Newton's method is tried.
_RECURRENCE_THRESHOLD = 0.01

#: Largest extrapolation along the line through the last two orbits, in units of their distance in beta.
_FURTHEST = 2.0

#: Two anchors closer than this are the same; ten times the value for one mass, because sums over many modes
#: round more.
_SAME = 1e-8


class Starts(NamedTuple):
    """Initial states at every r: coordinates and velocities in t = tau/r of the free oscillators, and the
    load phase.
    """

    coordinates: np.ndarray  # (n_r, n)
    velocity: np.ndarray  # (n_r, n)
    cos: np.ndarray  # (n_r,)
    sin: np.ndarray


class ManyMassSystem(NamedTuple):
    """A structure over a whole map."""

    r: np.ndarray
    model: Model
    loads: Loads
    orbit: Continuous
    marginal: np.ndarray  # (n_r,) bool
    rest: Starts
    moving: Starts
    steps: float  # scan steps per period of the fastest part of the motion
    lim: np.ndarray  # (n_mu, n_r) boundary of beta to continuous motion
    modes: int  # n


class ManyMasses(NamedTuple):
    """A structure at one frequency."""

    h: float  # scan step in tau
    r: float
    load: float  # unit of force and displacement, 1
    v_abs: float
    marginal: bool  # whether the continuous motions form a continuum
    recurrence_threshold: float
    i: int  # index of the frequency
    st: StructureAtFrequency
    wave: np.ndarray  # see `structure.sliding_orbit`
    orbit: Continuous
    state: np.ndarray  # (2, padded(n)) present state of the free oscillators
    kept: np.ndarray  # (SLOTS, 2, padded(n)) saved states
    memory: Memory
    log: np.ndarray  # see `cycle_log`
    work: Workspace
    scratch: Scratch
    no_table: np.ndarray  # (0, 0)


@entry
def at_frequency(system, i):
    """Build the motion of the structure at the i-th frequency, r > 0."""
    r = system.r[i]
    st = make_structure(system.model, system.loads, i, r, system.steps)
    n = st.n
    return ManyMasses(
        st.h, r, 1.0, system.orbit.v_abs[i], system.marginal[i], _RECURRENCE_THRESHOLD, i,
        st, make_wave(st.h, max(1.0, FINE_STEPS / system.steps)), system.orbit, make_state(n),
        np.zeros((SLOTS, 2, padded(n))), make_memory(st.h, 2 * n),
        make_log(LOGGED), make_workspace(n), make_scratch(n), np.empty((0, 0)),
    )  # fmt: skip


@kernel
def contact_at(system, m, i, beta, mu):
    """Build the contact of a cell."""
    return Contact(beta, mu * beta, system.lim[m, i], mu == 1.0)


@kernel
def start(motion, system, i, contact, moving):
    """Set the initial state, see `single/kernel_data`."""
    st, state = motion.st, motion.state
    starts = system.moving if moving else system.rest
    for j in range(st.n):
        state[0, j] = starts.coordinates[i, j]
        state[1, j] = starts.velocity[i, j] / st.rate
    return ContactState(
        contact_displacement(st, state, starts.cos[i], starts.sin[i]), 0.0, starts.cos[i], starts.sin[i],
        UNDER_WAY,
    )  # fmt: skip


@inner_kernel
def slide_to_turn(motion, contact, contact_state, allowed):
    """See `motion.slide_to_turn`."""
    steps, end, c, s, _ = slide_on(
        motion.st, contact.b, contact_state.contact_force, motion.state, contact_state.cos, contact_state.sin,
        allowed, motion.scratch,
    )  # fmt: skip
    done = steps if end == FELL else float(NO_END)
    return done, ContactState(contact_displacement(motion.st, motion.state, c, s), 0.0, c, s, 0.0)


@inner_kernel
def after_turn(motion, contact, contact_state, allowed):
    """See `motion.after_turn`."""
    event, c, s, contact_force, wait, _, _ = after_slide(
        motion.st, contact.b, contact.mu_b, motion.state, motion.work.held, contact_state.cos,
        contact_state.sin, allowed, motion.scratch,
    )  # fmt: skip
    z = -contact_state.z if turns_at(event) else contact_state.z
    return event, ContactState(z, 0.0, c, s, contact_force), wait


@kernel
def lasting_vibration(motion):
    """See `motion.lasting_vibration`."""
    return vibrates_in_step(motion.st)


@kernel
def stop_free(motion, contact):
    """See `motion.stop_free`."""
    orbit, i = motion.orbit, motion.i
    v_abs, u, b = orbit.v_abs[i], orbit.u[i], contact.b
    amplitude = continuous_amplitude(v_abs, u, orbit.g[i], b)
    phase = orbit_phase(v_abs, orbit.v_arg[i], u, b)
    radius = stop_free_radius(motion.st, orbit, i, b, contact.mu_b, phase, motion.wave)
    return amplitude, phase, radius


@kernel
def distance_from_continuous(motion, contact, amplitude, phase, contact_state):
    """See `motion.distance_from_continuous`."""
    st, state, moved = motion.st, motion.state, motion.work.moved
    orbit_state(st, motion.orbit, motion.i, contact.b, phase, contact_state.cos, contact_state.sin, moved)
    for j in range(st.n):
        moved[0, j] -= state[0, j]
        moved[1, j] -= state[1, j]
    return energy(st, moved), energy(st, state)


@kernel
def record_state(motion, contact_state, column):
    """See `motion.record_state`."""
    n = motion.st.n
    row = motion.memory.anchors[column]
    for i in range(n):
        row[STATE + i] = motion.state[0, i]
        row[STATE + n + i] = motion.state[1, i]


@kernel
def motion_size(motion, contact_state):
    """See `motion.motion_size`."""
    return energy(motion.st, motion.state)


@kernel
def recurrence_distance(motion, now, then, size, most):
    """See `motion.recurrence_distance`."""
    turn = turned(motion.memory, now, then)
    if turn > _NEAR_PHASE:
        return math.inf
    if turn > most:
        return turn
    st = motion.st
    one, other = motion.memory.anchors[now], motion.memory.anchors[then]
    far = 2.0 * (most * size / st.norm) ** 2  # well beyond `most`, so that rounding decides nothing
    total = 0.0
    for i in range(st.n):
        z = one[STATE + i] - other[STATE + i]
        v = one[STATE + st.n + i] - other[STATE + st.n + i]
        total += (st.modes[W, i] * z) ** 2 + (st.rate * v) ** 2
        if total > far:
            break
    return turn + st.norm * math.sqrt(total) / size


@kernel
def creeps(motion, contact, events):
    """See `motion.creeps`: `wait_for_release` detects creeping itself."""
    return False, 0.0


@kernel
def _keep_orbit(work, n, b, anchored, halves, sign, slides):
    """Save the orbit in work.middle as the first guess of the next cell, and the previous one for
    extrapolation.

    The previous orbit is kept only if it is anchored at the same load phase, sign, number of slides and of
    half periods; see `_nearest`.

    Parameters
    ----------
    work : Workspace
    n : number of free oscillators
    b : kinetic friction force of the orbit
    anchored : ContactState whose load phase the orbit is anchored at
    halves : half periods per recurrence
    sign : -1.0 where the slide is mirrored, else 1.0
    slides : slides per recurrence
    """
    kept = work.anchored
    alike = kept[HALVES] == halves and kept[SIDE] == sign and kept[SLIDES] == slides
    alike = alike and kept[PHASE_COS] == anchored.cos and kept[PHASE_SIN] == anchored.sin
    copy_state(work.solved, work.earlier, n)
    copy_state(work.middle, work.solved, n)
    kept[EARLIER_BETA] = kept[BETA] if alike else math.nan
    kept[HALVES], kept[SIDE], kept[SLIDES], kept[BETA] = halves, sign, slides, b
    kept[PHASE_COS], kept[PHASE_SIN] = anchored.cos, anchored.sin


@kernel
def _expect(work, n, b):
    """Extrapolate the state in work.middle to friction b from the last two orbits, or copy the last one."""
    kept = work.anchored
    copy_state(work.solved, work.middle, n)
    share = (b - kept[BETA]) / (kept[BETA] - kept[EARLIER_BETA])
    if abs(share) <= _FURTHEST:  # it is NaN if there is no line
        for i in range(n):
            work.middle[0, i] += share * (work.solved[0, i] - work.earlier[0, i])
            work.middle[1, i] += share * (work.solved[1, i] - work.earlier[1, i])


@kernel
def _converge(motion, contact, anchored, sign, sequence, recurrence, limits):
    """Solve for a periodic orbit by Newton's method, and follow it to its next anchor.

    The unknown, work.middle, is the state within a slide at the load phase of `anchored`.

    Parameters
    ----------
    motion : ManyMasses; its state becomes that of the orbit at the anchor that follows
    contact : Contact
    anchored : ContactState of the unknown
    sign : -1.0 where that slide is mirrored, else 1.0
    sequence : EventSequence of one recurrence
    recurrence : Recurrence; its `halves` are the half periods of one recurrence
    limits : Limits

    Returns
    -------
    Orbit
    """
    st, work = motion.st, motion.work
    b, mu_b, halves = contact.b, contact.mu_b, recurrence.halves
    copy_state(work.middle, work.start, st.n)
    if not solve_return(
        st, b, mu_b, anchored.cos, anchored.sin, sequence, halves, limits.tolerance, work,
        motion.scratch,
    ):  # fmt: skip
        return no_orbit()
    if not contact.unique and not _attracts(motion, contact, anchored, sequence, recurrence):
        return no_orbit()
    copy_state(work.middle, motion.state, st.n)
    steps, contact_state = slide_to_turn(motion, contact, anchored, _LONGEST_SLIDE / st.h)
    if steps == NO_END:
        return no_orbit()
    event, contact_state, _ = after_turn(motion, contact, contact_state, TURN * limits.cycles)
    _keep_orbit(work, st.n, b, anchored, halves, sign, sequence.count)
    return known_orbit(contact_state, event, -sign if turns_at(event) else sign, sequence.count)


@kernel
def _attracts(motion, contact, anchored, sequence, recurrence):
    """Whether the orbit in work.middle, solved for last, is stable, and the motion in work.start so close to
    it that it keeps the orbit's events on its way there.

    A motion may come near a stable orbit and leave it, as an event changes before it arrives.  Where that is
    possible, a recurrence is asked for that is so much closer.
    """
    st, work, memory, n = motion.st, motion.work, motion.memory, motion.st.n
    if recurrence.distance > RETURNED_AFTER_LONG:
        for i in range(n):
            work.moved[0, i] = work.middle[0, i] - work.start[0, i]
            work.moved[1, i] = work.middle[1, i] - work.start[1, i]
        distance = energy(st, work.moved)
        copy_state(work.middle, work.moved, n)
        margin = event_margin(
            st, contact.b, contact.mu_b, work.moved, anchored.cos, anchored.sin, sequence.count, work,
            motion.scratch,
        )  # fmt: skip
        if not distance <= memory.wanted[SHARE] * margin:
            closer = memory.wanted[SHARE] * margin / distance
            memory.wanted[CLOSER] = max(closer * recurrence.distance, RETURNED_AFTER_LONG)
            return False
    # the derivative is that of the last Newton step, at most one step away from the orbit
    return contracts(work.flow, 2 * n, work.square)


@kernel
def _from_anchor(motion, contact, contact_state, sign, sequence, recurrence, limits):
    """Apply `_converge` from the middle of the slide that starts at an anchor.

    Parameters
    ----------
    motion : ManyMasses, at the anchor
    contact : Contact
    contact_state : ContactState at the anchor
    sign, sequence, recurrence, limits : see `_converge`
    """
    st, work, b = motion.st, motion.work, contact.b
    copy_state(motion.state, work.middle, st.n)
    most = _LONGEST_SLIDE / st.h
    steps, end, _, _, _ = slide_on(
        st, b, contact_state.contact_force, motion.state, contact_state.cos, contact_state.sin, most,
        motion.scratch,
    )  # fmt: skip
    if end != FELL:
        return no_orbit()
    _, _, c, s, _ = slide_on(
        st, b, contact_state.contact_force, work.middle, contact_state.cos, contact_state.sin, 0.5 * steps,
        motion.scratch,
    )  # fmt: skip
    middle = ContactState(0.0, 0.0, c, s, UNDER_WAY)
    return _converge(motion, contact, middle, sign, sequence, recurrence, limits)


@kernel
def seek(motion, contact, contact_state, event, sign, events, recurrence, failures, limits):
    """See `motion.seek`.

    Just below beta_stick the motion creeps for thousands of periods towards an orbit that slides very little
    out of the held motion; where the steady state is unique, that orbit is tried as well.

    Parameters
    ----------
    motion, contact, contact_state, event, sign, events, recurrence, failures, limits : see `motion.seek`
    """
    st, work = motion.st, motion.work
    copy_state(motion.state, work.anchor, st.n)
    sequence = EventSequence(motion.memory.events, np.int64(events - recurrence.lag), recurrence.lag)
    if recurrence.lag == 0 or (contact.unique and failures % 3 == 2):
        starts, c, s = release_steady(st, contact.mu_b, work.held, motion.state)
        contact_state = ContactState(0.0, 0.0, c, s, contact.mu_b - contact.b)
        work.events[0] = STOP_THEN_BACK
        sequence = EventSequence(work.events, np.int64(0), 1 if starts else 0)
        recurrence, sign = Recurrence(0, recurrence.distance, 1), 1.0
    orbit = no_orbit()
    if sequence.count > 0:
        orbit = _from_anchor(motion, contact, contact_state, sign, sequence, recurrence, limits)
    if not orbit.found:
        copy_state(work.anchor, motion.state, st.n)
    return orbit


@kernel
def forget_neighbour(motion):
    """See `motion.forget_neighbour`."""
    motion.work.anchored[HALVES] = 0.0


@kernel
def _nearest(motion, contact):
    """Set work.middle to the first guess of the orbit, and return (found, contact_state, sign, half periods).

    The guess is extrapolated from the last cells, if they were solved for; otherwise it is the continuous
    orbit at the boundary where its velocity first touches zero.
    """
    work, orbit, i, b = motion.work, motion.orbit, motion.i, contact.b
    halves = int(work.anchored[HALVES])
    if halves > 0:
        _expect(work, motion.st.n, b)
        contact_state = ContactState(0.0, 0.0, work.anchored[PHASE_COS], work.anchored[PHASE_SIN], UNDER_WAY)
        return True, contact_state, work.anchored[SIDE], halves
    if math.isinf(motion.v_abs) or not b * abs(orbit.u[i]) < motion.v_abs:
        return False, undefined_state(), 1.0, 0
    phase = orbit_phase(motion.v_abs, orbit.v_arg[i], orbit.u[i], b)
    # in the middle of the rising half
    contact_state = ContactState(0.0, 0.0, math.sin(phase), -math.cos(phase), UNDER_WAY)
    orbit_state(motion.st, orbit, i, b, phase, contact_state.cos, contact_state.sin, work.middle)
    return True, contact_state, 1.0, 1


@kernel
def seek_nearby(motion, contact, limits):
    """See `motion.seek_nearby`: Newton's method with the event sequence that follows each guess, which may
    change on the way.
    """
    st, work, scratch = motion.st, motion.work, motion.scratch
    b, mu_b = contact.b, contact.mu_b
    found, contact_state, sign, halves = _nearest(motion, contact)
    if not found:
        return no_orbit()
    copy_state(motion.state, work.anchor, st.n)
    for _ in range(_MOST_ORDERS):
        copy_state(work.middle, work.moved, st.n)
        slides = follow_events(
            st, b, mu_b, work.moved, contact_state.cos, contact_state.sin, halves, work, scratch
        )
        if slides == 0:
            break
        sequence = EventSequence(work.events, np.int64(0), slides)
        copy_state(work.middle, work.trial, st.n)
        orbit = _converge(motion, contact, contact_state, sign, sequence, Recurrence(0, 0.0, halves), limits)
        if orbit.found:
            return orbit
        # the event sequence changes on the way: take one Newton step with this one, then follow the motion
        # again
        copy_state(work.trial, work.middle, st.n)
        move, _ = newton_step(
            st, b, mu_b, contact_state.cos, contact_state.sin, sequence, halves, work, scratch
        )
        if not move < math.inf:
            break
        for j in range(st.n):
            work.middle[0, j] += work.moved[0, j]
            work.middle[1, j] += work.moved[1, j]
    work.anchored[HALVES] = 0.0
    copy_state(work.anchor, motion.state, st.n)
    return no_orbit()


@kernel
def save_state(motion, slot):
    """See `motion.save_state`."""
    copy_state(motion.state, motion.kept[slot], motion.st.n)


@kernel
def restore_state(motion, slot):
    """See `motion.restore_state`."""
    copy_state(motion.kept[slot], motion.state, motion.st.n)


@kernel
def distance_from(motion, slot, saved, contact_state, stopped):
    """See `motion.distance_from`."""
    st, state, moved, kept = motion.st, motion.state, motion.work.moved, motion.kept[slot]
    for i in range(st.n):
        moved[0, i] = state[0, i] - kept[0, i]
        moved[1, i] = state[1, i] - kept[1, i]
    return (
        abs(contact_state.cos - saved.cos)
        + abs(contact_state.sin - saved.sin)
        + energy(st, moved) / energy(st, kept)
    )


@kernel
def has_returned(motion, slot, saved, contact_state):
    """See `motion.has_returned`."""
    return distance_from(motion, slot, saved, contact_state, False) <= _SAME


@kernel
def on_continuous(motion, contact):
    """See `motion.on_continuous`."""
    orbit, i = motion.orbit, motion.i
    phase = orbit_phase(motion.v_abs, orbit.v_arg[i], orbit.u[i], contact.b)
    c, s = -math.cos(phase), -math.sin(phase)
    orbit_state(motion.st, orbit, i, contact.b, phase, c, s, motion.state)
    return ContactState(contact_displacement(motion.st, motion.state, c, s), 0.0, c, s, UNDER_WAY)


@kernel
def put_slide(motion, contact_state, row):
    """See `motion.put_slide`."""
    put_state(motion.state, motion.st.n, motion.st.rate, contact_state.cos, contact_state.sin, row)


@kernel
def put_stop(motion, contact_state, row):
    """See `motion.put_stop`."""
    st, held = motion.st, motion.work.held
    hold(st, motion.state, contact_state.z, contact_state.cos, contact_state.sin, held)
    put_state(held, st.m, st.rate, contact_state.cos, contact_state.sin, row)

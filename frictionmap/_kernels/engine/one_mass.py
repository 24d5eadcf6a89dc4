"""One mass as a kind of motion: the normalised oscillator of `one_mass.scan_step`.

At a stop only the displacement is left of the state, so the return map of a motion with stops has one unknown
(`one_mass.newton`).  Forces are divided by the amplitude of the load in the contact, and the load phase is
counted from the maximum of that load.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..continuous_motion import continuous_amplitude, orbit_phase
from ..event_codes import REVERSE, STOP_THEN_BACK, STOP_THEN_ON, EventSequence
from ..extrapolation import CELLS, reaches, weight
from ..logs import make_log
from ..one_mass.events import Scratch, after_slide, make_scratch, slide_within
from ..one_mass.newton import first_contact_force, solve_orbit
from ..one_mass.scan_step import Step, step_constants
from ..one_mass.sliding_orbit import Oscillator, distance_to_orbit, stop_free_radius
from .cycle_log import LOGGED
from .memory import STATE, Memory, make_memory, turned
from .policies import FINE_STEPS, MOVING_START, MOVING_START_CAP
from .records import Contact, ContactState, Orbit, known_orbit, no_orbit, stops_at
from .segment_table import put_mass

#: Columns of the orbits solved for last, which point to the next cell: slides per recurrence (0: no orbit),
#: sign at the end of a stop, how many orbits with these events are known, at most CELLS, their displacements
#: at the end of that stop and their friction, latest first, and the events, at most MOST_EVENTS.
COUNT, SIDE, KNOWN = 0, 1, 2
_DISPLACEMENTS, _FRICTION, FIRST = 3, 3 + CELLS, 3 + 2 * CELLS
MOST_EVENTS = 32
NEIGHBOUR = FIRST + MOST_EVENTS

#: Two anchors closer than this are the same: Newton's method may have converged to a repeated short orbit.
_SAME = 1e-9

#: Recurrence distance, relative to the motion, below which Newton's method is tried; `march` then checks with
#: two recurrences whether the motion approaches the orbit found.
_RECURRENCE_THRESHOLD = 0.1

#: Distance to an end of the range of sticking positions, over r^2, below which one slide reduces it by less
#: than a tenth.
_CREEPING = 0.02

#: A stop-free radius above this share of the amplitude is not refined with fine steps: the scan's own steps
#: underestimate it by about a sixth of that share.
_WIDE = 0.1

_BELOW_ONE = 0.9999999999999999  # the double before 1


class Frequencies(NamedTuple):
    """Quantities that depend on r only; arrays of shape (n_r,)."""

    r: np.ndarray
    load: np.ndarray  # amplitude A of the load in the contact
    phase: np.ndarray  # phase lead of that load over cos(tau)
    v_abs: np.ndarray
    v_arg: np.ndarray
    u: np.ndarray
    g: np.ndarray
    marginal: np.ndarray  # bool; see Oscillator


class OneMassSystem(NamedTuple):
    """A system of one mass over a whole map."""

    frequencies: Frequencies
    zeta: float
    steps: float  # scan steps per period of the fastest part of the motion
    lim: np.ndarray  # (n_mu, n_r) boundary of b to continuous motion
    stick: np.ndarray  # (n_mu, n_r) boundary of beta to permanent sticking
    modes: int  # 1
    chi: float  # participation factor of the mode in the contact, 1 or -1


class OneMass(NamedTuple):
    """One mass at one frequency."""

    h: float  # scan step in tau
    r: float
    load: float  # amplitude of the load in the contact
    lead: float  # phase lead of that load over cos(tau)
    chi: float
    v_abs: float
    marginal: bool  # whether the continuous motions form a continuum
    recurrence_threshold: float
    oscillator: Oscillator
    step: Step
    fine: Step  # a step at least as short, for bounds over a whole orbit
    memory: Memory
    log: np.ndarray  # see `cycle_log`
    scratch: Scratch
    neighbour: np.ndarray  # (NEIGHBOUR,)
    no_table: np.ndarray  # (0, 0)


@entry
def at_frequency(system, i):
    """Build the motion of the mass at the i-th frequency, r > 0."""
    f = system.frequencies
    r = f.r[i]
    oscillator = Oscillator(r, system.zeta, f.v_abs[i], f.v_arg[i], f.u[i], f.g[i], f.marginal[i])
    step = step_constants(r, system.zeta, system.steps)
    return OneMass(
        step.h, r, f.load[i], f.phase[i], system.chi, f.v_abs[i], f.marginal[i], _RECURRENCE_THRESHOLD,
        oscillator, step,
        step_constants(r, system.zeta, max(system.steps, FINE_STEPS)),
        make_memory(step.h, 1), make_log(LOGGED), make_scratch(), np.zeros(NEIGHBOUR), np.empty((0, 0)),
    )  # fmt: skip


@kernel
def contact_at(system, m, i, beta, mu):
    """Build the contact of a cell.

    The division by the load amplitude rounds.  Where beta equals beta_stick it could contradict the
    comparison made by the closed form; that comparison, made on beta, decides here too.
    """
    b = beta / system.frequencies.load[i]
    mu_b = mu * b
    sticks = beta >= system.stick[m, i]
    if (mu_b >= 1.0) != sticks:
        mu_b = 1.0 if sticks else _BELOW_ONE
        b = mu_b / mu
    return Contact(b, mu_b, system.lim[m, i], mu == 1.0)


@kernel
def start(motion, system, i, contact, moving):
    """Return the initial state.

    At rest: z = z' = 0 at tau = 0.  Moving: z = 0 with 1.5 times the speed that has the energy amplitude of
    the response without friction, that amplitude limited to 10, while the load falls through zero.
    """
    if not moving:
        c, s = math.cos(motion.lead), math.sin(motion.lead)
        return ContactState(0.0, 0.0, c, s, c - contact.b)
    oscillator = motion.oscillator
    size = MOVING_START * min(oscillator.v_abs, MOVING_START_CAP) * max(1.0, oscillator.r)
    speed = size / oscillator.r
    contact_force = -contact.b - 2.0 * oscillator.zeta * oscillator.r * speed
    return ContactState(0.0, speed * motion.h, 0.0, 1.0, contact_force)


@inner_kernel
def slide_to_turn(motion, contact, contact_state, allowed):
    """See `motion.slide_to_turn`."""
    step = motion.step
    steps, z, c, s = slide_within(
        step, contact.b, contact_state.z, contact_state.w, step.stiffness * contact_state.contact_force,
        contact_state.cos, contact_state.sin, allowed, motion.scratch,
    )  # fmt: skip
    return steps, ContactState(z, 0.0, c, s, 0.0)


@inner_kernel
def after_turn(motion, contact, contact_state, allowed):
    """See `motion.after_turn`."""
    event, z, c, s, contact_force, wait = after_slide(
        contact.b, contact.mu_b, contact_state.z, contact_state.cos, contact_state.sin
    )
    return event, ContactState(z, 0.0, c, s, contact_force), wait


@kernel
def lasting_vibration(motion):
    """See `motion.lasting_vibration`: a stop leaves no velocity."""
    return False


@kernel
def stop_free(motion, contact):
    """See `motion.stop_free`."""
    f = motion.oscillator
    amplitude = continuous_amplitude(f.v_abs, f.u, f.g, contact.b)
    phase = orbit_phase(f.v_abs, f.v_arg, f.u, contact.b)
    radius = stop_free_radius(motion.step, f, contact.b, contact.mu_b, amplitude, phase)
    if not radius > _WIDE * amplitude:
        radius = stop_free_radius(motion.fine, f, contact.b, contact.mu_b, amplitude, phase)
    return amplitude, phase, radius


@kernel
def distance_from_continuous(motion, contact, amplitude, phase, contact_state):
    """See `motion.distance_from_continuous`."""
    distance = distance_to_orbit(
        motion.oscillator, contact.b, amplitude, phase, contact_state.z, contact_state.cos, contact_state.sin
    )
    return distance, amplitude


@inner_kernel
def record_state(motion, contact_state, column):
    """See `motion.record_state`."""
    motion.memory.anchors[column, STATE] = contact_state.z


@kernel
def motion_size(motion, contact_state):
    """See `motion.motion_size`."""
    return abs(contact_state.z)


@kernel
def recurrence_distance(motion, now, then, size, most):
    """See `motion.recurrence_distance`; at a stop the load phase is a function of the displacement."""
    memory = motion.memory
    distance = abs(memory.anchors[now, STATE] - memory.anchors[then, STATE])
    turn = turned(memory, now, then) if memory.events[now] == REVERSE else 0.0
    return turn + distance / size if size > 0.0 else math.inf


@kernel
def creeps(motion, contact, events):
    """See `motion.creeps`: stops may creep to an end of |z| <= mu b - 1, where the contact sticks
    permanently.

    At a small distance y from that end a slide reduces y by about 4.5 y^2/r^2: the end is never passed, and
    never reached in finite time.
    """
    memory = motion.memory
    length = memory.events.size
    if not contact.mu_b >= 1.0 or events < 2:
        return False, 0.0
    now, then = (events - 1) % length, (events - 2) % length
    if memory.events[now] != STOP_THEN_ON or memory.events[then] != STOP_THEN_ON:
        return False, 0.0
    place = memory.anchors[now, STATE]
    end = contact.mu_b - 1.0
    far = abs(place) - end
    taken = abs(memory.anchors[then, STATE]) - abs(place)
    found = far < _CREEPING * motion.r * motion.r and 0.0 <= taken < 0.5 * far
    return found, math.copysign(end, place)


@kernel
def _middle(memory, events):
    """Mean displacement of the last two stops; NaN if there is no earlier stop."""
    length = memory.events.size
    now = events - 1
    for lag in range(1, min(events, length)):
        then = (now - lag) % length
        if stops_at(memory.events[then]):
            return 0.5 * (memory.anchors[now % length, STATE] + memory.anchors[then, STATE])
    return math.nan


@kernel
def seek(motion, contact, contact_state, event, sign, events, recurrence, failures, limits):
    """See `motion.seek`.

    The event sequence of the last recurrence is tried first, from the present state.  Close to a multiplier
    of -1 a motion stays asymmetric for thousands of periods, with an event sequence that the symmetric orbit
    between its two halves does not have.  Where the steady state is unique, any orbit found is the right one;
    the symmetric orbits with one or two stops per half period are then tried too.

    Parameters
    ----------
    motion, contact, contact_state, event, sign, events, recurrence, failures, limits : see `motion.seek`
    """
    if recurrence.lag == 0:
        return no_orbit()
    stopped = stops_at(event)
    guesses = 3 if contact.unique and event == STOP_THEN_BACK else 1
    start = contact_state.z
    for guess in range(guesses):
        slides = recurrence.lag
        if guess > 0:
            start = _middle(motion.memory, events)
            slides = guess
        found, z, c, s, contraction = solve_orbit(
            motion.step, motion.oscillator, contact.b, contact.mu_b, start, contact_state.cos,
            contact_state.sin, stopped, EventSequence(motion.memory.events, events - slides, slides),
            limits.tolerance, motion.scratch,
        )  # fmt: skip
        if found:
            if stopped:
                _keep(motion, contact.b, z, sign, events, slides)
            contact_force = first_contact_force(contact.b, contact.mu_b, z, c)
            return Orbit(
                True, ContactState(z, 0.0, c, s, contact_force), event, sign, slides, contact.unique,
                contraction,
            )  # fmt: skip
    return no_orbit()


@kernel
def _remember(neighbour, b, z):
    """Add an orbit with the events of the last ones, its displacement at the end of a stop."""
    known = int(min(neighbour[KNOWN] + 1.0, float(CELLS)))
    for first in (_DISPLACEMENTS, _FRICTION):
        for k in range(known - 1, 0, -1):
            neighbour[first + k] = neighbour[first + k - 1]
    neighbour[KNOWN], neighbour[_DISPLACEMENTS], neighbour[_FRICTION] = known, z, b


@kernel
def _expected(neighbour, b):
    """Displacement at friction b by the polynomial through the last orbits; if b is far away, the last."""
    last, friction = neighbour[_DISPLACEMENTS], neighbour[_FRICTION:FIRST]
    known = int(neighbour[KNOWN])
    if not reaches(friction, known, b):
        return last
    z = 0.0
    for k in range(known):
        z += weight(friction, known, k, b) * neighbour[_DISPLACEMENTS + k]
    return z


@kernel
def _keep(motion, b, z, sign, events, slides):
    """Save an orbit that starts at the end of a stop, as the first guess of the next cell.

    Parameters
    ----------
    motion : OneMass
    b : friction over load amplitude
    z : displacement at the end of the stop
    sign : -1.0 where the slide after it is mirrored, else 1.0
    events : number of events of the motion
    slides : slides per recurrence, whose events are the last ones
    """
    neighbour, ring = motion.neighbour, motion.memory.events
    if slides > MOST_EVENTS:
        return
    neighbour[COUNT], neighbour[SIDE], neighbour[KNOWN] = slides, sign, 0.0
    _remember(neighbour, b, z)
    for m in range(slides):
        neighbour[FIRST + m] = ring[(events - slides + m) % ring.size]


@kernel
def forget_neighbour(motion):
    """See `motion.forget_neighbour`."""
    motion.neighbour[COUNT] = 0.0


@kernel
def _nearby(motion, contact, z, slides, limits):
    """Solve for the orbit with the events of the last cell, from a first guess of its displacement."""
    found, z, c, s, _ = solve_orbit(
        motion.step, motion.oscillator, contact.b, contact.mu_b, z, 1.0, 0.0, True,
        EventSequence(motion.neighbour[FIRST:], np.int64(0), slides), limits.tolerance, motion.scratch,
    )  # fmt: skip
    return found, z, c, s


@kernel
def seek_nearby(motion, contact, limits):
    """See `motion.seek_nearby`; the first guess is where the last orbits point, at first the orbit at the
    onset of stopping, which stops where it turns.
    """
    neighbour = motion.neighbour
    slides = int(neighbour[COUNT])
    if slides == 0:
        f = motion.oscillator
        if math.isinf(f.v_abs) or not contact.b_lim > 0.0:
            return no_orbit()
        slides = 1
        neighbour[SIDE], neighbour[KNOWN] = 1.0, 0.0
        neighbour[FIRST] = STOP_THEN_BACK
        _remember(neighbour, contact.b_lim, -continuous_amplitude(f.v_abs, f.u, f.g, contact.b_lim))
    neighbour[COUNT] = 0.0
    expected, last = _expected(neighbour, contact.b), neighbour[_DISPLACEMENTS]
    found, z, c, s = _nearby(motion, contact, expected, slides, limits)
    if not found and expected != last:
        found, z, c, s = _nearby(motion, contact, last, slides, limits)
    if not found:
        return no_orbit()
    neighbour[COUNT] = slides
    _remember(neighbour, contact.b, z)
    contact_force = first_contact_force(contact.b, contact.mu_b, z, c)
    event = int(neighbour[FIRST + slides - 1])
    return known_orbit(ContactState(z, 0.0, c, s, contact_force), event, neighbour[SIDE], slides)


@kernel
def save_state(motion, slot):
    """See `motion.save_state`; the contact state is the whole state."""


@kernel
def restore_state(motion, slot):
    """See `motion.restore_state`."""


@kernel
def distance_from(motion, slot, saved, contact_state, stopped):
    """See `motion.distance_from`; after a stop the load phase is a function of the displacement."""
    turn = 0.0 if stopped else abs(contact_state.cos - saved.cos) + abs(contact_state.sin - saved.sin)
    return turn + abs(contact_state.z - saved.z) / abs(saved.z)


@kernel
def has_returned(motion, slot, saved, contact_state):
    """See `motion.has_returned`."""
    return distance_from(motion, slot, saved, contact_state, False) <= _SAME


@kernel
def on_continuous(motion, contact):
    """See `motion.on_continuous`."""
    f = motion.oscillator
    z = -continuous_amplitude(f.v_abs, f.u, f.g, contact.b)
    phase = orbit_phase(f.v_abs, f.v_arg, f.u, contact.b)
    c, s = -math.cos(phase), -math.sin(phase)
    return ContactState(z, 0.0, c, s, c - z - contact.b)


@kernel
def put_slide(motion, contact_state, row):
    """See `motion.put_slide`."""
    c, s = math.cos(motion.lead), math.sin(motion.lead)
    put_mass(
        motion.chi * motion.load * contact_state.z, contact_state.cos * c + contact_state.sin * s,
        contact_state.sin * c - contact_state.cos * s, row,
    )  # fmt: skip


@kernel
def put_stop(motion, contact_state, row):
    """See `motion.put_stop`; one mass has the same state in a stop as in a slide."""
    put_slide(motion, contact_state, row)

"""Motions of structures on belts without a load, from one largest displacement of a contact to the next one.

Nothing depends on the time itself, so that intervals of the load have no meaning: a step is at most as long
as one, ends at an event, and ends at a maximum of the displacement in the contact that is looked at.  Times
are counted in intervals.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.packed import packed
from ..general.counts import COUNT_ROWS
from ..general.crossings import value_at
from ..general.follow import FOLLOWED, count_time, forget_tables, next_event, pass_event, prepare
from ..general.laws.speed import set_segments
from ..general.loops import begin
from ..general.pattern import BOX_ROWS, stop_exactly
from ..general.problem import H, P, Q, padded, velocity_row
from ..general.record import NOTHING, RANGES, clear_record, make_record, record_step
from ..general.row import make_motion, make_row, set_channels, set_row
from ..general.series import advance, expand, factor_held
from ..general.tangent import advance_tangent, hold_tangent, identity

#: Outcomes of `march`: back at a state of before; without events for a while; as many maxima as wanted;
#: else a code of `follow`, negative.
BACK, QUIET, LONG = 0, 1, 2

#: Maxima that are kept, and those without an event between them after which the motion is quiet.
KEPT, _CALM = 96, 4

#: Halvings that find a maximum to rounding.
_HALVINGS = 54

#: Events in a flight, at most.
_MOST_EVENTS = 100000

#: Places in `Trail.numbers`: time since the beginning, and of the last maximum; largest modal velocity since.
_TIME, _LAST, _FAST = 0, 1, 2
#: Places in `Trail.counts`: maxima, those since the last event, whether the next maximum counts, events.
_MAXIMA, _CALMS, _ARMED, _EVENTS = 0, 1, 2, 3


class Trail(NamedTuple):
    """The last maxima of a motion."""

    states: np.ndarray  # (KEPT, 2, M)
    senses: np.ndarray  # (KEPT, N) int
    times: np.ndarray  # (KEPT,)
    sizes: np.ndarray  # (KEPT,) largest modal velocity since the maximum before
    numbers: np.ndarray  # (3,)
    counts: np.ndarray  # (4,) int


class Memory(NamedTuple):
    """The memory that motions of a structure are followed in; names are those of `general`."""

    row: NamedTuple
    motion: NamedTuple
    box: np.ndarray
    counts: np.ndarray
    record: NamedTuple
    trail: Trail
    rates: np.ndarray  # (2, M) derivative of the state by the time


@entry
def make_memory(problem, masses):
    """Allocate the memory and fill its constants; `masses` (n, m): see `record.make_record`."""
    contacts, modes = problem.chi.shape
    width = padded(max(modes, contacts))
    trail = Trail(
        np.zeros((KEPT, 2, width)), np.zeros((KEPT, contacts), np.int64), np.zeros(KEPT), np.zeros(KEPT),
        np.zeros(3), np.zeros(4, np.int64),
    )  # fmt: skip
    memory = Memory(
        make_row(problem), make_motion(problem), np.zeros((BOX_ROWS, contacts)),
        np.zeros((COUNT_ROWS, contacts)), make_record(problem, masses, 0), trail, np.zeros((2, width)),
    )  # fmt: skip
    set_row(packed(problem), 0, packed(memory.row))
    return memory


@kernel
def _ready(problem, friction, memory):
    """Make a state in `motion` one that can be followed; False if forces are not determined."""
    if not prepare(problem, memory.row, friction, memory.motion):
        return False
    set_channels(problem, memory.row, 0.0, -1, memory.motion)
    stop_exactly(problem, memory.row, memory.motion)
    set_segments(problem, memory.row, memory.motion)
    forget_tables(problem, memory.row, friction)
    return True


@entry
def start(problem, friction, memory, state):
    """Begin a motion from (2, m) modes and their velocities; whether the contacts determine their forces."""
    problem, friction, memory = packed(problem), packed(friction), packed(memory)
    motion = memory.motion
    for m in range(problem.squares.size):
        motion.state[Q, m] = state[0, m]
        motion.state[P, m] = memory.row.numbers[H] * state[1, m]
    forget_tables(problem, memory.row, friction)
    for i in range(memory.trail.counts.size):
        memory.trail.counts[i] = 0
    for i in range(memory.trail.numbers.size):
        memory.trail.numbers[i] = 0.0
    memory.trail.counts[_ARMED] = 1
    memory.record.active[0] = NOTHING
    return begin(problem, memory.row, friction, 0.0, motion, memory.box)


@inner_kernel
def _maximum_in(problem, motion, j, belt, sign, end):
    """Place in the present step at which sign times the displacement in contact j has a maximum, else -1.

    Parameters
    ----------
    problem, motion : Problem, Motion with the series of the step
    j : contact
    belt : displacement of its wall over an interval
    sign : 1.0 or -1.0
    end : end of the step
    """
    at = velocity_row(problem, j)
    if motion.sense[j] == 0:
        return -1.0
    if not (sign * (motion.series[at, 0] + belt) > 0.0 >= sign * (value_at(motion.series, at, end) + belt)):
        return -1.0
    low, high = 0.0, end
    for _ in range(_HALVINGS):
        x = 0.5 * (low + high)
        if sign * (value_at(motion.series, at, x) + belt) > 0.0:
            low = x
        else:
            high = x
    return high


@inner_kernel
def _falls(problem, motion, j, belt, sign, end):
    """Whether sign times the displacement in contact j falls at the end of the present step."""
    at = velocity_row(problem, j)
    return motion.sense[j] != 0 and sign * (value_at(motion.series, at, end) + belt) < 0.0


@kernel
def _go(problem, friction, memory, rest, contact, derive):
    """Follow the motion over a part of an interval, or to the first event or maximum in it.

    Parameters
    ----------
    problem, friction, memory : Problem, Friction, Memory
    rest : length of the part
    contact : whose maxima end the step; -1: none
    derive : whether the derivatives are carried on

    Returns
    -------
    (code, x, at_maximum) : code of `follow`; the way; whether a maximum is there
    """
    row, motion, record, counts = memory.row, memory.motion, memory.record, memory.trail.counts
    expand(problem, row, friction, 0.0, -1, motion, record.active[0] != NOTHING)
    event = next_event(problem, row, friction, motion, rest)
    step = min(event[0], rest)
    at_maximum = False
    if contact >= 0:
        belt = row.numbers[H] * problem.belt[contact]
        sign = 1.0 if belt > 0.0 else -1.0
        x = _maximum_in(problem, motion, contact, belt, sign, step) if counts[_ARMED] == 1 else -1.0
        if x >= 0.0:
            at_maximum, counts[_ARMED], step = True, 0, x
        elif _falls(problem, motion, contact, belt, sign, step):
            counts[_ARMED] = 1
    if record.active[0] != NOTHING:
        record_step(problem, row, motion, step, record)
    if derive and step > 0.0:
        advance_tangent(problem, row, motion, step)
    if step > 0.0:
        count_time(motion, memory.counts, step)
        advance(problem, row, step, motion)
        for j in range(motion.fresh.size):
            motion.fresh[j] = 0
    if at_maximum or event[1] < 0:
        return FOLLOWED, step, at_maximum
    counts[_EVENTS] += 1
    counts[_CALMS] = 0
    determined = pass_event(problem, row, friction, 0.0, motion, memory.box, memory.counts, event, derive)
    motion.clock[0] = 0.0
    return FOLLOWED if determined else -1, step, False


@kernel
def _keep(problem, memory):
    """Keep the state at a maximum."""
    trail, motion = memory.trail, memory.motion
    k = trail.counts[_MAXIMA] % KEPT
    for part in range(2):
        for m in range(problem.squares.size):
            trail.states[k, part, m] = motion.state[part, m]
    for j in range(motion.sense.size):
        trail.senses[k, j] = motion.sense[j]
    trail.times[k] = trail.numbers[_TIME]
    trail.sizes[k] = trail.numbers[_FAST]
    trail.numbers[_LAST], trail.numbers[_FAST] = trail.numbers[_TIME], 0.0
    trail.counts[_MAXIMA] += 1
    trail.counts[_CALMS] += 1


@kernel
def _distance(problem, trail, a, b):
    """Largest difference of two states kept, over the largest velocity; infinite for different patterns."""
    off = 0.0
    for j in range(problem.spring.size):
        if trail.senses[a, j] != trail.senses[b, j]:
            return math.inf
    for part in range(2):
        for m in range(problem.squares.size):
            off = max(off, abs(trail.states[a, part, m] - trail.states[b, part, m]))
    return off / max(trail.sizes[a], trail.sizes[b])


@kernel
def _back(problem, trail, tolerance):
    """How many maxima ago the motion was where it is now; 0 if it was not."""
    last = trail.counts[_MAXIMA] - 1
    for back in range(1, min(last, KEPT - 1)):
        if _distance(problem, trail, last % KEPT, (last - back) % KEPT) < tolerance:
            return back
    return 0


@entry
def march(problem, friction, memory, contact, tolerance, most, longest):
    """Follow the motion until it is back where it was at a maximum before.

    Parameters
    ----------
    problem, friction, memory : Problem, Friction, Memory
    contact : whose displacement has the maxima
    tolerance : largest difference of the states, over the largest velocity
    most : maxima at most
    longest : time without a maximum after which the motion is quiet

    Returns
    -------
    (code, back) : BACK, QUIET, LONG, or a negative code; how many maxima ago it was there
    """
    problem, friction, memory = packed(problem), packed(friction), packed(memory)
    trail, motion = memory.trail, memory.motion
    if not factor_held(problem, memory.row, motion):
        return -1, 0
    for _ in range(_MOST_EVENTS * most):
        code, step, at_maximum = _go(problem, friction, memory, 1.0, contact, False)
        if code != FOLLOWED:
            return -1, 0
        trail.numbers[_TIME] += step
        for m in range(problem.squares.size):
            trail.numbers[_FAST] = max(trail.numbers[_FAST], abs(motion.state[P, m]))
        if at_maximum:
            _keep(problem, memory)
            back = _back(problem, trail, tolerance) if trail.counts[_CALMS] < _CALM else 0
            if back > 0:
                return BACK, back
        if trail.counts[_CALMS] >= _CALM or trail.numbers[_TIME] - trail.numbers[_LAST] > longest:
            trail.numbers[_LAST], trail.counts[_CALMS] = trail.numbers[_TIME], 0
            return QUIET, 0
        if trail.counts[_MAXIMA] >= most:
            return LONG, 0
    return -1, 0


@entry
def fly(problem, friction, memory, length, derive, recorded):
    """Follow the motion that is in `memory.motion` for a time; the counters are those of this time.

    Parameters
    ----------
    problem, friction, memory : Problem, Friction, Memory
    length : the time
    derive : whether the derivatives are carried on, from the identity
    recorded : whether extremes and works are recorded

    Returns
    -------
    int : events on the way; -1 if the contacts do not determine their forces, or chatter
    """
    problem, friction, memory = packed(problem), packed(friction), packed(memory)
    for part in range(memory.counts.shape[0]):
        for j in range(memory.counts.shape[1]):
            memory.counts[part, j] = 0.0
    if not _ready(problem, friction, memory):
        return -1
    if derive:
        identity(problem, memory.motion)
        hold_tangent(problem, memory.row, memory.motion)
    if recorded:
        clear_record(memory.record)
    memory.record.active[0] = RANGES if recorded else NOTHING
    memory.trail.counts[_EVENTS] = 0
    rest = length
    while rest > 0.0 and memory.trail.counts[_EVENTS] < _MOST_EVENTS:
        code, step, _ = _go(problem, friction, memory, min(1.0, rest), -1, derive)
        if code != FOLLOWED:
            return -1
        rest -= step
    memory.record.active[0] = NOTHING
    return memory.trail.counts[_EVENTS]


@entry
def time_to_event(problem, friction, memory, most):
    """Time to the next event of the motion in `memory.motion`, which is followed to it; at most `most`."""
    problem, friction, memory = packed(problem), packed(friction), packed(memory)
    if not _ready(problem, friction, memory):
        return 0.0
    memory.trail.counts[_EVENTS] = 0
    time = 0.0
    while time < most and memory.trail.counts[_EVENTS] == 0:
        code, step, _ = _go(problem, friction, memory, 1.0, -1, False)
        time += step
        if code != FOLLOWED:
            break
    return time


@entry
def fill_rates(problem, friction, memory):
    """Fill the derivative of the state by the time, of the motion in `memory.motion`; False: undetermined."""
    problem, friction, memory = packed(problem), packed(friction), packed(memory)
    if not _ready(problem, friction, memory):
        return False
    expand(problem, memory.row, friction, 0.0, -1, memory.motion, False)
    for m in range(problem.squares.size):
        memory.rates[0, m] = memory.motion.state[P, m]
        memory.rates[1, m] = 2.0 * memory.motion.moves[2, m]
    return True

"""The motion from one phase of the load to another: steps, and the events that end them."""

import math

from ..compiler import inner_kernel, kernel
from .counts import COUNT_ROWS, MOVED, RELEASE_ORDER, STUCK
from .crossings import NONE, value_at
from .glide import can_glide, glide
from .laws.contact import change_phase, count, jumps
from .laws.coulomb import comes_to_rest, first_event, watched_slope
from .laws.coupled import begin_slip, is_coupled
from .laws.elastic import end_slips, rest_springs
from .laws.kinds import has_constraint
from .laws.speed import first_bound, has_law, is_at_speed, pass_break_point, set_segments
from .loops import prepare_loops, release_in_loops, settle_contacts
from .pattern import (
    FORCE,
    HOLDING,
    KINETIC,
    ORDER_MATTERS,
    PARTICIPATES,
    release_by_rates,
    stop_exactly,
)
from .problem import SECTION, H, force_row, normal_row
from .record import NOTHING, keep_displacements, needs_ends, record_ends, record_step
from .row import set_channels
from .series import advance, expand, factor_held
from .tangent import advance_tangent, hold_tangent, through_event, through_slip, watched_row

#: Phases of no length in a row after which the contacts chatter.
_MOST_IMMEDIATE = 200

#: Events in an interval of the load, at most.
_MOST_EVENTS = 1000

#: Rows of `Motion.event`: of every contact its sense and force before an event, the change of its force, and
#: its normal load; where contacts are coupled, the jump of the rate of its force in the place of the force.
_SENSE, _BEFORE, _CHANGE, _NORMAL = 0, 1, 2, 3

FOLLOWED, CHATTERS, UNDETERMINED = 0, 1, 2


@inner_kernel
def next_event(problem, row, friction, motion, end):
    """Return (x, contact, side) of the first event in the present step up to `end`; x = NONE without one."""
    found, contact, side = NONE, -1, 0
    for j in range(motion.sense.size):
        x, of = first_event(problem, friction, motion, j)
        if motion.sense[j] != 0 and has_law(problem):
            x, of = first_bound(problem, row, motion, j, x, of)
        if x < found:
            found, contact, side = x, j, of
    if found > end:
        return NONE, -1, 0
    return found, contact, side


@kernel
def _arrives_instead(problem, friction, motion, x, contact):
    """A rigid contact that comes to rest where the slip of an elastic one ends, or that one.

    Both have one velocity where they are side by side; what the rigid one does decides what follows.
    """
    for j in range(motion.sense.size):
        slides = has_constraint(problem, j) and motion.sense[j] != 0
        if slides and comes_to_rest(problem, friction, motion, x, j):
            return j
    return contact


@kernel
def _settle(problem, row, friction, tau, motion, box, forces, event):
    """Change the pattern at an event at which forces jump; False if they are not determined.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau : phase of the event
    motion, box : Motion, scratch of `settle`
    forces : (N,) forces before the event
    event : see `next_event`
    """
    x, contact, side = event
    arrived, released = (contact, -1) if side == 0 else (-1, contact)
    if not settle_contacts(problem, row, friction, tau, motion, box, forces, arrived, released):
        return False
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0:
            motion.fresh[j] = 1 if motion.sense[j] != 0 else 0
            motion.segment[j] = 0
    end_slips(problem, friction, motion, x)
    return True


@kernel
def _count(problem, motion, box, before, counts):
    """Count stops, turns, slips and reversals from the pattern before and after an event."""
    for j in range(motion.sense.size):
        old, new = int(before[j]), motion.sense[j]
        if new != old:
            share = box[KINETIC, j] / abs(box[HOLDING, j]) if old * new < 0 else 0.0
            count(problem, counts, j, old, new, share)


@inner_kernel
def count_time(motion, counts, time):
    """Add a time > 0 in which the pattern was the present one."""
    for j in range(motion.sense.size):
        if motion.sense[j] == 0:
            counts[STUCK, j] += time
        else:
            way = 1.0 if motion.sense[j] > 0 else 2.0
            counts[MOVED, j] = way if counts[MOVED, j] in (0.0, way) else 3.0
            if counts.shape[0] > COUNT_ROWS:
                counts[COUNT_ROWS + motion.segment[j], j] += time


@kernel
def _forces_at(problem, motion, x, out):
    """Friction forces at x of the present step."""
    for j in range(motion.sense.size):
        out[j] = value_at(motion.series, force_row(problem, j), x)


@kernel
def pass_event(problem, row, friction, tau, motion, box, counts, event, derive):
    """Change the pattern at an event, count it, and carry the derivatives through it.

    Parameters
    ----------
    problem, row, friction, motion : Problem, Row, Friction, Motion; the state is that of the event
    tau : phase of the event
    box, counts : scratch of `settle`, counters
    event : (x, contact, side) of `next_event`
    derive : whether the derivatives are carried on; they are those of just before the event

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    x, contact, side = event
    if is_at_speed(side):  # no force jumps, and nothing else changes
        pass_break_point(motion, counts, contact, side)
        return True
    if side == 0 and not has_constraint(problem, contact):
        contact = _arrives_instead(problem, friction, motion, x, contact)
    contacts = problem.spring.size
    series, scratch = motion.series, motion.event
    before, forces = scratch[_SENSE], scratch[_CHANGE]
    for j in range(contacts):
        before[j] = motion.sense[j]
    _forces_at(problem, motion, x, forces)
    slope = watched_slope(problem, friction, motion, x, contact, side)
    settles = jumps(problem, friction, contact, side)
    if derive:
        watched_row(problem, row, motion, contact, side, motion.watched)
    if settles and derive:
        for j in range(contacts):
            scratch[_BEFORE, j] = forces[j]
            scratch[_NORMAL, j] = value_at(series, normal_row(problem, j), x)
    if settles:
        determined = _settle(problem, row, friction, tau, motion, box, forces, (x, contact, side))
    elif is_coupled(problem) and side != 0:
        determined = begin_slip(problem, friction, motion, x, contact, side, box, scratch[_BEFORE])
    elif problem.loops:
        determined = release_in_loops(problem, row, friction, motion, forces, x, box)
    else:
        change_phase(problem, friction, motion, x, contact, side)
        determined = release_by_rates(problem, row, friction, motion, x, before, box)
    if not determined:
        return False
    if not problem.loops:
        rest_springs(problem, friction, motion, 1 if settles else 2)
    _count(problem, motion, box, before, counts)
    if settles:
        for j in range(contacts):
            counts[RELEASE_ORDER, j] = max(counts[RELEASE_ORDER, j], box[ORDER_MATTERS, j])
    if not factor_held(problem, row, motion):
        return False
    if derive:
        for j in range(contacts):
            if (
                not settles
                or not has_constraint(problem, j)
                or (has_law(problem) and box[PARTICIPATES, j] == 0.0)
            ):
                forces[j] = 0.0
            elif motion.sense[j] != 0:
                forces[j] = motion.sense[j] * friction.kinetic[j] * scratch[_NORMAL, j] - scratch[_BEFORE, j]
            else:
                forces[j] = box[FORCE, j] - scratch[_BEFORE, j]
        through_event(problem, row, motion, forces, motion.watched, slope)
        if is_coupled(problem) and side != 0:
            through_slip(problem, motion, scratch[_BEFORE], motion.watched, slope)
        hold_tangent(problem, row, motion)
    return True


@kernel
def _cross(problem, row, friction, begin, interval, length, motion, box, counts, record, derive):
    """Follow the motion through one interval of the load, or a part of it.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    begin, interval : phase and number of the interval, see `set_channels`
    length : length of the part, over that of the interval
    motion, box, counts, record, derive : see `follow`

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    h = row.numbers[H]
    x = 0.0
    tau = begin
    immediate = 0
    for _ in range(_MOST_EVENTS):
        rest = length - x
        expand(problem, row, friction, tau, interval if x == 0.0 else -1, motion, record.active[0] != 0)
        event = next_event(problem, row, friction, motion, rest)
        step = min(event[0], rest)
        if record.active[0] != 0:
            record_step(problem, row, motion, step, record)
        if derive and step > 0.0:
            advance_tangent(problem, row, motion, step)
        if step > 0.0:
            count_time(motion, counts, step * h)
            advance(problem, row, step, motion)
            for j in range(motion.fresh.size):
                motion.fresh[j] = 0
        if event[1] < 0:
            return FOLLOWED
        x += step
        tau = begin + x * h
        immediate = immediate + 1 if step == 0.0 else 0
        if immediate > _MOST_IMMEDIATE:
            return CHATTERS
        if not pass_event(problem, row, friction, tau, motion, box, counts, event, derive):
            return UNDETERMINED
    return CHATTERS


@kernel
def prepare(problem, row, friction, motion):
    """Prepare the state and pattern in `motion`; False if the contacts do not determine their forces."""
    motion.clock[0] = math.nan
    for j in range(motion.idle.size):
        motion.idle[j] = False
    if problem.loops:  # see `prepare_loops`
        return True
    rest_springs(problem, friction, motion, 0)
    return factor_held(problem, row, motion)


@kernel
def forget_tables(problem, row, friction):
    """Forget derivatives of motions that were under another friction, where they depend on it."""
    if not has_law(problem):
        return
    same = True
    for j in range(row.kinetic.size):
        same = same and row.kinetic[j] == friction.kinetic[j]
        row.kinetic[j] = friction.kinetic[j]
    for k in range(0 if same else row.patterns.size):
        row.patterns[k] = 0


@kernel
def follow(problem, row, friction, first, count, motion, box, counts, record, derive):
    """Follow the motion through some intervals of the load.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    first, count : the first interval, from the section on, and how many
    motion : Motion; state and pattern become those at the end, and `tangent` is multiplied if `derive`
    box : (BOX_ROWS, N) scratch
    counts : (COUNT_ROWS, N) counters, increased
    record : Record
    derive : whether the derivatives are carried on

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    h = row.numbers[H]
    if not prepare(problem, row, friction, motion):
        return UNDETERMINED
    # a state that Newton's method or other states led to, with their errors
    set_channels(problem, row, SECTION + first * h, first, motion)
    if not prepare_loops(problem, row, friction, SECTION + first * h, motion, box):
        return UNDETERMINED
    stop_exactly(problem, row, motion)
    set_segments(problem, row, motion)
    forget_tables(problem, row, friction)
    if derive:
        hold_tangent(problem, row, motion)
    glides, recorded = needs_ends(problem, record) and can_glide(problem, row), record.active[0] != NOTHING
    before, after = motion.event[_BEFORE], motion.event[_CHANGE]
    for interval in range(first, first + count):
        if glides and recorded:
            keep_displacements(problem, row, motion, interval, before)
        if glides and glide(problem, row, friction, interval, motion):
            if recorded:
                keep_displacements(problem, row, motion, interval + 1, after)
                record_ends(problem, friction, motion, before, after, record)
            count_time(motion, counts, h)
            if derive:
                advance_tangent(problem, row, motion, 1.0)
            continue
        begin = SECTION + interval * h
        code = _cross(problem, row, friction, begin, interval, 1.0, motion, box, counts, record, derive)
        if code != FOLLOWED:
            return code
    return FOLLOWED


@kernel
def follow_to_section(problem, row, friction, begin, motion, box, counts, record):
    """Follow the motion from a phase to the next section.

    Parameters
    ----------
    problem, row, friction, motion, box, counts, record : see `follow`
    begin : the phase, from 0 to 2 pi

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    h = row.numbers[H]
    if not prepare(problem, row, friction, motion):
        return UNDETERMINED
    if not prepare_loops(problem, row, friction, begin, motion, box):
        return UNDETERMINED
    parts = (SECTION if begin <= SECTION else SECTION + 2.0 * math.pi) / h - begin / h
    for k in range(int(math.ceil(parts))):
        length = min(1.0, parts - k)
        code = _cross(problem, row, friction, begin + k * h, -1, length, motion, box, counts, record, False)
        if code != FOLLOWED:
            return code
    return FOLLOWED

"""The motion of the general engine under a record: its start, an interval or a part of one, its end.

`motions_in_time` follows it from interval to interval.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..general.counts import COUNT_ROWS
from ..general.crossings import NONE, value_at
from ..general.follow import count_time, pass_event, prepare
from ..general.laws.contact import jumps
from ..general.laws.coulomb import first_event, reaches, watched_slope
from ..general.laws.coupled import LEAP, is_coupled
from ..general.laws.elastic import rest_springs
from ..general.laws.kinds import has_constraint, is_constrained
from ..general.laws.speed import first_bound, has_law, is_at_speed, rate_under, set_segments
from ..general.pattern import BOX_ROWS, PARTICIPATES, settle, stop_exactly
from ..general.problem import (
    HALF,
    LOAD_TERMS,
    SIZE,
    TERMS,
    F,
    H,
    Motion,
    P,
    Q,
    Row,
    force_row,
    normal_row,
    slide_velocity,
    velocity_row,
)
from ..general.row import make_motion, make_row, put_part, set_channels, set_interval
from ..general.series import advance, expand, factor_held
from .asleep import is_asleep
from .coupled_springs import begin_coupled
from .course import (
    ASLEEP,
    AT_LIMIT,
    AWAKE,
    BY_LAW,
    MOST_EVENTS,
    RESOLVED,
    TOO_MANY_EVENTS,
    UNDETERMINED,
    any_slides,
    parts_of,
    slides_on_slowly,
)
from .held import Places, keep_places, make_places, note_places
from .kept import begin_step, keep_ends, keep_present, keep_step, list_changes, store_state
from .springs import (
    begin_springs,
    bends,
    follow_open,
    follow_walls,
    has_open_spring,
    has_varying_spring,
    rest_tied,
    slip_at_start,
    slip_with_walls,
    turn_open,
)
from .tables import Tables, has_tables, make_tables, pass_by_tables, set_tables

#: Leading terms of a slide's velocity that may be zero at most: where the load begins as t^4.
_MOST_ZEROS = 6

#: A jump of a wall within this share of its terms is rounding error.
_SAME = 1e-12

#: A velocity at the start within this share of its terms is rest.
_AT_REST = 1e-12

#: A force of a motion that goes on within this share of its limit does not exceed it.
_EXCEEDS = 1e-10


class Memory(NamedTuple):
    """Memory of a motion."""

    row: Row
    channels: np.ndarray  # `row.loads`: the channels in the present part of an interval
    motion: Motion
    tables: Tables
    box: np.ndarray  # (BOX_ROWS, N) scratch of `settle`
    before: np.ndarray  # (N,) senses before an event
    counts: np.ndarray  # (COUNT_ROWS, N) counters
    places: Places
    rests: np.ndarray  # (N,) bool: springs under varying normal loads that are at rest, see `springs`
    last: np.ndarray  # (m,) modes at the last sample, see `creeps`


@entry
def make_memory(problem, still, watched, terms, lengths):
    """Allocate it; see `tables.make_tables`."""
    tables = make_tables(problem, still, watched, terms, lengths if has_tables(problem) else 0)
    contacts, row = problem.spring.size, make_row(problem)
    return Memory(
        row, row.loads, make_motion(problem), tables, np.zeros((BOX_ROWS, contacts)),
        np.zeros(contacts), np.zeros((COUNT_ROWS, contacts)), make_places(problem),
        np.zeros(contacts, np.bool_), np.full(problem.squares.size, np.inf),
    )  # fmt: skip


@kernel
def _bend_of_load(problem, friction, motion, event):
    """How much the rate of a force over its limit falls in a unit of the step, at an event."""
    x, j, side = event
    force, nu = force_row(problem, j), normal_row(problem, j)
    bend = 0.0
    for k in range(TERMS, 1, -1):
        load = side * motion.series[force, k] - friction.static[j] * motion.series[nu, k]
        bend = bend * x - k * (k - 1) * load
    return bend


@kernel
def _touches(problem, friction, motion, event, end):
    """Whether a force reaches its limit at an event and does not exceed it by more than rounding.

    It then neither rises above the limit after the event nor is above it half way to the end, and there.
    What crosses a limit at its peak by rounding error has a rate like the root of this error, and falls back.
    """
    x, j, side = event
    rate = -watched_slope(problem, friction, motion, x, j, side)
    size = friction.static[j] * value_at(motion.series, normal_row(problem, j), x)
    if rate * (end - x) > AT_LIMIT * size:
        bend = _bend_of_load(problem, friction, motion, event)
        if rate >= bend * (end - x) or rate * rate > 2.0 * bend * AT_LIMIT * size:
            return False
    for at in (0.5 * (x + end), end):
        force = value_at(motion.series, force_row(problem, j), at)
        limit = friction.static[j] * value_at(motion.series, normal_row(problem, j), at)
        if side * force - limit > AT_LIMIT * abs(limit):
            return False
    return True


@kernel
def _next_event(problem, row, friction, motion, end):
    """Return (x, contact, side) of the first event up to `end`; x = NONE without one.

    A limit that a force touches is no event: at a sample the slope of the load after it decides, and a
    constant force at its limit holds.  The other limit may be reached later in the step.
    """
    found, contact, side = NONE, -1, 0
    for j in range(motion.sense.size):
        x, of = first_event(problem, friction, motion, j)
        if motion.sense[j] != 0 and has_law(problem):
            x, of = first_bound(problem, row, motion, j, x, of)
        if x < found and x <= end:
            held = motion.sense[j] == 0
            if held and motion.fresh[j] == 0 and _touches(problem, friction, motion, (x, j, of), end):
                of = -of
                x = reaches(problem, friction, motion, j, of)
                if x >= found or x > end or _touches(problem, friction, motion, (x, j, of), end):
                    continue
            found, contact, side = x, j, of
    return found, contact, side


@kernel
def _skip_zeros(problem, motion):
    """Count all leading terms of the velocities of slides that begin which are zero.

    The load rises without a slope, at the beginning of a record too, from a limit that a contact is at.
    """
    for j in range(motion.sense.size):
        if motion.sense[j] == 0 or not has_constraint(problem, j):
            continue
        while 0 < motion.fresh[j] < _MOST_ZEROS:
            if motion.series[velocity_row(problem, j), motion.fresh[j]] != 0.0:
                break
            motion.fresh[j] += 1


@kernel
def _cross(problem, friction, memory, ties, kept, jumped, listed):
    """Follow the motion by its series through one interval, or an equal part of one.

    Parameters
    ----------
    problem, friction, memory, kept : see `motions_in_time.follow_record`; the polynomials are in `row.loads`
    ties : see `course.Course`
    jumped : whether the load, or what a contact does, has changed at the beginning
    listed : whether the states at events are kept

    Returns
    -------
    int : RESOLVED, TOO_MANY_EVENTS or UNDETERMINED
    """
    row, motion, counts = memory.row, memory.motion, memory.counts
    h = row.numbers[H]
    x = 0.0
    motion.clock[0] = math.nan
    before = memory.before
    show, opens = listed and jumped, has_open_spring(problem, friction)
    for _ in range(MOST_EVENTS):
        rest = 1.0 - x
        expand(problem, row, friction, x * h, 0 if x == 0.0 else -1, motion, True)
        _skip_zeros(problem, motion)
        if opens:
            if follow_open(problem, row, friction, motion, before):
                expand(problem, row, friction, x * h, 0 if x == 0.0 else -1, motion, True)
            list_changes(row, motion, before, x, kept)
        if show:
            keep_present(problem, row, motion, x, 0.0, kept)
        event = _next_event(problem, row, friction, motion, rest)
        step = min(event[0], rest)
        if step > 0.0:
            begin_step(problem, row, motion, kept)
            count_time(motion, counts, step * h)
            advance(problem, row, step, motion)
            keep_places(problem, row, motion, x + step, kept.clock[0] + (x + step) * h, memory.places)
            keep_step(problem, row, motion, x, step, kept)
            for j in range(motion.fresh.size):
                motion.fresh[j] = 0
        if event[1] < 0:
            keep_ends(problem, motion, step, kept)
            return RESOLVED
        show = listed and not is_at_speed(event[2])
        if show:
            keep_present(problem, row, motion, x + step, step, kept)
        for j in range(motion.sense.size):
            before[j] = motion.sense[j]
        x += step
        if not pass_event(problem, row, friction, x * h, motion, memory.box, counts, event, False):
            return UNDETERMINED
        set_channels(problem, row, x * h, -1, motion)
        if opens:
            order = 1 if jumps(problem, friction, event[1], event[2]) else 2
            rest_tied(problem, row, friction, motion, ties, memory.rests, order)
            turn_open(problem, row, friction, motion, before)
        stop_exactly(problem, row, motion)  # the rounding error of what `settle` took away
        note_places(problem, row, motion, before, x, kept.clock[0] + x * h, memory.places)
        list_changes(row, motion, before, x, kept)
    return TOO_MANY_EVENTS


@kernel
def rate_of(memory, problem, friction):
    """Bound on the rate of the fastest part of the motion."""
    return rate_under(problem, 0, friction)


@kernel
def set_length(memory, problem, h):
    """Change the length of parts of intervals, with the velocities that are measured in it."""
    row, motion = memory.row, memory.motion
    before = row.numbers[H]
    if h != before:
        set_interval(problem, 0, row, h)
        for m in range(problem.squares.size):
            motion.state[P, m] *= h / before
        factor_held(problem, row, motion)
        set_tables(memory.tables, h)


@kernel
def _jump(problem, friction, memory, ties, kept):
    """Decide the pattern where the load jumps; False if the contacts do not determine their forces."""
    motion = memory.motion
    before = memory.before
    for j in range(motion.sense.size):
        before[j] = motion.sense[j]
    if not _settle(problem, friction, memory):
        return False
    rest_tied(problem, memory.row, friction, motion, ties, memory.rests, 1)
    note_places(problem, memory.row, motion, before, 0.0, kept.clock[0], memory.places)
    list_changes(memory.row, motion, before, 0.0, kept)
    return True


@kernel
def _settle(problem, friction, memory):
    """Ask the law for all held contacts, at the beginning of an interval."""
    row, motion, box = memory.row, memory.motion, memory.box
    motion.clock[0] = math.nan
    set_channels(problem, row, 0.0, 0, motion)
    if not settle(problem, row, friction, 0.0, motion, box, -1, -1):
        return False
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            motion.fresh[j] = 1
            motion.segment[j] = 0
    rest_springs(problem, friction, motion, 1)
    return factor_held(problem, row, motion)


@kernel
def _sense_at_start(problem, row, motion, j):
    """Sense of a contact by its velocity: that of one at rest is rounding error of its terms."""
    if not has_constraint(problem, j):
        return 0
    modes, channels = problem.push.shape
    w = slide_velocity(problem, row, motion, j)
    size = abs(row.numbers[H] * problem.belt[j])
    for m in range(modes):
        size += abs(problem.chi[j, m] * motion.state[P, m])
    for d in range(channels):
        for k in range(1, row.intervals[LOAD_TERMS]):
            size += abs(problem.base[j, d] * motion.series[modes + d, k])
    return int(np.sign(w)) if abs(w) > _AT_REST * size else 0


@kernel
def _note_leaps(course, k, leaps):
    """Fill how far the walls of springs jump where interval k begins, except for rounding error."""
    for j in range(leaps.size):
        leaps[j], size = 0.0, 0.0
        for d in range(course.direct.shape[1]):
            now, before = course.pieces[k, d, 0], 0.0
            for i in range(course.pieces.shape[2] if k > 0 else 0):
                before += course.pieces[k - 1, d, i]
            leaps[j] += course.direct[j, d] * (now - before)
            size += abs(course.direct[j, d]) * (abs(now) + abs(before))
        if abs(leaps[j]) <= _SAME * size:
            leaps[j] = 0.0


@kernel
def _begin_at_walls(problem, friction, memory, course, kept):
    """Let springs follow what the load displaces at once where the record begins; see `_begin_springs`."""
    row, motion, leaps = memory.row, memory.motion, memory.box[LEAP]
    before = memory.before
    _note_leaps(course, 0, leaps)
    if is_coupled(problem):
        return begin_coupled(problem, row, friction, motion, kept, before, memory.box)
    for j in range(motion.sense.size):
        before[j] = motion.sense[j]
    follow_walls(problem, row, friction, motion, leaps, kept)
    list_changes(row, motion, before, 0.0, kept)
    slip_with_walls(problem, row, friction, leaps, kept)
    return True


@kernel
def _begin_springs(problem, friction, memory, course, kept, jump):
    """Decide what springs do where an interval begins; False if coupled ones have no pattern there.

    jump : the interval, if the load jumps, else -1
    """
    row, motion, leaps = memory.row, memory.motion, memory.box[LEAP]
    leaps[:] = 0.0
    if jump >= 0:
        _note_leaps(course, jump, leaps)
    if is_coupled(problem):
        return begin_coupled(problem, row, friction, motion, kept, memory.before, memory.box)
    begin_springs(problem, row, friction, motion, kept, memory.before, course, memory.rests, leaps)
    return True


@kernel
def _is_overloaded(problem, row, friction, motion):
    """Whether a held contact of a motion that goes on needs more than its friction: under another load."""
    expand(problem, row, friction, 0.0, 0, motion, True)
    found = False
    for j in range(motion.sense.size):
        if is_constrained(problem, motion, j):
            limit = friction.static[j] * motion.series[normal_row(problem, j), 0]
            force = motion.series[force_row(problem, j), 0]
            found = found or abs(force) > limit * (1.0 + _EXCEEDS)
    return found


@kernel
def begin(memory, problem, friction, course, start, senses, kept):
    """Set the state and the pattern at the start; False if the contacts do not determine their forces.

    Parameters
    ----------
    memory, problem, friction, course, start, senses, kept : see `motions_in_time.follow_record`
    """
    row, motion = memory.row, memory.motion
    row.intervals[HALF], row.intervals[LOAD_TERMS] = 1, course.pieces.shape[2]
    row.loads[:] = 0.0
    parts = parts_of(rate_under(problem, 0, friction), course.steps[0])
    set_interval(problem, 0, row, course.steps[0] / parts)
    set_tables(memory.tables, row.numbers[H])
    put_part(row.loads, course.pieces[0], 0.0, parts)
    for m in range(problem.squares.size):
        motion.state[Q, m] = start[Q, m]
        motion.state[P, m] = start[P, m] * row.numbers[H]
    motion.clock[0] = math.nan
    set_channels(problem, row, 0.0, 0, motion)
    for j in range(motion.sense.size):
        motion.state[F, j] = start[F, j]
        by_law = senses[j] == BY_LAW
        motion.sense[j] = _sense_at_start(problem, row, motion, j) if by_law else senses[j]
    set_segments(problem, row, motion)
    if senses[0] != BY_LAW and not slip_at_start(problem, row, friction, motion, kept):
        return False
    if not prepare(problem, row, friction, motion):
        return False
    settles = senses[0] == BY_LAW or _is_overloaded(problem, row, friction, motion)
    if settles and not _settle(problem, friction, memory):
        return False
    before = memory.before
    before[:] = 1.0
    note_places(problem, row, motion, before, 0.0, course.times[0], memory.places)
    if senses[0] == BY_LAW and bends(course.direct):
        return _begin_at_walls(problem, friction, memory, course, kept)
    return True


@kernel
def keep_start(memory, problem, friction, kept, shown):
    """Keep the forces where the motion begins, and the state there if it is `shown`."""
    if any_slides(memory.motion.sense):
        kept.first[0] = kept.clock[0]
    row, motion = memory.row, memory.motion
    for j in range(motion.sense.size):
        kept.forces[j] = motion.state[F, j]
    if shown:
        expand(problem, row, friction, 0.0, 0, motion, True)
        keep_present(problem, row, motion, 0.0, 0.0, kept)


@kernel
def keep_sample(memory, problem, kept):
    """Keep the state at the end of an interval."""
    store_state(problem, memory.row, memory.motion, 1.0, kept)


@kernel
def follow_part(memory, problem, friction, course, kept, part, jump, listed):
    """Follow the motion through an equal part of an interval; a code of `_cross`.

    Parameters
    ----------
    memory, problem, friction, course, kept : see `motions_in_time.follow_record`
    part : number of the part; its polynomials are in `memory.channels`
    jump : the interval, if the load jumps where it begins, else -1
    listed : whether the states at events are kept
    """
    row, motion, counts, tables = memory.row, memory.motion, memory.counts, memory.tables
    jumped = jump >= 0 and part == 0
    changed = jumped
    if part == 0 and (bends(course.direct) or has_varying_spring(problem)):
        events = kept.counts[0]
        if not _begin_springs(problem, friction, memory, course, kept, jump):
            return UNDETERMINED
        changed |= kept.counts[0] > events
    if jumped and not _jump(problem, friction, memory, course.ties, kept):
        return UNDETERMINED
    by_tables = not jumped and tables.known.size > 0
    if by_tables and pass_by_tables(problem, row, friction, motion, counts, kept, tables):
        keep_places(problem, row, motion, 1.0, kept.clock[0] + row.numbers[H], memory.places)
        return RESOLVED
    return _cross(problem, friction, memory, course.ties, kept, changed, listed)


@kernel
def sleep_of(memory, problem, friction, kept, bed):
    """Whether no contact ever moves again under no load: AWAKE or ASLEEP."""
    return ASLEEP if is_asleep(memory.row, friction, memory.motion, bed) else AWAKE


@kernel
def creeps(memory, problem):
    """Whether a contact slides so slowly that rounding error hides it."""
    motion = memory.motion
    size = memory.row.numbers[SIZE]
    return slides_on_slowly(motion.sense, motion.state[Q], motion.state[P], memory.last, size)


@kernel
def end(memory, problem, kept):
    """Leave the velocities q' in the state; the forces at the end are kept already."""
    for m in range(problem.squares.size):
        memory.motion.state[P, m] /= memory.row.numbers[H]

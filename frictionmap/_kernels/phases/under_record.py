"""The motion under a record, whose channels are polynomials over every interval, and after it."""

import math

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..general.crossings import NONE, first_zero, slope_at, value_at
from ..general.problem import TERMS, TURN
from ..general.record import clear_record
from ..general.row import put_part
from ..history.kept import BEGIN, END
from ..history.motion import (
    AFTER,
    BY_LAW,
    CREEPING,
    EVERY,
    LISTED,
    RESOLVED,
    RINGING,
    TO_REST,
    TOO_MANY_EVENTS,
    UNDETERMINED,
)
from .change import count_time, wake_tied
from .follow import INSTANT, MOST_IMMEDIATE, pass_event
from .kept import (
    KNOT,
    keep_step,
    list_changes,
    list_event,
    note_senses,
    put_channels,
    put_units,
    store_state,
)
from .pattern import begin_pattern, find_piece, is_at_rest, rest_tied, settle
from .problem import NORMAL, RIGID, SMOOTH, UP, F, watch_row
from .rest import ASLEEP, ELSEWHERE, keep_places, note_places, sleep_of
from .series import (
    advance,
    begin_terms,
    dot,
    factor_held,
    observe,
    slave_forces,
    stop_exactly,
)
from .watch import clear_leads, is_watched, put_knot, put_watched

#: The phase at the end has no bed yet: the caller makes it and goes on.
NEEDS_BED = -1

#: Places in `state`: intervals followed, -1 before the start; after how many of them the motion has ended.
DONE, SINCE = 0, 1

#: Events in a part of an interval at most: more are chattering.
_MOST_EVENTS = 2000

#: Leading terms of a watched quantity that may be zero where a step begins, as at rest under a load t^4.
_MOST_ZEROS = 8

#: A force within this share of its limit is at it.
_AT_LIMIT = 1e-14

#: A slide is over for practical purposes below this speed, relative to displacements.
_CREEP = 1e-15


@kernel
def _zero_after(motion, at, lead):
    """First zero in a row of the series; terms that are zero at its beginning are no events.

    What is watched and all its derivatives may be zero at rest: it then has no zero.
    """
    series = motion.series
    while lead <= _MOST_ZEROS and series[at, lead] == 0.0:
        lead += 1
    if lead > _MOST_ZEROS:
        return NONE
    if lead > 0:
        for k in range(TERMS + 1):
            series[at, k] = series[at, k + lead] if k + lead <= TERMS else 0.0
    return first_zero(series, at)


@kernel
def _touches(problem, cell, motion, x, j, which, rest):
    """Whether the force in a held contact reaches its limit at x, and exceeds it by no more than rounding.

    At a sample the slope of the load after it decides; see `history.motion`.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion with its series
    x, j, which : place, contact, and the limit
    rest : end of the step
    """
    at = watch_row(problem)
    put_watched(problem, cell, motion, j, which)
    size = _AT_LIMIT * abs(value_at(motion.series, F * problem.law.size + j, x))
    if -slope_at(motion.series, at, x) * (rest - x) > size:
        return False
    middle, end = value_at(motion.series, at, 0.5 * (x + rest)), value_at(motion.series, at, rest)
    return middle >= -size and end >= -size


@kernel
def _next_event(problem, cell, motion, rest):
    """The first event in a step, up to x = rest; see `watch.first_event`."""
    contacts, at = problem.law.size, watch_row(problem)
    best, who, what = NONE, -1, 0
    for j in range(contacts):
        for which in range(3):
            if not is_watched(problem, motion, j, which):
                continue
            put_watched(problem, cell, motion, j, which)
            x = _zero_after(motion, at, motion.lead[j, which])
            if x < best and x <= rest:
                held = which != NORMAL and motion.sense[j] == 0 and problem.law[j] == RIGID
                if held and motion.lead[j, which] == 0 and _touches(problem, cell, motion, x, j, which, rest):
                    continue
                best, who, what = x, j, which
    for s in range(problem.along.shape[0]):
        for which in range(2):
            if motion.piece[s] != (problem.knot_count[s] if which == 0 else 0):
                put_knot(problem, motion, s, which)
                x = _zero_after(motion, at, motion.lead_spring[s, which])
                if x < best and x <= rest:
                    best, who, what = x, contacts + s, which
    return best, who, what


@kernel
def _step(problem, cell, memory, begin, kept):
    """Follow the motion from x = `begin` of a part to the next event, or to the end; see `watch.first_event`.

    Returns
    -------
    (x, who, what) : length of the way, and the event; who = -1 at the end
    """
    motion, length = memory.motion, memory.length[0]
    rest = 1.0 - begin
    found, who, what = _next_event(problem, cell, motion, rest)
    step = min(found, rest)
    if step > 0.0:
        keep_step(problem, cell, memory, begin, step, kept)
        count_time(problem, motion, motion.counts, step * length)
        advance(problem, cell, motion, step)
        keep_places(problem, memory, begin + step, kept.clock[0] + (begin + step) * length)
        if step > INSTANT:
            clear_leads(motion)
    elif who < 0:
        put_units(problem, cell, memory, kept.units[END], 0.0)
    return step, who, what


@kernel
def _pass(problem, cell, memory, x, who, what, kept):
    """Change the phase at an event, and list it; False if that is not determined.

    Parameters
    ----------
    problem, cell, memory, kept : see `follow_record`
    x, who, what : place in the part, and the event, see `watch.first_event`
    """
    motion = memory.motion
    note_senses(memory)
    put_channels(memory, x)
    if not pass_event(problem, memory.row, cell, 0.0, motion, who, what, False):
        return False
    time = kept.clock[0] + x * memory.length[0]
    note_places(problem, memory, x, time)
    list_changes(memory, x, kept)
    if who >= problem.law.size:
        list_event(kept, time, who - problem.law.size, KNOT)
    return True


@kernel
def _cross(problem, cell, memory, kept, jumped, listed):
    """Follow the motion through one part of an interval.

    Parameters
    ----------
    problem, cell, memory, kept : see `follow_record`; the channels are there
    jumped : whether the load has changed at the beginning
    listed : whether the states at events are kept

    Returns
    -------
    int : RESOLVED, TOO_MANY_EVENTS or UNDETERMINED
    """
    motion, units, x, immediate = memory.motion, kept.units[BEGIN], 0.0, 0
    show = listed and jumped
    for _ in range(_MOST_EVENTS):
        put_channels(memory, x)
        begin_terms(problem, memory.row, cell, motion, TERMS)
        observe(problem, memory.row, motion, False)
        if show:
            put_units(problem, cell, memory, units, 0.0)
            store_state(memory, units, x, kept)
        step, who, what = _step(problem, cell, memory, x, kept)
        if who < 0:
            return RESOLVED
        show = listed
        if show:
            put_units(problem, cell, memory, units, step)
            store_state(memory, units, x + step, kept)
        x += step
        immediate = immediate + 1 if step <= INSTANT else 0
        if immediate > MOST_IMMEDIATE:
            return TOO_MANY_EVENTS
        if not _pass(problem, cell, memory, x, who, what, kept):
            return UNDETERMINED
    return TOO_MANY_EVENTS


@kernel
def _set_length(problem, memory, length):
    """Change the length of parts, with what is measured in it."""
    before, row, motion = memory.length[0], memory.row, memory.motion
    if length == before:
        return
    memory.length[0], square = length, length * length
    for i in range(problem.squares.size):
        row.stiffness[i] = square * problem.squares[i]
        for other in range(problem.squares.size):
            row.damping[i, other] = length * problem.damping[i, other]
        for j in range(problem.law.size):
            row.reaction[j, i] = square * problem.chi[j, i]
            row.push[j, i] = square * problem.normal[j, i]
        for s in range(problem.along.shape[0]):
            row.pull[s, i] = square * problem.along[s, i]
        motion.p[i] *= length / before
    for j in range(problem.law.size):
        row.belt[j] = length * memory.belt[j]
    factor_held(problem, row, motion)


@kernel
def _lead_sliders(problem, memory):
    """Note that the slides of rigid contacts that begin from rest have no velocity yet."""
    motion = memory.motion
    for j in range(problem.law.size):
        if problem.law[j] == RIGID and motion.sense[j] != 0 and memory.before[j] == 0:
            motion.lead[j, UP] = 1


@kernel
def _jump(problem, cell, memory, kept):
    """Decide which held contacts slide where the load jumps; False if their forces are not determined."""
    motion = memory.motion
    note_senses(memory)
    put_channels(memory, 0.0)
    if not (settle(problem, memory.row, cell, motion, -1, 0) and factor_held(problem, memory.row, motion)):
        return False
    _lead_sliders(problem, memory)
    wake_tied(problem, memory.row, cell, motion, 1)
    rest_tied(problem, cell, motion)
    list_changes(memory, 0.0, kept)
    return True


@kernel
def _follow_interval(problem, cell, memory, course, kept, done, listed):
    """Follow the motion through the next interval; a code of `_cross`.

    Parameters
    ----------
    problem, cell, memory, course, kept : see `follow_record`
    done : intervals followed before
    listed : whether the states at events are kept
    """
    k = min(done, course.steps.size - 1)
    jump = course.jumps[k] and done == k and done > 0
    step = course.steps[k]
    begin, parts = course.times[k] + (done - k) * step, _parts_of(memory, step)
    _set_length(problem, memory, step / parts)
    for part in range(parts):
        kept.clock[0] = begin + step * (part / parts)
        put_part(memory.channels, course.pieces[k], done - k + part / parts, parts)
        jumped = jump and part == 0
        if jumped and not _jump(problem, cell, memory, kept):
            return UNDETERMINED
        code = _cross(problem, cell, memory, kept, jumped, listed)
        if code != RESOLVED:
            return code
    return RESOLVED


@kernel
def _parts_of(memory, step):
    """Equal parts of an interval in which series are exact to rounding."""
    return max(1, int(math.ceil(memory.rate[0] * step / TURN)))


@kernel
def _go_on(problem, cell, memory, senses):
    """Take the pattern of a motion that goes on from its senses; open are contacts by their place."""
    motion, row = memory.motion, memory.row
    for s in range(motion.piece.size):
        find_piece(problem, motion, s)
    for j in range(problem.law.size):
        motion.open[j] = 0
        if problem.presses[j]:
            pressed = problem.pressed[j] * dot(problem.normal, j, motion.q)
            motion.open[j] = 1 if cell.preload[j] + pressed < 0.0 else 0
        motion.sense[j] = 0 if motion.open[j] != 0 or problem.law[j] == SMOOTH else senses[j]
    slave_forces(problem, cell, motion)
    if not factor_held(problem, row, motion):
        return False
    rest_tied(problem, cell, motion)
    stop_exactly(problem, row, motion)
    return True


@kernel
def _begin(problem, cell, memory, course, start, senses, kept):
    """Set the state and the pattern at the start; False if the contacts do not determine their forces.

    Parameters
    ----------
    problem, cell, memory, course, start, senses, kept : see `follow_record`
    """
    motion, row = memory.motion, memory.row
    parts = _parts_of(memory, course.steps[0])
    _set_length(problem, memory, course.steps[0] / parts)
    put_part(memory.channels, course.pieces[0], 0.0, parts)
    kept.clock[0] = course.times[0]
    for i in range(problem.squares.size):
        motion.q[i], motion.p[i] = start[0, i], start[1, i] * memory.length[0]
    for j in range(problem.law.size):
        motion.f[j] = start[2, j]
    put_channels(memory, 0.0)
    if senses[0] == BY_LAW:
        if not begin_pattern(problem, row, cell, motion):
            return False
        for j in range(problem.law.size):
            memory.before[j] = 0 if is_at_rest(problem, row, motion, j) else 1
        _lead_sliders(problem, memory)
    elif not _go_on(problem, cell, memory, senses):
        return False
    memory.before[:] = 1
    note_places(problem, memory, 0.0, kept.clock[0])
    for j in range(problem.law.size):
        if motion.sense[j] != 0:
            kept.first[0] = kept.clock[0]
    return True


@kernel
def _creeps(problem, memory):
    """Whether a contact slides so slowly that rounding error hides it."""
    motion, slides, speed, size = memory.motion, False, 0.0, memory.row.size
    for j in range(problem.law.size):
        slides = slides or motion.sense[j] != 0
    for i in range(problem.squares.size):
        speed, size = max(speed, abs(motion.p[i])), max(size, abs(motion.q[i]))
    return slides and speed <= _CREEP * size


@kernel
def _follow(problem, cell, memory, course, kept, bed, limits, state):
    """Follow the motion from where it is; a status or NEEDS_BED.

    Parameters
    ----------
    problem, cell, memory, course, kept, bed, limits, state : see `follow_record`
    """
    last, to_rest = course.steps.size - 1, limits[TO_REST] != 0
    while True:
        done = state[DONE]
        k = min(done, last)
        if k == last and state[SINCE] < 0:
            sleep = sleep_of(problem, memory, bed)
            if sleep == ELSEWHERE:
                return NEEDS_BED
            if sleep == ASLEEP:
                state[SINCE] = done
        if state[SINCE] >= 0 and to_rest:
            return RESOLVED
        if done >= last + limits[AFTER]:
            return RINGING if to_rest else RESOLVED
        code = _follow_interval(problem, cell, memory, course, kept, done, limits[LISTED] != 0)
        if code != RESOLVED:
            return code
        state[DONE] = done + 1
        if limits[EVERY] > 0 and ((done + 1) % limits[EVERY] == 0 or done + 1 == last):
            store_state(memory, kept.units[END], 1.0, kept)
        if k == last and to_rest and _creeps(problem, memory):
            return CREEPING


@entry
def follow_record(problem, cell, memory, course, start, senses, kept, bed, limits, state):
    """Follow the motion under a record and after it, or go on with a further bed.

    Parameters
    ----------
    problem : Problem
    cell : Cell
    memory : Memory; the state is that at the end
    course : `history.motion.Course`
    start : (3, ...) modes, their velocities q', forces of springs in contacts
    senses : (N,) of a motion that goes on; else BY_LAW
    kept : `history.kept.Kept`
    bed : Bed of one phase
    limits : (4,) int, see `history.motion`
    state : (2,) int, see DONE

    Returns
    -------
    int : status, see `history.motion`, or NEEDS_BED
    """
    problem, cell, memory = packed(problem), packed(cell), packed(memory)
    course, kept, bed = packed(course), packed(kept), packed(bed)
    motion = memory.motion
    if state[DONE] < 0:
        clear_record(kept.record)
        state[DONE] = 0
        if not _begin(problem, cell, memory, course, start, senses, kept):
            return UNDETERMINED
        if limits[EVERY] > 0:
            begin_terms(problem, memory.row, cell, motion, TERMS)
            put_units(problem, cell, memory, kept.units[END], 0.0)
            store_state(memory, kept.units[END], 0.0, kept)
    code = _follow(problem, cell, memory, course, kept, bed, limits, state)
    for j in range(problem.law.size):
        kept.forces[j] = kept.units[END, 2 * motion.q.size + j]
    return code

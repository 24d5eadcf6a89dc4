"""The motion of phases under a record: its start, a part of an interval, its end.

The channels of the record are polynomials over every interval; `motions_in_time` follows the motion from
interval to interval.
"""

from ..compiler import kernel
from ..general.crossings import NONE, first_zero, slope_at, value_at
from ..general.problem import TERMS
from ..general.row import put_part
from ..history.course import (
    AT_LIMIT,
    BY_LAW,
    MOST_EVENTS,
    RESOLVED,
    TOO_MANY_EVENTS,
    UNDETERMINED,
    any_slides,
    parts_of,
    slides_on_slowly,
)
from ..history.kept import BEGIN, END, add_slide
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
from .problem import ELASTIC, NORMAL, RIGID, SMOOTH, UP, F, watch_row
from .rest import keep_places, note_places
from .series import (
    advance,
    begin_terms,
    dot,
    factor_held,
    limit_at,
    observe,
    slave_forces,
    stop_exactly,
)
from .watch import clear_leads, is_watched, put_knot, put_watched

#: A spring whose force is within this share of its limit slips, or is about to.
_NEAR = 1e-9

#: Leading terms of a watched quantity that may be zero where a step begins, as at rest under a load t^4.
_MOST_ZEROS = 8


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
    size = AT_LIMIT * abs(value_at(motion.series, F * problem.law.size + j, x))
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
    problem, cell, memory, kept : see `motions_in_time.follow_record`
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
    problem, cell, memory, kept : see `motions_in_time.follow_record`; the channels are there
    jumped : whether the load has changed at the beginning
    listed : whether the states at events are kept

    Returns
    -------
    int : RESOLVED, TOO_MANY_EVENTS or UNDETERMINED
    """
    motion, units, x, immediate = memory.motion, kept.units[BEGIN], 0.0, 0
    show = listed and jumped
    for _ in range(MOST_EVENTS):
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
def rate_of(memory, problem, cell):
    """Bound on the rate of the fastest part of the motion in any phase."""
    return memory.rate[0]


@kernel
def set_length(memory, problem, length):
    """Change the length of parts of intervals, with what is measured in it."""
    before, row, motion = memory.length[0], memory.row, memory.motion
    if length == before:
        return
    memory.length[0], square = length, length * length
    for i in range(problem.squares.size):
        row.stiffness[i] = square * problem.squares[i]
        for other in range(problem.squares.size):
            row.damping[i, other] = length * problem.damping[i, other]
        motion.p[i] *= length / before
    for i in range(memory.free[0]):
        for j in range(problem.law.size):
            row.reaction[j, i] = square * problem.chi[j, i]
            row.push[j, i] = square * problem.normal[j, i]
        for s in range(problem.along.shape[0]):
            row.pull[s, i] = square * problem.along[s, i]
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
def follow_part(memory, problem, cell, course, kept, part, jump, listed):
    """Follow the motion through an equal part of an interval; a code of `_cross`.

    Parameters
    ----------
    memory, problem, cell, course, kept : see `motions_in_time.follow_record`
    part : number of the part; its polynomials are in `memory.channels`
    jump : the interval, if the load jumps where it begins, else -1
    listed : whether the states at events are kept
    """
    jumped = jump >= 0 and part == 0
    if jumped and not _jump(problem, cell, memory, kept):
        return UNDETERMINED
    return _cross(problem, cell, memory, kept, jumped, listed)


@kernel
def _adapt_spring(problem, cell, motion, j, kept):
    """Adapt the spring of a motion that goes on to its friction, see `history.springs.slip_at_start`."""
    most = limit_at(problem, cell, j, dot(problem.normal, j, motion.q))
    size = abs(motion.f[j])
    if size > most * (1.0 + _NEAR):
        way = (size - most) / problem.spring[j]
        add_slide(kept, j, way, 0.5 * (size + most) * way)
        motion.f[j] = most if motion.f[j] > 0.0 else -most
    elif size < most * (1.0 - _NEAR):
        motion.sense[j] = 0


@kernel
def _go_on(problem, cell, memory, senses, kept):
    """Take the pattern of a motion that goes on from its senses; open are contacts by their place.

    Under another load, or less friction, held contacts may begin to slide.
    """
    motion, row = memory.motion, memory.row
    for s in range(motion.piece.size):
        find_piece(problem, motion, s)
    for j in range(problem.law.size):
        motion.open[j] = 0
        if problem.presses[j]:
            pressed = problem.pressed[j] * dot(problem.normal, j, motion.q)
            motion.open[j] = 1 if cell.preload[j] + pressed < 0.0 else 0
        motion.sense[j] = 0 if motion.open[j] != 0 or problem.law[j] == SMOOTH else senses[j]
        if problem.law[j] == ELASTIC and motion.open[j] == 0:
            _adapt_spring(problem, cell, motion, j, kept)
    slave_forces(problem, cell, motion)
    note_senses(memory)
    if not (settle(problem, row, cell, motion, -1, 0) and factor_held(problem, row, motion)):
        return False
    _lead_sliders(problem, memory)
    rest_tied(problem, cell, motion)
    stop_exactly(problem, row, motion)
    return True


@kernel
def begin(memory, problem, cell, course, start, senses, kept):
    """Set the state and the pattern at the start; False if the contacts do not determine their forces.

    Parameters
    ----------
    memory, problem, cell, course, start, senses, kept : see `motions_in_time.follow_record`
    """
    motion, row = memory.motion, memory.row
    parts = parts_of(memory.rate[0], course.steps[0])
    set_length(memory, problem, course.steps[0] / parts)
    put_part(memory.channels, course.pieces[0], 0.0, parts)
    for i in range(memory.free[0]):
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
    elif not _go_on(problem, cell, memory, senses, kept):
        return False
    memory.before[:] = 1
    note_places(problem, memory, 0.0, course.times[0])
    return True


@kernel
def keep_start(memory, problem, cell, kept, shown):
    """Keep the state where the motion begins, if it is `shown`."""
    if any_slides(memory.motion.sense):
        kept.first[0] = kept.clock[0]
    if shown:
        begin_terms(problem, memory.row, cell, memory.motion, TERMS)
        put_units(problem, cell, memory, kept.units[END], 0.0)
        store_state(memory, kept.units[END], 0.0, kept)


@kernel
def keep_sample(memory, problem, kept):
    """Keep the state at the end of an interval."""
    store_state(memory, kept.units[END], 1.0, kept)


@kernel
def creeps(memory, problem):
    """Whether a contact slides so slowly that rounding error hides it."""
    motion = memory.motion
    return slides_on_slowly(motion.sense, motion.q, motion.p, memory.last, memory.row.size)


@kernel
def end(memory, problem, kept):
    """Leave the velocities q' in the state, and keep the forces at the end."""
    for i in range(problem.squares.size):
        memory.motion.p[i] /= memory.length[0]
    for j in range(problem.law.size):
        kept.forces[j] = kept.units[END, 2 * problem.squares.size + j]

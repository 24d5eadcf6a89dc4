"""The motion of banks under a record: its start, an interval, its end.

The stacks of turning points are the state of the banks: what slips next follows from them in every interval.
"""

import math

from ..compiler import kernel
from ..general.problem import LONG
from ..general.row import put_part
from ..history.course import ASLEEP, AWAKE, RESOLVED, TOO_MANY_EVENTS, any_slides, slides_on_slowly
from ..history.kept import END
from ..phases.problem import FIRST, LAST, STUCK
from .fill import put_friction
from .follow import INSTANT, MOST_IMMEDIATE, MOST_STEPS, pass_event
from .kept import (
    OF_INTERVAL,
    OF_STEP,
    keep_step,
    list_changes,
    note_senses,
    put_channels,
    put_loads,
    put_units,
    sense_of,
    store_state,
)
from .level import NOTHING, TURN, displacement, pass_thresholds, put_pulls, slider
from .step import (
    advance,
    choose_length,
    clear_leads,
    contact_velocity,
    first_event,
    put_moves,
    put_rates,
    terms_of_step,
)

#: An element whose spring is stretched to this share of its limit at the start is at it.
_AT_LIMIT = 1.0 - 1e-12

#: A velocity at the start within this share of its terms is rest.
_AT_REST = 1e-12


@kernel
def _expand(memory, problem, cell, x):
    """Fill the series of the step that begins at x of the interval.

    Returns
    -------
    (angle, last) : of the fastest part of the motion in it; whether it is the last one of the interval
    """
    motion, whole = memory.motion, memory.lengths[OF_INTERVAL]
    put_channels(memory, x)
    for j in range(problem.moved.size):
        if contact_velocity(problem, motion, j) == 0.0:  # nothing has moved yet
            motion.now.lead[j] = 1
    rest = (1.0 - x) * whole
    length, angle = choose_length(problem, memory.row, cell, motion, rest)
    count = max(terms_of_step(angle), min(LONG, memory.terms[0] + 2))
    put_loads(memory, length, count)
    put_moves(problem, memory.row, cell, motion, length, count)
    return angle, length >= rest


@kernel
def _show(memory, problem, cell, kept):
    """Keep the state at the beginning of an interval."""
    _expand(memory, problem, cell, 0.0)
    put_units(memory, problem, cell, kept.units[END], 0.0)
    store_state(memory, problem, kept)


@kernel
def _advance(memory, problem, cell, end, kept):
    """Move on by `end` of the present step, with what is kept of it; return the time that takes."""
    motion, length = memory.motion, memory.lengths[OF_STEP]
    keep_step(memory, problem, cell, end, kept)
    for j in range(problem.moved.size):
        if motion.now.level[j] == 0:
            motion.counts[STUCK, j] += end * length
    advance(motion, memory.count[0], length, end)
    return end * length


@kernel
def _pass(memory, problem, cell, j, what, kept, listed):
    """Change the level or the sense of a contact at an event; slips of further elements are not listed.

    Parameters
    ----------
    memory, problem, cell, kept : see `follow_record`
    j, what : contact, and its event, see `step.first_event`
    listed : whether the states on both sides are kept
    """
    show = listed and (what == TURN or memory.motion.now.level[j] == 0)
    if show:
        store_state(memory, problem, kept)
    note_senses(memory)
    pass_event(problem, cell, memory.motion, j, what)
    changed = sense_of(memory.motion.now, j) != memory.before[j]
    list_changes(memory, kept)
    if show and changed:
        store_state(memory, problem, kept)


@kernel
def rate_of(memory, problem, cell):
    """Return 0: steps have lengths of their own, and an interval is one part."""
    return 0.0


@kernel
def set_length(memory, problem, length):
    """Set the length of an interval."""
    memory.lengths[OF_INTERVAL] = length


@kernel
def follow_part(memory, problem, cell, course, kept, part, jump, listed):
    """Follow the motion through the interval that begins at `kept.clock`; RESOLVED or TOO_MANY_EVENTS.

    Parameters
    ----------
    memory, problem, cell, course, kept : see `motions_in_time.follow_record`
    part : 0; the polynomials are in `memory.channels`
    jump : the interval, if the load jumps where it begins, else -1
    listed : whether the states at events are kept
    """
    motion, whole, begin = memory.motion, memory.lengths[OF_INTERVAL], kept.clock[0]
    x, immediate = 0.0, 0
    if jump >= 0 and listed:
        _show(memory, problem, cell, kept)
    for _ in range(MOST_STEPS):
        if x >= 1.0:
            return RESOLVED
        angle, last = _expand(memory, problem, cell, x)
        end, who, what = first_event(problem, cell, motion, memory.count[0])
        if end > 0.0:
            passed = _advance(memory, problem, cell, end, kept)
            x = 1.0 if end == 1.0 and last else x + passed / whole
            kept.clock[0] = begin + x * whole
        else:
            put_units(memory, problem, cell, kept.units[END], 0.0)
        put_channels(memory, x)
        if end * angle > INSTANT:
            clear_leads(motion)
            immediate = 0
        else:
            immediate += 1
            if immediate > MOST_IMMEDIATE * problem.moved.size:
                return TOO_MANY_EVENTS
        if what != NOTHING:
            shown = listed and (end > 0.0 or motion.now.level[who] > 0 or what != TURN)
            _pass(memory, problem, cell, who, what, kept, shown)
    return TOO_MANY_EVENTS


@kernel
def _put_sense(memory, problem, j):
    """Set the sense of a contact at the start: of its velocity, or of what follows if it is at rest."""
    motion, modes = memory.motion, problem.squares.size
    now, chi = motion.now, problem.chi
    w, whole = contact_velocity(problem, motion, j), memory.lengths[OF_INTERVAL]
    size = abs(problem.moved[j] * motion.loads[1, modes])
    for i in range(modes):
        size += abs(chi[j, i] * now.p[i])
    now.lead[j] = 0
    if abs(w) <= _AT_REST * size:
        now.lead[j], w = 1, 0.0
        for i in range(modes):
            w += chi[j, i] * motion.rate[i]
        for d in range(memory.walls.size if memory.terms[0] > 2 else 0):
            bend = 2.0 * memory.present[d, 2] / (whole * whole)
            w -= problem.moved[j] * memory.walls[d] * bend
    now.sense[j] = -1 if w < 0.0 else 1


@kernel
def begin(memory, problem, cell, course, start, senses, kept):
    """Set the state at the start, with the channels and the length of the first interval; True.

    Parameters
    ----------
    memory, problem, cell, course, start, senses, kept : see `motions_in_time.follow_record`
    """
    motion, now = memory.motion, memory.motion.now
    put_friction(problem, cell.limit, cell)
    set_length(memory, problem, course.steps[0])
    put_part(memory.channels, course.pieces[0], 0.0, 1)
    motion.tangent.count[0] = 0
    for i in range(problem.squares.size):
        now.q[i], now.p[i] = start[0, i], start[1, i]
    put_channels(memory, 0.0)
    for j in range(problem.moved.size):
        z = displacement(problem, motion, j)
        motion.z[j, 0] = z
        now.level[j] = 0
        motion.counts[FIRST, j] = motion.counts[LAST, j] = 0.0
        for i in range(problem.first[j], problem.first[j + 1]):
            stretch = memory.stretch[i]
            at_limit = abs(stretch) >= _AT_LIMIT * cell.limit[i]
            now.place[i] = z if at_limit else z - stretch
            now.side[i] = (1.0 if stretch > 0.0 else -1.0) if at_limit else 0.0
        put_pulls(problem, cell, motion, j, problem.first[j + 1] - problem.first[j])
    put_rates(problem, memory.row, cell, motion, motion.z)
    for j in range(problem.moved.size):
        _put_sense(memory, problem, j)
        pass_thresholds(problem, cell, motion, j, motion.z[j, 0])
    return True


@kernel
def keep_start(memory, problem, cell, kept, shown):
    """Note a slip at the start, and keep the state there if it is `shown`."""
    if any_slides(memory.motion.now.level):
        kept.first[0] = kept.clock[0]
    if shown:
        _show(memory, problem, cell, kept)


@kernel
def _product(units, weights, shift):
    """Product of weights (2 m + N) with the state s; see `history.asleep.Bed`."""
    total = 0.0
    for a in range(weights.size):
        total += weights[a] * units[a]
    for i in range(shift.size):
        total -= weights[i] * shift[i]
    return total


@kernel
def sleep_of(memory, problem, cell, kept, bed):
    """Whether no element ever slips again, see `history.asleep`: AWAKE or ASLEEP."""
    if bed.active[0] == 0:
        return AWAKE
    units = kept.units[END]
    motion, forces, square = memory.motion, 2 * problem.squares.size, 0.0
    for v in range(bed.vibration.shape[0]):
        part = _product(units, bed.vibration[v], bed.shift)
        square += part * part
    for j in range(problem.moved.size):
        stiffness = problem.left[problem.first[j] + j]
        z = displacement(problem, motion, j)
        rest = z + (_product(units, bed.forces[j], bed.shift) - units[forces + j]) / stiffness
        reach = math.sqrt(square) * bed.gains[j] / stiffness
        for i in range(problem.first[j], problem.first[j + 1]):
            if abs(rest - slider(problem, cell, motion, j, i, z)) + reach > cell.limit[i]:
                return AWAKE
    return ASLEEP


@kernel
def keep_sample(memory, problem, kept):
    """Keep the state at the end of an interval."""
    store_state(memory, problem, kept)


@kernel
def creeps(memory, problem):
    """Whether elements slip so slowly that rounding error hides it."""
    now = memory.motion.now
    return slides_on_slowly(now.level, now.q, now.p, memory.last, memory.row.size)


@kernel
def end(memory, problem, kept):
    """Leave the elongations, senses and forces at the end."""
    motion, cell = memory.motion, memory.cell
    for j in range(problem.moved.size):
        kept.forces[j] = kept.units[END, 2 * problem.squares.size + j]
        memory.before[j] = sense_of(motion.now, j)
        z = displacement(problem, motion, j)
        for i in range(problem.first[j], problem.first[j + 1]):
            memory.stretch[i] = z - slider(problem, cell, motion, j, i, z)

"""The motion under a record, and after it."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..general.counts import COUNT_ROWS
from ..general.crossings import NONE, value_at
from ..general.follow import count_time, pass_event, prepare
from ..general.laws.coulomb import first_event
from ..general.laws.elastic import rest_springs
from ..general.laws.kinds import has_constraint
from ..general.pattern import BOX_ROWS, PARTICIPATES, settle, slide_velocity
from ..general.problem import PIECE_TERMS, SIZE, TURN, F, H, Motion, P, Q, Row, force_row, normal_row
from ..general.record import clear_record
from ..general.row import make_motion, make_row, set_channels, set_interval
from ..general.series import advance, expand, factor_held
from .asleep import is_asleep
from .kept import keep_ends, keep_state, keep_step, list_changes, store_state
from .tables import Tables, forget, has_tables, make_tables, pass_by_tables

#: What became of a motion.
RESOLVED, RINGING, CREEPING, TOO_MANY_EVENTS, RECORD_TOO_SHORT, UNDETERMINED = 0, 1, 2, 3, 4, 5

#: Events in an interval at most: more are chattering.
_MOST_EVENTS = 2000

#: A force within this share of its limit at a sample is at it: the load after the sample decides.
_AT_LIMIT = 1e-14

#: A velocity at the start within this share of its terms is rest.
_AT_REST = 1e-12

#: Sense of a contact at the start that its law decides.
BY_LAW = 9

#: A slide is over for practical purposes below this speed, relative to displacements and the fastest rate.
_CREEP = 1e-15

#: Row of the scratch for the senses before an event.
_SENSE = 7


class Memory(NamedTuple):
    """Memory of a motion."""

    row: Row
    motion: Motion
    tables: Tables


@entry
def make_memory(problem, watched, wanted):
    """Allocate it; see `tables.make_tables`."""
    tables = make_tables(problem, watched, wanted and has_tables(problem))
    return Memory(make_row(problem), make_motion(problem), tables)


@kernel
def _is_at_limit(problem, friction, motion, j, side, end):
    """Whether the force of a contact is at its limit at the end of the interval, to rounding."""
    force = value_at(motion.series, force_row(problem, j), end)
    limit = friction.static[j] * value_at(motion.series, normal_row(problem, j), end)
    return abs(limit - side * force) <= _AT_LIMIT * abs(limit)


@kernel
def _next_event(problem, friction, motion, end, sample):
    """Return (x, contact, side) of the first event up to `end`; x = NONE without one.

    sample : whether the slope of the load may change at the end, so that a limit that is reached there to
        rounding is not yet exceeded
    """
    found, contact, side = NONE, -1, 0
    for j in range(motion.sense.size):
        x, of = first_event(problem, friction, motion, j)
        if x < found and x <= end:
            if sample and of != 0 and x > 0.0 and _is_at_limit(problem, friction, motion, j, of, end):
                continue
            found, contact, side = x, j, of
    return found, contact, side


@kernel
def _cross(problem, row, friction, motion, box, counts, kept, sample, jumped, keeps):
    """Follow the motion through one interval, or an equal part of one; the polynomials are in `row.loads`.

    Parameters
    ----------
    problem, row, friction, motion, box, counts, kept : see `follow_record`
    sample : whether the part ends at a sample
    jumped : whether the load has jumped at the beginning
    keeps : (whether the states at events are kept, whether that at the end is)

    Returns
    -------
    int : RESOLVED, TOO_MANY_EVENTS or UNDETERMINED
    """
    h = row.numbers[H]
    x = 0.0
    motion.clock[0] = math.nan
    before = motion.scratch[_SENSE]
    for k in range(_MOST_EVENTS):
        rest = 1.0 - x
        expand(problem, row, friction, x * h, 0 if x == 0.0 else -1, motion, True)
        if keeps[0] and (k > 0 or jumped):
            keep_state(problem, row, motion, x, 0.0, kept)
        event = _next_event(problem, friction, motion, rest, sample)
        step = min(event[0], rest)
        if step > 0.0:
            keep_step(problem, row, motion, x, step, kept)
            count_time(motion, counts, step * h)
            advance(problem, row, step, motion)
            for j in range(motion.fresh.size):
                motion.fresh[j] = 0
        if event[1] < 0:
            keep_ends(problem, motion, step, kept)
            return RESOLVED
        if keeps[0]:
            keep_state(problem, row, motion, x + step, step, kept)
        for j in range(motion.sense.size):
            before[j] = motion.sense[j]
        x += step
        if not pass_event(problem, row, friction, x * h, motion, box, counts, event, False):
            return UNDETERMINED
        list_changes(row, motion, before, x, kept)
    return TOO_MANY_EVENTS


@kernel
def _put_pieces(row, pieces, part, parts):
    """Put the polynomials of one of the equal parts of an interval in the row.

    pieces : (D, PIECE_TERMS), over the whole interval
    """
    begin, share = part / parts, 1.0 / parts
    for d in range(pieces.shape[0]):
        for k in range(PIECE_TERMS):
            row.loads[d, k] = pieces[d, k]
        for i in range(PIECE_TERMS - 1):
            for k in range(PIECE_TERMS - 2, i - 1, -1):
                row.loads[d, k] += begin * row.loads[d, k + 1]
        scale = 1.0
        for k in range(PIECE_TERMS):
            row.loads[d, k] *= scale
            scale *= share


@kernel
def _set_length(problem, row, h, motion, tables):
    """Change the length of intervals, with the velocities that are measured in it."""
    before = row.numbers[H]
    if h != before:
        set_interval(problem, 0, row, h)
        for m in range(problem.squares.size):
            motion.state[P, m] *= h / before
        factor_held(problem, row, motion)
        forget(tables)


@kernel
def _jump(problem, row, friction, motion, box, kept):
    """Decide the pattern where the load jumps; False if the contacts do not determine their forces."""
    before = motion.scratch[_SENSE]
    for j in range(motion.sense.size):
        before[j] = motion.sense[j]
    if not _settle(problem, row, friction, motion, box):
        return False
    list_changes(row, motion, before, 0.0, kept)
    return True


@kernel
def _settle(problem, row, friction, motion, box):
    """Ask the law for all held contacts, at the beginning of an interval."""
    motion.clock[0] = math.nan
    set_channels(problem, row, 0.0, 0, motion)
    if not settle(problem, row, friction, 0.0, motion, box, -1, -1):
        return False
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            motion.fresh[j] = 1
    rest_springs(problem, friction, motion, 1)
    return factor_held(problem, row, motion)


@kernel
def _begin(problem, row, friction, motion, box, senses):
    """Decide the pattern of the state at the start; False if the contacts do not determine their forces.

    senses : (N,) of a motion that goes on, or BY_LAW
    """
    modes, channels = problem.push.shape
    motion.clock[0] = math.nan
    set_channels(problem, row, 0.0, 0, motion)
    for j in range(motion.sense.size):
        w = slide_velocity(problem, row, motion, j)
        size = abs(row.numbers[H] * problem.belt[j])
        for m in range(modes):
            size += abs(problem.chi[j, m] * motion.state[P, m])
        for d in range(channels):
            for k in range(1, PIECE_TERMS):
                size += abs(problem.base[j, d] * motion.series[modes + d, k])
        moves = abs(w) > _AT_REST * size and has_constraint(problem, j)
        motion.sense[j] = int(np.sign(w)) if moves else 0
        if senses[j] != BY_LAW:
            motion.sense[j] = senses[j]
    if not prepare(problem, row, friction, motion):
        return False
    return senses[0] != BY_LAW or _settle(problem, row, friction, motion, box)


@kernel
def _follow_interval(problem, row, friction, motion, box, counts, kept, tables, pieces, step, jump, keeps):
    """Follow the motion through an interval of the length `step`; see `follow_record`."""
    parts = max(1, int(math.ceil(problem.rates[0] * step / TURN)))
    _set_length(problem, row, step / parts, motion, tables)
    begin = kept.clock[0]
    for part in range(parts):
        kept.clock[0] = begin + step * (part / parts)
        _put_pieces(row, pieces, part, parts)
        if jump and part == 0 and not _jump(problem, row, friction, motion, box, kept):
            return UNDETERMINED
        sample, jumped = part == parts - 1, jump and part == 0
        if jumped or not (
            tables.known.size > 0 and pass_by_tables(problem, row, friction, motion, counts, kept, tables)
        ):
            code = _cross(problem, row, friction, motion, box, counts, kept, sample, jumped, keeps)
            if code != RESOLVED:
                return code
    if keeps[1]:
        store_state(problem, row, motion, 1.0, kept)
    return RESOLVED


@kernel
def _creeps(problem, row, motion):
    """Whether a contact slides so slowly that rounding error hides it."""
    slides = False
    for j in range(motion.sense.size):
        slides = slides or motion.sense[j] != 0
    if not slides:
        return False
    speed, size = 0.0, row.numbers[SIZE]
    for m in range(problem.squares.size):
        speed = max(speed, abs(motion.state[P, m]))
        size = max(size, abs(motion.state[Q, m]))
    return speed <= _CREEP * size


@entry
def follow_record(problem, memory, friction, start, senses, pieces, steps, times, jumps, kept, bed, limits):
    """Follow the motion under a record and after it.

    Parameters
    ----------
    problem : Problem with r = [1.0] and no harmonics; its first rate bounds that of free motion
    memory : Memory
    friction : Friction
    start, senses : (3, ...) modes, their velocities q', forces of springs; see `_begin`
    pieces : (K, D, PIECE_TERMS) polynomials of the channels over the interval; the last one is that after the
        record
    steps, times : (K,) lengths of the intervals, and when they begin
    jumps : (K,) bool: whether a channel jumps where the interval begins
    kept : Kept
    bed : Bed
    limits : (4,) int: states are kept every so many samples (0: none); intervals after the record at most;
        whether to end when asleep; whether states at events are kept

    Returns
    -------
    (status, counts, state, sense, done, asleep) : see RESOLVED; counters (COUNT_ROWS, N), modes and their
        velocities (2, m), and senses (N,) at the end; intervals followed; after how many of them no contact
        moves again, -1 if this is not proved
    """
    contacts = problem.spring.size
    problem, friction, kept, bed = packed(problem), packed(friction), packed(kept), packed(bed)
    row, motion, tables = packed(memory.row), packed(memory.motion), packed(memory.tables)
    box, counts = np.zeros((BOX_ROWS, contacts)), np.zeros((COUNT_ROWS, contacts))
    row.intervals[0] = 1
    row.loads[:] = 0.0
    clear_record(kept.record)
    parts = max(1, int(math.ceil(problem.rates[0] * steps[0] / TURN)))
    set_interval(problem, 0, row, steps[0] / parts)
    for m in range(problem.squares.size):
        motion.state[Q, m] = start[Q, m]
        motion.state[P, m] = start[P, m] * row.numbers[H]
    for j in range(contacts):
        motion.state[F, j] = start[F, j]
    _put_pieces(row, pieces[0], 0, parts)
    status = RESOLVED if _begin(problem, row, friction, motion, box, senses) else UNDETERMINED
    last = steps.size - 1
    if status == RESOLVED and limits[0] > 0:
        expand(problem, row, friction, 0.0, 0, motion, True)
        keep_state(problem, row, motion, 0.0, 0.0, kept)
    done, asleep = 0, -1
    if limits[2] != 0:
        status = RINGING if status == RESOLVED else status
    while status == RESOLVED or status == RINGING:
        k = min(done, last)
        if k == last and asleep < 0 and is_asleep(row, friction, motion, bed):
            asleep = done
        if asleep >= 0 and limits[2] != 0:
            status = RESOLVED
            break
        if done >= last + limits[1]:
            break
        kept.clock[0] = times[k] + (done - k) * steps[k]
        jump = jumps[k] and done == k and done > 0
        keeps = (limits[3] != 0, limits[0] > 0 and ((done + 1) % max(1, limits[0]) == 0 or done + 1 == last))
        code = _follow_interval(
            problem, row, friction, motion, box, counts, kept, tables, pieces[k], steps[k], jump, keeps
        )
        if code != RESOLVED:
            status = code
            break
        done += 1
        if k == last and limits[2] != 0 and _creeps(problem, row, motion):
            status = CREEPING
            break
    state = np.zeros((2, problem.squares.size))
    for m in range(problem.squares.size):
        state[Q, m] = motion.state[Q, m]
        state[P, m] = motion.state[P, m] / row.numbers[H]
    if asleep < 0 and done >= last and is_asleep(row, friction, motion, bed):
        asleep = done
    return status, counts, state, motion.sense, done, asleep

"""Motions under records and after them, from interval to interval, of all engines.

An engine is chosen by the class of its memory (`by_class`): `history.motion` follows contacts under given
normal loads, `phases.under_record` contacts that open and piecewise linear springs, and `banks.under_record`
banks of elastic elements.
"""

from .banks import under_record as banks
from .banks.kept import Memory as BankMemory
from .compiler import by_class, entry, kernel
from .compiler.packed import packed
from .general.record import clear_record
from .general.row import put_part
from .history import motion as general
from .history.course import (
    AFTER,
    ASLEEP,
    CREEPING,
    ELSEWHERE,
    EVERY,
    LISTED,
    RESOLVED,
    RINGING,
    TO_REST,
    UNDETERMINED,
    parts_of,
)
from .phases import rest
from .phases import under_record as phases
from .phases.kept import Memory as PhaseMemory

#: The phase at the end has no bed yet: the caller makes it and goes on.
NEEDS_BED = -1

#: Places in `state`: intervals followed, -1 before the start; after how many of them no contact moves again,
#: -1 where this is not proved.
DONE, SINCE = 0, 1


def _each(name: str) -> tuple:
    memories = ((general.Memory, general), (PhaseMemory, phases), (BankMemory, banks))
    return tuple((memory, getattr(module, name)) for memory, module in memories)


@by_class(*_each("begin"))
def _begin(memory, problem, friction, course, start, senses, kept):
    """Set the state and the pattern at the start; False if the contacts do not determine their forces.

    Parameters
    ----------
    memory, problem, friction, course, start, senses, kept : see `follow_record`
    """


@by_class(*_each("keep_start"))
def _keep_start(memory, problem, friction, kept, shown):
    """Keep what there is where the motion begins, and the state there if it is `shown`."""


@by_class(*_each("rate_of"))
def _rate_of(memory, problem, friction):
    """Bound on the rate of the fastest part of the motion."""


@by_class(*_each("set_length"))
def _set_length(memory, problem, length):
    """Change the length of parts of intervals, with what is measured in it."""


@by_class(*_each("follow_part"))
def _follow_part(memory, problem, friction, course, kept, part, jump, listed):
    """Follow the motion through an equal part of an interval: RESOLVED, TOO_MANY_EVENTS or UNDETERMINED.

    Parameters
    ----------
    memory, problem, friction, course, kept : see `follow_record`
    part : number of the part; its polynomials are in `memory.channels`
    jump : the interval, if the load jumps where it begins, else -1
    listed : whether the states at events are kept
    """


@by_class(*_each("keep_sample"))
def _keep_sample(memory, problem, kept):
    """Keep the state at the end of an interval."""


@by_class((general.Memory, general.sleep_of), (PhaseMemory, rest.sleep_of), (BankMemory, banks.sleep_of))
def _sleep_of(memory, problem, friction, kept, bed):
    """Whether no contact ever moves again under no load: AWAKE, ASLEEP or ELSEWHERE."""


@by_class(*_each("creeps"))
def _creeps(memory, problem):
    """Whether a contact slides so slowly that rounding error hides it."""


@by_class(*_each("end"))
def _end(memory, problem, kept):
    """Leave the velocities q' in the state, and keep the forces at the end."""


@kernel
def _follow_interval(memory, problem, friction, course, kept, done, listed):
    """Follow the motion through the next interval; a code of `_follow_part`.

    Parameters
    ----------
    memory, problem, friction, course, kept : see `follow_record`
    done : intervals followed before
    listed : whether the states at events are kept
    """
    k = min(done, course.steps.size - 1)
    jump = k if course.jumps[k] and done == k and done > 0 else -1
    step = course.steps[k]
    parts = parts_of(_rate_of(memory, problem, friction), step)
    _set_length(memory, problem, step / parts)
    begin = course.times[k] + (done - k) * step
    for part in range(parts):
        kept.clock[0] = begin + step * (part / parts)
        put_part(memory.channels, course.pieces[k], done - k + part / parts, parts)
        code = _follow_part(memory, problem, friction, course, kept, part, jump, listed)
        if code != RESOLVED:
            return code
    return RESOLVED


@kernel
def _follow(memory, problem, friction, course, kept, bed, limits, state):
    """Follow the motion from where it is; a status or NEEDS_BED.

    Parameters
    ----------
    memory, problem, friction, course, kept, bed, limits, state : see `follow_record`
    """
    last, to_rest = course.steps.size - 1, limits[TO_REST] != 0
    while True:
        done = state[DONE]
        k = min(done, last)
        if k == last and state[SINCE] < 0:
            sleep = _sleep_of(memory, problem, friction, kept, bed)
            if sleep == ELSEWHERE:
                return NEEDS_BED
            if sleep == ASLEEP:
                state[SINCE] = done
        if state[SINCE] >= 0 and to_rest:
            return RESOLVED
        if done >= last + limits[AFTER]:
            return RINGING if to_rest else RESOLVED
        code = _follow_interval(memory, problem, friction, course, kept, done, limits[LISTED] != 0)
        if code != RESOLVED:
            return code
        state[DONE] = done + 1
        if limits[EVERY] > 0 and ((done + 1) % limits[EVERY] == 0 or done + 1 == last):
            _keep_sample(memory, problem, kept)
        if k == last and to_rest and _creeps(memory, problem):
            return CREEPING


@entry
def follow_record(problem, friction, memory, course, start, senses, kept, bed, limits, state):
    """Follow the motion under a record and after it, or go on with a further bed.

    Parameters
    ----------
    problem : Problem of the engine; of `general` with r = [1.0], no harmonics, and a first rate that bounds
        that of free motion
    friction : Friction, or Cell of `phases` or `banks`
    memory : Memory of the engine; its counters and the state are those at the end
    course : Course
    start : (3, ...) modes, their velocities q', forces of springs
    senses : (N,) of a motion that goes on; else BY_LAW
    kept : Kept
    bed : Bed of the engine; of `phases` that of one phase
    limits : (4,) int, see `history.course.EVERY`
    state : (2,) int, see DONE; both -1 before the start

    Returns
    -------
    int : status, see `history.course.RESOLVED`, or NEEDS_BED
    """
    problem, friction, memory = packed(problem), packed(friction), packed(memory)
    course, kept, bed = packed(course), packed(kept), packed(bed)
    if state[DONE] < 0:
        clear_record(kept.record)
        state[DONE] = 0
        kept.clock[0] = course.times[0]
        if not _begin(memory, problem, friction, course, start, senses, kept):
            return UNDETERMINED
        _keep_start(memory, problem, friction, kept, limits[EVERY] > 0)
    status = _follow(memory, problem, friction, course, kept, bed, limits, state)
    if status != NEEDS_BED:
        _end(memory, problem, kept)
    return status

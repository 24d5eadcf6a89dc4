"""The motion from one phase of the load to another: steps, and the events that end them."""

import math

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, load, store
from .crossings import NONE, first_zero, slope_at, value_at
from .glide import can_glide, glide
from .pattern import rest_springs, settle, stop_exactly
from .problem import SECTION, TERMS, WIDTH, set_channels
from .record import record_step
from .series import advance, expand, factor_held, first_contact_row
from .tangent import advance_tangent, hold_tangent, through_event, watched_row

#: Phases of no length in a row after which the contacts chatter.
_MOST_IMMEDIATE = 200

#: Events in an interval of the load, at most.
_MOST_EVENTS = 1000

#: Loads within this share of their limit are at it together, for contacts with mu = 1.
_AT_LIMIT = 1e-11

#: A velocity within this share of its size is zero together with one that is.
_TOGETHER = 1e-11

#: Rows of `law` and `counts`.
LAW_ROWS = 10
STOPS, TURNS, STUCK, SLIPS, REVERSALS, LAST_SENSE = 0, 1, 2, 3, 4, 5
MOVED = 6  # 0: at rest; 1, 2: slid up, down; 3: both
NEAREST_STOP = 7  # largest share that friction has of the force that would hold a contact at a turn
FIRST_SENSE = 8  # of the slips of an elastic contact; 0 before the first
RELEASE_ORDER = 9  # 1 where releasing all overloaded contacts at once would leave it in another state
STOPS_ERROR, STUCK_ERROR = 10, 11  # standard errors per period of the load, of averages; else 0
COUNT_ROWS = 12

FOLLOWED, CHATTERS, UNDETERMINED = 0, 1, 2


@inner_kernel
def _watch(series, source, sign, shift, scratch):
    """Copy sign times a series without its first terms, which are zero, to scratch[0]; return its zero."""
    for k in range(0, TERMS, LANES):
        store(load(series, source * WIDTH + k + shift) * sign, scratch, k)
    return first_zero(scratch, 0)


@inner_kernel
def _within(series, force, nu, size, sign, shift, scratch):
    """Copy the distance of a force from one side of its range to scratch[0]; return its first zero.

    Parameters
    ----------
    series : series of the step
    force, nu : rows of the force and of the normal load
    size : static friction under constant normal load
    sign : 1.0 or -1.0, the side
    shift : number of leading terms that are zero by definition
    scratch : its row 0 is filled
    """
    for k in range(0, TERMS, LANES):
        at = k + shift
        limit = load(series, nu * WIDTH + at) * size
        store(limit - load(series, force * WIDTH + at) * sign, scratch, k)
    if shift > 0 and scratch[0, 0] < 0.0:
        return 0.0  # at its limit, and about to exceed it
    return first_zero(scratch, 0)


@inner_kernel
def _first_event(problem, friction, work, end):
    """Return (x, contact, side) of the first event in the present step up to `end`; x = NONE without one.

    side: 0 for a velocity that vanishes, else the side of its range that a force reaches.
    """
    contacts = problem.spring.size
    first = first_contact_row(problem)
    found, contact, side = NONE, -1, 0
    for j in range(contacts):
        w, force, nu = first + contacts + j, first + 2 * contacts + j, first + 3 * contacts + j
        if work.sense[j] != 0:
            x = _watch(work.series, w, float(work.sense[j]), work.fresh[j], work.scratch)
            if x < found:
                found, contact, side = x, j, 0
            continue
        if work.idle[j]:
            continue
        for sign in (1, -1):
            shift = max(0, sign * work.fresh[j])
            x = _within(work.series, force, nu, friction.static[j], float(sign), shift, work.scratch)
            if x < found:
                found, contact, side = x, j, sign
    if found > end:
        return NONE, -1, 0
    return found, contact, side


@kernel
def _release_without_drop(problem, friction, work, x, contact, side):
    """Let a contact with mu = 1 slide on at the limit of its load, with all that are at theirs and go on."""
    contacts = problem.spring.size
    first = first_contact_row(problem)
    for j in range(contacts):
        if problem.spring[j] != 0.0 or work.sense[j] != 0 or friction.static[j] > friction.kinetic[j]:
            continue
        force, nu = first + 2 * contacts + j, first + 3 * contacts + j
        load = value_at(work.series, force, x)
        sign = side if j == contact else (1 if load > 0.0 else -1)
        limit = friction.static[j] * value_at(work.series, nu, x)
        rate = sign * slope_at(work.series, force, x) - friction.static[j] * slope_at(work.series, nu, x)
        if j == contact or (sign * load >= limit * (1.0 - _AT_LIMIT) and rate > 0.0):
            work.sense[j] = sign
            work.fresh[j] = 2


@kernel
def _comes_to_rest(work, w, sense, x):
    """Whether a velocity is zero at x up to rounding error, and on its way down."""
    size = 0.0
    for k in range(TERMS):
        size += abs(work.series[w, k])
    if abs(value_at(work.series, w, x)) > _TOGETHER * size:
        return False
    return sense * slope_at(work.series, w, x) <= 0.0


@kernel
def _arrives_instead(problem, work, x, contact):
    """A rigid contact that comes to rest where the slip of an elastic one ends, or that one.

    Both have one velocity where they are side by side; what the rigid one does decides what follows.
    """
    first_w = first_contact_row(problem) + problem.spring.size
    for j in range(work.sense.size):
        slides = problem.spring[j] == 0.0 and work.sense[j] != 0
        if slides and _comes_to_rest(work, first_w + j, work.sense[j], x):
            return j
    return contact


@kernel
def _end_slip(friction, work, j):
    """Let the slider of an elastic contact rest."""
    work.state[2, j] = work.sense[j] * friction.kinetic[j]
    work.fresh[j] = 2 * work.sense[j]
    work.sense[j] = 0


@kernel
def _end_slips(problem, friction, work, x):
    """End the slips of elastic contacts whose velocities are zero at x of the present step."""
    contacts = problem.spring.size
    first_w = first_contact_row(problem) + contacts
    for j in range(contacts):
        slips = problem.spring[j] != 0.0 and work.sense[j] != 0
        if slips and _comes_to_rest(work, first_w + j, work.sense[j], x):
            _end_slip(friction, work, j)


@kernel
def _after_elastic(problem, friction, work, x, contact, side):
    """Change the pattern of an elastic contact, and of all others that stop slipping with it.

    Elements of a bank slip together, and so do contacts of a symmetric structure.
    """
    if side != 0:
        work.state[2, contact] = side * friction.kinetic[contact]
        work.sense[contact] = side
        work.fresh[contact] = max(0, side * work.fresh[contact] - 1)  # the force's zeros less one of w
        return
    _end_slip(friction, work, contact)
    _end_slips(problem, friction, work, x)


@kernel
def _change_pattern(problem, row, friction, tau, work, law, x, contact, side):
    """Change the pattern after an event; False if the contacts do not determine their forces.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau : phase of the event
    work, law : Work, scratch of `settle`
    x, contact, side : the event, see `_first_event`
    """
    if problem.spring[contact] != 0.0:
        _after_elastic(problem, friction, work, x, contact, side)
        return True
    if side != 0 and friction.static[contact] <= friction.kinetic[contact]:
        _release_without_drop(problem, friction, work, x, contact, side)
        return True
    arrived, released = (contact, -1) if side == 0 else (-1, contact)
    if not settle(problem, row, friction, tau, work, law, arrived, released):
        return False
    for j in range(work.sense.size):
        if law[3, j] != 0.0:
            work.fresh[j] = 1 if work.sense[j] != 0 else 0
    _end_slips(problem, friction, work, x)
    return True


@kernel
def _count(problem, work, law, before, counts):
    """Count stops, turns, slips and reversals from the pattern before and after an event."""
    for j in range(work.sense.size):
        old, new = int(before[j]), work.sense[j]
        if new == old:
            continue
        if problem.spring[j] != 0.0:
            if new != 0:
                counts[SLIPS, j] += 1.0
                if counts[LAST_SENSE, j] * new < 0.0:
                    counts[REVERSALS, j] += 1.0
                counts[LAST_SENSE, j] = new
                if counts[FIRST_SENSE, j] == 0.0:
                    counts[FIRST_SENSE, j] = new
        elif new == 0:
            counts[STOPS, j] += 1.0
        elif old != 0:
            counts[TURNS, j] += 1.0
            counts[NEAREST_STOP, j] = max(counts[NEAREST_STOP, j], law[4, j] / abs(law[7, j]))


@inner_kernel
def _count_time(work, counts, time):
    """Add a time > 0 in which the pattern was the present one."""
    for j in range(work.sense.size):
        if work.sense[j] == 0:
            counts[STUCK, j] += time
        else:
            way = 1.0 if work.sense[j] > 0 else 2.0
            counts[MOVED, j] = way if counts[MOVED, j] in (0.0, way) else 3.0


@kernel
def _forces_at(problem, work, x, out):
    """Friction forces at x of the present step."""
    contacts = problem.spring.size
    first = first_contact_row(problem)
    for j in range(contacts):
        out[j] = value_at(work.series, first + 2 * contacts + j, x)


@kernel
def _event(problem, row, friction, tau, work, law, counts, event, derive):
    """Change the pattern at an event, count it, and carry the derivatives through it.

    Parameters
    ----------
    problem, row, friction, work : Problem, Row, Friction, Work; the state is that of the event
    tau : phase of the event
    law, counts : scratch of `settle`, counters
    event : (x, contact, side) of `_first_event`
    derive : whether the derivatives are carried on; they are those of just before the event

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    x, contact, side = event
    if side == 0 and problem.spring[contact] != 0.0:
        contact = _arrives_instead(problem, work, x, contact)
    contacts = problem.spring.size
    first = first_contact_row(problem)
    series, scratch = work.series, work.scratch
    before, forces = scratch[1], scratch[2]
    for j in range(contacts):
        before[j] = work.sense[j]
    _forces_at(problem, work, x, forces)
    if side == 0:
        slope = slope_at(series, first + contacts + contact, x)
    else:
        slope = friction.static[contact] * slope_at(series, first + 3 * contacts + contact, x)
        slope -= side * slope_at(series, first + 2 * contacts + contact, x)
    settles = problem.spring[contact] == 0.0 and (
        side == 0 or friction.static[contact] > friction.kinetic[contact]
    )
    if derive:
        watched_row(problem, row, work, contact, side, work.watched)
    if settles and derive:
        for j in range(contacts):
            scratch[3, j] = forces[j]
            scratch[4, j] = value_at(series, first + 3 * contacts + j, x)
    if not _change_pattern(problem, row, friction, tau, work, law, x, contact, side):
        return False
    rest_springs(problem, friction, work, 1 if settles else 2)
    _count(problem, work, law, before, counts)
    if settles:
        for j in range(contacts):
            counts[RELEASE_ORDER, j] = max(counts[RELEASE_ORDER, j], law[8, j])
    if not factor_held(problem, row, work):
        return False
    if derive:
        for j in range(contacts):
            if not settles or problem.spring[j] != 0.0:
                forces[j] = 0.0
            elif work.sense[j] != 0:
                forces[j] = work.sense[j] * friction.kinetic[j] * scratch[4, j] - scratch[3, j]
            else:
                forces[j] = law[1, j] - scratch[3, j]
        through_event(problem, row, work, forces, work.watched, slope)
        hold_tangent(problem, row, work)
    return True


@kernel
def _cross(problem, row, friction, begin, interval, length, work, law, counts, record, derive):
    """Follow the motion through one interval of the load, or a part of it.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    begin, interval : phase and number of the interval, see `set_channels`
    length : length of the part, over that of the interval
    work, law, counts, record, derive : see `follow`

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    h = row.numbers[0]
    x = 0.0
    tau = begin
    immediate = 0
    for _ in range(_MOST_EVENTS):
        rest = length - x
        expand(problem, row, friction, tau, interval if x == 0.0 else -1, work, record.active[0] != 0)
        event = _first_event(problem, friction, work, rest)
        step = min(event[0], rest)
        if record.active[0] != 0:
            record_step(problem, row, work, step, record)
        if derive and step > 0.0:
            advance_tangent(problem, row, work, step)
        if step > 0.0:
            _count_time(work, counts, step * h)
            advance(problem, row, step, work)
            for j in range(work.fresh.size):
                work.fresh[j] = 0
        if event[1] < 0:
            return FOLLOWED
        x += step
        tau = begin + x * h
        immediate = immediate + 1 if step == 0.0 else 0
        if immediate > _MOST_IMMEDIATE:
            return CHATTERS
        if not _event(problem, row, friction, tau, work, law, counts, event, derive):
            return UNDETERMINED
    return CHATTERS


@kernel
def _begin(problem, row, friction, work):
    """Prepare the state and pattern in `work`; False if the contacts do not determine their forces."""
    work.clock[0] = math.nan
    for j in range(work.idle.size):
        work.idle[j] = False
    rest_springs(problem, friction, work, 0)
    return factor_held(problem, row, work)


@kernel
def follow(problem, row, friction, part, work, law, counts, record, derive):
    """Follow the motion for half a period of the load.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    part : 0 or 1: the half period that begins at the section, or the one after it
    work : Work; state and pattern are replaced by those at the end, and `tangent` is multiplied if `derive`
    law : (LAW_ROWS, N) scratch
    counts : (COUNT_ROWS, N) counters, increased
    record : Record
    derive : whether the derivatives are carried on

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    h = row.numbers[0]
    if not _begin(problem, row, friction, work):
        return UNDETERMINED
    intervals = row.intervals[0]
    # a state that Newton's method or other states led to, with their errors
    set_channels(problem, row, SECTION + part * intervals * h, part * intervals, work)
    stop_exactly(problem, row, work)
    if derive:
        hold_tangent(problem, row, work)
    glides = record.active[0] == 0 and can_glide(problem, row)
    for k in range(intervals):
        interval = part * intervals + k
        if glides and glide(problem, row, friction, interval, work):
            _count_time(work, counts, h)
            if derive:
                advance_tangent(problem, row, work, 1.0)
            continue
        begin = SECTION + interval * h
        code = _cross(problem, row, friction, begin, interval, 1.0, work, law, counts, record, derive)
        if code != FOLLOWED:
            return code
    return FOLLOWED


@kernel
def follow_to_section(problem, row, friction, begin, work, law, counts, record):
    """Follow the motion from a phase to the next section.

    Parameters
    ----------
    problem, row, friction, work, law, counts, record : see `follow`
    begin : the phase, from 0 to 2 pi

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    h = row.numbers[0]
    if not _begin(problem, row, friction, work):
        return UNDETERMINED
    parts = (SECTION if begin <= SECTION else SECTION + 2.0 * math.pi) / h - begin / h
    for k in range(int(math.ceil(parts))):
        length = min(1.0, parts - k)
        code = _cross(problem, row, friction, begin + k * h, -1, length, work, law, counts, record, False)
        if code != FOLLOWED:
            return code
    return FOLLOWED

"""The motion from one phase of the load to another: steps, and the events that end them."""

import math

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, load, store
from .crossings import NONE, first_zero, slope_at, value_at
from .glide import can_glide, glide
from .pattern import FORCE, HOLDING, KINETIC, ORDER_MATTERS, PARTICIPATES, rest_springs, settle, stop_exactly
from .problem import SECTION, TERMS, WIDTH, F, H, set_channels
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

#: Rows of the scratch: the watched quantity; of every contact its sense and force before an event, the change
#: of its force, and its normal load.  Further rows: see `record`, `events`.
_WATCHED, _SENSE, _BEFORE, _CHANGE, _NORMAL = 0, 1, 3, 2, 4

#: Rows of `counts`.
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
    return first_zero(scratch, _WATCHED)


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
    if shift > 0 and scratch[_WATCHED, 0] < 0.0:
        return 0.0  # at its limit, and about to exceed it
    return first_zero(scratch, _WATCHED)


@inner_kernel
def _first_event(problem, friction, motion, end):
    """Return (x, contact, side) of the first event in the present step up to `end`; x = NONE without one.

    side: 0 for a velocity that vanishes, else the side of its range that a force reaches.
    """
    contacts = problem.spring.size
    first = first_contact_row(problem)
    found, contact, side = NONE, -1, 0
    for j in range(contacts):
        w, force, nu = first + contacts + j, first + 2 * contacts + j, first + 3 * contacts + j
        if motion.sense[j] != 0:
            x = _watch(motion.series, w, float(motion.sense[j]), motion.fresh[j], motion.scratch)
            if x < found:
                found, contact, side = x, j, 0
            continue
        if motion.idle[j]:
            continue
        for sign in (1, -1):
            shift = max(0, sign * motion.fresh[j])
            x = _within(motion.series, force, nu, friction.static[j], float(sign), shift, motion.scratch)
            if x < found:
                found, contact, side = x, j, sign
    if found > end:
        return NONE, -1, 0
    return found, contact, side


@kernel
def _release_without_drop(problem, friction, motion, x, contact, side):
    """Let a contact with mu = 1 slide on at the limit of its load, with all that are at theirs and go on."""
    contacts = problem.spring.size
    first = first_contact_row(problem)
    for j in range(contacts):
        if problem.spring[j] != 0.0 or motion.sense[j] != 0 or friction.static[j] > friction.kinetic[j]:
            continue
        force, nu = first + 2 * contacts + j, first + 3 * contacts + j
        load = value_at(motion.series, force, x)
        sign = side if j == contact else (1 if load > 0.0 else -1)
        limit = friction.static[j] * value_at(motion.series, nu, x)
        rate = sign * slope_at(motion.series, force, x) - friction.static[j] * slope_at(motion.series, nu, x)
        if j == contact or (sign * load >= limit * (1.0 - _AT_LIMIT) and rate > 0.0):
            motion.sense[j] = sign
            motion.fresh[j] = 2


@kernel
def _comes_to_rest(motion, w, sense, x):
    """Whether a velocity is zero at x up to rounding error, and on its way down."""
    size = 0.0
    for k in range(TERMS):
        size += abs(motion.series[w, k])
    if abs(value_at(motion.series, w, x)) > _TOGETHER * size:
        return False
    return sense * slope_at(motion.series, w, x) <= 0.0


@kernel
def _arrives_instead(problem, motion, x, contact):
    """A rigid contact that comes to rest where the slip of an elastic one ends, or that one.

    Both have one velocity where they are side by side; what the rigid one does decides what follows.
    """
    first_w = first_contact_row(problem) + problem.spring.size
    for j in range(motion.sense.size):
        slides = problem.spring[j] == 0.0 and motion.sense[j] != 0
        if slides and _comes_to_rest(motion, first_w + j, motion.sense[j], x):
            return j
    return contact


@kernel
def _end_slip(friction, motion, j):
    """Let the slider of an elastic contact rest."""
    motion.state[F, j] = motion.sense[j] * friction.kinetic[j]
    motion.fresh[j] = 2 * motion.sense[j]
    motion.sense[j] = 0


@kernel
def _end_slips(problem, friction, motion, x):
    """End the slips of elastic contacts whose velocities are zero at x of the present step."""
    contacts = problem.spring.size
    first_w = first_contact_row(problem) + contacts
    for j in range(contacts):
        slips = problem.spring[j] != 0.0 and motion.sense[j] != 0
        if slips and _comes_to_rest(motion, first_w + j, motion.sense[j], x):
            _end_slip(friction, motion, j)


@kernel
def _after_elastic(problem, friction, motion, x, contact, side):
    """Change the pattern of an elastic contact, and of all others that stop slipping with it.

    Elements of a bank slip together, and so do contacts of a symmetric structure.
    """
    if side != 0:
        motion.state[F, contact] = side * friction.kinetic[contact]
        motion.sense[contact] = side
        motion.fresh[contact] = max(0, side * motion.fresh[contact] - 1)  # the force's zeros less one of w
        return
    _end_slip(friction, motion, contact)
    _end_slips(problem, friction, motion, x)


@kernel
def _change_pattern(problem, row, friction, tau, motion, box, x, contact, side):
    """Change the pattern after an event; False if the contacts do not determine their forces.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau : phase of the event
    motion, box : Motion, scratch of `settle`
    x, contact, side : the event, see `_first_event`
    """
    if problem.spring[contact] != 0.0:
        _after_elastic(problem, friction, motion, x, contact, side)
        return True
    if side != 0 and friction.static[contact] <= friction.kinetic[contact]:
        _release_without_drop(problem, friction, motion, x, contact, side)
        return True
    arrived, released = (contact, -1) if side == 0 else (-1, contact)
    if not settle(problem, row, friction, tau, motion, box, arrived, released):
        return False
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0:
            motion.fresh[j] = 1 if motion.sense[j] != 0 else 0
    _end_slips(problem, friction, motion, x)
    return True


@kernel
def _count(problem, motion, box, before, counts):
    """Count stops, turns, slips and reversals from the pattern before and after an event."""
    for j in range(motion.sense.size):
        old, new = int(before[j]), motion.sense[j]
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
            counts[NEAREST_STOP, j] = max(counts[NEAREST_STOP, j], box[KINETIC, j] / abs(box[HOLDING, j]))


@inner_kernel
def _count_time(motion, counts, time):
    """Add a time > 0 in which the pattern was the present one."""
    for j in range(motion.sense.size):
        if motion.sense[j] == 0:
            counts[STUCK, j] += time
        else:
            way = 1.0 if motion.sense[j] > 0 else 2.0
            counts[MOVED, j] = way if counts[MOVED, j] in (0.0, way) else 3.0


@kernel
def _forces_at(problem, motion, x, out):
    """Friction forces at x of the present step."""
    contacts = problem.spring.size
    first = first_contact_row(problem)
    for j in range(contacts):
        out[j] = value_at(motion.series, first + 2 * contacts + j, x)


@kernel
def _event(problem, row, friction, tau, motion, box, counts, event, derive):
    """Change the pattern at an event, count it, and carry the derivatives through it.

    Parameters
    ----------
    problem, row, friction, motion : Problem, Row, Friction, Motion; the state is that of the event
    tau : phase of the event
    box, counts : scratch of `settle`, counters
    event : (x, contact, side) of `_first_event`
    derive : whether the derivatives are carried on; they are those of just before the event

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    x, contact, side = event
    if side == 0 and problem.spring[contact] != 0.0:
        contact = _arrives_instead(problem, motion, x, contact)
    contacts = problem.spring.size
    first = first_contact_row(problem)
    series, scratch = motion.series, motion.scratch
    before, forces = scratch[_SENSE], scratch[_CHANGE]
    for j in range(contacts):
        before[j] = motion.sense[j]
    _forces_at(problem, motion, x, forces)
    if side == 0:
        slope = slope_at(series, first + contacts + contact, x)
    else:
        slope = friction.static[contact] * slope_at(series, first + 3 * contacts + contact, x)
        slope -= side * slope_at(series, first + 2 * contacts + contact, x)
    settles = problem.spring[contact] == 0.0 and (
        side == 0 or friction.static[contact] > friction.kinetic[contact]
    )
    if derive:
        watched_row(problem, row, motion, contact, side, motion.watched)
    if settles and derive:
        for j in range(contacts):
            scratch[_BEFORE, j] = forces[j]
            scratch[_NORMAL, j] = value_at(series, first + 3 * contacts + j, x)
    if not _change_pattern(problem, row, friction, tau, motion, box, x, contact, side):
        return False
    rest_springs(problem, friction, motion, 1 if settles else 2)
    _count(problem, motion, box, before, counts)
    if settles:
        for j in range(contacts):
            counts[RELEASE_ORDER, j] = max(counts[RELEASE_ORDER, j], box[ORDER_MATTERS, j])
    if not factor_held(problem, row, motion):
        return False
    if derive:
        for j in range(contacts):
            if not settles or problem.spring[j] != 0.0:
                forces[j] = 0.0
            elif motion.sense[j] != 0:
                forces[j] = motion.sense[j] * friction.kinetic[j] * scratch[_NORMAL, j] - scratch[_BEFORE, j]
            else:
                forces[j] = box[FORCE, j] - scratch[_BEFORE, j]
        through_event(problem, row, motion, forces, motion.watched, slope)
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
        event = _first_event(problem, friction, motion, rest)
        step = min(event[0], rest)
        if record.active[0] != 0:
            record_step(problem, row, motion, step, record)
        if derive and step > 0.0:
            advance_tangent(problem, row, motion, step)
        if step > 0.0:
            _count_time(motion, counts, step * h)
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
        if not _event(problem, row, friction, tau, motion, box, counts, event, derive):
            return UNDETERMINED
    return CHATTERS


@kernel
def _begin(problem, row, friction, motion):
    """Prepare the state and pattern in `motion`; False if the contacts do not determine their forces."""
    motion.clock[0] = math.nan
    for j in range(motion.idle.size):
        motion.idle[j] = False
    rest_springs(problem, friction, motion, 0)
    return factor_held(problem, row, motion)


@kernel
def follow(problem, row, friction, part, motion, box, counts, record, derive):
    """Follow the motion for half a period of the load.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    part : 0 or 1: the half period that begins at the section, or the one after it
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
    if not _begin(problem, row, friction, motion):
        return UNDETERMINED
    intervals = row.intervals[0]
    # a state that Newton's method or other states led to, with their errors
    set_channels(problem, row, SECTION + part * intervals * h, part * intervals, motion)
    stop_exactly(problem, row, motion)
    if derive:
        hold_tangent(problem, row, motion)
    glides = record.active[0] == 0 and can_glide(problem, row)
    for k in range(intervals):
        interval = part * intervals + k
        if glides and glide(problem, row, friction, interval, motion):
            _count_time(motion, counts, h)
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
    if not _begin(problem, row, friction, motion):
        return UNDETERMINED
    parts = (SECTION if begin <= SECTION else SECTION + 2.0 * math.pi) / h - begin / h
    for k in range(int(math.ceil(parts))):
        length = min(1.0, parts - k)
        code = _cross(problem, row, friction, begin + k * h, -1, length, motion, box, counts, record, False)
        if code != FOLLOWED:
            return code
    return FOLLOWED

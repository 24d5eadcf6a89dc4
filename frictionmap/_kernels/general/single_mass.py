"""The steady state of one mass with one rigid contact, for mu = 1: from that of its neighbour, by tables.

Between events the mass is an oscillator, so a slide needs two numbers for an interval, and a stop one.  What
is watched is bounded by sums of control points, as in `glide`; events are located on the series by
`approach`.  Newton's method needs the derivatives by two coordinates only.  Where anything is unusual (a
pattern that keeps changing, a slide that hardly begins, no convergence), the general solver decides.
"""

import math

from ..compiler import inner_kernel, kernel, late_kernel
from ..compiler.vectors import LANES, LEADING, filled, least, load, mask_above, most, store
from .counts import COUNT_ROWS, MOVED, NEAREST_STOP, STOPS, STUCK, TURNS
from .crossings import NONE, approach, slope_at, value_at
from .orbits import LARGEST, MEASURED, NEARBY, radius_of_two
from .problem import SIZE, TERMS, WIDTH, H, P, Q
from .record import LEAST_SLIP, OF_FRICTION, clear_record, include, mirror
from .return_map import base_halves, raster, rounded
from .single_tables import (
    CHI,
    DELTA,
    ETA,
    KAPPA,
    PLACE,
    PLACE_RATE,
    PUSH,
    PUSH_RATE,
    RATE,
    RATE_BY_RATE,
    RATE_BY_Z,
    STIFFNESS,
    WALL,
    WALL_RATE,
    YIELD,
    YIELD_RATE,
    Z_BY_RATE,
    Z_BY_Z,
    Z,
    control_row,
    end_row,
    force_row,
)

_ALL = 2**LANES - 1

#: Events of a return, and returns, at most.
_MOST_EVENTS = 400
_MOST_RETURNS = 12

#: A new slide that is not certain to last for this share of an interval may be one of rounding errors.
_CERTAIN = 1e-3

#: Another step is taken unless the error is so much less than MEASURED, or no longer decreases.
_SURELY = 0.02

#: States that are rounded again after the first one, at most, see `steady.find_from_rounded`.
_MOST_BEGUN = 2

_WATCHED = 0  # row of the scratch


@inner_kernel
def _motions(single, x):
    """Values at x of the displacement from z = 1, from z' = 1, and under f = -1."""
    series = single.series
    return value_at(series, PLACE, x), value_at(series, PUSH, x), value_at(series, YIELD, x)


@kernel
def _to_beginning(single, interval, x, force):
    """Replace the state of rest at x by the one from which the slide would come at the beginning."""
    kappa, delta, eta = single.numbers[KAPPA], single.numbers[DELTA], single.numbers[ETA]
    state, at = single.state, force_row(interval)
    place, push, yield_ = _motions(single, x)
    rate = place - delta * push  # of `push`; that of `place` is -kappa push
    whole = place * rate + kappa * push * push
    z = state[Z] - value_at(single.series, at + 1, x) + force * yield_
    p = state[RATE] - value_at(single.series, at + 2, x) + force * eta * push
    state[Z], state[RATE] = (rate * z - push * p) / whole, (kappa * push * z + place * p) / whole
    for i in (Z_BY_Z, Z_BY_RATE):
        z, p = state[i], state[i + 2]  # those of the rate follow two places later
        state[i], state[i + 2] = (rate * z - push * p) / whole, (kappa * push * z + place * p) / whole


@inner_kernel
def _carry(single, motions, forced, force):
    """Carry the state at the beginning of an interval on.

    Parameters
    ----------
    single : Single
    motions : displacements from z = 1, from z' = 1, and under f = -1
    forced : displacement and velocity under the holding force
    force : friction force
    """
    kappa, delta, eta = single.numbers[KAPPA], single.numbers[DELTA], single.numbers[ETA]
    place, push, yield_ = motions
    rate = place - delta * push
    state = single.state
    z, p = state[Z], state[RATE]
    state[Z] = z * place + p * push + forced[0] - force * yield_
    state[RATE] = p * rate - kappa * z * push + forced[1] - force * eta * push
    for i in (Z_BY_Z, Z_BY_RATE):
        z, p = state[i], state[i + 2]  # those of the rate follow two places later
        state[i], state[i + 2] = z * place + p * push, p * rate - kappa * z * push


@kernel
def _to_end(single, interval, x, force):
    """Replace the state at the beginning of the interval by that at x."""
    at = force_row(interval)
    forced = value_at(single.series, at + 1, x), value_at(single.series, at + 2, x)
    _carry(single, _motions(single, x), forced, force)


@inner_kernel
def _through(single, interval, force):
    """Replace the state at the beginning of the interval by that at its end."""
    ends, at = single.ends, end_row(interval)
    _carry(single, (ends[0], ends[1], ends[2]), (ends[at], ends[at + 1]), force)


@kernel
def _velocity_series(single, interval, sense, force):
    """Put the velocity of a slide, times its sense, in the scratch."""
    series, at = single.series, force_row(interval)
    z, p = single.state[Z], single.state[RATE]
    for k in range(0, WIDTH, LANES):
        sum_ = load(series, (at + 2) * WIDTH + k) - load(series, YIELD_RATE * WIDTH + k) * force
        sum_ = sum_ + load(series, PLACE_RATE * WIDTH + k) * z + load(series, PUSH_RATE * WIDTH + k) * p
        store(sum_ * float(sense), single.scratch, _WATCHED * WIDTH + k)


@kernel
def _certain_from(single, interval, x, fresh, push):
    """End of the time for which a slide that begins at x goes on for certain; NONE if that is too short.

    Parameters
    ----------
    single, interval : Single with the velocity in its scratch, interval
    x : begin of the slide
    fresh : 1 if it begins with an acceleration, 2 if with its rate (released at mu = 1)
    push : that acceleration or rate, > 0 for a slide that goes on
    """
    bound = 0.0
    for k in range(fresh + 1, TERMS):
        factor = k * (k - 1.0)
        if fresh == 2:
            factor *= k - 2.0
        bound += factor * abs(single.scratch[_WATCHED, k])
    lasts = fresh * push  # the velocity has not returned to zero before (fresh + 1) * push / bound
    if not lasts > _CERTAIN * bound:
        return NONE
    return 1.0 if lasts >= bound * (1.0 - x) else x + lasts / bound


@inner_kernel
def _slides_past(single, interval, sense, force):
    """Mask of the eighths of an interval in which the velocity of a slide is certain not to be zero.

    Parameters
    ----------
    single, interval : Single with the state at the beginning of the interval, interval
    sense, force : of the slide
    """
    controls, bounds = single.controls, single.bounds
    z, p, at = single.state[Z], single.state[RATE], control_row(interval) + 1
    low = filled(math.inf)
    for part in range(0, WIDTH, LANES):
        sum_ = load(controls, at * WIDTH + part) - load(controls, YIELD // 2 * WIDTH + part) * force
        sum_ = sum_ + load(controls, part) * z + load(controls, PUSH // 2 * WIDTH + part) * p
        low = least(low, sum_ * float(sense))
    return mask_above(low, bounds[at] + abs(z) * bounds[0] + abs(p) * bounds[1] + abs(force) * bounds[2])


@inner_kernel
def _held_past(single, interval, limit, sign):
    """Mask of the eighths of an interval in which the holding force is certain to stay within a limit.

    Parameters
    ----------
    single, interval : Single, interval
    limit, sign : the side of the range: sign F < limit
    """
    at = control_row(interval)
    worst = filled(-math.inf)
    for part in range(0, WIDTH, LANES):
        worst = most(worst, load(single.controls, at * WIDTH + part) * float(sign))
    return mask_above(limit - single.bounds[at], worst)


@inner_kernel
def _nothing_happens(single, interval, sense, beta):
    """Whether an interval is certain to hold no event of a motion; a slide is carried through it."""
    if sense == 0:
        need = single.numbers[STIFFNESS] * single.state[Z]
        return (
            _held_past(single, interval, beta + need, 1) == _ALL
            and _held_past(single, interval, beta - need, -1) == _ALL
        )
    if _slides_past(single, interval, sense, sense * beta) != _ALL:
        return False
    _through(single, interval, sense * beta)
    return True


@kernel
def _slide_ends(single, interval, sense, force, x, ready):
    """First zero from x on of the velocity of a slide, in an interval; NONE without one.

    Parameters
    ----------
    single, interval : Single with the state at the beginning of the interval, interval
    sense, force : of the slide
    x : where the search begins
    ready : whether the velocity is in the scratch
    """
    passed = _slides_past(single, interval, sense, force) | ((1 << int(LANES * x)) - 1)
    if passed == _ALL or x >= 1.0:
        return NONE
    if not ready:
        _velocity_series(single, interval, sense, force)
    return approach(single.scratch, _WATCHED, max(x, LEADING[passed] / float(LANES)))


@kernel
def _stop_ends(single, interval, beta, x):
    """(x, sense) of the release of a contact that is held from x on; x = NONE if it stays held."""
    need = single.numbers[STIFFNESS] * single.state[Z]  # the force F - need holds the contact
    found, side = NONE, 0
    for sign in (1, -1):
        limit = beta + sign * need
        passed = _held_past(single, interval, limit, sign) | ((1 << int(LANES * x)) - 1)
        if passed == _ALL:
            continue
        for k in range(0, WIDTH, LANES):
            part = load(single.series, force_row(interval) * WIDTH + k) * float(-sign)
            store(part, single.scratch, _WATCHED * WIDTH + k)
        single.scratch[_WATCHED, 0] += limit
        when = approach(single.scratch, _WATCHED, max(x, LEADING[passed] / float(LANES)))
        if when < found:
            found, side = when, sign
    return found, side


@kernel
def _turn_or_stop(single, interval, sense, beta, x, memory):
    """Sense after a slide that ends at x; 0 for a stop.  The state is that of x, and its velocity is zero.

    After a turn the derivatives of the velocity grow by the ratio of the accelerations after and before it.
    """
    state = single.state
    held = value_at(single.series, force_row(interval), x) - single.numbers[STIFFNESS] * state[Z]
    state[RATE] = 0.0
    if sense * held >= -beta:
        state[RATE_BY_Z] = state[RATE_BY_RATE] = 0.0
        memory.counts[STOPS, 0] += 1.0
        return 0
    ratio = (held + sense * beta) / (held - sense * beta)
    state[RATE_BY_Z] *= ratio
    state[RATE_BY_RATE] *= ratio
    memory.counts[TURNS, 0] += 1.0
    memory.counts[NEAREST_STOP, 0] = max(memory.counts[NEAREST_STOP, 0], beta / abs(held))
    return -sense


@kernel
def _begin_slide(single, interval, sense, beta, x, fresh):
    """Begin a slide at x; where the search for its end may start, NONE if that is not certain.

    Parameters
    ----------
    single, interval : Single with the state at x, interval
    sense, beta : of the slide
    x, fresh : see `_certain_from`
    """
    force = sense * beta
    at, eta = force_row(interval), single.numbers[ETA]
    if fresh == 2:
        push = sense * eta * slope_at(single.series, at, x)
    else:
        held = value_at(single.series, at, x) - single.numbers[STIFFNESS] * single.state[Z]
        push = sense * eta * (held - force)
    _to_beginning(single, interval, x, force)
    _velocity_series(single, interval, sense, force)
    return _certain_from(single, interval, x, fresh, push)


@kernel
def _pass_interval(single, h, interval, sense, beta, begun, memory, record):
    """Follow the motion through one interval.

    Parameters
    ----------
    single : Single; its state is replaced by that at the end of the interval
    h, interval : length and number of the interval
    sense, beta : sense at its beginning, friction
    begun : displacement where the present slide began
    memory, record : Return, whose counts are increased; Record

    Returns
    -------
    (sense, begun, decided) : at the end of the interval; whether nothing was unusual
    """
    x, start = 0.0, 0.0
    ready = False
    for _ in range(_MOST_EVENTS):
        if sense == 0:
            end, side = _stop_ends(single, interval, beta, x)
            memory.counts[STUCK, 0] += (min(end, 1.0) - x) * h
            if end == NONE:
                return 0, begun, True
            sense, x, begun = side, end, single.state[Z]
            fresh = 2
        else:
            end = _slide_ends(single, interval, sense, sense * beta, start, ready)
            if end == NONE:
                _through(single, interval, sense * beta)
                return sense, begun, True
            _to_end(single, interval, end, sense * beta)
            z = single.state[Z]
            record.distance[0] += abs(z - begun)
            include(record.ranges, 0, z)
            sense, x, begun = _turn_or_stop(single, interval, sense, beta, end, memory), end, z
            fresh = 1
        if sense != 0:
            start = _begin_slide(single, interval, sense, beta, x, fresh)
            ready = True
            if start == NONE:
                return sense, begun, False
            memory.counts[MOVED, 0] = 1.0
    return sense, begun, False


@kernel
def _return(single, h, intervals, start, sense, beta, memory, record):
    """Follow the motion from a state at the section through some intervals.

    Parameters
    ----------
    single : Single; its state is replaced by the one on return
    h, intervals : length of the intervals, and how many
    start, sense : (z, z') and sense at the section
    beta : friction
    memory, record : Return, Record; counts and extremes are those of this way

    Returns
    -------
    (sense, decided) : on return; whether nothing was unusual
    """
    state = single.state
    state[Z], state[RATE] = start
    state[Z_BY_Z], state[Z_BY_RATE], state[RATE_BY_Z] = 1.0, 0.0, 0.0
    state[RATE_BY_RATE] = 1.0 if sense != 0 else 0.0
    for part in range(COUNT_ROWS):
        memory.counts[part, 0] = 0.0
    memory.counts[MOVED, 0] = 1.0 if sense != 0 else 0.0
    clear_record(record)
    include(record.ranges, 0, state[Z])
    begun = state[Z]
    for interval in range(intervals):
        if _nothing_happens(single, interval, sense, beta):
            memory.counts[STUCK, 0] += h if sense == 0 else 0.0
            continue
        sense, begun, decided = _pass_interval(single, h, interval, sense, beta, begun, memory, record)
        if not decided:
            return sense, False
    if sense != 0:
        record.distance[0] += abs(state[Z] - begun)
    include(record.ranges, 0, state[Z])
    return sense, True


@kernel
def _keep_motion(problem, base, beta, start, sense, single, memory, record):
    """Put the steady state found where the general solver puts its own.

    Parameters
    ----------
    problem, base, beta : Problem, half periods of the return, friction
    start, sense : (z, z') and sense at the section
    single, memory, record : Single, Return, Record
    """
    chi = single.numbers[CHI]
    memory.start[Q, 0] = (start[0] + single.numbers[WALL]) / chi
    memory.start[P, 0] = (start[1] + single.numbers[WALL_RATE]) / chi
    memory.senses[0] = sense
    record.works[OF_FRICTION, 0] = beta * record.distance[0]
    record.slips[LEAST_SLIP, 0] = 2.0 * record.distance[0] / base
    for i in range(record.masses.shape[0]):
        for part in range(2):
            include(record.ranges, 1 + i, record.ranges[part, 0] * record.masses[i, 0] / chi)
    if base == 1:
        mirror(record)


@kernel
def _rounded_start(single, z, p, bits):
    """(q, q') of the state (z, z') at the section, rounded as by `round_state`; not, for 0 bits."""
    chi = single.numbers[CHI]
    q, v = (z + single.numbers[WALL]) / chi, (p + single.numbers[WALL_RATE]) / chi
    if bits > 0:
        step = raster(max(abs(q), abs(v)), bits)
        q, v = rounded(q, step), rounded(v, step)
    return q, v


@kernel
def _in_contact(single, start):
    """(z, z') of a state (q, q') at the section."""
    chi = single.numbers[CHI]
    return chi * start[0] - single.numbers[WALL], chi * start[1] - single.numbers[WALL_RATE]


@kernel
def _next_state(single, sign, z, p, sense, end, nearer):
    """(z, z') and sense of the state that is tried after one that does not return, and whether it is that of
    Newton's method; else the motion itself approaches the steady state.

    Parameters
    ----------
    single : Single, with the state and its derivatives on return
    sign : that of the return
    z, p, sense : the state at the section
    end : sense on return
    nearer : whether the state returns nearer to itself than the last one
    """
    state = single.state
    off_z, off_p = sign * state[Z] - z, sign * state[RATE] - p
    a, b = sign * state[Z_BY_Z], sign * state[Z_BY_RATE]
    c, d = sign * state[RATE_BY_Z], sign * state[RATE_BY_RATE]
    determinant = (1.0 - a) * (1.0 - d) - b * c
    if end == sense and nearer and determinant != 0.0:
        z += ((1.0 - d) * off_z + b * off_p) / determinant
        p += (c * off_z + (1.0 - a) * off_p) / determinant
        return z, p, sense, True
    return sign * state[Z], sign * state[RATE], end, False


@late_kernel((bool, float, float))
def solve_single(problem, row, single, beta, memory, record, bits):
    """Find and measure the steady state for mu = 1, from the state in `memory.start`.

    Parameters
    ----------
    problem, row, single : Problem, Row, Single with the tables of this row
    beta : friction
    memory, record : Return, Record; where the state is found they are as `steady.measure` leaves them
    bits : 0; or it is found from the state that it is rounded to, see `steady.find_from_rounded`

    Returns
    -------
    (found, cycles, multiplier) : whether it was found; periods followed; largest modulus of the multipliers
        over a period of the load
    """
    base, state = base_halves(problem), single.state
    sign = 1.0 - 2.0 * (base % 2)
    z, p = _in_contact(single, (memory.start[Q, 0], memory.start[P, 0]))
    start = _rounded_start(single, z, p, bits)
    if bits > 0:
        z, p = _in_contact(single, start)
    sense, size = memory.senses[0], row.numbers[SIZE] * abs(single.numbers[CHI])
    last, begun, count = math.inf, 1, 0
    for count in range(1, _MOST_RETURNS + 1):
        if not sense * p > 0.0:  # a stop, or a start that was moved beyond the end of its slide
            sense, p = 0, 0.0
        if not max(abs(z), abs(p)) <= LARGEST * size:
            break
        end, decided = _return(
            single, row.numbers[H], base * row.intervals[0], (z, p), sense, beta, memory, record
        )
        end = -end if base == 1 else end
        if not decided or memory.counts[MOVED, 0] == 0.0:
            break
        multiplier = radius_of_two(state[Z_BY_Z], state[Z_BY_RATE], state[RATE_BY_Z], state[RATE_BY_RATE])
        off = max(abs(sign * state[Z] - z), abs(sign * state[RATE] - p)) / max(size, abs(z), abs(p))
        enough = MEASURED * min(1.0, abs(1.0 - multiplier))
        returns = end == sense and (off <= _SURELY * enough or enough >= off >= 0.5 * last)
        if not returns:
            z, p, sense, stepped = _next_state(single, sign, z, p, sense, end, off < last)
            last = off if stepped else math.inf
        if bits > 0 and begun <= _MOST_BEGUN and (returns or (begun == 1 and off <= NEARBY)):
            again = _rounded_start(single, z, p, bits)
            if again != start:
                start, begun, last, returns = again, begun + 1, math.inf, False
                z, p = _in_contact(single, start)
        if returns:
            _keep_motion(problem, base, beta, (z, p), sense, single, memory, record)
            return True, 0.5 * base * count, multiplier if base == 2 else multiplier * multiplier
    return False, 0.5 * base * count, math.nan

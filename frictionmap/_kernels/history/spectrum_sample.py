"""One oscillator through one sample with events, by Taylor series; see `spectrum_lanes`.

A limit that is reached at the beginning or the end of a sample, to rounding, is not exceeded: the load after
it decides.
"""

import math

from ..compiler import inner_kernel, kernel
from ..taylor_series import MAX_POLISH, ONE_STEP, cubic_root, first_root, reversion, series_value
from .motion import RESOLVED, TOO_MANY_EVENTS
from .spectrum_lanes import (
    ACC,
    BETA,
    DAMPING,
    DISTANCE,
    FORCE,
    FROM,
    HELD,
    INVERSE,
    LIMIT,
    LOAD,
    OLD_ACC,
    OLD_PEAK,
    OLD_V,
    OLD_X,
    PEAK,
    RATE,
    RATES,
    REACH,
    SENSE,
    SLIDES,
    SQUARE,
    STATIC,
    STATUS,
    STOPS,
    TERMS,
    TURNS,
    WATCHED,
    A,
    V,
    X,
    fill_rates,
)

#: A force within this share of its limit is at it.
_AT_LIMIT = 1e-14

#: What a search for an event returns without one.
NONE = 2.0

#: Events in a sample at most: more are chattering.
_MOST_EVENTS = 2000

#: Halvings of a sample in the search for a peak: that of a parabola is then missed by 2^-60 of its height.
_HALVINGS = 30

#: Peaks closer than this share are equal to rounding.
_EQUAL = 1.0 + 2.0**-50


@inner_kernel
def release(state, i, side, pull):
    """Let the mass slide to `side`; pull : load less the force of the spring."""
    state[SENSE, i], state[SLIDES, i], state[HELD, i] = side, 1.0, 0.0
    state[FORCE, i], state[LIMIT, i] = side * state[BETA, i], math.inf
    state[V, i], state[ACC, i], state[FROM, i] = 0.0, pull - side * state[BETA, i], state[X, i]


@inner_kernel
def stick(state, i):
    """Hold the mass."""
    state[SENSE, i], state[SLIDES, i], state[HELD, i] = 0.0, 0.0, 1.0
    state[FORCE, i], state[LIMIT, i] = 0.0, state[STATIC, i]
    state[V, i] = state[ACC, i] = 0.0


@inner_kernel
def _fill_load(pieces, begin, rest, curved, series):
    """Fill the series of the load over a share `rest` of the sample after `begin`."""
    row = series[LOAD]
    terms = pieces.size
    for k in range(terms):
        row[k] = pieces[k]
    if begin == 0.0:
        return
    if not curved:
        row[0] += begin * row[1]
        row[1] *= rest
        return
    for i in range(terms - 1):
        for k in range(terms - 2, i - 1, -1):
            row[k] += begin * row[k + 1]
    scale = 1.0
    for k in range(terms):
        row[k] *= scale
        scale *= rest


@inner_kernel
def _derivatives(row, first, terms, x):
    """Value, and derivatives over their factorials, of a series without the first factors x."""
    value = slope = bend = third = 0.0
    for k in range(terms - 1, first - 1, -1):
        third = third * x + bend
        bend = bend * x + slope
        slope = slope * x + value
        value = value * x + row[k]
    return value, slope, bend, third


@inner_kernel
def _first_zero(row, first, terms):
    """First zero in (0, 1] of a series that begins with the positive term `first`; NONE without one.

    Where the series certainly falls all the way, the zero of the cubic through its ends is improved to
    fourth order; else the steps of `first_root` pass no zero.
    """
    others = bend = fall = slope_after = 0.0
    for k in range(first + 1, terms):
        size, factor = abs(row[k]), float(k - first)
        others += size
        bend += factor * (factor - 1.0) * size
        fall += row[k]
        slope_after += factor * row[k]
    if row[first] > others:
        return NONE
    if -row[first + 1] <= bend:
        return first_root(row, first, terms)
    after = row[first] + fall
    if after > 0.0:
        return NONE
    x = cubic_root(row[first], row[first + 1], after, slope_after)
    for _ in range(MAX_POLISH):
        value, slope, second, third = _derivatives(row, first, terms, x)
        step = reversion(value, slope, 2.0 * second, 6.0 * third)
        x = min(max(x + step, 0.0), 1.0)
        if abs(step) <= ONE_STEP:
            break
    return x


@inner_kernel
def _change(row, terms):
    """Bound on the distance of a load from its value at the beginning of a piece."""
    sum_ = 0.0
    for k in range(1, terms):
        sum_ += abs(row[k])
    return sum_


@kernel
def _keep_peak(state, i, row, terms, end):
    """Include the largest modulus of a series over [0, end] in the peak of the acceleration.

    Intervals that cannot beat the peak so far, or have no extremum inside, are left out; others are halved.
    """
    size = bend = 0.0
    scale = 1.0
    for k in range(terms):
        size += abs(row[k])
        if k >= 2:
            bend += k * (k - 1.0) * abs(row[k]) * scale
            scale *= end
    peak = state[PEAK, i]
    if size <= peak:
        return
    peak = max(peak, abs(row[0]), abs(series_value(row, terms, end)))
    level, place, width = 0, 0, end
    while True:
        left, slope = 0.0, 0.0
        for k in range(terms - 1, -1, -1):
            slope = slope * (place * width) + left
            left = left * (place * width) + row[k]
        right = series_value(row, terms, (place + 1) * width)
        high = max(abs(left), abs(right)) + 0.125 * width * width * bend
        if level < _HALVINGS and abs(slope) <= bend * width and high > peak * _EQUAL:
            peak = max(peak, abs(series_value(row, terms, (place + 0.5) * width)))
            level, place, width = level + 1, 2 * place, 0.5 * width
            continue
        place += 1
        while level > 0 and place % 2 == 0:
            level, place, width = level - 1, place // 2, 2.0 * width
        if level == 0:
            break
    state[PEAK, i] = peak


@inner_kernel
def _may_beat(lanes, i, h, ends):
    """Whether the acceleration of the present slide, of the length `h`, may beat its peak so far.

    Its second derivative is bounded as in `spectrum_lanes`.
    ends : the accelerations at both ends.
    """
    state, rates, given = lanes.state, lanes.series[RATES], lanes.series[LOAD]
    slope = bend = 0.0
    for k in range(1, lanes.load_terms):
        slope += k * abs(given[k])
        bend += k * (k - 1.0) * abs(given[k])
    damping, rate = state[DAMPING, i], state[RATE, i]
    size = rate * h * abs(rates[0]) + abs(rates[1]) + h * slope  # of h v'
    third = damping * h * ((rate + damping) * h * size + h * slope) + state[SQUARE, i] * h * h * size
    return max(abs(ends[0]), abs(ends[1])) + 0.125 * (third / h + bend) > state[PEAK, i]


@kernel
def _keep_acceleration(lanes, i, h, base, terms, end):
    """Include the acceleration of the present slide up to `end` in its peak; see `slide`."""
    state, rates, row = lanes.state, lanes.series[RATES], lanes.series[WATCHED]
    if base:
        row[0] = state[FORCE, i] + state[DAMPING, i] * rates[0] + state[SQUARE, i] * state[X, i]
        for k in range(1, terms):
            row[k] = state[DAMPING, i] * rates[k] + state[SQUARE, i] * h * rates[k - 1] * INVERSE[k]
    else:
        terms -= 1
        for k in range(terms):
            row[k] = (k + 1.0) * rates[k + 1] / h
    _keep_peak(state, i, row, terms, end)


@inner_kernel
def _first_overload(lanes, i, side):
    """First x in [0, 1] at which the load overcomes the contact towards `side`; NONE without one."""
    state, given, row = lanes.state, lanes.series[LOAD], lanes.series[WATCHED]
    limit, terms = state[STATIC, i], lanes.load_terms
    row[0] = limit - side * (given[0] - state[SQUARE, i] * state[X, i])
    for k in range(1, terms):
        row[k] = -side * given[k]
    if row[0] > _change(given, terms):
        return NONE
    near = _AT_LIMIT * limit
    if row[0] < -near:
        return 0.0  # a jump
    first = 0
    if row[0] <= near:
        first = 1
        while first < terms and row[first] == 0.0:
            first += 1
        if first == terms:
            return NONE
        if row[first] < 0.0:
            return 0.0
    x = first_root(row, first, terms)
    if 0.0 < x <= 1.0 and abs(series_value(row, terms, 1.0)) <= near:
        middle = series_value(row, terms, 0.5 + 0.5 * x)
        if abs(middle) <= near:
            return NONE  # reached at the end
    return x


@inner_kernel
def _wait(lanes, i, base):
    """Wait for a release in the present piece of the load; return when it is, or NONE."""
    state, given = lanes.state, lanes.series[LOAD]
    up, down = _first_overload(lanes, i, 1.0), _first_overload(lanes, i, -1.0)
    x, side = (up, 1.0) if up <= down else (down, -1.0)
    if base and x > 0.0:
        _keep_peak(state, i, given, lanes.load_terms, min(x, 1.0))
    if x > 1.0:
        return NONE
    pull = side * state[STATIC, i]
    if x == 0.0:
        now = given[0] - state[SQUARE, i] * state[X, i]
        if side * now - state[STATIC, i] > _AT_LIMIT * state[STATIC, i]:
            pull = now
    release(state, i, side, pull)
    return x


@inner_kernel
def _end_slide(lanes, i, x, pull):
    """Stop at x, or turn; pull : load less the force of the spring."""
    state = lanes.state
    state[DISTANCE, i] += abs(x - state[FROM, i])
    state[REACH, i] = max(state[REACH, i], abs(x))
    if abs(pull) <= state[STATIC, i]:
        state[STOPS, i] += 1.0
        stick(state, i)
        return
    side = 1.0 if pull > 0.0 else -1.0
    if side != state[SENSE, i]:
        state[TURNS, i] += 1.0
    release(state, i, side, pull)


@inner_kernel
def slide(lanes, i, h, base, terms):
    """Slide through the present piece of the load.

    Parameters
    ----------
    lanes : with the series of the load
    i : lane
    h, base, terms : length of the piece, see `Load`, terms of the series

    Returns
    -------
    float : x in [0, 1] at which the slide ends, where the next state begins; NONE if it goes on
    """
    state, rates, row = lanes.state, lanes.series[RATES], lanes.series[WATCHED]
    sense = state[SENSE, i]
    rates[0], rates[1] = state[V, i], h * state[ACC, i]
    fill_rates(lanes.series, h, state[DAMPING, i], state[SQUARE, i], terms)
    for k in range(terms):
        row[k] = sense * rates[k]
    first = 0
    while first < terms and row[first] == 0.0:
        first += 1
    if first == terms:
        return NONE
    found = _first_zero(row, first, terms) if row[first] > 0.0 else 0.0
    end = min(found, 1.0)
    v = place = 0.0
    for k in range(terms - 1, -1, -1):
        v = v * end + rates[k]
        place = place * end + rates[k] * INVERSE[k + 1]
    if found > 1.0 and sense * v <= 0.0:
        found = 1.0  # the last rounding error
    x = state[X, i] + h * end * place
    pull = series_value(lanes.series[LOAD], lanes.load_terms, end) - state[SQUARE, i] * x
    resist = state[FORCE, i] + state[DAMPING, i] * v
    ends = (state[ACC, i], pull - resist)
    if base:
        held = state[FORCE, i] + state[DAMPING, i] * rates[0] + state[SQUARE, i] * state[X, i]
        ends = (held, resist + state[SQUARE, i] * x)
    if _may_beat(lanes, i, h, ends):
        _keep_acceleration(lanes, i, h, base, terms, end)
    state[X, i] = x
    if found <= 1.0:
        _end_slide(lanes, i, x, pull)
        return found
    state[V, i], state[ACC, i] = v, pull - state[FORCE, i] - state[DAMPING, i] * v
    return NONE


@inner_kernel
def _cross(record, lanes, i, k):
    """Follow the motion through sample k; False if there are too many events."""
    state = lanes.state
    terms = int(lanes.tables[record.which[k], TERMS, i])
    begin = 0.0
    for _ in range(_MOST_EVENTS):
        rest = 1.0 - begin
        _fill_load(record.terms[k], begin, rest, record.curved, lanes.series)
        if state[SENSE, i] == 0.0:
            x = _wait(lanes, i, record.base)
        else:
            x = slide(lanes, i, rest * record.steps[k], record.base, terms)
        begin += x * rest
        if x >= 1.0 or begin >= 1.0:
            return True
    return False


@kernel
def follow_sample(record, lanes, i, k):
    """Follow lane i through sample k, from the state before it (rows OLD_X to OLD_PEAK)."""
    state = lanes.state
    state[X, i], state[V, i] = state[OLD_X, i], state[OLD_V, i]
    state[ACC, i], state[PEAK, i] = state[OLD_ACC, i], state[OLD_PEAK, i]
    if state[STATUS, i] == RESOLVED and not _cross(record, lanes, i, k):
        state[STATUS, i] = TOO_MANY_EVENTS
        stick(state, i)
    set_level(lanes, i, record.ends[k], record.base)


@inner_kernel
def set_level(lanes, i, end, base):
    """Set the modulus of the acceleration at the end of a sample, where the load is `end`."""
    state = lanes.state
    if not base:
        state[A, i] = abs(state[ACC, i])
    elif state[SENSE, i] == 0.0:
        state[A, i] = abs(end)
    else:
        resist = state[FORCE, i] + state[DAMPING, i] * state[V, i] + state[SQUARE, i] * state[X, i]
        state[A, i] = abs(resist)
    state[PEAK, i] = max(state[PEAK, i], state[A, i])

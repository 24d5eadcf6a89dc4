"""One mass with friction under a drive of cubic pieces, and the derivatives of its motion.

    u'' + 2 zeta w u' + w^2 (u + q) = p,    q = sgn(u') x_F while it slides

The drive c is a cubic on every interval; p = a c + b c' + g c'', where a, b, g are functions of w and zeta.
A rigid contact sticks with q in -mu x_F..mu x_F.  A contact with a spring has mu = 1 and q' = kappa u' while
it does not slip.

The derivatives follow the equation of motion between events, and change at events by (H1).  Every interval
gives those of its end by its beginning, by the four coefficients of its drive and by the five values; sums
over intervals are made by `carried`.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.packed import packed
from ..taylor_series import first_root, series_slope, series_value
from .motion import RESOLVED, TOO_MANY_EVENTS

#: Values of a motion.
FREQUENCY, RATIO, FRICTION, STATIC, SPRING = range(5)
VALUES = 5

#: State between intervals; PHASE is the sense of the slide, 0 without one.
U, V, Q, ACC, PHASE = range(5)
STATE = 5

#: Derivatives of an interval: by its beginning, its drive, the values.
COLUMNS = 3 + 4 + VALUES
_DRIVE, _VALUE = 3, 7

#: Terms of a series.  Angles per step are 1 at most: 1/24! is rounding.
TERMS = 26
_INVERSE = 1.0 / np.maximum(np.arange(TERMS + 1.0), 1.0)

#: A force within this share of its limit is at it.
_AT_LIMIT = 1e-14

#: Events in an interval at most: more are chattering.
_MOST_EVENTS = 200

#: Events: the contact holds, turns the other way at once, lets go.
STOP, TURN, START = range(3)


class Intervals(NamedTuple):
    """A drive, and how it moves the mass."""

    lengths: np.ndarray  # (n,)
    drive: np.ndarray  # (n, 4) coefficients of powers of the share of the interval
    forms: np.ndarray  # (3, 3) a, b, g; each with its derivatives by w and zeta
    values: np.ndarray  # (VALUES,); kappa is 0 of a rigid contact
    terms: int  # of a series, TERMS - 2 at most


class Motion(NamedTuple):
    """What is filled."""

    state: np.ndarray  # (n + 1, STATE) at the ends of intervals
    carry: np.ndarray  # (n, 3, COLUMNS) derivatives of u, u', q at the end of each
    events: np.ndarray  # (any, 3) interval and share of it, and what happens
    counts: np.ndarray  # (2,) events, and those that had no room


class Work(NamedTuple):
    """Series."""

    drive: np.ndarray  # (1 + 4, 4) the drive in the rest of an interval, and of the parts of unit size
    load: np.ndarray  # (1 + COLUMNS, 4) p, and its derivatives
    row: np.ndarray  # (1 + COLUMNS, TERMS) u, and its derivatives
    watched: np.ndarray  # (TERMS,)
    tangent: np.ndarray  # (3, COLUMNS)


@kernel
def _fill_drive(given, k, begin, rest, work):
    """Fill the drive over a share `rest` of interval k after `begin`, and the unit powers."""
    for m in range(5):
        row = work.drive[m]
        for i in range(4):
            row[i] = given.drive[k, i] if m == 0 else (1.0 if i == m - 1 else 0.0)
        for i in range(3):
            for j in range(2, i - 1, -1):
                row[j] += begin * row[j + 1]
        scale = 1.0
        for i in range(4):
            row[i] *= scale
            scale *= rest


@inner_kernel
def _fill_load(drive, a, b, g, h, load):
    """Fill a c + b c' + g c'' for a drive over a length h."""
    for n in range(4):
        load[n] = a * drive[n]
        if n < 3:
            load[n] += b * (n + 1.0) * drive[n + 1] / h
        if n < 2:
            load[n] += g * (n + 1.0) * (n + 2.0) * drive[n + 2] / (h * h)


@kernel
def _fill_loads(given, h, work):
    """Fill the load, and its derivatives by the drive, w and zeta."""
    forms, load = given.forms, work.load
    _fill_load(work.drive[0], forms[0, 0], forms[1, 0], forms[2, 0], h, load[0])
    for m in range(4):
        _fill_load(work.drive[1 + m], forms[0, 0], forms[1, 0], forms[2, 0], h, load[1 + _DRIVE + m])
    for m in range(2):
        _fill_load(
            work.drive[0], forms[0, 1 + m], forms[1, 1 + m], forms[2, 1 + m], h,
            load[1 + _VALUE + m],
        )  # fmt: skip


@kernel
def _fill_motion(given, h, now, work):
    """Fill the series of u over a length h; now : (STATE,)."""
    w, damping = given.values[FREQUENCY], 2.0 * given.values[RATIO] * given.values[FREQUENCY] * h
    stiffer = w * w * h * h * (1.0 + (given.values[SPRING] if now[PHASE] == 0.0 else 0.0))
    row, load = work.row[0], work.load[0]
    row[0], row[1], row[2] = now[U], h * now[V], 0.5 * h * h * now[ACC]
    for n in range(1, given.terms - 2):
        pull = h * h * load[n] if n < 4 else 0.0
        row[n + 2] = (pull - stiffer * row[n] - damping * (n + 1.0) * row[n + 1]) * (
            _INVERSE[n + 1] * _INVERSE[n + 2]
        )


@kernel
def _fill_tangents(given, h, now, work):
    """Fill the series of the derivatives of u over a length h, where the phase does not change."""
    w, zeta, kappa = given.values[FREQUENCY], given.values[RATIO], given.values[SPRING]
    sliding = now[PHASE] != 0.0
    square, damping = w * w * h * h, 2.0 * zeta * w * h
    stiffer = square * (1.0 + (0.0 if sliding else kappa))
    motion = work.row[0]
    for col in range(COLUMNS):
        row, load = work.row[1 + col], work.load[1 + col]
        row[0], row[1] = work.tangent[0, col], h * work.tangent[1, col]
        held = work.tangent[2, col]
        if sliding:
            held = now[PHASE] if col == _VALUE + FRICTION else 0.0
        for n in range(given.terms - 2):
            pull = h * h * load[n] if n < 4 else 0.0
            if n == 0:
                pull -= square * (row[0] + held)
            else:
                pull -= stiffer * row[n]
            pull -= damping * (n + 1.0) * row[n + 1]
            if col == _VALUE + FREQUENCY:
                spring = motion[0] + now[Q] if n == 0 else motion[n] * (1.0 + (0.0 if sliding else kappa))
                pull -= 2.0 * w * h * h * spring + 2.0 * zeta * h * (n + 1.0) * motion[n + 1]
            elif col == _VALUE + RATIO:
                pull -= 2.0 * w * h * (n + 1.0) * motion[n + 1]
            elif col == _VALUE + SPRING and not sliding and n > 0:
                pull -= square * motion[n]
            row[n + 2] = pull * _INVERSE[n + 1] * _INVERSE[n + 2]


@kernel
def _move(given, h, x, now, work):
    """Take the derivatives to a share x of the piece; `now` is still the state at its begin."""
    sliding = now[PHASE] != 0.0
    kappa = given.values[SPRING]
    motion = work.row[0]
    way = series_value(motion, given.terms, x) - motion[0]
    for col in range(COLUMNS):
        row = work.row[1 + col]
        u = series_value(row, given.terms, x)
        if sliding:
            work.tangent[2, col] = now[PHASE] if col == _VALUE + FRICTION else 0.0
        else:
            work.tangent[2, col] += kappa * (u - row[0])
            if col == _VALUE + SPRING:
                work.tangent[2, col] += way
        work.tangent[0, col] = u
        work.tangent[1, col] = series_slope(row, given.terms, x) / h


@inner_kernel
def _exit(row, terms, near):
    """First x in [0, 1] where a series that must be positive is no longer; 2 without one.

    near : a first term within this is zero, and the next terms decide
    """
    if row[0] < -near:
        return 0.0
    first = 0
    if row[0] <= near:
        first = 1
    while first < terms and row[first] == 0.0:
        first += 1
    if first == terms:
        return 2.0
    if row[first] < 0.0:
        return 0.0
    return first_root(row, first, terms)


@kernel
def _held_until(given, now, work):
    """(x, side): when a rigid contact that holds lets go, 2 if it does not."""
    square = given.values[FREQUENCY] * given.values[FREQUENCY]
    limit = given.values[STATIC] * given.values[FRICTION]
    best, at = 2.0, 0.0
    for k in range(2):
        side = 1.0 - 2.0 * k
        for n in range(4):
            work.watched[n] = -side * work.load[0, n] / square
        work.watched[0] += limit + side * now[U]
        x = _exit(work.watched, 4, _AT_LIMIT * limit)
        if x < best:
            best, at = x, side
    return best, at


@kernel
def _elastic_until(given, now, work):
    """(x, side): when a contact with a spring slips, 2 if it does not."""
    limit, kappa = given.values[FRICTION], given.values[SPRING]
    best, at = 2.0, 0.0
    for k in range(2):
        side = 1.0 - 2.0 * k
        work.watched[0] = limit - side * now[Q]
        for n in range(1, given.terms):
            work.watched[n] = -side * kappa * work.row[0, n]
        x = _exit(work.watched, given.terms, 0.0)
        if x < best:
            best, at = x, side
    return best, at


@inner_kernel
def _slide_until(given, now, work):
    """When a slide ends, 2 if it does not."""
    for n in range(given.terms - 1):
        work.watched[n] = now[PHASE] * (n + 1.0) * work.row[0, n + 1]
    return _exit(work.watched, given.terms - 1, 0.0)


@kernel
def _release(given, h, x, side, now, work):
    """Let a rigid contact go to `side` at a share x of the piece, and the derivatives with it."""
    w, friction, mu = given.values[FREQUENCY], given.values[FRICTION], given.values[STATIC]
    square = w * w
    load = series_value(work.load[0], 4, x)
    over = side * (load / square - now[U]) - mu * friction
    jump = x == 0.0 and over > _AT_LIMIT * mu * friction
    now[PHASE], now[V], now[Q] = side, 0.0, side * friction
    now[ACC] = side * square * ((mu - 1.0) * friction + (over if jump else 0.0))
    rate = -side * series_slope(work.load[0], 4, x) / (square * h)
    for col in range(COLUMNS):
        change = side * (work.tangent[0, col] - series_value(work.load[1 + col], 4, x) / square)
        if col == _VALUE + FREQUENCY:
            change += 2.0 * side * load / (square * w)
        elif col == _VALUE + FRICTION:
            change += mu
        elif col == _VALUE + STATIC:
            change += friction
        later = 0.0 if jump or rate == 0.0 else -change / rate
        work.tangent[1, col] = -now[ACC] * later
        work.tangent[2, col] = side if col == _VALUE + FRICTION else 0.0


@kernel
def _slip(given, side, now, work):
    """Let a contact with a spring slip: nothing jumps."""
    now[PHASE], now[Q] = side, side * given.values[FRICTION]
    for col in range(COLUMNS):
        work.tangent[2, col] = side if col == _VALUE + FRICTION else 0.0


@kernel
def _end_slide(given, load, now, work):
    """Stop at u' = 0, or turn; return which."""
    now[V] = 0.0
    if given.values[SPRING] > 0.0:
        now[PHASE] = 0.0
        return STOP
    square = given.values[FREQUENCY] * given.values[FREQUENCY]
    friction = given.values[FRICTION]
    pull = load / square - now[U]
    if abs(pull) <= given.values[STATIC] * friction:
        now[PHASE], now[ACC], now[Q] = 0.0, 0.0, 0.0
        for col in range(COLUMNS):
            work.tangent[1, col] = work.tangent[2, col] = 0.0
        return STOP
    side = 1.0 if pull > 0.0 else -1.0
    after = square * (pull - side * friction)
    turned = after / now[ACC] if now[ACC] != 0.0 else 1.0
    now[PHASE], now[ACC], now[Q] = side, after, side * friction
    for col in range(COLUMNS):
        work.tangent[1, col] *= turned
        work.tangent[2, col] = side if col == _VALUE + FRICTION else 0.0
    return TURN


@inner_kernel
def _note(motion, k, place, what):
    """Keep an event, if there is room."""
    count = motion.counts[0]
    motion.counts[0] += 1
    if count < motion.events.shape[0]:
        motion.events[count, 0], motion.events[count, 1], motion.events[count, 2] = k, place, what
    else:
        motion.counts[1] += 1


@kernel
def _advance(given, h, x, now, work):
    """Take state and derivatives to a share x of the piece, in one phase."""
    rigid = given.values[SPRING] == 0.0
    if now[PHASE] == 0.0 and rigid:
        return
    _fill_tangents(given, h, now, work)
    _move(given, h, x, now, work)
    row, terms = work.row[0], given.terms
    u = series_value(row, terms, x)
    if now[PHASE] == 0.0:
        now[Q] += given.values[SPRING] * (u - now[U])
    now[U], now[V] = u, series_slope(row, terms, x) / h
    w = given.values[FREQUENCY]
    load = series_value(work.load[0], 4, x)
    now[ACC] = load - 2.0 * given.values[RATIO] * w * now[V] - w * w * (u + now[Q])


@kernel
def _piece(given, motion, k, begin, now, work):
    """Follow the motion from a share `begin` of interval k up to an event or its end; return where."""
    length = given.lengths[k]
    w, kappa = given.values[FREQUENCY], given.values[SPRING]
    turn = w * (math.sqrt(1.0 + kappa) + 2.0 * given.values[RATIO]) * length
    rest = 1.0 - begin
    whole = turn * rest <= 1.0
    if not whole:
        rest = 1.0 / turn
    h = rest * length
    _fill_drive(given, k, begin, rest, work)
    _fill_loads(given, h, work)
    side = 0.0
    if now[PHASE] == 0.0 and kappa == 0.0:
        x, side = _held_until(given, now, work)
    else:
        _fill_motion(given, h, now, work)
        if now[PHASE] == 0.0:
            x, side = _elastic_until(given, now, work)
        else:
            x = _slide_until(given, now, work)
    if x > 1.0:
        _advance(given, h, 1.0, now, work)
        return 1.0 if whole else begin + rest
    place = begin + x * rest
    what = START
    if now[PHASE] != 0.0:
        _advance(given, h, x, now, work)
        what = _end_slide(given, series_value(work.load[0], 4, x), now, work)
    elif kappa > 0.0:
        _advance(given, h, x, now, work)
        _slip(given, side, now, work)
    else:
        _release(given, h, x, side, now, work)
    _note(motion, k, place, what)
    return place


@kernel
def _begin(given, now):
    """The phase of a contact at the start, from the law; now has u, u' and the force of a spring."""
    w, friction = given.values[FREQUENCY], given.values[FRICTION]
    square = w * w
    load = given.forms[0, 0] * given.drive[0, 0]
    load += given.forms[1, 0] * given.drive[0, 1] / given.lengths[0]
    load += 2.0 * given.forms[2, 0] * given.drive[0, 2] / (given.lengths[0] * given.lengths[0])
    v = now[V]
    now[PHASE] = 0.0
    if given.values[SPRING] == 0.0:
        now[Q] = 0.0
        pull = load / square - now[U]
        if v != 0.0:
            now[PHASE] = 1.0 if v > 0.0 else -1.0
        elif abs(pull) > given.values[STATIC] * friction:
            now[PHASE] = 1.0 if pull > 0.0 else -1.0
        now[Q] = now[PHASE] * friction
    elif abs(now[Q]) >= friction and now[Q] * v > 0.0:
        now[PHASE] = 1.0 if v > 0.0 else -1.0
        now[Q] = now[PHASE] * friction
    held = now[PHASE] == 0.0 and given.values[SPRING] == 0.0
    now[ACC] = 0.0 if held else load - 2.0 * given.values[RATIO] * w * v - square * (now[U] + now[Q])


@kernel
def _follow(given, motion, start, now, work):
    """See `motion_and_tangents`, which makes the arrays."""
    given, motion, work = packed(given), packed(motion), packed(work)
    now[U], now[V], now[Q] = start[0], start[1], start[2]
    _begin(given, now)
    motion.counts[0] = motion.counts[1] = 0
    for k in range(given.lengths.size):
        for i in range(STATE):
            motion.state[k, i] = now[i]
        for i in range(3):
            for col in range(COLUMNS):
                work.tangent[i, col] = 1.0 if i == col else 0.0
        begin, found = 0.0, motion.counts[0]
        while begin < 1.0:
            begin = _piece(given, motion, k, begin, now, work)
            if motion.counts[0] - found > _MOST_EVENTS:
                return TOO_MANY_EVENTS
        for i in range(3):
            for col in range(COLUMNS):
                motion.carry[k, i, col] = work.tangent[i, col]
    for i in range(STATE):
        motion.state[given.lengths.size, i] = now[i]
    return RESOLVED


@entry
def motion_and_tangents(given, motion, start):
    """Fill the motion under a drive and its derivatives.

    Parameters
    ----------
    given : Intervals
    motion : Motion
    start : (3,) u, u' and the force of the spring of a contact over k, which does not exceed x_F

    Returns
    -------
    int : RESOLVED, or TOO_MANY_EVENTS
    """
    work = Work(
        np.zeros((5, 4)), np.zeros((1 + COLUMNS, 4)), np.zeros((1 + COLUMNS, TERMS)), np.zeros(TERMS),
        np.zeros((3, COLUMNS)),
    )  # fmt: skip
    return _follow(given, motion, start, np.zeros(STATE), work)


@entry
def carried(carry, added, out):
    """Sum derivatives over intervals: out[k + 1] = carry[k] out[k] + added[k].

    carry : (n, 3, 3) or more columns, of which the first three count
    added : (n, 3, m)
    out : (n + 1, 3, m), out[0] is given
    """
    for k in range(added.shape[0]):
        for i in range(3):
            for j in range(added.shape[2]):
                sum_ = added[k, i, j]
                for m in range(3):
                    sum_ += carry[k, i, m] * out[k, m, j]
                out[k + 1, i, j] = sum_

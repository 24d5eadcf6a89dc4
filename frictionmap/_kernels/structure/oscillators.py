"""Oscillators under one load, and the first time at which a weighted sum of them leaves a range.

A sliding structure is a set of free modes and a sticking one a set of held modes (`state`).  In units of one
scan step, with x in [0, 1] inside it and ``w = dz/dx``,

    z_i'' + D_i z_i' + K_i z_i = FC_i cos(tau) + FS_i sin(tau) + F1_i friction .

A scan step is a fixed affine map of each oscillator, so that the scan calls no function.  One sum is watched,
``y = sum OZ_i z_i + OW_i w_i + YC cos(tau) + YS sin(tau)``: the contact velocity, or the variable part of the
load in the contact.  The cost is linear in the number of oscillators.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.vectors import LANES
from ..taylor_series import MAX_TERMS, first_root

# Columns of a table of oscillators, one oscillator per row: the equation, the watched sum, ...
K, D, FC, FS, F1, OZ, OW = 0, 1, 2, 3, 4, 5, 6
# ... frequency and damping ratio in time t = tau/r, sqrt(K), amplitude of the load's second derivative, ...
OMEGA, ZETA, ROOT, GROWTH = 7, 8, 9, 10
# ... and the map of one step: z <- ZZ z + ZW w + ZC cos + ZS sin + Z1 friction, and so w.
ZZ, ZW, WZ, WW, ZC, WC, ZS, WS, Z1, W1 = 11, 12, 13, 14, 15, 16, 17, 18, 19, 20
COLUMNS = 21
# The last row holds common values: length of a step in tau, its cos and sin, number of Taylor terms, the
# load's part of y, and the amplitude of its second derivative.
H, TURN_COS, TURN_SIN, TERMS, YC, YS, SWING = 0, 1, 2, 3, 4, 5, 6

#: Outcomes of a scan: the allowed time is over, y fell through the lower end of its range, y rose through the
#: upper end, or y is not a number.
AT_LIMIT, FELL, ROSE, FAILED = 0, 1, 2, 3

#: Value of `rise` for a scan whose y starts inside its range.
STARTS_INSIDE = -1.0

#: Number of scan steps below which the load phase is still exact to some roundings: at most 8 + 7 rotations
#: by tabulated angles have led there, whose errors add up.
_FEW_STEPS = 64.0

#: Angle below which the first omitted term of the series in `phase_at`, 0.5^14/15!, is below half a rounding.
_SMALL_ANGLE = 0.5


class Scratch(NamedTuple):
    """Work arrays of the kernels."""

    series: np.ndarray  # (MAX_TERMS + 1, n) Taylor coefficients of every z
    watched: np.ndarray  # (MAX_TERMS + 1,) Taylor coefficients of y
    below: np.ndarray  # (MAX_TERMS,) Taylor coefficients of the distance to an end of the range
    next: np.ndarray  # (2, padded(n)) state at the other end of a step
    left: np.ndarray  # (1,) scan steps that may still be taken


@kernel
def padded(n):
    """Smallest multiple of LANES that is not below n."""
    return (n + LANES - 1) // LANES * LANES


@entry
def make_state(n):
    """Return the state of n oscillators: (2, padded(n)) zeros, of which the first n columns are used."""
    return np.zeros((2, padded(n)))


@entry
def make_scratch(n):
    """Allocate scratch arrays for up to n oscillators, without a limit on scan steps."""
    return Scratch(
        np.zeros((MAX_TERMS + 1, n)), np.zeros(MAX_TERMS + 1), np.zeros(MAX_TERMS), make_state(n),
        np.full(1, np.inf),
    )  # fmt: skip


@kernel
def _step_response(k, d, h, terms, z, w, cosine, sine, constant):
    """State (z, w) of an oscillator after one step.

    Parameters
    ----------
    k, d : stiffness and damping
    h : length of the step in tau
    terms : terms of the Taylor series
    z, w : initial state
    cosine, sine, constant : load cosine cos(h x) + sine sin(h x) + constant
    """
    z_k = z
    z_next = w
    f_k = cosine
    f_next = sine * h
    z_end = z + w
    w_end = w
    pull = constant  # has no further coefficients
    for j in range(terms):
        factor = 1.0 / ((j + 1.0) * (j + 2.0))
        new = (f_k + pull - k * z_k - d * (j + 1.0) * z_next) * factor
        z_k = z_next
        z_next = new
        f_new = -h * h * factor * f_k
        f_k = f_next
        f_next = f_new
        pull = 0.0
        z_end += new
        w_end += (j + 2.0) * new
    return z_end, w_end


@kernel
def fill_steps(table, h, terms):
    """Fill the columns of the step's map from those of the equation, and the last row except for y."""
    n = table.shape[0] - 1
    for i in range(n):
        k = table[i, K]
        d = table[i, D]
        table[i, ROOT] = math.sqrt(k)
        table[i, GROWTH] = h * h * math.hypot(table[i, FC], table[i, FS])
        table[i, ZZ], table[i, WZ] = _step_response(k, d, h, terms, 1.0, 0.0, 0.0, 0.0, 0.0)
        table[i, ZW], table[i, WW] = _step_response(k, d, h, terms, 0.0, 1.0, 0.0, 0.0, 0.0)
        table[i, ZC], table[i, WC] = _step_response(k, d, h, terms, 0.0, 0.0, table[i, FC], table[i, FS], 0.0)
        table[i, ZS], table[i, WS] = _step_response(
            k, d, h, terms, 0.0, 0.0, table[i, FS], -table[i, FC], 0.0
        )
        table[i, Z1], table[i, W1] = _step_response(k, d, h, terms, 0.0, 0.0, 0.0, 0.0, table[i, F1])
    table[n, H] = h
    table[n, TURN_COS], table[n, TURN_SIN] = math.cos(h), math.sin(h)
    table[n, TERMS] = terms


@kernel
def watch_load(table, yc, ys):
    """Set the load's part of y to yc cos(tau) + ys sin(tau)."""
    n = table.shape[0] - 1
    h = table[n, H]
    table[n, YC], table[n, YS] = yc, ys
    table[n, SWING] = h * h * math.hypot(yc, ys)


@kernel
def expand(table, n, friction, state, c, s, h, terms, series):
    """Compute the Taylor coefficients in x of every z.

    Parameters
    ----------
    table : (n + 1, COLUMNS) table of oscillators; n : their number
    friction : friction force on the oscillators
    state : (2, n) state at x = 0
    c, s : cosine and sine of the load phase there
    h : length of the step in tau
    terms : order of the series
    series : (terms + 1, n) filled with the coefficients
    """
    for i in range(n):
        series[0, i] = state[0, i]
        series[1, i] = state[1, i]
    c_k, s_k = c, s  # coefficients of cos(tau + h x) and sin(tau + h x)
    c_next, s_next = -s * h, c * h
    for j in range(terms - 1):
        factor = 1.0 / ((j + 1.0) * (j + 2.0))
        pull = friction if j == 0 else 0.0
        for i in range(n):
            force = table[i, FC] * c_k + table[i, FS] * s_k + table[i, F1] * pull
            series[j + 2, i] = (
                force - table[i, K] * series[j, i] - table[i, D] * ((j + 1.0) * series[j + 1, i])
            ) * factor
        fall = -h * h * factor
        c_k, c_next = c_next, fall * c_k
        s_k, s_next = s_next, fall * s_k


@kernel
def advance(series, n, terms, x, state):
    """Evaluate the state at x inside the step from its Taylor series."""
    for i in range(n):
        state[0, i] = series[terms, i]
        state[1, i] = terms * series[terms, i]
    for j in range(terms - 1, 0, -1):
        for i in range(n):
            state[0, i] = state[0, i] * x + series[j, i]
            state[1, i] = state[1, i] * x + j * series[j, i]
    for i in range(n):
        state[0, i] = state[0, i] * x + series[0, i]


@kernel
def watch(table, c, s, series, watched):
    """Compute the Taylor coefficients of y from those of every z."""
    n = table.shape[0] - 1
    h = table[n, H]
    c_k, s_k = c, s
    c_next, s_next = -s * h, c * h
    for j in range(int(table[n, TERMS])):
        total = table[n, YC] * c_k + table[n, YS] * s_k
        for i in range(n):
            total += table[i, OZ] * series[j, i] + table[i, OW] * ((j + 1.0) * series[j + 1, i])
        watched[j] = total
        fall = -h * h / ((j + 1.0) * (j + 2.0))
        c_k, c_next = c_next, fall * c_k
        s_k, s_next = s_next, fall * s_k


@inner_kernel
def step_on(table, n, friction, state, before, c, s):
    """Advance the state by one scan step in place, and return the oscillators' part of y there.

    One pass over contiguous rows: with few oscillators, passes over columns cost more than the arithmetic.

    Parameters
    ----------
    table : (n + 1, COLUMNS) table of oscillators; n : their number
    friction : friction force on the oscillators
    state : (2, n) state, advanced
    before : (2, n) filled with the previous state
    c, s : cosine and sine of the load phase before the step
    """
    y = 0.0
    for i in range(n):
        z = state[0, i]
        w = state[1, i]
        before[0, i] = z
        before[1, i] = w
        forced_z = table[i, ZC] * c + table[i, ZS] * s + table[i, Z1] * friction
        forced_w = table[i, WC] * c + table[i, WS] * s + table[i, W1] * friction
        z_new = forced_z + (table[i, ZZ] * z + table[i, ZW] * w)
        w_new = forced_w + (table[i, WZ] * z + table[i, WW] * w)
        state[0, i] = z_new
        state[1, i] = w_new
        y += table[i, OZ] * z_new + table[i, OW] * w_new
    return y


@kernel
def value(table, state, c, s):
    """Value of y for a state."""
    n = table.shape[0] - 1
    total = 0.0
    for i in range(n):
        total += table[i, OZ] * state[0, i] + table[i, OW] * state[1, i]
    return total + (table[n, YC] * c + table[n, YS] * s)


@kernel
def derivatives(table, friction, state, c, s):
    """Value of y for a state, and its first three derivatives in x."""
    n = table.shape[0] - 1
    h = table[n, H]
    y = table[n, YC] * c + table[n, YS] * s
    slope = h * (table[n, YS] * c - table[n, YC] * s)
    bend = -h * h * y
    third = -h * h * slope
    for i in range(n):
        k, d = table[i, K], table[i, D]
        oz, ow = table[i, OZ], table[i, OW]
        load = table[i, FC] * c + table[i, FS] * s
        acceleration = load + table[i, F1] * friction - k * state[0, i] - d * state[1, i]
        jerk = h * (table[i, FS] * c - table[i, FC] * s) - k * state[1, i] - d * acceleration
        snap = -h * h * load - k * acceleration - d * jerk
        y += oz * state[0, i] + ow * state[1, i]
        slope += oz * state[1, i] + ow * acceleration
        bend += oz * acceleration + ow * jerk
        third += oz * jerk + ow * snap
    return y, slope, bend, third


@kernel
def bounds(table, friction, state, c, s):
    """Bounds over the next step on the derivatives 2 to 4 of y, and the growth of each bound per step.

    The energy sqrt(K) |z''| + |z'''| of the motion of z'' can grow by the load only, by at most |F''| per
    step.
    """
    n = table.shape[0] - 1
    h = table[n, H]
    second = table[n, SWING]
    third, fourth = h * second, h * h * second
    second_growth = third_growth = fourth_growth = 0.0
    for i in range(n):
        k = table[i, K]
        d = table[i, D]
        root = table[i, ROOT]
        growth = table[i, GROWTH]
        force = table[i, FC] * c + table[i, FS] * s + table[i, F1] * friction
        acceleration = force - k * state[0, i] - d * state[1, i]
        jerk = h * (table[i, FS] * c - table[i, FC] * s) - k * state[1, i] - d * acceleration
        energy = root * abs(acceleration) + abs(jerk) + growth
        oz = abs(table[i, OZ])
        ow = abs(table[i, OW])
        per_second = oz / root + ow
        per_third = oz + ow * (d + root)
        per_fourth = oz * (d + root) + ow * (d * (d + root) + k)
        second += per_second * energy
        third += per_third * energy + ow * growth
        fourth += per_fourth * energy + (oz + ow * (d + h)) * growth
        second_growth += per_second * growth
        third_growth += per_third * growth
        fourth_growth += per_fourth * growth
    return second, third, fourth, second_growth, third_growth, fourth_growth


@inner_kernel
def _to_circle(c, s):
    """Remove the rounding error of a cosine and a sine from the sum of their squares."""
    norm = 1.5 - 0.5 * (c * c + s * s)
    return norm * c, norm * s


@kernel
def turned(c, s, angle):
    """Rotate the load phase (cos, sin) by an angle, keeping it on the unit circle."""
    turn_c, turn_s = math.cos(angle), math.sin(angle)
    return _to_circle(turn_c * c - turn_s * s, turn_c * s + turn_s * c)


@inner_kernel
def phase_at(start, now, done, x, h):
    """Load phase (cos, sin) inside a step of a scan.

    Parameters
    ----------
    start, now : load phase (cos, sin) at the start of the scan and of this step
    done : scan steps before this one
    x : part of the step
    h : scan step in tau

    Returns
    -------
    (cos, sin)
    """
    angle = x * h
    if not (done < _FEW_STEPS and abs(angle) < _SMALL_ANGLE):
        return turned(start[0], start[1], (done + x) * h)
    # the series in pairs: a chain of dependent operations would take as long as the library's cosine
    a2 = angle * angle
    a4 = a2 * a2
    a8 = a4 * a4
    turn_c = (
        (1.0 - a2 * (1.0 / 2.0) + a4 * (1.0 / 24.0 - a2 * (1.0 / 720.0)))
        + a8 * (1.0 / 40320.0 - a2 * (1.0 / 3628800.0))
        + a8 * a4 * (1.0 / 479001600.0 - a2 * (1.0 / 87178291200.0))
    )  # fmt: skip
    turn_s = angle * (
        (1.0 - a2 * (1.0 / 6.0) + a4 * (1.0 / 120.0 - a2 * (1.0 / 5040.0)))
        + a8 * (1.0 / 362880.0 - a2 * (1.0 / 39916800.0))
        + a8 * a4 * (1.0 / 6227020800.0)
    )  # fmt: skip
    return _to_circle(turn_c * now[0] - turn_s * now[1], turn_c * now[1] + turn_s * now[0])


@kernel
def leave_range(table, friction, low, high, rise, done, start, now, state, scratch):
    """Find where y leaves [low, high] in a step, by its Taylor series: no root can be missed.

    Parameters
    ----------
    table : (n + 1, COLUMNS) table of oscillators
    friction : friction force on the oscillators
    low, high : range of y
    rise : slope of y at x = 0 if y starts at `low` exactly, >= 0; else STARTS_INSIDE
    done : scan steps before this one
    start, now : load phase (cos, sin) at the start of the scan and of this step
    state : (2, n) state at the end of the step; replaced by the state at the exit
    scratch : Scratch; scratch.next is the state at the start of the step

    Returns
    -------
    (x, end, slope) : x = 2 if y does not leave the range; FELL, ROSE or AT_LIMIT; dy/dx
    """
    n = table.shape[0] - 1
    c, s = now
    terms = int(table[n, TERMS])
    expand(table, n, friction, scratch.next, c, s, table[n, H], terms, scratch.series)
    watch(table, c, s, scratch.series, scratch.watched)
    x, end = _first_exit(scratch.watched, scratch.below, terms, low, high, rise)
    if end == AT_LIMIT:
        return 2.0, end, 0.0
    advance(scratch.series, n, terms, x, state)
    c, s = phase_at(start, now, done, x, table[n, H])
    return x, end, derivatives(table, friction, state, c, s)[1]


@kernel
def _first_exit(watched, below, terms, low, high, rise):
    """Return (x, end) where y first leaves [low, high] in the step of this Taylor series; x = 2 if it does
    not.
    """
    x = 2.0
    end = AT_LIMIT
    if low > -math.inf:
        for j in range(terms):
            below[j] = watched[j]
        below[0] -= low
        first = 0
        if rise >= 0.0:
            below[0] = 0.0
            below[1] = rise
            first = 1 if rise != 0.0 else 2
        x = first_root(below, first, terms)
        if x <= 1.0:
            end = FELL
    if high < math.inf:
        for j in range(terms):
            below[j] = -watched[j]
        below[0] += high
        other = first_root(below, 0, terms)
        if other <= 1.0 and other < x:
            return other, ROSE
    return x, end

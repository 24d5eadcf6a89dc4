"""Oscillators side by side under one load, and the first time that a sum of them leaves a range.

Sliding structures are sets of free modes and sticking ones sets of held modes (`structure`): in units of one
scan step, x in [0, 1] inside it, with ``w = dz/dx``,

    z_i'' + D_i z_i' + K_i z_i = FC_i cos(tau) + FS_i sin(tau) + F1_i friction .

A scan step is a fixed affine map of each oscillator, so that the scan calls no function.  What is watched
is one number, ``y = sum OZ_i z_i + OW_i w_i + yc cos(tau) + ys sin(tau) + level``: the velocity in the
contact, or the load in it.  Cost is linear in the number of oscillators.
"""

import math
from typing import NamedTuple

import numpy as np

from .events import first_root
from .jit import entry, inner_kernel, kernel
from .phases import MAX_TERMS

# Rows of a table of oscillators, one a column: the equation, the sum that is watched, ...
K, D, FC, FS, F1, OZ, OW = 0, 1, 2, 3, 4, 5, 6
# ... frequency and damping ratio in time t = tau/r, sqrt(K), amplitude of the load's second derivative, ...
OMEGA, ZETA, ROOT, GROWTH = 7, 8, 9, 10
# ... and the map of one step: z <- ZZ z + ZW w + ZC cos + ZS sin + Z1 friction, and so w.
ZZ, ZW, WZ, WW, ZC, WC, ZS, WS, Z1, W1 = 11, 12, 13, 14, 15, 16, 17, 18, 19, 20
ROWS = 21

#: Ends of a scan: the time allowed is over, y fell through the lower end of its range, rose through the
#: upper one, or is not a number.
AT_LIMIT, FELL, ROSE, FAILED = 0, 1, 2, 3

#: In place of a slope at the start: y starts inside its range.
ELSEWHERE = -1.0


class Scratch(NamedTuple):
    """Arrays that kernels write into."""

    series: np.ndarray  # (MAX_TERMS + 1, n) Taylor coefficients of every z
    watched: np.ndarray  # (MAX_TERMS,) of y
    below: np.ndarray  # (MAX_TERMS,) of the distance to an end of the range
    next: np.ndarray  # (2, n) state after a step


@entry
def make_scratch(n):
    """Scratch for up to n oscillators."""
    return Scratch(np.zeros((MAX_TERMS + 1, n)), np.zeros(MAX_TERMS), np.zeros(MAX_TERMS), np.zeros((2, n)))


@kernel
def _answer(k, d, h, terms, z, w, cosine, sine, constant):
    """(z, w) after one step from (z, w) under cosine cos(h x) + sine sin(h x) + constant."""
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
def fill_steps(table, n, h, terms):
    """Fill the rows of the step's map from those of the equation."""
    for i in range(n):
        k = table[K, i]
        d = table[D, i]
        table[ROOT, i] = math.sqrt(k)
        table[GROWTH, i] = h * h * math.hypot(table[FC, i], table[FS, i])
        table[ZZ, i], table[WZ, i] = _answer(k, d, h, terms, 1.0, 0.0, 0.0, 0.0, 0.0)
        table[ZW, i], table[WW, i] = _answer(k, d, h, terms, 0.0, 1.0, 0.0, 0.0, 0.0)
        table[ZC, i], table[WC, i] = _answer(k, d, h, terms, 0.0, 0.0, table[FC, i], table[FS, i], 0.0)
        table[ZS, i], table[WS, i] = _answer(k, d, h, terms, 0.0, 0.0, table[FS, i], -table[FC, i], 0.0)
        table[Z1, i], table[W1, i] = _answer(k, d, h, terms, 0.0, 0.0, 0.0, 0.0, table[F1, i])


@kernel
def expand(table, n, friction, state, c, s, h, terms, series):
    """Taylor coefficients in x of every z, from a state; `terms` + 1 of them."""
    for i in range(n):
        series[0, i] = state[0, i]
        series[1, i] = state[1, i]
    c_k, s_k = c, s  # coefficients of cos(tau + h x) and sin(tau + h x)
    c_next, s_next = -s * h, c * h
    for j in range(terms - 1):
        factor = 1.0 / ((j + 1.0) * (j + 2.0))
        pull = friction if j == 0 else 0.0
        for i in range(n):
            force = table[FC, i] * c_k + table[FS, i] * s_k + table[F1, i] * pull
            series[j + 2, i] = (
                force - table[K, i] * series[j, i] - table[D, i] * ((j + 1.0) * series[j + 1, i])
            ) * factor
        fall = -h * h * factor
        c_k, c_next = c_next, fall * c_k
        s_k, s_next = s_next, fall * s_k


@kernel
def advance(series, n, terms, x, state):
    """The state at x inside the step whose series this is."""
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
def _watch(table, n, yc, ys, level, c, s, h, terms, series, watched):
    """Taylor coefficients of y, `terms` of them, from those of every z."""
    c_k, s_k = c, s
    c_next, s_next = -s * h, c * h
    for j in range(terms):
        total = yc * c_k + ys * s_k
        for i in range(n):
            total += table[OZ, i] * series[j, i] + table[OW, i] * ((j + 1.0) * series[j + 1, i])
        watched[j] = total
        fall = -h * h / ((j + 1.0) * (j + 2.0))
        c_k, c_next = c_next, fall * c_k
        s_k, s_next = s_next, fall * s_k
    watched[0] += level


@inner_kernel
def step_on(table, n, friction, state, c, s, following):
    """The state one scan step on, into `following`."""
    for i in range(n):
        z = state[0, i]
        w = state[1, i]
        forced_z = table[ZC, i] * c + table[ZS, i] * s + table[Z1, i] * friction
        forced_w = table[WC, i] * c + table[WS, i] * s + table[W1, i] * friction
        following[0, i] = forced_z + (table[ZZ, i] * z + table[ZW, i] * w)
        following[1, i] = forced_w + (table[WZ, i] * z + table[WW, i] * w)


@kernel
def value(table, n, yc, ys, level, state, c, s):
    """y of a state."""
    total = yc * c + ys * s + level
    for i in range(n):
        total += table[OZ, i] * state[0, i] + table[OW, i] * state[1, i]
    return total


@kernel
def _slope(table, n, friction, yc, ys, state, c, s, h):
    """dy/dx of a state."""
    total = h * (ys * c - yc * s)
    for i in range(n):
        force = table[FC, i] * c + table[FS, i] * s + table[F1, i] * friction
        push = force - table[K, i] * state[0, i] - table[D, i] * state[1, i]
        total += table[OZ, i] * state[1, i] + table[OW, i] * push
    return total


@kernel
def bounds(table, n, friction, yc, ys, state, c, s, h):
    """Bounds over the next step on the derivatives 2 to 4 of y, and what the 2nd and 4th grow by a step.

    The energy sqrt(K) |z''| + |z'''| of the motion of z'' can grow by the load only, by |F''| a step.
    """
    amplitude = h * h * math.hypot(yc, ys)
    second, third, fourth = amplitude, h * amplitude, h * h * amplitude
    second_growth = fourth_growth = 0.0
    for i in range(n):
        k = table[K, i]
        d = table[D, i]
        root = table[ROOT, i]
        growth = table[GROWTH, i]
        force = table[FC, i] * c + table[FS, i] * s + table[F1, i] * friction
        push = force - k * state[0, i] - d * state[1, i]
        jerk = h * (table[FS, i] * c - table[FC, i] * s) - k * state[1, i] - d * push
        energy = root * abs(push) + abs(jerk) + growth
        oz = abs(table[OZ, i])
        ow = abs(table[OW, i])
        per_second = oz / root + ow
        per_third = oz + ow * (d + root)
        per_fourth = oz * (d + root) + ow * (d * (d + root) + k)
        second += per_second * energy
        third += per_third * energy + ow * growth
        fourth += per_fourth * energy + (oz + ow * (d + h)) * growth
        second_growth += per_second * growth
        fourth_growth += per_fourth * growth
    return second, third, fourth, second_growth, fourth_growth


@kernel
def _inside(y0, dy0, y1, dy1, low, high, error):
    """Whether the cubic through these values and slopes keeps `error` away from both ends of the range."""
    left = y0 + dy0 * (1.0 / 3.0)
    right = y1 - dy1 * (1.0 / 3.0)
    least = min(min(y0, y1), min(left, right))
    most = max(max(y0, y1), max(left, right))
    return least - error > low and most + error < high


@kernel
def scan(
    table, n, friction, yc, ys, level, low, high, push, state, c, s, h, terms, limit, scratch
):  # fmt: skip
    """Follow the motion until y leaves [low, high], or for `limit` steps.

    Parameters
    ----------
    table, n, friction : the oscillators and the friction force on them
    yc, ys, level : see the module
    low, high : range of y; one may be infinite
    push : if >= 0, y starts at `low` exactly with this slope, and that root is not looked for; else ELSEWHERE
    state : (2, n) z and w; replaced by the state at the end
    c, s : cos(tau), sin(tau)
    h, terms : length of a step in tau, terms of the Taylor series in it
    limit : steps allowed, a fraction included

    Returns
    -------
    (steps, end, cos, sin, slope) : steps taken, one of AT_LIMIT, FELL, ROSE, FAILED, the load's phase, dy/dx.

    Notes ----- A step is passed where y cannot come to an end of the range inside it: by the bound on y'',
    or by the cubic through its ends and the bound on y''''.  Any other step is searched with
    `events.first_root`, which cannot pass a root.
    """
    turn_c, turn_s = math.cos(h), math.sin(h)
    c0, s0 = c, s
    following = scratch.next
    second, third, fourth, second_growth, fourth_growth = bounds(table, n, friction, yc, ys, state, c, s, h)
    from_edge = push >= 0.0  # told by a number: a flag would be compiled once for each value
    y = low if from_edge else value(table, n, yc, ys, level, state, c, s)
    done = 0.0
    while y == y:  # a number
        whole = done + 1.0 <= limit
        step_on(table, n, friction, state, c, s, following)
        c1 = turn_c * c - turn_s * s
        s1 = turn_c * s + turn_s * c
        y1 = value(table, n, yc, ys, level, following, c1, s1)
        edge = from_edge and done == 0.0
        margin = 0.125 * second
        sure = min(y, y1) - margin > low and max(y, y1) + margin < high
        if edge and not sure:
            # y/x is above a concave parabola that is positive at both ends
            bend = 0.5 * _second(table, n, friction, yc, ys, state, c, s, h)
            sure = push >= 0.0 and push + bend - third * (1.0 / 6.0) > 0.0 and y1 + margin < high
        elif not sure:
            dy = _slope(table, n, friction, yc, ys, state, c, s, h)
            dy1 = _slope(table, n, friction, yc, ys, following, c1, s1, h)
            sure = _inside(y, dy, y1, dy1, low, high, fourth * (1.0 / 384.0))
        if not (sure and whole):
            expand(table, n, friction, state, c, s, h, terms, scratch.series)
            end = AT_LIMIT
            x = 2.0
            if not sure:
                _watch(table, n, yc, ys, level, c, s, h, terms, scratch.series, scratch.watched)
                x, end = _leaves(scratch.watched, scratch.below, terms, low, high, edge, push)
            rest = 1.0 if whole else limit - done
            if x <= rest or not whole:
                if x > rest:
                    x, end = rest, AT_LIMIT
                advance(scratch.series, n, terms, x, state)
                angle = (done + x) * h
                turn_c, turn_s = math.cos(angle), math.sin(angle)
                c = turn_c * c0 - turn_s * s0
                s = turn_c * s0 + turn_s * c0
                norm = 1.5 - 0.5 * (c * c + s * s)  # back to the unit circle
                c *= norm
                s *= norm
                return done + x, end, c, s, _slope(table, n, friction, yc, ys, state, c, s, h)
        done += 1.0
        second += second_growth
        fourth += fourth_growth
        for i in range(n):
            state[0, i] = following[0, i]
            state[1, i] = following[1, i]
        y, c, s = y1, c1, s1
    return done, FAILED, c, s, 0.0


@kernel
def _second(table, n, friction, yc, ys, state, c, s, h):
    """d^2y/dx^2 of a state."""
    total = -h * h * (yc * c + ys * s)
    for i in range(n):
        force = table[FC, i] * c + table[FS, i] * s + table[F1, i] * friction
        push = force - table[K, i] * state[0, i] - table[D, i] * state[1, i]
        jerk = h * (table[FS, i] * c - table[FC, i] * s) - table[K, i] * state[1, i] - table[D, i] * push
        total += table[OZ, i] * push + table[OW, i] * jerk
    return total


@kernel
def _leaves(watched, below, terms, low, high, edge, push):
    """(x, end): where y first leaves [low, high] in the step whose series this is; x = 2 if it does not."""
    x = 2.0
    end = AT_LIMIT
    if low > -math.inf:
        for j in range(terms):
            below[j] = watched[j]
        below[0] -= low
        first = 0
        if edge:
            below[0] = 0.0
            below[1] = push
            first = 1 if push != 0.0 else 2
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

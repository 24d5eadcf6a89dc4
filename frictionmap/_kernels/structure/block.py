"""Eight scan steps of one structure at once.

The watched sum y of `oscillators`, and its slope, are linear in the state at the start of eight steps, in the
load phase and in the friction.  `Block` rows hold what each of these contributes at the next eight nodes, one
node per lane; the steps in which y certainly stays in its range are then known together.  Where an event is
located, and where the state moves on, the lanes hold oscillators instead.

A block is one array, because each array costs a kernel seven arguments:

==========  ==========================================================================================
position    numbers
==========  ==========================================================================================
0           step length, number of Taylor terms, load's part of y, load's part of the bounds on the
            derivatives 2 to 4 of y, growth of these bounds per step, steady response
TURNS       cosines, then sines, of 1, 2, ..., 8 step lengths
EQUATION    columns of the oscillators: the first seven of `oscillators`, and those of the bounds
then        maps of 1, 2, ..., 8 steps: columns of the oscillators for unit cos, sin, friction, z and w
then        rows of y and dy/dx at the next eight nodes: for unit cos, sin, friction, and z, w of each
==========  ==========================================================================================

A column has one number per oscillator, then zeros up to a whole number of vectors.
"""

import math

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import (
    LANES,
    LEADING,
    RAMP,
    delayed,
    filled,
    lane,
    least,
    load,
    magnitude,
    mask_above,
    most,
    store,
    total,
)
from ..taylor_series import MAX_POLISH, MAX_TERMS, NEARLY, ONE_STEP, cubic_root, reversion
from .oscillators import (
    AT_LIMIT,
    F1,
    FAILED,
    FC,
    FELL,
    FS,
    GROWTH,
    OW,
    OZ,
    ROOT,
    ROSE,
    STARTS_INSIDE,
    SWING,
    W1,
    WC,
    WS,
    WW,
    WZ,
    YC,
    YS,
    Z1,
    ZC,
    ZS,
    ZW,
    ZZ,
    D,
    H,
    K,
    leave_range,
    padded,
    phase_at,
    step_on,
)
from .oscillators import TERMS as TABLE_TERMS

STEP, TERMS, LOAD_COS, LOAD_SIN, SECOND, THIRD, FOURTH = 0, 1, 2, 3, 4, 5, 6
THIRD_GROWTH, FOURTH_GROWTH = 7, 8
# Of held oscillators: amplitude of y of the steady response; 1 if there is one and all else decays or beats.
STEADY_LOAD, STEADY = 9, 10
TURNS = 16
EQUATION = TURNS + 2 * LANES

# Columns of the equation: K to OW as in `oscillators`, then those of the bounds.
PER_ROOT, PER_GROWTH, PER_SECOND, PER_THIRD, PER_FOURTH = 7, 8, 9, 10, 11
# ... of held oscillators also the phasor of the steady response, and the largest y of free motion of unit
# energy.
STEADY_RE, STEADY_IM, REACH = 12, 13, 14
_EQUATION_COLUMNS = 15

#: Columns of the map of some steps: z and w for each of unit cos, sin, friction, z, w.
_MAP_COLUMNS = 10

#: 1/j
_INVERSE = np.array([math.inf] + [1.0 / j for j in range(1, MAX_TERMS + 1)])


@kernel
def _maps_at(n):
    """Position of the maps in the block of n oscillators."""
    return EQUATION + _EQUATION_COLUMNS * padded(n)


@kernel
def _rows_at(n):
    """Position of the rows in the block of n oscillators."""
    return _maps_at(n) + LANES * _MAP_COLUMNS * padded(n)


@kernel
def block_size(n):
    """Size of the block of n oscillators."""
    return _rows_at(n) + 2 * LANES * (2 * n + 3)


@kernel
def _fill_unit(table, i, unit, block):
    """Fill what one unit does to oscillator i: cos, sin, friction, or its own z or w (unit = 0 to 4).

    The state is carried on step by step, so that no case of the closed form is special.
    """
    n = table.shape[0] - 1
    width = padded(n)
    z = 1.0 if unit == 3 else 0.0
    w = 1.0 if unit == 4 else 0.0
    pull = 1.0 if unit == 2 else 0.0
    c = 1.0 if unit == 0 else 0.0
    s = 1.0 if unit == 1 else 0.0
    row = _rows_at(n) + 2 * LANES * (unit if unit < 3 else unit + 2 * i)
    for k in range(LANES):
        z_new = (
            table[i, ZC] * c + table[i, ZS] * s + table[i, Z1] * pull + table[i, ZZ] * z + table[i, ZW] * w
        )
        w_new = (
            table[i, WC] * c + table[i, WS] * s + table[i, W1] * pull + table[i, WZ] * z + table[i, WW] * w
        )
        z, w = z_new, w_new
        cosine, sine = block[TURNS + k], block[TURNS + LANES + k]
        if unit == 0:
            c, s = cosine, sine
        elif unit == 1:
            c, s = -sine, cosine
        place = _maps_at(n) + (k * _MAP_COLUMNS + 2 * unit) * width + i
        block[place] = z
        block[place + width] = w
        acceleration = (
            table[i, FC] * c + table[i, FS] * s + table[i, F1] * pull - table[i, K] * z - table[i, D] * w
        )
        block[row + k] += table[i, OZ] * z + table[i, OW] * w
        block[row + LANES + k] += table[i, OZ] * w + table[i, OW] * acceleration


@kernel
def _fill_bounds(table, block):
    """Fill the columns of the equation and the constants of the bounds; see `oscillators.bounds`."""
    n = table.shape[0] - 1
    width = padded(n)
    h = table[n, H]
    block[SECOND] = table[n, SWING]
    block[THIRD], block[FOURTH] = h * block[SECOND], h * h * block[SECOND]
    for i in range(n):
        k, d, root, growth = table[i, K], table[i, D], table[i, ROOT], table[i, GROWTH]
        oz, ow = abs(table[i, OZ]), abs(table[i, OW])
        second = oz / root + ow
        third = oz + ow * (d + root)
        fourth = oz * (d + root) + ow * (d * (d + root) + k)
        for j in range(OW + 1):
            block[EQUATION + j * width + i] = table[i, j]
        block[EQUATION + PER_ROOT * width + i] = root
        block[EQUATION + PER_GROWTH * width + i] = growth
        block[EQUATION + PER_SECOND * width + i] = second
        block[EQUATION + PER_THIRD * width + i] = third
        block[EQUATION + PER_FOURTH * width + i] = fourth
        block[THIRD] += ow * growth
        block[FOURTH] += (oz + ow * (d + h)) * growth
        block[THIRD_GROWTH] += third * growth
        block[FOURTH_GROWTH] += fourth * growth


@kernel
def fill_block(table, block):
    """Fill a block of zeros from a complete table of oscillators.

    Parameters
    ----------
    table : (n + 1, COLUMNS) table of oscillators
    block : (block_size(n),)
    """
    n = table.shape[0] - 1
    h, yc, ys = table[n, H], table[n, YC], table[n, YS]
    block[STEP], block[TERMS], block[LOAD_COS], block[LOAD_SIN] = h, table[n, TABLE_TERMS], yc, ys
    row = _rows_at(n)
    for k in range(LANES):
        c, s = math.cos((k + 1.0) * h), math.sin((k + 1.0) * h)
        block[TURNS + k], block[TURNS + LANES + k] = c, s
        block[row + k], block[row + LANES + k] = yc * c + ys * s, h * (ys * c - yc * s)
        row_of_sin = row + 2 * LANES + k
        block[row_of_sin], block[row_of_sin + LANES] = ys * c - yc * s, -h * (yc * c + ys * s)
    _fill_bounds(table, block)
    for i in range(n):
        for unit in range(5):
            _fill_unit(table, i, unit, block)


@inner_kernel
def _begin(block, n, friction, state, c, s):
    """Value and first two derivatives of y at the start, and the bounds of `oscillators.bounds`."""
    width = padded(n)
    h = block[STEP]
    y = filled(0.0)
    slope = filled(0.0)
    bend = filled(0.0)
    second = filled(0.0)
    third = filled(0.0)
    fourth = filled(0.0)
    for first in range(0, width, LANES):
        z = load(state, first)
        w = load(state, state.shape[1] + first)
        at = EQUATION + first
        k = load(block, at + K * width)
        d = load(block, at + D * width)
        fc = load(block, at + FC * width)
        fs = load(block, at + FS * width)
        oz = load(block, at + OZ * width)
        ow = load(block, at + OW * width)
        acceleration = c * fc + s * fs + friction * load(block, at + F1 * width) - k * z - d * w
        jerk = h * (c * fs - s * fc) - k * w - d * acceleration
        energy = (
            load(block, at + PER_ROOT * width) * magnitude(acceleration)
            + magnitude(jerk) + load(block, at + PER_GROWTH * width)
        )  # fmt: skip
        y = y + oz * z + ow * w
        slope = slope + oz * w + ow * acceleration
        bend = bend + oz * acceleration + ow * jerk
        second = second + load(block, at + PER_SECOND * width) * energy
        third = third + load(block, at + PER_THIRD * width) * energy
        fourth = fourth + load(block, at + PER_FOURTH * width) * energy
    load_y = block[LOAD_COS] * c + block[LOAD_SIN] * s
    load_slope = h * (block[LOAD_SIN] * c - block[LOAD_COS] * s)
    return (
        total(y) + load_y, total(slope) + load_slope, total(bend) - h * h * load_y,
        (total(second) + block[SECOND], total(third) + block[THIRD], total(fourth) + block[FOURTH]),
    )  # fmt: skip


@inner_kernel
def _at_nodes(block, n, friction, state, c, s):
    """y and dy/dx at the next eight nodes.

    Parameters
    ----------
    block, n : the oscillators as a block, and their number
    friction : friction force on the oscillators
    state : (2, padded(n)) state at the present node
    c, s : cosine and sine of the load phase there
    """
    at = _rows_at(n)
    y = c * load(block, at) + s * load(block, at + 2 * LANES)
    slope = c * load(block, at + LANES) + s * load(block, at + 3 * LANES)
    y_of_w = friction * load(block, at + 4 * LANES)
    slope_of_w = friction * load(block, at + 5 * LANES)
    for i in range(n):
        at += 4 * LANES if i > 0 else 6 * LANES
        z, w = state[0, i], state[1, i]
        y = y + z * load(block, at)
        slope = slope + z * load(block, at + LANES)
        y_of_w = y_of_w + w * load(block, at + 2 * LANES)
        slope_of_w = slope_of_w + w * load(block, at + 3 * LANES)
    return y + y_of_w, slope + slope_of_w


@inner_kernel
def _steps_inside(block, n, friction, state, c, s, here, low, high, fourth, first, second):
    """How many of the next eight steps y certainly stays in its range.

    A step is passed by the cubic through its ends, whose largest error follows from the bound on y''''.

    Parameters
    ----------
    block, n : the oscillators as a block, and their number
    friction : friction force on the oscillators
    state : (2, padded(n)) state at the present node
    c, s : cosine and sine of the load phase there
    here : (y, dy/dx) there
    low, high : range of y
    fourth : bound on y'''' in the first step
    first : 0, or in the first step of a slide from rest: 1 if y stays above `low` in it, 2 if it may not
    second : bound on y'' in the first step

    Returns
    -------
    (passed, before, after) : number of steps; (y, dy/dx) at the node after them and at the node after that
    """
    y, slope = _at_nodes(block, n, friction, state, c, s)
    start = delayed(here[0], y)
    left = start + delayed(here[1], slope) * (1.0 / 3.0)
    right = y - slope * (1.0 / 3.0)
    error = (fourth + block[FOURTH_GROWTH] * load(RAMP, 0)) * (1.0 / 384.0)
    lowest = least(least(start, y), least(left, right)) - error
    highest = most(most(start, y), most(left, right)) + error
    inside = mask_above(lowest, low) & mask_above(high, highest)
    if first > 0:
        inside = inside & ~1
        if first == 1 and lane(y, 0) + 0.125 * second < high:
            inside = inside | 1
    passed = LEADING[inside]
    if passed == LANES:  # a lane that is known in advance is read from its register
        there = (lane(y, LANES - 1), lane(slope, LANES - 1))
        return passed, there, there
    there = (lane(y, passed), lane(slope, passed))
    if passed == 0:
        return passed, here, there
    return passed, (lane(y, passed - 1), lane(slope, passed - 1)), there


@inner_kernel
def _jump(block, n, steps, friction, state, c, s):
    """Move the state on by 1 to 8 steps.

    Parameters
    ----------
    block, n : the oscillators as a block, and their number
    steps : number of steps
    friction : friction force on the oscillators
    state : (2, padded(n)) state, moved on
    c, s : cosine and sine of the load phase before
    """
    width = padded(n)
    at = _maps_at(n) + (steps - 1) * _MAP_COLUMNS * width
    for first in range(0, width, LANES):
        z = load(state, first)
        w = load(state, state.shape[1] + first)
        here = at + first
        z_new = c * load(block, here) + s * load(block, here + 2 * width)
        w_new = c * load(block, here + width) + s * load(block, here + 3 * width)
        z_new = z_new + friction * load(block, here + 4 * width)
        w_new = w_new + friction * load(block, here + 5 * width)
        store(z_new + (z * load(block, here + 6 * width) + w * load(block, here + 8 * width)), state, first)
        w_new = w_new + (z * load(block, here + 7 * width) + w * load(block, here + 9 * width))
        store(w_new, state, state.shape[1] + first)


@inner_kernel
def _copy(source, target, n):
    """Copy a state; the arrays may be made for different numbers of oscillators."""
    width = padded(n)
    for first in range(0, width, LANES):
        store(load(source, first), target, first)
        store(load(source, source.shape[1] + first), target, target.shape[1] + first)


@kernel
def _move_inside(block, n, friction, before, c, s, x, state):
    """Compute the state at x inside a step from that at its start.

    Parameters
    ----------
    block, n : the oscillators as a block, and their number
    friction : friction force on the oscillators
    before : state at the start of the step
    c, s : cosine and sine of the load phase there
    x : position inside the step
    state : filled with the state at x
    """
    width = padded(n)
    h = block[STEP]
    terms = int(block[TERMS])
    for first in range(0, width, LANES):
        at = EQUATION + first
        k = load(block, at + K * width)
        d = load(block, at + D * width)
        fc = load(block, at + FC * width)
        fs = load(block, at + FS * width)
        last = load(before, first)
        this = load(before, before.shape[1] + first)
        force = c * fc + s * fs
        next_force = h * (c * fs - s * fc)
        new = force + friction * load(block, at + F1 * width) - k * last - d * this
        z = last + this * x
        w = this
        power = x  # x^j/j!
        for j in range(1, terms):
            next_power = power * x * _INVERSE[j + 1]
            z = z + new * next_power
            w = w + new * power
            power = next_power
            last = this
            this = new
            new = next_force - k * last - d * this
            later = -h * h * force
            force = next_force
            next_force = later
        store(z, state, first)
        store(w, state, state.shape[1] + first)


@inner_kernel
def _derivatives(block, n, friction, state, c, s):
    """Value of y for a state, and its first three derivatives in x."""
    width = padded(n)
    h = block[STEP]
    y = filled(0.0)
    slope = filled(0.0)
    bend = filled(0.0)
    third = filled(0.0)
    for first in range(0, width, LANES):
        at = EQUATION + first
        z = load(state, first)
        w = load(state, state.shape[1] + first)
        k = load(block, at + K * width)
        d = load(block, at + D * width)
        fc = load(block, at + FC * width)
        fs = load(block, at + FS * width)
        oz = load(block, at + OZ * width)
        ow = load(block, at + OW * width)
        force = c * fc + s * fs
        acceleration = force + friction * load(block, at + F1 * width) - k * z - d * w
        jerk = h * (c * fs - s * fc) - k * w - d * acceleration
        snap = -h * h * force - k * acceleration - d * jerk
        y = y + oz * z + ow * w
        slope = slope + oz * w + ow * acceleration
        bend = bend + oz * acceleration + ow * jerk
        third = third + oz * jerk + ow * snap
    load_y = block[LOAD_COS] * c + block[LOAD_SIN] * s
    load_slope = h * (block[LOAD_SIN] * c - block[LOAD_COS] * s)
    return (
        total(y) + load_y, total(slope) + load_slope, total(bend) - h * h * load_y,
        total(third) - h * h * load_slope,
    )  # fmt: skip


@inner_kernel
def _move_slightly(block, n, friction, state, c, s, x):
    """Move the state on by a small part of a step, with a third-order expansion.

    Parameters
    ----------
    block, n : the oscillators as a block, and their number
    friction : friction force on the oscillators
    state : (2, padded(n)) state, moved on
    c, s : cosine and sine of the load phase before
    x : part of a step
    """
    width = padded(n)
    h = block[STEP]
    for first in range(0, width, LANES):
        at = EQUATION + first
        z = load(state, first)
        w = load(state, state.shape[1] + first)
        k = load(block, at + K * width)
        d = load(block, at + D * width)
        fc = load(block, at + FC * width)
        fs = load(block, at + FS * width)
        force = c * fc + s * fs
        acceleration = force + friction * load(block, at + F1 * width) - k * z - d * w
        jerk = h * (c * fs - s * fc) - k * w - d * acceleration
        snap = -h * h * force - k * acceleration - d * jerk
        store(z + x * (w + x * (0.5 * acceleration + x * (1.0 / 6.0) * jerk)), state, first)
        w = w + x * (acceleration + x * (0.5 * jerk + x * (1.0 / 6.0) * snap))
        store(w, state, state.shape[1] + first)


@inner_kernel
def _at_crossing(block, n, friction, level, x, done, start, now, state, before):
    """Refine the crossing of `level` by y next to x, by Newton steps of fourth order.

    Parameters
    ----------
    block, n : the oscillators as a block, and their number
    friction : friction force on the oscillators
    level : value of y to cross
    x : first guess inside the step
    done : scan steps before this one
    start, now : load phase (cos, sin) at the start of the scan and of this step
    state : filled with the state at the crossing
    before : state at the start of the step

    Returns
    -------
    (found, x, slope, cos, sin) : not found where y only touches the level; the load phase there
    """
    for _ in range(MAX_POLISH):
        _move_inside(block, n, friction, before, now[0], now[1], x, state)
        c, s = phase_at(start, now, done, x, block[STEP])
        y, slope, bend, third = _derivatives(block, n, friction, state, c, s)
        y -= level
        if not abs(y) < NEARLY * abs(slope) or not abs(y * bend) < NEARLY * slope * slope:
            break
        move = reversion(y, slope, bend, third)
        x += move
        if abs(move) < ONE_STEP:
            _move_slightly(block, n, friction, state, c, s, move)
            # the angle is so small that its fourth power is rounding error
            angle = move * block[STEP]
            turn_c, turn_s = 1.0 - 0.5 * angle * angle, angle - (1.0 / 6.0) * angle * angle * angle
            c, s = turn_c * c - turn_s * s, turn_c * s + turn_s * c
            return True, x, slope + move * (bend + 0.5 * move * third), c, s
    return False, x, 0.0, now[0], now[1]


@kernel
def _look(table, block, friction, ends, low, high, rise, third, done, start, now, state, scratch):
    """Find where y leaves [low, high] in a step; without an exit the state becomes that at its end.

    Parameters
    ----------
    table, block : the oscillators
    friction : friction force on the oscillators
    ends : (y, dy/dx) at the start and at the end of the step
    low, high : range of y
    rise : as of `scan` in its first step; else STARTS_INSIDE
    third : bound on y'''
    done : scan steps before this one
    start, now : load phase (cos, sin) at the start of the scan and of this step
    state : state at the start of the step; replaced
    scratch : Scratch; scratch.next becomes the state at the start of the step

    Returns
    -------
    (x, end, slope, cos, sin) : x = 2 if y does not leave the range; FELL, ROSE or AT_LIMIT; dy/dx; the load
        phase there
    """
    n = table.shape[0] - 1
    (y, dy), (y1, dy1) = ends
    _copy(state, scratch.next, n)
    if rise < 0.0:
        # the slope deviates too little from the straight line to change sign: there is one root
        falls = y > low and y1 <= low and max(dy, dy1) + 0.125 * third < 0.0
        rises = y < high and y1 >= high and min(dy, dy1) - 0.125 * third > 0.0
        if falls or rises:
            sign, level = (1.0, low) if falls else (-1.0, high)
            x = cubic_root(sign * (y - level), sign * dy, sign * (y1 - level), sign * dy1)
            found, x, slope, c, s = _at_crossing(
                block, n, friction, level, x, done, start, now, state, scratch.next
            )
            if found:
                return x, FELL if falls else ROSE, slope, c, s
            _copy(scratch.next, state, n)
    step_on(table, n, friction, state, scratch.next, now[0], now[1])
    x, end, slope = leave_range(table, friction, low, high, rise, done, start, now, state, scratch)
    c, s = phase_at(start, now, done, x, block[STEP])
    return x, end, slope, c, s


@kernel
def scan(table, block, friction, low, high, rise, state, c, s, limit, scratch):
    """Follow the motion until y leaves [low, high], or for `limit` steps.

    Parameters
    ----------
    table : (n + 1, COLUMNS) table of oscillators
    block : (block_size(n),) made from it
    friction : friction force on the oscillators
    low, high : range of y; one end may be infinite
    rise : if >= 0, y starts at `low` exactly with this slope, and that root is skipped; else STARTS_INSIDE
    state : (2, padded(n)) z and w, zero beyond n; replaced by the state at the end
    c, s : cos(tau), sin(tau)
    limit : steps allowed, including a fraction
    scratch : Scratch

    Returns
    -------
    (steps, end, cos, sin, slope) : steps taken; AT_LIMIT, FELL, ROSE or FAILED; the load phase; dy/dx where y
        leaves its range.  FAILED also if scratch.left is used up; the steps taken, and one for the call, are
        subtracted from it.

    Notes
    -----
    A step is passed where the cubic through its ends and the bound on y'''' show that y cannot reach an end
        of the range inside it; the first step of a slide from rest also by the bound on y'''.  Any other step
        is examined by `_look`.
    """
    n = table.shape[0] - 1
    start = (c, s)
    y, dy, bend, (second, third, fourth) = _begin(block, n, friction, state, c, s)
    first = 0
    if rise >= 0.0:
        y, dy = low, rise
        # y/x is above a concave parabola that is positive at both ends
        first = 1 if rise + 0.5 * bend - third * (1.0 / 6.0) > 0.0 else 2
    here = (y, dy)
    done = 0.0
    left = scratch.left[0]
    while here[0] == here[0] and done < left:  # a number
        passed, before, after = _steps_inside(
            block, n, friction, state, c, s, here, low, high, fourth, first, second
        )
        inside = int(min(limit - done, float(LANES)))
        steps = min(passed, inside)
        from_rest = first > 0 and steps == 0
        first = 0
        if steps > 0:
            _jump(block, n, steps, friction, state, c, s)
            turn_c, turn_s = block[TURNS + steps - 1], block[TURNS + LANES + steps - 1]
            c, s = turn_c * c - turn_s * s, turn_c * s + turn_s * c
            done += steps
            third += steps * block[THIRD_GROWTH]
            fourth += steps * block[FOURTH_GROWTH]
        if steps == LANES:
            here = before
            continue
        remaining = min(limit - done, 1.0)
        x, end, slope, exit_c, exit_s = 2.0, AT_LIMIT, 0.0, c, s
        if steps == passed:
            x, end, slope, exit_c, exit_s = _look(
                table, block, friction, (before, after), low, high, rise if from_rest else STARTS_INSIDE,
                third, done, start, (c, s), state, scratch,
            )  # fmt: skip
        else:
            _copy(state, scratch.next, n)
        if x > remaining and remaining < 1.0:
            x, end = remaining, AT_LIMIT
            _move_inside(block, n, friction, scratch.next, c, s, x, state)
            exit_c, exit_s = phase_at(start, (c, s), done, x, block[STEP])
        if x <= remaining:
            scratch.left[0] = left - done - 1.0
            return done + x, end, exit_c, exit_s, slope
        turn_c, turn_s = block[TURNS], block[TURNS + LANES]
        c, s = turn_c * c - turn_s * s, turn_c * s + turn_s * c
        done += 1.0
        third += block[THIRD_GROWTH]
        fourth += block[FOURTH_GROWTH]
        here = after
    scratch.left[0] = left - done - 1.0
    return done, FAILED, c, s, 0.0


@kernel
def extremes(table, block, friction, state, c, s, steps):
    """Least minimum and largest maximum of y among the nodes inside the next scan steps.

    Parameters
    ----------
    table, block : the oscillators
    friction : friction force on the oscillators
    state : (2, padded(n)) state at the present node, moved on
    c, s : cosine and sine of the load phase there
    steps : scan steps, including a fraction

    Returns
    -------
    (low, high) : inf and -inf where there are none
    """
    n = table.shape[0] - 1
    low, high = math.inf, -math.inf
    y0, _, _, _ = _derivatives(block, n, friction, state, c, s)
    before = y0
    inside = -2  # the present node has none before it
    turn_c, turn_s = block[TURNS + LANES - 1], block[TURNS + 2 * LANES - 1]
    left = int(steps)
    while left > 0:
        y, _ = _at_nodes(block, n, friction, state, c, s)
        here = delayed(y0, y)
        earlier = delayed(before, here)
        inside &= (1 << min(left, LANES)) - 1
        lows = inside & ~(mask_above(here, earlier) | mask_above(here, y))
        highs = inside & ~(mask_above(earlier, here) | mask_above(y, here))
        if lows | highs != 0:
            for k in range(LANES):
                if lows >> k & 1 != 0:
                    low = min(low, lane(here, k))
                if highs >> k & 1 != 0:
                    high = max(high, lane(here, k))
        before, y0 = lane(here, LANES - 1), lane(y, LANES - 1)
        inside = -1
        left -= LANES
        if left > 0:
            _jump(block, n, LANES, friction, state, c, s)
            c, s = turn_c * c - turn_s * s, turn_c * s + turn_s * c
    return low, high

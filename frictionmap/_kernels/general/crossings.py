"""The first zero of a Taylor series in [0, 1], with certainty.

A series is evaluated with its slope at nine nodes at once.  Between two nodes it is the cubic of these
values and slopes, up to h^4/384 times a bound on its fourth derivative; the Bernstein coefficients of the
cubic bound the cubic from below.  Where this does not decide, steps from one side pass no zero (`approach`).
"""

import math

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import (
    LANES,
    LEADING,
    delayed,
    filled,
    least,
    load,
    magnitude,
    mask_above,
    store,
    total,
)
from .problem import NEXT, TERMS, WIDTH

#: Powers of the nodes 1/8, 2/8, ..., 1: row k holds the k-th powers.
_POWERS = np.array([[((i + 1.0) / LANES) ** k for i in range(LANES)] for k in range(TERMS)])

#: For x, x^2 and x^4: 1 in the lanes whose power does not have this factor, and in those that have it.
_WITHOUT = np.array([[float(not i >> bit & 1) for i in range(LANES)] for bit in range(3)])
_WITH = 1.0 - _WITHOUT

_ALL = 2**LANES - 1
_STEP = 1.0 / LANES
_HERMITE = _STEP**4 / 384.0

#: Factors of the fourth derivative, k (k-1) (k-2) (k-3), and of the second.
_FOURTH = np.array([k * (k - 1.0) * (k - 2.0) * (k - 3.0) for k in range(TERMS)])
_SECOND = np.array([k * (k - 1.0) for k in range(TERMS)])

#: What `first_zero` returns where there is none.
NONE = 2.0

#: Limit on the steps to a zero: quadratic convergence, but slow past a minimum of rounding depth.
_MOST_STEPS = 20000


@kernel
def _weighted(series, at, factors):
    """Sum of factor times modulus of the terms of a series in row `at`."""
    sum_ = filled(0.0)
    for k in range(0, TERMS, LANES):
        sum_ = sum_ + magnitude(load(series, at * WIDTH + k)) * load(factors, k)
    return total(sum_)


@inner_kernel
def value_at(series, at, x):
    """Value of a series; terms that it does not have are zeros."""
    square = x * x
    fourth = square * square
    eighth = fourth * fourth
    powers = load(_WITH, 0) * x + load(_WITHOUT, 0)
    powers = powers * (load(_WITH, LANES) * square + load(_WITHOUT, LANES))
    powers = powers * (load(_WITH, 2 * LANES) * fourth + load(_WITHOUT, 2 * LANES))
    sum_ = filled(0.0)
    for k in range(WIDTH - LANES, -1, -LANES):
        sum_ = sum_ * eighth + load(series, at * WIDTH + k)
    return total(sum_ * powers)


@inner_kernel
def _value_and_slope(series, at, x):
    """Value and derivative of a series of at most TERMS + 1 terms."""
    square = x * x
    fourth = square * square
    eighth = fourth * fourth
    powers = load(_WITH, 0) * x + load(_WITHOUT, 0)
    powers = powers * (load(_WITH, LANES) * square + load(_WITHOUT, LANES))
    powers = powers * (load(_WITH, 2 * LANES) * fourth + load(_WITHOUT, 2 * LANES))
    value = filled(0.0)
    slope = filled(0.0)
    for k in range(TERMS - LANES, -1, -LANES):
        value = value * eighth + load(series, at * WIDTH + k)
        slope = slope * eighth + load(series, at * WIDTH + k + 1) * load(NEXT, k)
    return total(value * powers), total(slope * powers)


@kernel
def slope_at(series, at, x):
    """Derivative of a series of at most TERMS + 1 terms."""
    _, slope = _value_and_slope(series, at, x)
    return slope


@kernel
def approach(series, at, x):
    """First zero of a series that is >= 0 at x, from there on.

    From x it stays above the parabola p + p' d - B d^2/2, where B bounds |p''|: the step d to the zero of the
    parabola passes no zero of the series, and next to a simple zero the steps are Newton's.
    """
    bound = _weighted(series, at, _SECOND)
    for _ in range(_MOST_STEPS):
        value, slope = _value_and_slope(series, at, x)
        if value <= 0.0 and (x > 0.0 or slope <= 0.0):
            return x  # a zero at the start with a rising slope is no crossing
        value = max(value, 0.0)
        root = math.sqrt(slope * slope + 2.0 * bound * value)
        if slope > 0.0:
            if bound == 0.0:
                return NONE
            new = x + (slope + root) / bound
        elif root > slope:
            new = x + 2.0 * value / (root - slope)
        else:
            return NONE
        if new > 1.0:
            return NONE
        if new == x:
            return x
        x = new
    return x


@kernel
def fill_controls(series, at, table, into):
    """Fill the control points of the cubics between the nodes; return the bound on their error.

    Parameters
    ----------
    series, at : series and its row
    table, into : (..., WIDTH) and the row that is filled
    """
    value = filled(series[at, 0])
    slope = filled(series[at, 1])
    for k in range(1, TERMS - 1):
        powers = load(_POWERS, k * LANES)
        value = value + powers * series[at, k]
        slope = slope + powers * ((k + 1.0) * series[at, k + 1])
    value = value + load(_POWERS, (TERMS - 1) * LANES) * series[at, TERMS - 1]
    left, left_slope = delayed(series[at, 0], value), delayed(series[at, 1], slope)
    third = _STEP / 3.0
    first = into * WIDTH
    store(left, table, first)
    store(left + left_slope * third, table, first + LANES)
    store(value - slope * third, table, first + 2 * LANES)
    store(value, table, first + 3 * LANES)
    return _HERMITE * _weighted(series, at, _FOURTH)


@kernel
def first_zero(series, at):
    """First x in (0, 1] at which the series in row `at`, positive before, is zero; NONE without one."""
    value = filled(series[at, 0])
    slope = filled(series[at, 1])
    for k in range(1, TERMS - 1):
        powers = load(_POWERS, k * LANES)
        value = value + powers * series[at, k]
        slope = slope + powers * ((k + 1.0) * series[at, k + 1])
    value = value + load(_POWERS, (TERMS - 1) * LANES) * series[at, TERMS - 1]
    left, left_slope = delayed(series[at, 0], value), delayed(series[at, 1], slope)
    third = _STEP / 3.0
    lowest = least(least(left, left + left_slope * third), least(value, value - slope * third))
    passed = mask_above(lowest, _HERMITE * _weighted(series, at, _FOURTH))
    if passed == _ALL:
        return NONE
    return approach(series, at, LEADING[passed] * _STEP)


@kernel
def next_turn(series, at, x, sign, scratch, row):
    """First zero after x > 0 of the slope of a series whose slope is zero at x and then has this sign.

    Parameters
    ----------
    series, at : series and its row
    x, sign : see above
    scratch, row : its row is filled
    """
    for k in range(TERMS):
        scratch[row, k] = sign * (k + 1.0) * series[at, k + 1]
    bend = 0.0
    bound = 0.0
    for k in range(TERMS - 1, 0, -1):
        bend = bend * x + k * scratch[row, k]
        bound += k * (k - 1.0) * abs(scratch[row, k])
    if bend <= 0.0:
        return NONE
    x = x + 2.0 * bend / bound if bound > 0.0 else NONE
    return approach(scratch, row, x) if x < 1.0 else NONE

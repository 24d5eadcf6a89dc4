"""Taylor series of the motion in one step: how many terms it has, its value, and where it is zero."""

import math

from .compiler import inner_kernel, kernel

#: Largest number of Taylor terms, for the lowest allowed number of scan steps per period.
MAX_TERMS = 44

#: Taylor terms below this size relative to the first are rounding error.
_NEGLIGIBLE = 1e-18

#: If the first guess of an event has a larger error than this, in scan steps, the velocity only touches zero
#: there.
NEARLY = 0.25

#: A Newton step of fourth order shorter than this, in scan steps, converges to rounding.
ONE_STEP = 2e-4

#: Newton steps of fourth order to a root, at most.
MAX_POLISH = 8

#: Limit on the steps to a root.  They converge quadratically, but pass a grazing minimum slowly, at a rate
#: that is the square root of its curvature over the bound: a minimum of rounding depth takes thousands of
#: steps.
_MAX_APPROACH = 20000


@kernel
def series_terms(steps):
    """Return (turn, terms): angle of the fastest part per step, and number of Taylor terms for that angle.

    The number of steps per period is made odd, so that a slide of half a period (every slide of a continuous
    motion) ends inside a step and not next to a node.
    """
    turn = 2.0 * math.pi / (2.0 * math.floor(0.5 * steps) + 1.0)
    terms = 4
    size = turn * turn * turn * turn / 24.0
    while size > _NEGLIGIBLE and terms < MAX_TERMS:
        terms += 1
        size *= turn / terms
    return turn, terms


@inner_kernel
def series_value(row, terms, x):
    """Value of a series of this number of terms."""
    sum_ = 0.0
    for k in range(terms - 1, -1, -1):
        sum_ = sum_ * x + row[k]
    return sum_


@inner_kernel
def series_slope(row, terms, x):
    """Its derivative."""
    sum_ = 0.0
    for k in range(terms - 1, 0, -1):
        sum_ = sum_ * x + k * row[k]
    return sum_


@kernel
def first_root(p, first, terms):
    """Find the first root in (0, 1] of p[first] + p[first+1] x + ...; 2.0 if there is none.

    The value at 0 must be >= 0.  From x the polynomial stays above the parabola p(x) + p'(x) d - B d^2/2,
    where B bounds |p''|; the step d to the root of the parabola passes no root of p, and at a simple root of
    p the steps become Newton's from one side.  No root can be missed.
    """
    bound = 0.0
    for k in range(first + 2, terms):
        bound += (k - first) * (k - first - 1.0) * abs(p[k])
    x = 0.0
    for _ in range(_MAX_APPROACH):
        value = 0.0
        slope = 0.0
        for k in range(terms - 1, first - 1, -1):
            slope = slope * x + value
            value = value * x + p[k]
        if value <= 0.0 and (x > 0.0 or slope <= 0.0):
            return x  # a zero at the start with a rising slope is not an exit
        value = max(value, 0.0)
        root = math.sqrt(slope * slope + 2.0 * bound * value)
        # the parabola's root, in the form that does not cancel
        if slope > 0.0:
            if bound == 0.0:
                return 2.0  # rises from here on
            new = x + (slope + root) / bound
        elif root > slope:
            new = x + 2.0 * value / (root - slope)
        else:
            return 2.0  # constant
        if new > 1.0:
            return 2.0
        if new == x:
            return x
        x = new
    return x


@kernel
def cubic_root(w, slope, w1, slope1):
    """Find the root in [0, 1] of the cubic with these values and slopes at 0 and 1, falling from w > 0 to w1
    <= 0.
    """
    third = 2.0 * (w - w1) + slope + slope1
    second = 3.0 * (w1 - w) - 2.0 * slope - slope1
    x = w / (w - w1)
    for _ in range(2):
        value = w + x * (slope + x * (second + x * third))
        x -= value / (slope + x * (2.0 * second + 3.0 * x * third))
    return min(max(x, 0.0), 1.0)


@kernel
def reversion(value, slope, bend, third):
    """Find the root m of value + slope m + bend m^2/2 + third m^3/6, to fourth order in value/slope."""
    inverse = 1.0 / slope
    first = -value * inverse
    second = 0.5 * bend * inverse
    return first * (1.0 - first * (second - first * (2.0 * second * second - third * inverse * (1.0 / 6.0))))

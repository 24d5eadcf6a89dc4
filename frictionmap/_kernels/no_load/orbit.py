"""One turn of the motion through its bands, forwards or backwards in time.

A band is a segment of the law on one side of the belt's velocity, and on one side of x' = 0.  The motion
there is an oscillation about x = c with damping delta.  A turn ends at a maximum of x or in a stop.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import inner_kernel, kernel
from .band import HIGH, NEVER, leave, rate_at

#: How a turn ends: at a maximum, in a stop; SETTLES if it has no end; LOST after too many bands.
MAXIMUM, STOP, SETTLES, LOST = 0, 1, 2, 3

_MOST_BANDS = 400

# Places of `Turn.numbers`.  The sums are of 2 |delta| t over crossings of bands and over bands in which the
# velocity turns, separately for delta > 0 and < 0; LOSS is that of -ln of the ratio of the accelerations
# after and before a crossing of w = 0.
X, TIME, LOWEST, KNOTS, LOSS = 0, 1, 2, 3, 4
DAMPED_CROSSING, DRIVEN_CROSSING, DAMPED_TURN, DRIVEN_TURN = 5, 6, 7, 8
RISE = 9  # ways along x in 0 < x' < v, where friction drives the mass
TURNS = 10  # crossings of w = 0
NUMBERS = 11


class Belt(NamedTuple):
    """One mass on a belt: K segments of the law from their speeds on."""

    speeds: np.ndarray  # (K,) from 0 on
    factors: np.ndarray  # (K,) friction over beta at these speeds
    slopes: np.ndarray  # (K,) slopes from there on
    zeta: float
    beta: float
    mu: float
    v: float


@inner_kernel
def segment_above(belt, speed):
    """Segment of the law for speeds just above a speed."""
    k = belt.speeds.size - 1
    while belt.speeds[k] > speed:
        k -= 1
    return k


@inner_kernel
def segment_below(belt, speed):
    """Segment of the law for speeds just below a speed > 0."""
    k = belt.speeds.size - 1
    while belt.speeds[k] >= speed:
        k -= 1
    return k


@inner_kernel
def factor_at(belt, speed):
    """Friction over beta at a speed."""
    k = segment_above(belt, speed)
    return belt.factors[k] + belt.slopes[k] * (speed - belt.speeds[k])


@inner_kernel
def damping_in(belt, k):
    """Damping delta of the oscillation in a segment."""
    return belt.zeta + 0.5 * belt.beta * belt.slopes[k]


@inner_kernel
def centre_in(belt, side, k):
    """Place about which the mass oscillates in a segment; side 1 where it overtakes the belt, else -1."""
    start = belt.factors[k] - belt.slopes[k] * belt.speeds[k]
    return belt.beta * (belt.slopes[k] * belt.v - side * start)


@inner_kernel
def release_of(belt):
    """Place at which a stop ends."""
    return belt.mu * belt.beta - 2.0 * belt.zeta * belt.v


@inner_kernel
def _bounds(belt, side, k, rising):
    """Bounds of a band of velocities."""
    above = belt.speeds[k + 1] if k + 1 < belt.speeds.size else math.inf
    if side > 0:
        return belt.v + belt.speeds[k], belt.v + above
    low, high = belt.v - above, belt.v - belt.speeds[k]
    return (max(low, 0.0), high) if rising else (low, min(high, 0.0))


@inner_kernel
def _add(numbers, belt, k, s, turns):
    """Add the time in a band to the sums."""
    weight = 2.0 * damping_in(belt, k) * s
    if weight >= 0.0:
        numbers[DAMPED_TURN if turns else DAMPED_CROSSING] += weight
    else:
        numbers[DRIVEN_TURN if turns else DRIVEN_CROSSING] -= weight


@inner_kernel
def _passes(numbers, belt, side, direction):
    """Whether the mass goes through w = 0 without a stop; the loss there is added.

    Forwards, it comes from `side`; backwards, it has gone there.
    """
    load = numbers[X] + 2.0 * belt.zeta * belt.v
    into = -side * direction  # the side after the crossing, in time
    if not -into * load > belt.mu * belt.beta:
        return False
    numbers[LOSS] -= math.log((abs(load) - belt.beta) / (abs(load) + belt.beta))
    numbers[TURNS] += 1.0
    return True


@kernel
def follow(belt, numbers, side, k, rising, u, rate, direction):
    """Follow the motion to its next maximum (backwards: the last one) or stop.

    Parameters
    ----------
    belt : Belt
    numbers : (NUMBERS,) X on entry; at the end the sums and extremes of the turn
    side, k, rising : the first band
    u, rate : velocity, and its rate by the time in this direction
    direction : 1 forwards, -1 backwards
    """
    for i in range(1, numbers.size):
        numbers[i] = 0.0
    numbers[LOWEST] = numbers[X]
    for _ in range(_MOST_BANDS):
        delta, centre = damping_in(belt, k), centre_in(belt, side, k)
        low, high = _bounds(belt, side, k, rising)
        bound, s, turns = leave(u, rate, direction * delta, low, high)
        if bound == NEVER:
            return SETTLES
        reached = direction * rate_at(u, rate, direction * delta, s)
        u = high if bound == HIGH else low
        x = centre - 2.0 * delta * u - reached
        if side < 0 and rising:
            numbers[RISE] += abs(x - numbers[X])
        numbers[X] = x
        numbers[LOWEST] = min(numbers[LOWEST], x)
        numbers[TIME] += s
        _add(numbers, belt, k, s, turns)
        if u == 0.0 and side < 0:
            if rising == (direction > 0):  # the end of the rise, forwards
                return MAXIMUM
            rising = not rising
            k = segment_below(belt, belt.v) if rising else segment_above(belt, belt.v)
        elif u == belt.v and k == 0:
            if not _passes(numbers, belt, side, direction):
                return STOP
            side = -side
        else:
            outwards = (bound == HIGH) == (side > 0)
            k += 1 if outwards else -1
            numbers[KNOTS] += 1.0
        rate = direction * (centre_in(belt, side, k) - x - 2.0 * damping_in(belt, k) * u)
    return LOST


@kernel
def next_maximum(belt, numbers, x):
    """Follow the motion from a maximum of x."""
    numbers[X] = x
    k = segment_above(belt, belt.v)
    return follow(belt, numbers, -1, k, False, 0.0, centre_in(belt, -1, k) - x, 1)


@kernel
def from_release(belt, numbers):
    """Follow the motion from the end of a stop to the next maximum; a stop cannot come before it."""
    numbers[X] = release_of(belt)
    return follow(belt, numbers, -1, 0, True, belt.v, (1.0 - belt.mu) * belt.beta, 1)

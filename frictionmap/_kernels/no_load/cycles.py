"""All cycles without stops, as fixed points of the map from a maximum of x to the next one.

Motions in the plane (x, x') do not cross, so the map P increases.  Between the maxima whose motion only just
reaches another band, every motion passes the same bands.  There a larger motion passes each band faster, and
stays longer in a band in which its velocity turns, because every band's oscillation has its centre on x' = 0.
So the sums of 2 delta t at both ends of an interval bound the damping of the turn, S, in between.  With q the
square of the distance from steady sliding, dq_next/dq = exp(-S).  An interval has no fixed point if
P(a) >= b or P(b) <= a, and at most one if S keeps its sign; otherwise it is divided.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import inner_kernel, kernel
from .orbit import (
    DAMPED_CROSSING,
    DAMPED_TURN,
    DRIVEN_CROSSING,
    DRIVEN_TURN,
    LOSS,
    LOWEST,
    MAXIMUM,
    RISE,
    SETTLES,
    TURNS,
    X,
    centre_in,
    damping_in,
    factor_at,
    follow,
    next_maximum,
    release_of,
    segment_above,
    segment_below,
)

#: Distance from a critical maximum, over the size of the motion, at which its interval begins: rounding
#: errors of some 1e-15 do not reach it.
_NEXT = 1e-12

#: Doublings of the motion up to which the proof is sought that no larger cycle exists.
_DOUBLINGS = 60

_STEPS = 200

#: Cycles kept at most; the law has 24 points.
MOST_CYCLES = 16

#: Intervals looked at in a cell; ordinary ones need some hundred.  Where neither friction nor damping is left
#: at large speeds, P(x) - x vanishes like 1/x^2 and intervals there are too many.
MOST_INTERVALS = 5000


class Search(NamedTuple):
    """What a search keeps."""

    turns: np.ndarray  # (3, NUMBERS) the turns from the ends of an interval, and from its inside
    critical: np.ndarray  # (4 K + 4,) maxima at which intervals end
    cycles: np.ndarray  # (MOST_CYCLES,) maxima of the cycles, ascending
    damping: np.ndarray  # (MOST_CYCLES,) S there, > 0 where they attract
    left: np.ndarray  # (1,) intervals that may still be looked at; at 0 the search has given up


@inner_kernel
def damping_of(turn):
    """Damping S of a turn; infinite where the motion settles."""
    gains = turn[DRIVEN_CROSSING] + turn[DRIVEN_TURN]
    return turn[DAMPED_CROSSING] + turn[DAMPED_TURN] + turn[LOSS] - gains


@inner_kernel
def _least_damping(a, b):
    """Lower bound of S between two maxima, from their turns."""
    gains = a[DRIVEN_CROSSING] + b[DRIVEN_TURN]
    return b[DAMPED_CROSSING] + a[DAMPED_TURN] + b[LOSS] - gains


@inner_kernel
def _most_damping(a, b):
    """Upper bound of S between two maxima."""
    gains = b[DRIVEN_CROSSING] + a[DRIVEN_TURN]
    return a[DAMPED_CROSSING] + b[DAMPED_TURN] + a[LOSS] - gains


@kernel
def _growth(belt, turn, x, steady):
    """P(x) - x; -infinity where the motion settles in steady sliding without another maximum."""
    code = next_maximum(belt, turn, x)
    if code == MAXIMUM:
        return turn[X] - x
    turn[LOSS] = math.nan  # no bound of S compares with it
    return steady - x if code == SETTLES else math.nan


@kernel
def _origin(belt, turn, x, side, k, u, rate):
    """The maximum from which a motion comes; NaN if it comes from a stop or from none.

    Parameters
    ----------
    belt : Belt
    turn : (NUMBERS,)
    x, u, rate : displacement, velocity, and the rate of the velocity by the time backwards
    side, k : the band
    """
    turn[X] = x
    code = follow(belt, turn, side, k, u > 0.0, u, rate, -1)
    return turn[X] if code == MAXIMUM else math.nan


@kernel
def first_to_stop(belt, turn):
    """The least maximum from which the motion reaches w = 0."""
    return _origin(belt, turn, belt.beta - 2.0 * belt.zeta * belt.v, -1, 0, belt.v, 0.0)


@kernel
def last_to_stop(belt, turn):
    """The maximum from which on motions go through w = 0 and never stop."""
    x = release_of(belt)
    found = _origin(belt, turn, x, 1, 0, belt.v, (1.0 + belt.mu) * belt.beta)
    if not math.isnan(found):
        return found
    x = -belt.mu * belt.beta - 2.0 * belt.zeta * belt.v
    return _origin(belt, turn, x, -1, 0, belt.v, -(1.0 + belt.mu) * belt.beta)


@kernel
def _insert(found, count, x):
    """Insert a number in an ascending list."""
    i = count
    while i > 0 and found[i - 1] > x:
        found[i] = found[i - 1]
        i -= 1
    found[i] = x
    return count + 1


@kernel
def critical_maxima(belt, search, begin, end):
    """Collect the maxima between two limits whose motion only just reaches another band."""
    turn, count = search.turns[2], 0
    for k in range(belt.speeds.size):
        for side in (-1, 1):
            u = belt.v + side * belt.speeds[k]
            if u == 0.0 or u == belt.v:
                continue
            # the velocity turns at u, in the band that the motion does not leave: the inner one
            inner = k - 1 if (side > 0 or u < 0.0) else k
            x = centre_in(belt, side, inner) - 2.0 * damping_in(belt, inner) * u
            found = _origin(belt, turn, x, side, inner, u, 0.0)
            if begin < found < end:
                count = _insert(search.critical, count, found)
    return count


@kernel
def _fixed_point(belt, turn, a, b, rises, steady):
    """The fixed point between two maxima between which P(x) - x changes its sign once.

    Parameters
    ----------
    belt : Belt
    turn : (NUMBERS,) the turn from the fixed point, at the end
    a, b : the maxima
    rises : whether P(x) > x at a
    steady : displacement of steady sliding
    """
    x, last = 0.5 * (a + b), math.inf
    for _ in range(_STEPS):
        growth = _growth(belt, turn, x, steady)
        if (growth > 0.0) == rises:
            a = x
        else:
            b = x
        span = turn[X] - steady
        slope = (x - steady) / span * math.exp(-damping_of(turn)) - 1.0 if span > 0.0 else 0.0
        following = x - growth / slope if slope != 0.0 else math.inf
        if not (a <= following <= b) or abs(following - x) > 0.5 * last:
            following = a + 0.5 * (b - a)
        last = abs(following - x)
        if following == x or b <= a:
            break
        x = following
    _growth(belt, turn, x, steady)
    return x


@kernel
def _keep(belt, search, count, a, b, rises, steady):
    """Keep the fixed point in an interval.

    Parameters
    ----------
    belt : Belt
    search : Search
    count : cycles known
    a, b : maxima between which P(x) - x changes its sign once
    rises : whether P(x) > x at a
    steady : displacement of steady sliding
    """
    if count < MOST_CYCLES:
        x = _fixed_point(belt, search.turns[2], a, b, rises, steady)
        search.cycles[count] = x
        search.damping[count] = damping_of(search.turns[2])
    return count + 1


@kernel
def _search_interval(belt, search, count, begin, end, steady):
    """Find all fixed points between two critical maxima, from the left; the turns of both are followed."""
    low, high = search.turns[0], search.turns[1]
    a, b = begin, end
    at_a = _growth(belt, low, a, steady)
    width = _NEXT * (abs(end) + abs(steady))
    while a < end and search.left[0] > 0:
        search.left[0] -= 1
        at_b = _growth(belt, high, b, steady)
        if not (a + at_a >= b or b + at_b <= a):
            one = _least_damping(low, high) > 0.0 or _most_damping(low, high) < 0.0
            still = _least_damping(low, high) == 0.0 and _most_damping(low, high) == 0.0
            if not (one or still) and b - a > width:
                b = a + 0.5 * (b - a)
                continue
            if (at_a > 0.0) != (at_b > 0.0) and not still:
                count = _keep(belt, search, count, a, b, at_a > 0.0, steady)
        a, at_a, b = b, at_b, end
        for i in range(low.size):
            low[i] = high[i]
    return count


@kernel
def _joint(belt, search, count, a, b, steady):
    """Keep the fixed point at a critical maximum, if there is one between its two sides."""
    at_a = _growth(belt, search.turns[0], a, steady)
    at_b = _growth(belt, search.turns[1], b, steady)
    if (at_a > 0.0) != (at_b > 0.0) and at_a != 0.0 and at_b != 0.0:
        return _keep(belt, search, count, a, b, at_a > 0.0, steady)
    return count


@inner_kernel
def _leaves_at_once(belt):
    """Whether every small motion about steady sliding leaves its band: driven, and without oscillation."""
    above, below = segment_above(belt, belt.v), segment_below(belt, belt.v)
    return damping_in(belt, above) <= -1.0 or damping_in(belt, below) <= -1.0


@kernel
def find_between(belt, search, count, begin, end, steady):
    """Find all cycles with maxima between two limits; of them, `count` are known.

    Below the first critical maximum after steady sliding there is none: every turn has the same factor.  It
    is steady sliding itself where small motions do not oscillate, but leave their band.
    """
    many = critical_maxima(belt, search, begin, end)
    a = begin if begin > steady else math.nan
    if math.isnan(a) and _leaves_at_once(belt):
        a = steady + _NEXT * (abs(end) + abs(steady) if math.isfinite(end) else abs(steady) + belt.v)
    for i in range(many + 1):
        b = search.critical[i] if i < many else end
        gap = _NEXT * (abs(b) + abs(steady))
        if b - gap > a:
            count = _search_interval(belt, search, count, a, b - gap, steady)
        if i < many:
            if b - gap > a or math.isnan(a):
                count = _joint(belt, search, count, b - gap, b + gap, steady)
            a = b + gap
    return count


@kernel
def _factor_range(belt):
    """Largest friction over beta at speeds to v, and the least one at speeds from v on."""
    most = least = factor_at(belt, belt.v)
    for k in range(belt.speeds.size):
        if belt.speeds[k] < belt.v:
            most = max(most, belt.factors[k])
        else:
            least = min(least, belt.factors[k])
    return most, least


@kernel
def _longest_drive(belt):
    """Largest 2 |delta| t of half a period in a segment that drives the mass."""
    most = 0.0
    for k in range(belt.speeds.size):
        delta = damping_in(belt, k)
        if delta <= -1.0:
            return math.inf
        if delta < 0.0:
            most = max(most, -2.0 * delta * math.pi / math.sqrt(1.0 - delta * delta))
    return most


@kernel
def _none_beyond(belt, turn, x):
    """Whether no cycle has a larger maximum than x, the turn from which is given.

    By work: in 0 < x' < v friction drives the mass, at most by its largest value times a way that is shorter
    for larger motions; in x' < 0 it brakes it, on a way that is longer.  By the damping S: bands that are
    crossed are crossed faster by larger motions, the outermost ones have damping >= 0, and below w = 0 no
    motion is in the band in which it turns for longer than half a period of that band.
    """
    most, least = _factor_range(belt)
    if turn[TURNS] > 0.0 and most * turn[RISE] < least * (x - turn[LOWEST]):
        return True
    gains = turn[DRIVEN_CROSSING]
    if turn[DRIVEN_TURN] > 0.0:
        gains += _longest_drive(belt)
    return turn[DAMPED_TURN] - gains > 0.0


@kernel
def find_beyond(belt, search, count, begin, steady):
    """Find all cycles with maxima from `begin` on, `count` smaller ones being known.

    Returns their number, and whether it is proved that there are no larger ones.
    """
    many = critical_maxima(belt, search, begin, math.inf)
    a = begin
    if many > 0:
        last = search.critical[many - 1] + _NEXT * (abs(search.critical[many - 1]) + abs(steady))
        count = find_between(belt, search, count, begin, last, steady)
        a = last
    if a == steady:  # one band on either side of x' = 0, and none else: every turn has the same factor
        return count, True
    size = max(a - steady, belt.v)
    for _ in range(_DOUBLINGS):
        if search.left[0] == 0:
            break
        growth = _growth(belt, search.turns[0], a, steady)
        if growth < 0.0 and _none_beyond(belt, search.turns[0], a):
            return count, True
        b = a + size
        count = _search_interval(belt, search, count, a, b, steady)
        a, size = b, 2.0 * size
    return count, False

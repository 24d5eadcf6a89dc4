"""An oscillation within a band of velocities: when and where it leaves the band.

In a band, u = x' follows u'' + 2 delta u' + u = 0.  Its extrema are known in closed form, so it is monotone
up to the first one and from there to the next one, and no crossing of a bound can be missed.
"""

import math

from ..compiler import inner_kernel, kernel

#: Bounds by which a band is left; NEVER where the motion settles within it.
NEVER, LOW, HIGH = 0, -1, 1

#: Doublings of a time in which a motion without further extrema reaches a bound, at most: exp(-2^10) is 0.
_DOUBLINGS = 12

#: Steps of Newton's method with bisection, which halves at least every other interval of doubles.
_STEPS = 120


@inner_kernel
def parts_of(delta, s):
    """Cosine-like and sine-like motions over exp(-delta s), with the exponent that they are multiplied by."""
    square = 1.0 - delta * delta
    if square > 0.0:
        w = math.sqrt(square)
        return math.cos(w * s), math.sin(w * s) / w, math.exp(-delta * s)
    if square == 0.0:
        return 1.0, s, math.exp(-delta * s)
    # exp(-(delta - h) s) is taken out, the larger of the two for any sign of delta
    h = math.sqrt(-square)
    small = math.exp(-2.0 * h * s)
    return 0.5 * (1.0 + small), -math.expm1(-2.0 * h * s) / (2.0 * h), math.exp((h - delta) * s)


@inner_kernel
def velocity_at(u, rate, delta, s):
    """Velocity after the time s."""
    cosine, sine, scale = parts_of(delta, s)
    return scale * (u * cosine + (rate + delta * u) * sine)


@inner_kernel
def rate_at(u, rate, delta, s):
    """Its rate after the time s."""
    cosine, sine, scale = parts_of(delta, s)
    return scale * (rate * cosine - (delta * rate + u) * sine)


@inner_kernel
def first_extremum(u, rate, delta):
    """Time > 0 of the first extremum of the velocity; infinite if there is none."""
    square = 1.0 - delta * delta
    height = delta * rate + u
    if square > 0.0:
        w = math.sqrt(square)
        if rate == 0.0:
            return math.pi / w
        angle = math.atan2(w * rate, height)
        return (angle if angle > 0.0 else angle + math.pi) / w
    if rate == 0.0 or height == 0.0:
        return math.inf
    ratio = rate / height
    if square == 0.0:
        return ratio if ratio > 0.0 else math.inf
    h = math.sqrt(-square)
    return math.atanh(h * ratio) / h if 0.0 < h * ratio < 1.0 else math.inf


@kernel
def _root(u, rate, delta, bound, begin, end, sign):
    """Time at which a monotone velocity reaches a bound; sign (u - bound) > 0 at the end.

    Newton's method, with bisection where it would leave the bracket or converges slowly.

    Parameters
    ----------
    u, rate, delta : velocity at time 0, its rate, damping of the oscillation
    bound : of the band
    begin, end : times between which the velocity is monotone
    sign : 1 where it rises to the bound, else -1
    """
    s = begin + (end - begin) * 0.5
    last = math.inf
    for _ in range(_STEPS):
        miss = velocity_at(u, rate, delta, s) - bound
        if miss * sign >= 0.0:
            end = s
        else:
            begin = s
        slope = rate_at(u, rate, delta, s)
        step = -miss / slope if slope != 0.0 else math.inf
        following = s + step
        if not (begin <= following <= end) or abs(step) > 0.5 * last:
            following = begin + (end - begin) * 0.5
            step = following - s
        last = abs(step)
        if following == s or end <= begin:
            break
        s = following
    return s


@kernel
def _reaches(u, rate, delta, bound, begin, end, sign):
    """Time at which a velocity reaches a bound; -1 if it does not.

    Parameters
    ----------
    u, rate, delta : velocity at time 0, its rate, damping of the oscillation
    bound : of the band
    begin, end : times between which the velocity is monotone; the end may be infinite
    sign : 1 where it rises, else -1
    """
    if math.isfinite(end):
        if (velocity_at(u, rate, delta, end) - bound) * sign < 0.0:
            return -1.0
        return _root(u, rate, delta, bound, begin, end, sign)
    span = 1.0
    for _ in range(_DOUBLINGS):
        if (velocity_at(u, rate, delta, begin + span) - bound) * sign >= 0.0:
            return _root(u, rate, delta, bound, begin, begin + span, sign)
        span *= 2.0
    return -1.0


@kernel
def leave(u, rate, delta, low, high):
    """Bound by which a band is left, the time until then, and whether the velocity turns in the band.

    Parameters
    ----------
    u, rate : velocity within the band, and its rate
    delta : damping of the oscillation; of either sign
    low, high : bounds of the band, may be infinite; 0 is not between them
    """
    sign = 1.0 if rate > 0.0 or (rate == 0.0 and u < 0.0) else -1.0
    bound = high if sign > 0.0 else low
    turn = first_extremum(u, rate, delta)
    if math.isfinite(bound):
        s = _reaches(u, rate, delta, bound, 0.0, turn, sign)
        if s >= 0.0:
            return (HIGH if sign > 0.0 else LOW), s, False
    if not math.isfinite(turn):
        return NEVER, math.inf, False
    square = 1.0 - delta * delta
    following = turn + math.pi / math.sqrt(square) if square > 0.0 else math.inf
    bound = low if sign > 0.0 else high
    s = _reaches(u, rate, delta, bound, turn, following, -sign) if math.isfinite(bound) else -1.0
    if s >= 0.0:
        return (LOW if sign > 0.0 else HIGH), s, True
    return NEVER, math.inf, True

"""Closed forms of one vibrating mode: trigonometry of pi/(2R), d and q of T(B.8), u and g of T(7.11-12).

A mode has natural frequency ``w`` and damping ratio ``zeta``; with ``R = r/w`` and ``a = 1/R`` the thesis's
functions of ``tau`` are functions of ``theta = a tau``.  Over-damped modes are the analytic continuation (sin
-> sinh); every form below stays accurate through ``zeta = 1``.
"""

import math

from .compiler import entry, kernel

HALF_PI = 0.5 * math.pi
_SPLIT = 134217729.0  # 2**27 + 1, Dekker's constant for splitting a double in two halves


@kernel
def residual(numerator, multiple, r):
    """Compute ``numerator - multiple*r`` with one rounding (Dekker's product) for an integer ``multiple``."""
    product = multiple * r
    if not abs(product) < 1e290:  # Dekker's splitting would overflow; the quotient is 0 or 1 there
        return numerator - product
    t = _SPLIT * multiple
    m_high = t - (t - multiple)
    m_low = multiple - m_high
    t = _SPLIT * r
    r_high = t - (t - r)
    r_low = r - r_high
    error = ((m_high * r_high - product) + m_high * r_low + m_low * r_high) + m_low * r_low
    return (numerator - product) - error


@kernel
def sincos_quarter(numerator, less, r):
    """Sine and cosine of ``(pi/2) (numerator - less)/r``, exact to rounding close to every zero of both.

    ``less`` carries the part that ``numerator`` alone would round away.  Whole quarter turns are subtracted
    before the division, so that no accuracy is lost close to ``R = 1/(2n+1)`` and ``R = 1/(2n)``, where the
    plain expression has no correct digit.
    """
    turns = (numerator - less) / r
    if not turns < 4503599627370496.0:  # 2**52: a double this large has no fractional part
        return math.nan, math.nan
    whole = math.floor(turns + 0.5)
    angle = HALF_PI * ((residual(numerator, whole, r) - less) / r)
    sine = math.sin(angle)
    cosine = math.cos(angle)
    quadrant = whole - 4.0 * math.floor(0.25 * whole)
    if quadrant == 0.0:
        return sine, cosine
    if quadrant == 1.0:
        return cosine, -sine
    if quadrant == 2.0:
        return -sine, -cosine
    return -cosine, sine


@kernel
def fastest_rate(omega, zeta):
    """Rate of the fastest part of the free motion of an oscillator."""
    if zeta > 1.0:
        return omega * (zeta + math.sqrt((zeta - 1.0) * (zeta + 1.0)))
    return omega


@kernel
def decay(zeta, theta):
    """``q`` and ``e = R q'`` of T(B.8b), (B.9b) at ``theta = tau/R``; then ``d = e + 2 zeta q``.

    Free motion of a mode from (eta, R eta'): ``eta d + R eta' q`` and ``-eta q + R eta' e``.
    """
    if zeta < 1.0:
        s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
        envelope = math.exp(-zeta * theta)
        q = envelope * math.sin(s * theta) / s
        return q, envelope * math.cos(s * theta) - zeta * q
    if zeta == 1.0:
        envelope = math.exp(-theta)
        q = envelope * theta
        return q, envelope - q
    s = math.sqrt((zeta - 1.0) * (zeta + 1.0))
    slow = 1.0 / (zeta + s)
    q = math.exp(-slow * theta) * (-math.expm1(-2.0 * s * theta)) / (2.0 * s)
    return q, math.exp(-(zeta + s) * theta) - slow * q


@kernel
def _sinh_minus_argument(x):
    """Compute ``sinh(x) - x`` without cancellation."""
    if abs(x) > 1.0:
        return math.sinh(x) - x
    square = x * x
    term = x * square / 6.0
    total = term
    n = 5.0
    while abs(term) > 1e-17 * abs(total):
        term *= square / (n * (n - 1.0))
        total += term
        n += 2.0
    return total


@kernel
def _argument_minus_sin(x):
    """Compute ``x - sin(x)`` without cancellation."""
    if abs(x) > 1.0:
        return x - math.sin(x)
    square = x * x
    term = x * square / 6.0
    total = term
    n = 5.0
    while abs(term) > 1e-17 * abs(total):
        term *= -square / (n * (n - 1.0))
        total += term
        n += 2.0
    return total


@kernel
def _over_damped_rise(x, zeta):
    """Compute ``sinh(x) - zeta/s sinh(s x/zeta)``, s^2 = zeta^2 - 1, for x <= 1, without cancellation.

    Its series is that of sinh with the factor 1 - (s/zeta)^(2k) on each term.
    """
    less = 1.0 / (zeta * zeta)  # 1 - (s/zeta)^2
    square = x * x
    term = x * square / 6.0
    share = less
    total = 0.0
    n = 5.0
    while True:
        total += term * share
        if term <= 1e-17 * total:
            return total
        term *= square / (n * (n - 1.0))
        share = share * (1.0 - less) + less
        n += 2.0


@entry
def damping_functions(w, zeta, r):
    """The damping functions ``u`` and ``g`` of a mode, T(7.11), (7.12).

    For ``zeta = 0``: ``u = tan(pi/(2R))/R`` and ``g = 0``.  At an exact pole ``u`` is infinite.
    """
    a = w / r
    if zeta == 0.0:
        sine, cosine = sincos_quarter(w, 0.0, r)
        if cosine == 0.0:
            return math.inf, 0.0
        return a * sine / cosine, 0.0
    x = math.pi * zeta * a
    small = math.exp(-x)  # every hyperbolic function below is scaled by exp(-x)
    if zeta < 1.0:
        s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
        # where exp(-x) underflows the angle has no effect, and may be out of range
        sine, cosine = 0.0, 0.0
        if small > 0.0:
            less = w * zeta * zeta / (1.0 + s)  # w s = w - less, with the smaller rounding error
            if zeta < 0.5:
                sine, cosine = sincos_quarter(w, less, r)
            else:
                sine, cosine = sincos_quarter(w * s, 0.0, r)
        gap = -math.expm1(-x)
        below = 0.5 * gap * gap + 2.0 * cosine * cosine * small
        swing = 2.0 * sine * cosine * small / s
        angle = s * math.pi * a
        if angle < 1.0 and x < 1.0:
            above = small * (_sinh_minus_argument(x) + (zeta / s) * _argument_minus_sin(angle))
        else:
            above = 0.5 * gap * (1.0 + small) - zeta * swing
        return a * swing / below, above / below
    if zeta == 1.0:
        swing = small * math.pi * a
        below = 0.5 * (1.0 + small * small) + small
        if x < 1.0:
            return a * swing / below, small * _sinh_minus_argument(x) / below
        return a * swing / below, (0.5 * (1.0 - small * small) - swing) / below
    s = math.sqrt((zeta - 1.0) * (zeta + 1.0))
    angle = s * math.pi * a
    slow = math.exp(-math.pi * a / (zeta + s))  # exp(angle - x)
    swing = slow * (-math.expm1(-2.0 * angle)) / (2.0 * s)
    below = 0.5 * (1.0 + small * small) + 0.5 * slow * (1.0 + math.exp(-2.0 * angle))
    if x < 1.0:
        above = small * _over_damped_rise(x, zeta)
    else:
        # 1/2 (1 - small^2) - zeta swing, after cancelling the common term s swing = 1/2 (slow - exp(-angle -
        # x))
        lag = math.pi * a / (zeta + s)  # x - angle
        above = -0.5 * math.expm1(-lag) * (1.0 + small * math.exp(-angle)) - swing / (zeta + s)
    return a * swing / below, above / below

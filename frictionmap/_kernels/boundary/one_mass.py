"""S of one mode: the largest value of [u cos(tau) + h'(tau)]/sin(tau) over 0 < tau < pi, T(2.27), (7.46).

With ``y = h'`` the bracket is ``f = (u cos + y)/sin`` and ``f' = m/sin^2`` where

    m = y' sin - y cos - u,       m' = (y'' + y) sin,        f = y sin + y' cos - m cot.

``y'' + y`` is a damped oscillation whose zeros are equally spaced and known, so ``m`` is monotone between two
of them: it has at most one root there, found by a safeguarded Newton iteration.  The maxima are the roots in
the intervals where ``y'' + y < 0``.  ``m`` is zero at both ends of (0, pi), so the first and the last
interval hold none.  Both sides are searched towards the middle, and the search of a side ends when an upper
bound on the remaining intervals is below the largest value found.  The maximum is therefore global.
"""

import math

from ..closed_form import HALF_PI, decay
from ..compiler import kernel

#: Newton's method inside a bracket halves it at worst; 60 halvings exhaust a double.
MAX_ITERATIONS = 60

#: f is flat at its maximum: an error of 1e-9 in the angle a*tau is one of 1e-18 of f.
ANGLE_TOLERANCE = 1e-9


@kernel
def _evaluate(tau, a, zeta, u, forms):
    """Compute m, y'' + y and f + m cot at tau; `forms` holds the coefficients of y, y' and y'' + y over (q,
    e) of `decay`.
    """
    y_q, y_e, p_q, p_e, k_q, k_e = forms
    q, e = decay(zeta, a * tau)
    sine = math.sin(tau)
    cosine = math.cos(tau)
    y = y_q * q + y_e * e
    slope = p_q * q + p_e * e
    m = slope * sine - y * cosine - u
    return m, k_q * q + k_e * e, y * sine + slope * cosine


@kernel
def narrow(low, high, tau, m, slope):
    """Narrow the bracket of the root of the falling function m; return it with Newton's next point, or its
    middle.
    """
    if m > 0.0:
        low = tau
    else:
        high = tau
    new = tau - m / slope if slope < 0.0 else low
    if not (low < new < high):
        new = 0.5 * (low + high)
    return low, high, new


@kernel
def _stationary_value(low, high, a, zeta, u, forms):
    """Value of f at the root of m in (low, high), where m falls; -inf if there is none or m rises."""
    if _evaluate(0.5 * (low + high), a, zeta, u, forms)[1] >= 0.0:
        return -math.inf
    if _evaluate(low, a, zeta, u, forms)[0] <= 0.0:
        return -math.inf
    if _evaluate(high, a, zeta, u, forms)[0] >= 0.0:
        return -math.inf
    tau = 0.5 * (low + high)
    value = -math.inf
    for _ in range(MAX_ITERATIONS):
        m, bend, value = _evaluate(tau, a, zeta, u, forms)
        value -= m / math.tan(tau)  # f = (u cos + y)/sin in the form that does not cancel near m = 0
        if m == 0.0:
            break
        low, high, new = narrow(low, high, tau, m, bend * math.sin(tau))
        if abs(new - tau) * a <= ANGLE_TOLERANCE:
            break
        tau = new
    return value


@kernel
def largest_bracket(a, zeta, u, g, floor):
    """Compute max(floor, S) for one mode with chi^2/w^2 = 1.

    Parameters
    ----------
    a : 1/R of the mode, finite, > 0
    zeta, u, g : its damping ratio and damping functions, finite
    floor : lower limit that S has to exceed: its end limit, or the limit that depends on mu
    """
    if zeta >= 1.0 or (zeta == 0.0 and a <= 2.0):
        # over-damped: y'' + y has one zero at most, so there is no interval between two of them;
        # undamped with R >= 1/2: it has one, at pi/2
        return floor
    y_q = (1.0 + g) * a
    p_q = a * u
    p_e = (1.0 + g) * a * a + 2.0 * zeta * a * u
    # y'' + y = (1 - a^2) y - 2 zeta a y'
    k_q = (1.0 - a * a) * y_q - 2.0 * zeta * a * p_q
    k_e = (a * a - 1.0) * u - 2.0 * zeta * a * p_e
    forms = (y_q, -u, p_q, p_e, k_q, k_e)
    s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    # y'' + y = exp(-zeta theta) [k_e cos(s theta) + (k_q - zeta k_e)/s sin(s theta)], theta = a tau:
    # its zeros are (first + j pi)/(s a)
    first = math.atan2(-k_e, (k_q - zeta * k_e) / s) % math.pi
    rate = s * a
    count = int(math.floor(rate - first / math.pi))  # intervals between two zeros inside (0, pi)
    half = int(math.ceil(0.5 * rate - first / math.pi))  # the first one that starts at or past pi/2
    half = max(0, min(half, count))
    size_y = math.hypot(u, (y_q + zeta * u) / s)
    size_p = math.hypot(p_e, (p_q - zeta * p_e) / s)

    # At a root |f| <= |y| + min(|y'|, (|u| + |y|)/sin(tau)), from m = 0.
    best = floor
    sine_half = math.sin((first + half * math.pi) / rate)
    for j in range(half):
        low = (first + j * math.pi) / rate
        y = size_y * math.exp(-zeta * a * low)
        p = size_p * math.exp(-zeta * a * low)
        if low > 0.0 and y + min(p, (abs(u) + y) / min(math.sin(low), sine_half)) <= best:
            break
        high = (first + (j + 1) * math.pi) / rate
        best = max(best, _stationary_value(low, high, a, zeta, u, forms))
    y = size_y * math.exp(-zeta * a * HALF_PI)
    p = size_p * math.exp(-zeta * a * HALF_PI)
    for j in range(count - 1, half - 1, -1):
        high = (first + (j + 1) * math.pi) / rate
        if y + min(p, (abs(u) + y) / math.sin(high)) <= best:
            break
        low = (first + j * math.pi) / rate
        best = max(best, _stationary_value(low, high, a, zeta, u, forms))
    return best

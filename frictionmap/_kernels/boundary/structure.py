"""Response functions U, G, H and S of structures, and the modal bound; once per r, independent of beta.

S of many modes is the maximum of the sum over modes, theory.md 3.  With ``Y = sum c_i h_i'``, ``c_i =
chi_i^2/w_i^2``, the bracket is ``f = n/sin``, ``n = U cos + Y``, and ``f' = m/sin^2`` where

    m = Y' sin - Y cos - U,        m' = W sin,        W = Y'' + Y.

Intervals are halved until each is settled by one of two proofs.  Either no value in it can exceed the largest
found so far, since ``n - best sin`` is negative at both ends by more than its curvature allows.  Or W keeps
its sign, since it is far enough from zero at both ends, so that m has at most one root; the largest value is
then at an end or at this root, which Newton's method finds.

Close to its resonance u of a mode is of order 1/(w - r), while its contributions to n, m and W stay finite: u
cos and the term -u e of h' nearly cancel.  There they are combined before they are multiplied by u, in
products of u with w - r and zeta that have a limit at the pole.
"""

import math

import numpy as np

from ..closed_form import damping_functions, decay, fastest_rate
from ..compiler import entry, kernel
from .one_mass import ANGLE_TOLERANCE, MAX_ITERATIONS, largest_bracket, narrow

#: Initial intervals per period of the fastest mode.
_INTERVALS = 4.0

#: Largest number of halvings of an interval: at this depth its values equal those at its ends to rounding.
_DEEPEST = 40

#: Rows of the table of modes that `mode_sums` fills, one column a mode: c, a = 1/R, zeta, and y_i = h_i',
#: y_i' and y_i'' + y_i over (q, e) of `decay`.  Modes beside their resonance have no use for Y_E and P_Q,
#: which hold u, except delta = s a - 1 with s^2 = 1 - zeta^2, and u delta, u zeta and u (a - s); BESIDE is 1
#: for them, else 0.  Of oscillators that the damping couples c is 1, and y_i is c_i h_i' + d_i h_i''.
C, A, ZETA, Y_Q, Y_E, P_Q, P_E, K_Q, K_E, DELTA, U_DELTA, U_ZETA, U_GAP, BESIDE = range(14)
ROWS = 14


@kernel
def _beside_resonance(a, zeta):
    """Whether w - r is free of rounding error and the mode oscillates; other modes have no pole of u close to
    a = 1.
    """
    return 0.5 <= a <= 2.0 and zeta < 1.0


@kernel
def _fill_column(table, n, c, w, r, zeta, u, g, slope):
    """Fill column n of the table.

    Parameters
    ----------
    table : (ROWS, modes) table to fill; n : its column
    c : chi^2/w^2 of the mode
    w, zeta : natural frequency and damping ratio
    r : frequency ratio
    u, g : damping functions
    slope : g a^2 + 2 zeta a u
    """
    a = w / r
    table[C, n] = c
    table[A, n] = a
    table[ZETA, n] = zeta
    table[Y_Q, n] = (1.0 + g) * a
    table[Y_E, n] = -u
    table[P_Q, n] = a * u
    table[P_E, n] = slope + a * a
    table[BESIDE, n] = 0.0
    if _beside_resonance(a, zeta):
        table[BESIDE, n] = 1.0
        off = (w - r) / r
        u_off = u * off if math.isfinite(u) else -2.0 / math.pi  # its limit: u -> -2/(pi off)
        u_zeta = u * zeta if zeta > 0.0 else 0.0
        one_less_s = zeta * zeta / (1.0 + math.sqrt((1.0 - zeta) * (1.0 + zeta)))
        u_one_less_s = u_zeta * (one_less_s / zeta) if zeta > 0.0 else 0.0
        table[DELTA, n] = off - a * one_less_s
        table[U_DELTA, n] = u_off - a * u_one_less_s
        table[U_ZETA, n] = u_zeta
        table[U_GAP, n] = u_off + u_one_less_s
        table[K_Q, n] = -(a + 1.0) * off * table[Y_Q, n] - 2.0 * a * a * u_zeta
        table[K_E, n] = (a + 1.0) * u_off - 2.0 * zeta * a * table[P_E, n]
    else:
        table[K_Q, n] = (1.0 - a * a) * table[Y_Q, n] - 2.0 * zeta * a * table[P_Q, n]
        table[K_E, n] = (a * a - 1.0) * u - 2.0 * zeta * a * table[P_E, n]


@kernel
def _fill_coupled(table, n, c, d, a, zeta, u, g):
    """Fill column n of the table for an oscillator of coupled modes, whose response is c h' + d h''.

    Parameters
    ----------
    table : (ROWS, modes) table to fill; n : its column
    c, d : coefficients of h' and h''
    a, zeta : 1/R and damping ratio
    u, g : damping functions
    """
    rate, pull = (1.0 + g) * a, -u
    bend, push = -a * pull, a * rate - 2.0 * zeta * a * pull
    y_q, y_e = c * rate + d * bend, c * pull + d * push
    p_q, p_e = -a * y_e, a * y_q - 2.0 * zeta * a * y_e
    table[BESIDE, n] = 0.0
    table[C, n], table[A, n], table[ZETA, n] = 1.0, a, zeta
    table[Y_Q, n], table[Y_E, n], table[P_Q, n], table[P_E, n] = y_q, y_e, p_q, p_e
    table[K_Q, n], table[K_E, n] = y_q - a * p_e, y_e + a * p_q - 2.0 * zeta * a * p_e


@kernel
def mode_sums(r, w, zeta, static, rates, table):
    """Compute U, G, H of theory.md 2 at r > 0 and the bound of T(5.55); fill `table` for `largest_sum`.

    Parameters
    ----------
    r : frequency ratio
    w, zeta : (n,) natural frequencies and damping ratios
    static, rates : (n,) the response of z to friction is the sum of static h_i + rates r h_i'; rates = 0 for
        modes
    table : (ROWS, n) filled with the modes

    Returns
    -------
    (U, G, H, S by modes, modes in the table) : S by modes is infinite where S is, at a pole of u other than
        the resonance r = w; it is NaN where the damping couples modes
    """
    total_u = 0.0
    total_g = 0.0
    total_h = 0.0
    by_modes = 0.0
    n = 0
    for i in range(w.size):
        u, g = damping_functions(w[i], zeta[i], r)
        a = w[i] / r
        c = static[i]
        total_u += c * u
        total_g += c * g
        slope = g * a * a
        if zeta[i] > 0.0:
            slope += 2.0 * zeta[i] * a * u
        total_h += c * slope
        if rates[i] != 0.0:
            # h_i''(0+) = slope + a^2; the a^2 add up to nothing in U, and to 1/(m_eff r^2) in h''(0+)
            d = rates[i] * r
            total_u -= d * slope
            total_g += d * u
            total_h += d * (a * a * u - 2.0 * zeta[i] * a * slope)
            by_modes = by_modes if math.isinf(by_modes) else math.nan
            _fill_coupled(table, n, c, d, a, zeta[i], u, g)
            n += 1
            continue
        if math.isinf(u) and w[i] != r:
            by_modes = math.inf
            continue
        by_modes += c * largest_bracket(a, zeta[i], u, g, slope + a * a)
        _fill_column(table, n, c, w[i], r, zeta[i], u, g, slope)
        n += 1
    return total_u, total_g, total_h, by_modes, n


@kernel
def _amplitude(zeta, q, e):
    """Upper bound over theta >= 0 on |q Q + e E| with (Q, E) of `decay`."""
    if zeta < 1.0:
        # exp(-zeta theta) [e cos(s theta) + (q - zeta e) sin(s theta)/s], and |sin(s t)/s| <= t
        s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
        swing = abs(q - zeta * e)
        least = min(swing / s, swing / (math.e * zeta)) if zeta > 0.0 else swing
        return math.hypot(e, swing / s) if least == swing / s else abs(e) + least
    # Q <= 1/(e zeta) at its top, |E| <= 1
    return abs(e) + abs(q) / zeta


@kernel
def _combined(tau, sine, cosine, mode):
    """Compute n, m, m cot + n/sin and W, each over c, of a mode close to resonance; `mode` is its column."""
    a = mode[A]
    zeta = mode[ZETA]
    s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    theta = a * tau
    swing = math.cos(s * theta)
    envelope = math.exp(-zeta * theta)
    fallen = -math.expm1(-zeta * theta) / zeta if zeta > 0.0 else theta  # (1 - envelope)/zeta
    q = envelope * math.sin(s * theta) / s
    e = envelope * swing - zeta * q
    half = 0.5 * mode[DELTA] * tau
    half_sine = math.sin(half)
    beat = mode[U_DELTA] * 0.5 * tau * (half_sine / half if half != 0.0 else 1.0)  # u sin(delta tau/2)
    # cos - e = 2 sin((s a + 1) tau/2) sin(delta tau/2) + zeta (fallen cos(s theta) + q)
    n = mode[Y_Q] * q + 2.0 * beat * math.sin(0.5 * (s * theta + tau)) + mode[U_ZETA] * (fallen * swing + q)
    # a q sin + e cos - 1 = envelope (cos(delta tau) - 1) - (1 - envelope) + (a - s) q sin - zeta q cos
    m = mode[P_E] * e * sine - mode[Y_Q] * q * cosine
    m += mode[U_GAP] * q * sine - 2.0 * beat * half_sine * envelope - mode[U_ZETA] * (fallen + q * cosine)
    # a q cos - e sin = envelope sin(delta tau) + (a - s) q cos + zeta q sin
    f = mode[Y_Q] * q * sine + mode[P_E] * e * cosine
    f += mode[U_GAP] * q * cosine + 2.0 * beat * math.cos(half) * envelope + mode[U_ZETA] * q * sine
    return n, m, f, mode[K_Q] * q + mode[K_E] * e


@kernel
def _values(tau, table, n_modes):
    """Compute n, m, m cot + n/sin, which does not cancel where m = 0, and W at tau."""
    sine = math.sin(tau)
    cosine = math.cos(tau)
    n = 0.0
    m = 0.0
    f = 0.0
    k = 0.0
    for i in range(n_modes):
        c = table[C, i]
        if table[BESIDE, i] == 1.0:
            n_i, m_i, f_i, k_i = _combined(tau, sine, cosine, table[:, i])
            n += c * n_i
            m += c * m_i
            f += c * f_i
            k += c * k_i
            continue
        q, e = decay(table[ZETA, i], table[A, i] * tau)
        u = -table[Y_E, i]
        y = table[Y_Q, i] * q + table[Y_E, i] * e
        p = table[P_Q, i] * q + table[P_E, i] * e
        n += c * (u * cosine + y)
        m += c * (p * sine - y * cosine - u)
        f += c * (y * sine + p * cosine)
        k += c * (table[K_Q, i] * q + table[K_E, i] * e)
    return n, m, f, k


@kernel
def _at_crossing(low, high, fastest, table, n):
    """Value of f at the root of m in (low, high), where m falls and W < 0."""
    tau = 0.5 * (low + high)
    value = -math.inf
    for _ in range(MAX_ITERATIONS):
        _, m, f, k = _values(tau, table, n)
        sine = math.sin(tau)
        value = f - m * math.cos(tau) / sine
        if m == 0.0:
            break
        low, high, new = narrow(low, high, tau, m, k * sine)
        if abs(new - tau) * fastest <= ANGLE_TOLERANCE:
            break
        tau = new
    return value


@kernel
def _bends(table, n):
    """Upper bounds on |n''| and |W''|, and the fastest rate."""
    fastest = 1.0
    u = 0.0
    bend_n = 0.0
    bend_w = 0.0
    for i in range(n):
        c = table[C, i]
        a = table[A, i]
        zeta = table[ZETA, i]
        fastest = max(fastest, fastest_rate(a, zeta))
        size_k = _amplitude(zeta, table[K_Q, i], table[K_E, i])
        rate_k = _amplitude(zeta, -a * table[K_E, i], a * (table[K_Q, i] - 2.0 * zeta * table[K_E, i]))
        # W'' = -2 zeta a W' - a^2 W of a mode, and so for y
        bend_w += c * (2.0 * zeta * a * rate_k + a * a * size_k)
        if table[BESIDE, i] == 1.0:
            # n'' = W - n, and n is bounded term by term, as `_combined` has it, with fallen <= theta
            size_q = _amplitude(zeta, 1.0, 0.0)
            size_n = abs(table[Y_Q, i]) * size_q + math.pi * abs(table[U_DELTA, i])
            bend_n += c * (size_k + size_n + abs(table[U_ZETA, i]) * (math.pi * a + size_q))
        else:
            u -= c * table[Y_E, i]
            size_y = _amplitude(zeta, table[Y_Q, i], table[Y_E, i])
            size_p = _amplitude(zeta, table[P_Q, i], table[P_E, i])
            bend_n += c * (2.0 * zeta * a * size_p + a * a * size_y)
    return bend_n + abs(u), bend_w, fastest


@kernel
def largest_sum(floor, table, n, stack):
    """Compute max(floor, S) for the modes in `table`; `stack` is scratch of shape (2 * _DEEPEST, 8)."""
    if n == 0:
        return floor
    bend_n, bend_w, fastest = _bends(table, n)
    best = floor
    count = int(math.ceil(_INTERVALS * 0.5 * fastest)) + 2
    _, _, _, k0 = _values(0.0, table, n)
    n0 = 0.0  # n(0) = n(pi) = 0
    m0 = 0.0
    tau0 = 0.0
    for j in range(1, count + 1):
        tau1 = math.pi * j / count
        n1, m1, f1, k1 = _values(tau1, table, n)
        if j < count:
            best = max(best, f1 - m1 * math.cos(tau1) / math.sin(tau1))
        else:
            m1 = 0.0
            n1 = 0.0
        # a stack of intervals: tau, n, m, W at both ends
        stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = tau0, n0, m0, k0
        stack[0, 4], stack[0, 5], stack[0, 6], stack[0, 7] = tau1, n1, m1, k1
        depth = 1
        while depth > 0:
            depth -= 1
            low, n_low, m_low, k_low = (
                stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3]
            )  # fmt: skip
            high, n_high, m_high, k_high = (
                stack[depth, 4], stack[depth, 5], stack[depth, 6], stack[depth, 7]
            )  # fmt: skip
            square = (high - low) ** 2 * 0.125
            over_low = n_low - best * math.sin(low)
            over_high = n_high - best * math.sin(high) if high < math.pi else 0.0
            if max(over_low, over_high) + square * (bend_n + abs(best)) < 0.0:
                continue
            slack = square * bend_w
            if min(k_low, k_high) > slack or (max(k_low, k_high) < -slack):
                if m_low > 0.0 and m_high < 0.0 and k_low < 0.0:
                    best = max(best, _at_crossing(low, high, fastest, table, n))
                continue
            if (high - low) * fastest < 1e-6 or depth + 2 > stack.shape[0]:
                continue  # flat: its ends, which were looked at, say all that a double can
            tau = 0.5 * (low + high)
            middle, m, f, k = _values(tau, table, n)
            best = max(best, f - m * math.cos(tau) / math.sin(tau))
            stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3] = low, n_low, m_low, k_low
            stack[depth, 4], stack[depth, 5], stack[depth, 6], stack[depth, 7] = tau, middle, m, k
            stack[depth + 1, 0], stack[depth + 1, 1] = tau, middle
            stack[depth + 1, 2], stack[depth + 1, 3] = m, k
            stack[depth + 1, 4], stack[depth + 1, 5] = high, n_high
            stack[depth + 1, 6], stack[depth + 1, 7] = m_high, k_high
            depth += 2
        tau0, n0, m0, k0 = tau1, n1, m1, k1
    return best


@entry
def many_mode_functions(r, w, zeta, static, rates, inverse_mass, u, g, h, s, by_modes):
    """Fill U, G, H, S of theory.md 2 and 3 and the bound of T(5.55) over frequencies.

    At r = 0 (limits): S is infinite; U has no limit (NaN) if a participating mode is undamped, else it is 0.

    Parameters
    ----------
    r : (n_r,) frequency ratios >= 0
    w, zeta : (n,) natural frequencies and damping ratios of the participating oscillators
    static, rates : (n,) response to friction, see `mode_sums`
    inverse_mass : 1/m_eff
    u, g, h, s, by_modes : (n_r,) filled with U, G, H, S and the bound
    """
    table = np.empty((ROWS, w.size))
    stack = np.empty((2 * _DEEPEST, 8))
    for j in range(r.size):
        if r[j] == 0.0:
            u[j], g[j], h[j] = 0.0, 0.0, 0.0
            for i in range(w.size):
                if zeta[i] == 0.0:
                    u[j] = math.nan
                else:
                    g[j] += static[i]
                    h[j] = math.inf
            s[j] = math.inf
            by_modes[j] = math.inf
            continue
        u[j], g[j], h[j], by_modes[j], n = mode_sums(r[j], w, zeta, static, rates, table)
        floor = h[j] + inverse_mass / (r[j] * r[j])
        s[j] = math.inf if math.isinf(by_modes[j]) else largest_sum(floor, table, n, stack)

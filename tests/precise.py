"""Closed forms of theory.md 2 and 3 for one mass in high precision, written from the equations.

Imports nothing from the package.
"""

from typing import NamedTuple

import mpmath as mp

DIGITS = 75  # next to a pole of u half of them are lost


class Precise(NamedTuple):
    """V, U, G, H and S of one mass with friction against a fixed wall."""

    v: mp.mpc
    u: mp.mpf
    g: mp.mpf
    h: mp.mpf
    s: mp.mpf


def damping_functions(r: mp.mpf, zeta: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """u and g, T(7.11), (7.12); complex square roots continue them through zeta = 1."""
    if zeta == 1:
        zeta = zeta + mp.mpf(10) ** (-DIGITS // 2)
    s = mp.sqrt(mp.mpc(1 - zeta**2))
    angle = mp.pi * s / r
    x = mp.pi * zeta / r
    below = mp.cosh(x) + mp.cos(angle)
    u = mp.sin(angle) / (r * s * below)
    g = (mp.sinh(x) - zeta / s * mp.sin(angle)) / below
    return mp.re(u), mp.re(g)


def bracket(tau: mp.mpf, r: mp.mpf, zeta: mp.mpf, u: mp.mpf, g: mp.mpf) -> mp.mpf:
    """[u cos + h']/sin, with h' from T(B.8), (B.9)."""
    s = mp.sqrt(mp.mpc(1 - zeta**2))
    if s == 0:
        s = mp.mpc(mp.mpf(10) ** (-DIGITS // 2))
    envelope = mp.exp(-zeta * tau / r)
    q = mp.re(envelope * mp.sin(s * tau / r) / s)
    e = mp.re(envelope * (mp.cos(s * tau / r) - zeta / s * mp.sin(s * tau / r)))  # R q'
    return (u * mp.cos(tau) + (1 + g) * q / r - u * e) / mp.sin(tau)


def functions(r: float, zeta: float, samples: int = 400) -> Precise:
    """All functions at the doubles r and zeta, to 30 digits; S by dense sampling and polishing."""
    with mp.workdps(DIGITS):
        r, zeta = mp.mpf(r), mp.mpf(zeta)
        v = 1 / mp.mpc(1 - r**2, 2 * zeta * r)
        u, g = damping_functions(r, zeta)
        h = (g + 2 * zeta * r * u) / r**2
        best = h + 1 / r**2
        count = int(samples * max(1, 1 / r))
        taus = [mp.pi * (k + mp.mpf(1) / 2) / count for k in range(count)]
        values = [bracket(tau, r, zeta, u, g) for tau in taus]
        for k in range(1, count - 1):
            if values[k - 1] <= values[k] >= values[k + 1]:
                best = max(best, _polish(taus[k - 1], taus[k + 1], r, zeta, u, g))
        return Precise(v, u, g, h, best)


def _polish(low: mp.mpf, high: mp.mpf, r: mp.mpf, zeta: mp.mpf, u: mp.mpf, g: mp.mpf) -> mp.mpf:
    ratio = (mp.sqrt(5) - 1) / 2
    left, right = high - ratio * (high - low), low + ratio * (high - low)
    f_left, f_right = bracket(left, r, zeta, u, g), bracket(right, r, zeta, u, g)
    while high - low > mp.mpf(10) ** -13:  # flat there: the value is good to 26 digits
        if f_left > f_right:
            high, right, f_right = right, left, f_left
            left = high - ratio * (high - low)
            f_left = bracket(left, r, zeta, u, g)
        else:
            low, left, f_left = left, right, f_right
            right = low + ratio * (high - low)
            f_right = bracket(right, r, zeta, u, g)
    return max(f_left, f_right)


def beta_lim(values: Precise, r: float, mu: float) -> mp.mpf:
    """Boundary between continuous and stick-slip motion."""
    with mp.workdps(DIGITS):
        return abs(values.v) / mp.hypot(values.u, max(values.s, values.h + mp.mpf(mu) / mp.mpf(r) ** 2))

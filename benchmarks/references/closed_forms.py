"""Boundaries and continuous motions in 40-digit arithmetic, written from the equations; slow.

Structures with modal damping, in closed form (theory.md 2 to 4). The maximum S is found by sampling, then
polished. Numbers have twice the digits, so that 40 remain where half of them cancel. Input numbers are
doubles, taken as exact.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mpmath  # type: ignore[import-untyped]
import numpy as np

DIGITS = 40
mp = mpmath.mp.clone()
mp.dps = 2 * DIGITS

#: A number, or a matrix, of so many digits.
Number = Any

#: Step of differences, relative: half of the digits carried are left of a slope.
_STEP = mp.mpf(10) ** -20

#: Samples of the bracket of S per period of the fastest mode, and how near to the highest of them (relative)
#: another one is polished too.
_SAMPLES = 48

#: A u of a mode above which samples in doubles lose what is sought in u cos - u e: then they have all digits.
_LARGE_U = 1e6
_CLOSE = 1e-3
_MOST_POLISHED = 6

#: Nodes from the eighth sample towards an end, each four times nearer: a maximum that is nearer still to it
#: differs from the end's limit by less than 10^-18 of it.
_NEAR_ENDS = 18


@dataclass(frozen=True)
class Structure:
    """Modes w, zeta and participation factors chi, lambda, (n,), in 40 digits; matrices for the held
    response.
    """

    mass: Number  # (n, n) M/r^2
    stiffness: Number
    contact: Sequence  # c
    load: Sequence  # p
    base_motion: int  # s
    w: Sequence
    zeta: Sequence
    phi: Number

    @property
    def chi(self) -> list:
        """c.phi_i."""
        return [mp.fdot(self.contact, self.phi[:, i]) for i in range(len(self.w))]

    @property
    def participation(self) -> list:
        """p.phi_i."""
        return [mp.fdot(self.load, self.phi[:, i]) for i in range(len(self.w))]


def chain_matrices(masses: Sequence[float], springs: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """M/r^2 and K of a chain, as lists of sums without rounding to doubles."""
    n = len(masses)
    mass, stiffness = mp.zeros(n), mp.zeros(n)
    for i in range(n):
        mass[i, i] = mp.mpf(masses[i])
        stiffness[i, i] += mp.mpf(springs[i])
        if i:
            stiffness[i - 1, i - 1] += mp.mpf(springs[i])
            stiffness[i, i - 1] = stiffness[i - 1, i] = -mp.mpf(springs[i])
    return mass, stiffness


def structure(
    mass: Number, stiffness: Number, contact: Sequence, load: Sequence, base_motion: int, zeta: Sequence
) -> Structure:
    """Solve the eigenproblem; the mass matrix is diagonal."""
    n = mass.rows
    root = [mp.sqrt(mass[i, i]) for i in range(n)]
    scaled = mp.matrix(n, n)
    for i in range(n):
        for j in range(n):
            scaled[i, j] = stiffness[i, j] / (root[i] * root[j])
    squares, phi = mp.eigsy(scaled)
    for i in range(n):
        for j in range(n):
            phi[i, j] /= root[i]
    return Structure(
        mass, stiffness, [mp.mpf(x) for x in contact], [mp.mpf(x) for x in load], base_motion,
        [mp.sqrt(x) for x in squares], [mp.mpf(x) for x in zeta], phi,
    )  # fmt: skip


def one_mass(zeta: Number) -> Structure:
    """One mass, contact with a fixed wall."""
    return structure(*chain_matrices([1], [1]), [1], [1], 0, [zeta])


def damping_functions(ratio: Number, zeta: Number) -> tuple:
    """u and g of a mode with R = `ratio`, T(7.11), (7.12); u is infinite at a pole."""
    a = 1 / ratio
    if zeta == 0:
        cosine = mp.cos(mp.pi * a / 2)
        return (mp.inf if cosine == 0 or a == 1 else a * mp.sin(mp.pi * a / 2) / cosine), mp.mpf(0)
    root = mp.sqrt(mp.mpc(1 - zeta**2))
    x, angle = mp.pi * zeta * a, mp.pi * a * root
    part = mp.sin(angle) / root if zeta != 1 else mp.pi * a  # analytic continuation through zeta = 1
    below = 2 * (mp.sinh(x / 2) ** 2 + mp.cos(angle / 2) ** 2)  # cosh(x) + cos(angle), which cancels
    return mp.re(a * part / below), mp.re((mp.sinh(x) - zeta * part) / below)


def decay(theta: Number, zeta: Number) -> tuple:
    """q and e = R q' of T(B.8b), (B.9b) at theta = tau/R."""
    envelope = mp.exp(-zeta * theta)
    if zeta == 1:
        q = envelope * theta
        return q, envelope - q
    if zeta < 1:
        root = mp.sqrt(1 - zeta**2)
        cosine, sine = mp.cos_sin(root * theta)
    else:
        root = mp.sqrt(zeta**2 - 1)
        cosine, sine = mp.cosh(root * theta), mp.sinh(root * theta)
    q = envelope * sine / root
    return q, envelope * cosine - zeta * q


class Functions(NamedTuple):
    """V, U, G, H, S of theory.md 2 and 3 at one r, and the time `tau` of S (0 where the end has it)."""

    v: Number
    u: Number
    g: Number
    h: Number
    s: Number
    tau: Number


def _table(body: Structure, r: Number) -> list[tuple]:
    """Participating modes: c = chi^2/w^2, a = 1/R, zeta, u, g."""
    rows = []
    for w, zeta, chi in zip(body.w, body.zeta, body.chi, strict=True):
        if abs(chi) > mp.mpf(10) ** (-DIGITS):
            u, g = damping_functions(r / w, zeta)
            rows.append(((chi / w) ** 2, w / r, zeta, u, g))
    return rows


def _bracket(rows: Sequence[tuple], big_u: Number, tau: Number) -> tuple:
    """(f, m): the bracket whose maximum is S, and sin^2 times its slope."""
    y = slope = mp.mpf(0)
    for c, a, zeta, u, g in rows:
        q, e = decay(a * tau, zeta)
        y += c * ((1 + g) * a * q - u * e)
        slope += c * (((1 + g) * a * a + 2 * zeta * a * u) * e + a * u * q)
    cosine, sine = mp.cos_sin(tau)
    return (big_u * cosine + y) / sine, slope * sine - y * cosine - big_u


def _sampled(rows: Sequence[tuple], big_u: Number, tau: np.ndarray) -> np.ndarray:
    """The bracket in doubles, over max(1, |U|)."""
    scale = max(mp.mpf(1), abs(big_u))
    total = float(big_u / scale) * np.cos(tau)
    for c, a, zeta, u, g in rows:
        z, theta = float(zeta), float(a) * tau
        root = np.sqrt(complex(1.0 - z * z))
        if root == 0.0:
            q = np.exp(-theta) * theta
            e = np.exp(-theta) - q
        else:
            up, down = np.exp((1j * root - z) * theta), np.exp((-1j * root - z) * theta)
            q = ((up - down) / (2j * root)).real
            e = (0.5 * (up + down)).real - z * q
        total += float(c * (1 + g) * a / scale) * q - float(c * u / scale) * e
    return total / np.sin(tau)


def _polished(rows: Sequence[tuple], big_u: Number, low: Number, high: Number) -> tuple:
    """(f, tau) at the maximum between two samples around it."""
    m_low, m_high = _bracket(rows, big_u, low)[1], _bracket(rows, big_u, high)[1]
    if not m_low > 0 > m_high:
        middle = (low + high) / 2
        return max((_bracket(rows, big_u, tau)[0], tau) for tau in (low, middle, high))
    side = 0
    tau = low
    for _ in range(60):
        new = (low * m_high - high * m_low) / (m_high - m_low)
        f, m = _bracket(rows, big_u, new)
        if abs(new - tau) < mp.mpf(10) ** -DIGITS or m == 0:
            break
        tau = new
        if m > 0:  # the Illinois variant of the rule of false position
            low, m_low = new, m
            m_high = m_high / 2 if side == 1 else m_high
            side = 1
        else:
            high, m_high = new, m
            m_low = m_low / 2 if side == -1 else m_low
            side = -1
    return f, new


def _largest(rows: Sequence[tuple], big_u: Number, floor: Number) -> tuple:
    """(S, tau) of the sum."""
    fastest = max([1.0, *(float(a * max(mp.mpf(1), 2 * zeta)) for _, a, zeta, _, _ in rows)])
    cancels = any(abs(c * u) > _LARGE_U for c, _, _, u, _ in rows)
    count = int(_SAMPLES * max(4.0, fastest))
    found: list[tuple[float, float, float]] = []
    best = -math.inf
    chunk = 1 << 20
    for first in range(1, count, chunk):  # chunks overlap by a sample on each side
        k = np.arange(max(first - 1, 1), min(first + chunk + 1, count))
        tau = math.pi * k / count
        if cancels:
            f = np.array([float(_bracket(rows, big_u, mp.mpf(t))[0]) for t in tau])
        else:
            f = _sampled(rows, big_u, tau)
        best = max(best, float(f.max()))
        tops = 1 + np.flatnonzero((f[1:-1] >= f[:-2]) & (f[1:-1] >= f[2:]))
        tops = tops[f[tops] >= best - _CLOSE * abs(best)]
        tops = tops[np.argsort(f[tops])[-_MOST_POLISHED:]]
        found += [(float(f[t]), float(tau[t - 1]), float(tau[t + 1])) for t in tops]
    top = (floor, mp.mpf(0))
    brackets = [(mp.mpf(low), mp.mpf(high)) for _, low, high in sorted(found)[-_MOST_POLISHED:]]
    for low, high in [*brackets, *_end_brackets(rows, big_u, mp.pi / count)]:
        top = max(top, _polished(rows, big_u, low, high))
    return top


def _end_brackets(rows: Sequence[tuple], big_u: Number, first: Number) -> list[tuple]:
    """Brackets of maxima closer to an end than the second sample, where doubles cancel."""
    found = []
    distances = [8 * first * mp.mpf(4) ** -k for k in range(_NEAR_ENDS)]
    for times in (distances, [mp.pi - t for t in distances]):
        f = [_bracket(rows, big_u, t)[0] for t in times]
        found += [
            tuple(sorted((times[k - 1], times[k + 1])))
            for k in range(1, _NEAR_ENDS - 1)
            if f[k - 1] <= f[k] >= f[k + 1]
        ]
    return found


def functions(body: Structure, r: Number, at: Number = None) -> Functions:
    """All functions at r > 0; S at a known time `at`, if given."""
    r = mp.mpf(r)
    v = -mp.mpc(body.base_motion)
    rows = _table(body, r)
    for w, zeta, chi, part in zip(body.w, body.zeta, body.chi, body.participation, strict=True):
        stiffness = mp.mpc((w - r) * (w + r), 2 * zeta * w * r)
        v = v + chi * part / stiffness if stiffness != 0 else mp.mpc(mp.inf)
    big_u = mp.fsum(c * u for c, _, _, u, _ in rows)
    big_g = mp.fsum(c * g for c, _, _, _, g in rows)
    if mp.isinf(big_u):
        return Functions(v, big_u, big_g, mp.mpf(0), mp.inf, mp.mpf(0))
    big_h = mp.fsum(c * (g + 2 * zeta * u / a) * a * a for c, a, zeta, u, g in rows)
    floor = big_h + inverse_mass(body) / r**2
    if at is None:
        s, tau = _largest(rows, big_u, floor)
    else:
        s, tau = (floor, at) if at == 0 else (_bracket(rows, big_u, at)[0], at)
    return Functions(v, big_u, big_g, big_h, s, tau)


def sum_of_maxima(body: Structure, r: Number) -> Number:
    """Maxima of S of the modes, each at its own time, added up as in T(5.55): an upper bound of S."""
    r = mp.mpf(r)
    total = mp.mpf(0)
    for row in _table(body, r):
        c, a, zeta, u, g = row
        total += _largest([row], c * u, c * a * a * (1 + g + 2 * zeta * u / a))[0]
    return total


def inverse_mass(body: Structure) -> Number:
    """1/m_eff of the contact."""
    return mp.fsum(x**2 / body.mass[i, i] for i, x in enumerate(body.contact))


def beta_lim(body: Structure, r: Number, mu: Number, found: Functions) -> Number:
    """Boundary of continuous motion, theory.md 3."""
    if mp.isinf(found.u) and mp.isinf(abs(found.v)):
        return (
            mp.pi
            / 4
            * max(
                abs(part / chi)
                for w, chi, part in zip(body.w, body.chi, body.participation, strict=True)
                if w == mp.mpf(r)
            )
        )
    bracket = max(found.s, found.h + mp.mpf(mu) * inverse_mass(body) / mp.mpf(r) ** 2)
    return mp.mpf(0) if mp.isinf(found.u) else abs(found.v) / mp.hypot(found.u, bracket)


def held_force(body: Structure, r: Number) -> Number:
    """|F| of theory.md 4 from the bordered equations; beta_stick = |F|/mu."""
    r = mp.mpf(r)
    n = body.mass.rows
    damping = _damping_matrix(body) if any(body.zeta) else mp.zeros(n)
    bordered, right = mp.matrix(n + 1, n + 1), mp.matrix(n + 1, 1)
    for i in range(n):
        for j in range(n):
            bordered[i, j] = mp.mpc(body.stiffness[i, j] - r**2 * body.mass[i, j], r * damping[i, j])
        bordered[i, n] = bordered[n, i] = body.contact[i]
        right[i] = body.load[i]
    right[n] = body.base_motion
    return abs(mp.lu_solve(bordered, right)[n])


def _damping_matrix(body: Structure) -> Number:
    """C1 = M phi diag(2 zeta w) phi^T M."""
    shapes = body.mass * body.phi
    rates = mp.diag([2 * zeta * w for zeta, w in zip(body.zeta, body.w, strict=True)])
    return shapes * rates * shapes.T


def continuous_amplitude(found: Functions, beta: Number) -> Number:
    """Z of T(2.34), (7.20)."""
    beta = mp.mpf(beta)
    if mp.isinf(abs(found.v)):
        return mp.inf
    if beta == 0:
        return abs(found.v)
    return mp.sqrt(abs(found.v) ** 2 - (beta * found.u) ** 2) - beta * found.g


def condition(function: Callable[..., Number], *arguments: Number) -> Number:
    """Sum over the arguments x of |x f'(x)/f(x)|, by differences of 20 digits; the larger of both sides."""
    value = function(*arguments)
    if not mp.isfinite(value) or value == 0:
        return mp.inf
    total = mp.mpf(0)
    for k, x in enumerate(arguments):
        sides = []
        for step in (_STEP, -_STEP):
            moved = [*arguments]
            moved[k] = mp.mpf(x) * (1 + step)
            sides.append(abs((function(*moved) - value) / (step * value)))
        total += max(sides)
    return total

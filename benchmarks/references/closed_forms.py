"""The theory in 40-digit arithmetic, written from the equations; slow, and with nothing of the package in it.

Boundaries and continuous motions of structures with modal damping in closed form (theory.md 2 to 4; the
maximum S is looked for by sampling, then polished), and steady states with stops of one mass (theory.md 5):
slides and stops in closed form, every event by Newton's method, the periodic orbit by Steffensen's.
Numbers carry twice the digits: 40 are left where half of them cancel.  Input is doubles, taken as they are.
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

# ---------------------------------------------------------------- structures in closed form

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
    """Modes w, zeta and participations chi, lambda, (n,), all of 40 digits; matrices for the held answer."""

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
    """M/r^2 and K of a chain, as lists of sums that no double rounds."""
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
    """Solve the eigenproblem; the mass is diagonal."""
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
    """Seen modes: c = chi^2/w^2, a = 1/R, zeta, u, g."""
    rows = []
    for w, zeta, chi in zip(body.w, body.zeta, body.chi, strict=True):
        if abs(chi) > mp.mpf(10) ** (-DIGITS):
            u, g = damping_functions(r / w, zeta)
            rows.append(((chi / w) ** 2, w / r, zeta, u, g))
    return rows


def _bracket(rows: Sequence[tuple], big_u: Number, tau: Number) -> tuple:
    """(f, m): the bracket whose maximum is S, and sin^2 of its slope."""
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
    """Brackets of maxima nearer to an end than the second sample, where doubles cancel."""
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


# ---------------------------------------------------------------- steady states of one mass

REVERSE, BACK, ON = "reverse", "stop, then back", "stop, then on"

#: Scan steps per period of the fastest part, and how near to zero (relative) a velocity is looked at closely.
_SCAN = 48
_GRAZING = 1e-4
_MOST_SCANNED = 4_000_000

#: Anchors agree to this before the orbit is solved for.
_NEARLY = 1e-4
_MOST_LAG = 24

#: Slides after which a march counts as worth a guess no longer, and steps of Steffensen's method.
_SETTLING = 8
_MOST_STEPS = 12


class Steady(NamedTuple):
    """A periodic steady state of one mass in units of the load in the contact."""

    stops: int  # in `halves` half periods
    halves: int
    amplitude: Number
    stuck: Number  # share of time
    anchor: Number  # z at the end of a stop from which the orbit starts, upwards
    slides: int
    shortest: Number  # shortest stop, in tau


class OneMass:
    """r^2 z'' + 2 zeta r z' + z + b sgn z' = cos(theta), followed exactly from event to event."""

    def __init__(self, r: Number, zeta: Number, b: Number, mu: Number) -> None:
        self.r, self.zeta, self.b = mp.mpf(r), mp.mpf(zeta), mp.mpf(b)
        if self.zeta == 0 and self.r == 1:
            self.r += mp.mpf(10) ** -DIGITS  # the limit: V cancels, half of the digits are left
        self.mu_b = mp.mpf(mu) * self.b
        self.v = 1 / mp.mpc((1 - self.r) * (1 + self.r), 2 * self.zeta * self.r)
        fastest = max(1.0, float((1 if self.zeta <= 1 else self.zeta + mp.sqrt(self.zeta**2 - 1)) / self.r))
        self.h = 2.0 * math.pi / (_SCAN * fastest)
        self._step = self._scan_matrix()

    def _state(self, z0: Number, c0: Number, s0: Number, t: Number) -> tuple:
        """z, z' and z'' of an upward slide from rest at z0, a time t after load phase (c0, s0)."""
        cosine, sine = mp.cos_sin(t)
        return self._moved(z0, mp.mpf(0), c0, s0, self.b, cosine, sine, t)

    def _moved(
        self,
        z0: Number,
        v0: Number,
        c0: Number,
        s0: Number,
        b: Number,
        cosine: Number,
        sine: Number,
        t: Number,
    ) -> tuple:
        """The same from speed v0, with cos and sin of t."""
        r, x, y = self.r, self.v.real, self.v.imag
        c, s = c0 * cosine - s0 * sine, s0 * cosine + c0 * sine
        a = z0 - (x * c0 - y * s0) + b
        rate = v0 + (x * s0 + y * c0)
        q, e = decay(t / r, self.zeta)
        z = x * c - y * s - b + a * (e + 2 * self.zeta * q) + rate * r * q
        v = -x * s - y * c - a * q / r + rate * e
        return z, v, (c - b - z - 2 * self.zeta * r * v) / r**2

    def _scan_matrix(self) -> list[list[float]]:
        """(z, v) after one scan step for unit z, v, cos, sin and b, in doubles."""
        t = mp.mpf(self.h)
        cosine, sine = mp.cos_sin(t)
        columns = []
        for unit in np.eye(5):
            z, v, c, s, b = map(mp.mpf, unit)
            columns.append([float(x) for x in self._moved(z, v, c, s, b, cosine, sine, t)[:2]])
        return columns

    def _first_zero(self, z0: Number, c0: Number, s0: Number) -> Number:
        """Time of the first zero of the velocity of an upward slide from rest."""
        (zz, vz), (zv, vv), (zc, vc), (zs, vs), (z1, v1) = self._step
        h, b, r, damping = self.h, float(self.b), float(self.r), 2.0 * float(self.zeta * self.r)
        cosine, sine = math.cos(h), math.sin(h)
        z, v, c, s = float(z0), 0.0, float(c0), float(s0)
        square = r * r
        a = float((c0 - self.b - z0) / self.r**2)
        for k in range(_MOST_SCANNED):
            z, v_new = (
                zz * z + zv * v + zc * c + zs * s + z1 * b,
                vz * z + vv * v + vc * c + vs * s + v1 * b,
            )
            c, s = c * cosine - s * sine, s * cosine + c * sine
            a_new = (c - b - z - damping * v_new) / square
            # values of the cubic's control points: above zero by more than its error, the velocity is so too
            size = _GRAZING * (abs(v) + abs(v_new) + h * (abs(a) + abs(a_new)))
            if k == 0 or min(v, v_new, v + a * h / 3.0, v_new - a_new * h / 3.0) <= size:
                t = self._zero_within(z0, c0, s0, k)
                if t is not None:
                    return t
            v, a = v_new, a_new
        raise ArithmeticError("a slide does not end")

    def _zero_within(self, z0: Number, c0: Number, s0: Number, k: int) -> Number:
        """The first zero in scan step k in 40 digits, if there is one: signs and minima on eighths of it."""
        parts = 8
        h = mp.mpf(self.h)
        nodes = [(k + mp.mpf(j) / parts) * h for j in range(parts + 1)]
        before = None
        for t in nodes:
            if t == 0:
                continue
            _, v, a = self._state(z0, c0, s0, t)
            if v <= 0:
                low = before[0] if before else mp.mpf(0)
                return self._root(z0, c0, s0, low, t)
            if before and before[2] < 0 < a:  # a minimum between
                low, high = before[0], t
                bottom = self._bottom(z0, c0, s0, low, high)
                if self._state(z0, c0, s0, bottom)[1] <= 0:
                    return self._root(z0, c0, s0, low, bottom)
            before = (t, v, a)
        return None

    def _bottom(self, z0: Number, c0: Number, s0: Number, low: Number, high: Number) -> Number:
        """Where the acceleration changes its sign from below."""
        for _ in range(60):
            middle = (low + high) / 2
            if self._state(z0, c0, s0, middle)[2] < 0:
                low = middle
            else:
                high = middle
        return (low + high) / 2

    def _root(self, z0: Number, c0: Number, s0: Number, low: Number, high: Number) -> Number:
        """Zero of the velocity, which falls through it between low and high: Newton's method, kept inside."""
        t = high
        for _ in range(200):
            _, v, a = self._state(z0, c0, s0, t)
            if v > 0:
                low = t
            else:
                high = t
            new = t - v / a if a != 0 else low
            if not low < new < high:
                new = (low + high) / 2 if low > 0 or v > 0 else (low + 3 * high) / 4
            if abs(new - t) < abs(t) * mp.mpf(10) ** (-DIGITS - 10):
                return new
            t = new
        return t

    def after(self, z0: Number, c0: Number, s0: Number) -> tuple:
        """A slide and what follows: (event, z, cos, sin of the next upward slide, |z|, duration, wait).

        The event is None where the contact sticks for good.
        """
        t = self._first_zero(z0, c0, s0)
        z = self._state(z0, c0, s0, t)[0]
        cosine, sine = mp.cos_sin(t)
        c, s = c0 * cosine - s0 * sine, s0 * cosine + c0 * sine
        if z - c > self.mu_b:
            return REVERSE, -z, -c, -s, abs(z), t, mp.mpf(0)
        if z - c < -self.mu_b:
            return ON, z, c, s, abs(z), t, mp.mpf(0)
        return *self._pause(z, c, s), abs(z), t, self._wait(z, c, s)[1]

    def _wait(self, z: Number, c: Number, s: Number) -> tuple:
        """(leaves upwards in the load, i.e. moves back; duration of the stop)."""
        now = mp.atan2(s, c)
        ends = []
        for level, back in ((z - self.mu_b, True), (z + self.mu_b, False)):
            if abs(level) < 1:
                angle = mp.acos(level)
                # cos falls through its level at +angle (the load leaves upwards), rises at -angle
                ends.append(((angle if back else -angle) - now) % (2 * mp.pi))
            else:
                ends.append(mp.inf)
        return ends[0] < ends[1], min(ends)

    def _pause(self, z: Number, c: Number, s: Number) -> tuple:
        """A stop at z: (event, state of the next upward slide); the event is None if it lasts."""
        back, wait = self._wait(z, c, s)
        if mp.isinf(wait):
            return None, z, c, s
        level = z - self.mu_b if back else z + self.mu_b
        sine = mp.sqrt((1 - level) * (1 + level))
        if back:
            return BACK, -z, -level, -sine
        return ON, z, level, -sine

    def anchor(self, z: Number) -> tuple:
        """The state in which a stop at z ends, upward motion following."""
        c = z + self.mu_b
        if abs(c) > 1:
            raise ArithmeticError("no stop ends there")
        return z, c, -mp.sqrt((1 - c) * (1 + c))

    def _return(self, z: Number, slides: int) -> Number:
        state = [*self.anchor(z)]
        for _ in range(slides):
            event, *state = self.after(*state)[:4]
            if event is None:
                raise ArithmeticError("sticks for good")
        return state[0]

    def steady(self, phase: Number, most: int) -> Steady | None:
        """Steady state reached from rest at load phase `phase`.

        None if it sticks, has no stops or is not found in `most` slides.
        """
        c, s = mp.cos_sin(mp.mpf(phase))
        event, *state = self._pause(mp.mpf(0), c, s) if abs(c) <= self.mu_b else self._push_off(c, s)
        anchors: list = []  # (slides so far, z, kind)
        for slides in range(1, most + 1):
            event, *state, _, _, wait = self.after(*state)
            if event is None:
                return None
            if event == REVERSE or wait == 0:
                continue
            z = state[0]
            for then, old, kind in anchors[: -_MOST_LAG - 1 : -1]:
                if kind == event and abs(z - old) <= _NEARLY * abs(z):
                    found = self.solved(z, slides - then)
                    if found is not None:
                        return found
                    break
            anchors.append((slides, z, event))
        return None

    def unique(self, guess: Number, phase: Number, most: int) -> Steady | None:
        """The same for mu = 1, where there is one only, however found.

        First the symmetric orbit with one stop, at its turn, is tried: from the amplitude `guess`, and from
        the middle of two stops; next to a multiplier of -1 a march stays asymmetric for long.
        """
        if mp.isfinite(guess):
            found = self.solved(-guess, 1)
            if found is not None:
                return found
        c, s = mp.cos_sin(mp.mpf(phase))
        event, *state = self._pause(mp.mpf(0), c, s) if abs(c) <= self.mu_b else self._push_off(c, s)
        last = None
        for _ in range(_SETTLING):
            event, *state = self.after(*state)[:4]
            if event == BACK:
                if last is not None:
                    found = self.solved((state[0] + last) / 2, 1)
                    if found is not None:
                        return found
                last = state[0]
        return self.steady(phase, most)

    @staticmethod
    def _push_off(c: Number, s: Number) -> tuple:
        """The first slide from rest under a load beyond mu b."""
        return (REVERSE, mp.mpf(0), c, s) if c > 0 else (REVERSE, mp.mpf(0), -c, -s)

    def solved(self, z: Number, slides: int) -> Steady | None:
        """Steffensen's method on the return after so many slides from z, then the orbit's measures."""
        try:
            for _ in range(_MOST_STEPS):
                once = self._return(z, slides)
                twice = self._return(once, slides)
                bend = twice - 2 * once + z
                if bend == 0 or abs(once - z) < abs(z) * mp.mpf(10) ** -DIGITS:
                    return self._measured(once, slides)
                z -= (once - z) ** 2 / bend
        except ArithmeticError:
            pass
        return None

    def _measured(self, z: Number, slides: int) -> Steady | None:
        state = [*self.anchor(z)]
        stops, stuck, time, amplitude, shortest = 0, mp.mpf(0), mp.mpf(0), mp.mpf(0), mp.inf
        for _ in range(slides):
            event, *state, size, t, wait = self.after(*state)
            if event is None:
                return None
            if wait > 0:
                stops += 1
                shortest = min(shortest, wait)
            stuck += wait
            time += t + wait
            amplitude = max(amplitude, size)
        halves = int(mp.nint(time / mp.pi))
        near = mp.mpf(10) ** -20
        if abs(time - halves * mp.pi) > near * halves or abs(state[0] - z) > near * abs(z):
            return None
        return Steady(stops, halves, amplitude, stuck / time, z, slides, shortest)

"""Steady states of one mass in 40-digit arithmetic, written from the equations (theory.md 5); slow.

Slides and stops have closed forms. Every event is found by Newton's method, the periodic orbit by
Steffensen's.
"""

import math
from typing import NamedTuple

import numpy as np

from .closed_forms import DIGITS, Number, decay, mp

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
        """z, z' and z'' of an upward slide from speed v0, with cos and sin of t."""
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
        """First zero in scan step k in 40 digits, if there is one: signs and minima on eighths of it."""
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
        """Time at which the acceleration changes its sign from below."""
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

        The event is None if the contact sticks permanently.
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
        """(whether the load leaves the range of friction upwards, so that the mass moves back; duration of
        the stop).
        """
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
        """A stop at z: (event, state of the next upward slide); None as event if the stop is permanent."""
        back, wait = self._wait(z, c, s)
        if mp.isinf(wait):
            return None, z, c, s
        level = z - self.mu_b if back else z + self.mu_b
        sine = mp.sqrt((1 - level) * (1 + level))
        if back:
            return BACK, -z, -level, -sine
        return ON, z, level, -sine

    def anchor(self, z: Number) -> tuple:
        """State in which a stop at z ends, with upward motion following."""
        c = z + self.mu_b
        if abs(c) > 1:
            raise ArithmeticError("no stop ends there")
        return z, c, -mp.sqrt((1 - c) * (1 + c))

    def _return(self, z: Number, slides: int) -> Number:
        state = [*self.anchor(z)]
        for _ in range(slides):
            event, *state = self.after(*state)[:4]
            if event is None:
                raise ArithmeticError("sticks permanently")
        return state[0]

    def steady(self, phase: Number, most: int) -> Steady | None:
        """Steady state reached from rest at load phase `phase`.

        None if it sticks, has no stops or is not found within `most` slides.
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
        """Steady state for mu = 1, where only one exists, found from any state.

        First the symmetric orbit with one stop, at its turn, is tried: from the amplitude `guess`, and from
        the middle of two stops. Next to a multiplier of -1 a march remains asymmetric for long.
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
        """First slide from rest under a load beyond mu b."""
        return (REVERSE, mp.mpf(0), c, s) if c > 0 else (REVERSE, mp.mpf(0), -c, -s)

    def solved(self, z: Number, slides: int) -> Steady | None:
        """Steffensen's method on the recurrence after `slides` slides from z, and results of the orbit."""
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

"""Steady states to check against: event-exact, from the equation of motion alone, nothing of the package.

A phase (slide or stop) is followed in steps by its Taylor series, whose coefficients the equation of motion
gives one from another.  The series of what ends the phase (the velocity in a slide; in a stop what the
contact can still hold) is sampled inside every step, its dips between samples are looked into, and the first
zero is polished.  Two codes do this:

`settle` in doubles for one mass, compiled: march from rest until the state repeats.  For many cells.  A stop
of one mass ends where an arccos says.

`periodic_orbit` in 40-digit arithmetic for any structure of `baselines.Problem`: Newton's method on the
return map, from the state that a fixed-step method has come to.  For few cells.
"""

import math
from typing import NamedTuple

import mpmath as mp
import numpy as np
from numba import njit

from ..peers.fixed_step import SHORTEST_STOP, TWO_PI, Problem

#: Terms of the series in doubles, for steps of at most half a radian of the fastest part of the motion.
TERMS = 18
RADIANS = 0.5
_SAMPLES = 8
_SHORTEST_STEP = 1e-6
_MOST_EVENTS = 10_000

#: A steady state may repeat after so many periods.
LONGEST_PERIOD = 8

DIGITS = 40
_MP_TERMS = 46  # 1/46! = 2e-58, for steps of one radian
_MP_SAMPLES = 64


# ---------------------------------------------------------------- one mass, doubles


class Settled(NamedTuple):
    """What `settle` has found; `period` is 0 if the state did not repeat in time."""

    period: int  # excitation periods
    stops: float  # a cycle; nan where the contact sticks for good
    amplitude: float
    cycles: int
    shortest: float  # least length of a stop in the steady state
    residual: float


@njit(cache=True, error_model="numpy")
def _series(place, velocity, cosine, sine, damping, square, friction, h, x, v):
    """Series of a slide in tau over h: x'' = square (load - friction - x) - damping x'.

    cosine, sine : F cos and F sin of the phase of the load, at the start
    """
    x[0] = place
    v[0] = velocity
    for k in range(TERMS - 1):
        constant = friction if k == 0 else 0.0
        step = h / (k + 1.0)
        x[k + 1] = step * v[k]
        v[k + 1] = step * (square * (cosine - constant - x[k]) - damping * v[k])
        cosine, sine = -step * sine, step * cosine


@njit(cache=True, error_model="numpy")
def _sum(a, t):
    total = 0.0
    for k in range(TERMS - 1, -1, -1):
        total = total * t + a[k]
    return total


@njit(cache=True, error_model="numpy")
def _slope(a, t):
    total = 0.0
    for k in range(TERMS - 1, 0, -1):
        total = total * t + k * a[k]
    return total


@njit(cache=True, error_model="numpy")
def _bisect(a, low, high, sense, derivative):
    """Where sense times the series (or its derivative) falls from positive to not positive."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        value = _slope(a, middle) if derivative else _sum(a, middle)
        if sense * value > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@njit(cache=True, error_model="numpy")
def _first_fall(a, sign, fresh):
    """First t in (0, 1] at which sign times the series is no longer positive; 2.0 if it stays so."""
    bend = 0.0
    for k in range(1, TERMS):
        bend += k * abs(a[k])
    left = 0.0
    value_left = sign * a[0]
    slope_left = sign * a[1]
    begun = not fresh
    for m in range(1, _SAMPLES + 1):
        right = m / _SAMPLES
        value = sign * _sum(a, right)
        slope = sign * _slope(a, right)
        if value <= 0.0:
            if begun or value_left > 0.0:
                return _bisect(a, left, right, sign, False)
            # the slide has just begun: it rises to a top inside, and falls from there
            if slope_left >= 0.0 > slope:
                top = _bisect(a, left, right, sign, True)
                if sign * _sum(a, top) > 0.0:
                    return _bisect(a, top, right, sign, False)
            return left
        near = 0.5 * bend / _SAMPLES
        if begun and slope_left < 0.0 < slope and min(value_left, value) < near:
            low = _bisect(a, left, right, -sign, True)
            if sign * _sum(a, low) <= 0.0:
                return _bisect(a, left, low, sign, False)
        begun = True
        left, value_left, slope_left = right, value, slope
    return 2.0


@njit(cache=True, error_model="numpy")
def _release(load, limit, tau, phase, z):
    """Length of a stop at z from tau on, and the direction after it; the contact was able to stick."""
    wait = math.inf
    sign = 0
    theta = tau + phase
    if z + limit < load:
        wait = (-math.acos(max((z + limit) / load, -1.0)) - theta) % TWO_PI
        sign = 1
    if z - limit > -load:
        back = (math.acos(min((z - limit) / load, 1.0)) - theta) % TWO_PI
        if back < wait:
            wait = back
            sign = -1
    if wait > TWO_PI - 1e-9:  # rounding put it in the past
        wait = 0.0
    return wait, sign


@njit(cache=True, error_model="numpy")
def settle(r, zeta, load, phase, beta, mu, most_cycles, tolerance):
    """March one mass from rest under load cos(tau + phase) until what is left to come is below the tolerance.

    z'' = (load cos(tau + phase) - beta sgn(z') - z)/r^2 - 2 zeta z'/r
    """
    square = 1.0 / (r * r)
    damping = 2.0 * zeta / r
    limit = mu * beta
    h_most = RADIANS * min(1.0, r, r / (2.0 * zeta) if zeta > 0.0 else 1.0)
    x, v = np.empty(TERMS), np.empty(TERMS)
    memory = np.zeros((LONGEST_PERIOD + 1, 3))  # z, r z' and direction at tau = 0 of the last periods
    counts = np.zeros(LONGEST_PERIOD + 1)  # stops that began, by period
    peaks = np.zeros(LONGEST_PERIOD + 1)
    shorts = np.full(LONGEST_PERIOD + 1, math.inf)
    before = np.full(LONGEST_PERIOD + 1, math.inf)  # residuals a while ago
    z, w, tau = 0.0, 0.0, 0.0
    sign = 0
    push = load * math.cos(phase)
    wait = 0.0
    if abs(push) > limit:
        sign = 1 if push > 0.0 else -1
    else:
        wait, sign = _release(load, limit, 0.0, phase, 0.0)
        if sign == 0:
            return Settled(1, math.nan, 0.0, 0, math.inf, 0.0)
    fresh = True
    residual = math.inf
    for cycle in range(1, most_cycles + 1):
        slot = cycle % (LONGEST_PERIOD + 1)
        counts[slot], peaks[slot], shorts[slot] = 0.0, abs(z), math.inf
        events = 0
        while tau < TWO_PI:
            if wait > 0.0:
                passed = min(wait, TWO_PI - tau)
                wait -= passed
                tau = TWO_PI if wait > 0.0 else tau + passed
                continue
            # a dip soon after the start is the one to miss: short steps there
            h = min(0.125 * h_most if fresh else h_most, TWO_PI - tau)
            angle = tau + phase
            _series(
                z, w, load * math.cos(angle), load * math.sin(angle), damping, square, sign * beta, h, x, v
            )
            # a slide that has just begun does not end at once: what is below rounding is not looked at
            t = 2.0 if fresh and h < _SHORTEST_STEP else _first_fall(v, sign, fresh)
            if t > 1.0:
                z, w = _sum(x, 1.0), _sum(v, 1.0)
                tau = TWO_PI if h == TWO_PI - tau else tau + h
                fresh = fresh and h < _SHORTEST_STEP
                peaks[slot] = max(peaks[slot], abs(z))
                continue
            events += 1
            if events > _MOST_EVENTS:
                return Settled(0, math.nan, math.nan, cycle, 0.0, math.inf)
            z, w = _sum(x, t), 0.0
            tau += t * h
            peaks[slot] = max(peaks[slot], abs(z))
            fresh = True
            push = load * math.cos(tau + phase) - z
            if abs(push) > limit:
                sign = 1 if push > 0.0 else -1
            else:
                wait, sign = _release(load, limit, tau, phase, z)
                if sign == 0:
                    return Settled(1, math.nan, 0.0, cycle, math.inf, 0.0)
                if wait > SHORTEST_STOP:
                    counts[slot] += 1.0
                    shorts[slot] = min(shorts[slot], wait)
        tau = 0.0
        memory[slot, 0], memory[slot, 1], memory[slot, 2] = z, r * w, wait
        scale = max(peaks[slot], 1e-3 * load)
        for period in range(1, min(LONGEST_PERIOD, cycle - 1) + 1):
            other = (slot - period) % (LONGEST_PERIOD + 1)
            residual = math.hypot(z - memory[other, 0], r * w - memory[other, 1]) + abs(
                wait - memory[other, 2]
            )
            rate = (residual / before[period]) ** (period / 16.0) if cycle > 40 else 1.0
            if cycle % 16 == 0:
                before[period] = residual
            done = residual <= 4e-16 * scale
            if not done and rate < 1.0 and cycle % 16 == 0:
                done = residual * rate / (1.0 - rate) <= tolerance * scale
            if done:
                stops, peak, short = 0.0, 0.0, math.inf
                for k in range(period):
                    place = (slot - k) % (LONGEST_PERIOD + 1)
                    stops += counts[place]
                    peak = max(peak, peaks[place])
                    short = min(short, shorts[place])
                return Settled(period, stops / period, peak, cycle, short, residual)
    return Settled(0, counts[slot], peaks[slot], most_cycles, shorts[slot], residual)


# ---------------------------------------------------------------- any structure, 40 digits


class Orbit(NamedTuple):
    """A periodic orbit in 40-digit arithmetic, rounded."""

    stops: int
    amplitude: float
    begins: list[float]  # tau in [0, 2 pi) at which stops begin, increasing
    multiplier: float  # largest modulus of an eigenvalue of the return map
    residual: float  # what one more return still changes


class _State(NamedTuple):
    place: list
    velocity: list
    cosine: mp.mpf  # of tau
    sine: mp.mpf


class _Path(NamedTuple):
    """What a march passed: its end, max |x_j|, and the times since its start at which stops begin."""

    state: _State
    peak: mp.mpf
    begins: list


class _Exact:
    """The series of one problem, in 40 digits."""

    def __init__(self, p: Problem):
        def exact(rows):
            return [[mp.mpf(float(value)) for value in row] for row in rows]

        self.stiffness, self.damping = exact(p.stiffness), exact(p.damping)
        self.n, self.contact, self.load = len(p.stiffness), p.contact, p.load
        self.inverse = 1 / mp.mpf(p.inertia)
        self.load_cos, self.load_sin = mp.mpf(p.load_cos), mp.mpf(p.load_sin)
        self.beta, self.limit = mp.mpf(p.beta), mp.mpf(p.mu) * mp.mpf(p.beta)
        fastest = max(
            1.0, math.sqrt(np.linalg.eigvalsh(p.stiffness).max() / p.inertia),
            np.abs(p.damping).max() / p.inertia,
        )  # fmt: skip
        self.h = mp.mpf(1) / math.ceil(fastest)

    def series(self, state: _State, sign: int) -> tuple[list, list, list]:
        """Coefficients of places, velocities and of the force that would hold the contact, in tau."""
        n, j = self.n, self.contact
        x, v = [list(state.place)], [list(state.velocity)]
        load, quarter = (
            self.load_cos * state.cosine + self.load_sin * state.sine,
            self.load_sin * state.cosine - self.load_cos * state.sine,
        )
        holding = []
        for k in range(_MP_TERMS):
            force = [
                (load if i == self.load else mp.mpf(0))
                - mp.fdot(self.stiffness[i], x[k]) - mp.fdot(self.damping[i], v[k])
                for i in range(n)
            ]  # fmt: skip
            holding.append(force[j])
            if sign and k == 0:
                force[j] -= sign * self.beta
            if not sign:
                force[j] = mp.mpf(0)
            x.append([value / (k + 1) for value in v[k]])
            v.append([self.inverse * value / (k + 1) for value in force])
            load, quarter = quarter / (k + 1), -load / (k + 1)
        return x, v, holding

    def at(self, series: list, t: mp.mpf) -> list:
        """Values of the series at t."""
        return [mp.polyval([row[i] for row in reversed(series)], t) for i in range(self.n)]

    def move(self, state: _State, x: list, v: list, t: mp.mpf) -> _State:
        """The state t later."""
        c, s = mp.cos(t), mp.sin(t)
        turned = state.cosine * c - state.sine * s, state.sine * c + state.cosine * s
        return _State(self.at(x, t), self.at(v, t), *turned)

    def decide(self, state: _State) -> int:
        """What follows a zero of the velocity: 0, or the direction of the next slide."""
        load = self.load_cos * state.cosine + self.load_sin * state.sine if self.load == self.contact else 0
        push = (
            load - mp.fdot(self.stiffness[self.contact], state.place)
            - mp.fdot(self.damping[self.contact], state.velocity)
        )  # fmt: skip
        return 0 if abs(push) <= self.limit else int(mp.sign(push))

    def march(self, state: _State, sign: int, length: mp.mpf) -> _Path:
        """Follow the motion for `length` from a state inside a slide or at the start of one."""
        past = mp.mpf(0)
        j = self.contact
        peak, begins = abs(state.place[j]), []
        fresh = state.velocity[j] == 0
        while past < length:
            x, v, holding = self.series(state, sign)
            h = min(self.h, length - past)
            if sign:
                watched = [[sign * row[j] for row in v]]
            else:
                watched = [[side * value for value in holding] for side in (-1, 1)]
                for row in watched:
                    row[0] += self.limit
            falls = [first_fall(row, h, fresh and bool(sign)) for row in watched]
            found = [(t, side) for side, t in zip((1, -1), falls, strict=False) if t is not None]
            t, side = min(found) if found else (h, 0)
            state = self.move(state, x, v, t)
            past += t
            fresh = bool(found)
            if found and sign:
                state.velocity[j] = mp.mpf(0)
                sign = self.decide(state)
                if not sign:
                    begins.append(past)
            elif found:
                sign = side
            peak = max(peak, abs(state.place[j]))
        return _Path(state, peak, begins)


def first_fall(coefficients: list, h: mp.mpf, fresh: bool) -> mp.mpf | None:
    """First t in (0, h] at which the series falls to zero; `fresh`: it is zero at 0 and rises from there."""
    a = np.array([float(value * h**k) for k, value in enumerate(coefficients)])
    grid = np.linspace(0.0, 1.0, _MP_SAMPLES + 1)
    values = np.polynomial.polynomial.polyval(grid, a)
    slopes = np.polynomial.polynomial.polyval(grid, np.polynomial.polynomial.polyder(a))
    first = 0
    if fresh:
        if values[1] <= 0.0:
            raise ArithmeticError("a slide of less than a sample")
        first = 1
    down = np.flatnonzero(values[first + 1 :] <= 0.0)
    dips = first + np.flatnonzero((slopes[first:-1] < 0.0) & (slopes[first + 1 :] > 0.0))
    near = np.abs(slopes).max() / _MP_SAMPLES
    grazing = [k for k in dips if min(values[k], values[k + 1]) <= near and values[k] > 0.0 < values[k + 1]]
    falling = list(reversed(coefficients))
    for k in grazing:
        if np.polynomial.polynomial.polyval(np.linspace(grid[k], grid[k + 1], 1001), a).min() <= 0.0:
            raise ArithmeticError("a dip between two samples reaches zero: no reference for this cell")
    if not down.size:
        return None
    low, high = grid[first + down[0]] * h, grid[first + down[0] + 1] * h
    return mp.findroot(
        lambda t: mp.polyval(falling, t), (low, high), solver="anderson", tol=mp.mpf(10) ** -70
    )


def periodic_orbit(p: Problem, tau: float, place: np.ndarray, velocity: np.ndarray) -> Orbit | None:
    """The orbit of one excitation period near a state in a slide at tau; None if there is none so near."""
    with mp.workdps(DIGITS):
        exact = _Exact(p)
        n = exact.n
        start = mp.mpf(tau)
        c, s = mp.cos(start), mp.sin(start)
        sign = 1 if velocity[p.contact] > 0.0 else -1

        def path(y: mp.matrix) -> _Path:
            state = _State(list(y[:n]), list(y[n:]), c, s)
            return exact.march(state, sign, 2 * mp.pi)

        def change(y: mp.matrix, passed: _Path) -> mp.matrix:
            return mp.matrix([*passed.state.place, *passed.state.velocity]) - y

        y = mp.matrix([mp.mpf(float(value)) for value in (*place, *velocity)])
        small = mp.mpf(10) ** -18
        first = change(y, path(y))
        if max(abs(value) for value in first) > 1e-5:
            return None
        jacobian = mp.matrix(2 * n, 2 * n)
        for k in range(2 * n):
            moved = y.copy()
            moved[k] += small
            column = (change(moved, path(moved)) - first) / small
            for i in range(2 * n):
                jacobian[i, k] = column[i]
        left = first
        for _ in range(6):
            y = y - mp.lu_solve(jacobian, left)
            found = path(y)
            left = change(y, found)
            if max(abs(value) for value in left) < mp.mpf(10) ** -25:
                break
        else:
            return None
        multipliers = np.linalg.eigvals(np.array(jacobian.tolist(), dtype=float) + np.eye(2 * n))
        begins = sorted(float((start + t) % (2 * mp.pi)) for t in found.begins)
        residual = float(max(abs(value) for value in left))
        return Orbit(len(begins), float(found.peak), begins, float(np.abs(multipliers).max()), residual)

"""Periodic orbits of any structure in 40-digit arithmetic, from the equations of motion alone; for few cells.

A segment (slide or stop) is followed in steps by its Taylor series, whose coefficients follow recursively
from the equations of motion. The series of the quantity that ends the segment (the velocity in a slide; in a
stop the remaining holding force) is sampled inside every step. Minima between samples are examined, and the
first zero is polished. The orbit is found by Newton's method on the return map, from the state that a
fixed-step method has reached.
"""

import math
from typing import NamedTuple

import mpmath as mp
import numpy as np

from ..peers.fixed_step import Problem

DIGITS = 40
_MP_TERMS = 46  # 1/46! = 2e-58, for steps of one radian
_MP_SAMPLES = 64


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
    """Result of a march: its end, max |x_j|, and the times since its start at which stops begin."""

    state: _State
    peak: mp.mpf
    begins: list


class _Exact:
    """Series of one problem, in 40 digits."""

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
        """Coefficients of displacements, velocities and of the force that would hold the contact, in tau."""
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
        """State after the time t."""
        c, s = mp.cos(t), mp.sin(t)
        turned = state.cosine * c - state.sine * s, state.sine * c + state.cosine * s
        return _State(self.at(x, t), self.at(v, t), *turned)

    def decide(self, state: _State) -> int:
        """Next segment after a zero of the velocity: 0, or the direction of the next slide."""
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
    """Orbit of one excitation period near a state in a slide at tau; None if there is none that close."""
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

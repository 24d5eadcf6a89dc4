"""Elastic contacts that residual flexibility couples, and their motion by matrix exponentials and sign tests.

It shares no code with the package: sub-steps so fine that no two events of a contact are in one, brentq, and
the friction law by trying all patterns.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

import frictionmap as fm


class Given:
    """A structure with the last point under load, and contacts at the others."""

    def __init__(self, seed, contacts=None):
        rng = np.random.default_rng(seed)
        self.count = contacts or int(rng.integers(2, 6))
        modes, points = int(rng.integers(2, 5)), self.count + 1
        self.w = 1.0 + np.concatenate(([0.0], np.cumsum(rng.uniform(0.3, 2.0, modes - 1))))
        self.zeta = rng.uniform(0.02, 0.06, modes)
        self.shapes = rng.normal(size=(points, modes))
        root = 0.3 * rng.normal(size=(points, points))
        self.residual = root @ root.T
        self.kt = rng.uniform(1.0, 12.0, self.count)
        self.force = rng.choice([0.03, 0.1, 0.3, 1.0], self.count) * rng.uniform(0.5, 1.5, self.count)
        self.load = {1: 1.0 + 0.0j, 2: 0.4 * np.exp(1j * rng.uniform(0.0, 6.0))}
        self.r = float(rng.uniform(0.4, 1.6))
        self.more = [{} for _ in range(self.count)]

    def modes(self, order=None, **keys):
        """Its modes, with the points in another order; keys: more of them."""
        names = [*(f"c{j}" for j in range(self.count)), "load"]
        at = np.arange(self.count + 1) if order is None else np.array(order)
        return fm.Modes(
            self.w, self.zeta, self.shapes[at], [names[k] for k in at], self.residual[np.ix_(at, at)], **keys
        )

    def system(self, modes=None, **keys):
        """The system; keys: of its load, in the place of that of `self`."""
        contacts = [
            fm.Contact(masses=[f"c{j}"], stiffness=self.kt[j], force=self.force[j], **self.more[j])
            for j in range(self.count)
        ]
        keys = keys or {"load_mass": "load", "load_harmonics": self.load}
        return fm.System(modes=modes or self.modes(), contacts=contacts, **keys)

    def free(self):
        """Add a rigid-body mode, under a load that does not drive it one way."""
        self.w, self.zeta = np.append(0.0, self.w), np.append(0.0, self.zeta)
        self.shapes = np.column_stack((np.full(self.count + 1, 0.7), self.shapes))
        self.load = {1: 1.0 + 0.0j}

    def displacements(self, n, forces):
        """Displacements of the points by a harmonic of the load and of forces in the contacts (N,)."""
        p = np.append(-forces, self.load.get(n, 0.0))
        o = n * self.r
        modes = (self.shapes.T @ p) / (self.w**2 - o**2 + 2j * self.zeta * self.w * o)
        return self.shapes @ modes + self.residual @ p


def rates(given, flexibility, senses, at_limit, free):
    """Rates of the forces and the pattern after an event, by trying all patterns; mu = 1.

    free : (N,) rates of the displacements without forces
    """
    for choice in product((0, 1), repeat=len(at_limit)):
        pattern = np.zeros(given.count, dtype=int)
        for slides, j in zip(choice, at_limit, strict=True):
            pattern[j] = senses[j] * slides
        held = pattern == 0
        force = np.zeros(given.count)
        force[held] = np.linalg.solve(flexibility[np.ix_(held, held)], free[held])
        slide = free - flexibility @ force
        inside = all(senses[j] * force[j] <= 0.0 for j in at_limit if pattern[j] == 0)
        if inside and (pattern[~held] * slide[~held] > 0.0).all():
            return force, pattern
    raise AssertionError


class Load(NamedTuple):
    """A load of k coordinates c, c' = generator c."""

    generator: np.ndarray  # (k, k)
    push: np.ndarray  # (n, k) of the modes
    direct: np.ndarray  # (N, k) displacement of the contacts beside them, relative to their walls
    place: np.ndarray  # (p, k) of the points


def load_at_last(given, generator):
    """A load at the last point, of which the first coordinate is its value."""
    one = np.eye(len(generator))[0]
    column = given.residual[:, -1]
    return Load(
        np.array(generator, dtype=float), np.outer(given.shapes[-1], one), np.outer(column[:-1], one),
        np.outer(column, one),
    )  # fmt: skip


class March:
    """The motion from rest, a matrix exponential for each pattern; u = (q, q', f, load), time over 1/r."""

    def __init__(self, given, load, start, r=1.0):
        self.given, self.load, self.r = given, load, r
        self.chi = given.shapes[:-1]
        self.flexibility = given.residual[:-1, :-1] + np.diag(1.0 / given.kt)
        self.n, self.known, self.rows = given.w.size, {}, {}
        self.forces = slice(2 * self.n, 2 * self.n + given.count)
        self.drive = slice(2 * self.n + given.count, None)
        self.u = np.zeros(2 * self.n + given.count + len(load.generator))
        self.u[self.drive] = start
        self.pattern = np.zeros(given.count, dtype=int)  # the sliders begin where the forces are 0
        self.events, self.distance = 0, np.zeros(given.count)
        self.free = np.zeros((given.count, self.u.size))  # rates of the displacements without forces
        self.free[:, self.n : 2 * self.n], self.free[:, self.drive] = self.chi, load.direct @ load.generator

    def matrix(self, pattern):
        """u' = A u."""
        given, n = self.given, self.n
        a = np.zeros((self.u.size, self.u.size))
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n, :n] = -np.diag(given.w**2) / self.r**2
        a[n : 2 * n, n : 2 * n] = -np.diag(2.0 * given.zeta * given.w) / self.r
        a[n : 2 * n, self.forces] = -self.chi.T / self.r**2
        a[n : 2 * n, self.drive] = self.load.push / self.r**2
        a[self.drive, self.drive] = self.load.generator
        held = np.flatnonzero(pattern == 0)
        a[2 * n + held] = np.linalg.solve(self.flexibility[np.ix_(held, held)], self.free[held])
        return a

    def slide_rates(self, pattern):
        """Rates of the sliders, (N, ...) of u."""
        if tuple(pattern) not in self.rows:
            force = self.matrix(pattern)[self.forces]
            self.rows[tuple(pattern)] = pattern[:, np.newaxis] * (self.free - self.flexibility @ force)
        return self.rows[tuple(pattern)]

    def after(self, time, keep=False):
        """u after a time in the present pattern."""
        key = (tuple(self.pattern), time)
        if key in self.known:
            return self.known[key] @ self.u
        found = expm(self.matrix(self.pattern) * time)
        if keep:
            self.known[key] = found
        return found @ self.u

    def watched(self, u, sides):
        """What is > 0 in the present pattern, (N,), of forces beside their limits of these signs."""
        inside = self.given.force - sides * u[self.forces]
        return np.where(self.pattern == 0, inside, self.slide_rates(self.pattern) @ u)

    def displacements(self):
        """Of the points."""
        forces = self.given.residual[:, :-1] @ self.u[self.forces]
        return self.given.shapes @ self.u[: self.n] + self.load.place @ self.u[self.drive] - forces

    def advance(self, time):
        """Follow a sub-step."""
        rest = time
        while True:
            end = self.after(rest, rest == time)
            sides = np.sign(end[self.forces])
            broken = np.flatnonzero(self.watched(end, sides) < 0.0)
            at, j = min(((self._zero(rest, sides, j), j) for j in broken), default=(rest, -1))
            new = end if j < 0 else self.after(at)
            free, force = self.chi @ (new - self.u)[: self.n], (new - self.u)[self.forces]
            free += self.load.direct @ (new - self.u)[self.drive]
            self.distance += self.pattern * (free - self.flexibility @ force)
            self.u, rest = new, rest - at
            if j < 0:
                return
            self._change(j)

    def _zero(self, rest, sides, j):
        def margin(t):
            return self.watched(self.after(t), sides)[j]

        # a force at its limit may fall first, and come back
        begin = next((t for t in rest * np.arange(32) / 32 if margin(t) > 0.0), None)
        return 0.0 if begin is None else brentq(margin, begin, rest, xtol=1e-14 * rest, rtol=1e-14)

    def _change(self, j):
        senses = self.pattern.copy()
        if senses[j] != 0:
            senses[j] = 0
            self._take(senses)
            return
        senses[j] = int(np.sign(self.u[2 * self.n + j]))
        self.u[2 * self.n + j] = senses[j] * self.given.force[j]
        self._choose(senses)

    def _choose(self, senses):
        """Let contacts at their limits slip on, or hold, by the rates there."""
        limits, free = np.flatnonzero(senses), self.free @ self.u
        self._take(rates(self.given, self.flexibility, senses, limits, free)[1])

    def _take(self, pattern):
        self.events += int((pattern != self.pattern).sum())
        self.pattern = pattern

    def bend(self, coordinates):
        """Give the load other coordinates of the same value."""
        self.u[self.drive] = coordinates
        self._choose(self.pattern)

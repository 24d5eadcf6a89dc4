"""Motions of structures with one contact that opens and piecewise linear springs, integrated for tests.

The equations of every phase are integrated by DOP853 in physical coordinates, up to its events; nothing of
the package is used.  Masses move relative to the ground, which does not move; the base may.
"""

import numpy as np
from numpy.polynomial import polynomial
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

OPEN, HELD = 2, 0


class Course:
    """A function of time by polynomials of the time since the beginning of every interval."""

    def __init__(self, times, terms):
        self.times, self.terms = np.asarray(times, float), [np.asarray(one, float) for one in terms]

    @classmethod
    def through(cls, times, values, how="linear"):
        """Samples joined by straight lines, by a natural spline, or by values that hold."""
        if how == "cubic":
            return cls(times, CubicSpline(times, values, bc_type="natural").c[::-1].T)
        if how == "hold":
            return cls([*times, 2.0 * times[-1] - times[-2]], [[value] for value in values])
        return cls(times, zip(values[:-1], np.diff(values) / np.diff(times), strict=True))

    def integral(self):
        found, start = [], 0.0
        for terms, step in zip(self.terms, np.diff(self.times), strict=True):
            found.append(polynomial.polyint(terms, k=start))
            start = polynomial.polyval(step, found[-1])
        return Course(self.times, found)

    def at(self, k, t):
        """Value at a time in interval k."""
        return polynomial.polyval(t - self.times[k], self.terms[k])


class Truth:
    """A structure, a contact, springs (direction, knots, forces, slopes), and a load over time.

    push : shares of the load on the masses; None: the load is the acceleration of the base, which begins at
        rest and at whose other end the first springs and dampers of K and C are
    """

    def __init__(self, matrices, contact, springs, push, load):
        self.mass, self.damping, self.stiffness = (np.asarray(matrices[name], float) for name in "MCK")
        self.inverse, self.n = np.linalg.inv(self.mass), len(self.mass)
        self.contact, self.springs = {"moved": 0.0} | contact, springs
        still = Course(load.times, [[0.0]] * len(load.terms))
        self.push = np.zeros(self.n) if push is None else np.asarray(push, float)
        self.load, self.times, self.k = load, load.times, 0
        speed = load.integral()
        self.base = (still, still, still) if push is not None else (speed.integral(), speed, load)
        self.mode = OPEN if contact["N0"] < 0.0 else HELD
        self.pieces = [int(np.searchsorted(knots, 0.0)) for _, knots, _, _ in springs]
        self.events = []

    def base_at(self, t):
        """Displacement, velocity and acceleration of the base."""
        return [one.at(self.k, t) for one in self.base]

    def normal(self, x):
        return self.contact["N0"] + self.contact["kn"] * self.contact["d"] @ x

    def spring(self, s, x):
        direction, knots, forces, slopes = self.springs[s]
        knot = max(self.pieces[s] - 1, 0)
        return direction * (forces[knot] + slopes[self.pieces[s]] * (direction @ x - knots[knot]))

    def force(self, t, x, v, f):
        """Friction force in the present phase."""
        if self.mode == OPEN:
            return 0.0
        if self.mode != HELD:
            return self.mode * self.contact["phi"] * self.normal(x)
        if self.contact["kt"]:
            return f
        free = self.inverse @ self.rest(t, x, v)
        c = self.contact["c"]
        return (c @ free - self.contact["moved"] * self.base_at(t)[2]) / (c @ self.inverse @ c)

    def rest(self, t, x, v):
        """Forces on the masses without friction."""
        u, rate, _ = self.base_at(t)
        found = self.push * self.load.at(self.k, t) - self.damping @ (v - rate) - self.stiffness @ (x - u)
        pressed = 0.0 if self.mode == OPEN else self.normal(x)
        found -= self.contact["d"] * (pressed - max(0.0, self.contact["N0"]))
        for s in range(len(self.springs)):
            found -= self.spring(s, x)
        return found

    def sliding(self, t, v):
        wall = self.contact["belt"] + self.contact["moved"] * self.base_at(t)[1]
        return self.contact["c"] @ v - wall

    def slip(self, sense, t, v):
        """What falls to 0 where a slide ends: its velocity, or that of the slider behind a spring."""
        own = self.contact
        if own["kt"]:
            return sense * own["kt"] * self.sliding(t, v) - own["phi"] * own["kn"] * own["d"] @ v
        return sense * self.sliding(t, v)

    def slope(self, t, y):
        x, v, f = y[: self.n], y[self.n : 2 * self.n], y[2 * self.n]
        force = self.force(t, x, v, f)
        acceleration = self.inverse @ (self.rest(t, x, v) - self.contact["c"] * force)
        kt, w = self.contact["kt"], self.sliding(t, v)
        if self.mode == HELD:
            rate = kt * w
        else:
            rate = (
                0.0
                if self.mode == OPEN
                else self.mode * self.contact["phi"] * self.contact["kn"] * (self.contact["d"] @ v)
            )
        slip = 0.0 if self.mode in (OPEN, HELD) else force * (w - (rate / kt if kt else 0.0))
        relative = v - self.base_at(t)[1]
        return np.concatenate((v, acceleration, [rate, relative @ self.damping @ relative, slip]))

    def watched(self):
        """Functions that fall to 0 at the events of the present phase, and what these are."""
        n, own = self.n, self.contact
        found = []
        if own["kn"]:
            sign = -1.0 if self.mode == OPEN else 1.0
            found.append((lambda t, y: sign * self.normal(y[:n]), ("normal",)))
        if self.mode == HELD:
            for side in (1, -1):
                found.append(
                    (
                        lambda t, y, side=side: (
                            own["mu"] * own["phi"] * self.normal(y[:n])
                            - side * self.force(t, y[:n], y[n : 2 * n], y[2 * n])
                        ),
                        ("release", side),
                    )
                )
        elif self.mode != OPEN:
            found.append((lambda t, y, sense=self.mode: self.slip(sense, t, y[n : 2 * n]), ("stop",)))
        for s, (direction, knots, _, _) in enumerate(self.springs):
            for step, knot in ((1, self.pieces[s]), (-1, self.pieces[s] - 1)):
                if 0 <= knot < len(knots):
                    found.append(
                        (
                            lambda t, y, step=step, at=knots[knot], direction=direction: (
                                step * (at - direction @ y[:n])
                            ),
                            ("knot", s, step),
                        )
                    )
        for function, _ in found:
            function.terminal, function.direction = True, -1
        return found

    def change(self, t, y, what):
        x, v, own = y[: self.n], y[self.n : 2 * self.n], self.contact
        if what[0] == "knot":
            self.pieces[what[1]] += what[2]
        elif what[0] == "normal" and self.mode != OPEN:
            self.mode, y[2 * self.n] = OPEN, 0.0
        elif what[0] == "normal":
            w = self.sliding(t, v)
            sticks = own["kt"] and own["kt"] * abs(w) <= own["phi"] * own["kn"] * own["d"] @ v
            self.mode = HELD if sticks else int(np.sign(w))
        elif what[0] == "release":
            self.mode = what[1]
        else:
            before, self.mode = self.mode, HELD
            if own["kt"]:
                y[2 * self.n] = before * own["phi"] * self.normal(x)
            elif abs(self.force(t, x, v, 0.0)) > own["mu"] * own["phi"] * self.normal(x):
                self.mode = -before
        return y

    def release_at_a_jump(self, t, y):
        """Let a rigid contact go that a load holds no longer which has jumped."""
        if self.mode != HELD or self.contact["kt"]:
            return
        force = self.force(t, y[: self.n], y[self.n : 2 * self.n], 0.0)
        if abs(force) > self.contact["mu"] * self.contact["phi"] * self.normal(y[: self.n]) * (1.0 + 1e-9):
            self.mode = int(np.sign(force))
            self.events.append((t, ("release", self.mode)))

    def relative(self, t, y):
        """Displacements and velocities relative to the base."""
        u, rate, _ = self.base_at(t)
        return np.concatenate((y[: self.n] - u, y[self.n : 2 * self.n] - rate))

    def follow(self):
        """States x, v at the samples, relative to the base, (samples, 2 n), works of damping and friction."""
        y = np.zeros(2 * self.n + 3)
        states = [self.relative(self.times[0], y)]
        for interval, (begin, end) in enumerate(zip(self.times[:-1], self.times[1:], strict=True)):
            self.k = interval
            t = begin
            self.release_at_a_jump(t, y)
            while t < end:
                functions, kinds = zip(*self.watched(), strict=True)
                found = solve_ivp(
                    self.slope, (t, end), y, "DOP853", events=functions, rtol=1e-13, atol=1e-15, max_step=0.1
                )
                t, y = found.t[-1], found.y[:, -1]
                if found.status == 1:
                    k = next(k for k, times in enumerate(found.t_events) if times.size)
                    self.events.append((t, kinds[k]))
                    y = self.change(t, y, kinds[k])
            states.append(self.relative(end, y))
        return np.array(states), y[-2], y[-1]

"""Motions of structures with one contact that opens and piecewise linear springs, integrated for tests.

The equations of every phase are integrated by DOP853 in physical coordinates, up to its events; nothing of
the package is used.
"""

import numpy as np
from scipy.integrate import solve_ivp

OPEN, HELD = 2, 0


class Truth:
    """A structure, a contact, springs (direction, knots, forces, slopes), and a load given by its samples."""

    def __init__(self, matrices, contact, springs, push, record):
        self.mass, self.damping, self.stiffness = (np.asarray(matrices[name], float) for name in "MCK")
        self.inverse, self.n = np.linalg.inv(self.mass), len(self.mass)
        self.contact, self.springs = contact, springs
        self.push, (self.times, self.values) = np.asarray(push, float), record
        self.mode = OPEN if contact["N0"] < 0.0 else HELD
        self.pieces = [int(np.searchsorted(knots, 0.0)) for _, knots, _, _ in springs]
        self.events = []

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
        return (c @ free) / (c @ self.inverse @ c)

    def rest(self, t, x, v):
        """Forces on the masses without friction."""
        found = self.push * np.interp(t, self.times, self.values) - self.damping @ v - self.stiffness @ x
        pressed = 0.0 if self.mode == OPEN else self.normal(x)
        found -= self.contact["d"] * (pressed - max(0.0, self.contact["N0"]))
        for s in range(len(self.springs)):
            found -= self.spring(s, x)
        return found

    def sliding(self, v):
        return self.contact["c"] @ v - self.contact["belt"]

    def slip(self, sense, v):
        """What falls to 0 where a slide ends: its velocity, or that of the slider behind a spring."""
        own = self.contact
        if own["kt"]:
            return sense * own["kt"] * self.sliding(v) - own["phi"] * own["kn"] * own["d"] @ v
        return sense * self.sliding(v)

    def slope(self, t, y):
        x, v, f = y[: self.n], y[self.n : 2 * self.n], y[2 * self.n]
        force = self.force(t, x, v, f)
        acceleration = self.inverse @ (self.rest(t, x, v) - self.contact["c"] * force)
        kt, w = self.contact["kt"], self.sliding(v)
        if self.mode == HELD:
            rate = kt * w
        else:
            rate = (
                0.0
                if self.mode == OPEN
                else self.mode * self.contact["phi"] * self.contact["kn"] * (self.contact["d"] @ v)
            )
        slip = 0.0 if self.mode in (OPEN, HELD) else force * (w - (rate / kt if kt else 0.0))
        return np.concatenate((v, acceleration, [rate, v @ self.damping @ v, slip]))

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
            found.append((lambda t, y, sense=self.mode: self.slip(sense, y[n : 2 * n]), ("stop",)))
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
            w = self.sliding(v)
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

    def follow(self):
        """States x, v at the samples, (samples, 2 n), works of damping and of friction."""
        y, states = np.zeros(2 * self.n + 3), []
        states.append(y[: 2 * self.n].copy())
        for begin, end in zip(self.times[:-1], self.times[1:], strict=True):
            t = begin
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
            states.append(y[: 2 * self.n].copy())
        return np.array(states), y[-2], y[-1]

"""One mass with friction under a record of straight lines, by matrix exponentials and sign tests.

It shares no code with the package: sub-steps so fine that no two events are in one, and brentq.
"""

from itertools import pairwise

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

#: Sub-steps of a sample, and time after the record.
FINE, AFTER = 60, 60.0


class Motion:
    """State (x, v, L, L', 1) of x'' + 2 zeta w x' + w^2 x + friction = L."""

    def __init__(self, w, zeta, beta, mu, base):
        self.w, self.zeta, self.beta, self.mu, self.base = w, zeta, beta, mu, base
        self.sense, self.state = 0, np.array([0.0, 0.0, 0.0, 0.0, 1.0])
        self.began, self.found = 0.0, dict.fromkeys(
            ("amplitude", "acceleration_amplitude", "sliding_distance", "stops", "turns"), 0.0
        )  # fmt: skip

    def matrix(self):
        a = np.zeros((5, 5))
        a[2, 3] = 1.0
        if self.sense:
            a[0, 1] = 1.0
            a[1] = [-(self.w**2), -2 * self.zeta * self.w, 1.0, 0.0, -self.sense * self.beta]
        return a

    def at(self, t):
        return expm(self.matrix() * t) @ self.state

    def pull(self, state):
        return state[2] - self.w**2 * state[0]

    def margin(self, state):
        """Falls below zero where the phase ends."""
        return self.mu * self.beta - abs(self.pull(state)) if self.sense == 0 else self.sense * state[1]

    def keep(self, state):
        inertia = self.matrix()[1] @ state
        absolute = abs(inertia - state[2]) if self.base else abs(inertia)
        self.found["acceleration_amplitude"] = max(self.found["acceleration_amplitude"], absolute)

    def keep_inside(self, t):
        """A peak inside the sub-step, where the slope of the acceleration changes its sign."""
        a = self.matrix()

        def rate(s):
            state = self.at(s)
            slope = a[1] @ (a @ state)
            return slope - state[3] if self.base else slope

        if rate(0.0) * rate(t) < 0.0:
            self.keep(self.at(brentq(rate, 0.0, t, xtol=1e-15)))

    def step(self, t):
        """Follow for t, with the events in it."""
        while t > 0.0:
            new = self.at(t)
            self.keep(self.state)
            if self.margin(new) >= 0.0:
                self.keep_inside(t)
                self.state = new
                self.keep(new)
                return
            low = 0.0
            if self.margin(self.state) <= 0.0:  # a slide that begins here
                low = t * 1e-6
            part = 0.0 if self.margin(self.at(low)) <= 0.0 else brentq(
                lambda s: self.margin(self.at(s)), low, t, xtol=1e-16, rtol=1e-15
            )  # fmt: skip
            self.keep_inside(part)
            self.state = self.at(part)
            self.keep(self.state)
            t -= part
            self.event()

    def event(self):
        side = int(np.sign(self.pull(self.state)))
        if self.sense:
            self.found["amplitude"] = max(self.found["amplitude"], abs(self.state[0]))
            self.found["sliding_distance"] += abs(self.state[0] - self.began)
            stays = abs(self.pull(self.state)) <= self.mu * self.beta
            self.found["stops" if stays else "turns"] += 1
            side = 0 if stays else side
        self.sense, self.began, self.state[1] = side, self.state[0], 0.0


def followed(values, dt, w, zeta, beta, mu, base):
    """Peaks and counts of a motion from rest under a record, and after it until it is at rest."""
    motion = Motion(w, zeta, beta, mu, base)
    loads = -values if base else values
    for first, last in pairwise(loads):
        for k in range(FINE):
            motion.state[2:4] = first + (last - first) * k / FINE, (last - first) / dt
            motion.step(dt / FINE)
    motion.state[2:4] = 0.0
    for _ in range(int(AFTER / dt)):
        if motion.sense == 0:
            break
        for _ in range(FINE):
            motion.step(dt / FINE)
    return motion.found

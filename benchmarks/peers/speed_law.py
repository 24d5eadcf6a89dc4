"""One mass under friction over speed with general-purpose solvers: from break point to break point.

In the segment k of a law, f = s beta (g_k - a_k V_k) + beta a_k r w: a constant and a damper.  A slide is
integrated segment by segment; it ends at w = 0, which only the first segment reaches.  The contact is with a
wall at rest, and static and kinetic friction just above speed 0 are equal.
"""

from collections.abc import Sequence
from importlib import import_module

import numpy as np

from .body import SLIDE_END
from .contacts import ContactBody
from .periodic_load import HarmonicsPeer

#: No bound.
_FAR = 1e9


class LawPeer(HarmonicsPeer):
    """Solver for one mass; a subclass integrates one segment of one slide."""

    def __init__(
        self, body: ContactBody, speed: Sequence[float], factor: Sequence[float], slope: float
    ) -> None:
        super().__init__(body)
        self.speed, self.factor = np.array(speed), np.array(factor)
        self.slopes = np.append(np.diff(self.factor) / np.diff(self.speed), slope)

    def prepare(self, r: float, beta: float) -> None:
        """Take the numbers of one cell, divided by the inertia: constants, dampers and bounds of segments."""
        self.r = r
        self.constants = beta * (self.factor - self.slopes * self.speed) / r**2
        self.dampers = 2.0 * self.body.zeta / r + beta * self.slopes / r
        self.bounds = np.append(self.speed, r * _FAR) / r  # of the velocity z'

    def slide(self, theta: float, z: float, v: float, sign: int, end: float) -> tuple[float, float, float]:
        """Integrate one slide."""
        k = max(int(np.searchsorted(self.bounds, abs(v), side="right")) - 1, 0)
        z, v = sign * z, sign * v
        while True:
            theta, z, v, event = self.segment(theta, z, v, sign, k, end)
            if event == 0:
                return theta, sign * z, sign * v
            if event < 0 and k == 0:
                return theta, sign * z, 0.0
            k += event

    def segment(
        self, theta: float, z: float, v: float, sign: int, k: int, end: float
    ) -> tuple[float, float, float, int]:
        """Integrate sign times the motion in segment k: to its upper (1), lower bound (-1), or `end` (0)."""
        raise NotImplementedError

    def limits(self, k: int) -> tuple[float, float]:
        """Velocities just outside a segment."""
        return self.bounds[k] + SLIDE_END, self.bounds[k + 1] - SLIDE_END


class LawSolveIvp(LawPeer):
    """scipy.integrate.solve_ivp with terminal events."""

    name = "solve_ivp DOP853"
    package = "scipy"

    def __init__(self, body, speed, factor, slope, rtol=1e-9, atol=1e-12):
        super().__init__(body, speed, factor, slope)
        self.settings = {"method": "DOP853", "rtol": rtol, "atol": atol}
        self.solve = import_module("scipy.integrate").solve_ivp

    def segment(self, theta, z, v, sign, k, end):
        """Integrate one segment."""
        load, square = self.load, 1.0 / self.r**2
        damper, constant, (low, high) = self.dampers[k], self.constants[k], self.limits(k)

        def rate(theta, y):
            z, v = y.tolist()
            return v, square * (sign * load(theta) - z) - damper * v - constant

        def below(_theta, y):
            return y[1] - low

        def above(_theta, y):
            return y[1] - high

        below.terminal = above.terminal = True
        below.direction, above.direction = -1, 1
        answer = self.solve(rate, (theta, end), (z, v), events=[below, above], **self.settings)
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        event = 0 if answer.status == 0 else -1 if answer.t_events[0].size else 1
        return answer.t[-1].item(), answer.y[0, -1].item(), answer.y[1, -1].item(), event


class LawHeyoka(LawPeer):
    """heyoka's Taylor integrator with terminal events: one program, the segment in its parameters."""

    name = "heyoka"
    package = "heyoka"

    def __init__(self, body, speed, factor, slope, **options):
        super().__init__(body, speed, factor, slope)
        heyoka = import_module("heyoka")
        z, v = heyoka.make_vars("z", "v")
        square, damper, constant, drive, low, high = (heyoka.par[i] for i in range(6))
        terms = [heyoka.cos(float(n) * heyoka.time + np.angle(p)) * abs(p) for n, p in body.load.items()]
        push = drive * heyoka.sum(terms) - damper * v - square * z - constant
        down, up = heyoka.event_direction.negative, heyoka.event_direction.positive
        events = [
            heyoka.t_event(v - low, direction=down, cooldown=0.0),
            heyoka.t_event(v - high, direction=up, cooldown=0.0),
        ]
        self.integrator = heyoka.taylor_adaptive(
            sys=[(z, v), (v, push)], state=[0.0, 0.0], t_events=events, fast_math=True, **options
        )
        self.time_limit = heyoka.taylor_outcome.time_limit

    def segment(self, theta, z, v, sign, k, end):
        """Integrate one segment."""
        integrator, square = self.integrator, 1.0 / self.r**2
        integrator.state[:] = z, v
        low, high = self.limits(k)
        integrator.pars[:] = square, self.dampers[k], self.constants[k], sign * square, low, high
        integrator.time = theta
        outcome = integrator.propagate_until(end)[0]
        z, v = integrator.state.tolist()
        if outcome == self.time_limit:
            return integrator.time, z, v, 0
        return integrator.time, z, v, (-1 if abs(v - low) < abs(v - high) else 1)

"""CVODE of SUNDIALS, by scikit-sundae, as a peer: Adams' method with root finding, restarted at every event.

The right-hand side and the events are Python functions, as this interface has them; nonlinear equations are
solved by the default dense Newton iteration.  Events are offset as in `heyoka`: the velocity along a slide
has ended at -1e-13.  A solver object keeps every event it has met, so each cell has new ones; each slide
starts them anew with `init_step`.
"""

import math
from importlib import import_module

import numpy as np

from .body import SLIDE_END, Body
from .chain import ChainPeer
from .one_mass import OneMassPeer
from .peer import Peer

#: Steps inside one phase, at most: far above what any phase takes.
MOST_STEPS = 1_000_000

#: Status of an answer that ended at an event.
EVENT = 2


def peer(body: Body, **settings) -> Peer:
    """Solver for a body."""
    return (OneMassCvode if body.masses == 1 else ChainCvode)(body, **settings)


def _cvode(rhs, events, count, directions, rtol, atol):
    """Solver with terminal events."""
    events.terminal = [True] * count
    events.direction = directions
    return import_module("sksundae.cvode").CVODE(
        rhs, method="Adams", rtol=rtol, atol=atol, eventsfn=events, num_events=count, max_num_steps=MOST_STEPS
    )


def _to_event(solver, theta, state, end):
    """Integrate to an event or to `end`: (phase, state, index of the event or None)."""
    solver.init_step(theta, state)
    answer = solver.step(end, tstop=end)
    if not answer.success:
        raise RuntimeError(f"CVODE: {answer.message}")
    # the events are those of every integration since the solver was made; the last one is this one's
    event = int(np.flatnonzero(answer.i_events[-1])[0]) if answer.status == EVENT else None
    return float(answer.t), answer.y, event


class OneMassCvode(OneMassPeer):
    """CVODE for one mass."""

    name = "CVODE"
    package = "sksundae"
    distribution = "scikit-sundae"

    def __init__(self, body: Body, rtol=1e-6, atol=1e-12):
        super().__init__(body)
        self.tolerances = rtol, atol

    def solver(self, sign, rtol, atol):
        """The solver of slides of this sign."""
        cos = math.cos

        def rhs(theta, y, rate):
            z, v = y.tolist()
            rate[0] = v
            rate[1] = self.drive * cos(theta) - self.damping * v - self.stiffness * z - sign * self.friction

        def events(_theta, y, values):
            values[0] = sign * y[1] - SLIDE_END

        return _cvode(rhs, events, 1, [-1], rtol, atol)

    def prepare(self, amplitude, r, beta):
        """Take the numbers of one cell, divided by the inertia."""
        self.drive = amplitude / r**2
        self.stiffness = 1 / r**2
        self.damping = 2 * self.body.zeta / r
        self.friction = beta / r**2
        self.solvers = {sign: self.solver(sign, *self.tolerances) for sign in (1, -1)}

    def slide(self, theta, z, v, sign, end):
        """Integrate one slide."""
        theta, state, event = _to_event(self.solvers[sign], theta, np.array([z, v]), end)
        z, v = state.tolist()
        return theta, z, (v if event is None else 0.0)


class ChainCvode(ChainPeer):
    """CVODE for a chain of masses."""

    name = "CVODE"
    package = "sksundae"
    distribution = "scikit-sundae"

    def __init__(self, body: Body, rtol=1e-6, atol=1e-12):
        super().__init__(body)
        self.tolerances = rtol, atol

    def rates(self, y, theta, rate):
        """All rates without friction."""
        n = self.n
        rate[:n] = y[n:]
        rate[n:] = -(self.stiffness @ y[:n] + self.r * (self.damping @ y[n:])) * self.square
        rate[n + self.load] += self.square * math.cos(theta)

    def slider(self, sign, rtol, atol):
        """The solver of slides of this sign."""

        def rhs(theta, y, rate):
            self.rates(y, theta, rate)
            rate[self.rate] -= sign * self.square * self.beta

        def events(_theta, y, values):
            values[0] = sign * y[self.rate] - SLIDE_END

        return _cvode(rhs, events, 1, [-1], rtol, atol)

    def make_sticker(self, rtol, atol):
        """The solver of stops."""

        def rhs(theta, y, rate):
            self.rates(y, theta, rate)
            rate[self.rate] = 0.0

        def events(theta, y, values):
            force = self.row @ y + self.contact_drive * math.cos(theta)
            values[0] = force - self.limit
            values[1] = -force - self.limit

        return _cvode(rhs, events, 2, [1, 1], rtol, atol)

    def prepare(self, r, beta, mu):
        """Take the numbers of one cell, and start from rest."""
        super().prepare(r, beta, mu)
        self.r, self.square, self.beta, self.limit = r, 1.0 / r**2, beta, mu * beta
        self.sliders = {sign: self.slider(sign, *self.tolerances) for sign in (1, -1)}
        self.sticker = self.make_sticker(*self.tolerances)

    def slide(self, theta, sign, end):
        """Integrate one slide."""
        theta, self.state, event = _to_event(self.sliders[sign], theta, self.state, end)
        if event is not None:
            self.state[self.rate] = 0.0
        return theta, event is not None

    def stop(self, theta, end):
        """Integrate one stop."""
        theta, self.state, event = _to_event(self.sticker, theta, self.state, end)
        return theta, (0 if event is None else (1, -1)[event])

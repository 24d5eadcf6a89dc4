"""Chains of masses with a general-purpose solver: the common part of all such solvers.

The end of a stop has no closed form here, because the other masses continue to move. The linear equations
with the mass in contact held are also integrated, up to the event |f| = mu beta. The solvers are given the
number of periods to march and the steady period. The velocity in the contact is made exactly zero where a
slide ends; `heyoka.OneMassHeyoka` explains the offset of that event, -1e-13.
"""

import math
from typing import NamedTuple

import numpy as np

from .body import SHORTEST_STOP, TWO_PI, Body, Cell, Outcome, matrices
from .peer import MAX_PHASES, Peer


class _Phase(NamedTuple):
    """State of a chain: phase of the load, sign of the slide or 0, and start of the last stop.

    Stops that began before the periods that count are not counted.
    """

    theta: float
    sign: int
    began: float


class ChainPeer(Peer):
    """Solver for chains. A subclass integrates one slide and one stop.

    `slide(theta, sign, end)` and `stop(theta, end)` change `self.state`. They return the phase of the load
    and True, or the sign of the next slide, if the segment ended; False, or 0, if `end` came first.
    """

    def __init__(self, body: Body) -> None:
        super().__init__(body)
        self.n, self.contact, self.load = body.masses, body.contact - 1, body.load - 1
        self.rate = self.n + self.contact  # place of z' in the state
        self.stiffness, self.damping = matrices(body)
        self.contact_drive = float(self.contact == self.load)

    def run(
        self, cell: Cell, cycles: int, periods: int = 1, begins: list[float] | None = None
    ) -> Outcome:  # fmt: skip
        """Integrate one cell from rest, as described in `Peer`."""
        self.prepare(*cell)
        push, limit = self.force(0.0), cell.mu * cell.beta
        state = _Phase(0.0, 0 if abs(push) <= limit else 1 if push > 0.0 else -1, 0.0)
        counted, peak = [], 0.0
        last = TWO_PI * (cycles - periods)
        for first, end in ((0.0, last), (last, TWO_PI * cycles)):
            state, counted, peak = self.march(state, limit, first, end)
        if begins is not None:
            begins[:] = counted
        return Outcome(len(counted) / periods, peak)

    def march(
        self, state: "_Phase", limit: float, first: float, end: float
    ) -> tuple["_Phase", list[float], float]:  # fmt: skip
        """March by segments up to `end`; state, starts of the stops since `first`, and max |z|."""
        theta, sign, began = state
        counted, peak = [], abs(self.place())
        for _ in range(MAX_PHASES):
            if theta >= end:
                break
            if sign:
                theta, ended = self.slide(theta, sign, end)
                peak = max(peak, abs(self.place()))
                if ended:
                    push = self.force(theta)
                    if abs(push) > limit:
                        sign = 1 if push > 0.0 else -1
                    else:
                        sign, began = 0, theta
            else:
                theta, sign = self.stop(theta, end)
                if sign and began >= first and theta - began > SHORTEST_STOP:
                    counted.append(began)
        else:
            raise RuntimeError(f"{MAX_PHASES} phases without reaching the end of the run")
        if not sign and began >= first:
            counted.append(began)
        return _Phase(theta, sign, began), counted, peak

    def prepare(self, r, beta, mu):
        """Take the numbers of one cell, and start from rest."""
        self.state = np.zeros(2 * self.n)
        self.row = -np.concatenate((self.stiffness[self.contact], r * self.damping[self.contact]))

    def place(self):
        """Return z."""
        return self.state[self.contact].item()

    def force(self, theta):
        """Return the force f that keeps z' = 0."""
        return float(self.row @ self.state) + self.contact_drive * math.cos(theta)

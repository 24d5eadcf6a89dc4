"""One mass under a load of several harmonics with a general-purpose solver: the common part of all such.

As in `one_mass`, only slides are integrated.  A stop ends where the load first leaves the band that friction
can balance.  With several harmonics this phase has no closed form.  It is bracketed on samples of the load,
which are made once for a body, and refined by Brent's method.
"""

from importlib import import_module
from typing import NamedTuple

import numpy as np

from .body import SHORTEST_STOP, TWO_PI
from .contacts import (
    ContactBody,
    ContactCell,
    ContactOutcome,
    ContactPeer,
    load_function,
    load_samples,
)
from .peer import MAX_PHASES

#: Samples of the load per period of its highest harmonic.
_SAMPLES = 64

_STUCK = ContactOutcome((0.0,), (0.0,))


class _State(NamedTuple):
    """Start of a slide: phase of the load, motion, and sign of z'; sign 0: the contact sticks permanently."""

    theta: float
    z: float
    v: float
    sign: int


class HarmonicsPeer(ContactPeer):
    """Solver for one mass under several harmonics.  A subclass integrates one slide.

    `slide(theta, z, v, sign, end)` returns theta, z, v: at the end of the slide with v = 0, or at phase `end`
    with v as it is there.
    """

    def __init__(self, body: ContactBody) -> None:
        super().__init__(body)
        self.load = load_function(body.load)
        count = _SAMPLES * max(body.load)
        self.step = TWO_PI / count
        self.samples = load_samples(body.load, self.step * np.arange(count))
        self.root = import_module("scipy.optimize").brentq

    def run(self, cell: ContactCell, cycles: int) -> ContactOutcome:
        """Integrate one cell from rest."""
        (limit,) = cell.beta
        self.prepare(cell.r, limit)
        theta, sign, _ = self._restart(0.0, 0.0, limit)
        state = _State(theta, 0.0, 0.0, sign)
        stops, low, high = 0, 0.0, 0.0
        for end in (TWO_PI * (cycles - 1), TWO_PI * cycles):
            state, stops, low, high = self._march(state, limit, end)
        return ContactOutcome((float(stops),), (high - low,)) if state.sign else _STUCK

    def _march(self, state: _State, limit: float, end: float) -> tuple[_State, int, float, float]:
        """Go from slide to slide up to phase `end`: state, stops that began, least and largest z."""
        theta, z, v, sign = state
        stops, low, high = 0, z, z
        for _ in range(MAX_PHASES):
            if theta >= end or not sign:
                break
            theta, z, v = self.slide(theta, z, v, sign, end)
            low, high = min(low, z), max(high, z)
            if v:
                break
            theta, sign, wait = self._restart(theta, z, limit)
            stops += wait > SHORTEST_STOP
        else:
            raise RuntimeError(f"{MAX_PHASES} slides without reaching the end of the run")
        return _State(theta, z, v, sign), stops, low, high

    def _restart(self, theta: float, z: float, limit: float) -> tuple[float, int, float]:
        """Phase and sign of the slide that follows z' = 0, and the length of the stop between."""
        push = self.load(theta) - z
        if abs(push) > limit:
            return theta, (1 if push > 0.0 else -1), 0.0
        beyond = np.abs(self.samples - z) > limit
        if not beyond.any():
            return theta, 0, 0.0
        start = theta - theta % TWO_PI
        first = int((theta - start) / self.step) + 1
        k = first + int(np.argmax(np.roll(beyond, -first)))
        high = start + k * self.step
        low = max(theta, high - self.step)
        release = self.root(lambda tau: abs(self.load(tau) - z) - limit, low, high, xtol=1e-15)
        return release, (1 if self.load(high) > z else -1), release - theta

    def prepare(self, r: float, beta: float) -> None:
        """Take the numbers of one cell."""
        raise NotImplementedError

    def slide(self, theta: float, z: float, v: float, sign: int, end: float) -> tuple[float, float, float]:
        """Integrate one slide."""
        raise NotImplementedError

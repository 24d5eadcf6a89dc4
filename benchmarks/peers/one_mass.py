"""One mass with a general-purpose solver: the common part of all such solvers.

They only integrate the slides. Everything else has a closed form, which favours them: the sticking test at z'
= 0, the release time of a stop (an arccos), and the immediate return from a contact that can never slip
again.
"""

import math
from typing import NamedTuple

from .body import STUCK, TWO_PI, Cell, Outcome, load_in_contact
from .peer import MAX_PHASES, Peer

LATE = TWO_PI - 1e-9  # a wait longer than this is a release that rounding put in the past


class State(NamedTuple):
    """Start of a slide: phase of the load in the contact, motion, and sign of z'."""

    theta: float
    z: float
    v: float
    sign: int


def release(amplitude, limit, theta, z):
    """Return the wait until a stop at z ends and the sign of the slide after it; sign 0: never."""
    wait, sign = math.inf, 0
    if z + limit < amplitude:
        wait = (-math.acos(max((z + limit) / amplitude, -1.0)) - theta) % TWO_PI
        wait, sign = (0.0 if wait > LATE else wait), 1
    if z - limit > -amplitude:
        back = (math.acos(min((z - limit) / amplitude, 1.0)) - theta) % TWO_PI
        back = 0.0 if back > LATE else back
        if back < wait:
            wait, sign = back, -1
    return wait, sign


def restart(amplitude, limit, theta, z):
    """Return phase and sign of the slide that follows z' = 0, and the length of the stop between.

    The contact sticks while the load less the spring's force is within the static limit.
    """
    push = amplitude * math.cos(theta) - z
    if abs(push) > limit:
        return theta, (1 if push > 0 else -1), 0.0
    wait, sign = release(amplitude, limit, theta, z)
    return theta + wait, sign, wait


def march(slide, amplitude, limit, state, end, begins=None):
    """Go from slide to slide up to phase `end`; return state, stops that began, and max |z|.

    The phases at which they began are added to the list `begins`, if there is one.

    `slide(theta, z, v, sign, end)` integrates one slide and returns theta, z, v: at its end with
    v = 0, or at phase `end` with v as it is there. A sign of 0 in the state: stuck permanently.
    """
    theta, z, v, sign = state
    stops, peak = 0, abs(z)
    for _ in range(MAX_PHASES):
        if theta >= end:
            break
        theta, z, v = slide(theta, z, v, sign, end)
        peak = max(peak, abs(z))
        if v:
            break
        began = theta
        theta, sign, wait = restart(amplitude, limit, theta, z)
        stops += wait > 0
        if begins is not None and wait > 0:
            begins.append(began)
        if not sign:
            break
    else:
        raise RuntimeError(f"{MAX_PHASES} slides without reaching the end of the run")
    return State(theta, z, v, sign), stops, peak


def from_rest(slide, amplitude, phase, limit, cycles, periods, begins=None):
    """March `cycles` excitation periods from z = z' = 0 at tau = 0; the outcome of the last `periods`.

    `begins` is filled with the phases of the load at which their stops began.
    """
    theta, sign, _ = restart(amplitude, limit, phase, 0.0)
    state = State(theta, 0.0, 0.0, sign)
    stops, peak = 0, 0.0
    for end in (phase + TWO_PI * (cycles - periods), phase + TWO_PI * cycles):
        if not state.sign:
            return STUCK
        if begins is not None:
            begins.clear()
        state, stops, peak = march(slide, amplitude, limit, state, end, begins)
    return Outcome(stops / periods, peak) if state.sign else STUCK


class OneMassPeer(Peer):
    """Solver for one mass. A subclass integrates one slide."""

    def run(
        self, cell: Cell, cycles: int, periods: int = 1, begins: list[float] | None = None
    ) -> Outcome:  # fmt: skip
        """Integrate one cell from rest, as described in `Peer`."""
        amplitude, phase = load_in_contact(self.body.wall, cell.r, self.body.zeta)
        limit = cell.mu * cell.beta
        if amplitude <= limit:
            return STUCK
        self.prepare(amplitude, cell.r, cell.beta)
        found = from_rest(self.slide, amplitude, phase, limit, cycles, periods, begins)
        if begins is not None:
            begins[:] = [theta - phase for theta in begins]
        return found

    def prepare(self, amplitude: float, r: float, beta: float) -> None:
        """Take the numbers of one cell."""
        raise NotImplementedError

    def slide(self, theta: float, z: float, v: float, sign: int, end: float) -> tuple[float, float, float]:
        """Integrate one slide, as described in `march`."""
        raise NotImplementedError

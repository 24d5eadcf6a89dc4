"""Periodic motions with a given sequence of slides and stops, and what borders a region of them.

An orbit returns to its state, or to its mirror image, after `half_periods` of the load.  It begins in the
middle of its longest piece, at `start`; between the events its pieces have senses (+1, -1: slides, 0: a
stop).  Events are forced to be where they are said to be, so all equations go on beyond a border.
"""

from typing import NamedTuple

import numpy as np

from .phases import Affine, Drive, Phases

GRAZE, SLIP, TURN, SLIDE_END = "graze", "slip-in-stop", "turn/stop", "graze-of-slide-end"


class Sequence(NamedTuple):
    """Senses of the pieces, the first of which goes on as the last, mirrored if `mirrored`."""

    senses: tuple[int, ...]
    start: float
    half_periods: int
    mirrored: bool
    mu: float

    @property
    def events(self) -> int:
        """Number of events: ends of pieces."""
        return len(self.senses) - 1

    @property
    def end(self) -> float:
        """Phase at which the orbit has returned."""
        return self.start + np.pi * self.half_periods

    @property
    def stops_per_cycle(self) -> float:
        """Stops that begin per excitation period."""
        stops = sum(sense == 0 for sense in self.senses[1:])
        return 2.0 * stops / self.half_periods


class Condition(NamedTuple):
    """A kind of border, the piece that it concerns, and the sign of the force there."""

    kind: str
    piece: int
    sign: int = 0

    @property
    def inside(self) -> bool:
        """Whether the border is an event inside a piece, whose phase is a further unknown."""
        return self.kind in (GRAZE, SLIP)


class Motion(NamedTuple):
    """States (B, 2m) at the beginning of every piece, and the phases there and at the end (B,)."""

    drive: Drive
    beta: np.ndarray
    times: list[np.ndarray]  # beginnings of the pieces, and the end
    states: list[np.ndarray]


def _piece(
    phases: Phases, sense: int, drive: Drive, beta: np.ndarray, begin: np.ndarray, end: np.ndarray
) -> Affine:
    if sense == 0:
        return phases.stop(drive, begin, end)
    return phases.slide(drive, begin, end, sense * beta)


def motion_of(
    phases: Phases, sequence: Sequence, times: np.ndarray, r: np.ndarray, beta: np.ndarray
) -> Motion:
    """The motion that returns, for event times (B, k), r and beta (B,)."""
    drive, cases = phases.drive(r), r.size
    ends = [*times.T, np.full(cases, sequence.end)]
    begins = [np.full(cases, sequence.start), *times.T]
    size = 2 * phases.m
    whole = None
    maps = []
    for sense, begin, end in zip(sequence.senses, begins, ends, strict=True):
        one = _piece(phases, sense, drive, beta, begin, end)
        whole = one if whole is None else one.after(whole)
        maps.append(one)
    assert whole is not None
    sign = -1.0 if sequence.mirrored else 1.0
    state = np.linalg.solve(sign * np.eye(size) - whole.matrix, whole.shift[..., np.newaxis])[..., 0]
    states = [state]
    for one in maps:
        states.append(one(states[-1]))
    return Motion(drive, beta, [*begins, ends[-1]], states)


def inside(phases: Phases, sequence: Sequence, motion: Motion, piece: int, tau: np.ndarray) -> np.ndarray:
    """State at phases tau (B,) inside a piece."""
    sense = sequence.senses[piece]
    one = _piece(phases, sense, motion.drive, motion.beta, motion.times[piece], tau)
    return one(motion.states[piece])


def residuals(
    phases: Phases, sequence: Sequence, condition: Condition | None, unknowns: np.ndarray
) -> np.ndarray:
    """What an orbit on a border leaves of its equations, (B, k [+ 1 or 2]).

    unknowns : (B, k [+ 1] + 2): times of the events, of the condition, r, beta
    """
    count = sequence.events
    r, beta = unknowns[:, -2], unknowns[:, -1]
    motion = motion_of(phases, sequence, unknowns[:, :count], r, beta)
    found = []
    for k in range(count):
        state, tau = motion.states[k + 1], motion.times[k + 1]
        if sequence.senses[k] == 0:
            limit = sequence.senses[k + 1] * sequence.mu * beta
            found.append(phases.force(motion.drive, state, tau) - limit)
        else:
            found.append(phases.velocity(state))
    if condition is not None:
        found += _border(phases, sequence, condition, motion, unknowns[:, count])
    return np.stack(found, axis=1)


def _border(
    phases: Phases, sequence: Sequence, condition: Condition, motion: Motion, tau: np.ndarray
) -> list[np.ndarray]:
    """Equations of a condition; `tau` is its phase, where it has one."""
    drive, beta, piece = motion.drive, motion.beta, condition.piece
    sense = sequence.senses[piece]
    if condition.kind == GRAZE:
        state = inside(phases, sequence, motion, piece, tau)
        return [phases.velocity(state), phases.acceleration(drive, state, tau, sense * beta)]
    if condition.kind == SLIP:
        state = inside(phases, sequence, motion, piece, tau)
        limit = condition.sign * sequence.mu * beta
        return [phases.force(drive, state, tau) - limit, phases.force_rate(drive, state, tau)]
    state, end = motion.states[piece + 1], motion.times[piece + 1]
    limit = -sense * sequence.mu * beta if condition.kind == TURN else sense * beta
    return [phases.force(drive, state, end) - limit]

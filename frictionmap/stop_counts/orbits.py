"""Periodic motions with a given sequence of slides and stops.

An orbit returns to its state, or to its mirror image, after `half_periods` of the load.  It begins in the
middle of its longest piece, at `start`; between the events its pieces have senses (+1, -1: slides, 0: a
stop).  Events are imposed at the given phases, so all equations continue beyond a border.
"""

from typing import NamedTuple

import numpy as np

from .phases import Affine, Drive, Phases


class Sequence(NamedTuple):
    """Senses of the pieces, the first of which continues the last, mirrored if `mirrored`."""

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
    def sign(self) -> float:
        """The factor by which the orbit returns to its state."""
        return -1.0 if self.mirrored else 1.0

    @property
    def stops_per_cycle(self) -> float:
        """Stops that begin per excitation period."""
        stops = sum(sense == 0 for sense in self.senses[1:])
        return 2.0 * stops / self.half_periods


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


class Pieces(NamedTuple):
    """All pieces of an orbit as maps of the state, and the phases of their beginnings and of the end."""

    drive: Drive
    beta: np.ndarray
    times: list[np.ndarray]
    maps: list[Affine]

    def states(self, first: np.ndarray) -> list[np.ndarray]:
        """States at these phases, from the first (B, 2m)."""
        found = [first]
        for one in self.maps:
            found.append(one(found[-1]))
        return found


def pieces_of(
    phases: Phases, sequence: Sequence, times: np.ndarray, r: np.ndarray, beta: np.ndarray
) -> Pieces:
    """The pieces between event times (B, k), for r and beta (B,)."""
    drive = phases.drive(r)
    edges = [np.full(r.size, sequence.start), *times.T, np.full(r.size, sequence.end)]
    maps = [
        _piece(phases, sense, drive, beta, begin, end)
        for sense, begin, end in zip(sequence.senses, edges[:-1], edges[1:], strict=True)
    ]
    return Pieces(drive, beta, edges, maps)


def motion_of(
    phases: Phases, sequence: Sequence, times: np.ndarray, r: np.ndarray, beta: np.ndarray
) -> Motion:
    """The motion that returns, for event times (B, k), r and beta (B,)."""
    pieces = pieces_of(phases, sequence, times, r, beta)
    whole = pieces.maps[0]
    for one in pieces.maps[1:]:
        whole = one.after(whole)
    back = sequence.sign * np.eye(2 * phases.m)
    first = np.linalg.solve(back - whole.matrix, whole.shift[..., np.newaxis])[..., 0]
    return Motion(pieces.drive, beta, pieces.times, pieces.states(first))


def inside(phases: Phases, sequence: Sequence, motion: Motion, piece: int, tau: np.ndarray) -> np.ndarray:
    """State at phases tau (B,) inside a piece."""
    sense = sequence.senses[piece]
    one = _piece(phases, sense, motion.drive, motion.beta, motion.times[piece], tau)
    return one(motion.states[piece])


def events(phases: Phases, sequence: Sequence, motion: Motion) -> list[np.ndarray]:
    """Residuals of the equations of the events of a motion: z' at ends of slides, forces at ends of stops."""
    found = []
    for k in range(sequence.events):
        state, tau = motion.states[k + 1], motion.times[k + 1]
        if sequence.senses[k] == 0:
            limit = sequence.senses[k + 1] * sequence.mu * motion.beta
            found.append(phases.force(motion.drive, state, tau) - limit)
        else:
            found.append(phases.velocity(state))
    return found

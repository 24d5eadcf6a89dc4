"""Equations of borders: an orbit, and one condition more.

Where two orbits of a sequence meet and end (a fold), or where one loses its symmetry or doubles its period,
the derivative of all its equations by its first state and its event times is singular, with the factor of
the return as it is or reversed.  Both need mu > 1, as does a graze of a slide's end.
"""

from typing import NamedTuple

import numpy as np

from .orbits import Motion, Sequence, events, inside, motion_of, pieces_of
from .phases import Phases

GRAZE, SLIP, TURN, SLIDE_END = "graze", "slip-in-stop", "turn/stop", "graze-of-slide-end"
FOLD, DOUBLING = "fold", "doubling"

#: Step of the differences that give a determinant, and their weights: of fourth order, exact to about 1e-12.
_STEP = 5e-4
_AT = np.array([-2.0, -1.0, 1.0, 2.0])
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0


class Condition(NamedTuple):
    """A kind of border, the piece that it concerns, and the sign of the force there."""

    kind: str
    piece: int
    sign: int = 0

    @property
    def inside(self) -> bool:
        """Whether the border is an event inside a piece, whose phase is a further unknown."""
        return self.kind in (GRAZE, SLIP)

    @property
    def singular(self) -> bool:
        """Whether the border is a singularity of the orbit's equations."""
        return self.kind in (FOLD, DOUBLING)


def residuals(
    phases: Phases, sequence: Sequence, condition: Condition | None, unknowns: np.ndarray
) -> np.ndarray:
    """Residuals of the equations of an orbit on a border, (B, k [+ 1 or 2]).

    unknowns : (B, k [+ 1] + 2): times of the events, of the condition, r, beta
    """
    count = sequence.events
    r, beta = unknowns[:, -2], unknowns[:, -1]
    motion = motion_of(phases, sequence, unknowns[:, :count], r, beta)
    found = events(phases, sequence, motion)
    if condition is not None and condition.singular:
        found.append(_determinant(phases, sequence, motion, condition.kind == DOUBLING))
    elif condition is not None:
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


def _determinant(phases: Phases, sequence: Sequence, motion: Motion, reversed_: bool) -> np.ndarray:
    """Determinant (B,) of the derivative of return and events by the first state and the event times."""
    size, cases = 2 * phases.m, motion.beta.size
    place = np.column_stack((motion.states[0], *motion.times[1:-1]))
    count = place.shape[1]
    shifts = (_AT[:, np.newaxis, np.newaxis] * _STEP * np.eye(count)).reshape(-1, 1, count)
    shifted = (place + shifts).reshape(-1, count)  # (4, count, B) cases
    repeats = 4 * count
    r, beta = np.tile(motion.drive.r, repeats), np.tile(motion.beta, repeats)
    pieces = pieces_of(phases, sequence, shifted[:, size:], r, beta)
    states = pieces.states(shifted[:, :size])
    forced = Motion(pieces.drive, beta, pieces.times, states)
    values = np.column_stack(
        (states[-1] - sequence.sign * shifted[:, :size], *events(phases, sequence, forced))
    )
    slopes = np.tensordot(_WEIGHTS, values.reshape(4, count, cases, count), axes=1) / _STEP
    jacobian = slopes.transpose(1, 2, 0)  # (B, equation, unknown)
    if reversed_:
        jacobian[:, :size, :size] += 2.0 * sequence.sign * np.eye(size)
    return np.linalg.det(jacobian)

"""The motion of a mass under a measured drive, what its sensor shows, and the derivatives of that."""

from typing import NamedTuple

import numpy as np

from ..._kernels.history.course import RESOLVED
from ..._kernels.history.tangents import (
    ACC,
    COLUMNS,
    PHASE,
    STATE,
    TERMS,
    VALUES,
    Intervals,
    Motion,
    Q,
    U,
    V,
    carried,
    motion_and_tangents,
)
from .drive import BLOCK, Drive, Pieces, coefficients, derivative_at, pieces, shifted

NAMES = (
    "f_n", "zeta", "x_F", "mu", "contact_stiffness", "stiffness", "offset_x", "delay", "gain",
    "place", "speed", "spring",
)  # fmt: skip
F_N, ZETA, X_F, MU, SPRING, STIFFNESS, OFFSET, DELAY, GAIN, PLACE, SPEED, STATE_OF_SPRING = range(12)

#: Parameters with names for users; the others are the state at the beginning.
NAMED = PLACE

_TURN = 2.0 * np.pi

#: Room for events: per piece, and besides.
_ROOM = 4, 100


class Measured(NamedTuple):
    """A record, checked: the drive and what a sensor of the mass shows."""

    drive: Drive
    time: np.ndarray  # (n,) of the samples of the mass
    x: np.ndarray  # (n,) in mm, mm/s or mm/s^2
    order: int  # of the derivative of the displacement that x is
    elastic: bool


class Course(NamedTuple):
    """A motion, and what it shows."""

    x: np.ndarray  # (n,)
    slopes: np.ndarray  # (n, NAMES)
    motion: Motion
    of: Pieces
    values: np.ndarray
    found: np.ndarray  # coefficients of the drive in pieces, over the stiffness
    resolved: bool

    @property
    def event_times(self) -> np.ndarray:
        """Times of events, by the clock of the drive, from the first sample."""
        events = self.motion.events[: min(int(self.motion.counts[0]), self.motion.events.shape[0])]
        ends = np.concatenate(([0.0], np.cumsum(self.of.lengths)))
        k = events[:, 0].astype(int)
        return ends[k] + events[:, 1] * self.of.lengths[k]

    @property
    def stuck(self) -> float:
        """Share of the ends of pieces at which the contact does not slip."""
        return float(np.mean(self.motion.state[:, PHASE] == 0.0))


class Model:
    """The motion of a record by its parameters; what does not depend on them is made once."""

    def __init__(self, given: Measured) -> None:
        self.given = given
        self.cubics = coefficients(given.drive.time, given.drive.values)
        self.undelayed = pieces(given.drive.time, given.drive.time)

    def _pieces(self, delay: float) -> Pieces:
        """Pieces of a drive that is read `delay` earlier than the mass was sampled."""
        if delay == 0.0 and self.given.time.size == self.given.drive.time.size:
            return self.undelayed
        return pieces(self.given.drive.time, self.given.time - delay)

    def scale(self, values: np.ndarray) -> float:
        """What the drive is multiplied by: a force gives the displacement of the spring alone."""
        return 1.0 / float(values[STIFFNESS]) if self.given.drive.is_force else 1.0

    def course(self, values: np.ndarray) -> Course:
        """Follow the motion."""
        of, drive = self._pieces(float(values[DELAY])), self.given.drive
        found = np.ascontiguousarray(shifted(of, self.cubics) * self.scale(values))
        w = _TURN * values[F_N]
        spring = float(values[SPRING]) if self.given.elastic else 0.0
        own = np.array([w, values[ZETA], values[X_F], values[MU], spring])
        m = of.lengths.size
        motion = Motion(
            np.zeros((m + 1, STATE)), np.zeros((m, 3, COLUMNS)), np.zeros((_ROOM[0] * m + _ROOM[1], 3)),
            np.zeros(2, dtype=np.int64),
        )  # fmt: skip
        turn = w * (np.sqrt(1.0 + spring) + 2.0 * abs(values[ZETA])) * float(of.lengths.max())
        intervals = Intervals(of.lengths, found, drive.forms(w, float(values[ZETA])), own, _terms(turn))
        start = np.array([values[PLACE], values[SPEED], values[STATE_OF_SPRING] * values[X_F]])
        code = motion_and_tangents(intervals, motion, start)
        course = Course(np.empty(0), np.empty(0), motion, of, values.copy(), found, code == RESOLVED)
        course = course._replace(x=self._shown(course))
        return course._replace(slopes=self._slopes(course))

    def _shown(self, course: Course) -> np.ndarray:
        """What the sensor shows."""
        given, state = self.given, course.motion.state
        x = state[:, (U, V, ACC)[given.order]]
        if given.drive.joined:
            x = x + self._base(course.found, course.of)
        offset = course.values[OFFSET] if given.order == 0 else 0.0
        return np.asarray(course.values[GAIN] * x[course.of.places] + offset)

    def _base(self, found: np.ndarray, of: Pieces) -> np.ndarray:
        """The part of the base in what a sensor of the mass shows, (m + 1, ...)."""
        return derivative_at(found, of.lengths, self.given.order - self.given.drive.order)

    def _slopes(self, course: Course) -> np.ndarray:
        """Derivatives of what the sensor shows by all parameters."""
        motion, values, found = course.motion, course.values, course.found
        added = np.zeros((course.of.lengths.size, 3, len(NAMES)))
        added[:, :, :VALUES] = motion.carry[:, :, 7:]
        added[:, :, F_N] *= _TURN
        if self.given.drive.is_force:
            by_scale = np.einsum("kij,kj->ki", motion.carry[:, :, 3:7], found)
            added[:, :, STIFFNESS] = -by_scale / values[STIFFNESS]
        out = np.zeros((added.shape[0] + 1, 3, len(NAMES)))
        out[0, 0, PLACE] = out[0, 1, SPEED] = 1.0
        out[0, 2, STATE_OF_SPRING] = values[X_F]
        out[0, 2, X_F] = motion.state[0, PHASE] or values[STATE_OF_SPRING]
        carried(motion.carry, added, out)
        result = self._sensed(course, out) + self._by_law(course)
        if self.given.drive.is_force:
            result[:, STIFFNESS] -= self._direct(course, found) / values[STIFFNESS]
        result[:, DELAY] = -self._rate(course)
        result = values[GAIN] * result[course.of.places]
        offset = values[OFFSET] if self.given.order == 0 else 0.0
        result[:, GAIN] = (course.x - offset) / values[GAIN]
        result[:, OFFSET] = float(self.given.order == 0)
        return result

    def _sensed(self, course: Course, out: np.ndarray) -> np.ndarray:
        """Derivatives of what the sensor shows, (m + 1, ...), from those of the state, (m + 1, 3, ...)."""
        if self.given.order < 2:
            return np.ascontiguousarray(out[:, self.given.order])
        w, zeta = _TURN * course.values[F_N], course.values[ZETA]
        moves = self._moves(course.motion.state)[:, None]
        return np.asarray(-moves * (2.0 * zeta * w * out[:, 1] + w * w * (out[:, 0] + out[:, 2])))

    def _by_law(self, course: Course) -> np.ndarray:
        """Derivatives of an acceleration by f_n and zeta with the state held, (m + 1, parameters)."""
        state, values = course.motion.state, course.values
        result = np.zeros((state.shape[0], len(NAMES)))
        if self.given.order < 2:
            return result
        w, zeta = _TURN * values[F_N], values[ZETA]
        forms = self.given.drive.forms(w, float(zeta))
        for column, name in ((1, F_N), (2, ZETA)):
            for k in np.flatnonzero(forms[:, column]):
                result[:, name] += forms[k, column] * derivative_at(course.found, course.of.lengths, int(k))
        result[:, F_N] -= 2.0 * zeta * state[:, V] + 2.0 * w * (state[:, U] + state[:, Q])
        result[:, F_N] *= _TURN
        result[:, ZETA] -= 2.0 * w * state[:, V]
        return np.asarray(result * self._moves(state)[:, None])

    def _moves(self, state: np.ndarray) -> np.ndarray:
        """Where the acceleration of u follows from the equation of motion, (m + 1,)."""
        return ((state[:, PHASE] != 0.0) | self.given.elastic).astype(float)

    def _direct(self, course: Course, found: np.ndarray) -> np.ndarray:
        """The part of the drive itself in what the sensor shows, for a drive `found`, (m + 1, ...)."""
        given, of = self.given, course.of
        result = np.zeros((of.lengths.size + 1, *found.shape[2:]))
        if given.order == 2:
            w = _TURN * course.values[F_N]
            forms = given.drive.forms(w, float(course.values[ZETA]))[:, 0]
            for k in np.flatnonzero(forms):
                result += forms[k] * derivative_at(found, of.lengths, int(k))
            result *= self._moves(course.motion.state).reshape((-1,) + (1,) * (result.ndim - 1))
        if given.drive.joined:
            result += self._base(found, of)
        return result

    def _rate(self, course: Course) -> np.ndarray:
        """Derivative of what the sensor shows by time, (m + 1,)."""
        given, state = self.given, course.motion.state
        if given.order == 2:
            return np.zeros(state.shape[0])
        rate = state[:, (V, ACC)[given.order]]
        if given.drive.joined:
            order = given.order + 1 - given.drive.order
            rate = rate + derivative_at(course.found, course.of.lengths, order)
        return np.asarray(rate)

    def by_drive(self, course: Course) -> np.ndarray:
        """Derivatives of what the sensor shows by the noisy samples of the drive, G of (H2)."""
        drive = self.given.drive
        noisy = np.flatnonzero(drive.noisy)
        result = np.empty((course.of.places.size, noisy.size))
        carry = course.motion.carry
        for begin in range(0, noisy.size, BLOCK):
            columns = noisy[begin : begin + BLOCK]
            unit = np.zeros((drive.time.size, columns.size))
            unit[columns, np.arange(columns.size)] = self.scale(course.values)
            found = shifted(course.of, coefficients(drive.time, unit))
            added = np.matmul(carry[:, :, 3:7], found)
            out = np.zeros((added.shape[0] + 1, 3, columns.size))
            carried(carry, added, out)
            shown = self._sensed(course, out) + self._direct(course, found)
            result[:, begin : begin + columns.size] = course.values[GAIN] * shown[course.of.places]
        return result


def _terms(turn: float) -> int:
    """Terms of a series whose angle per step is `turn`, or 1 where steps are divided, to rounding.

    The four terms of the drive, and as many for the derivatives, of which each has a source.
    """
    angle, size, terms = min(turn, 1.0), 1.0, 0
    while size > 2.0**-60 and terms < TERMS - 2 - 6:
        terms += 1
        size *= angle / terms
    return terms + 6

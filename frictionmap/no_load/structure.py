"""Cycles of structures on belts without a load: marched from a start, and closed by Newton's method.

    [I - J, -F(y_T); F(y_0)^T, 0] [dy; dT] = [phi_T(y) - y; 0]

J is the derivative of the flight phi_T by its beginning y, in the middle of a phase, and F the rate of the
state.  The second row keeps dy across the motion.
"""

from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.general.counts import CROSSINGS, STOPS, STUCK, TURNS
from .._kernels.general.problem import Problem
from .._kernels.general.record import HIGH, LOW
from .._kernels.general.series import Friction
from .._kernels.no_load.ride import (
    BACK,
    LONG,
    QUIET,
    fill_rates,
    fly,
    make_memory,
    march,
    start,
    time_to_event,
)
from ..general.problem import ModalSystem, problem_of
from ..model.general import in_general_form
from ..model.system import System
from .belts import Belts, shapes_of
from .steady import Sliding

#: Distance of states at two maxima, over the velocity of the motion, from which Newton's method is tried, and
#: its factor after each time that it leads elsewhere.
_NEAR, _NEARER, _NEAREST = 1e-2, 0.2, 1e-11

#: Newton steps at most; change of the state over the cycle, over the velocity, that is rounding error, and
#: the largest that is left where it does not get smaller.
_STEPS, _CLOSED, _NEARLY = 15, 1e-14, 1e-11

#: Change of the state over a part of the period, over the velocity, that is none.
_SAME = 1e-9

#: Rate of the state, over the velocity of the motion before, below which it is at rest.
_MOVES = 1e-2

#: How far from the state it began with, over the distance of the two maxima, Newton's method may lead.
_AWAY = 50.0

#: Singular values of Newton's equations below this share of the largest are zero: places of contacts that
#: rest all the time.
_NEUTRAL = 1e-11

#: Maxima followed at most, and periods of the slowest mode without a maximum after which motions are quiet.
MOST_MAXIMA, _LONGEST = 4000, 4.0

#: Quiet times after which a motion is given up, some maxima each.
_MOST_QUIET = 500


class Motion(NamedTuple):
    """Where a motion ends."""

    regime: int
    status: int
    period: float  # over 1/omega_1; NaN without a cycle
    stops: np.ndarray  # (N,) per cycle
    turns: np.ndarray  # (N,)
    stuck: np.ndarray  # (N,) share of the time
    crossings: np.ndarray  # (N,) of break points, per cycle
    highest: np.ndarray  # (n,) displacements of the masses
    lowest: np.ndarray
    contact_highest: np.ndarray  # (N,) displacements in the contacts
    contact_lowest: np.ndarray
    multiplier: float
    state: np.ndarray  # (2, m) modes and their velocities, in the middle of a phase
    senses: np.ndarray  # (N,) there


class Ride:
    """Motions of one structure at one belt speed.

    Parameters
    ----------
    system, belts : System, Belts
    speed : of the belt
    friction : largest beta of the grid, which bounds the rates of the motion
    """

    def __init__(self, system: System, belts: Belts, speed: float, friction: float) -> None:
        self.problem, self.modal = _problem(system, belts, speed, friction)
        self.belts, self.speed = belts, speed
        self.contact = int(np.flatnonzero(belts.share)[0])
        modal = self.modal
        self.shapes = np.ascontiguousarray(modal.phi if modal.points is None else modal.points.shapes)
        self._seen = shapes_of(system)  # the same by the coordinates of the structure
        self._march = make_memory(self.problem, self.shapes)
        self.flight = make_memory(self.problem, self.shapes)
        self.h = float(self._march.row.numbers[0])
        self.longest = _LONGEST * 2.0 * np.pi / np.sqrt(self.modal.squares.min()) / self.h

    def end_of(self, friction: Friction, sliding: Sliding, x: np.ndarray, velocity: np.ndarray) -> Motion:
        """Where the motion from displacements and velocities of the masses ends."""
        moved = self.modal.phi.T @ self.modal.mass
        begin = np.array([moved @ x, moved @ velocity])
        if not start(self.problem, friction, self._march, begin):
            return _unresolved(self.problem, len(self.shapes), regimes.TOO_MANY_EVENTS)
        near, quiet = _NEAR, 0
        while True:
            code, back = march(
                self.problem, friction, self._march, self.contact, near, MOST_MAXIMA, self.longest
            )
            if code == BACK:
                found = self._closed(friction, back, near)
                if found is not None:
                    return found
                near = max(near * _NEARER, _NEAREST)
            elif code == QUIET:
                present = self._present()
                if sliding.attracts(*present) or sliding.is_reached(*present[:2]):
                    return self._sliding(sliding)
                quiet += 1
                if quiet > _MOST_QUIET and sliding.followed == 0.0:
                    return self._sliding(sliding)._replace(status=regimes.MARGINAL)
                if quiet > _MOST_QUIET:
                    return _unresolved(self.problem, len(self.shapes), regimes.NOT_REACHED)
            elif code == LONG:
                found = self._averages(friction)
                return found._replace(status=regimes.MARGINAL) if sliding.followed == 0.0 else found
            else:
                return _unresolved(self.problem, len(self.shapes), regimes.TOO_MANY_EVENTS)

    def _present(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Displacements and velocities of the masses, senses and segments, of the motion marched."""
        motion, modes = self._march.motion, self.modal.squares.size
        x, p = motion.state[0, :modes], motion.state[1, :modes]
        return self.modal.phi @ x, self.modal.phi @ p / self.h, motion.sense, motion.segment

    def _closed(self, friction: Friction, back: int, near: float) -> Motion | None:
        """The cycle near the last maximum and the one `back` before it; None if there is no stable one."""
        trail, modes = self._march.trail, self.modal.squares.size
        last = (int(trail.counts[0]) - 1) % trail.times.size
        state, senses = trail.states[last, :, :modes], trail.senses[last]
        period = float(trail.times[last] - trail.times[last - back])
        size = float(trail.sizes[last])
        begin = self._middle(friction, state, senses, period)
        if begin is None:
            return None
        y, senses = begin
        closed = self._newton(friction, y, senses, period, size)
        if closed is None or np.abs(closed[0] - y).max() > _AWAY * near * size:
            return None
        y, period, largest = self._least_period(friction, closed, senses, back, size)
        if largest > 1.0 + 1e-9:  # beyond the rounding errors of a multiplier of 1: the motion leaves it
            return None
        return self._measured(friction, y, senses, period, largest)

    def _least_period(
        self, friction: Friction, closed: tuple[np.ndarray, float, float], senses: np.ndarray, back: int,
        size: float,
    ) -> tuple[np.ndarray, float, float]:  # fmt: skip
        """The same cycle over its least period, a part with a whole number of maxima."""
        y, period, _ = closed
        for parts in range(back, 1, -1):
            if back % parts:
                continue
            self.put(y, senses)
            if fly(self.problem, friction, self.flight, period / parts, False, False) < 0:
                continue
            end, pattern = self._taken()
            if (pattern == senses).all() and np.abs(end - y).max() <= _SAME * size:
                return self._newton(friction, y, senses, period / parts, size) or closed
        return closed

    def put(self, state: np.ndarray, senses: np.ndarray) -> None:
        """Begin a flight from modes and their velocities, in the middle of a phase."""
        motion, modes = self.flight.motion, self.modal.squares.size
        motion.state[:2, :modes] = state
        motion.sense[:] = senses
        motion.fresh[:] = 0

    def _taken(self) -> tuple[np.ndarray, np.ndarray]:
        motion, modes = self.flight.motion, self.modal.squares.size
        return motion.state[:2, :modes].copy(), motion.sense.copy()

    def _middle(
        self, friction: Friction, state: np.ndarray, senses: np.ndarray, period: float
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """The state in the middle between a maximum and the next event, and its pattern."""
        self.put(state, senses)
        time = time_to_event(self.problem, friction, self.flight, period)
        self.put(state, senses)
        if time == 0.0 or fly(self.problem, friction, self.flight, 0.5 * time, False, False) < 0:
            return None
        return self._taken()

    def _rates(self, friction: Friction) -> np.ndarray:
        fill_rates(self.problem, friction, self.flight)
        return self.flight.rates[:, : self.modal.squares.size].ravel().copy()

    def _newton(
        self, friction: Friction, y: np.ndarray, senses: np.ndarray, period: float, size: float
    ) -> tuple[np.ndarray, float, float] | None:
        """The state that returns, its period, and its largest multiplier; None if it is not found."""
        count, longest, last = y.size, 2.0 * period, np.inf
        for _ in range(_STEPS):
            self.put(y, senses)
            before = self._rates(friction)
            if np.abs(before).max() < _MOVES * size:
                return None  # steady sliding, which closes over any time
            self.put(y, senses)
            if fly(self.problem, friction, self.flight, period, True, False) <= 0:
                return None  # without an event the motion is linear, and part of no cycle of its own
            end, pattern = self._taken()
            if (pattern != senses).any():
                return None
            onward = self.flight.motion.tangent[:count, :count].copy()
            off = (end - y).ravel()
            error = float(np.abs(off).max()) / size
            if error <= _CLOSED or (error >= 0.5 * last and error <= _NEARLY):
                return y, period, self._largest_multiplier(onward, before, senses)
            last = error
            after = self._rates(friction)
            matrix = np.block(
                [[np.eye(count) - onward, -after[:, np.newaxis]], [before[np.newaxis], np.zeros((1, 1))]]
            )
            step = np.linalg.lstsq(matrix, np.append(off, 0.0), _NEUTRAL)[0]
            y, period = y + step[:-1].reshape(y.shape), period + float(step[-1])
            if not 0.0 < period < longest or not np.isfinite(y).all():
                return None
        return None

    def _largest_multiplier(self, onward: np.ndarray, rates: np.ndarray, senses: np.ndarray) -> float:
        """Largest modulus of the multipliers, without the 1 along the motion and those of resting contacts.

        F is an eigenvector of J, and the place of a contact that rests a left one: both are deflated.
        """
        left = onward - np.outer(onward @ rates, rates) / (rates @ rates)
        rest = (self.flight.counts[STUCK] > 0.0) & (self.flight.counts[STOPS] == 0.0) & (senses == 0)
        for chi in self.modal.chi[rest]:
            place = np.concatenate((chi, np.zeros_like(chi)))
            left -= np.outer(place, place @ left) / (place @ place)
        return float(np.abs(np.linalg.eigvals(left)).max())

    def _measured(
        self, friction: Friction, y: np.ndarray, senses: np.ndarray, period: float, multiplier: float
    ) -> Motion:
        """Counts and extremes of a cycle, or of a motion over a time."""
        self.put(y, senses)
        fly(self.problem, friction, self.flight, period, False, True)
        counts, ranges = self.flight.counts, self.flight.record.ranges
        contacts = senses.size
        stops = counts[STOPS].copy()
        regime = regimes.STICK_SLIP_CYCLE if stops.any() else regimes.CYCLE_WITHOUT_STOPS
        return Motion(
            regime, regimes.RESOLVED, period * self.h, stops, counts[TURNS].copy(), counts[STUCK] / period,
            counts[CROSSINGS].copy(), ranges[HIGH, contacts:].copy(), ranges[LOW, contacts:].copy(),
            ranges[HIGH, :contacts].copy(), ranges[LOW, :contacts].copy(), multiplier, y, senses,
        )  # fmt: skip

    def _averages(self, friction: Friction) -> Motion:
        """What a motion that does not return does over the time of the last maxima that are kept."""
        trail, motion, modes = self._march.trail, self._march.motion, self.modal.squares.size
        time = float(trail.times.max() - trail.times.min())
        found = self._measured(friction, motion.state[:2, :modes].copy(), motion.sense.copy(), time, np.nan)
        unknown = np.full_like(found.stops, np.nan)
        return found._replace(
            status=regimes.IRREGULAR, period=np.nan, stops=unknown, turns=unknown, crossings=unknown
        )

    def _sliding(self, sliding: Sliding) -> Motion:
        """Steady sliding."""
        still = np.zeros(self.problem.spring.size)
        x, _, senses, _ = self._present()
        place = sliding.place_of(x)
        seen = self._seen @ place
        stuck = (senses == 0).astype(float)
        z = self.modal.chi @ (self.modal.phi.T @ self.modal.mass @ place)
        state = np.array([self.modal.phi.T @ self.modal.mass @ place, np.zeros(self.modal.squares.size)])
        return Motion(
            regimes.STEADY_SLIDING, regimes.RESOLVED, np.nan, still, still, stuck, still, seen, seen, z, z,
            np.nan, state, senses.copy(),
        )  # fmt: skip


def _unresolved(problem: Problem, masses: int, status: int) -> Motion:
    contacts, modes = problem.chi.shape
    unknown = np.full(contacts, np.nan)
    places = np.full(masses, np.nan)
    return Motion(
        regimes.UNRESOLVED, status, np.nan, unknown, unknown, unknown, unknown, places, places, unknown,
        unknown, np.nan, np.zeros((2, modes)), np.zeros(contacts, np.int64),
    )  # fmt: skip


def _problem(system: System, belts: Belts, speed: float, friction: float) -> tuple[Problem, ModalSystem]:
    """The arrays of a structure at r = 1, its load taken off."""
    own = in_general_form(system).at_frequency(1.0)
    problem, modal = problem_of(own, np.array([1.0]), friction)
    size = max(friction, speed) / problem.squares.min()
    return problem._replace(
        belt=np.ascontiguousarray(belts.share * speed), phasors=np.zeros_like(problem.phasors),
        sizes=np.array([size]), symmetric=False,
    ), modal  # fmt: skip

"""The motions of a grid of records, scales and friction, on several threads."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from .._kernels.general.record import make_record
from .._kernels.general.series import Friction
from .._kernels.history.asleep import Bed
from .._kernels.history.course import CREEPING, Course
from .._kernels.history.kept import Kept, make_kept
from .._kernels.history.motion import Memory, make_memory
from .._kernels.motions_in_time import NEEDS_BED, SINCE, follow_record
from .bed import held, left_by
from .channels import Drive
from .energies import energies_over_time
from .starts import Start
from .structure import Structure, problem_of, ties_of, varying, watched_of

#: Events and states that there is room for at first, and samples per event beyond these.
_FIRST, _SAMPLES_PER_EVENT = 256, 4

#: Intervals after a record that a motion is followed to its rest.
_MOST_AFTER = 200_000

#: Distinct lengths of intervals that have tables, at most; else all intervals are followed by their series.
_MOST_LENGTHS = 64

#: Places in `Opened.base` of the states kept.
SHOWN = slice(2, None)

#: Rounding error of a sum, relative to its terms.
_ROUNDING = 2.0**-50


class Asked(NamedTuple):
    """How motions are followed, and what is kept."""

    start: Start
    after: float | None  # time after the record; None: until it is asleep
    every: int  # number of samples from a kept state to the next; 0: none


class Opened(NamedTuple):
    """What a motion has besides whose contacts open, or that has piecewise linear springs."""

    preload: np.ndarray  # (N,) N0
    separations: np.ndarray  # (N,)
    time: np.ndarray  # (N,) in which a contact is open
    crossings: np.ndarray  # (S,) knots that a spring has passed
    base: np.ndarray  # (2, 2 + states) place and velocity of the base: at first, at the end, at the states


class Elements(NamedTuple):
    """What a motion has besides whose contacts are banks of E elements."""

    stretch: np.ndarray  # (2, E) elongations of the springs of the elements at the start and at the end
    energy: np.ndarray  # (2,) of these springs
    stored: np.ndarray  # (N, times) the same of every contact at the states that are kept
    lost: np.ndarray  # (N, times) lost in every contact since the beginning


class Found(NamedTuple):
    """One motion."""

    status: int
    scale: float  # of the record
    kept: Kept
    counts: np.ndarray
    state: np.ndarray  # (2, m) at the end
    sense: np.ndarray  # (N,)
    end: float  # when that is
    asleep: float  # since when no contact moves again; NaN where this is not proved
    place: np.ndarray | None  # (m,) modes where it comes to rest; None where it may move on
    opened: Opened | None = None
    elements: Elements | None = None


def starting(structure: Structure, start: Start) -> np.ndarray:
    m, contacts = start.q.size, structure.spring.size
    found = np.zeros((3, max(m, contacts)))
    found[0, :m], found[1, :m], found[2, :contacts] = start.q, start.p, start.f
    return found


def room_for(asked: Asked, steps: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Numbers of events and of states that there is room for at first."""
    samples = 0
    if asked.every:
        samples = steps.size // asked.every + int(limits[1] * (1 - limits[2]))
    expected = _FIRST + steps.size // _SAMPLES_PER_EVENT
    return np.array([expected, samples and samples + 2 * expected * int(limits[3]) + _FIRST])


class Kernels(NamedTuple):
    """What the kernels follow a motion with: of `general`, or of `phases`."""

    problem: Any
    friction: Any
    memory: Callable[[Course, np.ndarray], tuple[Any, Kept]]  # by the room for events and states
    bed: Callable[[Any], Any]  # of the phase in which a memory is; None: the one to begin with


class Ran(NamedTuple):
    """A motion as the kernels leave it."""

    status: int
    memory: Any
    kept: Kept
    end: float  # when that is
    asleep: float  # since when no contact moves again; NaN where this is not proved


class Motions:
    """The motions of a structure under one record."""

    def __init__(self, structure: Structure, drive: Drive) -> None:
        self.structure, self.drive = structure, drive
        self.problem = problem_of(structure, drive)
        self.ties = ties_of(structure)
        self.ties[~varying(drive)] = False
        self.held = held(self.problem)
        self.left = left_by(self.problem, drive.terms[-1], drive.steps[-1])
        self.watched = watched_of(structure, self.problem, drive)

    def limits_of(self, asked: Asked, events: bool) -> tuple[np.ndarray, np.ndarray]:
        """Lengths of the intervals, and the limits of `follow_record`."""
        steps = self.drive.steps.copy()
        if asked.after is None:
            return steps, np.array([asked.every, _MOST_AFTER, 1, events])
        count = int(np.ceil(asked.after / steps[-1]))
        if count:
            steps[-1] = asked.after / count
        return steps, np.array([asked.every, count, 0, events])

    def terms_of(self, scale: float, steps: np.ndarray) -> np.ndarray:
        """Polynomials of the channels over intervals of these lengths, of which the last may be another."""
        terms = self.drive.terms * scale
        if self.drive.normal.any():  # normal loads are no loads
            normal = self.drive.normal.any(axis=0)
            terms[:, normal] = self.drive.terms[:, normal]
        if steps[-1] != self.drive.steps[-1]:
            terms[-1, :, 1] *= steps[-1] / self.drive.steps[-1]
        return terms

    def at(self, beta: float, mu: float, scale: float, asked: Asked, events: bool) -> Found:
        """Follow one motion at a friction ratio and a static-to-kinetic ratio; see `follow`."""
        groups = self.structure.system.contact_system.groups
        kinetic, static = np.array([group.friction(beta, mu) for group in groups], dtype=float).T
        return self.follow(kinetic, static, scale, asked, events)

    def run(self, asked: Asked, scale: float, events: bool, kernels: Kernels) -> Ran:
        """Follow one motion; where there is no room for all its events, once more with more.

        events : whether states at events are kept, where any are
        """
        steps, limits = self.limits_of(asked, events and asked.every > 0)
        terms = np.ascontiguousarray(self.terms_of(scale, steps))
        drive = self.drive
        course = Course(terms, steps, drive.times, drive.jumps, self.ties, drive.direct)
        start, room = starting(self.structure, asked.start), room_for(asked, steps, limits)
        while True:
            memory, kept = kernels.memory(course, room)
            state, bed, status = np.array([-1, -1]), kernels.bed(None), NEEDS_BED
            while status == NEEDS_BED:
                status = int(follow_record(
                    kernels.problem, kernels.friction, memory, course, start, asked.start.sense, kept, bed,
                    limits, state,
                ))  # fmt: skip
                bed = kernels.bed(memory) if status == NEEDS_BED else bed
            if (kept.counts <= room).all():
                break
            room = np.maximum(room, kept.counts)
        end, asleep = (self.time_after(int(k), steps) for k in state)
        return Ran(status, memory, kept, end, asleep if state[SINCE] >= 0 else np.nan)

    def follow(
        self,
        kinetic: np.ndarray,
        static: np.ndarray,
        scale: float,
        asked: Asked,
        events: bool = True,
        rows: slice = slice(None),
    ) -> Found:
        """Follow one motion; see `run`.

        rows : the watched quantities whose peaks are kept
        """
        problem, friction = (
            self.problem,
            Friction(np.ascontiguousarray(kinetic), np.ascontiguousarray(static)),
        )
        weights = np.ascontiguousarray(self.watched.weights[rows])
        rounding = self.rounding_of(self.watched.weights, static, scale)[rows]
        one = problem._replace(rates=np.ones(1))  # room for the channels of one interval
        still = problem._replace(belt=np.zeros_like(problem.belt))

        def memory(course: Course, room: np.ndarray) -> tuple[Memory, Kept]:
            lengths = len(np.unique(course.steps))
            lengths = lengths if lengths <= _MOST_LENGTHS else 0
            record = make_record(problem, np.empty((0, problem.squares.size)), 0)
            kept = make_kept(problem, weights, rounding, record, room)
            return make_memory(one, still, weights.shape[0], course.pieces.shape[2], lengths), kept

        bed = self.bed_after(scale)
        ran = self.run(asked, scale, events, Kernels(problem, friction, memory, lambda _: bed))
        motion = ran.memory.motion
        state = motion.state[:2, : problem.squares.size]
        found = Found(
            ran.status, scale, ran.kept, ran.memory.counts, state, motion.sense, ran.end, ran.asleep, None
        )
        return found._replace(place=self._place(found))

    def bed_after(self, scale: float) -> Bed:
        """The bed after the record, at a factor of it."""
        return self.left.at(self.held.bed, self.problem.squares, scale)

    def rounding_of(
        self, weights: np.ndarray, static: np.ndarray, scale: float, further: Sequence[np.ndarray] = ()
    ) -> np.ndarray:
        """Rounding errors of watched quantities, from the sizes of what they are sums of.

        further : sizes of forces beside those in contacts
        """
        problem, size, loads = self.problem, self.size_of(scale), self.loads_of(scale)
        modes = np.full(problem.squares.size, size)
        forces = np.minimum(static, float(np.abs(problem.push).sum(axis=0) @ loads))
        units = np.concatenate((modes, modes * problem.rates[0], forces, *further, loads))
        return _ROUNDING * (np.abs(weights) @ units)

    def size_of(self, scale: float) -> float:
        """Displacement that the record can be expected to cause."""
        return float(self.problem.sizes[0] * abs(scale))

    def loads_of(self, scale: float) -> np.ndarray:
        """Bounds on the channels, (D,)."""
        return np.asarray(np.abs(self.drive.terms).sum(axis=2).max(axis=0) * max(1.0, abs(scale)))

    def time_after(self, intervals: int, steps: np.ndarray) -> float:
        """Time after a number of intervals."""
        last = steps.size - 1
        return float(self.drive.times[min(intervals, last)] + max(0, intervals - last) * steps[-1])

    def energy(self, q: np.ndarray, p: np.ndarray, f: np.ndarray, one: Found, at: int | slice) -> np.ndarray:
        """Energy of masses and springs in states (..., times), also of the springs in contacts.

        at : 0: that at the beginning of the motion; 1: that at its end; SHOWN: the states kept
        """
        elastic, flexibility = self.structure.spring > 0.0, self.problem.coupling.flexibility
        if flexibility.size:
            springs = (f * (flexibility @ f)).sum(axis=0)
        else:
            springs = (f[elastic].T ** 2 / self.structure.spring[elastic]).sum(axis=-1)
        return np.asarray(0.5 * ((p**2).sum(axis=0) + self.problem.squares @ q**2 + springs))

    def energies_at_ends(self, one: Found, start: Start) -> tuple[float, float]:
        """Energy at the start and at the end."""
        q, p = one.state
        before = self.energy(start.q, start.p, start.f, one, 0)
        return float(before), float(self.energy(q, p, one.kept.forces, one, 1))

    def energies(self, one: Found, states: np.ndarray, slider: np.ndarray) -> dict[str, np.ndarray]:
        """Energies at the states of one motion; arguments as of `energies_over_time`."""
        m, contacts = self.problem.squares.size, self.structure.spring.size
        q, p, f = np.split(states[1 : 1 + 2 * m + contacts], (m, 2 * m))
        stored = self.energy(q, p, f, one, SHOWN)
        return energies_over_time(self.structure, stored, self.problem.belt, states, slider)

    def needed_friction(self, forces: np.ndarray) -> np.ndarray:
        """Friction of each contact (N,) that holds against forces of this size."""
        return forces

    def further_scalars(self, one: Found) -> dict[str, np.ndarray]:
        """Numbers of one motion that only some systems have."""
        return {}

    def further_traces(self, one: Found, values: np.ndarray) -> dict[str, np.ndarray]:
        """Histories that only some systems have, from those of the watched quantities."""
        return {}

    def state_at_end(self, one: Found) -> np.ndarray:
        """State s of the bed at the end: q - shift, q' and forces of springs."""
        springs = np.where(self.structure.spring > 0.0, one.kept.forces, 0.0)
        return np.concatenate((one.state[0] - self.bed_after(one.scale).shift, one.state[1], springs))

    def _place(self, one: Found) -> np.ndarray | None:
        """Where the masses come to rest."""
        if one.asleep == one.asleep and self.held.restored:
            return self.held.rest @ self.state_at_end(one) + self.bed_after(one.scale).shift
        return one.state[0] if one.status == CREEPING else None

    def _residual_places(self, one: Found) -> np.ndarray:
        """What forces in contacts displace beside the modes where these come to rest, (p,)."""
        forces = self.held.bed.forces @ self.state_at_end(one)
        return self.structure.beside_modes(one.kept.forces if one.status == CREEPING else forces)

    def places(self, one: Found) -> np.ndarray:
        """Where the masses, or points, come to rest, (n,)."""
        found = np.asarray(self.structure.shapes @ one.place)
        return found + self._residual_places(one) if self.structure.softer else found

    def contact_places(self, one: Found) -> np.ndarray:
        """Where the contacts come to rest, (N,)."""
        assert one.place is not None
        moving = self.problem.base @ self.drive.terms[-1, :, 1] != 0.0
        walls = one.scale * self.drive.terms[-1, :, 0]
        places = self.problem.chi @ one.place - self.problem.base @ walls
        points = self.structure.points
        if points is not None and self.structure.softer:
            places = places + points.vectors @ self._residual_places(one)
        return np.where(moving, np.nan, places)

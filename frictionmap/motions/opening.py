"""Motions of systems whose contacts open, or that have piecewise linear springs, under a record.

Masses move relative to the base, and the ground moves back: the place of the base is one more mode, on which
nothing acts, so that what presses a contact and what stretches a spring are sums of modes as without a base.
"""

from dataclasses import replace

import numpy as np

from .._kernels.general.counts import COUNT_ROWS, STUCK
from .._kernels.general.record import make_record
from .._kernels.history.course import CREEPING, Course
from .._kernels.history.kept import Kept, make_kept
from .._kernels.phases.kept import LIFTED, Memory
from .._kernels.phases.problem import LIFTOFFS, OPEN, WIDTH, Cell, Problem, make_motion, make_row
from .._kernels.phases.problem import STUCK as HELD
from .._kernels.phases.problem import Motion as PhaseMotion
from .._kernels.phases.rest import Bed
from ..errors import InputError
from ..model.system import System
from ..phases.arrays import Modal, fastest, grid_of, problem_of
from ..phases.given import phase_system
from ..phases.response import senses_of
from ..phases.system import PhaseSystem
from .cells import SHOWN, Asked, Found, Kernels, Motions, Opened, Ran
from .channels import Drive, Ground, ground_of
from .phase_beds import Phase, bed_of
from .structure import Structure, watched_of


def _system(system: System, drive: Drive) -> PhaseSystem:
    """The structure with its contacts and springs, relative to the base."""
    for k, group in enumerate(system.contact_system.groups, 1):
        if group.first.normal_record is not None:
            raise InputError(
                "cannot use", f"contacts[{k}].normal_record",
                "beside contacts that open or piecewise linear springs: a given normal load is not offered "
                "there; omit it",
            )  # fmt: skip
    given = phase_system(system, 1.0)
    walls = drive.base[:, drive.of_base].sum(axis=1)
    contacts = [replace(one, moved=float(wall)) for one, wall in zip(given.contacts, walls, strict=True)]
    return replace(given, contacts=contacts, loads={}, base={}, offset=None)


def _with_base(problem: Problem, ground: Ground) -> Problem:
    """The same system with the place of the base as the last mode."""

    def wider(rows: np.ndarray, last: np.ndarray | float = 0.0) -> np.ndarray:
        column = np.zeros(len(rows)) + last
        return np.ascontiguousarray(np.column_stack((rows, column)))

    return problem._replace(
        squares=np.append(problem.squares, 0.0), damping=np.pad(problem.damping, (0, 1)),
        chi=wider(problem.chi), normal=wider(problem.normal, ground.normal),
        along=wider(problem.along, ground.along), observed=wider(problem.observed),
    )  # fmt: skip


def _pressing(pressed: np.ndarray, preload: float, stiffness: float) -> np.ndarray:
    """Energy of the spring that presses a contact, and of its preload, at displacements d.x."""
    force = preload + stiffness * pressed
    if preload < 0.0:
        return np.asarray(0.5 * np.maximum(force, 0.0) ** 2 / stiffness)
    opened = -preload * (pressed + 0.5 * preload / stiffness)
    return np.where(force > 0.0, 0.5 * stiffness * pressed**2, opened)


def pattern_of(memory: Memory) -> np.ndarray:
    """Senses of the contacts, LIFTED where they are open, and pieces of the springs."""
    motion = memory.motion
    return np.concatenate((np.where(motion.open != 0, LIFTED, motion.sense), motion.piece))


def state_of(memory: Memory) -> np.ndarray:
    """The state q, q', f, 1 at the end of a motion."""
    motion = memory.motion
    return np.concatenate((motion.q, motion.p, motion.f, [1.0]))


class _Beds:
    """The beds of one motion, by phase."""

    def __init__(self, problem: Problem, cell: Cell, free: int, still: bool, load: np.ndarray) -> None:
        self.problem, self.cell, self.free, self.still, self.load = problem, cell, free, still, load
        self.known: dict[tuple[int, ...], Phase] = {}

    @property
    def unknown(self) -> Bed:
        """The bed of no phase."""
        contacts, modes = self.problem.chi.shape
        size = 2 * modes + contacts + 1
        pattern = np.full(contacts + self.problem.along.shape[0], -1)
        return Bed(pattern, np.zeros((0, size)), np.zeros((0, size)), np.zeros(0), np.zeros(1, np.int64))

    def of(self, memory: Memory) -> Phase:
        """Return the bed of the present phase, whose contacts are open or held."""
        pattern = pattern_of(memory)
        key = tuple(pattern.tolist())
        if key not in self.known:
            self.known[key] = bed_of(self.problem, self.cell, pattern, self.free, self.still, self.load)
        return self.known[key]

    def bed(self, memory: Memory | None) -> Bed:
        """Return that of the present phase for the kernels."""
        return self.unknown if memory is None else self.of(memory).bed


class OpeningMotions(Motions):
    """The motions of such a structure under one record."""

    def __init__(self, structure: Structure, drive: Drive) -> None:
        super().__init__(structure, drive)
        modal = structure.modal
        self.system = _system(structure.system, drive)
        self.modes = Modal(modal.squares, modal.phi, modal.damping)
        self.phases: Problem = problem_of(self.system, self.modes, np.zeros((0, self.system.n)))
        further = {"normal_force": self.phases.normal, "piecewise_force": self.phases.along}
        self.watched = watched_of(structure, self.problem, drive, further)
        self.rate = fastest(self.phases)
        self.free = self.modes.squares.size  # modes of the structure; the next one, if any, is the base
        if drive.of_base.any():
            self.phases = _with_base(self.phases, ground_of(structure.system.contact_system))

    @property
    def _base(self) -> slice:
        """Where the base is among the modes."""
        return slice(self.free, None)

    def _memory(self, terms: int, size: float) -> Memory:
        problem, base = self.phases, self._base
        contacts, modes = problem.chi.shape
        channels = self.problem.push.shape[1]
        row = make_row(problem, 1.0, 1.0, 0, np.zeros(contacts), np.zeros(0), np.zeros((2, 0, modes + 1)))
        row.push[:, base] = row.pull[:, base] = 0.0
        push = np.pad(self.problem.push, ((0, modes - self.free), (0, 0)))
        return Memory(
            make_motion(problem, row, 0), row._replace(size=size), self.problem.belt.astype(float),
            push, self.drive.of_base.astype(float), np.array([self.free]), self._ground(),
            np.array([self.rate]), np.ones(1), np.array([terms]), np.zeros((channels, WIDTH)),
            np.zeros((channels, WIDTH)), np.zeros(contacts, np.int64), np.zeros(contacts),
            np.zeros((8, WIDTH)), np.full(self.free, np.inf),
        )  # fmt: skip

    def _ground(self) -> np.ndarray:
        """Force of the ground, over which the base moves, as a sum of units; of no row where it is 0."""
        normal, along = (rows[:, self._base].sum(axis=1) for rows in (self.phases.normal, self.phases.along))
        (contacts, modes), channels = self.phases.chi.shape, self.problem.push.shape[1]
        found = np.concatenate((np.zeros(2 * modes + contacts), normal, along, np.zeros(channels)))
        return found[np.newaxis] if found.any() else np.zeros((0, found.size))

    def _kept(self, weights: np.ndarray, rounding: np.ndarray, room: np.ndarray) -> Kept:
        """Memory of the results of a motion; further forces are forces of further contacts."""
        general, phases, contacts = self.problem, self.phases, self.phases.law.size
        wider = general._replace(chi=np.concatenate((phases.chi, phases.normal, phases.along)))
        more = phases.squares.size - self.free
        columns = np.repeat([self.free, 2 * self.free], more)
        record = make_record(general, np.empty((0, 0)), 0)
        kept = make_kept(wider, np.insert(weights, columns, 0.0, axis=1), rounding, record, room)
        own = {name: getattr(kept, name)[..., :contacts].copy() for name in ("slides", "changes", "senses")}
        return kept._replace(forces=np.zeros(contacts), **own)

    def cell(self, beta: float, mu: float) -> Cell:
        """Friction and preloads; the load of the system is not used."""
        grid = grid_of(self.system, self.modes, np.array([beta]), mu, 0)
        return Cell(grid.limit[0], grid.static[0], grid.preload[0], np.zeros(self.phases.squares.size))

    def _rounding(self, weights: np.ndarray, cell: Cell, scale: float) -> np.ndarray:
        """Rounding errors of watched quantities."""
        problem = self.phases
        stiffest = np.abs(problem.slopes).max(axis=1, initial=0.0)
        pressed = problem.pressed[:, np.newaxis] * problem.normal
        size, place = self.size_of(scale), self.loads_of(scale)[self.drive.of_base].sum()
        further = [
            np.abs(one[:, : self.free]).sum(axis=1) * size + np.abs(one[:, self._base]).sum(axis=1) * place
            for one in (pressed, stiffest[:, np.newaxis] * problem.along)
        ]
        limit = np.abs(cell.static * cell.limit) + np.abs(problem.lift * cell.preload)
        return self.rounding_of(weights, limit, scale, further)

    def ran(
        self, cell: Cell, scale: float, asked: Asked, events: bool, weights: np.ndarray | None = None
    ) -> tuple[Ran, _Beds]:
        """Follow one motion; see `Motions.run`.

        weights : of quantities whose peaks are kept, in the place of all others
        """
        still = not (
            self.problem.belt.any() or (scale and self.drive.terms[-1, self.drive.of_base, 1:].any())
        )
        load = np.pad(scale * self.left.load, (0, self.phases.squares.size - self.free))
        beds = _Beds(self.phases, cell, self.free, still, load)
        watched = self.watched.weights if weights is None else weights
        rounding = self._rounding(watched, cell, scale)
        size = float(self.problem.sizes[0]) * (abs(scale) or 1.0)

        def memory(course: Course, room: np.ndarray) -> tuple[Memory, Kept]:
            return self._memory(course.pieces.shape[2], size), self._kept(watched, rounding, room)

        return self.run(asked, scale, events, Kernels(self.phases, cell, memory, beds.bed)), beds

    def at(self, beta: float, mu: float, scale: float, asked: Asked, events: bool) -> Found:
        """Follow one motion; see `Motions.follow`."""
        cell = self.cell(beta, mu)
        ran, beds = self.ran(cell, scale, asked, events)
        memory, free = ran.memory, self.free
        motion, place = memory.motion, None
        if ran.asleep == ran.asleep:
            place = (beds.of(memory).rest @ state_of(memory))[:free]
        elif ran.status == CREEPING:
            place = motion.q[:free].copy()
        counts = np.zeros((COUNT_ROWS, motion.sense.size))
        counts[STUCK] = motion.counts[HELD]
        kept, base = self._without_base(ran.kept, motion, scale)
        opened = Opened(cell.preload, motion.counts[LIFTOFFS], motion.counts[OPEN], motion.crossings, base)
        ends = np.stack((motion.q[:free], motion.p[:free]))
        return Found(ran.status, scale, kept, counts, ends, motion.sense, ran.end, ran.asleep, place, opened)

    def _without_base(self, kept: Kept, motion: PhaseMotion, scale: float) -> tuple[Kept, np.ndarray]:
        """The states kept without the base, and its place and velocity, see `Opened`."""
        shown, modes = min(int(kept.counts[1]), len(kept.states)), self.phases.squares.size
        found = np.zeros((2, 2 + shown))
        if modes == self.free:
            return kept, found
        columns = [modes, 2 * modes]  # behind the time
        first = scale * self.drive.terms[0, self.drive.of_base].sum(axis=0)
        found[:, 0] = first[0], first[1] / self.drive.steps[0]
        found[:, 1] = motion.q[-1], motion.p[-1]
        found[:, 2:] = kept.states[:shown, columns].T
        return kept._replace(states=np.delete(kept.states, columns, axis=1)), found

    def energy(self, q: np.ndarray, p: np.ndarray, f: np.ndarray, one: Found, at: int | slice) -> np.ndarray:
        """Energy of masses and springs, also of those that press the contacts, 0 in the equilibrium."""
        assert one.opened is not None
        found = super().energy(q, p, f, one, at)
        problem = self.phases
        if problem.squares.size > self.free:
            q = np.concatenate((q, np.broadcast_to(one.opened.base[0, at], q[:1].shape)))
        for j in np.flatnonzero(problem.presses):
            found = found + _pressing(problem.normal[j] @ q, one.opened.preload[j], problem.pressed[j])
        for along, spring in zip(problem.along, self.system.springs, strict=True):
            found = found + spring.energy(along @ q)
        return found

    def further_scalars(self, one: Found) -> dict[str, np.ndarray]:
        """Normal forces, separations, and forces of piecewise linear springs."""
        assert one.opened is not None
        low, high = one.kept.peaks[0], one.kept.peaks[1]
        pressed, springs = (self.watched.places[name] for name in ("normal_force", "piecewise_force"))
        found: dict[str, np.ndarray] = {}
        if self.phases.presses.any():
            rest = self._at_rest(one.opened)
            found |= {
                "normal_force_max": np.maximum(rest + high[pressed], 0.0),
                "normal_force_min": np.maximum(rest + low[pressed], 0.0),  # without rounding errors
                "separations": one.opened.separations,
                "open_fraction": one.opened.time / one.end if one.end else 0.0 * rest,
            }  # fmt: skip
        if self.system.springs:
            found["spring_force_max"] = np.maximum(np.abs(low[springs]), np.abs(high[springs]))
            found["spring_crossings"] = one.opened.crossings
        return found

    def further_traces(self, one: Found, values: np.ndarray) -> dict[str, np.ndarray]:
        """Normal forces, which contacts are open, and forces of piecewise linear springs."""
        assert one.opened is not None
        found: dict[str, np.ndarray] = {}
        if self.phases.presses.any():
            force = values[self.watched.places["normal_force"]] + self._at_rest(one.opened)[:, np.newaxis]
            states, modes = one.kept.states[: one.kept.counts[1]].T, self.free
            senses = one.kept.senses[: one.kept.counts[1]].T
            opened = senses == LIFTED
            rate = self.phases.chi[:, :modes] @ states[1 + modes : 1 + 2 * modes]
            rate -= self.problem.belt[:, np.newaxis] + np.outer(self.phases.moved, one.opened.base[1, SHOWN])
            found |= {
                "normal_force": np.where(opened, 0.0, np.maximum(force, 0.0)), "open": opened,
                "direction": senses_of(senses, opened, rate),
            }  # fmt: skip
        if self.system.springs:
            found["piecewise_force"] = values[self.watched.places["piecewise_force"]]
        return found

    def _at_rest(self, opened: Opened) -> np.ndarray:
        """Normal forces at rest, (N,); NaN where the motion does not change them."""
        return np.where(self.phases.presses, np.maximum(opened.preload, 0.0), np.nan)

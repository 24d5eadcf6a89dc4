"""Motions of systems whose contacts open, or that have piecewise linear springs, under a record."""

from dataclasses import replace

import numpy as np

from .._kernels.general.counts import COUNT_ROWS, STUCK
from .._kernels.general.record import make_record
from .._kernels.history.kept import Kept, make_kept
from .._kernels.history.motion import CREEPING, Course
from .._kernels.phases.kept import LIFTED, Memory
from .._kernels.phases.problem import LIFTOFFS, OPEN, WIDTH, Cell, Problem, make_motion, make_row
from .._kernels.phases.problem import STUCK as HELD
from .._kernels.phases.rest import Bed
from .._kernels.phases.under_record import NEEDS_BED, SINCE, follow_record
from ..errors import InputError
from ..model.system import System
from ..phases.arrays import Modal, fastest, grid_of, problem_of
from ..phases.given import phase_system
from ..phases.response import senses_of
from ..phases.system import PhaseSystem
from .cells import Asked, Found, Motions, Opened, room_for, starting
from .channels import Drive
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
    moving = drive.base.any(axis=0)
    walls = drive.base[:, moving].sum(axis=1) if moving.any() else np.zeros(len(given.contacts))
    contacts = [replace(one, moved=float(wall)) for one, wall in zip(given.contacts, walls, strict=True)]
    return replace(given, contacts=contacts, loads={}, base={}, offset=None)


def refuse_ground(system: System, drive: Drive) -> None:
    """Refuse what the ground presses or stretches where the base moves: masses move relative to the base."""
    if not drive.acceleration.any():
        return
    general = system.contact_system
    seen = [
        (f"contacts[{k}].normal", group.normal.direction)
        for k, group in enumerate(general.groups, 1) if group.normal is not None
    ]  # fmt: skip
    seen += [(f"springs[{k}]", one.direction) for k, one in enumerate(general.springs, 1)]
    for key, direction in seen:
        if abs(direction.sum()) > 1e-12 * np.abs(direction).max():
            raise InputError(
                f"cannot use {key} with the ground under a motion of the base: this is offered between two "
                "masses; give masses = [A, B], or a record of force"
            )


def _pressing(pressed: np.ndarray, preload: float, stiffness: float) -> np.ndarray:
    """Energy of the spring that presses a contact, and of its preload, at displacements d.x."""
    force = preload + stiffness * pressed
    if preload < 0.0:
        return np.asarray(0.5 * np.maximum(force, 0.0) ** 2 / stiffness)
    opened = -preload * (pressed + 0.5 * preload / stiffness)
    return np.where(force > 0.0, 0.5 * stiffness * pressed**2, opened)


class _Beds:
    """The beds of one motion, by phase."""

    def __init__(self, problem: Problem, cell: Cell, still: bool) -> None:
        self.problem, self.cell, self.still = problem, cell, still
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
        motion = memory.motion
        pattern = np.concatenate((np.where(motion.open != 0, LIFTED, motion.sense), motion.piece))
        key = tuple(pattern.tolist())
        if key not in self.known:
            self.known[key] = bed_of(self.problem, self.cell, pattern, self.still)
        return self.known[key]

    def place(self, memory: Memory) -> np.ndarray:
        """Modes where the present motion comes to rest."""
        motion = memory.motion
        state = np.concatenate((motion.q, motion.p / memory.length[0], motion.f, [1.0]))
        return np.asarray(self.of(memory).rest @ state)


def _ended(code: int, memory: Memory, kept: Kept, cell: Cell) -> Found:
    """One motion without its times and its place of rest."""
    motion = memory.motion
    counts = np.zeros((COUNT_ROWS, motion.sense.size))
    counts[STUCK] = motion.counts[HELD]
    opened = Opened(cell.preload, motion.counts[LIFTOFFS], motion.counts[OPEN], motion.crossings)
    ends = np.stack((motion.q, motion.p / memory.length[0]))
    return Found(code, kept, counts, ends, motion.sense, np.nan, np.nan, None, opened)


class OpeningMotions(Motions):
    """The motions of such a structure under one record."""

    def __init__(self, structure: Structure, drive: Drive) -> None:
        super().__init__(structure, drive)
        refuse_ground(structure.system, drive)
        modal = structure.modal
        self.system = _system(structure.system, drive)
        self.modes = Modal(modal.squares, modal.phi, modal.damping)
        self.phases: Problem = problem_of(self.system, self.modes, np.zeros((0, self.system.n)))
        further = {"normal_force": self.phases.normal, "piecewise_force": self.phases.along}
        self.watched = watched_of(structure, self.problem, drive, further)

    def _memory(self, terms: int, size: float) -> Memory:
        problem = self.phases
        contacts, modes = problem.chi.shape
        channels = self.problem.push.shape[1]
        row = make_row(problem, 1.0, 1.0, 0, np.zeros(contacts), np.zeros(0), np.zeros((2, 0, modes + 1)))
        walls = self.drive.base.any(axis=0).astype(float)
        return Memory(
            make_motion(problem, row, 0), row._replace(size=size), self.problem.belt.astype(float),
            self.problem.push, walls, np.array([fastest(problem)]), np.ones(1), np.array([terms]),
            np.zeros((channels, WIDTH)), np.zeros((channels, WIDTH)), np.zeros(contacts, np.int64),
            np.zeros(contacts), np.zeros((8, WIDTH)),
        )  # fmt: skip

    def _kept(self, rounding: np.ndarray, room: np.ndarray) -> Kept:
        """Memory of the results of a motion; further forces are forces of further contacts."""
        general, contacts = self.problem, self.phases.law.size
        wider = general._replace(chi=np.concatenate((general.chi, self.phases.normal, self.phases.along)))
        record = make_record(general, np.empty((0, 0)), 0)
        kept = make_kept(wider, self.watched.weights, rounding, record, room)
        own = {name: getattr(kept, name)[..., :contacts].copy() for name in ("slides", "changes", "senses")}
        return kept._replace(forces=np.zeros(contacts), **own)

    def _cell(self, beta: float, mu: float) -> Cell:
        """Friction and preloads; the load of the system is not used."""
        grid = grid_of(self.system, self.modes, np.array([beta]), mu, 0)
        return Cell(grid.limit[0], grid.static[0], grid.preload[0], np.zeros(self.modes.squares.size))

    def _rounding(self, cell: Cell, scale: float) -> np.ndarray:
        """Rounding errors of the watched quantities."""
        problem = self.phases
        stiffest = np.abs(problem.slopes).max(axis=1, initial=0.0)
        pressed = problem.pressed[:, np.newaxis] * problem.normal
        limit = np.abs(cell.static * cell.limit) + np.abs(problem.lift * cell.preload)
        return self.rounding_of(limit, scale, (pressed, stiffest[:, np.newaxis] * problem.along))

    def at(self, beta: float, mu: float, scale: float, asked: Asked, events: bool) -> Found:
        """Follow one motion; see `Motions.follow`."""
        cell = self._cell(beta, mu)
        steps, limits = self.limits_of(asked, events and asked.every > 0)
        terms = np.ascontiguousarray(self.terms_of(scale, steps))
        moving = terms[-1, :, 1:].any(axis=1) & self.drive.base.any(axis=0)
        beds = _Beds(self.phases, cell, not (self.problem.belt.any() or moving.any()))
        course = Course(terms, steps, self.drive.times, self.drive.jumps, self.ties)
        start, room = starting(self.structure, asked.start), room_for(asked, steps, limits)
        rounding, size = self._rounding(cell, scale), float(self.problem.sizes[0]) * (abs(scale) or 1.0)
        while True:
            memory, kept = self._memory(terms.shape[2], size), self._kept(rounding, room)
            state, bed, code = np.array([-1, -1]), beds.unknown, NEEDS_BED
            while code == NEEDS_BED:
                code = int(follow_record(
                    self.phases, cell, memory, course, start, asked.start.sense, kept, bed, limits, state
                ))  # fmt: skip
                bed = beds.of(memory).bed if code == NEEDS_BED else bed
            if (kept.counts <= room).all():
                break
            room = np.maximum(room, kept.counts)
        done, since = (self.time_after(int(k), steps) for k in state)
        place = memory.motion.q.copy() if code == CREEPING else None
        if state[SINCE] >= 0:
            place = beds.place(memory)
        found = _ended(code, memory, kept, cell)
        return found._replace(end=done, asleep=since if state[SINCE] >= 0 else np.nan, place=place)

    def energy(self, q: np.ndarray, p: np.ndarray, f: np.ndarray, opened: Opened | None) -> np.ndarray:
        """Energy of masses and springs, also of those that press the contacts, 0 in the equilibrium."""
        assert opened is not None
        found = super().energy(q, p, f, opened)
        problem = self.phases
        for j in np.flatnonzero(problem.presses):
            found = found + _pressing(problem.normal[j] @ q, opened.preload[j], problem.pressed[j])
        for along, one in zip(problem.along, self.system.springs, strict=True):
            found = found + one.energy(along @ q)
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
            states, modes = one.kept.states[: one.kept.counts[1]].T, self.modes.squares.size
            senses = one.kept.senses[: one.kept.counts[1]].T
            opened = senses == LIFTED
            rate = self.phases.chi @ states[1 + modes : 1 + 2 * modes] - self.problem.belt[:, np.newaxis]
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

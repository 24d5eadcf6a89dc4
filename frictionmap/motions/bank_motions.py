"""Motions of systems whose contacts are banks of elastic elements, under a record."""

from dataclasses import replace

import numpy as np

from .._kernels.banks.kept import Memory
from .._kernels.banks.problem import Cell, make_motion
from .._kernels.general.counts import COUNT_ROWS, STUCK
from .._kernels.general.problem import WIDTH
from .._kernels.general.record import make_record
from .._kernels.history.course import Course
from .._kernels.history.kept import Kept, make_kept
from .._kernels.phases.problem import COUNT_ROWS as BANK_ROWS
from .._kernels.phases.problem import STUCK as HELD
from ..banks.arrays import problem_of, row_of
from ..banks.given import banks_of
from ..banks.system import BankSystem
from ..phases.arrays import Modal
from .cells import Asked, Elements, Found, Kernels, Motions, Ran
from .channels import Drive
from .starts import Start
from .structure import Structure


def _used(terms: np.ndarray) -> int:
    """How many terms polynomials (K, D, terms) have without the last ones that are 0 in all, at least 2."""
    used = np.flatnonzero(terms.any(axis=(0, 1)))
    return max(2, int(used.max(initial=0)) + 1)


class BankMotions(Motions):
    """The motions of such a structure under one record."""

    def __init__(self, structure: Structure, drive: Drive) -> None:
        super().__init__(structure, drive)
        modal, walls = structure.modal, drive.base.sum(axis=1)
        contacts = [
            replace(one, moved=float(wall))
            for one, wall in zip(banks_of(structure.system.contact_system), walls, strict=True)
        ]
        self.contacts = tuple(contacts)
        system = BankSystem(modal.mass, modal.viscous, modal.stiffness, self.contacts)
        modes = Modal(modal.squares, modal.phi, modal.damping)
        found = problem_of(system, modes, np.zeros((0, system.n)))
        self.banks = found._replace(chi=self.problem.chi)
        self.row = row_of(system, self.banks, modes, 1.0)

    def _limits(self, beta: float) -> np.ndarray:
        """Elongations at which the elements slip, (E,)."""
        return np.concatenate([one.limits(np.array([beta]))[0] for one in self.contacts])

    def _memory(self, cell: Cell, stretch: np.ndarray, terms: int, scale: float) -> Memory:
        banks, channels = self.banks, self.problem.push.shape[1]
        size = float(self.problem.sizes[0]) * (abs(scale) or 1.0)
        return Memory(
            make_motion(banks, 0, BANK_ROWS, 0), self.row._replace(size=size), cell, stretch.copy(),
            self.problem.push, self.drive.base.any(axis=0).astype(float), np.array([terms]), np.ones(2),
            np.zeros(1, np.int64), np.zeros((channels, WIDTH)), np.zeros((channels, WIDTH)),
            np.zeros(banks.moved.size, np.int64), np.zeros((8, WIDTH)), np.full(banks.squares.size, np.inf),
        )  # fmt: skip

    def _kept(self, limits: np.ndarray, scale: float, room: np.ndarray) -> Kept:
        """Memory of the results of a motion; its states have two more numbers of every contact."""
        problem, contacts = self.problem, self.banks.moved.size
        most = np.add.reduceat(self.banks.spring * limits, self.banks.first[:-1])
        record = make_record(problem, np.empty((0, problem.squares.size)), 0)
        weights = self.watched.weights
        kept = make_kept(problem, weights, self.rounding_of(weights, most, scale), record, room)
        rows, columns = kept.states.shape
        return kept._replace(states=np.zeros((rows, columns + 2 * contacts)))

    def at(self, beta: float, mu: float, scale: float, asked: Asked, events: bool) -> Found:
        """Follow one motion; see `Motions.follow`."""
        bed = self.bed_after(scale)
        most = self._limits(beta)
        cell = Cell(most, np.zeros(self.banks.left.size))
        begin = np.zeros(most.size) if asked.start.stretch is None else asked.start.stretch
        begin = np.clip(begin, -most, most)

        def memory(course: Course, room: np.ndarray) -> tuple[Memory, Kept]:
            return self._memory(cell, begin, _used(course.pieces), scale), self._kept(most, scale, room)

        ran = self.run(asked, scale, events, Kernels(self.banks, cell, memory, lambda _: bed))
        found = self._ended(ran, scale, np.array((begin, ran.memory.stretch)))
        return found._replace(place=self._place(found))

    def _ended(self, ran: Ran, scale: float, stretch: np.ndarray) -> Found:
        """One motion without its place of rest."""
        contacts, motion, kept = self.banks.moved.size, ran.memory.motion, ran.kept
        counts = np.zeros((COUNT_ROWS, contacts))
        counts[STUCK] = motion.counts[HELD]
        own, stored, lost = np.split(kept.states, (-2 * contacts, -contacts), axis=1)
        there = min(int(kept.counts[1]), len(own))
        energy = 0.5 * (self.banks.spring * stretch**2).sum(axis=1)
        elements = Elements(stretch, energy, stored[:there].T, lost[:there].T)
        state = np.stack((motion.now.q, motion.now.p))
        kept = kept._replace(states=own)
        sense = ran.memory.before
        return Found(
            ran.status, scale, kept, counts, state, sense, ran.end, ran.asleep, None, None, elements
        )  # fmt: skip

    def energy(self, q: np.ndarray, p: np.ndarray, f: np.ndarray, one: Found, at: int | slice) -> np.ndarray:
        """Energy of masses and springs without those of the elements."""
        return np.asarray(0.5 * ((p**2).sum(axis=0) + self.problem.squares @ q**2))

    def energies_at_ends(self, one: Found, start: Start) -> tuple[float, float]:
        """Energy at the start and at the end."""
        assert one.elements is not None
        before, after = super().energies_at_ends(one, start)
        return before + float(one.elements.energy[0]), after + float(one.elements.energy[1])

    def energies(self, one: Found, states: np.ndarray, slider: np.ndarray) -> dict[str, np.ndarray]:
        """Energies at the states of one motion; what the elements lose is exact."""
        assert one.elements is not None
        found = super().energies(one, states, slider)
        stored = found["stored_energy"] + one.elements.stored.sum(axis=0)
        return found | {"stored_energy": stored, "lost_friction": one.elements.lost}

    def needed_friction(self, forces: np.ndarray) -> np.ndarray:
        """Friction with which no element slips, (N,): all are stretched alike, see `Bank.surplus`."""
        with np.errstate(divide="ignore", invalid="ignore"):  # an element without friction always slips
            needed = forces * np.array([one.surplus for one in self.contacts])
        return np.where(forces > 0.0, needed, 0.0)

    def further_scalars(self, one: Found) -> dict[str, np.ndarray]:
        """Elongations of the springs of the elements at the end."""
        assert one.elements is not None
        return {"elongation": one.elements.stretch[1]}

"""A steady motion at the points of integrals over a cycle."""

from dataclasses import dataclass

import numpy as np

from ..errors import NoSteadyState
from ..model.settings import Solver
from ..model.system import System
from ..phases.cycle import NODES, SECTION, TURN, WEIGHTS, Cycle, Points, in_contacts
from .given import bank_system, no_slip_limits, starts_of
from .motion import Steps, at_times, traces_at
from .solve import Found, find_motion


@dataclass(frozen=True)
class BankCycle(Cycle):
    """A steady motion of a system with banks: its steps differ in length."""

    found: Found  # type: ignore[assignment]  # the same names
    steps: Steps  # type: ignore[assignment]

    @property
    def shapes(self) -> np.ndarray:
        """Displacements of the masses, or of the points of a structure given by modes, by the modes."""
        return self.found.shapes

    def displacements(self, tau: np.ndarray, order: int = 0, row: int | slice = slice(None)) -> np.ndarray:
        """Displacements of the masses, or with `order` 1 their derivatives by tau; of one row or all."""
        found = at_times(self.steps, self.modal.squares.size, tau)
        return np.asarray(self.shapes[row] @ (found.rate if order else found.q))

    def points(self, highest: int) -> Points:
        """The motion at Gauss points that are dense enough for harmonics up to `highest`."""
        steps = self.steps
        own = steps.lengths * steps.ends
        many = max(1, int(np.ceil(highest * own.max() / TURN)))
        edges = ((np.arange(many)[:, np.newaxis] + 0.5 * (NODES + 1.0)) / many).ravel()
        weights = np.tile(0.5 * WEIGHTS / many, many) * own[:, np.newaxis]
        step = np.repeat(np.arange(own.size), edges.size)
        x = (steps.ends[:, np.newaxis] * edges).ravel()
        found = traces_at(steps, self.modal.squares.size, step, x)
        tau = SECTION + steps.begins[step] + x * steps.lengths[step]
        return Points(tau, weights.ravel(), found.q, found.rate, found.friction)


def find_cycle(system: System, r: float, beta: float, solver: Solver) -> BankCycle:
    """Find one steady motion.

    Raises
    ------
    NoSteadyState
        None was found.
    """
    limit = float(no_slip_limits(system, np.array([r]))[0])
    start = starts_of(system, np.array([r]), solver.start)[0]
    found = find_motion(bank_system(system, r), r, beta, limit, start, solver.cycles)
    if found.steps is None:
        raise NoSteadyState(
            f"r = {r:g}, beta = {beta:g}: no steady state was found in {int(found.numbers['cycles'])} "
            f"periods; raise solver.cycles"
        )
    return BankCycle(system, r, found, found.steps)


def stretch_at_maximum(cycle: BankCycle, beta: float) -> np.ndarray:
    """Elongations of the springs of the elements at tau = 0, (E,), from those at the section.

    In a step the motion in a contact has one sense, and an element follows it up to its limit.
    """
    found, steps, end = cycle.found, cycle.steps, 2.0 * np.pi - SECTION
    assert found.stretch is not None
    tau = SECTION + np.append(steps.begins[steps.begins < end], end)
    motion = at_times(steps, cycle.modal.squares.size, tau)
    z = in_contacts(cycle, found.problem.chi @ motion.q, tau)
    contacts = bank_system(cycle.system, cycle.r).contacts
    limit = np.concatenate([one.limits(np.array([beta]))[0] for one in contacts])
    many = np.diff(found.problem.first)
    stretch = found.stretch
    for way in np.diff(z, axis=1).T:
        stretch = np.clip(stretch + np.repeat(way, many), -limit, limit)
    return stretch

"""A steady motion at the points of integrals over a cycle."""

from typing import NamedTuple

import numpy as np

from ..errors import NoSteadyState
from ..model.settings import Solver
from ..model.system import System
from ..phases.arrays import Modal
from ..phases.cycle import SECTION, Points
from .given import bank_system, no_slip_limits, starts_of
from .motion import Steps, at_times, traces_at
from .solve import Found, find_motion

#: Gauss points of a part of a step, and the largest turn of a harmonic in a part: with these the integral of
#: a polynomial of the degree of a series times the harmonic is exact to rounding.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_TURN = 4.0


class BankCycle(NamedTuple):
    """A steady motion and the structure that it is of, with the names of `phases.cycle.Cycle`."""

    system: System
    r: float
    found: Found
    steps: Steps

    @property
    def modal(self) -> Modal:
        """Modes, (n, m) in `phi`."""
        return self.found.modes

    @property
    def period(self) -> int:
        """Periods of the load."""
        return self.found.period

    @property
    def drifts(self) -> bool:
        """Whether the motion is another one after each period: springs hold every structure here."""
        return False

    @property
    def begins(self) -> np.ndarray:
        """Times at which the steps begin."""
        return self.steps.begins

    def displacements(self, tau: np.ndarray, order: int = 0, row: int | slice = slice(None)) -> np.ndarray:
        """Displacements of the masses, or with `order` 1 their derivatives by tau; of one row or all."""
        found = at_times(self.steps, self.modal.squares.size, tau)
        return np.asarray(self.modal.phi[row] @ (found.rate if order else found.q))

    def points(self, highest: int) -> Points:
        """The motion at Gauss points that are dense enough for harmonics up to `highest`."""
        steps = self.steps
        own = steps.lengths * steps.ends
        many = max(1, int(np.ceil(highest * own.max() / _TURN)))
        edges = ((np.arange(many)[:, np.newaxis] + 0.5 * (_NODES + 1.0)) / many).ravel()
        weights = np.tile(0.5 * _WEIGHTS / many, many) * own[:, np.newaxis]
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

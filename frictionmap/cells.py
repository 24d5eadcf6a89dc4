"""What the cells of a map need, and the jobs that fill them: for one mass, and for any structure.

One mass is the structure with one mode, but its cells know more: a stop forgets all but one number.  They
have kernels of their own, an order of magnitude faster.
"""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ._kernels.cycle import Limits
from ._kernels.sweep import Frequencies, Outputs, fill_closed_form, fill_integrated
from .curves import Curves, many_mode_curves, one_mass_curves
from .settings import COEXISTENCE, DETAILS, Solver
from .system import System

Job = tuple[Callable[..., None], tuple]


def limits(solver: Solver) -> Limits:
    """When the kernels stop."""
    return Limits(float(solver.cycles), solver.tolerance, solver.steady == "solved")


class Cells(Protocol):
    """The cells of a system over (mu, r)."""

    curves: Curves
    no_load: np.ndarray  # (n_r,) where nothing loads the contact, so that nothing moves
    rest_sticks: bool  # a start from rest with beta >= beta_stick never begins to move

    def closed(self, first: int, last: int, low: np.ndarray, high: np.ndarray, out: Outputs) -> list[Job]:
        """Jobs for the cells of rows first..last-1 that formulas decide."""

    def opened(
        self, first: int, last: int, rows: np.ndarray, ends: np.ndarray, low: np.ndarray, out: Outputs,
        stop: np.ndarray,
    ) -> Job:  # fmt: skip
        """A job for cells first..last-1 of the list of open cells."""

    def reachable(self, out: Outputs, stop: np.ndarray) -> list[Job]:
        """Jobs for what else a cell could end in, if that was asked for."""

    def finish(self, out: Outputs) -> None:
        """What is left to do when all jobs are done."""


class OneMassCells:
    """Cells of a system with one mode of unit frequency."""

    rest_sticks = True

    def __init__(
        self, system: System, r: np.ndarray, beta: np.ndarray, mu: np.ndarray, solver: Solver
    ) -> None:
        self.found = one_mass_curves(system, r, mu)
        self.curves = self.found.curves
        self.no_load = self.found.frequencies.load == 0.0
        self._zeta, self._mu, self._beta, self._solver = system.zeta, mu, beta, solver

    def closed(self, first: int, last: int, low: np.ndarray, high: np.ndarray, out: Outputs) -> list[Job]:
        """See `Cells`."""
        found = self.found.frequencies
        return [(fill_closed_form, (first, last, low, high, self._beta, found, self._zeta, out))]

    def opened(
        self, first: int, last: int, rows: np.ndarray, ends: np.ndarray, low: np.ndarray, out: Outputs,
        stop: np.ndarray,
    ) -> Job:  # fmt: skip
        """See `Cells`."""
        solver = self._solver
        arguments = (
            first, last, rows, ends, low, self._beta, self._mu, self.found.lim, self.curves.beta_stick,
            self.found.frequencies, self._zeta, float(solver.steps), limits(solver),
            solver.start == "moving", out, stop,
        )  # fmt: skip
        return fill_integrated, arguments

    def reachable(self, out: Outputs, stop: np.ndarray) -> list[Job]:
        """See `Cells`."""
        return []

    def finish(self, out: Outputs) -> None:
        """See `Cells`."""


class StructureCells:
    """Cells of any structure."""

    rest_sticks = False  # what is not held may swing until the contact lets go

    def __init__(
        self, system: System, r: np.ndarray, beta: np.ndarray, mu: np.ndarray, solver: Solver
    ) -> None:
        from .structures import structures  # compiled for structures only

        self.curves = many_mode_curves(system, r, mu)
        self.no_load = (r == 0.0) & bool(system.base_motion)
        self.found = structures(system, r, self.curves)
        self.starts = self.found.moving if solver.start == "moving" else self.found.rest
        self._static = np.abs(system.modes.static_response())
        self._r, self._mu, self._beta, self._solver = r, mu, beta, solver

    def closed(self, first: int, last: int, low: np.ndarray, high: np.ndarray, out: Outputs) -> list[Job]:
        """See `Cells`."""
        from ._kernels.structure_sweep import fill_closed_details

        orbit = self.found.orbit
        ones = np.ones(self._r.size)
        found = Frequencies(
            self._r, ones, 0.0 * ones, orbit.v_abs, orbit.v_arg, orbit.u, orbit.g, self.found.marginal
        )
        jobs: list[Job] = [(fill_closed_form, (first, last, low, high, self._beta, found, 0.0, out))]
        if DETAILS & set(self._solver.outputs):
            f = self.found
            arguments = (
                first, last, low, high, self._beta, self._mu, self.curves.beta_lim, self._r, f.model, f.loads,
                orbit, f.shapes, f.alone_re, f.alone_im, f.held, float(self._solver.steps), out,
            )  # fmt: skip
            jobs.append((fill_closed_details, arguments))
        return jobs

    def reachable(self, out: Outputs, stop: np.ndarray) -> list[Job]:
        """See `Cells`."""
        if not COEXISTENCE & set(self._solver.outputs):
            return []
        from ._kernels.coexistence import fill_reachable

        f = self.found
        shape = (self._mu.size, self._r.size, self._beta.size)
        flags = out.also_reachable if out.also_reachable.size else np.zeros(shape, dtype=np.int8)
        far = out.sliding_limit if out.sliding_limit.size else np.empty(shape[:2])
        shared = (
            self._beta, self._mu, self.curves.beta_lim, self.curves.beta_stick, self._r, f.model, f.loads,
            f.orbit, f.marginal, f.rest, f.moving, float(self._solver.steps), limits(self._solver), flags,
            far, stop,
        )  # fmt: skip
        return [(fill_reachable, (row, row + 1, *shared)) for row in range(shape[0] * shape[1])]

    def opened(
        self, first: int, last: int, rows: np.ndarray, ends: np.ndarray, low: np.ndarray, out: Outputs,
        stop: np.ndarray,
    ) -> Job:  # fmt: skip
        """See `Cells`."""
        return self._follow, (first, last, rows, ends, low, out, stop)

    def _follow(
        self, first: int, last: int, rows: np.ndarray, ends: np.ndarray, low: np.ndarray, out: Outputs,
        stop: np.ndarray,
    ) -> None:  # fmt: skip
        from ._kernels.structure_sweep import ANCHOR, fill_details, fill_structures

        f = self.found
        where = (
            first, last, rows, ends, low, self._beta, self._mu, self.curves.beta_lim, self._r, f.model,
            f.loads,
        )  # fmt: skip
        steps = float(self._solver.steps)
        detailed = DETAILS & set(self._solver.outputs)
        shape = (last - first, ANCHOR + 2 * f.seen.size) if detailed else (0, 0)
        anchors = np.zeros(shape)
        fill_structures(
            *where, f.orbit, f.marginal, self.starts, steps, limits(self._solver), out, anchors, stop
        )
        if detailed and not stop[0]:
            fill_details(*where, f.orbit, f.shapes, f.alone_re, f.alone_im, f.held, steps, out, anchors)

    def finish(self, out: Outputs) -> None:
        """The limit r = 0 without friction; and modes that the contact does not see may resonate."""
        if out.amplitude.size:
            if self._beta[0] == 0.0:
                out.amplitude[:, self._r == 0.0, 0, :] = self._static
            where = np.broadcast_to(self.found.resonant[:, np.newaxis, :], out.amplitude.shape)
            out.amplitude[where & ~np.isnan(out.amplitude)] = np.inf


def make_cells(system: System, r: np.ndarray, beta: np.ndarray, mu: np.ndarray, solver: Solver) -> Cells:
    """The cells of a map; r, beta and mu are checked axes."""
    one = system.normalised and not (DETAILS | COEXISTENCE) & set(solver.outputs)
    return (OneMassCells if one else StructureCells)(system, r, beta, mu, solver)

"""Data that the cells of a map need, and the jobs that fill them.

One mass is the structure with one mode, but a stop leaves only one number of its state.  It is a kind of
motion of its own (`_kernels.engine`), ten times faster.
"""

from functools import cached_property
from typing import Any

import numpy as np

from .._kernels.engine.details import DetailResults, Details, Displacements
from .._kernels.engine.extremes import UncoupledResponse
from .._kernels.engine.fill import Axes, ClosedForm, OpenCells, fill_closed, fill_open
from .._kernels.engine.further import Common, NotRequested, Requested
from .._kernels.engine.many_masses import ManyMassSystem
from .._kernels.engine.one_mass import OneMassSystem
from .._kernels.engine.quantities import Quantities
from .._kernels.engine.records import Limits
from ..datasets.labels import CELL_VARIABLES
from ..jobs import Job
from ..model.settings import Solver
from ..model.system import System
from ..theory.boundary_curves import OneMass, many_mode_curves, one_mass_curves
from .kernel_data import StructureArrays, structure_arrays
from .quantity_data import QuantityRequest, quantity_arrays, results
from .quantity_limits import put_resonance, put_static

#: Periods of its fastest free motion for which a motion is followed, over the excitation periods `cycles`: at
#: low frequency an excitation period has very many of them.
_FREE_PERIODS = 4000.0

#: Outputs about the growth of a disturbance.
_EXPONENT = ("lyapunov_exponent", "lyapunov_exponent_error")


def limits(solver: Solver) -> Limits:
    """Convert the settings to the limits of the kernels."""
    steps = _FREE_PERIODS * solver.cycles * solver.steps
    return Limits(float(solver.cycles), solver.tolerance, solver.steady == "solved", steps)


class Cells:
    """Cells of a map of a system; r, beta and mu are checked axes."""

    def __init__(
        self, system: System, r: np.ndarray, beta: np.ndarray, mu: np.ndarray, solver: Solver,
        request: QuantityRequest | None = None,
    ) -> None:  # fmt: skip
        self._system, self._solver, self._request = system, solver, request
        self._axes = Axes(mu, r, beta)
        #: requested results over a cycle, filled by the jobs
        self.results = results(
            (mu.size, r.size, beta.size), system.n, request or QuantityRequest(frozenset())
        )
        self._one: OneMass | None = None
        if system.normalised:
            self._one = one_mass_curves(system, r, mu)
            self.curves = self._one.curves
            #: (n_r,) whether the contact carries no load, so that nothing moves
            self.no_load = self._one.frequencies.load == 0.0
        else:
            self.curves = many_mode_curves(system, r, mu)
            self.no_load = (r == 0.0) & bool(system.base_motion)

    @cached_property
    def _needs(self) -> set[str]:
        needs = {CELL_VARIABLES[name].needs for name in self._solver.outputs}
        return needs | {"details"} if "exponent" in needs else needs

    @property
    def kept(self) -> tuple[str, ...]:
        """Outputs that are computed: the requested ones, `status`, and those that others are made from."""
        made_from = ("period", "cycles", "multiplier", *_EXPONENT) if "exponent" in self._needs else ()
        return (*self._solver.outputs, "status", *made_from)

    @property
    def rest_sticks(self) -> bool:
        """Whether a start from rest never begins to slide at or above beta_stick; masses that are not held
        may move.
        """
        return self._one is not None

    @cached_property
    def structure_arrays(self) -> StructureArrays:
        """The system as the arrays of a structure."""
        return structure_arrays(self._system, self._axes.r, self.curves)

    @cached_property
    def motion(self) -> OneMassSystem | ManyMassSystem:
        """The system as a kind of motion."""
        steps = float(self._solver.steps)
        if self._one is not None:
            system = self._system
            return OneMassSystem(
                self._one.frequencies, system.zeta, steps, self._one.lim, self.curves.beta_stick, 1,
                float(system.modes.chi[0]),
            )  # fmt: skip
        f = self.structure_arrays
        return ManyMassSystem(
            self._axes.r, f.model, f.loads, f.orbit, f.marginal, f.rest, f.moving, steps,
            self.curves.beta_lim, f.participating.size,
        )  # fmt: skip

    @cached_property
    def _closed_form(self) -> ClosedForm:
        if self._one is not None:
            f = self._one.frequencies
            return ClosedForm(f.load, f.v_abs, f.u, f.g, f.marginal)
        orbit = self.structure_arrays.orbit
        return ClosedForm(
            np.ones(self._axes.r.size), orbit.v_abs, orbit.u, orbit.g, self.structure_arrays.marginal
        )

    @property
    def unit(self) -> float:
        """Unit of forces and displacements of the motion at the only frequency."""
        return float(self._closed_form.load[0])

    @cached_property
    def common(self) -> Common:
        """Data that further outputs share."""
        f = self.structure_arrays
        return Common(self._axes.r, f.model, f.loads, f.orbit, float(self._solver.steps))

    @cached_property
    def quantities(self) -> Quantities:
        """Data for the requested quantities of a cycle."""
        assert self._request is not None
        return quantity_arrays(self._system, self._axes.r, self.structure_arrays, self._request, self.results)

    def _requested(self, out: Any) -> Requested:
        """The further outputs that are requested, with the arrays for their results."""
        details: Details | NotRequested = NotRequested(0)
        if "details" in self._needs:
            f = self.structure_arrays
            parts = Displacements(f.outputs, UncoupledResponse(f.uncoupled, f.uncoupled), f.held)
            arrays = DetailResults(out.amplitude, out.multiplier, out.asymmetry)
            details = Details(self._axes.mu, parts, arrays)
        quantities = NotRequested(0) if self._request is None else self.quantities
        nothing = isinstance(details, NotRequested) and isinstance(quantities, NotRequested)
        return Requested(NotRequested(0) if nothing else self.common, details, quantities)

    def closed(self, first: int, last: int, cells: OpenCells, out: Any) -> Job:
        """Job for the cells of rows first..last-1 that closed forms decide."""
        return fill_closed, (first, last, cells, self._axes, self._closed_form, out, self._requested(out))

    def opened(self, first: int, last: int, cells: OpenCells, out: Any, cancel: np.ndarray) -> Job:
        """Job for cells first..last-1 of the list of open cells."""
        moving = self._solver.start == "moving"
        return fill_open, (
            first, last, cells, self._axes, self.motion, limits(self._solver), moving, out,
            self._requested(out), cancel,
        )  # fmt: skip

    def reachable(self, out: Any, cancel: np.ndarray) -> list[Job]:
        """Jobs for the further regimes that cells can reach, if requested."""
        if "coexistence" not in self._needs:
            return []
        from .._kernels.engine.coexistence import fill_reachable

        axes = self._axes
        shared = (
            axes, self.curves.beta_lim, self.curves.beta_stick, self.no_load, self.motion,
            limits(self._solver), out, cancel,
        )  # fmt: skip
        return [(fill_reachable, (row, row + 1, *shared)) for row in range(axes.mu.size * axes.r.size)]

    def exponents(self, out: Any, cancel: np.ndarray) -> list[Job]:
        """Jobs for the exponents of irregular motions, if requested, when all cells are filled."""
        if "exponent" not in self._needs:
            return []
        from .._kernels.engine.exponents import fill_exponents

        moves = self._solver.start == "moving"
        starts = self.structure_arrays.moving if moves else self.structure_arrays.rest
        rows = range(self._axes.mu.size * self._axes.r.size)
        return [(fill_exponents, (row, self._axes, self.common, starts, moves, out, cancel)) for row in rows]

    def finish(self, out: Any) -> None:
        """Fill what arrays give: exponents of steady states, r = 0 without friction, resonances elsewhere."""
        axes = self._axes
        if out.lyapunov_exponent.size:
            returns = (out.period > 0) & ~np.isnan(out.multiplier)
            with np.errstate(divide="ignore"):
                out.lyapunov_exponent[returns] = np.log(out.multiplier[returns]) / out.period[returns]
            out.lyapunov_exponent_error[returns] = 0.0
        if out.amplitude.size:
            if axes.beta[0] == 0.0:
                static = np.abs(self._system.modes.static_response())
                out.amplitude[:, axes.r == 0.0, 0, :] = static
            where = np.broadcast_to(self.structure_arrays.resonant[:, np.newaxis, :], out.amplitude.shape)
            out.amplitude[where & ~np.isnan(out.amplitude)] = np.inf
        if self._request is not None:
            put_resonance(self._system, axes.r, self.structure_arrays.resonant, self.results)
            if axes.r[0] == 0.0:
                static = put_static(self._system, axes.beta, out.status[:, 0], self.results)
                if out.contact_amplitude.size:
                    out.contact_amplitude[:, 0] = np.where(
                        np.isnan(static), out.contact_amplitude[:, 0], static
                    )

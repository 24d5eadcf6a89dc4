"""The engine of contacts that open and of piecewise linear springs: the stiffness changes with the motion."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from ..jobs import Progress, Watch
from ..model.general import refuse_phases
from ..model.settings import CurveSettings, Solver
from ..model.sizes import Sizes, Wanted
from .interface import FollowingEngine, Limits

if TYPE_CHECKING:
    import xarray as xr

    from ..single.points import States


class PhasesEngine(FollowingEngine):
    """Contacts that open, and piecewise linear springs.

    Other questions are refused here, and by `refuse_phases` where no engine is asked.
    """

    @property
    def kernels(self) -> str:
        return "phases"

    @property
    def least_ratio(self) -> float:
        from ..phases.given import least_ratio

        return least_ratio(self.system)

    @property
    def outputs(self) -> tuple[str, ...]:
        from ..phases.quantities import TABLE

        return tuple(TABLE)

    @property
    def bytes_per_cell(self) -> float:
        general = self.system.contact_system
        values = 40 * general.count + 10 * self.system.n + 10 * len(general.springs)
        return 8.0 * values

    def _refuse(self, what: str) -> NoReturn:
        refuse_phases(self.system, what)
        raise AssertionError  # every system of this engine is refused

    def needed_friction(self, r: np.ndarray) -> np.ndarray:
        self._refuse("compute the friction that each contact needs")  # it depends on mu

    def no_stop_limit(self, r: np.ndarray, mu: float, watch: Watch | None) -> np.ndarray:
        self._refuse("find friction without stops")

    def limits(self, r: np.ndarray, mu: np.ndarray, watch: Watch | None = None) -> Limits:
        from ..general.normal_limits import no_slip_friction

        self.check_static(mu)
        count = self.system.contact_system.count
        none = np.full((mu.size, r.size, 1), np.nan)
        stick = no_slip_friction(self.system, r, mu)
        each = np.repeat(stick[..., np.newaxis] if count == 1 else none, count, axis=-1)
        return Limits(none[..., 0], stick, each, none, none)

    def boundaries(self, r: np.ndarray, mu: np.ndarray) -> "xr.Dataset":
        from ..general.normal_limits import normal_boundaries

        self.check_static(mu)
        return normal_boundaries(self.system, r, mu)

    def map(
        self, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None, progress: Progress | None,
        watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..phases.dataset import phase_map

        return phase_map(self.system, axes, solver, threads, progress, watch)

    def cells(
        self, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver, threads: int | None,
        progress: Progress | None, watch: Watch | None, searched: bool = True,
    ) -> tuple[dict[str, np.ndarray], Limits]:  # fmt: skip
        from ..phases.dataset import solve_cells

        wanted = tuple(dict.fromkeys(("regime", "contact_regime", *names)))
        limits = self.limits(axes["r"], axes["mu"], watch)
        return solve_cells(self.system, axes, wanted, solver, threads, progress, watch), limits

    def curves(
        self, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
        progress: Progress | None, watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..phases.curves import phase_curves

        return phase_curves(self.system, axes, solver, asked, progress, watch)

    def motion(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> "xr.Dataset":
        from ..phases.response import phase_response

        return phase_response(self.system, r, beta, mu, solver, points)

    @property
    def sizes(self) -> tuple[str, ...]:
        from ..phases.responses import QUANTITIES

        return QUANTITIES

    def sizes_on_grid(
        self, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int, watch: Watch | None
    ) -> Sizes:
        from ..phases.responses import sizes_on_grid

        return sizes_on_grid(self.system, wanted, axes, solver, threads, watch)

    def sizes_at(
        self, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
        watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        from ..phases.responses import sizes_at

        return sizes_at(self.system, wanted, r, beta, mu, solver, threads, watch)

    def states(self, r: np.ndarray, beta: np.ndarray, mu: float) -> "list[States]":
        self._refuse("compute first harmonics at points")

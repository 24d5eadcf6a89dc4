"""The engine of any number of contacts, springs in contacts, belts and periodic loads."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..general.boundaries import INTERVALS, Boundaries, find_boundaries
from ..general.held import least_static_friction
from ..general.problem import least_ratio
from ..jobs import Progress, Watch
from ..model.settings import CurveSettings, Solver
from ..model.sizes import Sizes, Wanted
from .interface import FollowingEngine, Limits, Motion, traced_motion

if TYPE_CHECKING:
    import xarray as xr

    from ..single.points import States


def _limits(found: Boundaries) -> Limits:
    return Limits(found.beta_lim, found.beta_stick, found.beta_stick_contact, found.begins, found.ends)


class GeneralEngine(FollowingEngine):
    """Any piecewise linear system: its motion is followed from a phase of the load to the next return."""

    intervals = INTERVALS

    @property
    def kernels(self) -> str:
        return "general"

    @property
    def least_ratio(self) -> float:
        return least_ratio(self.system)

    @property
    def outputs(self) -> tuple[str, ...]:
        from ..general.outputs import TABLE

        return tuple(TABLE)

    @property
    def bytes_per_cell(self) -> float:
        from ..general.outputs import allocate

        one = allocate((1, 1, 1), self.system.contact_system.count, self.system.n)
        return float(sum(table.nbytes for table in one))

    def needed_friction(self, r: np.ndarray) -> np.ndarray:
        return least_static_friction(self.system, r)

    def no_stop_limit(self, r: np.ndarray, mu: float, watch: Watch | None) -> np.ndarray:
        return find_boundaries(self.system, r, np.array([mu]), watch=watch, intervals=1).beta_lim[0]

    def limits(self, r: np.ndarray, mu: np.ndarray, watch: Watch | None = None) -> Limits:
        self.check_static(mu)
        return _limits(find_boundaries(self.system, r, mu, watch=watch))

    def known_limits(self, r: np.ndarray, mu: np.ndarray) -> Limits:
        self.check_static(mu)
        return _limits(find_boundaries(self.system, r, mu, searched=False))

    def boundaries(self, r: np.ndarray, mu: np.ndarray) -> "xr.Dataset":
        from ..general.dataset import general_boundaries

        return general_boundaries(self.system, r, mu)

    def map(
        self, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None, progress: Progress | None,
        watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..general.dataset import general_map

        return general_map(self.system, axes, solver, threads, progress, watch)

    def cells(
        self, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver, threads: int | None,
        progress: Progress | None, watch: Watch | None, searched: bool = True,
    ) -> tuple[dict[str, np.ndarray], Limits]:  # fmt: skip
        from ..general.dataset import cell_arrays

        self.check_static(axes["mu"])
        wanted = tuple(dict.fromkeys(("regime", "contact_regime", *names)))
        found, limits = cell_arrays(self.system, axes, wanted, solver, threads, progress, watch, searched)
        return found, _limits(limits)

    def curves(
        self, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
        progress: Progress | None, watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..general.curves import general_curves

        def report(done: int, total: int) -> None:
            if watch is not None:
                watch()
            if progress is not None:
                progress(done, total)

        return general_curves(self.system, axes, solver, asked, report)

    def motion(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> "xr.Dataset":
        from ..general.response import general_response

        return general_response(self.system, r, beta, mu, solver, points)[0]

    def traced(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> Motion:
        """Without a second search for the boundaries."""
        from ..general.response import general_response

        ds, found = general_response(self.system, r, beta, mu, solver, points)
        return traced_motion(ds, _limits(found))

    @property
    def sizes(self) -> tuple[str, ...]:
        from ..general.responses import QUANTITIES

        return QUANTITIES

    def sizes_on_grid(
        self, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int, watch: Watch | None
    ) -> Sizes:
        from ..general.responses import sizes_on_grid

        return sizes_on_grid(self.system, wanted, axes, solver, threads, watch)

    def sizes_at(
        self, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
        watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        from ..general.responses import sizes_at

        return sizes_at(self.system, wanted, r, beta, mu, solver, threads, watch)

    def states(self, r: np.ndarray, beta: np.ndarray, mu: float) -> "list[States]":
        from ..general.first_harmonics import steady_phasors
        from ..single.points import States

        return [States(*steady_phasors(self.system, r, beta))]

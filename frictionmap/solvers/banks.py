"""The engine of banks of elastic elements, each bank one contact."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from ..jobs import Progress, Watch
from ..model.general import refuse_banks
from ..model.settings import CurveSettings, Solver
from ..model.sizes import Sizes, Wanted
from .interface import FollowingEngine, Limits

if TYPE_CHECKING:
    import xarray as xr

    from ..single.points import States


class BanksEngine(FollowingEngine):
    """Contacts of one elastic element or more.

    Other questions are refused here, and by `refuse_banks` where no engine is asked.
    """

    @property
    def kernels(self) -> str:
        return "banks"

    @property
    def least_ratio(self) -> float:
        from ..banks.given import least_ratio

        return least_ratio(self.system)

    @property
    def outputs(self) -> tuple[str, ...]:
        from ..banks.dataset import TABLE

        return TABLE

    @property
    def bytes_per_cell(self) -> float:
        general = self.system.contact_system
        return 8.0 * (40 * general.count + 10 * self.system.n)

    def _refuse(self, what: str) -> NoReturn:
        refuse_banks(self.system, what)
        raise AssertionError  # every system of this engine has a bank

    def needed_friction(self, r: np.ndarray) -> np.ndarray:
        from ..banks.given import needed_friction

        return needed_friction(self.system, r)

    def no_stop_limit(self, r: np.ndarray, mu: float, watch: Watch | None) -> np.ndarray:
        self._refuse("find friction without stops")

    def limits(self, r: np.ndarray, mu: np.ndarray, watch: Watch | None = None) -> Limits:
        from ..general.held import stick_scales

        self.check_static(mu)
        each = stick_scales(self.system.contact_system, self.needed_friction(r), mu)
        none = np.full((mu.size, r.size, 1), np.nan)
        return Limits(none[..., 0], each.max(axis=2), each, none, none)

    def boundaries(self, r: np.ndarray, mu: np.ndarray) -> "xr.Dataset":
        from ..banks.dataset import bank_boundaries

        return bank_boundaries(self.system, r, mu)

    def map(
        self, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None, progress: Progress | None,
        watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..banks.dataset import bank_map

        return bank_map(self.system, axes, solver, threads, progress, watch)

    def cells(
        self, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver, threads: int | None,
        progress: Progress | None, watch: Watch | None, searched: bool = True,
    ) -> tuple[dict[str, np.ndarray], Limits]:  # fmt: skip
        from ..banks.dataset import solve_cells

        wanted = tuple(dict.fromkeys(("regime", "contact_regime", *names)))
        limits = self.limits(axes["r"], axes["mu"], watch)
        return solve_cells(self.system, axes, wanted, solver, threads, progress, watch), limits

    def curves(
        self, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
        progress: Progress | None, watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..banks.curves import bank_curves

        return bank_curves(self.system, axes, solver, asked, progress, watch)

    def motion(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> "xr.Dataset":
        from ..banks.response import bank_response

        return bank_response(self.system, r, beta, mu, solver, points)

    @property
    def sizes(self) -> tuple[str, ...]:
        from ..banks.responses import QUANTITIES

        return QUANTITIES

    def sizes_on_grid(
        self, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int, watch: Watch | None
    ) -> Sizes:
        from ..banks.responses import sizes_on_grid

        return sizes_on_grid(self.system, wanted, axes, solver, threads, watch)

    def sizes_at(
        self, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
        watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        from ..banks.responses import sizes_at

        return sizes_at(self.system, wanted, r, beta, mu, solver, threads, watch)

    def states(self, r: np.ndarray, beta: np.ndarray, mu: float) -> "list[States]":
        self._refuse("compute first harmonics at points")

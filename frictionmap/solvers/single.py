"""The engine of one rigid contact under one harmonic load."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .. import regimes
from ..datasets.labels import PER_CONTACT
from ..jobs import Progress, Watch
from ..model.general import in_general_form
from ..model.settings import OUTPUTS, RECORDED, CurveSettings, GeneralOutput, Solver
from ..model.sizes import Sizes, Wanted
from ..theory.boundary_curves import Curves, find_curves, least_ratio
from .interface import OF_CONTACTS, Engine, Limits, Motion

if TYPE_CHECKING:
    import xarray as xr

    from ..single.points import States


def _limits(curves: Curves) -> Limits:
    """Boundaries of the only contact; there are no further intervals without stops."""
    none = np.empty((*curves.beta_lim.shape, SingleEngine.intervals))
    return Limits(curves.beta_lim, curves.beta_stick, curves.beta_stick[..., np.newaxis], none, none)


def _split(solver: Solver) -> tuple[Solver, tuple[GeneralOutput, ...]]:
    """The settings without the outputs that the other engine records, and these."""
    recorded = tuple(name for name in RECORDED if name in solver.outputs)
    own = tuple(name for name in solver.outputs if name not in recorded)
    return (replace(solver, outputs=own or ("status",)) if recorded else solver), recorded


class SingleEngine(Engine):
    """One rigid contact under one harmonic load: closed forms, and mirrored slides."""

    has_closed_limits = True
    intervals = 0  # beta_lim is the end of the only one
    states_status = False
    compares_starts = True
    order_step = 2  # its friction is antiperiodic

    @property
    def kernels(self) -> str:
        return "one" if self.system.normalised else "structure"

    @property
    def least_ratio(self) -> float:
        return least_ratio(self.system)

    @property
    def least_stick_ratio(self) -> float:
        return least_ratio(self.system)

    def check_static(self, mu: np.ndarray) -> None:
        """Any mu >= 1 is possible."""

    @property
    def outputs(self) -> tuple[str, ...]:
        return OUTPUTS

    @property
    def bytes_per_cell(self) -> float:
        return 0.0

    def needed_friction(self, r: np.ndarray) -> np.ndarray:
        return find_curves(self.system, r, np.array([1.0])).beta_stick[0][:, np.newaxis]

    def no_stop_limit(self, r: np.ndarray, mu: float, watch: Watch | None) -> np.ndarray:
        return find_curves(self.system, r, np.array([mu])).beta_lim[0]

    def limits(self, r: np.ndarray, mu: np.ndarray, watch: Watch | None = None) -> Limits:
        return _limits(find_curves(self.system, r, mu))

    def boundaries(self, r: np.ndarray, mu: np.ndarray) -> "xr.Dataset":
        from ..theory.boundaries import one_contact_boundaries

        return one_contact_boundaries(self.system, r, mu)

    def map(
        self, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None, progress: Progress | None,
        watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..single.dataset import single_map

        own, recorded = _split(solver)
        ds = single_map(self.system, axes, own, threads, progress, watch)
        return self._with_recorded(ds, axes, solver, recorded, threads, watch)

    def _with_recorded(
        self, ds: "xr.Dataset", axes: Mapping[str, np.ndarray], solver: Solver,
        recorded: tuple[GeneralOutput, ...], threads: int | None, watch: Watch | None,
    ) -> "xr.Dataset":  # fmt: skip
        """Add outputs that the other engine records; `axes` of one cell for a dataset of one cell."""
        if not recorded:
            return ds
        from .general import GeneralEngine

        twin = GeneralEngine(in_general_form(self.system))
        found = twin.map(axes, replace(solver, outputs=recorded), threads, None, watch)
        if "beta" not in ds.dims:
            found = found.isel(mu=0, r=0, beta=0, drop=True)
        return ds.assign({name: found[name].variable for name in recorded}).assign_coords(
            {name: found[name] for name in ("dof",) if name in found.coords}
        )

    def cells(
        self, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver, threads: int | None,
        progress: Progress | None, watch: Watch | None, searched: bool = True,
    ) -> tuple[dict[str, np.ndarray], Limits]:  # fmt: skip
        """Without labels, whose library takes longer to import than a page to show its first map."""
        from ..single.maps import solve_map

        settings = replace(solver, outputs=tuple(dict.fromkeys(("regime", *names))))  # type: ignore[arg-type]
        found, curves = solve_map(self.system, axes, settings, threads, progress, watch)
        found["contact_regime"] = found["regime"]
        for name in (*names, "contact_regime"):
            if name in PER_CONTACT:
                found[name] = found[name][..., np.newaxis]
        return found, _limits(curves)

    def curves(
        self, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
        progress: Progress | None, watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        from ..single.curves import single_curves

        recorded = tuple(name for name in asked.quantities if name in RECORDED)
        own = tuple(name for name in asked.quantities if name not in recorded)
        ds = single_curves(
            self.system, axes, solver, replace(asked, quantities=own), threads, progress, watch
        )
        grid = {name: axes[name] for name in ("mu", "r", "beta")}
        return self._with_recorded(ds, grid, solver, recorded, threads, watch)

    def motion(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> "xr.Dataset":
        from ..single.response import single_response

        own, recorded = _split(solver)
        ds = single_response(self.system, r, beta, mu, own, points)
        axes = {"mu": np.array([mu]), "r": np.array([r]), "beta": np.array([beta])}
        return self._with_recorded(ds, axes, solver, recorded, 1, None)

    def traced(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> Motion:
        """Without labels, as `cells`, and without the outputs of a map, which would take as long again."""
        from ..single.motion import MotionRequest, find_motion

        settings = replace(solver, outputs=("regime",))
        found = find_motion(MotionRequest(self.system, r, beta, mu, settings, points))
        history = found.history
        traces = {name: getattr(history, name) for name in ("tau", "x", "v", "z", "friction", "direction")}
        values = traces | found.cycle | {name: np.array(value) for name, value in found.summary.items()}
        values["contact_regime"] = values["regime"]
        of_contact = {name: value[np.newaxis] for name, value in values.items() if name in OF_CONTACTS}
        return Motion(values | of_contact, _limits(found.curves), found.comment)

    @property
    def sizes(self) -> tuple[str, ...]:
        from ..single.responses import QUANTITIES

        return QUANTITIES

    def sizes_on_grid(
        self, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int, watch: Watch | None
    ) -> Sizes:
        from ..single.responses import sizes_on_grid

        found = sizes_on_grid(self.system, wanted, axes, solver, threads, watch)
        at = np.broadcast_arrays(axes["r"][:, np.newaxis], axes["beta"])
        return self._with_irregular(found, wanted, at, axes["mu"], solver, threads, watch)

    def sizes_at(
        self, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
        watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        from ..single.responses import sizes_at

        found = sizes_at(self.system, wanted, r, beta, mu, solver, watch)
        return self._with_irregular(found, wanted, (r, beta), np.array([mu]), solver, threads, watch)

    def _with_irregular(
        self, found: Sizes, wanted: Wanted, at: Sequence[np.ndarray], mu: np.ndarray, solver: Solver,
        threads: int, watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        """Sizes with the largest amplitudes of masses in irregular motions, which the other engine keeps."""
        which = np.isnan(found.size) & (found.status == regimes.IRREGULAR)
        if wanted.quantity != "amplitude" or not which.any():
            return found
        from .general import GeneralEngine

        twin = GeneralEngine(in_general_form(self.system))
        axes = {"mu": mu, "r": at[0][which], "beta": at[1][which][:, np.newaxis]}
        size = found.size.copy()
        size[which] = twin.sizes_on_grid(wanted, axes, solver, threads, watch).size[:, 0]
        return found._replace(size=size)

    def states(self, r: np.ndarray, beta: np.ndarray, mu: float) -> "list[States]":
        from ..single.points import possible_states

        return possible_states(self.system, r, beta, mu)

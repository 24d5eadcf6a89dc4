"""Response curves, cell by cell."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..general.dataset import refuse_static
from ..jobs import Progress, Watch
from ..model.settings import CurveSettings, Solver
from ..model.system import System
from ..phases.curves import check_quantities, curve_dataset
from ..phases.cycle import Cycle
from .cycle import find_cycle
from .dataset import limit_variables
from .given import check_ratios


def bank_curves(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Compute response curves over the axes mu, r and beta; see `curves`."""
    check_quantities(asked, "a bank as one contact")
    refuse_static(system.contact_system, axes["mu"])
    check_ratios(system, axes["r"])

    def find(i: int, beta: float, _: float) -> Cycle:
        return find_cycle(system, float(axes["r"][i]), beta, solver)

    limits = limit_variables(system, axes["r"])
    return curve_dataset(system, axes, asked, find, limits, progress, watch)

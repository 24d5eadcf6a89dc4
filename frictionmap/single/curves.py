"""Response curves: variables of all cells, and those over frequency alone."""

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from ..datasets.labels import OLDER_NAMES
from ..datasets.variables import coordinate, label_variable
from ..jobs import Progress, Watch
from ..model.settings import CurveSettings, Output, Solver
from ..model.system import System
from ..theory.boundaries import boundary_variables, held_variables
from ..theory.boundary_curves import Curves
from ..theory.limit_curves import limit_variables
from .maps import compute
from .quantity_data import VARIABLES, quantity_request, read_result

#: Outputs of every cell.
_ALWAYS: tuple[Output, ...] = ("regime", "stops_per_cycle", "period", "status")


def plain_outputs(asked: CurveSettings) -> list[Output]:
    """Outputs that curves share with maps."""
    amplitude: list[Output] = ["contact_amplitude"] if "amplitude" in asked.quantities else []
    return [*_ALWAYS, *amplitude]


def cycle_variables(asked: CurveSettings) -> list[str]:
    """Variables that are read from the results over a cycle; the others are recorded, see `RECORDED`."""
    return [name for quantity in asked.quantities for name in VARIABLES.get(quantity, ())]


def older_names(names: Collection[str]) -> dict[str, str]:
    """Older names under which some of these variables are stored as well, with the current ones."""
    return {old: new for old, new in OLDER_NAMES["curves"].items() if new in names}


def _over_frequency(system: System, axes: Mapping[str, np.ndarray], found: Curves) -> dict[str, xr.Variable]:
    """Variables that do not depend on beta: responses with the contact held, and motions on the boundary."""
    held = held_variables(system, axes["r"])
    turned = {name: label_variable(name, value.values.T, "curves") for name, value in held.items()}
    return turned | limit_variables(system, axes["r"], axes["mu"], found)


def _variables(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> dict[str, xr.Variable]:  # fmt: skip
    """Compute the variables of `curves` over the axes mu, r and beta; `watch` may end the computation."""
    basic, names = plain_outputs(asked), cycle_variables(asked)
    settings = replace(solver, outputs=basic)
    cells, out = compute(
        system, axes, settings, quantity_request(names, asked.harmonics), threads, progress, watch
    )
    values: dict[str, np.ndarray] = {name: getattr(out, name) for name in basic}
    values |= {name: read_result(name, cells.results) for name in names}
    values |= {old: values[new] for old, new in older_names(names).items()}
    variables = {name: label_variable(name, value, "curves") for name, value in values.items()}
    return variables | boundary_variables(cells.curves) | _over_frequency(system, axes, cells.curves)


def single_curves(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Response curves over the axes mu, r and beta, with the coordinates `axes`; see `steady.curves`."""
    coords = {name: coordinate(name, values) for name, values in axes.items()}
    return xr.Dataset(_variables(system, axes, solver, asked, threads, progress, watch), coords=coords)

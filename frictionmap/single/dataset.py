"""Maps as labelled variables."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..datasets.labels import GENERAL_VARIABLES
from ..datasets.variables import indexed, label_variable
from ..errors import InputError
from ..jobs import Progress, Watch
from ..model.settings import Solver
from ..model.system import System
from ..theory.boundaries import boundary_variables
from .maps import solve_map


def single_map(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None,
    progress: Progress | None, watch: Watch | None = None,
) -> xr.Dataset:  # fmt: skip
    """Compute outputs, `status` and boundaries over the axes mu, r and beta."""
    only = [name for name in solver.outputs if name in GENERAL_VARIABLES]
    if only:
        raise InputError(
            f"cannot compute {only[0]} for one rigid contact under one harmonic load: it needs contacts, "
            f"load_harmonics, wall_velocity, normal_load or contact_stiffness; omit it"
        )
    found, curves = solve_map(system, axes, solver.of_cells, threads, progress, watch)
    variables = {name: label_variable(name, values) for name, values in found.items()}
    sizes = {"dof": np.array(system.dofs.numbers)} if "amplitude" in solver.outputs else {}
    return xr.Dataset(
        variables | boundary_variables(curves, solver.outputs), coords=indexed({**axes, **sizes})
    )

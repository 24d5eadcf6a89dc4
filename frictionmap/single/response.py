"""One steady state in time, as labelled variables."""

from dataclasses import replace

import numpy as np
import xarray as xr

from ..datasets.labels import CELL_VARIABLES, OLDER_NAMES
from ..datasets.variables import coordinate, label_variable
from ..model.settings import HARMONICS, Output, Solver
from ..model.system import System
from ..theory.boundaries import boundary_variables
from .dataset import single_map
from .motion import MotionRequest, find_motion
from .quantity_data import PARTS


def _further(request: MotionRequest, names: list[Output]) -> dict[str, xr.Variable]:
    """Compute outputs of the cell of a map that do not follow from the motion in time."""
    if not names:
        return {}
    axes = {name: np.array([getattr(request, name)]) for name in ("mu", "r", "beta")}
    ds = single_map(request.system, axes, replace(request.solver, outputs=names), 1, None)
    cell = ds.isel(mu=0, r=0, beta=0, missing_dims="ignore")
    return {name: cell[name].variable for name in names}


def single_response(
    system: System, r: float, beta: float, mu: float, solver: Solver, points: int
) -> xr.Dataset:
    """The steady state of a cell in time; see `steady.response`."""
    request = MotionRequest(system, r, beta, mu, solver.of_cells, points)
    found = find_motion(request)
    history, cycle = found.history, found.cycle
    times, begins, places = history.events
    variables = {
        "x": history.x,
        "v": history.v,
        "z": history.z,
        "friction": history.friction,
        "direction": history.direction,
        "event_tau": times,
        "event_direction": begins.astype(np.int8),
        "event_z": places,
    }
    variables |= {old: variables[new] for old, new in OLDER_NAMES["response"].items()}
    # what a map is asked for comes from its kernels below, to the bit
    variables |= {name: value for name, value in cycle.items() if name not in solver.outputs}
    own: dict[str, np.ndarray | float] = {
        "tau": history.tau,
        "dof": np.array(system.dofs.numbers),
        "harmonic": np.arange(HARMONICS + 1),
        "part": PARTS,
    }
    labelled = {name: label_variable(name, values) for name, values in variables.items()}
    labelled |= {name: v[0, 0] for name, v in boundary_variables(found.curves, solver.outputs).items()}
    labelled |= {
        name: label_variable(name, CELL_VARIABLES[name].dtype(value)) for name, value in found.summary.items()
    }
    labelled |= _further(request, [name for name in solver.outputs if name not in labelled])  # type: ignore[misc]
    own |= {"r": r, "beta": beta, "mu": mu}
    coords = {name: coordinate(name, values) for name, values in own.items()}
    ds = xr.Dataset(labelled, coords=coords)  # all at once: piece by piece took a third of the time
    return ds.assign_attrs(comment=found.comment) if found.comment else ds

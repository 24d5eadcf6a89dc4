"""Boundaries and maps as labelled variables."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.variables import coordinate, label_variable, mass_coordinates
from ..general.dataset import chosen_outputs, contact_coordinates, refuse_static
from ..general.outputs import depends_on_places, is_of_masses
from ..jobs import Progress, Watch
from ..model.settings import Solver
from ..model.system import System
from ..phases.dataset import OF_NORMAL, OF_SPRINGS, has_output, labelled
from ..phases.quantities import TABLE as PHASES
from .given import bank_system, changes_with_r, check_ratios, no_slip_limits, starts_of
from .solve import Ratios, sweep_banks

#: Outputs on offer: those of elastic contacts, and those whose place they take.
TABLE = tuple(
    name for name in PHASES if name not in (*OF_NORMAL, *OF_SPRINGS, "turns_per_cycle", "work_wall")
)


def limit_variables(system: System, r: np.ndarray) -> dict[str, xr.Variable]:
    """Label the boundary to no slip."""
    return {"beta_noslip": label_variable("beta_noslip", no_slip_limits(system, r))}


def bank_boundaries(system: System, r: np.ndarray, mu: np.ndarray) -> xr.Dataset:
    """Boundaries of a system with banks."""
    refuse_static(system.contact_system, mu)
    coords = {name: coordinate(name, axis) for name, axis in {"mu": mu, "r": r}.items()}
    coords |= mass_coordinates(system) | contact_coordinates(system)
    return xr.Dataset(limit_variables(system, r), coords=coords)


def solve_cells(
    system: System, axes: Mapping[str, np.ndarray], names: tuple[str, ...], solver: Solver,
    threads: int | None, progress: Progress | None, watch: Watch | None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Outputs over mu, r and beta (n_beta,) or (n_r, n_beta); of contacts and masses with a last axis."""
    refuse_static(system.contact_system, axes["mu"])
    r, beta = axes["r"], axes["beta"]
    check_ratios(system, r)
    masses, count = any(is_of_masses(name) for name in names), checks.threads(threads)
    # an element that only touches its limit has another multiplier than one that does not
    places = any(name == "multiplier" or depends_on_places(name, system.contact_system) for name in names)

    def solve(rows: slice, progress: Progress | None) -> dict[str, np.ndarray]:
        at = r[rows]
        given = bank_system(system, float(at[0]))
        own = np.broadcast_to(beta, (r.size, beta.shape[-1]))[rows]
        ratios = Ratios(at, own, no_slip_limits(system, at), starts_of(system, at, solver.start))
        return sweep_banks(given, ratios, names, masses, solver.cycles, count, progress, watch, places)

    parts = []
    for k in range(r.size if changes_with_r(system) else 0):
        parts.append(solve(slice(k, k + 1), None))
        if progress is not None:
            progress(k + 1, r.size)
    found = {name: np.concatenate([part[name] for part in parts]) for name in names} if parts else solve(
        slice(None), progress
    )  # fmt: skip
    return {name: values[np.newaxis] for name, values in found.items()}


def bank_map(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Compute outputs, `status` and boundaries over the axes mu, r and beta."""
    general = system.contact_system
    names = chosen_outputs(general, solver, TABLE, has_output, "a bank as one contact")
    found = solve_cells(system, axes, names, solver, threads, progress, watch)
    variables = {name: labelled(name, found[name], general) for name in names}
    coords = {name: coordinate(name, values) for name, values in axes.items()}
    if any(is_of_masses(name) for name in names):
        coords |= mass_coordinates(system)
    return xr.Dataset(
        variables | limit_variables(system, axes["r"]), coords=coords | contact_coordinates(system)
    )

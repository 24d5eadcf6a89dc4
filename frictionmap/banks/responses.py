"""Sizes of steady motions on a grid and at scattered points."""

import numpy as np

from ..general.problem import is_symmetric, static_offset
from ..jobs import Watch
from ..model.settings import Solver
from ..model.sizes import Sizes, Wanted, sizes_of_points
from ..model.system import System
from .dataset import solve_cells

QUANTITIES = ("amplitude", "contact")


def sizes_on_grid(
    system: System, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes over r and beta (n_beta,), or beta (n_r, n_beta), at one mu, (n_r, n_beta).

    Where half periods of the load mirror each other, masses move by half their range to either side with
    elements at rest in the middle of where they can be: where they stay depends on the start, which is not
    what a design is about.
    """
    name, column, scale, offset = "contact_amplitude", wanted.contact, 1.0, 0.0
    if wanted.quantity == "amplitude":
        centred = is_symmetric(system.contact_system)
        name, column, scale = ("peak_to_peak", wanted.row, 0.5) if centred else ("amplitude", wanted.row, 1.0)
        offset = abs(static_offset(system)[1][column]) if centred else 0.0
    found = solve_cells(system, axes, (name, "regime", "status"), solver, threads, None, watch)
    size, regime, status = (found[key][0] for key in (name, "regime", "status"))
    return Sizes(scale * size[..., column] + offset, regime, np.zeros(regime.shape), status)


def sizes_at(
    system: System, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes at points (k,): rows of a grid with a beta of their own."""

    def on_grid(axes: dict[str, np.ndarray]) -> Sizes:
        return sizes_on_grid(system, wanted, axes, solver, threads, watch)

    return sizes_of_points(on_grid, r, beta, mu)

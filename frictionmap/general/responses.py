"""Sizes of steady states on a grid and at scattered points."""

import numpy as np

from ..jobs import Watch
from ..model.settings import Solver
from ..model.sizes import Sizes, Wanted
from ..model.system import System
from .held import least_static_friction, stick_scales
from .maps import solve_cells
from .outputs import number, output_values
from .problem import general_of

QUANTITIES = ("amplitude", "contact")


def sizes_on_grid(
    system: System, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes over r and beta (n_beta,), or beta (n_r, n_beta), at one mu, (n_r, n_beta)."""
    needed = least_static_friction(system, axes["r"])
    stick = stick_scales(general_of(system), needed, axes["mu"]).max(axis=2)
    found = solve_cells(system, axes, stick, solver, threads, None, watch, masses=True)
    if wanted.quantity == "amplitude":
        size = output_values("amplitude", system, found)[0, ..., wanted.row]
    else:
        size = output_values("contact_amplitude", system, found)[0, ..., wanted.contact]
    stops = np.nan_to_num(number("stops", found)[0]).max(axis=-1)
    return Sizes(size, found.regime[0], stops, found.status[0])


def sizes_at(
    system: System, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes at points (k,): rows of a grid with a beta of their own."""
    points, back = np.unique(np.stack((r, beta)), axis=1, return_inverse=True)
    axes = {"mu": np.array([mu]), "r": points[0], "beta": points[1, :, np.newaxis]}
    found = sizes_on_grid(system, wanted, axes, solver, threads, watch)
    return Sizes(*(values[back.ravel(), 0] for values in found))

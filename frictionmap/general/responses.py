"""Sizes of steady states on a grid and at scattered points."""

import numpy as np

from .. import regimes
from .._kernels.general.fill import Cells
from ..jobs import Watch
from ..model.settings import Solver
from ..model.sizes import Sizes, Wanted, sizes_of_points
from ..model.system import System
from .boundaries import find_boundaries
from .held import least_static_friction, stick_scales
from .maps import solve_cells
from .outputs import number, output_values
from .problem import general_of, is_symmetric, static_offset

QUANTITIES = ("amplitude", "contact")


def sizes_on_grid(
    system: System, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes over r and beta (n_beta,), or beta (n_r, n_beta), at one mu, (n_r, n_beta)."""
    stick = _stick(system, axes)
    found = solve_cells(system, axes, stick, solver, threads, None, watch, masses=True)
    if wanted.quantity == "amplitude":
        size = _amplitude(system, found, bool((axes["mu"] == 1.0).all()))[0, ..., wanted.row]
    else:
        size = _contact_sizes(system, found)[0, ..., wanted.contact]
    stops = np.nan_to_num(number("stops", found)[0]).max(axis=-1)
    return Sizes(size, found.regime[0], stops, found.status[0])


def _stick(system: System, axes: dict[str, np.ndarray]) -> np.ndarray:
    """Friction ratios from which all contacts stick permanently, (n_mu, n_r)."""
    general, mu, r = general_of(system), axes["mu"], axes["r"]
    if general.loop:
        return find_boundaries(system, r, mu).beta_stick
    return np.asarray(stick_scales(general, least_static_friction(system, r), mu).max(axis=2))


def _contact_sizes(system: System, found: Cells) -> np.ndarray:
    """Largest displacement in each contact, (..., N); of contacts that close loops, whose places are not
    looked for, about the middle, as of `_amplitude`.
    """
    general = general_of(system)
    if not general.loop or not is_symmetric(general):
        return output_values("contact_amplitude", system, found)
    ranges = output_values("contact_peak_to_peak", system, found)
    return np.asarray(0.5 * ranges + np.abs(static_offset(system)[0]) * (ranges > 0.0))


def _amplitude(system: System, found: Cells, flat: bool) -> np.ndarray:
    """Largest displacement of each mass, (..., n), contacts at rest in the middle of where they can be.

    Where a contact stays at rest depends on the start, which is not what a design is about.  If half periods
    of the load mirror each other, every steady motion has a mirror image.  Where only such places are not
    unique (mu = 1 and friction that does not depend on the speed; or all contacts rest) the mean of both
    is a steady motion, too: it goes half the range to either side of where constant loads move it.
    flat : whether mu is 1
    """
    general, rests = general_of(system), found.contact_regime == regimes.PERMANENT_STICKING
    amplitude = output_values("amplitude", system, found)
    if not is_symmetric(general):
        return amplitude
    middle = rests.any(axis=-1) if flat and not general.has_law else rests.all(axis=-1)
    centred = 0.5 * output_values("peak_to_peak", system, found) + np.abs(static_offset(system)[1])
    return np.where(middle[..., np.newaxis], centred, amplitude)


def sizes_at(
    system: System, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes at points (k,): rows of a grid with a beta of their own."""

    def on_grid(axes: dict[str, np.ndarray]) -> Sizes:
        return sizes_on_grid(system, wanted, axes, solver, threads, watch)

    return sizes_of_points(on_grid, r, beta, mu)

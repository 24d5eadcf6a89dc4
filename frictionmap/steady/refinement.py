"""Regimes of a reduced structure on a coarse map, against those with all modes or many more."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..errors import InputError
from ..jobs import Watch
from ..model.settings import Solver
from ..model.system import System
from ..regimes import UNRESOLVED
from ..single.maps import solve_map
from ..theory.refinement import boundary_changes, not_compared, one_mu, thinned, with_more_modes

#: Frequencies and friction ratios of the coarse map; above mu = 1 no cell is decided by proof, and fewer do.
_COARSE, _COARSE_ABOVE_ONE = (20, 15), (8, 6)


def reduction_check(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None = None,
    watch: Watch | None = None,
) -> dict[str, str]:  # fmt: skip
    """The attribute `reduction_check` of cells on axes mu, r and beta; none without a reduction."""
    try:
        finer = with_more_modes(system)
        if finer is None:
            return {}
        mu = one_mu(axes["mu"])
        changes = boundary_changes(system, finer, axes["r"], mu).describe()
        changed, cells = regime_changes(system, finer, axes, mu, solver, threads, watch)
    except InputError as error:
        return {"reduction_check": not_compared(error)}
    where = f"{changed:,} of {cells:,} cells of a coarse map (mu = {mu:g}) change regime"
    return {"reduction_check": f"{changes}; {where}"}


def regime_changes(
    system: System, finer: System, axes: Mapping[str, np.ndarray], mu: float, solver: Solver,
    threads: int | None = None, watch: Watch | None = None,
) -> tuple[int, int]:  # fmt: skip
    """Number of cells of a coarse map whose regime a finer reduction changes, and number of its cells.

    Cells that either leaves unresolved do not count as changed.
    """
    counts = _COARSE if mu == 1.0 else _COARSE_ABOVE_ONE
    r, beta = (thinned(axes[name], count) for name, count in zip(("r", "beta"), counts, strict=True))
    coarse = {"mu": np.array([mu]), "r": r, "beta": beta}
    settings = replace(solver, outputs=("regime",))
    own, other = (
        solve_map(one, coarse, settings, threads, None, watch)[0]["regime"] for one in (system, finer)
    )
    changed = (own != other) & (own != UNRESOLVED) & (other != UNRESOLVED)
    return int(np.count_nonzero(changed)), own.size

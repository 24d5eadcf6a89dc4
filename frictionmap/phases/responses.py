"""Sizes of steady states on a grid and at scattered points."""

import numpy as np

from .. import checks
from ..jobs import Watch
from ..model.settings import Solver
from ..model.sizes import SEPARATION, Sizes, Wanted
from ..model.system import System
from .given import changes_with_r, check_ratios, phase_system
from .quantities import TABLE, Solved
from .solve import observed_rows, solve_rows
from .system import PhaseSystem

QUANTITIES = ("amplitude", "contact")

#: r, mu and beta of a row of cells.
_Row = tuple[float, float, np.ndarray]


def _losses(given: PhaseSystem, solved: Solved, beta: np.ndarray) -> np.ndarray:
    """Largest loss of normal force over the preload of any contact, (B,): above 1 a contact opens.

    It goes on where the contact is open: the force that a contact would have which cannot open.
    """
    moving = [one for one in given.contacts if one.normal is not None]
    low = solved.further[0]
    found = np.zeros(beta.size)
    for k, one in enumerate(moving):
        preload = one.at(beta)[1]
        with np.errstate(divide="ignore", invalid="ignore"):  # no preload: every loss opens the contact
            loss = np.where(preload > 0.0, -one.normal_stiffness * low[:, k] / preload, np.inf)
        found = np.maximum(found, np.where(np.isnan(low[:, k]), np.nan, loss))
    return found


def _sizes(given: PhaseSystem, solved: Solved, wanted: Wanted, beta: np.ndarray) -> Sizes:
    if wanted.quantity == SEPARATION:
        size = _losses(given, solved, beta)
    elif wanted.quantity == "amplitude":
        size = TABLE["amplitude"](solved)[:, wanted.row]
    else:
        size = TABLE["contact_amplitude"](solved)[:, wanted.contact]
    stops = np.nan_to_num(TABLE["stops_per_cycle"](solved)).max(axis=-1, initial=0.0)
    return Sizes(size, TABLE["regime"](solved), stops, TABLE["status"](solved))


def _rows(
    system: System, wanted: Wanted, rows: list[_Row], solver: Solver, threads: int, watch: Watch | None
) -> Sizes:
    """Sizes of rows of cells, (n_rows, n_beta)."""
    check_ratios(system, np.array(sorted({r for r, _, _ in rows})))
    changes, parts = changes_with_r(system), []
    groups = [[row] for row in rows] if changes else [rows]
    for group in groups:
        given = phase_system(system, group[0][0])
        observed = [observed_rows(system.n)]
        observed += [one.normal[np.newaxis] for one in given.contacts if one.normal is not None]
        solved = solve_rows(
            given, group, np.concatenate(observed), solver.start, solver.cycles, checks.threads(threads),
            None, watch,
        )  # fmt: skip
        parts += [_sizes(given, one, wanted, beta) for one, (_, _, beta) in zip(solved, group, strict=True)]
    return Sizes(*(np.stack(arrays) for arrays in zip(*parts, strict=True)))


def sizes_on_grid(
    system: System, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes over r and beta at one mu, (n_r, n_beta)."""
    mu, beta = float(axes["mu"][0]), axes["beta"]
    return _rows(system, wanted, [(float(r), mu, beta) for r in axes["r"]], solver, threads, watch)


def sizes_at(
    system: System, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes at points (k,): rows of one cell."""
    points, back = np.unique(np.stack((r, beta)), axis=1, return_inverse=True)
    rows = [(float(one), mu, np.array([friction])) for one, friction in points.T]
    found = _rows(system, wanted, rows, solver, threads, watch)
    return Sizes(*(values[back.ravel(), 0] for values in found))

"""Maps of general systems: cells computed row by row on several threads, as labelled variables."""

from collections.abc import Mapping

import numpy as np

from .. import regimes
from .._kernels.engine.policies import MOVING_START
from .._kernels.general.fill import Cells, Grid, fill_rows
from ..model.settings import Solver
from ..model.system import System
from .boundaries import Boundaries, find_boundaries, friction_lines, rest_states, sliding_states
from .held import held_forces, largest
from .jobs import Progress, Watch, run_jobs
from .problem import general_of, problem_of


def _allocate(shape: tuple[int, int, int], contacts: int, masses: int) -> Cells:
    """Allocate unresolved cells."""
    per_contact = (*shape, contacts)
    numbers = [np.full(per_contact, np.nan) for _ in range(8)]
    ranges = [np.full((*shape, contacts + masses), np.nan) for _ in range(2)]
    return Cells(
        np.full(shape, regimes.UNRESOLVED, np.int8), np.full(shape, regimes.NOT_COMPUTED, np.int8),
        np.full(shape, regimes.CLOSED_FORM, np.int8), np.zeros(shape, np.int32), np.zeros(shape, np.int16),
        np.full(shape, np.nan), np.full(per_contact, regimes.UNRESOLVED, np.int8), *numbers, *ranges,
    )  # fmt: skip


def _put_r_zero(found: Cells, at_zero: int, beta: np.ndarray, stick: np.ndarray) -> None:
    """Fill r = 0: the regime is known, and no number of stops has a limit."""
    for m in range(stick.shape[0]):
        stuck = beta >= stick[m, at_zero]
        found.regime[m, at_zero] = np.where(stuck, regimes.PERMANENT_STICKING, regimes.STICK_SLIP)
        found.status[m, at_zero] = np.where(stuck, regimes.RESOLVED, regimes.QUASI_STATIC)
        found.contact_regime[m, at_zero] = found.regime[m, at_zero][:, np.newaxis]


def _put_stuck(system: System, r: np.ndarray, found: Cells, masses: int) -> None:
    """Fill displacements of cells that closed forms prove to stick: those of the held structure."""
    general = general_of(system)
    _, motions = held_forces(system, r)
    orders = np.array(list(motions), dtype=float)
    x = np.stack(list(motions.values()), axis=-1)  # (n_r, n, H)
    z = np.einsum("jn,rnh->rjh", np.array([group.vector for group in general.groups]), x)
    for j, group in enumerate(general.groups):
        if group.base:
            z[:, j] -= np.array([general.base.get(int(n), 0.0) for n in orders])
        if group.first.stiffness is None:
            z[:, j] = 0.0
    both = np.concatenate((z, x), axis=1) if masses else z
    finite = np.isfinite(both).all(axis=-1)
    both = np.where(finite[..., np.newaxis], both, 0.0)
    high = np.where(finite, largest(orders, both), np.inf)
    low = -np.where(finite, largest(orders, -both), np.inf)
    stuck = (found.regime == regimes.PERMANENT_STICKING) & (found.origin == regimes.CLOSED_FORM)
    m, i, b = np.nonzero(stuck)
    found.highest[m, i, b], found.lowest[m, i, b] = high[i], low[i]


def solve_cells(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int,
    progress: Progress | None, watch: Watch | None, masses: bool,
) -> tuple[Cells, Boundaries]:  # fmt: skip
    """Compute all cells of a grid, and the boundaries over r.

    masses : whether displacements of the masses are wanted, after those in the contacts
    """
    mu, r, beta = axes["mu"], axes["r"], axes["beta"]
    limits = find_boundaries(system, r, mu, threads, watch)
    problem, modal = problem_of(system, r)
    general = general_of(system)
    kinetic, static = friction_lines(system, mu)
    unique = (static == kinetic).all(axis=(1, 2)) & (solver.skip == "exact")
    stuck_from = np.where(
        unique[:, np.newaxis], np.searchsorted(beta, limits.beta_stick), beta.size
    )  # fmt: skip
    starts = rest_states(system, modal, r)
    if solver.start == "moving":
        starts = sliding_states(problem, r, MOVING_START)
    grid = Grid(beta, kinetic, static, stuck_from, starts, float(solver.cycles), solver.tolerance)
    count = system.n if masses else 0
    found = _allocate((mu.size, r.size, beta.size), general.count, count)
    outputs = np.ascontiguousarray(modal.phi) if masses else np.empty((0, modal.phi.shape[1]))

    def job(row: int, cancel: np.ndarray) -> None:
        fill_rows(row, row + 1, problem, grid, found, outputs, cancel)

    run_jobs(mu.size * r.size, job, threads, progress, watch)
    for at_zero in np.flatnonzero(r == 0.0):
        _put_r_zero(found, int(at_zero), beta, limits.beta_stick)
    _put_stuck(system, r, found, count)
    _put_offset(system, found, count)
    return found, limits


def _put_offset(system: System, found: Cells, masses: int) -> None:
    """Add the displacements under constant loads."""
    general = general_of(system)
    if not general.offset.any():
        return
    x = np.linalg.solve(system.modes.stiffness, general.offset)
    moved = np.array([group.vector @ x for group in general.groups])
    shift = np.concatenate((moved, x)) if masses else moved
    for table in (found.lowest, found.highest):
        table += shift

"""The cells of a map: decide which of them need integration, and compute them in parallel."""

from collections import namedtuple
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import checks
from .._kernels.engine.fill import RESTART, OpenCells
from .._kernels.engine.policies import NO_FRICTION
from ..datasets.labels import CELL, CELL_VARIABLES
from ..errors import InputError
from ..jobs import Job, Progress, Watch, run_here, run_jobs
from ..model.settings import Solver
from ..model.system import System
from ..theory.boundary_curves import Curves
from ..units.axes import KINDS, ratios, require
from ..units.scales import Scales
from .cells import Cells
from .quantity_data import QuantityRequest, quantity_request, read_result

#: Cells per job: some milliseconds of work, so that all threads finish together, progress is visible and an
#: interrupt takes effect; long enough for the overhead of a job to be negligible.
TILE = 1024

#: Cells per job that are filled by closed form.
ROW_CELLS = 262144

#: Approximate cost of a cell, in hundredths of an integrated one: decided by a formula; integrated;
#: searched for further regimes, with mu = 1 and with mu > 1.
_DECIDED, FOLLOWED, SEARCHED_UNIQUE, SEARCHED = 2, 100, 25, 800

#: Cost up to which jobs run in this thread, as an interrupt need not wait: to wake a thread takes longer.
_AT_ONCE = 16 * FOLLOWED

#: Outputs with an array in a map: all but those that are read from the results over a cycle.
_NAMES = tuple(name for name, label in CELL_VARIABLES.items() if label.needs != "cycle")
Arrays = namedtuple("Arrays", _NAMES)  # type: ignore[misc]

#: Arrays in the place of outputs that are not requested.
_EMPTY: dict[str, np.ndarray] = {
    name: np.empty([0] * len(CELL_VARIABLES[name].dims), CELL_VARIABLES[name].dtype) for name in _NAMES
}


@dataclass(frozen=True)
class Plan:
    """Open cells of a map: in each row (mu, r), those with indices low to high - 1 in beta."""

    low: np.ndarray  # (n_mu * n_r,) first open cell
    high: np.ndarray
    rows: np.ndarray  # the rows that have open cells
    ends: np.ndarray  # cumulative number of open cells of these rows

    @property
    def cells(self) -> int:
        """Number of open cells."""
        return int(self.ends[-1]) if self.ends.size else 0

    def tiles(self) -> Iterator[tuple[int, int]]:
        """Iterate over tiles of the list of open cells: the first cell, and the one after the last.

        Tiles are cut only at the ends of rows and where the search from neighbours starts anew.
        """
        begin = first = 0
        for end in self.ends.tolist():
            for cut in (*range(begin + RESTART, end, RESTART), end):
                if cut - first >= TILE:
                    yield first, cut
                    first = cut
            begin = end
        if first < begin:
            yield first, begin


def _no_friction(beta_lim: np.ndarray, beta_stick: np.ndarray) -> np.ndarray:
    """Friction ratios (n_mu, n_r) below which friction is lost in rounding and the motion is continuous.

    Nothing says how large the load is where beta_stick is infinite, at a resonance of the held structure.
    """
    lost = np.where(np.isfinite(beta_stick), NO_FRICTION * beta_stick, 0.0)
    return np.minimum(beta_lim, lost)


def plan(cells: Cells, r: np.ndarray, mu: np.ndarray, beta: np.ndarray, solver: Solver) -> Plan:
    """Separate the cells that closed forms decide from the open ones (theory.md 6).

    * beta = 0 is linear; without a load in the contact (joined base-wall, r = 0) nothing moves.
    * skip = "exact": friction below the rounding error of the load, below beta_lim, is treated as zero.
    * skip = "exact", mu = 1: continuous below beta_lim, stuck at or above beta_stick, for every initial
      state.
    * skip = "exact", start from rest: one mass with beta >= beta_stick never begins to move.
    * r = 0 has no motion to integrate; the boundaries give a regime, but no number of stops.
    """
    beta_lim, beta_stick = cells.curves.beta_lim, cells.curves.beta_stick
    shape = beta_lim.shape
    no_motion = r == 0.0
    low = np.full(shape, int(beta[0] == 0.0))
    high = np.full(shape, beta.size)
    stuck_from = np.searchsorted(beta, beta_stick)
    if solver.skip == "exact":
        unique = (mu == 1.0)[:, np.newaxis]
        proved = unique | (solver.start == "rest" and cells.rest_sticks)
        high = np.where(proved, stuck_from, high)
        sliding = np.where(unique, beta_lim, _no_friction(beta_lim, beta_stick))
        low = np.maximum(low, np.searchsorted(beta, sliding))
    high = np.where(no_motion, stuck_from, high)
    low = np.where(cells.no_load, 0, np.minimum(low, high))
    open_cells = np.where(no_motion, 0, high - low).ravel()
    rows = np.flatnonzero(open_cells)
    return Plan(low.ravel(), high.ravel(), rows, np.cumsum(open_cells[rows]))


def allocate(shape: tuple[int, int, int], dofs: int, names: Sequence[str]) -> Any:
    """Allocate these outputs, unresolved until filled; other outputs have size 0."""
    sizes = dict(zip((*CELL, "dof"), (*shape, dofs), strict=True))
    kept: dict[str, np.ndarray] = {}
    for name in names:
        if name in _EMPTY:
            label = CELL_VARIABLES[name]
            kept[name] = np.full([sizes[dim] for dim in label.dims], label.unresolved, label.dtype)
    return Arrays(**(_EMPTY | kept))


def _fill(
    cells: Cells, work: Plan, shape: tuple[int, int, int], unique: np.ndarray, out: Any, threads: int,
    progress: Progress | None, watch: Watch | None,
) -> None:  # fmt: skip
    """Fill all cells; `unique` (n_mu,): where mu = 1."""
    n_rows, columns = work.low.size, shape[2]
    rows_at_once = max(1, ROW_CELLS // columns)
    opened = OpenCells(work.rows, work.ends, work.low, work.high)
    cancel = np.zeros(1, dtype=np.uint8)
    jobs: list[Job] = []
    costs: list[int] = []
    for first in range(0, n_rows, rows_at_once):
        last = min(first + rows_at_once, n_rows)
        jobs.append(cells.closed(first, last, opened, out))
        costs.append(_DECIDED * (last - first) * columns)
    for first, last in work.tiles():
        jobs.append(cells.opened(first, last, opened, out, cancel))
        costs.append(FOLLOWED * (last - first))

    others = cells.reachable(out, cancel)
    if others:
        jobs += others
        per_row = columns * np.repeat(np.where(unique, SEARCHED_UNIQUE, SEARCHED), shape[1])
        costs += per_row.tolist()

    spent, total = 0, sum(costs)

    def done(index: int) -> None:
        nonlocal spent
        spent += costs[index]
        if progress is not None:
            progress(spent, total)

    try:
        if total <= _AT_ONCE and watch is None:
            run_here(jobs, done)
        else:
            run_jobs(jobs, threads, done, watch)
        run_jobs(cells.exponents(out, cancel), threads, lambda _: None, watch)
    except BaseException:
        cancel[0] = 1  # the kernels check it at every event
        raise
    cells.finish(out)


def checked_axes(
    r: ArrayLike, beta: ArrayLike, mu: ArrayLike, per_cell: int, scales: Scales
) -> dict[str, np.ndarray]:
    """Check the axes mu, r and beta of a grid with `per_cell` numbers per cell; r and beta may have units."""
    require(scales, r=(KINDS["r"], r), beta=(KINDS["beta"], beta))
    r, beta = ratios(r, "r", KINDS["r"], scales), ratios(beta, "beta", KINDS["beta"], scales)
    r = checks.axis(r, "r", least=0.0, most=checks.LARGEST_RATIO)
    beta = checks.axis(beta, "beta", least=0.0)
    mu = checks.axis(mu, "mu", least=1.0)
    checks.cells(mu.size, r.size, beta.size * per_cell)
    return {"mu": mu, "r": r, "beta": beta}


def compute(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, request: QuantityRequest | None,
    threads: int | None, progress: Progress | None, watch: Watch | None = None,
) -> tuple[Cells, Any]:  # fmt: skip
    """Compute the cells of a grid; `request` names quantities to be stored in the results of the cells."""
    threads = checks.threads(threads)
    if progress is not None and not callable(progress):
        raise InputError("progress", f"must be a function of two numbers; got {checks.one_line(progress)}")
    mu, r, beta = axes["mu"], axes["r"], axes["beta"]
    cells = Cells(system, r, beta, mu, solver, request)
    out = allocate((mu.size, r.size, beta.size), system.n, cells.kept)
    work = plan(cells, r, mu, beta, solver)
    _fill(cells, work, (mu.size, r.size, beta.size), mu == 1.0, out, threads, progress, watch)
    return cells, out


def solve_map(
    system: System,
    axes: Mapping[str, np.ndarray],
    solver: Solver,
    threads: int | None,
    progress: Progress | None,
    watch: Watch | None = None,
) -> tuple[dict[str, np.ndarray], Curves]:
    """Compute outputs and `status` of one system over the axes mu, r and beta, as arrays, and its curves."""
    of_cycle = [name for name in solver.outputs if CELL_VARIABLES[name].needs == "cycle"]
    request = quantity_request(of_cycle) if of_cycle else None
    cells, out = compute(system, axes, solver, request, threads, progress, watch)
    names = dict.fromkeys((*solver.outputs, "status"))
    found: dict[str, np.ndarray] = {
        name: read_result(name, cells.results) if name in of_cycle else getattr(out, name) for name in names
    }
    return found, cells.curves

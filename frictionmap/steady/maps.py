"""The cells of a map: plan which of them need integration, run them in parallel."""

import os
from collections import namedtuple
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import checks
from .._kernels.engine.fill import RESTART, OpenCells
from ..datasets.labels import CELL, CELL_VARIABLES
from ..errors import InputError
from ..model.settings import Solver
from ..model.system import System
from ..theory.boundary_curves import Curves
from ..units.axes import KINDS, ratios
from ..units.scales import Scales
from .cells import Cells, Job
from .quantity_data import Asked, asked_for, read_result

#: Cells a thread takes at a time: some milliseconds of work, so that the threads finish together, progress
#: is seen and an interrupt is obeyed; and enough for the start of a tile not to count.
TILE = 1024

#: Rows of the map a thread fills by closed form at a time.
ROW_CELLS = 262144

#: What a cell costs, about, in hundredths of one that is followed: decided by a formula; followed; looked at
#: for what else it could end in, with mu = 1 and above.
_DECIDED, FOLLOWED, LOOKED_AT_SMOOTH, LOOKED_AT = 2, 100, 25, 800

#: The arrays of a map, one for every output but those that are read from the results of a cycle.
_NAMES = tuple(name for name, label in CELL_VARIABLES.items() if label.needs != "cycle")
Arrays = namedtuple("Arrays", _NAMES)  # type: ignore[misc]

Progress = Callable[[int, int], None]

#: Called now and then while cells are worked on; what it raises ends the work.
Watch = Callable[[], None]

#: Seconds between two calls of it.
_WATCHED = 0.02


@dataclass(frozen=True)
class Plan:
    """Which cells are open: in each row (mu, r), those from `low` to before `high` in beta."""

    low: np.ndarray  # (n_mu * n_r,)
    high: np.ndarray
    rows: np.ndarray  # the rows that have open cells
    ends: np.ndarray  # number of open cells up to and with each of them

    @property
    def cells(self) -> int:
        """Number of open cells."""
        return int(self.ends[-1]) if self.ends.size else 0

    def tiles(self) -> Iterator[tuple[int, int]]:
        """First cell and the one after the last of every tile of the list of open cells.

        Cut at the ends of rows and where the search from neighbours starts anew, and nowhere else.
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


def plan(cells: Cells, r: np.ndarray, mu: np.ndarray, beta: np.ndarray, solver: Solver) -> Plan:
    """Sort the cells into those that a formula decides and those that are open (theory.md 6).

    - beta = 0 is linear; where nothing loads the contact (joined base-wall, r = 0), nothing moves.
    - skip = "exact", mu = 1: continuous below beta_lim, stuck from beta_stick on, whatever the start.
    - skip = "exact", start from rest: one mass with beta >= beta_stick never begins to move.
    - r = 0 has no motion to integrate; a regime, but no number of stops, follows from the boundaries.
    """
    beta_lim, beta_stick = cells.curves.beta_lim, cells.curves.beta_stick
    shape = beta_lim.shape
    no_load = np.broadcast_to(cells.no_load, shape)
    no_motion = np.broadcast_to(r == 0.0, shape)
    low = np.full(shape, int(beta[0] == 0.0))
    high = np.full(shape, beta.size)
    stuck_from = np.searchsorted(beta, beta_stick)
    if solver.skip == "exact":
        smooth = (mu == 1.0)[:, np.newaxis]
        proved = smooth | (solver.start == "rest" and cells.rest_sticks)
        high = np.where(proved, stuck_from, high)
        low = np.where(smooth, np.maximum(low, np.searchsorted(beta, beta_lim)), low)
    high = np.where(no_motion, stuck_from, high)
    low = np.where(no_load, 0, np.minimum(low, high))
    open_cells = np.where(no_motion, 0, high - low).ravel()
    rows = np.flatnonzero(open_cells)
    return Plan(low.ravel(), high.ravel(), rows, np.cumsum(open_cells[rows]))


def allocate(shape: tuple[int, int, int], dofs: int, names: Sequence[str]) -> Any:
    """Outputs asked for, and status, unresolved until they are filled; the others have no cells."""
    sizes = dict(zip((*CELL, "dof"), (*shape, dofs), strict=True))
    arrays: list[np.ndarray] = []
    for name in _NAMES:
        label = CELL_VARIABLES[name]
        kept = name in (*names, "status")
        arrays.append(np.full([kept * sizes[dim] for dim in label.dims], label.unresolved, label.dtype))
    return Arrays(*arrays)


def default_threads() -> int:
    """Processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _run(jobs: Sequence[Job], threads: int, done: Callable, watch: Watch | None) -> None:
    """Run jobs on a pool of threads; `done(index)` is called in this thread as each one ends.

    This thread only waits, so that an interrupt reaches it at once.
    """
    pool = ThreadPoolExecutor(threads)
    running: dict[Future, int] = {}
    waiting = iter(enumerate(jobs))
    try:
        while True:
            for index, (function, arguments) in islice(waiting, 2 * threads - len(running)):
                running[pool.submit(function, *arguments)] = index
            if not running:
                return
            pause = None if watch is None else _WATCHED
            ended = wait(running, pause, return_when=FIRST_COMPLETED).done
            for future in sorted(ended, key=running.__getitem__):  # as they began: progress tells of them
                future.result()
                done(running.pop(future))
            if watch is not None:
                watch()
    finally:
        pool.shutdown(wait=not running, cancel_futures=True)


def _fill(
    cells: Cells, work: Plan, shape: tuple[int, int, int], smooth: np.ndarray, out: Any, threads: int,
    progress: Progress | None, watch: Watch | None,
) -> None:  # fmt: skip
    """`smooth` (n_mu,): where mu = 1."""
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
    jobs += others
    per_row = columns * np.repeat(np.where(smooth, LOOKED_AT_SMOOTH, LOOKED_AT), shape[1])
    costs += per_row.tolist()[: len(others)]

    spent, total = 0, sum(costs)

    def done(index: int) -> None:
        nonlocal spent
        spent += costs[index]
        if progress is not None:
            progress(spent, total)

    try:
        _run(jobs, threads, done, watch)
    except BaseException:
        cancel[0] = 1  # the kernels look at it at every event
        raise
    cells.finish(out)


def checked_axes(
    r: ArrayLike, beta: ArrayLike, mu: ArrayLike, per_cell: int, scales: Scales
) -> dict[str, np.ndarray]:
    """The axes mu, r and beta of a grid, of so many numbers a cell; r and beta may have units."""
    r, beta = ratios(r, "r", KINDS["r"], scales), ratios(beta, "beta", KINDS["beta"], scales)
    r = checks.axis(r, "r", least=0.0, most=checks.LARGEST_RATIO)
    beta = checks.axis(beta, "beta", least=0.0)
    mu = checks.axis(mu, "mu", least=1.0)
    checks.cells(mu.size, r.size, beta.size * per_cell)
    return {"mu": mu, "r": r, "beta": beta}


def compute(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, asked: Asked | None, threads: int | None,
    progress: Progress | None, watch: Watch | None = None,
) -> tuple[Cells, Any]:  # fmt: skip
    """The cells of a grid and their arrays, filled; `asked`: what else, in the results of the cells."""
    threads = default_threads() if threads is None else checks.whole(threads, "threads", least=1)
    if progress is not None and not callable(progress):
        raise InputError(f"progress must be a function of two numbers; got {checks.one_line(progress)}")
    mu, r, beta = axes["mu"], axes["r"], axes["beta"]
    cells = Cells(system, r, beta, mu, solver, asked)
    out = allocate((mu.size, r.size, beta.size), system.n, solver.outputs)
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
    """Outputs and `status` of one system over the axes mu, r and beta as bare arrays, and its curves."""
    of_cycle = [name for name in solver.outputs if CELL_VARIABLES[name].needs == "cycle"]
    asked = asked_for(of_cycle) if of_cycle else None
    cells, out = compute(system, axes, solver, asked, threads, progress, watch)
    names = dict.fromkeys((*solver.outputs, "status"))
    found: dict[str, np.ndarray] = {
        name: read_result(name, cells.results) if name in of_cycle else getattr(out, name) for name in names
    }
    return found, cells.curves

"""Cells at scattered points (r, beta), each with its own frequency and friction ratio."""

from typing import Any, NamedTuple

import numpy as np

from .._kernels.engine.fill import OpenCells
from ..model.settings import Solver
from ..model.system import System
from .cells import Cells
from .maps import allocate, plan
from .quantity_data import QuantityRequest

#: Points computed at a time: arrays extend over all pairs of their frequencies and friction ratios.
AT_ONCE = 512


class Scattered(NamedTuple):
    """Results at k points: those of point j are at [0, j, column[j]]."""

    cells: Cells
    out: Any
    column: np.ndarray


def allocate_at(
    system: System, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver,
    request: QuantityRequest | None,
) -> Scattered:  # fmt: skip
    """Allocate unresolved cells at up to `AT_ONCE` points, r and beta (k,)."""
    columns, column = np.unique(beta, return_inverse=True)
    cells = Cells(system, r, columns, np.array([mu]), solver, request)
    return Scattered(cells, allocate((1, r.size, columns.size), system.n, cells.kept), column)


def follow(found: Scattered, which: np.ndarray) -> None:
    """Fill cells at the points `which` by following their motions."""
    if not which.size:
        return
    places = OpenCells(which, np.arange(1, which.size + 1), found.column, found.column + 1)
    fill, arguments = found.cells.opened(0, which.size, places, found.out, np.zeros(1, dtype=np.uint8))
    fill(*arguments)


def scattered_cells(
    system: System, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver,
    request: QuantityRequest | None = None,
) -> Scattered:  # fmt: skip
    """Compute cells at up to `AT_ONCE` points, as those of a map.

    Parameters
    ----------
    system : System
    r : (k,) > 0
    beta : (k,) >= 0
    mu : >= 1
    solver : Solver
        Its outputs are computed.
    request : QuantityRequest, optional
        Further quantities, in the results of the cells.
    """
    found = allocate_at(system, r, beta, mu, solver, request)
    column, columns = found.column, np.unique(beta)
    work = plan(found.cells, r, np.array([mu]), columns, solver)
    slides, sticks = column < work.low, column >= work.high
    rows = np.arange(r.size)
    low = np.where(slides, column + 1, 0)
    high = np.where(sticks & ~slides, column, columns.size)
    decided = OpenCells(rows, rows + 1, low, high)
    fill, arguments = found.cells.closed(0, r.size, decided, found.out)
    fill(*arguments)
    follow(found, np.flatnonzero(~slides & ~sticks))
    found.cells.finish(found.out)
    return found

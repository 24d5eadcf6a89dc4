"""Single cells by the kernel that fills maps, as the benchmarks time it."""

from collections.abc import Callable

import numpy as np

import frictionmap as fm
from frictionmap._kernels.engine.fill import OpenCells
from frictionmap.model.settings import Solver
from frictionmap.single.cells import Cells
from frictionmap.single.maps import Arrays, allocate


def cells_by_kernel(
    system: fm.System, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver
) -> tuple[Callable[[], None], Arrays]:
    """(solve, out) for cells (r[k], beta[k]), with constants computed for each; cell k is out[0, k, k]."""
    out = allocate((1, r.size, r.size), system.n, solver.outputs)
    one_a_row = np.arange(r.size)
    cells = Cells(system, r, beta, np.array([mu]), solver)
    function, arguments = cells.opened(
        0, r.size, OpenCells(one_a_row, one_a_row + 1, one_a_row, one_a_row + 1), out,
        np.zeros(1, dtype=np.uint8),
    )  # fmt: skip
    return lambda: function(*arguments), out

"""Cells by the kernels of the package: rows of a map, and single cells from rest."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import frictionmap as fm
from frictionmap import regimes
from frictionmap._kernels.compiler.lending import lent
from frictionmap._kernels.compiler.packed import packed
from frictionmap._kernels.general.counts import MOVED, STOPS
from frictionmap._kernels.general.fill import Cells, Grid, fill_rows, make_row_memory
from frictionmap._kernels.general.record import NOTHING, RANGES
from frictionmap._kernels.general.return_map import from_rest, steady_period
from frictionmap._kernels.general.row import set_row
from frictionmap._kernels.general.series import Friction
from frictionmap._kernels.general.steady import REPEATS, find, make_workspace, measure
from frictionmap.general.boundaries import friction_lines, rest_states
from frictionmap.general.held import least_static_friction, stick_scales
from frictionmap.general.outputs import allocate
from frictionmap.general.problem import general_of, problem_of

from ..own_entry import own_entry

#: Settings of the package.
_CYCLES, _TOLERANCE = 2000.0, 1e-12

_MU = np.ones(1)


def stick_scale(system: fm.System, r: np.ndarray) -> np.ndarray:
    """beta from which all contacts stick permanently, (n_r,), mu = 1."""
    return stick_scales(general_of(system), least_static_friction(system, r), _MU).max(axis=2)[0]


def map_row(system: fm.System, r: float, beta: np.ndarray) -> tuple[Callable[[], None], Cells]:
    """(solve, cells) for one row of a map; cell b is [0, 0, b].  Boundaries are not part of `solve`."""
    axis = np.array([r])
    problem, modal = problem_of(system, axis)
    kinetic, static = friction_lines(system, _MU)
    stuck_from = np.searchsorted(beta, stick_scale(system, axis))[np.newaxis]
    starts = rest_states(system, modal, axis)
    grid = Grid(beta[np.newaxis], kinetic, static, stuck_from, starts, False, _CYCLES, _TOLERANCE, False)
    cells = allocate((1, 1, beta.size), general_of(system).count, 0)
    no_masses, cancel = np.empty((0, modal.phi.shape[1])), np.zeros(1, np.uint8)
    memory = lent(make_row_memory(problem, no_masses))
    given = lent(problem), lent(grid), lent(cells)
    return lambda: fill_rows(0, 1, *given, memory, cancel), cells


class Found(NamedTuple):
    """Steady states of single cells, mu = 1; nan where none was found."""

    multiplier: np.ndarray  # (cells,) over a period of the load
    stops: np.ndarray  # (cells, N) per period
    ranges: np.ndarray  # (cells, N) max z - min z; 0 where the contact sticks permanently


@own_entry
def _solve_cells(problem, forces, starts, workspace, friction, found):
    """Solve cells k = 0, 1, ... at r[k], each from rest and with its constants computed again."""
    problem, workspace, friction = packed(problem), packed(workspace), packed(friction)
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    contacts = problem.spring.size
    for k in range(problem.r.size):
        set_row(problem, k, row)
        for j in range(contacts):
            friction.kinetic[j] = friction.static[j] = forces[k, j]
        from_rest(problem, row, friction, starts[k], motion, memory, record, NOTHING)
        steady = find(problem, friction, _CYCLES, _TOLERANCE, workspace)
        if steady.status != REPEATS:
            continue
        halves, multiplier = measure(problem, friction, steady.halves, workspace, RANGES)
        if halves == 0:
            continue
        found.multiplier[k] = multiplier ** (1.0 / steady_period(steady.halves))
        for j in range(contacts):
            moved = memory.counts[MOVED, j] != 0.0
            found.stops[k, j] = memory.counts[STOPS, j] / (0.5 * halves) if moved else 0.0
            found.ranges[k, j] = record.ranges[1, j] - record.ranges[0, j] if moved else 0.0


def single_cells(system: fm.System, r: np.ndarray, forces: np.ndarray) -> tuple[Callable[[], None], Found]:
    """(solve, found) for cells with friction forces (cells, N), each at its own r, from rest."""
    problem, modal = problem_of(system, r)
    starts, count = rest_states(system, modal, r), forces.shape[1]
    found = Found(*(np.full(shape, np.nan) for shape in ((r.size,), (r.size, count), (r.size, count))))
    workspace = make_workspace(problem, np.empty((0, problem.squares.size)), 0)
    friction = Friction(np.empty(count), np.empty(count))
    return lambda: _solve_cells(problem, forces, starts, workspace, friction, found), found


def open_share(cells: Cells) -> np.ndarray:
    """Whether each cell of a row is stick-slip, solved, and not decided by a closed form."""
    return (cells.regime[0, 0] == regimes.STICK_SLIP) & (cells.status[0, 0] == regimes.RESOLVED)

"""Cells of a map, and the steps of one motion."""

import math
from typing import NamedTuple

import numpy as np

from ... import regimes
from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..phases.fill import AVERAGED, CYCLES, MULTIPLIER, PERIOD, STATUS
from ..phases.problem import COUNT_ROWS, STUCK
from .level import slipping
from .orbit import keep_orbit, make_memory
from .problem import Cell, make_motion
from .steady import Found, all_slip, find_ahead, find_steady
from .trail import begin_ahead, make_trail, remember


class Grid(NamedTuple):
    """Cells of one r."""

    beta: np.ndarray  # (B,) increasing
    limit: np.ndarray  # (B, E) u
    start: np.ndarray  # (2, m) modes and their velocities q' at the phase `begin`
    begin: float
    cycles: int
    places: bool  # whether displacements are wanted that depend on the places of elements that never slip


@kernel
def _put_cell(problem, motion, found, out, at):
    """Store a steady motion in a cell of a `phases.fill.Cells`."""
    record, resolved = motion.record, found.status == regimes.RESOLVED
    out.numbers[at, STATUS], out.numbers[at, CYCLES] = found.status, found.cycles
    out.numbers[at, MULTIPLIER] = found.multiplier
    out.numbers[at, PERIOD] = out.numbers[at, AVERAGED] = 1.0 if resolved else 0.0
    if not resolved:
        return
    contacts, rows = problem.moved.size, problem.observed.shape[0]
    for k in range(rows + contacts):
        out.low[at, k], out.high[at, k] = record.low[k], record.high[k]
    for j in range(contacts):
        rests = slipping(motion, j) == 0
        for k in range(motion.counts.shape[0]):
            out.counts[at, k, j] = 0.0 if rests else motion.counts[k, j]
        out.work[at, j], out.distance[at, j], out.belt_work[at, j] = record.work[j], record.distance[j], 0.0
        if rests:  # elements that reach their limits do so by rounding
            out.counts[at, STUCK, j] = 2.0 * math.pi
            out.work[at, j] = out.distance[at, j] = 0.0


@kernel
def put_friction(problem, limit, cell):
    """Set the limits of a cell."""
    for j in range(problem.moved.size):
        total, first = 0.0, problem.first[j]
        cell.slid[first + j] = 0.0
        for i in range(first, problem.first[j + 1]):
            cell.limit[i] = limit[i]
            total += problem.spring[i] * limit[i]
            cell.slid[i + j + 1] = total


@kernel
def _solve_cell(problem, row, cell, motion, memory, grid, at, trail):
    """Find the steady motion of a cell: where the last cells point, or from its start.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell with the friction of the cell
    motion, memory : Motion, Memory
    grid, at : Grid, number of the cell
    trail : Trail

    Returns
    -------
    Found
    """
    memory.known[0] = 0
    if trail.count[0] > 0:
        begin_ahead(problem, row, cell, motion, grid.beta[at], trail)
        passes = find_ahead(problem, row, cell, motion, memory)
        if passes > 0:
            remember(motion.now, grid.beta[at], trail)
            if not grid.places or all_slip(problem, motion):
                return Found(regimes.RESOLVED, passes, memory.radius[0])
            keep_orbit(motion, memory)
    ahead = memory.known[0] != 0
    found = find_steady(problem, row, cell, motion, memory, grid)
    if found.status != regimes.RESOLVED:
        trail.count[0] = 0
    elif not ahead:
        remember(motion.now, grid.beta[at], trail)
    return found


@entry
def _fill(problem, row, grid, cell, motion, memory, trail, out, cancel):
    """Fill the cells of one r.

    Parameters
    ----------
    problem, row, grid, out : see `fill_cells`
    cell, motion, memory, trail : Cell, Motion, Memory, Trail, overwritten
    cancel : (1,) not 0 where the rest is not wanted
    """
    problem, row, grid, out = packed(problem), packed(row), packed(grid), packed(out)
    cell, motion, memory, trail = packed(cell), packed(motion), packed(memory), packed(trail)
    trail.count[0] = 0
    for at in range(grid.limit.shape[0]):
        if cancel[0] != 0:
            break
        put_friction(problem, grid.limit[at], cell)
        found = _solve_cell(problem, row, cell, motion, memory, grid, at, trail)
        _put_cell(problem, motion, found, out, at)


def fill_cells(problem, row, grid, steps, out, cancel):
    """Fill the cells of one r; return the motion, whose record is that of the last cell.

    Parameters
    ----------
    problem, row, grid, out : Problem, Row, Grid, phases.fill.Cells
    steps : steps that the record keeps
    cancel : (1,) not 0 where the rest is not wanted
    """
    motion = make_motion(problem, row.orders.size, COUNT_ROWS, steps)
    cell = Cell(np.zeros(problem.spring.size), np.zeros(problem.left.size))
    _fill(problem, row, grid, cell, motion, make_memory(problem), make_trail(problem), out, cancel)
    return motion

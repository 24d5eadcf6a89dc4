"""Cells of a map, and the steps of one motion."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from .orbit import make_memory
from .problem import Cell, make_motion
from .steady import find_steady

#: Columns of `Cells.numbers`.
STATUS, PERIOD, CYCLES, MULTIPLIER, AVERAGED = 0, 1, 2, 3, 4
NUMBERS = 5


class Grid(NamedTuple):
    """Cells of one r."""

    limit: np.ndarray  # (B, N) see `Cell`
    static: np.ndarray  # (B, N)
    preload: np.ndarray  # (B, N)
    constant: np.ndarray  # (B, m) load on the modes
    start: np.ndarray  # (2, m) see `find_steady`
    cycles: int


class Cells(NamedTuple):
    """Numbers of every cell."""

    numbers: np.ndarray  # (B, NUMBERS)
    counts: np.ndarray  # (B, COUNT_ROWS, N)
    low: np.ndarray  # (B, R + 2 N + S) see `Record`
    high: np.ndarray
    work: np.ndarray  # (B, N)
    belt_work: np.ndarray  # (B, N)
    distance: np.ndarray  # (B, N)
    crossings: np.ndarray  # (B, S)
    spring_force: np.ndarray  # (B, S)
    state: np.ndarray  # (B, size) at the section


@kernel
def _copy(found, into):
    """Copy a list of numbers."""
    for k in range(found.size):
        into[k] = found[k]


@kernel
def put_cell(motion, memory, found, out, at):
    """Store a steady motion in a cell."""
    out.numbers[at, STATUS], out.numbers[at, PERIOD] = found.status, found.period
    out.numbers[at, CYCLES], out.numbers[at, MULTIPLIER] = found.cycles, found.multiplier
    out.numbers[at, AVERAGED] = found.averaged
    if found.averaged == 0:
        return
    record = motion.record
    for k in range(motion.counts.shape[0]):
        _copy(motion.counts[k], out.counts[at, k])
    _copy(record.low, out.low[at])
    _copy(record.high, out.high[at])
    _copy(record.work, out.work[at])
    _copy(record.belt_work, out.belt_work[at])
    _copy(record.distance, out.distance[at])
    _copy(motion.crossings, out.crossings[at])
    _copy(record.spring_force, out.spring_force[at])
    _copy(memory.start, out.state[at])


@entry
def fill_cells(problem, row, grid, steps, out, cancel):
    """Fill the cells of one r; return the motion, whose record is that of the last cell.

    Parameters
    ----------
    problem, row : Problem, Row
    grid, out : Grid, Cells
    steps : steps that the record keeps
    cancel : (1,) not 0 where the rest is not wanted
    """
    modes = problem.squares.size
    motion = make_motion(problem, steps)
    memory = make_memory(problem, motion.tangent.shape[0])
    constant = np.zeros(modes)
    scale = row.h * row.h / (row.r * row.r)
    for at in range(grid.limit.shape[0]):
        if cancel[0] != 0:
            break
        for i in range(modes):
            constant[i] = scale * grid.constant[at, i]
        cell = Cell(grid.limit[at], grid.static[at], grid.preload[at], constant)
        found = find_steady(problem, row, cell, motion, memory, grid.start, grid.cycles)
        put_cell(motion, memory, found, out, at)
    return motion

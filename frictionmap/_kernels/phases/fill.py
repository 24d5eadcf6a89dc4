"""Cells of a map, and the steps of one motion, with and without a load."""

from typing import NamedTuple

import numpy as np

from ... import regimes
from ..compiler import entry, kernel
from ..compiler.packed import packed
from .cycles import FAILS, REPEATS, SETTLES, WANDERS, find_cycle, make_events
from .orbit import make_memory
from .problem import Cell, make_motion
from .steady import find_steady
from .tables import forget_tables

#: Columns of `Cells.numbers`; without a load the period over 1/omega_1, whether the motion settles, and the
#: time of the record.
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


class Free(NamedTuple):
    """What cells without a load have of their own; times in steps."""

    starts: np.ndarray  # (B, 2, m) modes and their velocities
    settles: np.ndarray  # (B,) int: whether steady sliding may attract
    slowest: float  # slowest period of small vibrations
    longest: float  # time that a motion is followed at most


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
def _put_motion(motion, memory, out, at):
    """Store the record of a motion in a cell."""
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
    for a in range(out.state.shape[1]):
        out.state[at, a] = memory.start[a]


@kernel
def put_cell(motion, memory, found, out, at):
    """Store a steady motion in a cell."""
    out.numbers[at, STATUS], out.numbers[at, PERIOD] = found.status, found.period
    out.numbers[at, CYCLES], out.numbers[at, MULTIPLIER] = found.cycles, found.multiplier
    out.numbers[at, AVERAGED] = found.averaged
    if found.averaged == 0:
        return
    _put_motion(motion, memory, out, at)


@kernel
def _put_friction(row, grid, cell, at):
    """Set the friction, the preloads and the constant loads of a cell."""
    _copy(grid.limit[at], cell.limit)
    _copy(grid.static[at], cell.static)
    _copy(grid.preload[at], cell.preload)
    for i in range(cell.constant.size):
        cell.constant[i] = row.h * row.h / (row.r * row.r) * grid.constant[at, i]


@entry
def _fill_loaded(problem, row, grid, cell, motion, memory, out, cancel):
    """Fill the cells of one r.

    Parameters
    ----------
    problem, row, grid, out : Problem, Row, Grid, Cells
    cell, motion, memory : Cell, Motion, Memory, overwritten
    cancel : (1,) not 0 where the rest is not wanted
    """
    problem, row, grid, out = packed(problem), packed(row), packed(grid), packed(out)
    cell, motion, memory = packed(cell), packed(motion), packed(memory)
    for at in range(grid.limit.shape[0]):
        if cancel[0] != 0:
            break
        _put_friction(row, grid, cell, at)
        forget_tables(motion.tables, cell)
        found = find_steady(problem, row, cell, motion, memory, grid.start, grid.cycles)
        put_cell(motion, memory, found, out, at)


@entry
def _fill_free(problem, row, grid, free, cell, motion, memory, events, out, cancel):
    """Fill cells without a load.

    Parameters
    ----------
    problem, row, grid, free, out : Problem, Row, Grid, Free, Cells
    cell, motion, memory, events : Cell, Motion, Memory, Events, overwritten
    cancel : (1,) not 0 where the rest is not wanted
    """
    problem, row, grid, free = packed(problem), packed(row), packed(grid), packed(free)
    cell, motion, memory, events = packed(cell), packed(motion), packed(memory), packed(events)
    out = packed(out)
    for at in range(grid.limit.shape[0]):
        if cancel[0] != 0:
            break
        _put_friction(row, grid, cell, at)
        forget_tables(motion.tables, cell)
        limits = (free.slowest, free.longest, free.settles[at] != 0)
        found = find_cycle(problem, row, cell, motion, memory, events, free.starts[at], limits)
        settled, lost = found.code == SETTLES, found.code == FAILS
        status = regimes.IRREGULAR if found.code == WANDERS else regimes.RESOLVED
        out.numbers[at, STATUS] = regimes.TOO_MANY_EVENTS if lost else status
        out.numbers[at, PERIOD] = found.time * row.h if found.code == REPEATS else np.nan
        out.numbers[at, CYCLES] = 1.0 if settled else 0.0
        out.numbers[at, MULTIPLIER] = found.multiplier
        out.numbers[at, AVERAGED] = 0.0 if settled or lost else found.time * row.h
        if not (settled or lost):
            _put_motion(motion, memory, out, at)


def _empty_cell(problem):
    """A cell without friction."""
    contacts, modes = problem.chi.shape
    return Cell(np.zeros(contacts), np.ones(contacts), np.zeros(contacts), np.zeros(modes))


def fill_cells(problem, row, grid, steps, out, cancel):
    """Fill the cells of one r; return the motion, whose record is that of the last cell.

    Parameters
    ----------
    problem, row : Problem, Row
    grid, out : Grid, Cells
    steps : steps that the record keeps
    cancel : (1,) not 0 where the rest is not wanted
    """
    motion = make_motion(problem, row, steps)
    memory = make_memory(problem, motion.tangent.shape[0])
    _fill_loaded(problem, row, grid, _empty_cell(problem), motion, memory, out, cancel)
    return motion


def fill_cycles(problem, row, grid, free, steps, out, cancel):
    """Fill cells without a load; return the motion, whose record is that of the last cell.

    Parameters
    ----------
    problem, row : Problem, Row
    grid, out : Grid, Cells
    free : Free
    steps : steps that the record keeps
    cancel : (1,) not 0 where the rest is not wanted
    """
    motion = make_motion(problem, row, steps)
    size = motion.tangent.shape[0] + 1  # the period is one more unknown
    memory, events = make_memory(problem, size), make_events(problem, size)
    _fill_free(problem, row, grid, free, _empty_cell(problem), motion, memory, events, out, cancel)
    return motion

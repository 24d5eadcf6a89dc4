"""Steady motions over mu, r and beta."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .._kernels.banks.fill import Grid, fill_cells
from .._kernels.banks.problem import Problem
from .._kernels.phases.fill import AVERAGED, Cells
from .._kernels.phases.problem import ELASTIC, REVERSALS, STUCK
from ..jobs import Job, Progress, Watch, run_counted
from ..phases.arrays import Modal, modal
from ..phases.quantities import TABLE as PHASES
from ..phases.quantities import Solved
from ..phases.solve import observed_rows
from .arrays import allocate, grid_of, modal_offset, problem_of, row_of
from .motion import Steps, steps_of
from .system import BankSystem, Start

#: Reversals of banks are counted from one period to the next already.
TABLE = PHASES | {
    "slip_reversals_per_cycle": lambda solved: solved.per_period(REVERSALS, (ELASTIC,)),
}


def solved_of(problem: Problem, cells: Cells) -> Solved:
    """Cells of a system whose rows observed are its masses and its storeys, or none."""
    contacts = problem.moved.size
    law, presses = np.full(contacts, ELASTIC), np.zeros(contacts, dtype=bool)
    observed = problem.observed.shape[0]
    return Solved(cells, law, presses, observed // 2, True, observed)


def _observed(system: BankSystem) -> np.ndarray:
    """Displacements of the points, and of the storeys."""
    return np.asarray(observed_rows(len(system.rows)) @ system.rows)


class Ratios(NamedTuple):
    """Frequency ratios > 0, and what belongs to each."""

    r: np.ndarray  # (n_r,)
    beta: np.ndarray  # (n_r, n_beta), increasing in every row
    limits: np.ndarray  # (n_r,) beta from which no element slips
    starts: Sequence[Start]


def sweep_banks(
    system: BankSystem, ratios: Ratios, outputs: Sequence[str], masses: bool, cycles: int, threads: int,
    progress: Progress | None, watch: Watch | None, places: bool = True,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Steady motions over r and beta.

    Parameters
    ----------
    system : BankSystem
    ratios : Ratios
    outputs : names of `phases.quantities.TABLE`
    masses : whether they need displacements of the masses
    cycles : periods of the load that a motion is followed at most
    threads, progress, watch : as in `sweep`
    places : whether outputs are wanted that depend on the places of elements that never slip

    Returns
    -------
    dict
        Arrays (n_r, n_beta, ...) by name; of contacts or masses with a last dimension.
    """
    modes = modal(system)  # type: ignore[arg-type]  # it has the three matrices
    problem = problem_of(system, modes, _observed(system) if masses else np.zeros((0, system.n)))
    cancel = np.zeros(1, np.uint8)
    jobs: list[Job] = []
    found: list[Cells] = []
    for one, beta, start in zip(ratios.r, ratios.beta, ratios.starts, strict=True):
        found.append(allocate(problem, beta.size))
        row = row_of(system, problem, modes, float(one))
        grid = grid_of(system, modes, beta, start, cycles, places)
        jobs.append((fill_cells, (problem, row, grid, 0, found[-1], cancel)))
    try:
        run_counted(jobs, threads, progress, watch)
    except BaseException:
        cancel[0] = 1
        raise
    for cells, beta, limit in zip(found, ratios.beta, ratios.limits, strict=True):
        _put_still(cells, beta, float(limit))
        _put_offset(problem, cells, modal_offset(system, modes))
    solved = [solved_of(problem, one) for one in found]
    return {name: np.stack([TABLE[name](one) for one in solved]) for name in outputs}


def _put_offset(problem: Problem, cells: Cells, offset: np.ndarray | None) -> None:
    """Add displacements of the modes under constant loads to the extremes."""
    if offset is None:
        return
    shift = np.concatenate((problem.observed, problem.chi)) @ offset
    for ends in (cells.low, cells.high):
        ends[:, : shift.size] += shift


def _put_still(cells: Cells, beta: np.ndarray, limit: float) -> None:
    """Let no element slip where friction holds them all: rounding at their limits is no slip."""
    still = (beta >= limit) & (cells.numbers[:, AVERAGED] > 0.0)
    cells.counts[still] = 0.0
    cells.counts[still, STUCK] = 2.0 * np.pi
    cells.work[still] = cells.distance[still] = 0.0


class Found(NamedTuple):
    """A steady motion, with the names of `phases.solve.Found`."""

    problem: Problem
    modes: Modal
    shapes: np.ndarray  # (p, m) displacements of the points by the modes
    numbers: dict[str, np.ndarray]  # outputs
    averaged: int  # periods of the load that its steps cover; 0: none was found
    period: int
    steps: Steps | None
    stretch: np.ndarray | None = None  # (E,) elongations of the springs of the elements at the section


def find_motion(system: BankSystem, r: float, beta: float, limit: float, start: Start, cycles: int) -> Found:
    """Find one steady motion and its steps; arguments as of `sweep_banks`."""
    modes = modal(system)  # type: ignore[arg-type]
    problem = problem_of(system, modes, _observed(system))
    row = row_of(system, problem, modes, r)
    grid = grid_of(system, modes, np.array([beta]), start, cycles)
    cells, motion = _one(problem, row, grid, 0)
    _put_still(cells, np.array([beta]), limit)
    offset = modal_offset(system, modes)
    _put_offset(problem, cells, offset)
    numbers = {name: values(solved_of(problem, cells))[0] for name, values in TABLE.items()}
    shapes = system.rows @ modes.phi
    averaged = int(np.nan_to_num(cells.numbers[0, AVERAGED]))
    if averaged <= 0:
        return Found(problem, modes, shapes, numbers, 0, 0, None)
    _, motion = _one(problem, row, grid, int(motion.record.count[0]))
    stretch = _stretch(problem, grid.limit[0], motion)
    return Found(
        problem, modes, shapes, numbers, averaged, averaged, steps_of(problem, motion, offset), stretch
    )  # fmt: skip


def _stretch(problem: Problem, limit: np.ndarray, motion: Any) -> np.ndarray:
    """Elongations of the springs of the elements (E,) of a motion at the section; its load is that there."""
    now = motion.now
    z = problem.chi @ now.q - problem.moved * motion.loads[0, -1]
    many = np.diff(problem.first)
    contact = np.repeat(np.arange(many.size), many)
    slips = np.arange(contact.size) - problem.first[contact] < now.level[contact]
    held = z[contact] - now.place + now.side * limit
    return np.where(slips, now.sense[contact] * limit, held)


def _one(problem: Problem, row: Any, grid: Grid, steps: int) -> tuple[Cells, Any]:
    """One cell, and the motion whose record keeps its steps."""
    cells = allocate(problem, 1)
    return cells, fill_cells(problem, row, grid, steps, cells, np.zeros(1, np.uint8))

"""Steady motions over mu, r and beta."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from .._kernels.phases.fill import AVERAGED, PERIOD, Cells, Grid, fill_cells
from .._kernels.phases.problem import Problem
from ..errors import InputError
from ..jobs import Job, Progress, Watch, run_counted
from .arrays import Modal, allocate, grid_of, modal, problem_of, row_of
from .motion import Steps, events, in_time, steps_of, works
from .quantities import TABLE, Solved, solved_of
from .system import PhaseSystem

#: Outputs where none are named.
OUTPUTS = ("regime", "status", "period", "contact_amplitude", "open_fraction")

#: Cycles of a motion that does not repeat that are shown.
_SHOWN = 8

Start = Any  # "rest", "moving", or a state (2, n): displacements and velocities over omega at tau = 0


def observed_rows(n: int) -> np.ndarray:
    """Displacements of the masses, and of the storeys."""
    whole = np.eye(n)
    return np.concatenate((whole, whole - np.eye(n, k=-1)))


def start_state(system: PhaseSystem, modes: Modal, r: float, start: Start) -> np.ndarray:
    """Modes and their velocities at tau = 0, (2, m).

    "moving" is the steady motion of the structure without contacts and springs.
    """
    state = np.zeros((2, system.n))
    if isinstance(start, str):
        checks.choice(start, "start", ("rest", "moving"))
        for n, load in system.loads.items() if start == "moving" else ():
            dynamic = np.diag(modes.squares) - (n * r) ** 2 * np.eye(system.n) + 1j * n * r * modes.damping
            q = np.linalg.solve(dynamic, modes.phi.T @ load)
            state += np.stack((q.real, -n * q.imag))
        return state
    given = checks.array(start, "start").astype(float)
    if given.shape != (2, system.n) or not np.isfinite(given).all():
        raise InputError("start", f"must be a state (2, {system.n}); got shape {given.shape}")
    return np.stack([np.linalg.solve(modes.phi, one) for one in given])


def _unknown(outputs: Sequence[str]) -> None:
    for name in outputs:
        if name not in TABLE:
            raise InputError(
                f"unknown output {name!r}{checks.nearest(name, list(TABLE))}; valid: {', '.join(TABLE)}"
            )


def sweep_phases(
    system: PhaseSystem, r: np.ndarray, beta: np.ndarray, mu: np.ndarray,
    outputs: Sequence[str] = OUTPUTS, start: Start = "rest", cycles: int = 2000, threads: int = 1,
    progress: Progress | None = None, watch: Watch | None = None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Steady motions over mu, r > 0 and beta.

    Parameters
    ----------
    system : PhaseSystem
    r, beta, mu : axes
    outputs : names of `quantities.TABLE`
    start : "rest", "moving", or a state (2, n)
    cycles : periods of the load that a motion is followed at most
    threads, progress, watch : as in `sweep`

    Returns
    -------
    dict
        Arrays (n_mu, n_r, n_beta, ...) by name; of contacts, masses or springs with a last dimension.
    """
    _unknown(outputs)
    r, beta, mu = (np.atleast_1d(np.asarray(axis, dtype=float)) for axis in (r, beta, mu))
    rows = [(float(one), float(ratio), beta) for ratio in mu for one in r]
    solved = solve_rows(system, rows, observed_rows(system.n), start, cycles, threads, progress, watch)
    shape = (mu.size, r.size, beta.size)
    tables = {name: np.stack([TABLE[name](one) for one in solved]) for name in outputs}
    return {name: table.reshape(shape + table.shape[2:]) for name, table in tables.items()}


def solve_rows(
    system: PhaseSystem, rows: Sequence[tuple[float, float, np.ndarray]], observed: np.ndarray,
    start: Start, cycles: int, threads: int, progress: Progress | None, watch: Watch | None,
) -> list[Solved]:  # fmt: skip
    """Steady motions of rows of cells, each of one r and mu over some beta.

    observed : (R, n) displacements whose extremes are wanted; the first ones are those of `observed_rows`
    """
    modes = modal(system)
    problem = problem_of(system, modes, observed)
    cancel = np.zeros(1, np.uint8)
    jobs: list[Job] = []
    found: list[Cells] = []
    for r, mu, beta in rows:
        grid = grid_of(system, modes, beta, mu, cycles)
        grid = grid._replace(start=start_state(system, modes, r, start))
        found.append(allocate(problem, beta.size))
        jobs.append((fill_cells, (problem, row_of(system, problem, modes, r), grid, 0, found[-1], cancel)))
    try:
        run_counted(jobs, threads, progress, watch)
    except BaseException:
        cancel[0] = 1
        raise
    return [solved_of(problem, one) for one in found]


def response_phases(
    system: PhaseSystem, r: float, beta: float, mu: float, points: int = 1000, start: Start = "rest",
    cycles: int = 2000,
) -> dict[str, np.ndarray]:  # fmt: skip
    """One steady motion over its cycle: traces over tau, events, and all outputs as numbers.

    A motion that does not repeat is shown for some periods.

    Parameters
    ----------
    system : PhaseSystem
    r, beta, mu : the cell
    points : times per period of the load
    start, cycles : as in `sweep_phases`

    Returns
    -------
    dict
        tau (T,), traces (..., T), events, numbers of the motion; without traces where none was found.
    """
    one = find_motion(system, r, beta, mu, start, cycles)
    if one.steps is None:
        return one.numbers
    shown = one.period or min(_SHOWN, one.averaged)
    tau = np.linspace(0.0, 2.0 * np.pi * shown, shown * points + 1)
    traces = in_time(system, one.problem, one.modes, one.steps, one.preload, tau)
    works_of = works(system, one.modes, one.steps, r, one.averaged)
    return {"tau": tau, **traces, **events(one.steps), **one.numbers, **works_of}


class Found(NamedTuple):
    """A steady motion, or the last periods of a motion that does not repeat."""

    problem: Problem
    modes: Modal
    preload: np.ndarray  # (N,) N0
    numbers: dict[str, np.ndarray]  # outputs
    averaged: int  # periods of the load that its steps cover; 0: none was found
    period: int  # of the steady motion; 0: it does not repeat
    steps: Steps | None


def find_motion(
    system: PhaseSystem, r: float, beta: float, mu: float, start: Start = "rest", cycles: int = 2000
) -> Found:
    """Find one steady motion and its steps; arguments as of `response_phases`."""
    modes = modal(system)
    problem = problem_of(system, modes, observed_rows(system.n))
    row = row_of(system, problem, modes, r)
    grid = grid_of(system, modes, np.array([beta]), mu, cycles)
    grid = grid._replace(start=start_state(system, modes, r, start))
    cells, motion = _one(problem, row, grid, 0)
    averaged = int(np.nan_to_num(cells.numbers[0, AVERAGED]))
    numbers = {name: values(solved_of(problem, cells))[0] for name, values in TABLE.items()}
    if averaged <= 0:
        return Found(problem, modes, grid.preload[0], numbers, 0, 0, None)
    cells, motion = _one(problem, row, grid, int(motion.record.count[0]))
    period, steps = int(cells.numbers[0, PERIOD]), steps_of(problem, row, motion)
    return Found(problem, modes, grid.preload[0], numbers, averaged, period, steps)


def _one(problem: Any, row: Any, grid: Grid, steps: int) -> tuple[Cells, Any]:
    """One cell, and the motion whose record keeps its steps."""
    cells = allocate(problem, 1)
    return cells, fill_cells(problem, row, grid, steps, cells, np.zeros(1, np.uint8))

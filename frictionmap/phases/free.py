"""Steady motions without a load over mu, belt speed and beta: steady sliding, and cycles."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from .. import checks, regimes
from .._kernels.general.problem import TURN
from .._kernels.phases.fill import (
    AVERAGED,
    CYCLES,
    MULTIPLIER,
    PERIOD,
    STATUS,
    Cells,
    Free,
    fill_cycles,
)
from .._kernels.phases.problem import ELASTIC, LIFTOFFS, STOPS, TURNS, Problem, Row, make_row
from ..errors import InputError
from ..jobs import Job, Progress, Watch, run_counted
from .arrays import Modal, allocate, fastest, grid_of, modal, problem_of
from .attraction import attracts
from .motion import events, in_time, steps_of, works
from .quantities import FREE_TABLE, solved_of
from .sliding import Sliding, steady_sliding
from .solve import observed_rows, start_state
from .system import PhaseSystem

#: Outputs where none are named.
OUTPUTS = ("regime", "status", "cycle_period", "growth", "contact_amplitude", "open_fraction")

#: Outputs that are no numbers of one motion.
OTHERS = ("growth", "growth_frequency", "also_reachable")

#: Starts: at rest, next to steady sliding, far from it.
STARTS = ("rest", "sliding", "far")

#: Distance of the start next to steady sliding, and of that far from it, over the displacement there.
_NEXT, _FAR = 1e-3, 10.0

#: Times that a motion is followed on from where it seems to settle.
_MOST_QUIET = 2000

#: Part of the slowest period over which it is followed where Newton's method finds steady sliding as a cycle.
_SHORT = 0.5

#: Range of a motion, over its displacement, below which it is a place with rounding errors.
_STILL = 1e-9


def free_row(system: PhaseSystem, problem: Problem, size: float) -> Row:
    """The constants without a load; `size` is a displacement that friction causes."""
    belt = np.array([one.belt for one in system.contacts], dtype=float)
    none = np.zeros((2, 0, system.n + 1))
    row = make_row(problem, 1.0, TURN / fastest(problem), 0, belt, np.zeros(0), none)
    return row._replace(size=size)


def _state(system: PhaseSystem, modes: Modal, sliding: Sliding, start: Any) -> np.ndarray:
    """Modes and their velocities at the start, (2, m); NaN without one."""
    if not (isinstance(start, str) and start != "rest"):
        return start_state(system, modes, 1.0, start)
    checks.choice(start, "start", STARTS)
    size = np.abs(sliding.place).max()
    x, v = sliding.place, np.full(system.n, _NEXT * size)
    if start == "far":
        x, v = x + _FAR * size, np.full(system.n, -_FAR * size)
    return np.stack([np.linalg.solve(modes.phi, one) for one in (x, v)])


def at_speed(system: PhaseSystem, speed: float) -> PhaseSystem:
    """The system with this speed of its first belt that moves; others keep the quotient of their speeds."""
    first = next(one.belt for one in system.contacts if one.belt)
    contacts = [
        replace(one, wall_speed=one.belt / first * speed, wall_velocity=0.0) for one in system.contacts
    ]
    return replace(system, contacts=contacts)


def _check(system: PhaseSystem) -> None:
    if not any(one.belt for one in system.contacts):
        raise InputError("wall_speed", "must not be 0 in every contact without a load; got 0")
    if system.loads or system.base:
        raise InputError("cannot use", "load", "without r: a load gives the period; omit one")


class _Line:
    """Cells of one mu and belt speed, from several starts."""

    def __init__(
        self, system: PhaseSystem, problem: Problem, modes: Modal, beta: np.ndarray, mu: float,
        starts: Sequence[Any], cycles: int,
    ) -> None:  # fmt: skip
        self.system, self.problem, self.modes = system, problem, modes
        grid = grid_of(system, modes, beta, mu, cycles)
        self.sliding = [steady_sliding(system, *one) for one in zip(grid.limit, grid.preload, strict=True)]
        size = max((float(np.abs(one.place).max()) for one in self.sliding), default=1.0)
        row = free_row(system, problem, size if 0.0 < size < np.inf else 1.0)
        slowest = 2.0 * np.pi / np.sqrt(np.abs(modes.squares).min()) / row.h
        settles = np.array([not one.growth >= 0.0 for one in self.sliding], dtype=np.int64)
        self.cells, self.inputs = [], []
        for start in starts:
            states = np.array([_state(system, modes, one, start) for one in self.sliding])
            self.cells.append(allocate(problem, beta.size))
            self.inputs.append((problem, row, grid, Free(states, settles, slowest, cycles * slowest)))

    def jobs(self, cancel: np.ndarray) -> list[Job]:
        """The jobs that fill the cells."""
        return [(self.fill, (k, cancel)) for k in range(len(self.cells))]

    def fill(self, k: int, cancel: np.ndarray) -> None:
        """Fill the cells of one start."""
        cells = self.cells[k]
        fill_cycles(*self.inputs[k], 0, cells, cancel)
        for at in np.flatnonzero((cells.numbers[:, CYCLES] == 1.0) | is_still(cells, self.system.n)).tolist():
            self.follow_on(k, at, cancel)
        put_silent(cells, self.sliding)

    def follow_on(self, k: int, at: int, cancel: np.ndarray) -> None:
        """Follow a motion that seems to settle until it certainly does, or does something else.

        The cell gets what the motion does then, and its start in `inputs` the last state followed from.
        """
        problem, row, grid, free = self.inputs[k]
        one, sliding = allocate(problem, 1), self.sliding[at]
        own = grid._replace(
            limit=grid.limit[at : at + 1], static=grid.static[at : at + 1],
            preload=grid.preload[at : at + 1], constant=grid.constant[at : at + 1],
        )  # fmt: skip
        alone = Free(free.starts[at : at + 1].copy(), free.settles[at : at + 1], free.slowest, free.longest)
        most = 1 if (problem.law == ELASTIC).any() else _MOST_QUIET  # their forces are lost in a new start
        is_short = False
        for _ in range(most):
            motion = fill_cycles(problem, row, own, alone, 0, one, cancel)
            if cancel[0] != 0:
                return
            if is_still(one, self.system.n)[0]:
                longest = 0.5 * alone.longest if is_short else _SHORT * free.slowest
                alone, is_short = alone._replace(longest=longest, settles=np.zeros(1, np.int64)), True
                continue
            if one.numbers[0, CYCLES] != 1.0 and not (
                is_short and one.numbers[0, STATUS] == regimes.IRREGULAR
            ):
                for part, whole in zip(one, self.cells[k], strict=True):
                    whole[at] = part[0]
                free.starts[at] = alone.starts[0]
                return
            state = np.stack((motion.q[: self.system.n], motion.p[: self.system.n] / row.h))
            x, v = state @ self.modes.phi.T
            if attracts(self.system, sliding, own.preload[0], x, v, motion.sense):
                put_settled(self.cells[k], at)
                return
            alone = alone._replace(starts=state[np.newaxis].copy())
        put_lost(self.cells[k], at)

    def outputs(self, names: Sequence[str]) -> dict[str, np.ndarray]:
        """Outputs of the motions that the first start leads to."""
        for cells in self.cells:
            put_sliding(self.problem, cells, self.sliding)
        solved = [solved_of(self.problem, one, loaded=False) for one in self.cells]
        others = {
            "growth": np.array([one.growth for one in self.sliding]),
            "growth_frequency": np.array([one.frequency for one in self.sliding]),
            "also_reachable": reachable([FREE_TABLE["regime"](one) for one in solved], self.sliding),
        }
        return {name: others[name] if name in others else FREE_TABLE[name](solved[0]) for name in names}


def reachable(found: Sequence[np.ndarray], sliding: Sequence[Sliding]) -> np.ndarray:
    """Bits of the regimes that some start leads to, and of steady sliding where it is stable."""
    bits = np.array([one.is_stable << regimes.STEADY_SLIDING for one in sliding], dtype=np.uint8)
    for each in found:
        bits |= np.where(each >= 0, 1 << np.maximum(each, 0).astype(np.int64), 0).astype(np.uint8)
    return bits


def put_lost(cells: Cells, at: int) -> None:
    """Say that no motion was reached in a cell."""
    cells.numbers[at, STATUS], cells.numbers[at, PERIOD] = regimes.NOT_REACHED, np.nan
    cells.numbers[at, CYCLES] = cells.numbers[at, AVERAGED] = 0.0


def put_settled(cells: Cells, at: int) -> None:
    """Say that the motion of a cell ends in steady sliding."""
    cells.numbers[at, STATUS], cells.numbers[at, CYCLES] = regimes.RESOLVED, 1.0
    cells.numbers[at, [PERIOD, MULTIPLIER]], cells.numbers[at, AVERAGED] = np.nan, 0.0
    for counts in (cells.counts, cells.low, cells.high, cells.work, cells.belt_work, cells.distance):
        counts[at] = np.nan
    cells.crossings[at] = cells.spring_force[at] = np.nan


def is_still(cells: Cells, n: int) -> np.ndarray:
    """Cycles that are a place: Newton's method finds steady sliding too, which closes over any time."""
    low, high = cells.low[:, :n], cells.high[:, :n]
    size = np.maximum(np.abs(low), np.abs(high)).max(axis=1)
    return (cells.numbers[:, PERIOD] > 0.0) & ((high - low).max(axis=1) <= _STILL * size)


def put_silent(cells: Cells, sliding: Sequence[Sliding]) -> None:
    """Tell motions that nothing drives or damps, and those near another equilibrium, from irregular ones."""
    for at in np.flatnonzero(cells.numbers[:, STATUS] == regimes.IRREGULAR).tolist():
        counts = cells.counts[at, [STOPS, TURNS, LIFTOFFS]]
        if sliding[at].growth == 0.0:
            cells.numbers[at, STATUS] = regimes.MARGINAL
        elif not counts.any() and not cells.crossings[at].any():
            put_lost(cells, at)


def put_sliding(problem: Problem, cells: Cells, sliding: Sequence[Sliding]) -> None:
    """Fill cells that settle in steady sliding."""
    n, count = problem.observed.shape[0] // 2, problem.law.size
    for at in np.flatnonzero(cells.numbers[:, CYCLES] == 1.0):
        one = sliding[int(at)]
        x = one.place
        storeys = np.diff(x, prepend=0.0)
        cells.low[at, : 2 * n] = cells.high[at, : 2 * n] = np.concatenate((x, storeys))
        cells.low[at, 2 * n + count : 2 * n + 2 * count] = one.normal_force
        cells.high[at, 2 * n + count : 2 * n + 2 * count] = one.normal_force


def sweep_free(
    system: PhaseSystem, wall_speed: np.ndarray, beta: np.ndarray, mu: np.ndarray,
    outputs: Sequence[str] = OUTPUTS, starts: Sequence[Any] = STARTS, cycles: int = 2000, threads: int = 1,
    progress: Progress | None = None, watch: Watch | None = None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Steady motions without a load over mu, belt speed and beta.

    Parameters
    ----------
    system : PhaseSystem
        Contacts whose wall moves get the speed of the axis.
    wall_speed, beta, mu : axes
    outputs : names of `quantities.FREE_TABLE`, or of `OTHERS`
    starts : "rest", "sliding", "far", or states (2, n); all but `also_reachable` is of the first
    cycles : slowest periods of small vibrations that a motion is followed at most
    threads, progress, watch : as in `sweep`

    Returns
    -------
    dict
        Arrays (n_mu, n_wall_speed, n_beta, ...) by name.
    """
    _check(system)
    valid = [*FREE_TABLE, *OTHERS]
    for name in outputs:
        if name not in valid:
            raise InputError(
                f"unknown output {name!r}{checks.nearest(name, valid)}; valid: {', '.join(valid)}"
            )
    wall_speed, beta, mu = (np.atleast_1d(np.asarray(axis, dtype=float)) for axis in (wall_speed, beta, mu))
    modes = modal(system)
    problem = problem_of(system, modes, observed_rows(system.n))
    cancel = np.zeros(1, np.uint8)
    lines = [
        _Line(at_speed(system, float(v)), problem, modes, beta, float(ratio), starts, cycles)
        for ratio in mu
        for v in wall_speed
    ]
    try:
        run_counted([job for line in lines for job in line.jobs(cancel)], threads, progress, watch)
    except BaseException:
        cancel[0] = 1
        raise
    found = [line.outputs(outputs) for line in lines]
    shape = (mu.size, wall_speed.size, beta.size)
    tables = {name: np.stack([one[name] for one in found]) for name in outputs}
    return {name: table.reshape(shape + table.shape[2:]) for name, table in tables.items()}


def response_free(
    system: PhaseSystem, beta: float, mu: float, points: int = 1000, start: Any = "rest", cycles: int = 2000
) -> dict[str, np.ndarray]:
    """One motion without a load over its cycle; as `response_phases`, with `tau` over 1/omega_1."""
    _check(system)
    modes = modal(system)
    problem = problem_of(system, modes, observed_rows(system.n))
    line = _Line(system, problem, modes, np.array([beta]), mu, [start], cycles)
    given, cells = line.inputs[0], line.cells[0]
    line.fill(0, np.zeros(1, np.uint8))
    numbers = {name: values[0] for name, values in line.outputs([*FREE_TABLE, *OTHERS]).items()}
    if not cells.numbers[0, AVERAGED] > 0.0:
        return numbers
    count = fill_cycles(*given, 0, cells, np.zeros(1, np.uint8)).record.count[0]
    motion = fill_cycles(*given, int(count), cells, np.zeros(1, np.uint8))
    steps = steps_of(problem, given[1], motion)
    numbers |= works(system, modes, steps, 1.0, 1)
    period = float(cells.numbers[0, PERIOD])
    length = period if period > 0.0 else float(cells.numbers[0, AVERAGED])
    tau = np.linspace(0.0, length, points + 1)
    traces = in_time(system, problem, modes, steps, given[2].preload[0], tau)
    return {"tau": tau, **traces, **events(steps), **numbers}

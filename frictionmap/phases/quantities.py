"""Outputs of cells: names, what they are computed from, per contact, mass or spring."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.phases.fill import AVERAGED, CYCLES, MULTIPLIER, PERIOD, STATUS, Cells
from .._kernels.phases.problem import (
    ELASTIC,
    FIRST,
    LAST,
    LIFTOFFS,
    MOVED,
    OPEN,
    REVERSALS,
    RIGID,
    SLIPS,
    SMOOTH,
    STOPS,
    STUCK,
    TURNS,
    Problem,
)

_TURN = 2.0 * np.pi


class Solved(NamedTuple):
    """Cells of one frequency ratio or belt speed, of n masses, N contacts and S springs."""

    cells: Cells
    law: np.ndarray  # (N,)
    presses: np.ndarray  # (N,) bool
    n: int
    loaded: bool  # whether there is a load, whose periods are cycles
    observed: int  # rows observed: masses, storeys and further ones

    def rows(self, first: int, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest values of some rows."""
        return self.cells.low[:, first : first + count], self.cells.high[:, first : first + count]

    @property
    def masses(self) -> tuple[np.ndarray, np.ndarray]:
        return self.rows(0, self.n)

    @property
    def storeys(self) -> tuple[np.ndarray, np.ndarray]:
        return self.rows(self.n, self.n)

    @property
    def further(self) -> tuple[np.ndarray, np.ndarray]:
        return self.rows(2 * self.n, self.observed - 2 * self.n)

    @property
    def contacts(self) -> tuple[np.ndarray, np.ndarray]:
        return self.rows(self.observed, self.law.size)

    @property
    def normal_forces(self) -> tuple[np.ndarray, np.ndarray]:
        return self.rows(self.observed + self.law.size, self.law.size)

    @property
    def recorded(self) -> np.ndarray:
        """Time of the record, (B, 1); NaN where there is none."""
        found = self.cells.numbers[:, AVERAGED] * (_TURN if self.loaded else 1.0)
        return np.where(found > 0.0, found, np.nan)[:, np.newaxis]

    @property
    def periods(self) -> np.ndarray:
        """Cycles of the record, (B, 1); NaN where there is none, and of cycles that do not repeat."""
        if self.loaded:
            return self.recorded / _TURN
        return self.recorded / self.cells.numbers[:, PERIOD, np.newaxis]

    def per_period(self, what: int, laws: tuple[int, ...] = (RIGID, ELASTIC)) -> np.ndarray:
        """A counter per cycle; NaN for contacts of other laws."""
        return np.where(np.isin(self.law, laws), self.cells.counts[:, what] / self.periods, np.nan)

    def share(self, what: int, laws: tuple[int, ...] = (RIGID, ELASTIC)) -> np.ndarray:
        """A time over that of the record; NaN for contacts of other laws."""
        return np.where(np.isin(self.law, laws), self.cells.counts[:, what] / self.recorded, np.nan)


def contact_regimes(solved: Solved) -> np.ndarray:
    """Regime of every contact, (B, N)."""
    counts = solved.cells.counts
    still = (counts[:, MOVED] == 0.0) & (counts[:, OPEN] == 0.0)
    found = np.full(still.shape, regimes.STICK_SLIP)
    found[counts[:, STUCK] == 0.0] = regimes.CONTINUOUS
    one_way = (counts[:, STUCK] == 0.0) & (counts[:, OPEN] == 0.0) & (counts[:, MOVED] < 3.0)
    found[one_way & ~still] = regimes.ONE_WAY_SLIDING
    found[(found == regimes.CONTINUOUS) & (solved.law == ELASTIC)] = regimes.STICK_SLIP  # it slips
    found[still] = regimes.PERMANENT_STICKING
    found[:, solved.law == SMOOTH] = regimes.CONTINUOUS
    found[np.isnan(solved.recorded[:, 0])] = regimes.UNRESOLVED
    return found


def regime(solved: Solved) -> np.ndarray:
    """Regime of every cell, (B,)."""
    each = contact_regimes(solved)
    if each.shape[1] == 0:
        known = ~np.isnan(solved.recorded[:, 0])
        return np.where(known, regimes.CONTINUOUS, regimes.UNRESOLVED)
    least, most = each.min(axis=1), each.max(axis=1)
    found = np.full(least.shape, regimes.STICK_SLIP)
    found[least >= regimes.CONTINUOUS] = regimes.CONTINUOUS
    if each.shape[1] == 1:
        found[least == regimes.ONE_WAY_SLIDING] = regimes.ONE_WAY_SLIDING
    found[most == regimes.PERMANENT_STICKING] = regimes.PERMANENT_STICKING
    found[most == regimes.UNRESOLVED] = regimes.UNRESOLVED
    return found


def _number(column: int, kind: type = np.float64) -> Callable[[Solved], np.ndarray]:
    return lambda solved: solved.cells.numbers[:, column].astype(kind)


def _half_range(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return 0.5 * (ends[1] - ends[0])


def _largest(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return np.maximum(np.abs(ends[0]), np.abs(ends[1]))


def _middle(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return 0.5 * (ends[0] + ends[1])


def _normal_only(values: Callable[[Solved], np.ndarray]) -> Callable[[Solved], np.ndarray]:
    """Values of contacts whose normal force moves; NaN for others."""
    return lambda solved: np.where(solved.presses, values(solved), np.nan)


def _reversals(solved: Solved) -> np.ndarray:
    """Reversals of the sense of slip per cycle; that from the last slip to the first one counts, too."""
    counts, status = solved.cells.counts, solved.cells.numbers[:, STATUS, np.newaxis]
    closes = (status == regimes.RESOLVED) & (counts[:, LAST] * counts[:, FIRST] < 0.0)
    return solved.per_period(REVERSALS, (ELASTIC,)) + closes / solved.periods


def _origin(solved: Solved) -> np.ndarray:
    resolved = solved.cells.numbers[:, STATUS] == regimes.RESOLVED
    return np.where(resolved, regimes.PERIODIC_ORBIT, regimes.INTEGRATED).astype(np.int8)


#: Outputs by name: (B,), (B, N) of contacts, (B, n) of masses or (B, S) of springs.
TABLE: dict[str, Callable[[Solved], np.ndarray]] = {
    "regime": regime,
    "contact_regime": contact_regimes,
    "status": _number(STATUS, np.int8),
    "period": _number(PERIOD, np.int32),
    "cycles": _number(CYCLES, np.int64),
    "origin": _origin,
    "multiplier": _number(MULTIPLIER),
    "unique": lambda solved: np.zeros(len(solved.cells.numbers), np.int8),
    "stops_per_cycle": lambda solved: solved.per_period(STOPS, (RIGID,)),
    "turns_per_cycle": lambda solved: solved.per_period(TURNS, (RIGID,)),
    "stuck_fraction": lambda solved: solved.share(STUCK, (RIGID,)),
    "slips_per_cycle": lambda solved: solved.per_period(SLIPS, (ELASTIC,)),
    "slip_reversals_per_cycle": _reversals,
    "elastic_fraction": lambda solved: solved.share(STUCK, (ELASTIC,)),
    "open_fraction": _normal_only(lambda solved: solved.share(OPEN, (RIGID, ELASTIC, SMOOTH))),
    "separations_per_cycle": _normal_only(
        lambda solved: solved.per_period(LIFTOFFS, (RIGID, ELASTIC, SMOOTH))
    ),
    "normal_force_min": _normal_only(lambda solved: np.maximum(solved.normal_forces[0], 0.0)),  # rounding
    "normal_force_max": _normal_only(lambda solved: solved.normal_forces[1]),
    "contact_amplitude": lambda solved: _largest(solved.contacts),
    "contact_peak_to_peak": lambda solved: 2.0 * _half_range(solved.contacts),
    "contact_midpoint": lambda solved: _middle(solved.contacts),
    "sliding_distance": lambda solved: solved.cells.distance / solved.periods,
    "work_friction": lambda solved: np.maximum(solved.cells.work / solved.periods, 0.0),  # rounding
    "work_wall": lambda solved: solved.cells.belt_work / solved.periods,
    "amplitude": lambda solved: _largest(solved.masses),
    "peak_to_peak": lambda solved: 2.0 * _half_range(solved.masses),
    "midpoint": lambda solved: _middle(solved.masses),
    "drift": lambda solved: _half_range(solved.storeys),
    "spring_crossings": lambda solved: solved.cells.crossings / solved.periods,
    "spring_force_max": lambda solved: solved.cells.spring_force,
}


def free_regime(solved: Solved) -> np.ndarray:
    """Regime of every cell without a load, (B,)."""
    numbers = solved.cells.numbers
    stuck = (solved.cells.counts[:, STUCK] > 0.0).any(axis=1)
    found = np.where(stuck, regimes.STICK_SLIP_CYCLE, regimes.CYCLE_WITHOUT_STOPS)
    found[numbers[:, CYCLES] == 1.0] = regimes.STEADY_SLIDING
    lost = (numbers[:, CYCLES] != 1.0) & ~(numbers[:, AVERAGED] > 0.0)
    return np.where(lost, regimes.UNRESOLVED, found).astype(np.int8)


#: Outputs of cells without a load: some others are of loads alone.
FREE_TABLE = {
    name: values
    for name, values in TABLE.items()
    if name not in ("contact_regime", "period", "cycles", "origin")
} | {"regime": free_regime, "cycle_period": _number(PERIOD)}


def solved_of(problem: Problem, cells: Cells, loaded: bool = True) -> Solved:
    """Cells of a system whose rows observed begin with its masses and its storeys."""
    n = problem.squares.size
    return Solved(cells, problem.law, problem.presses, n, loaded, problem.observed.shape[0])

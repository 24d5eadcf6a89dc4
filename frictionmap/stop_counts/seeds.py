"""Where borders are looked for: neighbouring cells with different numbers of stops, and their orbits."""

from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.engine import segment_table
from .._kernels.engine.fill import one_cell
from ..model.settings import Output, Solver, Start
from ..model.system import System
from ..single.cells import Cells, limits
from ..single.maps import compute
from ..single.scattered import AT_ONCE, scattered_cells
from ..theory.boundary_curves import find_curves
from .orbits import Sequence
from .tracing import Window

#: Part of the friction ratios of a map that is spaced in proportion.
_PROPORTIONAL = 0.3

#: Blocks of frequencies in a map, and the least beta searched in one, relative to its largest: each block is
#: searched where motions stop and slide in it, which for small r may be a small part of the window.
_BLOCKS, _LEAST = 20, 1e-4

#: Bisections of a bracket in beta: of a map of 160 rows to a relative width of 1e-5 and less.
_BISECTIONS = 17

_OUTPUTS: tuple[Output, ...] = ("regime", "stops_per_cycle", "status")

#: Solvers for mu > 1 by their initial state.  The orbits sought settle within some cycles; irregular motions,
#: of which there are many, would be followed for all.
_CYCLES = 200
_UNIQUE = Solver(outputs=_OUTPUTS)
_SEVERAL: dict[Start, Solver] = {
    "rest": Solver(start="rest", cycles=_CYCLES, outputs=_OUTPUTS),
    "moving": Solver(start="moving", cycles=_CYCLES, outputs=_OUTPUTS),
}


class Source(NamedTuple):
    """Where steady states are taken from: a system, mu, and the initial state."""

    system: System
    mu: float
    start: Start = "rest"

    @property
    def solver(self) -> Solver:
        """The solver of the maps."""
        return _UNIQUE if self.mu == 1.0 else _SEVERAL[self.start]


class Seeds(NamedTuple):
    """Brackets in beta between cells with different numbers of stops; arrays (k,)."""

    r: np.ndarray
    low: np.ndarray
    high: np.ndarray
    below: np.ndarray  # stops per cycle at low
    above: np.ndarray


def counts_at(source: Source, r: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Stops per cycle at points (k,); NaN where the contact sticks or no steady state was reached."""
    order = np.argsort(r, kind="stable")
    found = np.empty(r.size)
    for first in range(0, r.size, AT_ONCE):
        which = order[first : first + AT_ONCE]
        cells = scattered_cells(source.system, r[which], beta[which], source.mu, source.solver)
        place = (0, np.arange(which.size), cells.column)
        resolved = cells.out.status[place] == regimes.RESOLVED
        found[which] = np.where(resolved, cells.out.stops_per_cycle[place], np.nan)
    return found


def seeds_of_map(source: Source, window: Window, r: np.ndarray, count: int) -> Seeds:
    """Brackets of all changes of the number of stops along beta in a map with `count` friction ratios."""
    found = [_block_seeds(source, window, block, count) for block in np.array_split(r, _BLOCKS)]
    return Seeds(*(np.concatenate(arrays) for arrays in zip(*found, strict=True)))


def _block_seeds(source: Source, window: Window, r: np.ndarray, count: int) -> Seeds:
    """Brackets along beta in one block of frequencies; see `seeds_of_map`."""
    mu = np.array([source.mu])
    curves = find_curves(source.system, r, mu)
    beta = _friction_of(window, curves.beta_lim[0], curves.beta_stick[0], count)
    if not beta.size:
        return Seeds(*np.empty((5, 0)))
    _, out = compute(source.system, {"mu": mu, "r": r, "beta": beta}, source.solver, None, None, None)
    stops = np.where(out.status[0] == regimes.RESOLVED, out.stops_per_cycle[0], np.nan)
    changed = (stops[:, 1:] != stops[:, :-1]) & ~np.isnan(stops[:, 1:]) & ~np.isnan(stops[:, :-1])
    for boundary in (curves.beta_lim[0], curves.beta_stick[0]):
        limit = boundary[:, np.newaxis]
        changed &= ~((beta[:-1] <= limit) & (limit <= beta[1:]))
    i, j = np.nonzero(changed)
    return Seeds(r[i], beta[j], beta[j + 1], stops[i, j], stops[i, j + 1])


def _friction_of(window: Window, lim: np.ndarray, stick: np.ndarray, count: int) -> np.ndarray:
    """Friction ratios between those of continuous and of stuck motions: in proportion, the larger evenly."""
    high = min(window.beta[1], float(stick.max()))
    low = max(window.beta[0], float(lim.min()), _LEAST * high)
    if low >= high:
        return np.empty(0)
    small = round(_PROPORTIONAL * count)
    return np.union1d(np.geomspace(low, high, small), np.linspace(low, high, count - small))


def narrowed(source: Source, seeds: Seeds) -> Seeds:
    """The same brackets, narrow; where a third number of stops lies between, that of the lower change."""
    r, low, high, below, above = (array.copy() for array in seeds)
    for _ in range(_BISECTIONS):
        if not r.size:
            break
        middle = 0.5 * (low + high)
        stops = counts_at(source, r, middle)
        known = ~np.isnan(stops)
        lower = known & (stops == below)
        low = np.where(lower, middle, low)
        high, above = np.where(lower, high, middle), np.where(lower | ~known, above, stops)
    return Seeds(r, low, high, below, above)


def orbit_at(source: Source, r: float, beta: float) -> tuple[Sequence, np.ndarray] | None:
    """Sequence of the steady state of a cell, and its event times, r and beta; None if it never stops."""
    mu, solver = source.mu, source.solver
    cells = Cells(source.system, np.array([r]), np.array([beta]), np.array([mu]), solver)
    cell, table = one_cell(cells.motion, beta, mu, limits(solver), source.start == "moving")
    if cell.period == 0 or len(table) < 2:
        return None
    senses = (table[:, segment_table.SENSE] * table[:, segment_table.SIGN]).round().astype(int)
    begins, lengths = table[:, segment_table.BEGIN], table[:, segment_table.LENGTH]
    total = float(lengths.sum())
    turn = np.pi * (table[0, segment_table.SIGN] < 0.0)
    first = np.arctan2(table[0, segment_table.SIN], table[0, segment_table.COS]) + turn
    halves = round(total / np.pi)
    mirrored = halves % 2 == 1
    longest = int(np.argmax(lengths))
    back = -1 if mirrored else 1
    ordered = (*senses[longest:].tolist(), *(back * senses[: longest + 1]).tolist())
    times = np.concatenate((begins[longest + 1 :], total + begins[: longest + 1])) + first
    start = float(first + begins[longest] + 0.5 * lengths[longest])
    return Sequence(ordered, start, halves, mirrored, mu), np.array([*times, r, beta])

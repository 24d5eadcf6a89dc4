"""Cells where the number of stops changes: a minimum of the velocity touches zero there."""

from collections.abc import Sequence

import numpy as np

import frictionmap as fm

from ...references.closed_forms import mp
from .bodies import one_mass
from .check_cells import check_cells
from .group import Group
from .points import around
from .row import Row


def cells_grazing(quick: bool) -> Group:
    """Cells at beta (1 +- 10^-k), where the number of stops changes at beta."""
    group = Group("cells, grazing, stops counted")
    for r, zeta in ((0.25, 0.01),) if quick else ((0.1, 0.0), (0.25, 0.01)):
        row = Row.of(one_mass(zeta), r)
        for low, high in _changes(row, 1 if quick else 2):
            edge = mp.mpf(_bisected(row, low, high))
            # at the edge itself and next to it a 40-digit march takes seconds
            cells = around(edge, (3,))[1:] if quick else around(edge, (4, 10))
            check_cells(group, row, cells, count=True)
    return group


def _stops(row: Row, betas: Sequence[float]) -> np.ndarray:
    ds = fm.sweep(row.body.system, [row.r], betas, row.mu, threads=1)
    return np.nan_to_num(ds.stops_per_cycle.values[0, 0], nan=-1.0)


def _changes(row: Row, most: int) -> list[tuple[float, float]]:
    """Neighbours on a grid with different numbers of stops."""
    betas = np.linspace(float(row.lim) * 1.05, 0.9 * float(row.stick), 60)
    stops = _stops(row, betas.tolist())
    where = np.flatnonzero((stops[1:] != stops[:-1]) & (stops[1:] > 0) & (stops[:-1] > 0))
    return [(float(betas[j]), float(betas[j + 1])) for j in where[:most]]


def _bisected(row: Row, low: float, high: float) -> float:
    """Value of beta where the number changes, to the double."""
    below = _stops(row, [low])[0]
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        if _stops(row, [middle])[0] == below:
            low = middle
        else:
            high = middle

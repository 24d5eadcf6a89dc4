"""The class of every cell, the number of cells per class, and labels for the legend."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from .. import regimes
from .palette import (  # fmt: skip
    CLASSES,
    CONTINUOUS,
    COUNT,
    MORE,
    NO_STOPS,
    NON_INTEGER,
    NOT_YET,
    ONE,
    STUCK,
    UNCOUNTED,
    UNRESOLVED,
)

if TYPE_CHECKING:
    import xarray as xr

#: Cells processed together, so that a map of any size needs little additional memory.
_AT_ONCE = 1 << 19


def blocks(shape: tuple[int, ...]) -> Iterator[slice]:
    """Slices of the first axis of an array of cells, each with about `_AT_ONCE` cells."""
    step = max(1, _AT_ONCE // max(1, int(np.prod(shape[1:]))))
    for first in range(0, shape[0], step):
        yield slice(first, first + step)


def _of_stops(stops: np.ndarray) -> np.ndarray:
    """Class of stick-slip cells by number of stops; NaN for a motion without such a number, as at r = 0."""
    nearest = np.rint(np.nan_to_num(stops))
    found = np.clip(ONE - 1 + nearest, ONE, MORE).astype(np.uint8)
    found[stops != nearest] = NON_INTEGER
    found[np.isnan(stops)] = UNCOUNTED
    return found


def of_cells(regime: np.ndarray | None, stops: np.ndarray | None) -> np.ndarray:
    """Class of every cell from its regime and its number of stops, one of which may be missing; uint8."""
    if regime is None:
        assert stops is not None
        found = np.where(stops == 0.0, CONTINUOUS, NO_STOPS).astype(np.uint8)
        slip = stops > 0.0
    else:
        found = np.full(regime.shape, UNRESOLVED, dtype=np.uint8)
        found[regime == regimes.PERMANENT_STICKING] = STUCK
        found[regime == regimes.CONTINUOUS] = CONTINUOUS
        slip = regime == regimes.STICK_SLIP
    found[slip] = UNCOUNTED if stops is None else _of_stops(stops[slip])
    return found


def classes(ds: "xr.Dataset") -> np.ndarray:
    """Class of every cell of one mu: an index into the palette, uint8, shape (r, beta).

    The regime decides; stick-slip motions are classified by their number of stops.  A map without regimes
    distinguishes continuous motion (no stops) from stick-slip, but not stuck from unresolved cells.  A map
    without numbers of stops has a single class of stick-slip.
    """
    regime, stops, status = (
        ds[name].values if name in ds else None for name in ("regime", "stops_per_cycle", "status")
    )
    found = np.empty((ds.sizes["r"], ds.sizes["beta"]), dtype=np.uint8)
    for block in blocks(found.shape):
        found[block] = of_cells(
            None if regime is None else regime[block], None if stops is None else stops[block]
        )
        if status is not None:
            found[block][status[block] == regimes.NOT_COMPUTED] = NOT_YET
    return found


def count(found: np.ndarray) -> np.ndarray:
    """Number of cells of every class."""
    counts = np.zeros(COUNT, dtype=np.int64)
    for block in blocks(found.shape):
        counts += np.bincount(found[block].ravel(), minlength=COUNT)
    return counts


def stops_range(found: np.ndarray, stops: np.ndarray, index: int) -> tuple[float, float]:
    """Smallest and largest number of stops per cycle of a class; infinite values where it has no cells."""
    low, high = np.inf, -np.inf
    for block in blocks(found.shape):
        inside = stops[block][found[block] == index]
        if inside.size:
            low, high = min(low, float(inside.min())), max(high, float(inside.max()))
    return low, high


def legend_label(index: int, cells: int, low: float, high: float) -> str:
    """Name of a class in the legend, with its range of stops where the colour does not show it, and its
    number of cells.
    """
    ends = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
    name = {MORE: f"{ends} stops", NON_INTEGER: f"non-integer, {ends} stops"}.get(index, CLASSES[index].label)
    return f"{name} ({cells:,})"

"""The class of every cell, the number of cells per class, and labels for the legend."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import regimes
from ..datasets.labels import regime_of_choice
from .palette import (  # fmt: skip
    CLASSES,
    CONTINUOUS,
    COUNT,
    MORE,
    NO_STOPS,
    NON_INTEGER,
    NOT_YET,
    NOT_YET_LABEL,
    ONE,
    ONE_WAY,
    ONE_WAY_LABEL,
    STUCK,
    UNCOUNTED,
    UNRESOLVED,
)

if TYPE_CHECKING:
    import xarray as xr

#: Cells processed together, so that a map of any size needs little additional memory.
_AT_ONCE = 1 << 19


class Counted(NamedTuple):
    """The variable that the classes of a map count, and their names."""

    variable: str
    events: str
    labels: tuple[str, ...]


_LABELS = (*(look.label for look in CLASSES), NOT_YET_LABEL, ONE_WAY_LABEL)


def _named(variable: str, events: str, names: dict[int, str]) -> Counted:
    """Classes whose names differ from those of the palette in `names`."""
    return Counted(variable, events, tuple(names.get(k, label) for k, label in enumerate(_LABELS)))


def _slip_classes(variable: str, event: str, uncounted: str) -> Counted:
    """Classes of an elastic contact by the number of its slips or slip reversals."""
    numbers = {ONE + k - 1: f"{k} {event}{'s' * (k > 1)}" for k in range(1, MORE - ONE + 1)}
    others = {
        STUCK: "no slip",
        CONTINUOUS: "slips without rest",
        MORE: f"more {event}s",
        NON_INTEGER: f"non-integer {event}s per cycle",
        UNCOUNTED: uncounted,
        NO_STOPS: "no slip or unresolved",
    }
    return _named(variable, f"{event}s", numbers | others)


STOPS = Counted("stops_per_cycle", "stops", _LABELS)
REVERSALS = _slip_classes("slip_reversals_per_cycle", "slip reversal", "slips without reversal")
SLIPS = _slip_classes("slips_per_cycle", "slip", "slips, not counted")

#: Classes of the regime of several contacts together.
OVERALL = _named(
    "",
    "",
    {STUCK: "all contacts stuck", CONTINUOUS: "no contact stops", UNCOUNTED: "stick-slip"},
)
OVERALL_ELASTIC = _named(
    "",
    "",
    {STUCK: "no contact slips", CONTINUOUS: "no contact rests", UNCOUNTED: "stick-slip"},
)


def counted(ds: "xr.Dataset") -> Counted:
    """The variable that classifies the cells of a map.

    Contacts with a spring have slips in place of stops; those of the other kind are NaN.  Several contacts
    together have a regime only.
    """
    if "contact" in ds.dims:
        return OVERALL_ELASTIC if "beta_noslip" in ds else OVERALL
    there = [kind for kind in (REVERSALS, SLIPS, STOPS) if kind.variable in ds]
    known = [kind for kind in there if np.isfinite(ds[kind.variable].values).any()]
    return (known or there[-1:] or [STOPS])[0]


def blocks(shape: tuple[int, ...]) -> Iterator[slice]:
    """Slices of the first axis of an array of cells, each with about `_AT_ONCE` cells."""
    step = max(1, _AT_ONCE // max(1, int(np.prod(shape[1:]))))
    for first in range(0, shape[0], step):
        yield slice(first, first + step)


def _stop_classes(stops: np.ndarray) -> np.ndarray:
    """Class of stick-slip cells by number of stops; NaN for a motion without such a number, as at r = 0."""
    nearest = np.rint(np.nan_to_num(stops))
    found = np.clip(ONE - 1 + nearest, ONE, MORE).astype(np.uint8)
    found[stops != nearest] = NON_INTEGER
    found[np.isnan(stops) | (stops == 0.0)] = UNCOUNTED  # an elastic contact can slip without reversals
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
        found[regime == regimes.ONE_WAY_SLIDING] = ONE_WAY
        slip = regime == regimes.STICK_SLIP
    found[slip] = UNCOUNTED if stops is None else _stop_classes(stops[slip])
    return found


def classes(ds: "xr.Dataset", by: Counted | None = None) -> np.ndarray:
    """Class of every cell of one mu: an index into the palette, uint8, shape (r, beta).

    The regime decides, that of a contact if one was chosen; stick-slip motions are classified by their number
    of stops, or of what else is `counted`.  A map without regimes distinguishes continuous motion (no stops)
    from stick-slip, but not stuck from unresolved cells.  A map without numbers of stops has a single class
    of stick-slip.

    by : `counted`, of the map that the mu is of
    """
    by = by or counted(ds)
    regime, stops, status = (
        ds[name].values if name in ds else None for name in (regime_of_choice(ds), by.variable, "status")
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


def legend_label(index: int, cells: int, low: float, high: float, by: Counted = STOPS) -> str:
    """Name of a class in the legend, with its range of stops where the colour does not show it, and its
    number of cells.
    """
    ends = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
    ranges = {MORE: f"{ends} {by.events}", NON_INTEGER: f"non-integer, {ends} {by.events}"}
    return f"{ranges.get(index, by.labels[index])} ({cells:,})"

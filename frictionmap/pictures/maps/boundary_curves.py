"""Boundaries over a map at the resolution of its picture, independent of the grid of the map.

At low frequency the boundaries have a cusp at every integer fraction of a natural frequency, which the grid
of the map contains only by chance.  They are therefore recomputed for the system in the file; without one,
the boundaries in the file are drawn.
"""

import numpy as np
import xarray as xr

from ...files.stored import stored_system
from ...model.system import System
from ...theory.boundary_curves import find_curves
from ..grids import HIGH, Grid

BOUNDARIES = ("beta_lim", "beta_stick", "beta_stick_contact", "beta_noslip")

#: Samples over the width of a picture, a few per pixel.
_SAMPLES = 4000

#: Integer fractions of the natural frequencies, where cusps are, down to the spacing of samples.
_PARTS = np.arange(1.0, 100.0)

#: Largest number of steps of the search for S in one picture, some tenths of a second: one step per mode and
#: period of the fastest mode.  If more are needed, the lowest frequencies are omitted.
_MOST_STEPS = 1e6

#: Share of the axis, about a line's width, below which two curves look the same.
_LINE = 0.004

#: Relative rounding error of boundaries.
_ROUNDING = 1e-9


def _affordable(r: np.ndarray, system: System) -> np.ndarray:
    """The higher of increasing frequencies, as many as `_MOST_STEPS` allow."""
    modes = system.modes
    fastest = float((modes.w * (1.0 + 2.0 * modes.zeta)).max())
    steps = np.cumsum(system.n * fastest / r[::-1])[::-1]
    return r[steps < _MOST_STEPS]


def _frequencies(system: System, r: Grid) -> np.ndarray:
    """Grid points, and the additional frequencies of the picture: samples, cusps, poles."""
    low, high = r.limits
    samples = r.at(np.linspace(0.0, 1.0, _SAMPLES))
    cusps = (system.modes.w[:, np.newaxis] / _PARTS).ravel()
    poles = system.modes.held_frequencies() if system.n > 1 else np.empty(0)
    beside = np.unique(np.concatenate((samples, cusps, poles)))
    beside = _affordable(beside[(beside > max(low, 0.0)) & (beside < high)], system)
    return np.union1d(r.values, beside)


def _agree(one: np.ndarray, other: np.ndarray, top: float) -> bool:
    """Whether two curves look the same in a picture up to `top`."""
    return bool((np.abs(np.minimum(one, top) - np.minimum(other, top)) <= _LINE * top).all())


def _computed(stored: dict[str, np.ndarray], panel: xr.Dataset, r: Grid, top: float) -> dict | None:
    """Curves at more frequencies; None if the file does not contain their system."""
    system = stored_system(panel)
    if system is None or r.values.size >= _SAMPLES:
        return None
    x = _frequencies(system, r)
    found = find_curves(system, x, np.atleast_1d(panel["mu"].values))
    own = np.searchsorted(x, r.values)
    curves = {name: (x, getattr(found, name)[0]) for name in stored}
    if not all(_agree(curves[name][1][own], values, top) for name, values in stored.items()):
        return None
    return curves


def boundary_curves(panel: xr.Dataset, r: Grid, top: float) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Frequencies and finite values of the boundaries in the map of one mu, for an axis up to `top`.

    A single value extends over its cell.  A contact that was chosen has a beta_stick of its own.
    """
    stored = {
        name: panel[name].values for name in BOUNDARIES if name in panel and "contact" not in panel[name].dims
    }
    if "beta_stick_contact" in stored:
        stored.pop("beta_stick", None)
    stored = {name: values for name, values in stored.items() if not np.isinf(values).all()}  # as on a belt
    if r.values.size == 1:
        curves = {name: (r.edges, np.repeat(values, 2)) for name, values in stored.items()}
    else:
        curves = _computed(stored, panel, r, top) or {n: (r.values, v) for n, v in stored.items()}
    return {name: (x, np.minimum(values, HIGH * top)) for name, (x, values) in curves.items()}


def further_ends(panel: xr.Dataset, r: Grid, top: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Ends of the ranges of beta without stops beyond the first one, whose end is beta_lim.

    Each value extends over its cell: such ranges may exist at a single frequency.  Ranges too narrow to be
    seen on an axis up to `top` are left out.
    """
    return [through_cells(r, end) for ends in further_ranges(panel, top) for end in ends]


def further_ranges(panel: xr.Dataset, top: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Begin and end of the ranges of beta without stops beyond the first one, over r; NaN where none is."""
    if not {"no_stop_begin", "beta_stick"} <= set(panel):
        return []
    begins, ends = (
        panel[name].transpose("interval", "r").values[1:] for name in ("no_stop_begin", "no_stop_end")
    )
    all_stick = panel["beta_stick"].values * (1.0 - _ROUNDING)
    # what lasts for ever and begins where all contacts can stick is no motion
    seen = (ends - begins > _LINE * top) & (np.isfinite(ends) | (begins < all_stick))
    return [
        (np.where(row, begin, np.nan), np.where(row, np.minimum(end, HIGH * top), np.nan))
        for row, begin, end in zip(seen, begins, ends, strict=True)
        if row.any()
    ]


def through_cells(r: Grid, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve with gaps (NaN), from edge to edge of each of its cells; shapes (3 n,)."""
    known = np.where(np.isfinite(values), values, np.nan)
    between = 0.5 * (known[1:] + known[:-1])
    ends = np.append(np.nan, between), np.append(between, np.nan)
    at_edges = [np.where(np.isnan(end), known, end) for end in ends]
    x = np.stack((r.edges[:-1], r.values, r.edges[1:]), axis=-1)
    return x.ravel(), np.stack((at_edges[0], known, at_edges[1]), axis=-1).ravel()

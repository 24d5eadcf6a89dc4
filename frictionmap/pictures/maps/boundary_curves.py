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

BOUNDARIES = ("beta_lim", "beta_stick")

#: Samples over the width of a picture, a few per pixel.
_SAMPLES = 4000

#: Integer fractions of the natural frequencies, where cusps are, down to the spacing of samples.
_PARTS = np.arange(1.0, 100.0)

#: Largest number of steps of the search for S in one picture, some tenths of a second: one step per mode and
#: period of the fastest mode.  If more are needed, the lowest frequencies are omitted.
_MOST_STEPS = 1e6

#: Share of the axis, about a line's width, below which two curves look the same.
_LINE = 0.004


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

    A single value extends over its cell.
    """
    stored = {name: panel[name].values for name in BOUNDARIES if name in panel}
    if r.values.size == 1:
        curves = {name: (r.edges, np.repeat(values, 2)) for name, values in stored.items()}
    else:
        curves = _computed(stored, panel, r, top) or {n: (r.values, v) for n, v in stored.items()}
    return {name: (x, np.minimum(values, HIGH * top)) for name, (x, values) in curves.items()}

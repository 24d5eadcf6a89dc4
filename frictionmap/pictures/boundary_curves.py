"""Boundaries over a map as fine as its picture, whatever grid the map has.

At low frequency they have a cusp at every whole part of a natural frequency, which the map's own grid meets
by chance.  So they are computed anew for the system in the file; if there is none, those in the file are
drawn.
"""

import numpy as np
import xarray as xr

from ..files.stored import stored_system
from ..model.system import System
from ..theory.boundary_curves import find_curves
from .grids import Grid

BOUNDARIES = ("beta_lim", "beta_stick")

#: Samples of a picture's width: some to a pixel.
_SAMPLES = 4000

#: Parts of natural frequencies, where cusps are, down to where they lie closer than samples.
_PARTS = np.arange(1.0, 100.0)

#: Steps that the search of S may take for one picture, some tenths of a second: one a mode and
#: period of the fastest mode.  Samples that would need more are left out, from the lowest up.
_MOST_STEPS = 1e6

#: Curves further apart than this share of the axis look different: about a line's width.
_LINE = 0.004

#: Infinite values are drawn so many axes high: where they rise to a pole, curves leave the picture.
_HIGH = 1e3


def _affordable(r: np.ndarray, system: System) -> np.ndarray:
    """The higher of increasing frequencies, as many as `_MOST_STEPS` allow."""
    modes = system.modes
    fastest = float((modes.w * (1.0 + 2.0 * modes.zeta)).max())
    steps = np.cumsum(system.n * fastest / r[::-1])[::-1]
    return r[steps < _MOST_STEPS]


def _frequencies(system: System, r: Grid) -> np.ndarray:
    """The grid's own points, and those that a picture needs beside them: samples, cusps, poles."""
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
    """The curves on more frequencies; None if the file does not tell the system that they are of."""
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
    """Frequencies and finite values of the boundaries that the map of one mu holds, for an axis up to `top`.

    A single value reaches over its cell.
    """
    stored = {name: panel[name].values for name in BOUNDARIES if name in panel}
    if r.values.size == 1:
        curves = {name: (r.edges, np.repeat(values, 2)) for name, values in stored.items()}
    else:
        curves = _computed(stored, panel, r, top) or {n: (r.values, v) for n, v in stored.items()}
    return {name: (x, np.minimum(values, _HIGH * top)) for name, (x, values) in curves.items()}

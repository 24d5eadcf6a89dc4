"""Features of a system on the frequency axis: their positions and their marks."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..files.stored import stored_system
from ..model.system import System
from .grids import Grid

#: Least distance of two marks, as a share of the axis.
_GAP = 0.015


#: Largest integer fraction of the natural frequency of one mass that is marked; lower ones are too close.
_MOST_PARTS = 9


class Feature(NamedTuple):
    """Frequencies of one kind, and their mark on the upper edge of a panel."""

    label: str
    marker: str
    places: np.ndarray


#: Label and marker of each kind of frequency.
_KINDS = {
    "natural_frequency": ("natural frequency", "v"),
    "held_frequency": ("natural frequency, contact held", "x"),
    "invariant_point": ("invariant point", "d"),
}


def _system_features(system: System | None) -> dict[str, np.ndarray]:
    if system is None:
        return {}
    known = {"natural_frequency": system.modes.w}
    if system.n > 1:
        known["held_frequency"] = system.modes.held_frequencies()
    return known


def frequencies_of(system: System | None) -> list[Feature]:
    """Natural frequencies of a system, also with the contact held; empty for an unknown system."""
    return [Feature(*_KINDS[name], places) for name, places in _system_features(system).items()]


def features_of(ds: xr.Dataset) -> list[Feature]:
    """Characteristic frequencies of a dataset, from its variables or from its configuration."""
    known = {name: ds[name].values for name in _KINDS if name in ds}
    if "natural_frequency" not in known:
        known |= _system_features(stored_system(ds))
    found = [Feature(*_KINDS[name], known[name]) for name in _KINDS if name in known]
    natural = known.get("natural_frequency", np.empty(0))
    # fractions of the frequencies of several masses would fill the axis; for one mass they are the invariant
    # points
    if natural.size == 1 and "invariant_point" not in known:
        found.append(Feature("natural frequency / n", "|", natural[0] / np.arange(_MOST_PARTS, 1, -1)))
    return found


def apart(shares: np.ndarray) -> np.ndarray:
    """Which of increasing positions on an axis are far enough apart to be drawn, from the last one down."""
    kept = np.zeros(shares.size, dtype=bool)
    last = np.inf
    for k in range(shares.size - 1, -1, -1):
        if last - shares[k] >= _GAP:
            kept[k], last = True, shares[k]
    return kept


def mark_features(ax: Axes, features: list[Feature], r: Grid) -> list[Line2D]:
    """Draw features on the upper edge; return entries for the legend of those within the axis."""
    handles = []
    for feature in features:
        places = feature.places[(feature.places >= r.limits[0]) & (feature.places <= r.limits[1])]
        if not places.size:
            continue
        kept = apart(r.share(places))
        left_out = "" if kept.all() else ", some left out"
        places = places[kept]
        (line,) = ax.plot(
            places, np.ones(places.size), linestyle="none", marker=feature.marker, markersize=5.0,
            markerfacecolor="white", markeredgecolor="black", markeredgewidth=0.9,
            label=feature.label + left_out, transform=ax.get_xaxis_transform(), clip_on=False, zorder=5.0,
        )  # fmt: skip
        handles.append(line)
    return handles

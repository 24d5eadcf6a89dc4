"""Features of a system on the frequency axis: where they lie, and how they are marked."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from .grids import Grid

#: Least distance of two marks, as a share of the axis.
_GAP = 0.015


class Feature(NamedTuple):
    """Frequencies of one kind, and their mark on the upper edge of a panel."""

    label: str
    marker: str
    places: np.ndarray


def features_of(ds: xr.Dataset) -> list[Feature]:
    """What a dataset knows of its system's frequencies."""
    known = (
        ("natural_frequency", "natural frequency", "v"),
        ("held_frequency", "natural frequency, contact held", "x"),
        ("invariant_point", "invariant point", "d"),
    )
    return [Feature(text, marker, ds[name].values) for name, text, marker in known if name in ds]


def apart(shares: np.ndarray) -> np.ndarray:
    """Which of increasing places on an axis (shares) can be told apart, from the last one down."""
    kept = np.zeros(shares.size, dtype=bool)
    last = np.inf
    for k in range(shares.size - 1, -1, -1):
        if last - shares[k] >= _GAP:
            kept[k], last = True, shares[k]
    return kept


def mark_features(ax: Axes, features: list[Feature], r: Grid) -> list[Line2D]:
    """Draw them on the upper edge; entries for a legend of those that lie within the axis."""
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

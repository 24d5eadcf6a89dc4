"""A second axis in hertz, newtons, millimetres or seconds, where the reference values are known."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..datasets.labels import BESIDE
from ..datasets.physical import BESIDE_OF, ones_of
from ..units.table import UNITS, handy_unit

_NAMES = {
    "frequency": "frequency",
    "force": "friction force",
    "length": "amplitude",
    "work": "work",
    "time": "time",
    "velocity": "belt speed",
}


def frequency_on_top(ax: Axes, ds: xr.Dataset) -> None:
    """Add a frequency axis above a panel whose lower axis is r."""
    _add_second_axis(ax, ds, "x", "frequency", _NAMES["frequency"], float(np.max(ds["r"].values)))


def force_on_top(ax: Axes, ds: xr.Dataset) -> None:
    """Add a force axis above a panel whose lower axis is beta and has its limits."""
    _add_second_axis(ax, ds, "x", "force", _NAMES["force"], max(abs(limit) for limit in ax.get_xlim()))


def time_on_top(ax: Axes, ds: xr.Dataset) -> None:
    """Add a time axis above a panel whose lower axis is tau/pi."""
    _add_second_axis(ax, ds, "x", "time", _NAMES["time"], float(np.max(ds["tau"].values)), np.pi)


def on_the_right(ax: Axes, ds: xr.Dataset, measure: str, name: str = "") -> None:
    """Add an axis of forces, lengths or work right of a panel whose limits are set; `name` is its label."""
    largest = max(abs(limit) for limit in ax.get_ylim())
    _add_second_axis(ax, ds, "y", measure, name or _NAMES[measure], largest)


def velocity_on_top(ax: Axes, ds: xr.Dataset) -> None:
    """Add an axis of belt speeds above a panel whose lower axis has its limits."""
    _add_second_axis(ax, ds, "x", "velocity", _NAMES["velocity"], max(abs(limit) for limit in ax.get_xlim()))


def length_on_top(ax: Axes, ds: xr.Dataset, name: str) -> None:
    """Add an axis of displacements above a panel whose lower axis is in units of P/k1."""
    _add_second_axis(ax, ds, "x", "length", name, max(abs(limit) for limit in ax.get_xlim()))


def in_brackets(ds: xr.Dataset, axis: str, index: int = 0) -> str:
    """Value of r or beta in hertz or newtons, in brackets; empty if the dataset has no units."""
    name = BESIDE_OF.get(axis, "")
    if name not in ds.coords:
        return ""
    value = float(np.atleast_1d(ds[name].values)[index])
    return f" ({value:.6g} {BESIDE[name].units})"


def _add_second_axis(
    ax: Axes, ds: xr.Dataset, axis: str, measure: str, name: str, largest: float, step: float = 1.0
) -> None:
    """Add a second axis, if the reference value of the panel's quantity in units of `step` is known."""
    one = ones_of(ds).get(measure)
    if one is None or not np.isfinite(largest):
        return
    unit = handy_unit(one * largest, measure)
    factor = step * one / float(UNITS[unit].size)

    def forward(values: ArrayLike) -> ArrayLike:
        return factor * np.asarray(values)

    def back(values: ArrayLike) -> ArrayLike:
        return np.asarray(values) / factor

    if axis == "x":
        ax.secondary_xaxis("top", functions=(forward, back)).set_xlabel(f"{name} [{_shown(unit)}]")
    else:
        ax.secondary_yaxis("right", functions=(forward, back)).set_ylabel(f"{name} [{_shown(unit)}]")


def _shown(unit: str) -> str:
    return unit.replace("um", "µm")

"""A working point on a map, and the box of its uncertainty."""

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from ... import checks
from ...datasets.labels import SCALES
from ...errors import InputError
from ...units.axes import KINDS, ratios, require
from ...units.scales import Scales
from ..options import current
from ..panels import Handle, halo

if TYPE_CHECKING:
    import xarray as xr

WORKING_POINT: dict[str, Any] = {
    "marker": "X", "markersize": 9.0, "markerfacecolor": "white", "markeredgecolor": "black",
    "markeredgewidth": 1.1, "linestyle": "none",
}  # fmt: skip
_BOX: dict[str, Any] = {"facecolor": "none", "edgecolor": "black", "linewidth": 1.1}


def _ratios(given: tuple[float | str, float | str], name: str, ds: "xr.Dataset") -> tuple[float, float]:
    """r and beta of two numbers that may have units, over the reference values of a dataset."""
    frequency, force = (_exact(ds.attrs.get(SCALES[kind])) for kind in KINDS.values())
    scales = Scales(frequency, force, None)
    require(scales, **{name: ("frequency", given[0]), f"{name}, beta": ("force", given[1])})
    found = (
        ratios(one, name, KINDS[axis], scales) if isinstance(one, str) else [one]
        for axis, one in zip(KINDS, given, strict=True)
    )
    first, second = (checks.number(one[0] if isinstance(one, list) else one, name) for one in found)
    return first, second


def _exact(value: float | None) -> Fraction | None:
    return None if value is None else Fraction(float(value))


def mark_point(ax: Axes, ds: "xr.Dataset") -> list[Handle]:
    """Draw the point and the box of the options, if given; return entries for the legend."""
    marked, around = current().point, current().box
    if marked is None:
        return []
    point = _ratios(marked, "point", ds)
    box = None if around is None else _ratios(around, "box", ds)
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    if not (left <= point[0] <= right and low <= point[1] <= high):
        raise InputError(
            f"point must lie within r = {left:.4g} to {right:.4g} and beta = {low:.4g} to {high:.4g}; "
            f"got {point[0]:g}, {point[1]:g}"
        )
    handles: list[Handle] = []
    if box is not None:
        corner = point[0] - box[0], point[1] - box[1]
        sides = 2.0 * box[0], 2.0 * box[1]
        ax.add_patch(Rectangle(corner, *sides, zorder=4.4, path_effects=halo(2.6), **_BOX))
        handles.append(Patch(label=f"uncertainty: r ± {box[0]:g}, β ± {box[1]:g}", **_BOX))
    ax.plot(*point, zorder=4.5, **WORKING_POINT)
    label = f"working point: r = {point[0]:g}, β = {point[1]:g}"
    return [Line2D([], [], label=label, **WORKING_POINT), *handles]

"""Pictures of the boundaries: which steady states are possible over frequency and friction."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, overload

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .features import features_of, mark_features
from .grids import Grid
from .palette import CLASSES, CONTINUOUS, HATCH, HATCH_COLOUR, LIM, MODAL, STICK, STUCK, UNCOUNTED
from .panels import (
    Handle,
    distinct,
    given_axes,
    halo,
    legend_below,
    legend_under,
    name_axes,
    panel_grid,
    patch,
)
from .second_axes import frequency_on_top, on_the_right
from .shapes import check_holds, panels_of, to_draw
from .words import caption

if TYPE_CHECKING:
    from .panels import AxesArray

#: Room above the curves, and above beta_lim where beta_stick leaves the picture through a pole.
_ABOVE, _ABOVE_LIM = 1.15, 2.0


class Areas(NamedTuple):
    """Bounds in beta of what is possible, over frequency; each area lies between the two of its arrays.

    Below beta_lim the continuous motion exists, from beta_stick on sticking does.  With mu > 1 both may be
    (the start decides), and stick-slip besides; with mu = 1 what is possible is certain.
    """

    continuous: tuple[np.ndarray, np.ndarray]
    sticking: tuple[np.ndarray, np.ndarray]
    both: tuple[np.ndarray, np.ndarray]
    neither: tuple[np.ndarray, np.ndarray]


def areas(lim: np.ndarray, stick: np.ndarray, top: float) -> Areas:
    """Bounds of the areas of a picture from beta = 0 to `top`."""
    lim, stick = np.minimum(lim, top), np.minimum(stick, top)
    lower, upper = np.minimum(lim, stick), np.maximum(lim, stick)
    return Areas((np.zeros_like(lim), lower), (upper, np.full_like(lim, top)), (lower, lim), (lower, stick))


def top_of(lim: np.ndarray, stick: np.ndarray) -> float:
    """Upper end of the axis of beta, for all mu together.

    beta_stick has poles where the held structure resonates: they leave the picture at the top.
    """
    lim = lim[np.isfinite(lim)]
    finite = np.concatenate((lim, stick[np.isfinite(stick)]))
    return float(min(_ABOVE * finite.max(initial=0.1), _ABOVE_LIM * lim.max(initial=0.05)))


def _over(r: Grid, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve over frequency; a single value reaches over its cell."""
    return (r.values, values) if r.values.size > 1 else (r.edges, np.repeat(values, 2))


def _differ(lim: np.ndarray, modal: np.ndarray, top: float) -> bool:
    """Whether two curves lie apart by more than a line's width somewhere in the picture."""
    return bool((np.abs(np.minimum(lim, top) - np.minimum(modal, top)) > 0.004 * top).any())


def _draw(ax: Axes, panel: xr.Dataset, r: Grid, top: float) -> list[Handle]:
    """Draw one mu; the entries for a legend that depend on what is there."""
    x, lim = _over(r, panel["beta_lim"].values)
    _, stick = _over(r, panel["beta_stick"].values)
    found = areas(lim, stick, top)
    handles: list[Handle] = []
    for bounds, index in (
        (found.sticking, STUCK),
        (found.neither, UNCOUNTED),
        (found.continuous, CONTINUOUS),
    ):
        ax.fill_between(x, *bounds, color=CLASSES[index].colour, linewidth=0.0)
    low, high = found.both
    if (high > low).any():
        ax.fill_between(x, low, high, facecolor="white", edgecolor=HATCH_COLOUR, hatch=HATCH, linewidth=0.0)
        handles.append(patch("continuous or stuck: the start decides", "white", HATCH))
    curves = [("beta_lim", LIM), ("beta_stick", STICK)]
    if "beta_lim_modal" in panel and _differ(panel["beta_lim"].values, panel["beta_lim_modal"].values, top):
        curves.append(("beta_lim_modal", MODAL))
    for name, style in curves:
        rim = [] if style is MODAL else halo()  # it often lies on beta_lim, which is to be seen under it
        handles += ax.plot(*_over(r, panel[name].values), path_effects=rim, **style)
    name_axes(ax, r, float(panel["mu"]))
    ax.set_ylim(0.0, top)
    frequency_on_top(ax, panel)
    on_the_right(ax, panel, "force")
    return handles + mark_features(ax, features_of(panel), r)


def _area_handles(mu: np.ndarray) -> list[Handle]:
    """Legend's entries of the areas: what mu = 1 makes certain, larger mu only makes possible."""
    certain = bool((mu == 1.0).all())
    words = (
        (CONTINUOUS, "continuous", "continuous motion possible"),
        (UNCOUNTED, "stick-slip", "stick-slip"),
        (STUCK, "permanent sticking", "sticking possible"),
    )
    return [patch(sure if certain else may, CLASSES[index].colour) for index, sure, may in words]


def _reading(mu: np.ndarray) -> str:
    """How to read what is possible."""
    if (mu == 1.0).all():
        return ""
    return r"for mu > 1 stick-slip is possible in all areas" + (
        ", for mu = 1 what is possible is certain" if (mu == 1.0).any() else ""
    )


@overload
def plot_boundaries(ds: xr.Dataset, ax: None = None) -> "AxesArray": ...


@overload
def plot_boundaries(ds: xr.Dataset, ax: Axes) -> Axes: ...


@overload
def plot_boundaries(ds: xr.Dataset, ax: "Sequence[Axes] | AxesArray") -> "AxesArray": ...


def plot_boundaries(
    ds: xr.Dataset, ax: "Axes | Sequence[Axes] | AxesArray | None" = None
) -> "Axes | AxesArray":
    """Picture of the boundaries over frequency, a panel for each mu, all with one axis of beta.

    Below `beta_lim` the continuous motion exists, from `beta_stick` on permanent sticking does; where both
    do, the area is hatched.

    Parameters
    ----------
    ds : xarray.Dataset
        As `boundaries` returns it, or a map: what holds `beta_lim` and `beta_stick`.
    ax : matplotlib axes, or an array of them, optional
        Axes to draw into, one for each mu; the legend goes under the last of them (save the figure with
        ``bbox_inches="tight"``).  Without it a figure is made.

    Returns
    -------
    The axes: what was given, or an array with one for each mu.

    Raises
    ------
    InputError
        The dataset holds no boundaries, or there are more or fewer axes than mu.
    """
    ds = to_draw(ds, "plot_boundaries", "boundaries", "map")
    check_holds(ds, ("beta_lim", "beta_stick"), "its boundaries")
    r, panels = Grid(ds["r"].values), panels_of(ds)
    title = str(ds.attrs.get("title", ""))
    axes = panel_grid(len(panels), title) if ax is None else given_axes(ax, len(panels), "one for each mu")
    top = top_of(ds["beta_lim"].values, ds["beta_stick"].values)
    handles = _area_handles(ds["mu"].values)
    for panel_ax, panel in zip(axes, panels, strict=True):
        handles += _draw(panel_ax, panel, r, top)
    handles = distinct(handles)
    if ax is None:
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        legend_below(figure, handles, "; ".join(filter(None, (caption(ds), _reading(ds["mu"].values)))))
        return axes
    legend_under(axes[-1], handles)
    return ax if isinstance(ax, Axes) else axes

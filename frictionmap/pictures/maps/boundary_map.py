"""Pictures of the boundaries: the possible steady states over frequency and friction."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, Unpack, overload

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...files.stored import has_equal_friction
from ..drawing import with_options
from ..features import features_of, mark_features
from ..grids import HIGH, Grid, limited
from ..options import FigureOptions, current
from ..palette import (  # fmt: skip
    CLASSES,
    CONTINUOUS,
    FURTHER,
    HATCH,
    HATCH_COLOUR,
    LIM,
    MODAL,
    NO_SLIP,
    STICK,
    STUCK,
    UNCOUNTED,
)
from ..panels import (
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
from ..second_axes import frequency_on_top, on_the_right
from ..shapes import check_holds, panels_of, to_draw
from ..words import caption
from .boundary_curves import further_ranges, through_cells
from .stop_borders import draw_borders
from .working_point import mark_point

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Height of the axis over the largest value, and over the largest beta_lim where beta_stick has poles.
_ABOVE, _ABOVE_LIM = 1.15, 2.0

#: Height of the axis over the median of beta_noslip.
_ABOVE_MEDIAN = 4.0


class Areas(NamedTuple):
    """Bounds in beta of the possible regimes over frequency; each area lies between its two arrays.

    Continuous motion is possible below beta_lim, sticking at or above beta_stick.  For mu = 1 the regions are
    exact.  For mu > 1 both may be possible, depending on the initial state, and stick-slip can occur as well.
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
    """Upper end of the axis of beta, common to all mu.

    beta_stick has poles at resonances of the held structure: they leave the picture at the top.
    """
    lim = lim[np.isfinite(lim)]
    finite = np.concatenate((lim, stick[np.isfinite(stick)]))
    return float(min(_ABOVE * finite.max(initial=0.1), _ABOVE_LIM * lim.max(initial=0.05)))


def _top_of_elastic(noslip: np.ndarray) -> float:
    """Upper end of the axis of beta for elastic contacts: resonances leave the picture at the top."""
    finite = noslip[np.isfinite(noslip)]
    if not finite.size:
        return 1.0
    return float(min(_ABOVE * finite.max(), _ABOVE_MEDIAN * np.median(finite))) or 1.0


def _over(r: Grid, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve over frequency; a single value extends over its cell."""
    return (r.values, values) if r.values.size > 1 else (r.edges, np.repeat(values, 2))


def _differ(lim: np.ndarray, modal: np.ndarray, top: float) -> bool:
    """Whether two curves differ by more than a line's width anywhere in the picture."""
    return bool((np.abs(np.minimum(lim, top) - np.minimum(modal, top)) > 0.004 * top).any())


def _draw_further(ax: Axes, panel: xr.Dataset, r: Grid, top: float) -> list[Handle]:
    """Draw ranges without stops beyond beta_lim."""
    handles: list[Handle] = []
    for begin, end in further_ranges(panel, top):
        (x, low), (_, high) = through_cells(r, begin), through_cells(r, end)
        ax.fill_between(x, low, high, color=CLASSES[CONTINUOUS].colour, linewidth=0.0)
        for ends in (low, high):
            handles += ax.plot(x, ends, path_effects=halo(), **FURTHER)
    return handles


def _draw_elastic(ax: Axes, panel: xr.Dataset, r: Grid, top: float) -> list[Handle]:
    """Draw one mu of elastic contacts: they slip below beta_noslip."""
    x, end = _over(r, panel["beta_noslip"].values)
    drawn = np.minimum(end, top)
    ax.fill_between(x, 0.0, drawn, color=CLASSES[UNCOUNTED].colour, linewidth=0.0)
    ax.fill_between(x, drawn, top, color=CLASSES[STUCK].colour, linewidth=0.0)
    handles: list[Handle] = [*ax.plot(x, np.minimum(end, HIGH * top), path_effects=halo(), **NO_SLIP)]
    _finish(ax, panel, r, top)
    return handles + mark_features(ax, features_of(panel), r)


def _finish(ax: Axes, panel: xr.Dataset, r: Grid, top: float) -> None:
    name_axes(ax, r, float(panel["mu"]))
    ax.set_ylim(0.0, top)
    frequency_on_top(ax, panel)
    on_the_right(ax, panel, "force")


def _draw(ax: Axes, panel: xr.Dataset, r: Grid, top: float) -> list[Handle]:
    """Draw one mu; return the entries for the legend that depend on its content."""
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
        handles.append(patch("continuous or stuck: the initial state decides", "white", HATCH))
    handles += _draw_further(ax, panel, r, top)
    curves = [("beta_lim", LIM), ("beta_stick", STICK)]
    if "beta_lim_modal" in panel and _differ(panel["beta_lim"].values, panel["beta_lim_modal"].values, top):
        curves.append(("beta_lim_modal", MODAL))
    for name, style in curves:
        rim = [] if style is MODAL else halo()  # it often coincides with beta_lim, which must stay visible
        handles += ax.plot(*_over(r, panel[name].values), path_effects=rim, **style)
    _finish(ax, panel, r, top)
    return handles + draw_borders(ax, panel) + mark_features(ax, features_of(panel), r)


def _elastic_handles() -> list[Handle]:
    """Legend entries of the areas of elastic contacts."""
    return [patch(word, CLASSES[index].colour) for index, word in ((UNCOUNTED, "slips"), (STUCK, "no slip"))]


def _area_handles(certain: bool) -> list[Handle]:
    """Legend entries of the areas: exact where static is kinetic friction, otherwise possible regimes."""
    words = (
        (CONTINUOUS, "continuous", "continuous motion possible"),
        (UNCOUNTED, "stick-slip", "stick-slip"),
        (STUCK, "permanent sticking", "sticking possible"),
    )
    return [patch(sure if certain else may, CLASSES[index].colour) for index, sure, may in words]


def _reading(exact: list[bool]) -> str:
    """Remark on how to read the regions, which are exact in some panels."""
    if all(exact):
        return ""
    some = "for μ = 1 the regions are exact; " if any(exact) else ""
    return f"{some}for μ > 1 stick-slip can also occur outside its region"


@overload
def plot_boundaries(ds: xr.Dataset, ax: None = None, **options: Unpack[FigureOptions]) -> "AxesArray": ...


@overload
def plot_boundaries(ds: xr.Dataset, ax: Axes, **options: Unpack[FigureOptions]) -> Axes: ...


@overload
def plot_boundaries(
    ds: xr.Dataset, ax: "Sequence[Axes] | AxesArray", **options: Unpack[FigureOptions]
) -> "AxesArray": ...


@with_options
def plot_boundaries(
    ds: xr.Dataset,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "Axes | AxesArray":
    """Draw the boundaries over frequency, one panel for each mu, with a common axis of beta.

    Continuous motion is possible below `beta_lim`, permanent sticking at or above `beta_stick`; where both
    are possible, the area is hatched.  Contacts with a spring slip below `beta_noslip`.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `boundaries`, or a map: any dataset with `beta_lim` and `beta_stick`, or with
        `beta_noslip`.
    ax : matplotlib axes, or an array of them, optional
        Axes to draw into, one for each mu; the legend is placed below the last of them (save the figure with
        ``bbox_inches="tight"``).  Without it a figure is created.

    Returns
    -------
    The axes: those given, or an array with one for each mu.

    Raises
    ------
    InputError
        The dataset has no boundaries, or the number of axes differs from the number of mu.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.boundaries(fm.System(), r=[0.4, 0.8, 1.2])
    >>> axes = fm.plot_boundaries(ds)
    >>> [ax.get_xlabel() for ax in axes.flat]
    ['frequency ratio $r$']
    """
    ds = to_draw(ds, "plot_boundaries", "boundaries", "map")
    elastic = "beta_noslip" in ds
    exact = [has_equal_friction(ds, float(mu)) for mu in np.atleast_1d(ds["mu"].values)]
    if not elastic:
        check_holds(ds, ("beta_lim", "beta_stick"), "its boundaries")
    r, panels = limited("r", ds["r"].values, current().xlim), current().chosen(panels_of(ds))
    title = str(ds.attrs.get("title", ""))
    axes = panel_grid(len(panels), title) if ax is None else given_axes(ax, len(panels), "one for each mu")
    if elastic:
        draw, top, handles = _draw_elastic, _top_of_elastic(ds["beta_noslip"].values), _elastic_handles()
    else:
        draw, top = _draw, top_of(ds["beta_lim"].values, ds["beta_stick"].values)
        handles = _area_handles(all(exact))
    top = limits[1] if (limits := current().ylim) else top
    for panel_ax, panel in zip(axes, panels, strict=True):
        handles += [*draw(panel_ax, panel, r, top), *mark_point(panel_ax, ds)]
    handles = distinct(handles)
    if ax is None:
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        legend_below(figure, handles, "; ".join(filter(None, (caption(ds), _reading(exact)))))
        return axes
    legend_under(axes[-1], handles)
    return ax if isinstance(ax, Axes) else axes

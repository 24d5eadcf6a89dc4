"""Pictures of regime maps: classes of cells in colours, boundaries over them, marks for small features."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, overload

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ...errors import InputError
from ..classes import Counted, classes, count, counted, legend_label, stops_range
from ..features import features_of, mark_features
from ..grids import Grid
from ..marks import COARSE, rare_classes, rings, room_for, trace
from ..palette import (  # fmt: skip
    CLASSES,
    CONTINUOUS,
    COUNT,
    FURTHER,
    HATCH,
    HATCH_COLOUR,
    LIM,
    LIM_CONTACT,
    MORE,
    NO_SLIP,
    NON_INTEGER,
    NOT_YET,
    NOT_YET_HATCH,
    NOT_YET_LABEL,
    ONE_WAY,
    ONE_WAY_HATCH,
    STICK,
    STICK_CONTACT,
    STUCK,
    colour_table,
)
from ..panels import (  # fmt: skip
    Handle,
    distinct,
    given_axes,
    halo,
    legend_below,
    legend_under,
    name_axes,
    panel_grid,
    patch,
    size_of,
)
from ..second_axes import frequency_on_top, on_the_right
from ..shapes import panels_of, to_draw
from ..words import caption, title_of_map
from .boundary_curves import boundary_curves, further_ends
from .raster import level_stripes, paint, rasterise, shade, stripes

if TYPE_CHECKING:
    from ..panels import AxesArray

_STYLES = {
    "beta_lim": LIM,
    "beta_stick": STICK,
    "beta_stick_contact": STICK_CONTACT,
    "beta_noslip": NO_SLIP,
}

#: Stripes: distance and width [inch].
_SPACING, _STRIPE = 0.085, 0.012
_HATCHING = int(HATCH_COLOUR[1:3], 16), int(HATCH_COLOUR[3:5], 16), int(HATCH_COLOUR[5:7], 16)


@dataclass(frozen=True)
class Cells:
    """The cells of one mu."""

    r: Grid
    beta: Grid
    found: np.ndarray  # classes, (r, beta)
    several: np.ndarray | None  # whether several regimes are possible, (r, beta)
    by: Counted

    @cached_property
    def counts(self) -> np.ndarray:
        """Number of cells of each class."""
        return count(self.found)


def _several(panel: xr.Dataset) -> np.ndarray | None:
    """Cells with several possible regimes, depending on the initial state; None if there are none."""
    if "also_reachable" not in panel:
        return None
    flags = panel["also_reachable"].values
    several = (flags & (flags - 1)) != 0  # more than one bit
    return several.astype(np.uint8) if several.any() else None


def cells_of(panel: xr.Dataset, by: Counted | None = None) -> Cells:
    """The cells of a map of one mu, dims (r, beta); `by`: what their classes count."""
    by = by or counted(panel)
    return Cells(Grid(panel["r"].values), Grid(panel["beta"].values), classes(panel, by), _several(panel), by)


class CellImage(Artist):
    """Cells in colours, rasterised for the pixels of each drawing so that no feature is lost at any size."""

    def __init__(self, cells: Cells) -> None:
        super().__init__()
        self.cells = cells
        self.set_zorder(0.5)

    def draw(self, renderer: RendererBase) -> None:
        """Draw the cells in view."""
        assert self.axes is not None
        scale = renderer.get_image_magnification()
        left, bottom, right, top = self.axes.bbox.extents
        left, bottom = round(left), round(bottom)
        size = max(1, round((right - left) * scale)), max(1, round((top - bottom) * scale))
        edges = self._edges(scale, left, bottom)
        raster = rasterise(self.cells.found, *edges, size, COUNT)
        image = paint(raster, colour_table())
        if self.cells.counts[ONE_WAY]:
            self._hatch_one_way(image, raster == ONE_WAY, scale)
        if self.cells.several is not None:
            self._hatch(image, rasterise(self.cells.several, *edges, size, 2) == 1, scale)
        gc = renderer.new_gc()
        gc.set_clip_rectangle(self.axes.bbox)
        renderer.draw_image(gc, left, bottom, image)
        gc.restore()

    def _edges(self, scale: float, left: float, bottom: float) -> tuple[np.ndarray, np.ndarray]:
        """Edges of the cells in pixels."""
        assert self.axes is not None
        x, y = self.cells.r.edges, self.cells.beta.edges
        inside = self.axes.viewLim.x0, self.axes.viewLim.y0
        to_pixels = self.axes.transData.transform
        across = to_pixels(np.column_stack((x, np.full(x.size, inside[1]))))[:, 0]
        up = to_pixels(np.column_stack((np.full(y.size, inside[0]), y)))[:, 1]
        return (across - left) * scale, (up - bottom) * scale

    def _hatch(self, image: np.ndarray, several: np.ndarray, scale: float) -> None:
        assert self.axes is not None
        inch = scale * self.axes.figure.dpi
        shade(image, stripes(several.shape, _SPACING * inch, _STRIPE * inch) * several, _HATCHING)

    def _hatch_one_way(self, image: np.ndarray, where: np.ndarray, scale: float) -> None:
        """Paint one-way sliding white with level stripes, also where cells not computed are dotted."""
        assert self.axes is not None
        inch = scale * self.axes.figure.dpi
        image[where.T] = 255
        shade(image, level_stripes(where.shape, _SPACING * inch, _STRIPE * inch) * where, _HATCHING)


def _name_regions(ax: Axes, cells: Cells, curves: Iterable[tuple[np.ndarray, np.ndarray]]) -> None:
    """Write the names of large regions into them, away from the curves."""
    x_edges, y_edges = (COARSE * grid.share(grid.edges) for grid in (cells.r, cells.beta))
    coarse = rasterise(cells.found, x_edges, y_edges, (COARSE, COARSE), COUNT)
    for x, y in curves:
        coarse[trace(cells.r.share(x), cells.beta.share(y))] = COUNT
    for index in (STUCK, CONTINUOUS, ONE_WAY):
        name = cells.by.labels[index]
        place = room_for(coarse == index, name, size_of(ax))
        if place:
            ax.text(
                *place, name, transform=ax.transAxes, ha="center", va="center", fontsize=9,
                path_effects=halo(3.0),
            )  # fmt: skip


def _ring(ax: Axes, cells: Cells) -> list[Handle]:
    """Draw rings around cells of rare classes."""
    centres = [np.empty((0, 2))]
    for index in rare_classes(cells.counts):
        i, j = np.nonzero(cells.found == index)
        centres.append(rings(cells.r.share(cells.r.values[i]), cells.beta.share(cells.beta.values[j])))
    places = np.concatenate(centres)
    if not len(places):
        return []
    (drawn,) = ax.plot(
        *places.T, "o", markersize=9.0, markerfacecolor="none", markeredgecolor="black", markeredgewidth=0.9,
        transform=ax.transAxes, path_effects=halo(2.2), clip_on=False,
        label="few cells of their class: circled",
    )  # fmt: skip
    return [drawn]


def draw_map(ax: Axes, panel: xr.Dataset, cells: Cells) -> list[Handle]:
    """Draw one mu without rings; return the entries for the legend that are not classes."""
    ax.add_artist(CellImage(cells))
    if cells.counts[NOT_YET]:
        ax.patch.set(hatch=NOT_YET_HATCH, edgecolor=HATCH_COLOUR)
    curves = boundary_curves(panel, cells.r, cells.beta.limits[1])
    handles: list[Handle] = []
    name_axes(ax, cells.r, float(panel["mu"]))
    if cells.beta.logarithmic:
        ax.set_yscale("log")
    ax.set_ylim(*cells.beta.limits)
    frequency_on_top(ax, panel)
    on_the_right(ax, panel, "force")
    for name, curve in curves.items():
        style = LIM_CONTACT if name == "beta_lim" and "beta_stick_contact" in curves else _STYLES[name]
        handles += ax.plot(*curve, path_effects=halo(), **style)
    for ends in further_ends(panel, cells.r, cells.beta.limits[1]):
        handles += ax.plot(*ends, path_effects=halo(), **FURTHER)
    if cells.several is not None:
        handles.append(
            Patch(
                facecolor="none", edgecolor=HATCH_COLOUR, hatch=HATCH, linewidth=0.0,
                label="several regimes: the initial state decides",
            )
        )  # fmt: skip
    handles += mark_features(ax, features_of(panel), cells.r)
    _name_regions(ax, cells, curves.values())
    return handles


def _class_handles(panels: Sequence[xr.Dataset], cells: Sequence[Cells]) -> list[Handle]:
    """Legend entries of the classes that occur, with their numbers of cells."""
    counts = np.sum([part.counts for part in cells], axis=0)
    handles: list[Handle] = []
    for index in np.flatnonzero(counts[:NOT_YET]):
        low, high = np.inf, -np.inf
        if index in (MORE, NON_INTEGER):
            ends = [
                stops_range(part.found, panel[part.by.variable].values, int(index))
                for panel, part in zip(panels, cells, strict=True)
            ]
            low, high = min(e[0] for e in ends), max(e[1] for e in ends)
        label = legend_label(int(index), int(counts[index]), low, high, cells[0].by)
        handles.append(patch(label, CLASSES[index].colour))
    if counts[ONE_WAY]:
        label = legend_label(ONE_WAY, int(counts[ONE_WAY]), np.inf, -np.inf, cells[0].by)
        handles.append(patch(label, "white", ONE_WAY_HATCH))
    if counts[NOT_YET]:
        label = f"{NOT_YET_LABEL} ({counts[NOT_YET]:,})"
        handles.append(Patch(facecolor="none", edgecolor=HATCH_COLOUR, hatch=NOT_YET_HATCH, label=label))
    return handles


@overload
def plot_regimes(ds: xr.Dataset, ax: None = None) -> "AxesArray": ...


@overload
def plot_regimes(ds: xr.Dataset, ax: Axes) -> Axes: ...


@overload
def plot_regimes(ds: xr.Dataset, ax: "Sequence[Axes] | AxesArray") -> "AxesArray": ...


def plot_regimes(ds: xr.Dataset, ax: "Axes | Sequence[Axes] | AxesArray | None" = None) -> "Axes | AxesArray":
    """Draw a regime map: stops per cycle in discrete colours, with the boundaries over it.

    Contacts with a spring are coloured by their slip reversals or slips.  Of several contacts the regime of
    all is drawn, or one that was chosen with ``ds.sel(contact=2)``.

    The legend shows the number of cells of each class.  Circles mark cells of classes too rare to be seen.
    If the map contains `also_reachable`, cells that can reach several regimes are hatched.  Where several
    cells share a pixel, the most frequent class is drawn; strips and isolated cells are never dropped.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `sweep`, or a part of it, with `regime` or `stops_per_cycle`; dimensions in any order.
    ax : matplotlib axes, or an array of them, optional
        Axes to draw into, one for each mu; the legend is placed below the last of them (save the figure with
        ``bbox_inches="tight"``).  Without it a figure with a panel for each mu is created.

    Returns
    -------
    The axes: those given, or an array with one for each mu.

    Raises
    ------
    InputError
        The dataset has neither output or is not a map, or the number of axes differs from the number of mu.
    """
    ds = to_draw(ds, "plot_regimes", "map")
    by = counted(ds)
    if "regime" not in ds and by.variable not in ds:
        raise InputError("a map must hold regime or stops_per_cycle to be drawn; got neither")
    panels = panels_of(ds)
    title = title_of_map(ds)
    axes = panel_grid(len(panels), title) if ax is None else given_axes(ax, len(panels), "one for each mu")
    cells = [cells_of(panel, by) for panel in panels]
    others: list[Handle] = []
    for panel_ax, panel, part in zip(axes, panels, cells, strict=True):
        others += draw_map(panel_ax, panel, part) + _ring(panel_ax, part)
    handles = _class_handles(panels, cells) + distinct(others)
    if ax is None:
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        legend_below(figure, handles, caption(ds, cells_counted=True))
        return axes
    legend_under(axes[-1], handles)
    return ax if isinstance(ax, Axes) else axes

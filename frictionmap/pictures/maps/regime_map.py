"""Pictures of regime maps: classes of cells in colours, boundaries over them, marks for small features."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Unpack, overload

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ...datasets.labels import regime_of_choice
from ...errors import InputError
from ..classes import Counted, classes, count, counted, legend_label, stops_range
from ..drawing import with_options
from ..features import features_of, mark_features
from ..grids import Grid, limited
from ..marks import COARSE, rare_classes, rings, room_for, trace
from ..options import FigureOptions, current
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
from ..sizes import points
from ..words import caption, title_of_map
from .boundary_curves import boundary_curves, further_ends
from .cell_image import CellImage
from .raster import level_stripes, paint, rasterise, shade, stripes
from .stop_borders import draw_borders
from .working_point import mark_point

if TYPE_CHECKING:
    from ..panels import AxesArray

_STYLES = {
    "beta_lim": LIM,
    "beta_stick": STICK,
    "beta_stick_contact": STICK_CONTACT,
    "beta_noslip": NO_SLIP,
}

Curves = dict[str, tuple[np.ndarray, np.ndarray]]

#: Share of a frame that is left of it between title, labels and legend of a small figure.
_FRAME = 0.85

#: Stripes: distance and width [inch].
SPACING, STRIPE = 0.085, 0.012
HATCHING = int(HATCH_COLOUR[1:3], 16), int(HATCH_COLOUR[3:5], 16), int(HATCH_COLOUR[5:7], 16)


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


def cells_of(panel: xr.Dataset, by: Counted | None = None, axes: tuple[Grid, Grid] | None = None) -> Cells:
    """The cells of a map of one mu, dims (r, beta).

    by : what their classes count
    axes : of r and beta, if their limits are not those of the cells
    """
    by = by or counted(panel)
    r, beta = axes or (Grid(panel["r"].values), Grid(panel["beta"].values))
    return Cells(r, beta, classes(panel, by), _several(panel), by)


def in_view(ds: xr.Dataset) -> tuple[xr.Dataset, tuple[Grid, Grid]]:
    """The cells within the limits of the picture, and the axes of r and beta."""
    shown = {"r": current().xlim, "beta": current().ylim}
    grids = {name: limited(name, ds[name].values, limits) for name, limits in shown.items()}
    ds = ds.isel({name: grid.part() for name, grid in grids.items() if grid.shown})
    return ds, (Grid(ds["r"].values, shown["r"]), Grid(ds["beta"].values, shown["beta"]))


class RegimeImage(CellImage):
    """Cells in the colours of their classes."""

    def __init__(self, cells: Cells) -> None:
        super().__init__(cells.r, cells.beta)
        self.cells = cells

    def image(self, edges: tuple[np.ndarray, np.ndarray], size: tuple[int, int], inch: float) -> np.ndarray:
        """Paint the most frequent class of every pixel, with stripes over several regimes."""
        raster = rasterise(self.cells.found, *edges, size, COUNT)
        image = paint(raster, colour_table())
        if self.cells.counts[ONE_WAY]:
            _hatch_one_way(image, raster == ONE_WAY, inch)
        if self.cells.several is not None:
            where = rasterise(self.cells.several, *edges, size, 2) == 1
            shade(image, stripes(where.shape, SPACING * inch, STRIPE * inch) * where, HATCHING)
        return image

    def colours(self) -> np.ndarray | None:
        """Return the colours of the classes; stripes need pixels."""
        if self.cells.counts[ONE_WAY] or self.cells.several is not None:
            return None
        return colour_table()[self.cells.found]


def _hatch_one_way(image: np.ndarray, where: np.ndarray, inch: float) -> None:
    """Paint one-way sliding white with level stripes, also where cells not computed are dotted."""
    image[where.T] = 255
    shade(image, level_stripes(where.shape, SPACING * inch, STRIPE * inch) * where, HATCHING)


def _name_regions(ax: Axes, cells: Cells, curves: Iterable[tuple[np.ndarray, np.ndarray]]) -> None:
    """Write the names of large regions into them, away from the curves."""
    x_edges, y_edges = (COARSE * grid.share(grid.edges) for grid in (cells.r, cells.beta))
    coarse = rasterise(cells.found, x_edges, y_edges, (COARSE, COARSE), COUNT)
    for x, y in curves:
        coarse[trace(cells.r.share(x), cells.beta.share(y))] = COUNT
    width, height = (side * 9.0 / points(9.0) for side in size_of(ax))
    if current().size is not None:  # the frame will be smaller than it is yet
        width, height = _FRAME * width, _FRAME * height
    for index in (STUCK, CONTINUOUS, ONE_WAY):
        name = cells.by.labels[index]
        place = room_for(coarse == index, name, (width, height))
        if place:
            ax.text(
                *place, name, transform=ax.transAxes, ha="center", va="center", fontsize=points(9.0),
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


def draw_frame(ax: Axes, panel: xr.Dataset, axes: tuple[Grid, Grid]) -> tuple[list[Handle], Curves]:
    """Draw the axes and the boundaries of one mu; return entries for the legend, and the curves."""
    r, beta = axes
    curves = boundary_curves(panel, r, beta.limits[1])
    handles: list[Handle] = []
    name_axes(ax, r, float(panel["mu"]))
    if beta.logarithmic:
        ax.set_yscale("log")
    ax.set_ylim(*beta.limits)
    frequency_on_top(ax, panel)
    on_the_right(ax, panel, "force")
    for name, curve in curves.items():
        style = LIM_CONTACT if name == "beta_lim" and "beta_stick_contact" in curves else _STYLES[name]
        handles += ax.plot(*curve, path_effects=halo(), **style)
    for ends in further_ends(panel, r, beta.limits[1]):
        handles += ax.plot(*ends, path_effects=halo(), **FURTHER)
    return handles, curves


def draw_map(ax: Axes, panel: xr.Dataset, cells: Cells) -> list[Handle]:
    """Draw one mu without rings; return the entries for the legend that are not classes."""
    ax.add_artist(RegimeImage(cells))
    if cells.counts[NOT_YET]:
        ax.patch.set(hatch=NOT_YET_HATCH, edgecolor=HATCH_COLOUR)
    handles, curves = draw_frame(ax, panel, (cells.r, cells.beta))
    if cells.several is not None:
        handles.append(
            Patch(
                facecolor="none", edgecolor=HATCH_COLOUR, hatch=HATCH, linewidth=0.0,
                label="several regimes: the initial state decides",
            )
        )  # fmt: skip
    handles += draw_borders(ax, panel, over_cells=True)
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
def plot_regimes(ds: xr.Dataset, ax: None = None, **options: Unpack[FigureOptions]) -> "AxesArray": ...


@overload
def plot_regimes(ds: xr.Dataset, ax: Axes, **options: Unpack[FigureOptions]) -> Axes: ...


@overload
def plot_regimes(
    ds: xr.Dataset, ax: "Sequence[Axes] | AxesArray", **options: Unpack[FigureOptions]
) -> "AxesArray": ...


@with_options
def plot_regimes(
    ds: xr.Dataset,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "Axes | AxesArray":
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

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.sweep(fm.System(), r=[0.4, 0.8, 1.2], beta=[0.1, 0.5, 0.9], mu=[1.0, 1.5])
    >>> axes = fm.plot_regimes(ds)
    >>> [ax.get_xlabel() for ax in axes.flat]
    ['frequency ratio $r$', 'frequency ratio $r$']
    """
    ds = to_draw(ds, "plot_regimes", "map")
    by = counted(ds)
    if regime_of_choice(ds) not in ds and by.variable not in ds:
        raise InputError("a map must hold regime or stops_per_cycle to be drawn; got neither")
    ds, grids = in_view(ds)
    panels = current().chosen(panels_of(ds))
    title = title_of_map(ds)
    axes = panel_grid(len(panels), title) if ax is None else given_axes(ax, len(panels), "one for each mu")
    cells = [cells_of(panel, by, grids) for panel in panels]
    others: list[Handle] = []
    for panel_ax, panel, part in zip(axes, panels, cells, strict=True):
        others += draw_map(panel_ax, panel, part) + _ring(panel_ax, part) + mark_point(panel_ax, ds)
    handles = _class_handles(panels, cells) + distinct(others)
    if ax is None:
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        legend_below(figure, handles, caption(ds, cells_counted=True))
        return axes
    legend_under(axes[-1], handles)
    return ax if isinstance(ax, Axes) else axes

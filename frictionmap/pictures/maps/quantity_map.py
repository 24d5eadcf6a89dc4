"""Maps of a number of every cell, such as an amplitude, in colours with a scale."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, Unpack, overload

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from ... import checks
from ...datasets.labels import LABELS, regime_of_choice
from ...errors import InputError
from ..classes import Counted, classes, counted
from ..drawing import with_options
from ..grids import Grid
from ..options import FigureOptions, current
from ..palette import CLASSES, NO_STOPS, NOT_YET, STUCK, colour_table
from ..panels import (  # fmt: skip
    MOST_PANELS,
    Handle,
    distinct,
    given_axes,
    grid_of_panels,
    legend_below,
    legend_under,
    patch,
)
from ..shapes import panels_of, to_draw
from ..sizes import points
from ..words import balanced, caption, name_of_contact, names_of_masses
from .cell_image import CellImage
from .regime_map import draw_frame, in_view
from .working_point import mark_point

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Colours of numbers of both signs, and of angles; others have those of the setting image.cmap.
_SIGNED, _CYCLIC = "RdBu_r", "twilight"

#: Peaks are cut off above this multiple of the value that all but the share `_BEYOND` of cells stay below.
_PEAK, _BEYOND = 4.0, 0.01

#: Letters per inch of the name of a scale.
_LETTERS = 12.0


class QuantityPanel(NamedTuple):
    """Numbers of the cells of one mu, of one mass or contact if there are several."""

    cells: xr.Dataset
    values: np.ndarray  # (r, beta)
    title: str  # mass or contact; empty if there is one value per cell
    found: np.ndarray  # classes, (r, beta): of that contact, else of all together
    by: Counted  # what they are named by


class QuantityImage(CellImage):
    """Cells in the colours of their numbers; cells without one in those of their classes."""

    def __init__(self, panel: QuantityPanel, axes: tuple[Grid, Grid], scale: ScalarMappable) -> None:
        super().__init__(*axes)
        self.panel, self.scale = panel, scale

    def image(self, edges: tuple[np.ndarray, np.ndarray], size: tuple[int, int], inch: float) -> np.ndarray:
        """Paint the cell at the centre of every pixel."""
        cells = [
            np.searchsorted(ends, np.arange(pixels) + 0.5, side="right") - 1
            for ends, pixels in zip(edges, size, strict=True)
        ]
        (i, j), shape = cells, self.panel.values.shape
        inside = [(k >= 0) & (k < most) for k, most in zip(cells, shape, strict=True)]
        where = np.ix_(np.clip(i, 0, shape[0] - 1), np.clip(j, 0, shape[1] - 1))
        image = self._painted(self.panel.values[where], self.panel.found[where])
        image[~(inside[0][:, np.newaxis] & inside[1])] = 0
        return np.ascontiguousarray(image.swapaxes(0, 1))

    def colours(self) -> np.ndarray:
        """Return the colours of all cells."""
        return self._painted(self.panel.values, self.panel.found)

    def _painted(self, values: np.ndarray, found: np.ndarray) -> np.ndarray:
        unknown = _without_number(values, found)
        numbers = np.where(unknown | np.isinf(values), self._top(), values)
        image = np.array(self.scale.to_rgba(numbers, bytes=True), dtype=np.uint8)
        image[unknown] = colour_table()[found[unknown]]
        return image

    def _top(self) -> float:
        return float(np.max(self.scale.norm.vmax or 0.0))


def _without_number(values: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Cells that keep the colour of their class: without a number, or stuck without motion or work."""
    return np.isnan(values) | ((found == STUCK) & (values == 0.0))


def quantities_of(ds: xr.Dataset) -> list[str]:
    """Variables of a map that have a number, or one for each mass or contact, in every cell."""
    return [
        str(name)
        for name, variable in ds.data_vars.items()
        if {"r", "beta"} <= set(variable.dims) <= {"mu", "r", "beta", "dof", "contact"}
        and name in LABELS
        and not LABELS[str(name)].codes
    ]


def _panels(ds: xr.Dataset, name: str) -> list[QuantityPanel]:
    """A panel for each mu, mass and contact."""
    found = []
    for panel in panels_of(ds):
        (dim, numbers) = next(
            ((d, ds[d].values.tolist()) for d in ("dof", "contact") if d in ds[name].dims), ("", [0])
        )
        names = dict(zip(numbers, names_of_masses(ds), strict=True)) if dim == "dof" else {}
        for number in numbers:
            cells = panel.sel(contact=number) if dim == "contact" else panel
            by = counted(ds.sel(contact=number) if dim == "contact" else ds)
            values = cells[name].sel(dof=number) if dim == "dof" else cells[name]
            title = names.get(number, f"contact {number}" if dim else "")
            numbers_of_cells = values.transpose("r", "beta").values.astype(float)
            found.append(QuantityPanel(cells, numbers_of_cells, title, _classes(cells, by), by))
    return found


def _classes(panel: xr.Dataset, by: Counted) -> np.ndarray:
    """Class of every cell, (r, beta); without a regime those that have no number are not distinguished."""
    if regime_of_choice(panel) in panel or by.variable in panel:
        return classes(panel, by)
    return np.full((panel.sizes["r"], panel.sizes["beta"]), NO_STOPS, dtype=np.uint8)


def _scale(name: str, panels: Sequence[QuantityPanel], log: bool) -> tuple[ScalarMappable, str]:
    """Colours of numbers, common to all panels, and which end of the scale numbers exceed."""
    values = np.concatenate([panel.values.ravel() for panel in panels])
    known = values[np.isfinite(values)]
    if log:
        known = known[known > 0.0]
    if not known.size:
        if log:
            raise InputError(f"cannot draw {name} with log: no cell has a number > 0; omit log")
        known = np.zeros(1)
    low, high = float(known.min()), float(known.max())
    usual = float(np.quantile(known, 1.0 - _BEYOND))
    if usual > 0.0 and high > _PEAK * usual and not log:
        high = usual
    beyond = bool((values > high).any())
    if LABELS[name].units == "radian":
        return _mappable(Normalize(-np.pi, np.pi), _CYCLIC), "neither"
    if low < 0.0 < high and not log:
        largest = max(-low, high)
        return _mappable(Normalize(-largest, largest), _SIGNED), "max" if beyond else "neither"
    if low == high:
        low, high = (0.5 * low, 2.0 * high) if log else (low - 0.5, high + 0.5)
    norm = LogNorm(low, high) if log else Normalize(low, high)
    return _mappable(norm, str(mpl.rcParams["image.cmap"])), "max" if beyond else "neither"


def _mappable(norm: Normalize, colours: str) -> ScalarMappable:
    return ScalarMappable(norm, mpl.colormaps[colours])


@overload
def plot_quantity(
    ds: xr.Dataset, name: str, ax: None = None, *, log: bool = False, **options: Unpack[FigureOptions]
) -> "AxesArray": ...


@overload
def plot_quantity(
    ds: xr.Dataset, name: str, ax: Axes, *, log: bool = False, **options: Unpack[FigureOptions]
) -> Axes: ...


@overload
def plot_quantity(
    ds: xr.Dataset,
    name: str,
    ax: "Sequence[Axes] | AxesArray",
    *,
    log: bool = False,
    **options: Unpack[FigureOptions],
) -> "AxesArray": ...


@with_options
def plot_quantity(
    ds: xr.Dataset,
    name: str,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    *,
    log: bool = False,
    **options: Unpack[FigureOptions],
) -> "Axes | AxesArray":
    """Draw a number of every cell of a map in colours, with a colour bar and the boundaries over it.

    Cells without a number have the colour of their class: grey where the contact is stuck, red where the
    cell is unresolved.  The highest peaks are cut off if all other cells would look alike.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `sweep`, or a part of it.
    name : str
        Variable with a number in every cell, such as "contact_amplitude", "multiplier", "work_friction",
        "stuck_fraction", "period", "asymmetry" or "amplitude".  Values of masses or contacts have a panel
        each; choose some with `mass`, `panels` or ``ds.sel(contact=2)``.
    ax : matplotlib axes, or an array of them, optional
        Axes to draw into, one for each mu, mass and contact; the colour bar takes its room from them.
    log : bool
        Logarithmic scale of colours.

    Returns
    -------
    The axes: those given, or an array with one for each panel.

    Raises
    ------
    InputError
        The dataset is not a map or has no such variable, or the number of axes differs from that of panels.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.sweep(fm.System(), r=[0.4, 0.8, 1.2], beta=[0.1, 0.5, 0.9])
    >>> axes = fm.plot_quantity(ds, "contact_amplitude")
    >>> [ax.get_xlabel() for ax in axes.flat]
    ['frequency ratio $r$']
    """
    ds = to_draw(ds, "plot_quantity", "map")
    valid = quantities_of(ds)
    if name not in valid:
        hint = checks.nearest(name, valid) if isinstance(name, str) else ""
        there = ", ".join(valid) or "none"
        raise InputError(f"unknown quantity {checks.one_line(name)} of a map{hint}; valid: {there}")
    ds, grids = in_view(ds)
    panels = current().chosen(_panels(ds, name))
    title = _title(ds, name)
    axes = _new_axes(len(panels), title) if ax is None else given_axes(ax, len(panels), "one for each panel")
    scale, ends = _scale(name, panels, log)
    handles: list[Handle] = []
    for panel_ax, panel in zip(axes, panels, strict=True):
        handles += [*_draw(panel_ax, panel, grids, scale), *mark_point(panel_ax, ds)]
    handles = [*_class_handles(panels), *distinct(handles)]
    figure = axes[0].figure
    assert isinstance(figure, Figure)
    label = balanced(str(ds[name].attrs.get("long_name", name)), int(_LETTERS * figure.get_figheight()))
    figure.colorbar(scale, ax=list(axes), label=label, extend=ends, shrink=0.8)
    if ax is None:
        legend_below(figure, handles, caption(ds))
        return axes
    legend_under(axes[-1], handles)
    return ax if isinstance(ax, Axes) else axes


def _title(ds: xr.Dataset, name: str) -> str:
    """Title: the quantity in place of that of the map, and the contact that was chosen."""
    words = str(ds[name].attrs.get("long_name", name)).partition(", ")[0]
    return ", ".join(filter(None, (words[:1].upper() + words[1:], name_of_contact(ds))))


def _new_axes(panels: int, title: str) -> "AxesArray":
    if panels > MOST_PANELS:
        raise InputError(
            f"a picture must have at most {MOST_PANELS} panels; got {panels}: choose some with panels or mass"
        )
    columns = current().columns(2 if panels in (2, 4) else min(panels, 3))
    return grid_of_panels(panels, columns, 3.9, title)


def _draw(ax: Axes, panel: QuantityPanel, grids: tuple[Grid, Grid], scale: ScalarMappable) -> list[Handle]:
    """Draw one panel; return entries for the legend."""
    ax.add_artist(QuantityImage(panel, grids, scale))
    handles, _ = draw_frame(ax, panel.cells, grids)
    if panel.title:
        words = f"{panel.title}, {ax.get_title()}"
        ax.set_title(words, fontsize=points(10.0, "axes.titlesize"))
    return handles


def _class_handles(panels: Sequence[QuantityPanel]) -> list[Handle]:
    """Legend entries of the classes of cells without a number."""
    there = {
        (int(k), panel.by.labels[k])
        for panel in panels
        for k in np.unique(panel.found[_without_number(panel.values, panel.found)])
        if k < NOT_YET
    }
    return [patch(label, CLASSES[k].colour) for k, label in sorted(there)]

"""Regimes on a belt without a load, over belt speed and friction, with the limits over them."""

from typing import TYPE_CHECKING, Literal, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ... import regimes
from ...errors import InputError
from ..drawing import with_options
from ..grids import HIGH, Grid, limited
from ..options import FigureOptions, current
from ..palette import CYCLE_SPEED, HATCH, HATCH_COLOUR, NO_LOAD, SLIDING_LIMIT
from ..panels import Handle, distinct, halo, legend_below, panel_grid, patch
from ..second_axes import on_the_right, velocity_on_top
from ..shapes import panels_of, to_draw
from ..sizes import points
from ..words import system_words
from .cell_image import CellImage
from .raster import paint, rasterise, shade, stripes
from .regime_map import HATCHING, SPACING, STRIPE

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Regimes in the order of their classes.
_CLASSES = tuple(code.value for code in regimes.NO_LOAD_REGIMES)


class BeltImage(CellImage):
    """Cells of one mu in the colours of their regimes, hatched where several motions are stable."""

    def __init__(self, speed: Grid, beta: Grid, panel: xr.Dataset) -> None:
        super().__init__(speed, beta)
        regime, flags = panel["regime"].values, panel["also_reachable"].values
        self.found = np.zeros(regime.shape, np.uint8)
        for index, code in enumerate(_CLASSES):
            self.found[regime == code] = index
        self.several = ((flags & (flags - 1)) != 0).astype(np.uint8)

    def image(self, edges: tuple[np.ndarray, np.ndarray], size: tuple[int, int], inch: float) -> np.ndarray:
        """Paint the most frequent class of every pixel, with stripes over several motions."""
        image = paint(rasterise(self.found, *edges, size, len(_CLASSES)), _colours())
        if self.several.any():
            where = rasterise(self.several, *edges, size, 2) == 1
            shade(image, stripes(where.shape, SPACING * inch, STRIPE * inch) * where, HATCHING)
        return image

    def colours(self) -> np.ndarray | None:
        """Return the colours of the classes; stripes need pixels."""
        return None if self.several.any() else _colours()[self.found]


def _colours() -> np.ndarray:
    """Colours of the classes, 0 to 255; transparent where there is no cell."""
    table = np.zeros((len(_CLASSES) + 1, 4), np.uint8)
    for row, code in zip(table, _CLASSES, strict=False):
        row[:] = [int(NO_LOAD[code].colour[k : k + 2], 16) for k in (1, 3, 5)] + [255]
    return table


def _curves(ax: Axes, panel: xr.Dataset, speed: Grid, beta: Grid) -> list[Handle]:
    """Draw the largest speed of the stick-slip cycle, and the friction at which sliding loses stability."""
    handles: list[Handle] = []
    if "cycle_speed_lim" in panel:
        at = np.minimum(panel["cycle_speed_lim"].values, HIGH * speed.limits[1])
        handles += ax.plot(at, beta.values, path_effects=halo(), **CYCLE_SPEED)
    if "beta_sliding_lim" in panel:
        limit = panel["beta_sliding_lim"].values
        if np.isfinite(limit).any():
            drawn = np.where(np.isfinite(limit), np.minimum(limit, HIGH * beta.limits[1]), np.nan)
            # the slope of segments is the same at many speeds, that of a formula at none
            style: Literal["steps-mid", "default"] = (
                "steps-mid" if np.unique(limit).size < limit.size else "default"
            )
            handles += ax.plot(speed.values, drawn, path_effects=halo(), drawstyle=style, **SLIDING_LIMIT)
    return handles


def _frame(ax: Axes, panel: xr.Dataset, speed: Grid, beta: Grid) -> None:
    """Scales, limits and names of the axes."""
    if speed.logarithmic:
        ax.set_xscale("log")
    if beta.logarithmic:
        ax.set_yscale("log")
    ax.set_xlim(*speed.limits)
    ax.set_ylim(*beta.limits)
    ax.set_xlabel(r"belt speed $v$ over $\omega_1 P/k_1$")
    ax.set_ylabel(r"friction ratio $\beta$")
    ax.set_title(rf"$\mu$ = {float(panel['mu']):g}", fontsize=points(10.0, "axes.titlesize"))
    velocity_on_top(ax, panel)
    on_the_right(ax, panel, "force")


@with_options
def plot_belt(ds: xr.Dataset, **options: Unpack[FigureOptions]) -> "AxesArray":
    """Draw the regimes on a belt without a load, one panel for each mu, with the limits over them.

    Cells with several stable motions are hatched.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `sweep` over wall_speed, or a part of it.

    Returns
    -------
    Axes, one for each mu.

    Raises
    ------
    InputError
        The dataset has no cells.

    Examples
    --------
    One panel for each mu:

    >>> import frictionmap as fm
    >>> belt = fm.System(damping_ratios=0.05)
    >>> ds = fm.sweep(belt, wall_speed=[0.1, 0.5, 1.0], beta=[0.5, 1.0], mu=[1.5, 2.0])
    >>> fm.plot_belt(ds).size
    2
    """
    ds = to_draw(ds, "plot_belt", "belt")
    if "regime" not in ds:
        raise InputError(
            "cannot draw limits without a load alone: the picture shows regimes; compute the map with "
            "frictionmap map"
        )
    shown = {"wall_speed": current().xlim, "beta": current().ylim}
    speed, beta = (limited(name, ds[name].values, limits) for name, limits in shown.items())
    panels = current().chosen(panels_of(ds))
    axes = panel_grid(len(panels), str(ds.attrs.get("title", "")))
    lines: list[Handle] = []
    several = False
    for ax, panel in zip(axes, panels, strict=True):
        image = BeltImage(speed, beta, panel)
        several = several or bool(image.several.any())
        ax.add_artist(image)
        _frame(ax, panel, speed, beta)
        lines += _curves(ax, panel, speed, beta)
    figure = axes[0].figure
    assert isinstance(figure, Figure)
    legend_below(figure, _handles(panels, several) + distinct(lines), system_words(ds))
    return axes


def _handles(panels: list[xr.Dataset], several: bool) -> list[Handle]:
    """Legend entries of the regimes that occur, with their numbers of cells."""
    found = np.concatenate([panel["regime"].values.ravel() for panel in panels])
    counts = {code: int((found == code).sum()) for code in _CLASSES}
    handles: list[Handle] = [
        patch(f"{NO_LOAD[code].label} ({count:,})", NO_LOAD[code].colour)
        for code, count in counts.items()
        if count
    ]
    if several:
        handles.append(
            Patch(
                facecolor="none", edgecolor=HATCH_COLOUR, hatch=HATCH, linewidth=0.0,
                label="several stable motions: the initial state decides",
            )
        )  # fmt: skip
    return handles

"""Pictures of probabilities: the share of the samples of an uncertain structure in each regime."""

from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from ..drawing import with_options
from ..grids import Grid
from ..options import FigureOptions, current
from ..panels import Handle, distinct, grid_of_panels, halo, legend_below, name_axes
from ..second_axes import frequency_on_top, on_the_right
from ..shapes import check_holds, to_draw
from ..sizes import points
from ..words import system_words, title_of_map

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Regimes with a panel if any sample is in them, from left to right.
_OUTCOMES = ("continuous", "stick_slip", "permanent_sticking", "one_way_sliding", "unresolved")

#: Colour map with increasing darkness, also in grey, common to all regimes.
_COLOURS = "Blues"

_BOUNDARIES = {"beta_lim": "-", "beta_stick": (0, (4, 2))}
_SYMBOLS = {"beta_lim": r"$\beta_\mathrm{lim}$", "beta_stick": r"$\beta_\mathrm{stick}$"}


@with_options
def plot_shares(ds: xr.Dataset, **options: Unpack[FigureOptions]) -> "AxesArray":
    """Draw the result of `shares`: one panel for each mu and regime, with quantiles of the boundaries.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `shares`, or a slice of one.

    Returns
    -------
    Axes, one for each mu and each regime that occurs.

    Raises
    ------
    InputError
        The dataset is not a result of `shares`.

    Examples
    --------
    >>> import frictionmap as fm
    >>> maps = fm.sweep(fm.System(), [0.4, 0.8], [0.3, 0.6], axes={"damping_ratios": [0.0, 0.1]})
    >>> ds = fm.shares(maps, over="damping_ratios")
    >>> axes = fm.plot_shares(ds)
    >>> [ax.get_xlabel() for ax in axes.flat]
    ['frequency ratio $r$', 'frequency ratio $r$']
    """
    ds = to_draw(ds, "plot_shares", "shares")
    check_holds(ds, ["regime_share"], "shares")
    share = ds["regime_share"]
    seen = share["outcome"].values[(share.values > 0.0).any(axis=(1, 2, 3))].tolist()
    there = [name for name in _OUTCOMES if name in (seen or share["outcome"].values)]
    title = title_of_map(ds)
    panels = current().chosen((m, name) for m in range(ds.sizes["mu"]) for name in there)
    columns = current().columns(min(len(there), len(panels)))
    axes = grid_of_panels(len(panels), columns, 3.6, title)
    r, beta = Grid(ds["r"].values), Grid(ds["beta"].values)
    handles: list[Handle] = []
    for ax, (m, name) in zip(axes, panels, strict=True):
        mesh = _fill(ax, share.sel(outcome=name).isel(mu=m).values, r, beta)
        name_axes(ax, r, float(ds["mu"][m]))
        frequency_on_top(ax, ds)
        on_the_right(ax, ds, "force")
        words = f"{name.replace('_', ' ')}, {ax.get_title()}"
        ax.set_title(words, fontsize=points(10.0, "axes.titlesize"))
        handles += _lines(ax, ds.isel(mu=m), r, beta)
    figure = axes[0].figure
    assert isinstance(figure, Figure)
    figure.colorbar(mesh, ax=axes, label="share of the samples", shrink=0.8)
    words = f"{ds.attrs.get('samples', 0):,} samples around {system_words(ds)}"
    legend_below(figure, distinct(handles), words)
    return axes


def _fill(ax: Axes, values: np.ndarray, r: Grid, beta: Grid) -> QuadMesh:
    mesh = ax.pcolormesh(r.edges, beta.edges, values.T, cmap=_COLOURS, vmin=0.0, vmax=1.0, rasterized=True)
    if beta.logarithmic:
        ax.set_yscale("log")
    ax.set_ylim(*beta.limits)
    return mesh


def _lines(ax: Axes, panel: xr.Dataset, r: Grid, beta: Grid) -> list[Handle]:
    """Draw quantiles of the boundaries: the middle one wide, the others thin."""
    handles: list[Handle] = []
    middle = int(np.argmin(np.abs(panel["quantile"].values - 0.5)))
    for name, style in _BOUNDARIES.items():
        if f"{name}_quantile" not in panel:
            continue
        curves = panel[f"{name}_quantile"].values
        for k, level in enumerate(panel["quantile"].values):
            wide = k == middle
            drawn = ax.plot(
                r.values, np.minimum(curves[k], 2.0 * beta.limits[1]), color="black", linestyle=style,
                linewidth=1.4 if wide else 0.7, path_effects=halo(2.4 if wide else 1.6),
            )  # fmt: skip
            if wide:
                others = [f"{100 * q:g}" for j, q in enumerate(panel["quantile"].values) if j != middle]
                thin = f"; thin: {' and '.join(others)} %" if others else ""
                drawn[0].set_label(f"{_SYMBOLS[name]}, {100 * level:g} % of the samples below{thin}")
                handles += drawn
    return handles

"""Pictures of fits to measured data: which of them is drawn, and their layout."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...errors import InputError
from ...files.estimates import estimates_in_short, verdict_in_words
from ..drawing import with_options
from ..options import FigureOptions, current
from ..panels import distinct, given_axes, legend_below, legend_under, new_figure, title_figure
from ..shapes import check_holds, check_range, to_draw
from .chain import chain_picture, is_chain
from .data import about_residuals
from .decay import decay_picture, is_decay
from .forced import forced_picture, is_forced
from .loop import is_loop, loop_picture
from .picture import FitPicture
from .record import is_record, record_picture
from .samples import samples_picture
from .sweep import is_sweep, sweep_picture

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Height of the title and of the names of an axis [inch].
_REST = 0.6


@with_options
def plot_fit(
    ds: xr.Dataset,
    ax: "Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Picture of a fit to measured data: samples over the fitted curve, residuals below.

    A free decay has its turning points, their envelope and the place of rest; forced responses have the
    fitted curve of every set and, as a record, their place on the regime map, if the dataset has the
    structure; all cycles of a record lie over each other as well.  Bars are one standard error of a sample,
    and a band beside the residuals; the caption has the estimates with their standard errors, what was found,
    and the lag-1 correlation of the residuals.

    Parameters
    ----------
    ds : xarray.Dataset
        As the functions of `identify` return it, or a part of it.
    ax : array of matplotlib axes, optional
        Axes to draw into, from top to bottom, those beside last; the legend goes under the last of them.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset holds no estimates, or lacks a variable to draw, or there are more or fewer axes than
        panels.

    Examples
    --------
    >>> import frictionmap as fm
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> n = np.floor(2 * t)
    >>> x = (9.5 - (2 * n + 1) * 0.5) * np.cos(2 * np.pi * t) + (-1) ** n * 0.5
    >>> noise = np.random.default_rng(1).normal(0.0, 0.02, t.size)
    >>> ds = fm.identify.free_decay(t, x + noise)
    >>> axes = fm.plot_fit(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['displacement [mm]', 'residual [mm]']
    """
    ds = to_draw(ds, "plot_fit", "estimates")
    names = ("data", "model", "residual")
    check_holds(ds, names, "its fit")
    check_range(ds, names)
    if ds.sizes["sample"] < 1:
        raise InputError("a dataset must have at least one sample for its fit to be drawn; got none")
    picture = _picture(ds).chosen(current())
    panels = picture.all
    axes = _new_axes(picture, ds) if ax is None else given_axes(ax, len(panels), "one for each panel")
    handles = distinct([handle for panel, one in zip(panels, axes, strict=True) for handle in panel(one)])
    if ax is None:
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        remarks = (estimates_in_short(ds), verdict_in_words(ds), about_residuals(ds), *picture.remarks)
        legend_below(figure, handles, "; ".join(filter(None, remarks)))
    else:
        legend_under(axes[-1], handles)
    return axes


def _picture(ds: xr.Dataset) -> FitPicture:
    if is_loop(ds):
        return loop_picture(ds)
    if is_decay(ds):
        return decay_picture(ds)
    if is_record(ds):
        return record_picture(ds)
    if is_forced(ds):
        return forced_picture(ds)
    if is_sweep(ds):
        return sweep_picture(ds)
    return chain_picture(ds) if is_chain(ds) else samples_picture(ds)


def _new_axes(picture: FitPicture, ds: xr.Dataset) -> "AxesArray":
    """Axes of a new figure with the title of the dataset."""
    width, height = picture.size()
    figure = new_figure(width, height + _REST)
    title_figure(figure, str(ds.attrs.get("title", "")))
    return picture.lay_out(figure)

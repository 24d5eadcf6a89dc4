"""`plot_design`: the picture of the result of a design question."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import xarray as xr
from matplotlib.axes import Axes

from ..panels import distinct, given_axes, legend_below, new_figure, title_figure
from ..shapes import check_holds, to_draw
from ..words import caption
from .limits import draw_limits
from .performance import draw_performance, draw_responses

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Size of a panel [inch].
_WIDTH, _HEIGHT = 5.4, 4.0


def plot_design(ds: xr.Dataset, ax: "Axes | Sequence[Axes] | AxesArray | None" = None) -> "AxesArray":
    """Draw the result of a design question.

    Of questions about the largest response: the performance curve, largest response over friction, with the
    answer; and response curves at the answer, at half and twice its friction, without friction, and stuck.
    Of questions about boundaries: the boundaries over frequency, with the answer or the working point.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a function of `design`, or of the command design.
    ax : axes of matplotlib, optional
        Axes to draw into: two for the largest response, else one.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is not an answer or lacks a variable to draw, or the number of axes is wrong.
    """
    ds = to_draw(ds, "plot_design", "design")
    check_holds(ds, ("question", "beta"), "its answer")
    of_peaks = "peak_of_beta" in ds
    names = ("peak_of_beta", "peak", "response_of_r", "curve") if of_peaks else ("r_search",)
    check_holds(ds, names, "its answer")
    count = 2 if of_peaks else 1
    if ax is None:
        figure = new_figure(_WIDTH * count, _HEIGHT)
        axes = figure.subplots(1, count, squeeze=False).ravel()
    else:
        axes = given_axes(ax, count, "for an answer")
    if of_peaks:
        handles = [*draw_performance(axes[0], ds), *draw_responses(axes[1], ds)]
    else:
        handles = draw_limits(axes[0], ds)
    if ax is None:
        title_figure(axes[0].figure, str(ds.attrs.get("title", "")))
        legend_below(axes[0].figure, distinct(handles), caption(ds))
    return axes

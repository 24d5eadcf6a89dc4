"""`plot_design`: the picture of the result of a design question."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple, Unpack

import xarray as xr
from matplotlib.axes import Axes

from ...datasets.questions import record
from ..drawing import with_options
from ..options import FigureOptions, current
from ..panels import Handle, distinct, given_axes, legend_below, legend_under, new_figure, title_figure
from ..shapes import check_holds, to_draw
from ..words import caption
from .limits import draw_limits
from .performance import draw_performance, draw_responses, draw_ridge
from .speeds import draw_speeds

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Size of a panel [inch].
_WIDTH, _HEIGHT = 5.4, 4.0


class _Panel(NamedTuple):
    """A part of a picture, and the variables that it draws."""

    draw: Callable[[Axes, xr.Dataset], list[Handle]]
    needs: tuple[str, ...]


#: Panels by the names that records of questions give them.
_PANELS = {
    "performance": _Panel(draw_performance, ("peak_of_beta", "peak")),
    "responses": _Panel(draw_responses, ("peak", "response_of_r", "curve")),
    "ridge": _Panel(draw_ridge, ("ratio_search", "peak_of_ratio", "beta_of_ratio", "second", "second_ratio")),
    "limits": _Panel(draw_limits, ("r_search",)),
    "speeds": _Panel(draw_speeds, ("speed_search", "growth_of_speed", "sliding_speed_lim", "wall_speed")),
}


@with_options
def plot_design(
    ds: xr.Dataset,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw the result of a design question.

    Of questions about the largest response: the performance curve, largest response over friction, with the
    answer; and response curves at the answer, at half and twice its friction or at the ends of its spread,
    without friction, and stuck.
    Of two forces also the least peak over the ratio of the second one.
    Of questions about boundaries: the boundaries over frequency, with the answer or the working point.
    Of belts without a load: the growth of small vibrations over the belt speed, and where it squeals.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a function of `design`, or of the command design.
    ax : axes of matplotlib, optional
        Axes to draw into: two for the largest response, three for two forces, else one.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is not an answer or lacks a variable to draw, or the number of axes is wrong.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.design.no_stop(fm.System(damping_ratios=0.02), band=[0.8, 1.2])
    >>> axes = fm.plot_design(ds)
    >>> [ax.get_xlabel() for ax in axes.flat]
    ['frequency ratio $r$']
    """
    ds = to_draw(ds, "plot_design", "design")
    check_holds(ds, ("question", "beta"), "its answer")
    parts = [_PANELS[name] for name in record(str(ds["question"].values)).panels]
    for part in parts:
        check_holds(ds, part.needs, "its answer")
    draw = current().chosen([part.draw for part in parts])
    if ax is None:
        columns = current().columns(len(draw))
        rows = -(-len(draw) // columns)
        figure = new_figure(_WIDTH * columns, _HEIGHT * rows)
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
    else:
        axes = given_axes(ax, len(draw), "for an answer")
    handles = [handle for panel, one in zip(draw, axes, strict=True) for handle in panel(one, ds)]
    handles = distinct(handles)
    if ax is None:
        title_figure(axes[0].figure, str(ds.attrs.get("title", "")))
        legend_below(axes[0].figure, handles, caption(ds))
    else:
        legend_under(axes[-1], handles)
    return axes

"""Friction over the motion in the contacts."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..options import current
from ..second_axes import length_on_top, on_the_right
from ..sizes import points
from ..words import length_unit
from .traces import Trace

#: Size of the marks of stops, and of arrow heads [points].
_DOT, _HEAD = 4.5, 16.0

#: Samples from the tail to the head of an arrow, as a share of all.
_ARROW = 0.015


def draw_loop(ax: Axes, ds: xr.Dataset, traces: Sequence[Trace]) -> None:
    """Draw friction over the motion in the contacts; a loop encloses the work of friction."""
    draw_loops(ax, traces, f"motion in the contact $z$ / {length_unit(ds)}", "friction / $P$")
    length_on_top(ax, ds, "motion in the contact")
    on_the_right(ax, ds, "force", "friction")


def draw_loops(ax: Axes, traces: Sequence[Trace], length: str, force: str) -> None:
    """Draw friction over the motion in the contacts, with the names of both axes.

    Arrows show the direction in which time goes on, dots where stops begin.
    """
    for trace in traces:
        ax.plot(trace.z, trace.friction, color=trace.colour, linewidth=1.2)
        if not trace.rests:
            speed = np.gradient(trace.z)
            for k in (int(np.argmax(speed)), int(np.argmin(speed))):
                draw_arrow(ax, trace.z, trace.friction, k, trace.colour)
        draw_stops(ax, trace.stops[1], trace.stop_friction, trace.colour)
    ax.set_xlabel(length)
    ax.set_ylabel(force)
    title = "hysteresis loop" if all(trace.elastic for trace in traces) else "friction loop"
    ax.set_title(title, fontsize=points(10.0, "axes.titlesize"))


def draw_arrow(ax: Axes, x: np.ndarray, y: np.ndarray, k: int, colour: str) -> None:
    """Draw an arrow head on a closed curve at its k-th sample, in the direction of time."""
    aside = max(1, round(_ARROW * x.size))
    first, last = max(0, k - aside), min(x.size - 1, k + aside)
    style = {"arrowstyle": "-|>", "color": colour, "linewidth": 0.0, "shrinkA": 0.0, "shrinkB": 0.0}
    ax.annotate(
        "", (x[last], y[last]), (x[first], y[first]), annotation_clip=False,
        arrowprops={**style, "mutation_scale": _HEAD * _share()},
    )  # fmt: skip


def draw_stops(ax: Axes, x: np.ndarray, y: np.ndarray, colour: str) -> None:
    """Mark where stops begin."""
    ax.scatter(x, y, s=(_DOT * _share()) ** 2, color=colour, zorder=3.0, clip_on=False)


def _share() -> float:
    """Size of marks in small figures, over that in others."""
    return 1.0 if current().size is None else 0.8

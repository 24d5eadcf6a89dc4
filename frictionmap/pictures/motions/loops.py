"""Friction over the motion in the contacts."""

from collections.abc import Sequence

import xarray as xr
from matplotlib.axes import Axes

from ..second_axes import length_on_top, on_the_right
from ..sizes import points
from .traces import Trace

#: Colour of the only contact.
CONTACT_COLOUR = "black"


def draw_loop(ax: Axes, ds: xr.Dataset, traces: Sequence[Trace]) -> None:
    """Draw friction over the motion in the contacts; a loop encloses the work of friction."""
    draw_loops(ax, traces, r"motion in the contact $z$ / $(P/k_1)$", "friction / $P$")
    length_on_top(ax, ds, "motion in the contact")
    on_the_right(ax, ds, "force", "friction")


def draw_loops(ax: Axes, traces: Sequence[Trace], length: str, force: str) -> None:
    """Draw friction over the motion in the contacts, with the names of both axes."""
    for trace in traces:
        ax.plot(trace.z, trace.friction, color=trace.colour if trace.label else CONTACT_COLOUR, linewidth=1.2)
    ax.set_xlabel(length)
    ax.set_ylabel(force)
    title = "hysteresis loop" if all(trace.elastic for trace in traces) else "friction loop"
    ax.set_title(title, fontsize=points(10.0, "axes.titlesize"))

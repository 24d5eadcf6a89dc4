"""Boundaries over the band, with the answer or the working point."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ...datasets.questions import record
from ..maps.working_point import WORKING_POINT
from ..palette import LIM, STICK, LineStyle
from ..panels import Handle
from ..second_axes import frequency_on_top, on_the_right
from .performance import ANSWER, in_units

#: Friction that is shown, as a multiple of that of the answer.
_SHOWN = 3.0


#: From there on every motion comes to rest (mu > 1).
_STUCK: LineStyle = {**STICK, "linestyle": (0, (1.5, 1.2)), "label": "sticks whatever the start"}


def draw_limits(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the boundaries over frequency, and where the answer or the working point is."""
    r, beta = ds["r_search"].values, float(ds["beta"])
    handles: list[Handle] = []
    tops = []
    for name, style in (("beta_lim_of_r", LIM), ("beta_stick_of_r", STICK), ("beta_stuck_of_r", _STUCK)):
        if name in ds:
            values = ds[name].values
            tops.append(float(np.median(values[np.isfinite(values)])))
            handles += ax.plot(r, np.where(np.isfinite(values), values, np.nan), **style)
    shown = [_SHOWN * beta] if np.isfinite(beta) and beta > 0.0 else []
    top = max([*shown, *(2.0 * one for one in tops)], default=1.0) or 1.0
    name = record(str(ds["question"].values)).mark
    answer: dict[str, Any] = {"color": ANSWER, "marker": "o", "markersize": 6.0}
    mark = WORKING_POINT if name == "working point" else answer
    colour = mark.get("color", "black")
    if np.isfinite(beta) and "at_r" in ds:
        ax.axhline(beta, color=colour, linewidth=0.9, linestyle=":")
        ax.plot([float(ds["at_r"])], [beta], zorder=4.0, clip_on=False, **mark)
        label = f"{name}: β = {beta:.4g}{in_units(ds, beta, 'force', top)}"
        handles.append(Line2D([], [], label=label, **{"color": colour, **mark, "linestyle": ":"}))
    for name in ("nearest_r_on_beta_lim", "nearest_r_on_beta_stick"):
        if name in ds and r[0] <= float(ds[name]) <= r[-1]:
            ax.plot([float(ds[name])], [beta], "|", color=colour, markersize=12.0)
    ax.set_xlim(r[0], r[-1])
    ax.set_ylim(0.0, top)
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(r"friction ratio $\beta$")
    frequency_on_top(ax, ds.rename(r_search="r"))
    on_the_right(ax, ds, "force")
    return handles

"""Growth of small vibrations over the belt speed, with the speeds at which it squeals."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ... import regimes
from ..palette import LINES, NO_LOAD
from ..panels import Handle
from ..second_axes import velocity_on_top


def draw_speeds(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the growth over the belt speed, and shade where it squeals by itself and after a push."""
    speed, growth = ds["speed_search"].values, ds["growth_of_speed"].values
    right = float(speed[-1])
    ends = [0.0, *(min(float(ds[name]), right) for name in ("sliding_speed_lim", "wall_speed"))]
    pushed = "squeals after a push" if "cycle_speed_lim" in ds else "may squeal after a push"
    looks = (
        (regimes.STICK_SLIP_CYCLE, "squeals by itself"),
        (regimes.CYCLE_WITHOUT_STOPS, pushed),
    )
    handles: list[Handle] = []
    for (regime, label), low, high in zip(looks, ends[:-1], ends[1:], strict=True):
        if high > low:
            style: dict[str, Any] = {"facecolor": NO_LOAD[regime].colour, "alpha": 0.5, "linewidth": 0.0}
            ax.axvspan(low, high, **style)
            handles.append(Patch(label=label, **style))
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.plot(speed, growth, color="black", linewidth=1.4)
    handles.append(Line2D([], [], color="black", linewidth=1.4, label="growth of small vibrations"))
    if np.isfinite(float(ds["wall_speed"])):
        ax.axvline(float(ds["wall_speed"]), color=LINES[4], linewidth=1.4)
        label = f"least speed without squeal: {float(ds['wall_speed']):.4g}"
        handles.append(Line2D([], [], color=LINES[4], linewidth=1.4, label=label))
    ax.set_xlim(0.0, right)
    ax.set_xlabel(r"belt speed $v / (\omega_1 P/k_1)$")
    ax.set_ylabel(r"growth rate / $\omega_1$")
    velocity_on_top(ax, ds)
    return handles

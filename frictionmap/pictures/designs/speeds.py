"""Growth of small vibrations over the belt speed, with the speeds at which it squeals."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..palette import LINES
from ..panels import Handle
from ..second_axes import velocity_on_top
from .performance import ANSWER, in_units

#: Squeal is shaded in red, lighter where only a push begins it.
_SQUEAL, _BY_ITSELF, _AFTER_A_PUSH = LINES[4], 0.35, 0.12


def draw_speeds(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the growth over the belt speed, and shade where it squeals by itself and after a push."""
    speed, growth = ds["speed_search"].values, ds["growth_of_speed"].values
    right = float(speed[-1])
    ends = [0.0, *(min(float(ds[name]), right) for name in ("sliding_speed_lim", "wall_speed"))]
    pushed = "squeals after a push" if "cycle_speed_lim" in ds else "may squeal after a push"
    looks = ((_BY_ITSELF, "squeals by itself"), (_AFTER_A_PUSH, pushed))
    handles: list[Handle] = []
    for (tint, label), low, high in zip(looks, ends[:-1], ends[1:], strict=True):
        if high > low:
            style: dict[str, Any] = {"facecolor": _SQUEAL, "alpha": tint, "linewidth": 0.0}
            ax.axvspan(low, high, **style)
            handles.append(Patch(label=label, **style))
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.plot(speed, growth, color="black", linewidth=1.4)
    handles.append(Line2D([], [], color="black", linewidth=1.4, label="growth of small vibrations"))
    quiet = float(ds["wall_speed"])
    if np.isfinite(quiet):
        ax.axvline(quiet, color=ANSWER, linewidth=1.4)
        label = f"least speed without squeal: {quiet:.4g}{in_units(ds, quiet, 'velocity', right)}"
        handles.append(Line2D([], [], color=ANSWER, linewidth=1.4, label=label))
    ax.set_xlim(0.0, right)
    ax.set_xlabel(r"belt speed $v / (\omega_1 P/k_1)$")
    ax.set_ylabel(r"growth rate / $\omega_1$")
    velocity_on_top(ax, ds)
    return handles

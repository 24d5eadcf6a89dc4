"""Borders between numbers of stops as curves of a picture."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..palette import BORDER, BORDER_OF_EXISTENCE
from ..panels import Handle, halo


def draw_borders(ax: Axes, panel: xr.Dataset, *, over_cells: bool = False) -> list[Handle]:
    """Draw the borders of a panel, which are those of its mu; return the entry for the legend."""
    if not {"border_r", "border_beta", "border_mu"} <= set(panel):
        return []
    mu = float(panel["mu"])
    rim = halo(1.6) if over_cells else []
    lines: list[Handle] = []
    for k in np.flatnonzero(panel["border_mu"].values == mu):
        x, y = panel["border_r"].values[k], panel["border_beta"].values[k]
        lines += ax.plot(x, y, path_effects=rim, **(BORDER if mu == 1.0 else BORDER_OF_EXISTENCE))
    return lines[:1]

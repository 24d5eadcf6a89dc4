"""Borders between numbers of stops as curves of a picture."""

import xarray as xr
from matplotlib.axes import Axes

from ..palette import BORDER
from ..panels import Handle, halo


def draw_borders(ax: Axes, panel: xr.Dataset, *, over_cells: bool = False) -> list[Handle]:
    """Draw the borders of a panel, which are those of mu = 1; return the entry for the legend."""
    if not {"border_r", "border_beta"} <= set(panel) or float(panel["mu"]) != 1.0:
        return []
    rim = halo(1.6) if over_cells else []
    lines: list[Handle] = []
    for x, y in zip(panel["border_r"].values, panel["border_beta"].values, strict=True):
        lines += ax.plot(x, y, path_effects=rim, **BORDER)
    return lines[:1]

"""Axes of response curves: their ends, cut-off peaks, arrangement of panels."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from ..options import current
from ..panels import Handle
from ..second_axes import frequency_on_top
from ..sizes import points
from .families import Family
from .invariants import infinite_resonances

#: End of the axis where some amplitude is infinite, in units of P/k1; linear and logarithmic.
CUT, CUT_LOG = 5.0, 100.0

#: Peaks higher than this factor times that end are cut off too, because everything else would look flat.
_FLAT = 4.0

#: Height of the axis over the largest peak.
_ABOVE = 1.2

#: Powers of ten on a logarithmic axis.
_DECADES = 4

#: Panels side by side.
_COLUMNS = 3

#: Draws into axes and returns entries for the legend.
Panel = Callable[[Axes], list[Handle]]
Row = list[Panel | None]


class Picture(NamedTuple):
    """Panels in rows, and remarks for the caption."""

    rows: list[Row]
    height: float  # of a row [inch]
    remarks: list[str]


class Scale(NamedTuple):
    """A vertical axis of amplitudes, from 0 or logarithmic."""

    top: float
    logarithmic: bool

    def apply(self, ax: Axes, values: np.ndarray) -> None:
        """Set the limits; a logarithmic axis starts at the smallest value within `_DECADES` decades."""
        if not self.logarithmic:
            ax.set_ylim(0.0, self.top)
            return
        shown = values[(values > self.top * 10.0**-_DECADES) & (values < self.top)]
        ax.set_yscale("log")
        ax.set_ylim(float(shown.min(initial=0.5 * self.top)), self.top)


def scale_of(family: Family, values: Sequence[np.ndarray], cut: float, log: bool) -> Scale:
    """Axis up to the largest value with room above it, or up to `cut` where that is too high."""
    together = np.concatenate([np.ravel(part) for part in values])
    largest = float(together[np.isfinite(together)].max(initial=0.0))
    infinite = bool(np.isinf(together).any()) or bool(infinite_resonances(family))
    if infinite or (largest > _FLAT * cut and not log):
        return Scale(cut, log)
    return Scale(_ABOVE * largest or 1.0, log)


def about_cut(scale: Scale, values: Sequence[np.ndarray]) -> list[str]:
    """Remark on cut-off amplitudes."""
    return [f"cut off above {scale.top:g}"] if any((part > scale.top).any() for part in values) else []


def about_peaks(family: Family) -> list[str]:
    """Remarks on infinite peaks and the friction ratio at which they become finite."""
    return [
        f"infinite at r = {r:.4g}, "
        + (f"finite at or above β = {beta:.4g}" if np.isfinite(beta) else "for any friction")
        for r, beta in infinite_resonances(family)
    ]


def over_r(ax: Axes, family: Family, title: str, name: str) -> None:
    """Set labels and limits of a panel over frequency."""
    if family.r.logarithmic:
        ax.set_xscale("log")
    ax.set_xlim(*family.r.limits)
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(name)
    ax.set_title(title, fontsize=points(10.0, "axes.titlesize"))
    frequency_on_top(ax, family.cells)


def in_rows(panels: list[Panel], below: list[Panel]) -> list[Row]:
    """Arrange panels in rows of two or three, each with another below it; a single one has the other beside
    it.
    """
    room = current().columns(_COLUMNS)
    if len(panels) == len(below) == 1 < room:
        return [[panels[0], below[0]]]
    columns = min(room, 2 if len(panels) == 4 else len(panels))
    rows: list[Row] = []
    for first in range(0, len(panels), columns):
        for part in filter(None, (panels, below)):
            if row := part[first : first + columns]:
                rows.append([*row, *[None] * (columns - len(row))])
    return rows

"""Axes of response curves: where they end, what is cut off, how panels lie."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from .families import Family
from .invariants import infinite_resonances
from .panels import Handle
from .second_axes import frequency_on_top

#: Where some amplitude is infinite the axis ends here, in units of P/k1; a logarithmic one further up.
CUT, CUT_LOG = 5.0, 100.0

#: Peaks so many times higher than that would leave all else flat, and are cut off too.
_FLAT = 4.0

#: Room above the largest peak.
_ABOVE = 1.2

#: Powers of ten on a logarithmic axis.
_DECADES = 4

#: Panels side by side.
_COLUMNS = 3

#: Draws into axes; entries for a legend.
Panel = Callable[[Axes], list[Handle]]
Row = list[Panel | None]


class Picture(NamedTuple):
    """Panels in rows, and what the caption says of them."""

    rows: list[Row]
    height: float  # of a row [inch]
    remarks: list[str]


class Scale(NamedTuple):
    """A vertical axis of amplitudes, from 0 or logarithmic."""

    top: float
    logarithmic: bool

    def apply(self, ax: Axes, values: np.ndarray) -> None:
        """Set the limits; a logarithmic axis begins at the least of the values, if that is not too far."""
        if not self.logarithmic:
            ax.set_ylim(0.0, self.top)
            return
        shown = values[(values > self.top * 10.0**-_DECADES) & (values < self.top)]
        ax.set_yscale("log")
        ax.set_ylim(float(shown.min(initial=0.5 * self.top)), self.top)


def scale_of(family: Family, values: Sequence[np.ndarray], cut: float, log: bool) -> Scale:
    """An axis up to the largest value, with room above it; up to `cut` where that is too high."""
    together = np.concatenate([np.ravel(part) for part in values])
    largest = float(together[np.isfinite(together)].max(initial=0.0))
    infinite = bool(np.isinf(together).any()) or bool(infinite_resonances(family))
    if infinite or (largest > _FLAT * cut and not log):
        return Scale(cut, log)
    return Scale(_ABOVE * largest or 1.0, log)


def about_cut(scale: Scale, values: Sequence[np.ndarray]) -> list[str]:
    """Where amplitudes are cut off, in words."""
    return [f"cut off above {scale.top:g}"] if any((part > scale.top).any() for part in values) else []


def about_peaks(family: Family) -> list[str]:
    """Which peaks are infinite, and from which friction on they are not, in words."""
    return [
        f"infinite at r = {r:.4g}, "
        + (f"finite from β = {beta:.4g} on" if np.isfinite(beta) else "whatever the friction")
        for r, beta in infinite_resonances(family)
    ]


def over_r(ax: Axes, family: Family, title: str, name: str) -> None:
    """Names and limits of a panel over frequency."""
    if family.r.logarithmic:
        ax.set_xscale("log")
    ax.set_xlim(*family.r.limits)
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(name)
    ax.set_title(title, fontsize=10)
    frequency_on_top(ax, family.cells)


def in_rows(panels: list[Panel], below: list[Panel]) -> list[Row]:
    """Panels, each with another below it, in rows of two or three; one alone has the other beside it."""
    if len(panels) == len(below) == 1:
        return [[panels[0], below[0]]]
    columns = 2 if len(panels) == 4 else min(len(panels), _COLUMNS)
    rows: list[Row] = []
    for first in range(0, len(panels), columns):
        for part in filter(None, (panels, below)):
            row = part[first : first + columns]
            rows.append([*row, *[None] * (columns - len(row))])
    return rows

"""Work, distances and forces per cycle over frequency, one panel each."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from ...datasets.labels import MEASURE_OF
from ..panels import Handle
from ..second_axes import on_the_right
from ..words import name_of_contact
from .axes import Panel, Picture, Scale, about_cut, about_peaks, in_rows, over_r, scale_of
from .families import Family
from .lines import draw_curve

#: Variables and the labels of their axes.
SCALARS = {
    "energy": {
        "work_input": "work of the load / $(P^2/k_1)$",
        "work_friction": "work of friction / $(P^2/k_1)$",
        "work_wall": "work of the belt / $(P^2/k_1)$",
        "work_damping": "work of dampers / $(P^2/k_1)$",
        "sliding_distance": "sliding distance / $(P/k_1)$",
        "equivalent_damping": r"equivalent damping $c_\mathrm{eq}\omega/k_1$",
    },
    "transmitted_force": {
        "transmitted_force": "transmitted force / $P$",
        "transmitted_first_harmonic": "its first harmonic / $P$",
    },
}


#: With infinite peaks, the axis ends at `_ABOVE` times the value that all but the share `_BEYOND` stay below.
_ABOVE, _BEYOND = 1.5, 0.1


def _cut(values: np.ndarray) -> float:
    """Upper end of an axis of work whose peaks are cut off."""
    positive = values[np.isfinite(values) & (values > 0.0)]
    return _ABOVE * float(np.quantile(positive, 1.0 - _BEYOND)) if positive.size else 1.0


class Scalar(NamedTuple):
    """Content of a panel: a number of every cell, or of one contact."""

    name: str
    contact: str  # empty if there is only one
    values: np.ndarray  # (lines, r)
    regime: np.ndarray  # (lines, r)


def _scalars(family: Family, quantity: str) -> list[Scalar]:
    """Panels of a quantity; the work of dampers only if it is not zero."""
    found = [
        Scalar(name, name_of_contact(one.cells), one.rows(name), one.regime)
        for name in SCALARS[quantity]
        if name in family.cells
        for one in family.contacts(name)
    ]
    return [one for one in found if one.name != "work_damping" or np.nansum(one.values) > 0.0]


def scalar_picture(family: Family, quantity: str, log: bool) -> Picture:
    """Panels of a quantity, one for each contact if it has one value per contact."""
    scalars = _scalars(family, quantity)

    def panel(one: Scalar, scale: Scale) -> Panel:
        def draw(ax: Axes) -> list[Handle]:
            over_r(ax, family, one.contact, SCALARS[quantity][one.name])
            for row, regime, colour in zip(one.values, one.regime, family.colours, strict=True):
                draw_curve(ax, family.cells["r"].values, row, regime, colour, scale.top)
            scale.apply(ax, one.values)
            if one.name in MEASURE_OF:
                name = SCALARS[quantity][one.name].split(" / ")[0]
                on_the_right(ax, family.cells, MEASURE_OF[one.name], name)
            return []

        return draw

    scales = [scale_of(family, [one.values], _cut(one.values), log) for one in scalars]
    remarks = ["work and distances per cycle of the load"] if quantity == "energy" else []
    if any(about_cut(scale, [one.values]) for scale, one in zip(scales, scalars, strict=True)):
        remarks.append("peaks cut off")
    panels = [panel(one, scale) for scale, one in zip(scales, scalars, strict=True)]
    return Picture(in_rows(panels, []), 2.9, [*remarks, *about_peaks(family)])

"""Work, distances and forces per cycle over frequency, one panel each."""

import numpy as np
from matplotlib.axes import Axes

from ...datasets.labels import MEASURE_OF
from ..panels import Handle
from ..second_axes import on_the_right
from .axes import Panel, Picture, Scale, about_cut, about_peaks, in_rows, over_r, scale_of
from .families import Family
from .lines import draw_curve

#: Variables and the labels of their axes.
SCALARS = {
    "energy": {
        "work_input": "work of the load / $(P^2/k_1)$",
        "work_friction": "work of friction / $(P^2/k_1)$",
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


def scalar_picture(family: Family, quantity: str, log: bool) -> Picture:
    """Panels of a quantity; the work of dampers only if it is not zero."""
    rows = {name: family.rows(name) for name in SCALARS[quantity] if name in family.cells}
    if "work_damping" in rows and not np.nansum(rows["work_damping"]) > 0.0:
        del rows["work_damping"]

    def panel(name: str, values: np.ndarray, scale: Scale) -> Panel:
        def draw(ax: Axes) -> list[Handle]:
            over_r(ax, family, "", SCALARS[quantity][name])
            for row, regime, colour in zip(values, family.regime, family.colours, strict=True):
                draw_curve(ax, family.cells["r"].values, row, regime, colour, scale.top)
            scale.apply(ax, values)
            if name in MEASURE_OF:
                on_the_right(ax, family.cells, MEASURE_OF[name], SCALARS[quantity][name].split(" / ")[0])
            return []

        return draw

    scales = {name: scale_of(family, [values], _cut(values), log) for name, values in rows.items()}
    remarks = ["work and distances per cycle of the load"] if quantity == "energy" else []
    if any(about_cut(scales[name], [values]) for name, values in rows.items()):
        remarks.append("peaks cut off")
    panels = [panel(name, values, scales[name]) for name, values in rows.items()]
    return Picture(in_rows(panels, []), 2.9, [*remarks, *about_peaks(family)])

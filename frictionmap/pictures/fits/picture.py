"""What a picture of a fit consists of."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..curves.axes import Panel
from ..options import Options, current

if TYPE_CHECKING:
    from ..panels import AxesArray

#: A panel with its height [inch].
Tall = tuple[float, Panel]

#: Widths of the panels over one axis, and of those beside them [inch].
WIDTH, BESIDE = 7.2, 5.4


class FitPicture(NamedTuple):
    """Panels over one axis, from top to bottom, and others beside them."""

    panels: list[Tall]
    beside: list[Tall]
    remarks: list[str]

    @property
    def all(self) -> list[Panel]:
        """All panels, those beside last."""
        return [panel for _, panel in (*self.panels, *self.beside)]

    def chosen(self, options: Options) -> "FitPicture":
        """The picture with the panels that the options ask for; the first ones lie over one axis."""
        kept = options.chosen(range(len(self.all)))
        tall, first = (*self.panels, *self.beside), len(self.panels)
        main = [tall[k] for k in kept if k < first]
        others = [tall[k] for k in kept if k >= first]
        return self._replace(panels=main, beside=others) if main else self._replace(panels=others, beside=[])

    def size(self) -> tuple[float, float]:
        """Width and height [inch]."""
        if self.beside and current().columns(2) == 1:
            return WIDTH, sum(height for height, _ in (*self.panels, *self.beside))
        tallest = max(sum(height for height, _ in column) for column in (self.panels, self.beside))
        return WIDTH + BESIDE * bool(self.beside), tallest

    def lay_out(self, figure: Figure) -> "AxesArray":
        """Axes in a figure, as many as there are panels."""
        columns = [(WIDTH, self.panels), (BESIDE, self.beside)][: 1 + bool(self.beside)]
        if self.beside and current().columns(2) == 1:
            heights = [sum(height for height, _ in column) for _, column in columns]
            outer = figure.add_gridspec(2, 1, height_ratios=heights)
        else:
            outer = figure.add_gridspec(1, len(columns), width_ratios=[width for width, _ in columns])
        axes: list[Axes] = []
        for k, (_, column) in enumerate(columns):
            inner = outer[k].subgridspec(len(column), 1, height_ratios=[height for height, _ in column])
            axes += [figure.add_subplot(inner[row, 0]) for row in range(len(column))]
        main = axes[: len(self.panels)]
        for one in main[:-1]:
            one.sharex(main[-1])
            one.tick_params(labelbottom=False)
        return np.array(axes, dtype=object)

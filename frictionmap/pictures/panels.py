"""Figures, panels, axes and legends."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import AbstractPathEffect, withStroke

from ..errors import InputError
from .grids import Grid
from .options import current
from .sizes import figure_size, height_is_free, points, setting_of
from .words import balanced

if TYPE_CHECKING:
    import numpy.typing as npt

    AxesArray = npt.NDArray[np.object_]

Handle = Line2D | Patch

#: Largest number of panels of a figure; more would be unreadable and exceed the memory.
MOST_PANELS = 60

#: Size of the texts of legends [points]; width of a letter and height of a line per point [inch].
_LEGEND_SIZE = 8.0
_LETTER, _LINE = 0.0078, 0.021

#: Width of the mark of an entry with the gap between two columns of a legend [inch].
_MARK = 0.55

#: Settings of matplotlib that make up the width of a legend besides its texts, in sizes of a letter.
_SPACES = ("handlelength", "handletextpad", "columnspacing", "borderpad")

#: Height of the labels below axes [inch], and largest share of a figure that a legend below axes may take.
_LABELS, _MOST_LEGEND = 0.45, 0.5


def halo(width: float = 2.6) -> list[AbstractPathEffect]:
    """A white outline, which makes lines and letters visible on any colour."""
    return [withStroke(linewidth=width, foreground="white")]


def _shown_by_itself() -> bool:
    """Whether figures made through pyplot are displayed: pyplot is in use, or a notebook runs."""
    if "matplotlib.pyplot" in sys.modules:
        return True
    shell = getattr(sys.modules.get("IPython"), "get_ipython", None)
    return shell is not None and shell() is not None


def new_figure(width: float, height: float) -> Figure:
    """Create an empty figure; where pyplot is in use, one that it displays.

    width, height : size by default [inch]; see `figure_size`
    """
    width, height = figure_size(width, height)
    if _shown_by_itself():
        import matplotlib.pyplot as plt

        return plt.figure(figsize=(width, height), layout="constrained")
    return Figure(figsize=(width, height), layout="constrained")


def title_figure(figure: Figure, title: str) -> None:
    """Set the title of a figure, wrapped into balanced lines."""
    given = current().title
    title, size = title if given is None else given, points(11.0, "figure.titlesize")
    wrapped = balanced(title, int(121.0 / size * figure.get_figwidth()))
    figure.suptitle(wrapped, fontsize=size, parse_math=False)  # dollar signs are literal


def panel_grid(panels: int, title: str) -> "AxesArray":
    """Create panels of a new figure, one for each mu."""
    if panels > MOST_PANELS:
        raise InputError(
            f"a file must hold at most {MOST_PANELS} mu to be drawn; got {panels}: "
            "draw some of them with frictionmap.plot_regimes(ds.sel(mu=...))"
        )
    columns = current().columns(2 if panels in (2, 4) else min(panels, 3))
    return grid_of_panels(panels, columns, 3.9, title)


def grid_of_panels(panels: int, columns: int, height: float, title: str) -> "AxesArray":
    """Create panels of a new figure, row by row, each `height` inches tall; shape (panels,)."""
    grid = table_of_panels(-(-panels // columns), columns, height, title).ravel()
    for spare in grid[panels:]:
        spare.remove()
    return grid[:panels]


def table_of_panels(rows: int, columns: int, height: float, title: str) -> "AxesArray":
    """Create panels of a new figure in rows and columns, each `height` inches tall; shape (rows, columns)."""
    width = {1: 6.2, 2: 5.2}.get(columns, 4.4)
    figure = new_figure(width * columns + 0.4, height * rows + 0.4)  # a legend adds its own height
    title_figure(figure, title)
    return figure.subplots(rows, columns, squeeze=False)


def given_axes(ax: "Axes | Sequence[Axes] | AxesArray", panels: int, what: str) -> "AxesArray":
    """Check axes given by the caller: one for each panel."""
    items = list(ax.ravel() if isinstance(ax, np.ndarray) else ax if isinstance(ax, Sequence) else [ax])
    for item in items:
        if not isinstance(item, Axes):
            raise InputError(f"ax must be matplotlib axes, or an array of them; got {type(item).__name__}")
    if len(items) != panels:
        raise InputError(f"ax must be {panels} axes, {what}; got {len(items)}")
    return np.array(items, dtype=object)


def size_of(ax: Axes) -> tuple[float, float]:
    """Approximate width and height of axes [inch]."""
    box = ax.get_window_extent()
    return box.width / ax.figure.dpi, box.height / ax.figure.dpi


def name_axes(ax: Axes, r: Grid, mu: float) -> None:
    """Set limits, scale and labels common to both kinds of maps."""
    if r.logarithmic:
        ax.set_xscale("log")
    ax.set_xlim(*r.limits)
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(r"friction ratio $\beta$")
    ax.set_title(rf"$\mu$ = {mu:g}", fontsize=points(10.0, "axes.titlesize"))


def patch(label: str, colour: str, hatch: str | None = None) -> Patch:
    """Legend entry for an area."""
    return Patch(facecolor=colour, edgecolor="black", linewidth=0.6, label=label, hatch=hatch)


def distinct(handles: Sequence[Handle]) -> list[Handle]:
    """The first entry for each label."""
    found: dict[str, Handle] = {}
    for handle in handles:
        found.setdefault(str(handle.get_label()), handle)
    return list(found.values())


def _columns(handles: Sequence[Handle], width: float) -> int:
    """Number of columns of equal width that a legend has room for."""
    letter = _LETTER * points(_LEGEND_SIZE, "legend.fontsize")
    longest = max((len(str(handle.get_label()).replace("\\mathrm", "")) for handle in handles), default=1)
    return max(1, min(len(handles), int(width / (longest * letter + _MARK))))


def _narrow_columns(figure: Figure, handles: Sequence[Handle], width: float) -> int:
    """Number of columns that a legend has room for, each as wide as its widest entry, as measured."""
    size = points(_LEGEND_SIZE, "legend.fontsize")
    length, pad, gap, border = (float(setting_of(f"legend.{name}")) * size / 72.0 for name in _SPACES)
    texts = [figure.text(0.0, 0.0, str(handle.get_label()), fontsize=size) for handle in handles]
    widths = [text.get_window_extent().width / figure.dpi + length + pad for text in texts]
    for text in texts:
        text.remove()
    for columns in range(len(handles), 1, -1):
        parts = np.array_split(widths, columns)  # as matplotlib fills the columns
        if sum(float(part.max()) for part in parts) + (columns - 1) * gap + 2.0 * border <= width:
            return columns
    return 1


def legend_below(figure: Figure, handles: Sequence[Handle], caption: str) -> None:
    """Add a legend under the panels with a caption above it; the figure grows by its height.

    The options of the picture may leave out both, or keep the height of the figure.
    """
    options, size = current(), points(_LEGEND_SIZE, "legend.fontsize")
    handles, caption = handles if options.legend else [], caption if options.has_caption else ""
    if not handles and not caption:
        return
    width = figure.get_figwidth() - (0.4 if options.size is None else 0.1)
    wide = options.size is None
    columns = _columns(handles, width) if wide else _narrow_columns(figure, handles, width)
    heading = balanced(caption, int(width / (_LETTER * size)))
    if height_is_free():
        lines = heading.count("\n") + 1 + -(-len(handles) // columns)
        figure.set_figheight(figure.get_figheight() + _LINE * size * lines + 0.2)
    legend = figure.legend(
        handles=list(handles),
        fontsize=size,
        loc="outside lower center",
        ncols=columns,
        title=heading,
        title_fontsize=size,
    )
    legend.get_title().set_parse_math(False)
    legend.get_title().set_horizontalalignment("center")


def legend_under(ax: Axes, handles: Sequence[Handle]) -> None:
    """Add a legend under axes given by the caller; inside them it would cover results.

    Where a layout of the caller's figure would have to squeeze the axes for it, it is left out.
    """
    if not current().legend or not handles:
        return
    width, height = size_of(ax)
    legend = ax.legend(
        handles=list(handles), fontsize=points(_LEGEND_SIZE, "legend.fontsize"), loc="upper center",
        bbox_to_anchor=(0.5, -max(0.16, _LABELS / height)), ncols=_columns(handles, width),
    )  # fmt: skip
    box, room = legend.get_window_extent(), ax.figure.bbox
    if ax.figure.get_layout_engine() and (box.width > room.width or box.height > _MOST_LEGEND * room.height):
        legend.remove()

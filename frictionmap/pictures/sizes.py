"""Sizes of figures, texts and lines; settings of matplotlib, of the user and of small figures."""

import contextlib
from collections.abc import Iterator, Mapping
from typing import Any, cast

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text

from ..errors import InputError
from .options import Options, current

#: Size of letters that all texts are relative to, and its least value in small figures [points].
_BASE, _LEAST_BASE = 10.0, 8.0

#: Least size of a text where a size is given [points].
LEAST_TEXT = 7.0

#: Width [inch] below which letters become smaller.
_WIDE = 6.2

#: Heights change less than widths, because texts become less small than figures: by this power.
_POWER = 0.7

#: Settings of small figures, where the user has not changed them; lengths in points.
_SMALL = {
    "axes.titlesize": "medium", "axes.labelsize": "medium",
    "xtick.labelsize": LEAST_TEXT, "ytick.labelsize": LEAST_TEXT,
    "axes.linewidth": 0.6, "axes.labelpad": 2.0, "axes.titlepad": 4.5,
    "xtick.major.size": 2.5, "ytick.major.size": 2.5, "xtick.minor.size": 1.5, "ytick.minor.size": 1.5,
    "xtick.major.pad": 2.0, "ytick.major.pad": 2.0, "xtick.major.width": 0.6, "ytick.major.width": 0.6,
    "legend.handlelength": 1.6, "legend.columnspacing": 1.2, "legend.labelspacing": 0.3,
}  # fmt: skip


_SETTINGS = cast(Mapping[str, Any], mpl.rcParams)
_DEFAULTS = cast(Mapping[str, Any], mpl.rcParamsDefault)


def setting_of(key: str) -> Any:
    """A setting of matplotlib as it is now."""
    return _SETTINGS[key]


def _is_default(key: str) -> bool:
    return bool(_SETTINGS[key] == _DEFAULTS[key])


def _base(options: Options) -> float:
    """Size of letters that a figure of this size has [points]."""
    assert options.size is not None
    return float(np.clip(_BASE * np.sqrt(options.size[0] / _WIDE), _LEAST_BASE, _BASE))


#: Numbers below 10^-3 have the power of ten beside the axis: 0.00015 takes the room of the data.
_NUMBERS = {"axes.formatter.limits": [-3, 6], "axes.formatter.use_mathtext": True}


@contextlib.contextmanager
def sizes(options: Options) -> Iterator[None]:
    """Set letters, ticks, margins and numbers of a figure; settings that the user has changed stay."""
    wanted = _NUMBERS if options.size is None else {"font.size": _base(options), **_SMALL, **_NUMBERS}
    changed: Any = {key: value for key, value in wanted.items() if _is_default(key)}
    with mpl.rc_context(changed):
        yield


def points(size: float, key: str = "font.size") -> float:
    """Size of a text [points] that is `size` by default.

    It follows the setting `key` of matplotlib if the user has changed it, else font.size.
    """
    if key != "font.size" and not _is_default(key):
        return float(FontProperties(size=_SETTINGS[key]).get_size_in_points())
    scaled = size * float(_SETTINGS["font.size"]) / _BASE
    return scaled if current().size is None else max(scaled, LEAST_TEXT)


def figure_size(width: float, height: float) -> tuple[float, float]:
    """Size of a figure that is `width` by `height` by default [inch]."""
    options = current()
    if options.size is None:
        if _is_default("figure.figsize"):
            return width, height
        first, second = _SETTINGS["figure.figsize"]
        return float(first), float(second)
    wanted, tall = options.size
    return wanted, tall or height * (wanted / width) ** _POWER


def height_is_free() -> bool:
    """Whether a figure may grow by the height of its legend."""
    size = current().size
    return _is_default("figure.figsize") if size is None else size[1] is None


def finish(axes: object, options: Options) -> None:
    """Apply limits, resolution and size to the panels that a function has drawn."""
    panels: list[Axes] = [axes] if isinstance(axes, Axes) else list(cast(np.ndarray, axes).ravel())
    figure = panels[0].figure
    assert isinstance(figure, Figure)
    for ax in panels:  # left of the numbers of an axis on top
        ax.yaxis.get_offset_text().set_horizontalalignment("right")
    for name in ("xlim", "ylim"):
        limits = getattr(options, name)
        if limits is not None:
            _limit(panels, name[0], limits)
    if options.dpi is not None:
        figure.set_dpi(options.dpi)
    if options.size is not None:
        _shrink(figure, _base(options) / _BASE)


def _limit(panels: list[Axes], axis: str, limits: tuple[float, float]) -> None:
    """Limit an axis of the first panel, and of the panels with the same one."""
    label = getattr(panels[0], f"get_{axis}label")()
    for ax in panels:
        if getattr(ax, f"get_{axis}label")() != label:
            continue
        if limits[0] <= 0.0 and getattr(ax, f"get_{axis}scale")() == "log":
            raise InputError(f"{axis}lim must be > 0 on a logarithmic axis; got {limits[0]:g}")
        getattr(ax, f"set_{axis}lim")(limits)
        for line in ax.lines:
            line.set_clip_on(True)


def _shrink(figure: Figure, share: float) -> None:
    """Make lines and marks smaller; labels of ticks keep their size when they are drawn later."""
    every = [*figure.axes, *(second for ax in figure.axes for second in ax.child_axes)]
    lines = [line for ax in every for line in ax.lines]
    for line in (*lines, *(line for legend in figure.legends for line in legend.get_lines())):
        line.set_linewidth(share * line.get_linewidth())
        line.set_markersize(share * line.get_markersize())
    for ax in every:
        for axis, one in (("x", ax.xaxis), ("y", ax.yaxis)):
            size = points(LEAST_TEXT, f"{axis}tick.labelsize")
            one.set_tick_params(which="both", labelsize=size)
            one.get_offset_text().set_fontsize(size)
    for text in figure.findobj(Text):
        text.set_fontsize(max(text.get_fontsize(), min(LEAST_TEXT, float(_SETTINGS["font.size"]))))

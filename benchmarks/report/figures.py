"""Figures of benchmarks, drawn without a display and written beside the results."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from .quoting import duration

#: Colours of a picture: lines and text need few, and the file is a third as large.
_COLOURS = 256


def new_figure(width: float, height: float) -> Figure:
    """Create an empty figure, size in inches."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def mark_limit(axes: Axes, place: float, limit: float) -> None:
    """Mark on a horizontal bar what its value should be at most."""
    axes.plot([limit] * 2, [place - 0.4, place + 0.4], color="#d98032", linewidth=2.0)


def name_time(axes: Axes, place: float, seconds: float) -> None:
    """Write the time of a horizontal bar to the right of the axes, away from spreads and limits."""
    axes.text(1.01, place, duration(seconds), va="center", fontsize=9, transform=axes.get_yaxis_transform())


def save_bars(figure: Figure, axes: Axes, words: tuple[str, str], path: Path) -> Path:
    """Write a figure of horizontal bars, the first on top; words: what they show, and the title."""
    axes.invert_yaxis()
    axes.set_xlabel(words[0])
    axes.set_title(words[1])
    axes.grid(alpha=0.25, axis="x")
    return save_figure(figure, path)


def save_figure(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG and print its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    with Image.open(path) as drawn:
        few = drawn.convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
    print(f"drawn: {path}")
    return path

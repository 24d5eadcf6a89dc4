"""Picture of the measurements: time per cell and per frequency, over contacts, and against error."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from ...report.figures import new_figure, save_figure
from ...report.quoting import two_digits
from .scenes import E1, E2, SQUARE, TWO

#: Scenes whose time against error is drawn.
_DRAWN = (TWO, SQUARE, E1, E2)

_COLOURS = {"solve_ivp DOP853": "#b2552f", "heyoka": "#6f9e3c", "Moreau-Jean": "#8a8a8a"}
_OURS = "#2c5aa0"

#: Error of the exact cells in the picture: below it nothing is compared.
_ROUNDING = 1e-15


def _bars(axes: Axes, values: list[float], names: list[str], colour: str) -> None:
    """Bars with their values."""
    places = np.arange(len(values))
    axes.barh(places, values, color=colour)
    for place, value in zip(places, values, strict=True):
        axes.text(value, place, f" {two_digits(value)}", va="center", fontsize=8)
    axes.set_yticks(places, names, fontsize=8)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlim(0.5 * min(values), 4.0 * max(values))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _costs(axes: Axes, costs: dict) -> None:
    _bars(axes, [1e6 * entry["seconds a cell"]["median"] for entry in costs.values()], list(costs), _OURS)
    axes.set_xlabel("time per cell [µs]")
    axes.set_title("Stick-slip cells in rows of a map", fontsize=10)


def _boundaries(axes: Axes, found: dict) -> None:
    values = [1e3 * entry["seconds a frequency"]["median"] for entry in found.values()]
    _bars(axes, values, [""] * len(values), "#8aa6c8")
    axes.set_xlabel("time per frequency [ms]")
    axes.set_title("Boundaries of the same systems", fontsize=10)


def _over_contacts(axes: Axes, found: dict) -> None:
    counts = [int(count) for count in found]
    medians = [1e6 * entry["seconds a cell"]["median"] for entry in found.values()]
    axes.plot(counts, medians, marker="o", color=_OURS)
    axes.set_xticks(counts)
    axes.set_yscale("log")
    axes.set_xlabel("contacts")
    axes.set_ylabel("time per cell [µs]")
    axes.set_title("Stick-slip cells of eight masses", fontsize=10)
    axes.grid(alpha=0.25)


def _against(axes: Axes, name: str, entry: dict) -> None:
    """Time over error of every solver, cell by cell in the median."""
    for method, found in entry["methods"].items():
        points = [
            (
                max(float(np.median(point["relative errors of ranges"])), _ROUNDING),
                point["seconds a cell"]["median"],
            )
            for point in found.get("points", ())
            if point["relative errors of ranges"]
        ]
        if points:
            axes.loglog(*zip(*points, strict=True), marker="o", color=_COLOURS[method], label=method)
    axes.axhline(entry["our seconds a cell"]["median"], color=_OURS, label="frictionmap, exact")
    axes.set_title(name, fontsize=10)
    _time_over_error(axes)


def _balance(axes: Axes, found: dict) -> None:
    points = found["points"]
    errors = [point["median relative error of Z"] for point in points]
    seconds = [point["seconds a cell"]["median"] for point in points]
    axes.loglog(errors, seconds, marker="o", color="#9a4f96", label="harmonic balance")
    for error, taken, point in zip(errors, seconds, points, strict=True):
        axes.annotate(
            str(point["highest harmonic"]), (error, taken), (3, 3), textcoords="offset points", fontsize=8
        )
    axes.axhline(found["our seconds a cell"]["median"], color=_OURS, label="frictionmap, exact")
    axes.set_title("Elastic contact, highest harmonic", fontsize=10)
    _time_over_error(axes)


def _time_over_error(axes: Axes) -> None:
    axes.set_xlabel("relative error, median")
    axes.set_ylabel("time per cell [s]")
    axes.grid(alpha=0.25)
    axes.legend(fontsize=7)


def draw(content: dict, path: Path) -> None:
    """Draw the costs, the other solvers and harmonic balance."""
    figure = new_figure(15.0, 7.6)
    axes = figure.subplots(2, 4)
    _costs(axes[0, 0], content["cells"])
    _boundaries(axes[0, 1], content["boundaries"])
    _over_contacts(axes[0, 2], content["contacts"])
    _balance(axes[0, 3], content["harmonic balance"])
    for one, name in zip(axes[1], _DRAWN, strict=True):
        _against(one, name, content["other solvers"][name])
    save_figure(figure, path)

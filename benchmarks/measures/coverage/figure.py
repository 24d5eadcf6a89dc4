"""Figure of coverage: one line per case, one dot per parameter."""

from itertools import pairwise
from pathlib import Path

from ...report.figures import new_figure, save_figure
from .counting import STATED, band

#: Heights of a line and of the rest of the figure [inches].
_LINE, _REST = 0.27, 1.6

_WITHIN, _BELOW, _SHORT = "#2c5aa0", "#e07b00", "#c0232c"


def draw(kinds: dict[str, dict[str, dict]], path: Path) -> None:
    """Draw the coverage of every parameter by case, the range that chance explains, and the refusals."""
    rows = [(kind, name, row) for kind, cases in kinds.items() for name, row in cases.items()]
    figure = new_figure(9.0, _REST + _LINE * len(rows))
    ax, beside = figure.subplots(1, 2, sharey=True, width_ratios=(5, 1))
    least = 100.0 * min(
        [one["coverage"] for _, _, row in rows for one in row["parameters"].values()], default=STATED
    )
    for place, (_, _, row) in enumerate(rows):
        low, high = (100.0 * end for end in band(max(row["seeds"] - row["refused"], 1)))
        ax.barh(place, high - low, 0.8, low, color="0.85")
        for name, one in row["parameters"].items():
            colour = _SHORT if one["short"] else _BELOW if one["below the band"] else _WITHIN
            ax.plot(100.0 * one["coverage"], place, "o", color=colour, markersize=4, alpha=0.8)
            if one["short"]:
                ax.annotate(
                    name, (100.0 * one["coverage"], place), (0, 3), textcoords="offset points", fontsize=6,
                    ha="center",
                )  # fmt: skip
        for share, colour in ((row["warned"], "0.75"), (row["refused"], "k")):
            beside.barh(place, 100.0 * share / row["seeds"], 0.6, color=colour)
    _label(ax, rows, least)
    beside.set_xlabel("% of fits\ngrey: warned\nblack: refused", fontsize=8)
    beside.set_xlim(0.0, 100.0)
    save_figure(figure, path)


def _label(ax: object, rows: list[tuple[str, str, dict]], least: float) -> None:
    """Label axes, cases and colours."""
    ax.axvline(100.0 * STATED, color="k", linewidth=0.8)
    ax.set_yticks(
        range(len(rows)), [f"{kind}: {name} ({row['seeds']})" for kind, name, row in rows], fontsize=8
    )
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_xlim(max(min(least - 3.0, 88.0), -2.0), 100.8)
    for k, (one, other) in enumerate(pairwise(rows)):
        if one[0] != other[0]:
            ax.axhline(k + 0.5, color="0.5", linewidth=0.6)
    ax.set_xlabel(
        "95 % intervals that hold the truth [%], one dot per parameter (number of fits in brackets)",
        fontsize=8,
    )
    ax.set_title(
        "Coverage of the intervals of identify\n"
        "grey: 95 % of all counts by chance; blue: within or above, orange: below, red: far below",
        fontsize=9,
    )
    ax.grid(axis="x", alpha=0.25)

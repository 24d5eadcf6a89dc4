"""Picture of the torture test: digits lost by group and distance from the singular point."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap

from ...report.figures import new_figure, save_figure
from .group import ALLOWED, Group

#: Columns of the picture: exponents k, the singular point itself, and cells without a distance from one.
_AT_POINT = 16
_OTHER = 17


def _worst_by_distance(group: Group) -> dict[int, float]:
    """Column of the picture: most digits lost beyond the condition number by any number in it."""
    worst: dict[int, float] = {}
    for row in group.answers:
        column = _OTHER if row["k"] is None else row["k"]
        worst[column] = max(worst.get(column, 0.0), row["lost"] - row["explained"], 0.0)
    return worst


def _verdict(group: Group) -> str:
    """Short summary of regimes and stops."""
    if not group.statuses:
        return ""
    cells = f"{len(group.wrong)} of {group.cells}"
    return cells + (f"; {len(group.miscounted)} of {group.counted}" if group.counted else "")


def draw(groups: Sequence[Group], path: Path) -> None:
    """Draw the digits lost beyond the condition number, by group and distance from the singular point."""
    figure = new_figure(11.0, 0.33 * len(groups) + 1.7)
    axes = figure.subplots()
    lost = np.full((len(groups), _OTHER), np.nan)
    for i, group in enumerate(groups):
        for column, digits in _worst_by_distance(group).items():
            lost[i, column - 1] = digits
            axes.text(
                column, i, f"{digits:.0f}", ha="center", va="center", fontsize=8,
                color="white" if digits > 8.0 else "black",
                fontweight="bold" if digits > ALLOWED else "normal",
            )  # fmt: skip
        axes.text(_OTHER + 0.8, i, _verdict(group), va="center", fontsize=8)
    colours = ListedColormap(("#d9ead3", "#f9cb9c", "#e06666", "#990000"))
    axes.imshow(
        lost, cmap=colours, norm=BoundaryNorm((0.0, ALLOWED, 5.0, 8.0, 16.1), 4), aspect="auto",
        extent=(0.5, _OTHER + 0.5, len(groups) - 0.5, -0.5),
    )  # fmt: skip
    axes.set_yticks(range(len(groups)), [group.name for group in groups], fontsize=9)
    axes.set_xticks(range(1, _OTHER + 1), [*(str(k) for k in range(1, _AT_POINT)), "at", "other"], fontsize=8)
    axes.set_xticks(np.arange(1.5, _OTHER), minor=True)
    axes.set_yticks(np.arange(0.5, len(groups)), minor=True)
    axes.grid(which="minor", color="white", linewidth=1.2)
    axes.tick_params(which="both", length=0)
    axes.set_xlabel(
        "relative distance 10$^{-k}$ from the singular point: k;  at: the point itself", fontsize=9
    )
    axes.text(_OTHER + 0.8, -0.9, "wrong regimes; wrong stop counts", fontsize=8)
    beyond = sum(len(group.beyond) for group in groups)
    total = sum(len(group.answers) for group in groups)
    axes.set_title(
        f"Digits lost beyond what the condition number explains, worst of each group (of 16)\n"
        f"green: at most {ALLOWED:.0f}; more in {beyond} of {total} numbers",
        fontsize=10, loc="left", pad=18,
    )  # fmt: skip
    axes.set_xlim(0.5, _OTHER + 5.0)
    for side in ("top", "right", "left", "bottom"):
        axes.spines[side].set_visible(False)
    save_figure(figure, path)

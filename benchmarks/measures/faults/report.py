"""Trials and failures: table, JSON, and a figure of before and after."""

import json
from pathlib import Path

from ...report.figures import new_figure, save_figure
from ...report.record import save, table
from .verdict import Family

NAME, BEFORE = "faults", "faults-before"

_COLOURS = {BEFORE: "#d98032", NAME: "#2c5aa0"}


def _kinds(entry: dict) -> str:
    counts = entry["wrong by kind"] | entry["beyond reach"]
    return ", ".join(f"{count} {kind}" for kind, count in counts.items()) or "-"


def show(families: dict[str, dict]) -> None:
    """Print the table."""
    rows = [(name, entry["tried"], entry["wrong"], _kinds(entry)) for name, entry in families.items()]
    total = [sum(entry[key] for entry in families.values()) for key in ("tried", "wrong")]
    table(("what was tried", "trials", "wrong", "by kind"), [*rows, ("all", *total, "")])


def _share(entries: dict[str, dict], family: str) -> float:
    """Percentage of failed trials of a family; 0 without trials."""
    return 100.0 * entries[family]["wrong"] / entries[family]["tried"] if family in entries else 0.0


def draw(results: Path, path: Path) -> None:
    """Draw the percentage of failed trials, of this version and of an earlier one if it was tried."""
    found = {
        name: json.loads((results / f"{name}.json").read_text())["families"]
        for name in (BEFORE, NAME)
        if (results / f"{name}.json").is_file()
    }
    families = list(found[NAME])
    figure = new_figure(8.0, 0.33 * len(families) + 1.0)
    axes = figure.subplots()
    height = 0.8 / len(found)
    for k, (name, entries) in enumerate(found.items()):
        label = "before" if name == BEFORE else "now"
        shares = [_share(entries, family) for family in families]
        places = [place + (k - 0.5 * (len(found) - 1)) * height for place in range(len(families))]
        axes.barh(places, shares, height=0.9 * height, color=_COLOURS[name], label=label)
        for place, share, family in zip(places, shares, families, strict=True):
            if family in entries:
                text = f"{entries[family]['wrong']} of {entries[family]['tried']}"
                axes.text(share + 1.0, place, text, va="center", fontsize=7)
    axes.set_yticks(range(len(families)), families, fontsize=8)
    axes.invert_yaxis()
    axes.margins(y=0.01)
    axes.set_xlim(0.0, 119.0)
    axes.set_xlabel("trials that went wrong [%]")
    axes.legend(fontsize=8, loc="lower right")
    axes.grid(alpha=0.25, axis="x")
    save_figure(figure, path)


def write(families: list[Family], seconds: dict[str, float], results: Path, *, another: bool) -> dict:
    """Print, save and draw; `another`: for another checkout than this one."""
    content = {
        "seconds": seconds,
        "families": {family.name: family.content() for family in families},
    }
    show(content["families"])
    save(BEFORE if another else NAME, content, results)
    if not another:
        draw(results, results / f"{NAME}.png")
    return content

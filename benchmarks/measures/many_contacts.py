"""Time of a cell over the number of contacts, 1 to 64: frames with rigid or elastic dampers, and loops.

A frame has as many storeys as dampers, of random friction; a loop is a ring of as many unequal blades, whose
rigid dampers between neighbours do not determine their forces.  Damping is 0.05, and friction is a part of
that from which no contact slips.  Numbers of contacts on both sides of 8, 32 and 63 show whether the time
jumps where tables or words of bits are full.
"""

import math
import time
from pathlib import Path

import numpy as np

import frictionmap as fm
from frictionmap.general.dataset import cell_arrays
from frictionmap.model.settings import Solver

from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table

#: Numbers of contacts; by quick.
COUNTS = {False: (1, 2, 4, 8, 9, 16, 31, 32, 33, 48, 63, 64), True: (1, 4, 9)}

#: Friction over that from which no contact slips: the first and the last one of a row; r differs by so much.
_FRICTION, _FREQUENCIES = (0.3, 0.312), 1.01

#: Cells measured, over N: each from rest, and each from its neighbour in a row; at least so many.
_FROM_REST, _NEIGHBOURS = 32, 128
_LEAST = (1, 3)
_ROUNDS = {False: 3, True: 1}

#: Seconds of a processor after which one system is not measured again.
_ENOUGH = 1.0

#: What is measured.
_NAMES = {
    "rest": "seconds from rest",
    "neighbour": "seconds from neighbour",
    "boundaries": "seconds of boundaries",
}
_TITLES = {
    "rest": "A cell from rest",
    "neighbour": "A cell from its neighbour",
    "boundaries": "Boundaries at one frequency",
}
_OUTPUTS = ("status", "cycles")

#: Fewest sectors of a ring.
_RING = 3


def frame(count: int, stiffness: float | None) -> fm.System:
    """A frame with a damper in each storey, under a load at its top."""
    friction = np.random.default_rng(count).uniform(0.3, 1.0, count)
    contacts = [
        fm.Contact(
            "between-masses" if j else "fixed-wall", (j, j + 1) if j else 1, ratio=float(friction[j]),
            stiffness=stiffness,
        )
        for j in range(count)
    ]  # fmt: skip
    ones = [1.0] * count
    return fm.System(
        contacts=contacts, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=0.05, load_mass=count
    )


def ring(count: int) -> fm.System:
    """A ring of blades that differ by 3 %, with rigid dampers between neighbours."""
    sectors = {
        "count": count, "mass": [[1.0]], "stiffness": [[0.6]], "engine_order": 2,
        "coupling": [{"masses": [1, 1], "stiffness": 0.5}],
        "spread": {"standard_deviation": 0.03, "seed": count},
    }  # fmt: skip
    contacts = [{"kind": "between-masses", "masses": [1, "next.1"]}]
    return fm.ring(sectors=sectors, contacts=contacts, load_mass=1, damping_ratios=0.05)


#: Systems by the number of contacts, with r over the first natural frequency.
KINDS = {
    "frame, rigid dampers": (lambda count: frame(count, None), 5.0),
    "frame, elastic dampers": (lambda count: frame(count, 1.0), 5.0),
    "ring of blades, rigid dampers": (ring, 1.4),
}


def _timed(system: fm.System, r: np.ndarray, beta: np.ndarray) -> tuple[float, dict[str, np.ndarray]]:
    """Seconds of a processor of the cells of a map, and their status and periods, without beta_lim."""
    axes = {"mu": np.ones(1), "r": r, "beta": beta}
    solver = Solver(outputs=_OUTPUTS)
    began = time.process_time()
    found, _ = cell_arrays(system, axes, _OUTPUTS, solver, 1, None, None, searched=False)
    return time.process_time() - began, found


def _boundary(system: fm.System, r: np.ndarray) -> tuple[float, float, bool]:
    """Seconds of a processor of the boundaries at one r; that from which no contact slips; whether the others
    are searched for.
    """
    began = time.process_time()
    ends = fm.boundaries(system, r)
    taken = time.process_time() - began
    stick = ends["beta_noslip" if "beta_noslip" in ends else "beta_stick"].item()
    return taken, stick, "beta_lim" in ends


def _measure(system: fm.System, count: int, r: float, quick: bool) -> dict:
    """Seconds of a processor for a cell from rest, and for one from its neighbour; for the boundaries at one
    frequency, where they are searched for.
    """
    few, near = (
        max(many // count, least) for many, least in zip((_FROM_REST, _NEIGHBOURS), _LEAST, strict=True)
    )
    first = r * float(system.modes.w[0])
    frequencies = first * np.linspace(1.0, _FREQUENCIES, few)
    _, stick, searched = _boundary(system, frequencies[:1])
    beta = stick * np.linspace(*_FRICTION, 1 + near)
    _timed(system, frequencies[:1], beta[:2])  # loads the kernels
    taken: dict[str, list[float]] = {"rest": [], "neighbour": [], "boundaries": []}
    if searched:
        taken["boundaries"].append(_boundary(system, frequencies[:1])[0])
    while len(taken["rest"]) < _ROUNDS[quick] and sum(taken["rest"]) < _ENOUGH:
        column, there = _timed(system, frequencies, beta[:1])
        row, row_found = _timed(system, frequencies[:1], beta)
        taken["rest"].append(column / few)
        taken["neighbour"].append((row - column / few) / near)
    status = np.concatenate((there["status"].ravel(), row_found["status"].ravel()))
    return {
        "cells": int(status.size),
        "unresolved": int((status != fm.regimes.RESOLVED).sum()),
        "periods": [float(there["cycles"].mean()), float(row_found["cycles"][..., 1:].mean())],
        **{_NAMES[what]: spread(seconds) for what, seconds in taken.items() if seconds},
    }


def slopes(content: dict) -> dict:
    """Powers of N with which the times grow, by least squares of logarithms from 8 contacts on; the largest
    factor between numbers of contacts that differ by one, from 8 on.
    """
    found: dict = {}
    for kind, rows in content.items():
        found[kind] = {}
        for name in _NAMES.values():
            times = {int(n): row[name]["median"] for n, row in rows.items() if name in row}
            if not times:
                continue
            many = [n for n in times if n >= min(8, max(times) // 2)]
            power = np.polyfit(np.log(many), np.log([times[n] for n in many]), 1)[0]
            steps = [times[n + 1] / times[n] for n in times if n + 1 in times and n >= 8]
            found[kind][name] = {"power": float(power), "largest step": max(steps, default=math.nan)}
    return found


def draw(content: dict, path: Path) -> None:
    """Draw the time of a cell over the number of contacts."""
    figure = new_figure(10.8, 3.7)
    panels = figure.subplots(1, 3, sharey=True)
    for ax, (what, name) in zip(panels, _NAMES.items(), strict=True):
        for (kind, rows), marker in zip(content["cells"].items(), "osD", strict=True):
            n = [int(one) for one, row in rows.items() if name in row]
            if not n:
                continue
            times = [1e3 * rows[str(one)][name]["median"] for one in n]
            power = content["slopes"][kind][name]["power"]
            ax.loglog(n, times, marker=marker, markersize=4, label=f"{kind}: N^{power:.1f}")
        ticks = [1, 2, 4, 8, 16, 32, 64]
        ax.set_xticks(ticks, [str(one) for one in ticks])
        ax.minorticks_off()
        ax.set_xlabel("number of contacts N")
        ax.set_title(_TITLES[what], fontsize=10)
        ax.legend(fontsize=7)
    panels[0].set_ylabel("time [ms]")
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    cells: dict = {}
    lines = []
    with pinned():
        for kind, (build, r) in KINDS.items():
            cells[kind] = {}
            for count in COUNTS[quick]:
                if build is ring and count < _RING:
                    continue
                one = cells[kind][str(count)] = _measure(build(count), count, r, quick)
                times = [1e3 * one[name]["median"] if name in one else math.nan for name in _NAMES.values()]
                lines.append((kind, count, *times, *one["periods"], one["unresolved"]))
                print(*lines[-1], flush=True)
    table(
        (
            "",
            "contacts",
            "ms from rest",
            "ms from neighbour",
            "ms of boundaries",
            "periods from rest",
            "from neighbour",
            "unresolved",
        ),
        lines,
    )
    content = {"cells": cells, "slopes": slopes(cells)}
    save("many_contacts", content, results)
    draw(content, results / "many_contacts.png")
    return content

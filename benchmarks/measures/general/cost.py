"""Cost of a stick-slip cell in rows of a map, mu = 1, also over the number of contacts.

A row is computed as in maps: the first cell from rest, every other one from the steady state of its
neighbour in beta.  Its friction ratios cover the longest range of stick-slip at this frequency, so that
nearly every cell of the row is one.  The boundaries of the frequency are not part of the time, see `whole`.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

import frictionmap as fm

from ...report.record import spread, table, timed
from .kernels import map_row, open_share, stick_scale
from .scenes import ONE, SCENES, SQUARE, many_contacts


class _Count(NamedTuple):
    """How much is computed."""

    rows: int
    cells: int  # of a row
    rounds: int


#: Scenes, and systems with many contacts, by quick.
_SCENES = {False: _Count(20, 200, 5), True: _Count(2, 20, 2)}
_OVER_CONTACTS = {False: _Count(8, 100, 3), True: _Count(2, 20, 1)}

#: Cells of the row in which the range of stick-slip is looked for, and largest beta where it has no end.
_COARSE, _LARGEST = 64, 4.0

_CONTACTS = range(1, 9)
_MANY = (0.25, 1.5)  # frequencies of the systems with many contacts

Row = tuple[Callable[[], None], np.ndarray]


def _longest_run(flags: np.ndarray) -> tuple[int, int]:
    """First and last index of the longest run of true values; (0, -1) without one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    begins, ends = edges[::2], edges[1::2]
    if not begins.size:
        return 0, -1
    k = int(np.argmax(ends - begins))
    return int(begins[k]), int(ends[k]) - 1


def stick_slip_range(system: fm.System, r: float) -> tuple[float, float] | None:
    """The longest range of beta with stick-slip on a coarse row; None if it has fewer than two cells."""
    top = min(float(stick_scale(system, np.array([r]))[0]), _LARGEST)
    beta = top * np.arange(1, _COARSE) / _COARSE
    solve, cells = map_row(system, r, beta)
    solve()
    first, last = _longest_run(open_share(cells))
    return (float(beta[first]), float(beta[last])) if last > first else None


def rows_at(system: fm.System, frequencies: Iterable[float], cells: int) -> list[Row]:
    """Rows at these frequencies, as functions that solve them, with whether each cell is open."""
    found = []
    for r in frequencies:
        ends = stick_slip_range(system, float(r))
        if ends is not None:
            solve, out = map_row(system, float(r), np.linspace(*ends, cells))
            solve()
            found.append((solve, open_share(out)))
    return found


def _open_cells(rows: list[Row]) -> int:
    return int(sum(flags.sum() for _, flags in rows))


def seconds_a_cell(rows: list[Row]) -> float:
    """Time to solve rows, over their open cells."""
    return sum(timed(solve)[0] for solve, _ in rows) / _open_cells(rows)


def _cell_cost(system: fm.System, frequencies: tuple[float, float], count: _Count) -> dict:
    """Time per stick-slip cell of all rows, over rounds."""
    rows = rows_at(system, np.geomspace(*frequencies, count.rows), count.cells)
    return {
        "rows": len(rows),
        "cells": int(sum(flags.size for _, flags in rows)),
        "stick-slip cells": _open_cells(rows),
        "seconds a cell": spread([seconds_a_cell(rows) for _ in range(count.rounds)]),
    }


def cell_costs(quick: bool) -> dict:
    """Measure and print the time per cell of every scene."""
    content = {
        name: _cell_cost(scene.system(), scene.frequencies, _SCENES[quick]) for name, scene in SCENES.items()
    }
    one = content[ONE]["seconds a cell"]["median"]
    content[SQUARE]["over one harmonic"] = content[SQUARE]["seconds a cell"]["median"] / one
    table(
        ("stick-slip cells, mu = 1, in rows of a map", "rows", "cells", "us a cell"),
        [
            (name, entry["rows"], entry["stick-slip cells"], 1e6 * entry["seconds a cell"]["median"])
            for name, entry in content.items()
        ],
    )
    print(f"square wave over one harmonic: {content[SQUARE]['over one harmonic']:.3g}")
    return content


def costs_over_contacts(quick: bool) -> dict:
    """Measure and print the time per cell of eight masses over the number of contacts."""
    content = {
        str(count): _cell_cost(many_contacts(count), _MANY, _OVER_CONTACTS[quick]) for count in _CONTACTS
    }
    table(
        ("contacts, eight masses", "cells", "us a cell"),
        [
            (count, entry["stick-slip cells"], 1e6 * entry["seconds a cell"]["median"])
            for count, entry in content.items()
        ],
    )
    return content

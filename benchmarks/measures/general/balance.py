"""The elastic contact: harmonic balance with 1 to 31 harmonics against the exact steady states.

Rows of a map at kt = 3, each solved from cell to cell by both, which favours harmonic balance: Newton's
method needs few steps from a neighbour.  The error is that of max abs(z), relative to frictionmap.
"""

import numpy as np

from ...peers.harmonic_balance import HarmonicBalance, amplitudes
from ...report.record import spread, table, timed
from .cost import stick_slip_range
from .kernels import map_row
from .scenes import ELASTIC, SCENES

#: Highest harmonic; frequencies, cells of a row, and rounds, by quick.
HIGHEST = (1, 3, 5, 7, 11, 15, 21, 31)
_QUICK = (1, 7, 31)
_FREQUENCIES = {False: (0.2, 0.4, 0.7, 1.0, 1.3, 1.7), True: (0.4, 1.3)}
_CELLS, _ROUNDS = {False: 100, True: 10}, {False: 7, True: 2}


def _point(highest: int, rows: list[tuple[float, np.ndarray]], exact: list[np.ndarray], rounds: int) -> dict:
    """Time and errors of harmonic balance up to one harmonic."""
    scene = SCENES[ELASTIC]
    balance = HarmonicBalance(scene.body, float(scene.stiffness or 0.0), highest)
    balance.solve(*rows[0])  # compiles
    cells = sum(beta.size for _, beta in rows)
    seconds, found = [], []
    for _ in range(rounds):
        taken, found = timed(lambda: [balance.solve(r, beta) for r, beta in rows])
        seconds.append(taken / cells)
    errors = np.concatenate(
        [
            np.abs(amplitudes(balance.orders, one) - z) / z
            for one, z in zip(found, exact, strict=True)
        ]
    )  # fmt: skip
    solved = errors[np.isfinite(errors)]
    return {
        "highest harmonic": highest,
        "seconds a cell": spread(seconds),
        "cells that did not converge": int(errors.size - solved.size),
        "median relative error of Z": float(np.median(solved)),
        "largest relative error of Z": float(solved.max()),
    }


def harmonic_balance(quick: bool) -> dict:
    """Measure and print both methods on the same rows."""
    system = SCENES[ELASTIC].system()
    rows, ours, exact = [], [], []
    for r in _FREQUENCIES[quick]:
        ends = stick_slip_range(system, r)
        if ends is None:
            continue
        beta = np.linspace(*ends, _CELLS[quick])
        solve, cells = map_row(system, r, beta)
        solve()
        rows.append((r, beta))
        ours.append(solve)
        exact.append(np.maximum(cells.highest, -cells.lowest)[0, 0, :, 0])
    cells = sum(beta.size for _, beta in rows)
    seconds = [sum(timed(solve)[0] for solve in ours) / cells for _ in range(_ROUNDS[quick])]
    points = [_point(h, rows, exact, _ROUNDS[quick]) for h in (_QUICK if quick else HIGHEST)]
    ours_median = spread(seconds)["median"]
    for point in points:
        point["ratio"] = point["seconds a cell"]["median"] / ours_median
    table(
        ("harmonic balance, up to", "us a cell", "ratio", "error, median", "largest", "failed"),
        [
            (
                point["highest harmonic"], 1e6 * point["seconds a cell"]["median"], point["ratio"],
                point["median relative error of Z"], point["largest relative error of Z"],
                point["cells that did not converge"],
            )
            for point in points
        ],
    )  # fmt: skip
    print(f"exact: {1e6 * ours_median:.3g} us a cell")
    return {"cells": cells, "our seconds a cell": spread(seconds), "points": points}

"""Check every peer of one mass that is installed against a table of known steady states, and time it.

python -m benchmarks.peers.check steady_states.json
"""

import argparse
import json
import math
import statistics
import time
from collections.abc import Sequence
from functools import cache

from . import heyoka, solve_ivp
from .body import Body, Cell
from .peer import Peer

PEERS = (solve_ivp.OneMassSolveIvp, heyoka.OneMassHeyoka)
WALLS = {"sdof-wall": "fixed-wall", "sdof-base": "joined-base-wall"}


def reference_rows(path: str) -> list[tuple[Body, Cell, dict]]:
    """Rows of the table that these solvers can run, as (Body, Cell, row)."""
    with open(path, encoding="utf-8") as file:
        rows = json.load(file)["rows"]
    return [
        (
            Body(zeta=float(row["zeta"]), wall=WALLS[row["system"]]),
            Cell(*(float(row[key]) for key in Cell._fields)),
            row,
        )
        for row in rows
        if row["system"] in WALLS
    ]


def check(kind: type[Peer], rows: Sequence[tuple[Body, Cell, dict]], cycles: int) -> tuple:
    """Run the rows; return (wrong cells, errors of Z where converged, times).

    Z is not compared if the reference itself needs more than `cycles` periods, or never converges.
    """
    made = cache(kind)
    wrong, errors, times = [], [], []
    for body, cell, row in rows:
        peer = made(body)
        begin = time.perf_counter()
        outcome = peer.run(cell, cycles)
        elapsed = time.perf_counter() - begin
        if row["status"] == "stuck":
            wrong += [] if math.isnan(outcome.stops) else [(body, cell)]
            continue
        times.append(elapsed)
        wrong += [] if outcome.stops == row["stops"] else [(body, cell)]
        if row["status"] == "ok" and row["cycles"] <= cycles:
            errors.append(abs(outcome.Z - float(row["Z"])))
    return wrong, errors, times


def main() -> None:
    """Check and time the solvers."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("reference", help="JSON table of steady states")
    parser.add_argument("--rows", type=int, help="run the first so many rows only")
    parser.add_argument("--cycles", type=int, default=200, help="periods a run (default 200)")
    arguments = parser.parse_args()
    rows = reference_rows(arguments.reference)[: arguments.rows]
    for kind in PEERS:
        why = kind.why_missing()
        if why:
            print(f"{kind.name}: skipped, {why}")
            continue
        wrong, errors, times = check(kind, rows, arguments.cycles)
        print(
            f"{kind.name} ({kind.package}): {len(rows)} cells,"
            f" {len(wrong)} with the wrong number of stops; error of Z: median"
            f" {statistics.median(errors):.1e}, worst {max(errors):.1e} ({len(errors)} settled);"
            f" a moving cell takes {1e3 * statistics.median(times):.3g} ms (median),"
            f" {1e3 * statistics.fmean(times):.3g} ms (mean)"
        )
        for where in wrong:
            print(f"    wrong: {where}")


if __name__ == "__main__":
    main()

"""Other solvers on the same cells: time against error.

Random stick-slip cells of every scene with rigid contacts, from rest, mu = 1.  frictionmap ends when the
steady state is found, and computes all constants of a cell again.  In a map it begins at the steady states of
the cells beside: the time of a cell in rows of a map at the same frequencies is given, too.

For one mass the other solvers march 200 periods, as in the thesis.  For more masses they are given the
number of periods after which a disturbance has decayed to 1e-10, by the multiplier that frictionmap computes,
and ten more.  Cells that need more than 200 periods, or more than `_MOST_PERIODS` with more masses, are left
out.

Errors are those of the ranges max z - min z of the contacts, over the largest range in the cell, relative to
frictionmap.  The tests compare frictionmap with steady states that were computed by independent programs.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...peers import heyoka, moreau, solve_ivp
from ...peers.contacts import ContactBody, ContactCell, ContactOutcome, ContactPeer, largest_difference
from ...report.record import spread, table, timed
from .cost import Row, rows_at, seconds_a_cell, stick_slip_range
from .kernels import Found, single_cells
from .scenes import E1, E2, FIVE, ONE, SCENES, SQUARE, TWO, Scene

#: Scenes that are compared, and cells of each, by quick.
COMPARED = (ONE, TWO, SQUARE, FIVE, E1, E2)
_CELLS = {False: 3, True: 1}

#: Cells of a row of a map.
_ROW = 200

#: Periods that are marched: one mass; more masses, at most.
_THESIS = 200
_MOST_PERIODS = 100
_DECAYED, _EXTRA = 1e-10, 10

#: Runs of frictionmap and of other solvers; a slow solver runs once.
_OURS, _THEIRS = {False: 50, True: 3}, {False: 3, True: 1}
_SLOW = 1.0  # seconds of a run

#: Periods marched before the timed runs.
_WARM = 10

_EPS = float(np.finfo(float).eps)


class Method(NamedTuple):
    """A solver with a setting that trades time for accuracy."""

    kind: type[ContactPeer]  # names the package
    make: Callable[[ContactBody, float], ContactPeer]
    setting: str
    settings: tuple[float, ...]
    quick: tuple[float, ...]


def _tolerances(relative: float) -> dict:
    """Absolute tolerance that belongs to a relative one: displacements are about 1."""
    return {"rtol": relative, "atol": max(1e-3 * relative, 1e-14)}


METHODS = (
    Method(
        solve_ivp.ContactsSolveIvp, lambda body, t: solve_ivp.contact_peer(body, **_tolerances(t)), "rtol",
        (1e-6, 1e-9, 1e-12), (1e-6,),
    ),
    Method(
        heyoka.ContactsHeyoka, lambda body, t: heyoka.contact_peer(body, tol=t), "tol",
        (1e-3, 1e-6, 1e-9, _EPS), (_EPS,),
    ),
    Method(
        moreau.ContactsMoreau, lambda body, steps: moreau.ContactsMoreau(body, int(steps)),
        "steps per period", (64, 256, 1024, 4096, 16_384), (256,),
    ),
)  # fmt: skip


class _Sample(NamedTuple):
    """Cells of a scene, with the periods that others march and the results of the package."""

    cells: list[ContactCell]
    periods: list[int]
    solve: Callable[[], None]
    found: Found
    rows: list[Row]  # of a map, at the same frequencies


def periods_needed(multiplier: float) -> int:
    """Periods after which a disturbance has decayed, and some more."""
    if not multiplier > 0.0:
        return _EXTRA
    return _EXTRA + math.ceil(math.log(_DECAYED) / math.log(min(multiplier, 1.0 - 1e-12)))


def _sample(scene: Scene, quick: bool, rng: np.random.Generator) -> tuple[_Sample, int]:
    """Random stick-slip cells of a scene; number of those left out because they need more periods."""
    system = scene.system()
    cells: list[ContactCell] = []
    periods, left_out = [], 0
    while len(cells) < _CELLS[quick]:
        r = float(rng.uniform(*scene.frequencies))
        ends = stick_slip_range(system, r)
        if ends is None:
            continue
        cell = ContactCell(r, scene.forces(float(rng.uniform(*ends))))
        solve, found = single_cells(system, np.array([r]), np.array([cell.beta]))
        solve()
        if not found.stops.sum() > 0.0:
            continue
        needed = periods_needed(float(found.multiplier[0]))
        if needed > (_THESIS if scene.body.masses == 1 else _MOST_PERIODS):
            left_out += 1
            continue
        cells.append(cell)
        periods.append(needed if scene.body.masses > 1 else _THESIS)
    solve, found = single_cells(system, *(np.array(column) for column in zip(*cells, strict=True)))
    solve()
    rows = rows_at(system, [cell.r for cell in cells], _ROW)
    return _Sample(cells, periods, solve, found, rows), left_out


def _outcomes(peer: ContactPeer, sample: _Sample) -> list[ContactOutcome | None]:
    """Results of all cells; None where the solver fails."""
    found: list[ContactOutcome | None] = []
    for cell, periods in zip(sample.cells, sample.periods, strict=True):
        try:
            found.append(peer.run(cell, periods))
        except RuntimeError:
            found.append(None)
    return found


def _point(peer: ContactPeer, sample: _Sample, runs: int) -> dict:
    """Time and errors of one solver at one setting."""
    for cell in sample.cells:  # compiles, heyoka for each set of held contacts that a motion visits
        peer.run(cell, _WARM)
    seconds: list[float] = []
    outcomes: list[ContactOutcome | None] = []
    while len(seconds) < runs and not (seconds and seconds[0] > _SLOW):
        taken, outcomes = timed(lambda: _outcomes(peer, sample))
        seconds.append(taken)
    errors, other, failed = [], 0, 0
    for outcome, stops, ranges in zip(outcomes, sample.found.stops, sample.found.ranges, strict=True):
        if outcome is None:
            failed += 1
            continue
        other += any(a != b for a, b in zip(outcome.stops, stops, strict=True))
        errors.append(largest_difference(outcome.ranges, ranges))
    return {
        "seconds a cell": spread([one / len(sample.cells) for one in seconds]),
        "relative errors of ranges": errors,
        "cells with other stop counts": other,
        "cells that failed": failed,
    }


def _measure(scene: Scene, sample: _Sample, quick: bool) -> dict:
    """Times and errors of all solvers on the cells of a scene."""
    ours = spread([timed(sample.solve)[0] / len(sample.cells) for _ in range(_OURS[quick])])
    in_rows = spread([seconds_a_cell(sample.rows) for _ in range(_THEIRS[quick])])
    methods: dict[str, dict] = {}
    for method in METHODS:
        why = method.kind.why_missing()
        if why:
            print(f"{method.kind.name}: skipped, {why}")
            methods[method.kind.name] = {"skipped": why}
            continue
        points = []
        for setting in method.quick if quick else method.settings:
            point = _point(method.make(scene.body, setting), sample, _THEIRS[quick])
            theirs = point["seconds a cell"]["median"]
            ratios = {"ratio": theirs / ours["median"], "ratio in rows": theirs / in_rows["median"]}
            points.append({method.setting: setting, **point, **ratios})
        methods[method.kind.name] = {
            "version": method.kind.version(), "setting": method.setting, "points": points
        }  # fmt: skip
    return {"our seconds a cell": ours, "our seconds a cell in rows": in_rows, "methods": methods}


def _rows(name: str, entry: dict) -> list[tuple]:
    """Rows of the printed table."""
    rows = []
    for method, found in entry["methods"].items():
        for point in found.get("points", ()):
            errors = point["relative errors of ranges"]
            rows.append(
                (
                    name, f"{method}, {found['setting']} {point[found['setting']]:.3g}",
                    1e3 * point["seconds a cell"]["median"], 1e6 * entry["our seconds a cell"]["median"],
                    f"{point['ratio']:,.0f}", f"{point['ratio in rows']:,.0f}",
                    float(np.median(errors)) if errors else math.nan,
                    max(errors, default=math.nan), point["cells with other stop counts"],
                )
            )  # fmt: skip
    return rows


def other_solvers(quick: bool) -> dict:
    """Measure and print all scenes against other solvers."""
    rng = np.random.default_rng(2425)
    content, rows = {}, []
    for name in COMPARED:
        scene = SCENES[name]
        sample, left_out = _sample(scene, quick, rng)
        needed = [periods_needed(float(value)) for value in sample.found.multiplier]
        content[name] = {
            "cells": [cell._asdict() for cell in sample.cells],
            "cells left out, too many periods": left_out,
            "periods marched": sample.periods,
            "periods until a disturbance has decayed": needed,
            **_measure(scene, sample, quick),
        }
        rows += _rows(name, content[name])
    heads = "cells", "solver", "ms a cell", "ours, us", "ratio", "in rows", "error, median", "largest"
    table((*heads, "other stops"), rows)
    return content

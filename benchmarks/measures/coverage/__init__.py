"""Coverage of `identify`: how often the stated 95 % intervals contain the true value.

For every kind of measurement, synthetic data with known true values are generated, one seed at a time,
disturbed in one way (a gap, a drift, a wandering zero, outliers, a limited range, heavy damping), and fitted
with the public function as a user would. Each row of the table counts, over its seeds, the intervals that
contain their true value, the refusals and the warnings. It also compares errors with the stated standard
errors.

The data are generated without the package: decays in closed form by half cycles, those of sensors with
filters by matrix exponentials, records by `references.shaken`, forced responses by half-period propagators or
by marching, sweeps from M, K and C, forces of dampers by marching their springs, and motions under bases and
forces of any shape by matrix exponentials of small steps.
"""

import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from ...report.quoted_coverage import HEADER, coverage_notes, coverage_rows
from ...report.record import machine, save, table
from . import decays, forced, histories, joint, loops, records, sensors, sweeps
from .case import SEEDS, Trial, attempt
from .counting import STATED, row
from .figure import draw

#: Cases by kind of measurement.
KINDS = {
    "free_decay": decays.CASES + sensors.CASES,
    "forced": forced.CASES,
    "record": records.CASES,
    "sweep": sweeps.CASES,
    "joint": joint.CASES,
    "loop": loops.CASES,
    "history": histories.CASES,
}

#: Share of the seeds that is fitted unless all are wanted.
SHARE = 0.1

#: Processes at a time, and fits that one of them is given at once.
_PROCESSES, _AT_ONCE = min(os.cpu_count() or 1, 16), 5


def trial(task: tuple[str, int, int]) -> Trial:
    """Fit one case: kind, position of the case in the list, and seed."""
    kind, place, seed = task
    rng = np.random.default_rng([list(KINDS).index(kind), place, seed])
    return attempt(KINDS[kind][place].make(rng), seed)


def _tasks(share: float | None) -> Iterator[tuple[str, int, int]]:
    """All fits of a share of the seeds; without a share, one fit of every case that has all seeds."""
    for kind, cases in KINDS.items():
        for place, case in enumerate(cases):
            seeds = int(case.seeds == SEEDS) if share is None else round(share * case.seeds)
            for seed in range(seeds):
                yield kind, place, seed


def measure(share: float | None = 1.0) -> Iterator[tuple[str, str, dict]]:
    """Kind, name and row of each case when it is done; without a share the quick form, in this process."""
    tasks = list(_tasks(share))
    if share is None:
        yield from _rows(tasks, map(trial, tasks))
        return
    with ProcessPoolExecutor(_PROCESSES, mp_context=get_context("spawn")) as pool:
        yield from _rows(tasks, pool.map(trial, tasks, chunksize=_AT_ONCE))


def _rows(tasks: list[tuple[str, int, int]], trials: Iterable[Trial]) -> Iterator[tuple[str, str, dict]]:
    """Complete the row of every case with its last fit."""
    for (kind, place), some in groupby(zip(tasks, trials, strict=True), key=lambda one: one[0][:2]):
        yield kind, KINDS[kind][place].name, row([one for _, one in some])


def run(quick: bool, results: Path, whole: bool = False) -> dict:
    """Generate data, fit, count and print; save after each case, and draw the figure at the end.

    whole : all seeds, which takes an hour of two processors, instead of `SHARE` of them
    """
    kinds: dict[str, dict[str, dict]] = {}
    content = {"machine": machine(), "stated coverage": STATED, "kinds": kinds}
    for kind, name, one in measure(None if quick else 1.0 if whole else SHARE):
        kinds.setdefault(kind, {})[name] = one
        save("coverage", content, results)
        print(*coverage_rows({kind: {name: one}})[0], sep="  ", flush=True)
    table(HEADER, coverage_rows(kinds))
    for note in coverage_notes(kinds):
        print(note)
    draw(kinds, results / "coverage.png")
    return content

"""No cell hangs: up to a million random cells, each with a regime or a status that states the cause.

r from 1e-3 to 1e3 (logarithmic), beta from 0 to 2 beta_stick, mu from 1 to 10, zeta from 0 to 5, 1 to 6
masses, any contact, from rest and moving.
"""

import os
import time
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import xarray as xr

import frictionmap as fm
from frictionmap import regimes

from ...report.record import table

OUTPUTS = ("regime", "status", "stops_per_cycle", "contact_amplitude")

#: Excitation periods after which to give up; fewer at small r, where each holds 1/r periods of the structure.
#: The default, 2000, only makes those that need more slower.
CYCLES = 100
LEAST_CYCLES = 10

#: Cells of one structure at one frequency.
ROW = 50

#: Time for the cells of one row above which it is listed [s].
SLOW = 10.0


def random_system(rng: np.random.Generator, n: int) -> fm.System:
    """Chain of n random masses and springs, any contact, any load; undamped, or damped by up to 5."""
    mass, stiffness = (np.concatenate(([1.0], rng.uniform(0.3, 3.0, n - 1))) for _ in range(2))
    contact = str(rng.choice(["fixed-wall", "joined-base-wall", "between-masses"][: 2 + (n > 1)]))
    first = int(rng.integers(1, n + (contact != "between-masses")))
    masses = [first, int(rng.integers(first + 1, n + 1))] if contact == "between-masses" else [first]
    zeta = float(rng.choice([0.0, rng.uniform(0.0, 0.1), rng.uniform(0.0, 5.0)]))
    return fm.System(
        contact=contact, contact_masses=masses, mass_ratios=mass.tolist(),
        stiffness_ratios=stiffness.tolist(), damping_ratios=zeta,
        load_mass=1 if contact == "joined-base-wall" else int(rng.integers(1, n + 1)),
    )  # fmt: skip


def _why(system: fm.System, r: float, mu: float, status: int) -> str:
    """Common properties of unresolved cells."""
    name = next(code.name for code in regimes.STATUSES if code.value == status)
    damping = "undamped" if system.zeta == 0.0 else "damped"
    pace = "r < 0.1" if r < 0.1 else "r > 10" if r > 10.0 else "r 0.1 to 10"
    return f"{name}: {damping}, mu {'= 1' if mu == 1.0 else '> 1'}, {pace}"


class Row(NamedTuple):
    """Cells of one structure at one frequency."""

    system: fm.System
    r: float
    mu: float
    beta: np.ndarray
    start: str

    @property
    def words(self) -> dict:
        """Description of the row."""
        return {"system": str(self.system), "r": self.r, "mu": self.mu, "start": self.start}


def random_row(rng: np.random.Generator) -> Row:
    """Random structure, frequency, static-to-kinetic ratio and initial state; beta from 0 to 2 beta_stick."""
    system = random_system(rng, int(rng.integers(1, 7)))
    r = 10.0 ** float(rng.uniform(-3.0, 3.0))
    mu = float(rng.choice([1.0, rng.uniform(1.0, 2.0), rng.uniform(1.0, 10.0)]))
    stick = fm.boundaries(system, [r], [mu]).beta_stick.item()
    top = 2.0 * stick if 0.0 < stick < 1e6 else 1.0
    return Row(system, r, mu, np.unique(rng.uniform(0.0, top, ROW)), str(rng.choice(["rest", "moving"])))


def _solve(row: Row) -> tuple[xr.Dataset, float]:
    """Compute the cells of a row; return them with the seconds they took."""
    cycles = max(LEAST_CYCLES, round(CYCLES * min(1.0, 10.0 * row.r)))
    began = time.perf_counter()
    ds = fm.sweep(
        row.system, [row.r], row.beta, [row.mu], outputs=OUTPUTS, start=row.start, cycles=cycles, threads=1
    )
    return ds, time.perf_counter() - began


def _wrong(ds: xr.Dataset) -> np.ndarray:
    """Resolved cells without a regime, or without the numbers that belong to it."""
    regime, status = ds.regime.values.ravel(), ds.status.values.ravel()
    stops, z = ds.stops_per_cycle.values.ravel(), ds.contact_amplitude.values.ravel()
    slides = regime != regimes.PERMANENT_STICKING
    return (status == regimes.RESOLVED) & (
        (regime < 0)
        | (slides & ~((z >= 0.0) & (stops >= 0.0)))
        | ((regime == regimes.STICK_SLIP) & ~(stops > 0.0))
    )


def random_cells(wanted: int, seconds: float) -> dict:
    """Cells by status, and the unresolved ones by their common properties.

    No row is started after `seconds`: the number of cells is then below the requested one.
    """
    began = time.perf_counter()
    statuses: dict[str, int] = {}
    causes: dict[str, int] = {}
    slow: list[dict] = []
    faults: list[dict] = []
    slowest, cells = 0.0, 0
    rng = np.random.default_rng(6)
    waiting: deque[tuple[Row, Future]] = deque()
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with ThreadPoolExecutor(workers) as pool:  # the kernels let go of the interpreter
        asked = 0
        while waiting or (asked < wanted and time.perf_counter() - began < seconds):
            while asked < wanted and len(waiting) < 4 * workers and time.perf_counter() - began < seconds:
                row = random_row(rng)
                waiting.append((row, pool.submit(_solve, row)))
                asked += row.beta.size
            row, done = waiting.popleft()
            ds, taken = done.result()
            slowest = max(slowest, taken)
            cells += row.beta.size
            if taken > SLOW:
                slow.append(row.words | {"seconds": taken})
            for value, count in zip(*np.unique(ds.status.values, return_counts=True), strict=True):
                name = next(code.name for code in regimes.STATUSES if code.value == value)
                statuses[name] = statuses.get(name, 0) + int(count)
                if value != regimes.RESOLVED:
                    why = _why(row.system, row.r, row.mu, int(value))
                    causes[why] = causes.get(why, 0) + int(count)
            faults += [row.words | {"beta": float(row.beta[j])} for j in np.flatnonzero(_wrong(ds))]
    return {
        "wanted": wanted, "limit [s]": seconds, "cells": cells, "cells of a row": ROW,
        "periods at most": [LEAST_CYCLES, CYCLES], "threads": workers, "seconds": time.perf_counter() - began,
        "slowest row of cells [s]": slowest, "rows slower than the limit": slow, "statuses": statuses,
        "unresolved, by cause": causes, "resolved without a regime or a number": faults,
    }  # fmt: skip


def _ranked(counts: dict[str, int], cells: int) -> list[tuple]:
    return [(name, n, 100.0 * n / cells) for name, n in sorted(counts.items(), key=lambda item: -item[1])]


def report(found: dict) -> None:
    """Print the results."""
    cells = found["cells"]
    if cells < found["wanted"]:
        print(f"{found['wanted']:,} random cells were wanted, the limit of {found['limit [s]']:g} s ended it")
    print(
        f"{cells:,} random cells, {LEAST_CYCLES} to {CYCLES} periods each, in {found['seconds']:,.0f} s; "
        f"slowest {ROW} cells {found['slowest row of cells [s]']:.2g} s"
    )
    table(("status", "cells", "share [%]"), _ranked(found["statuses"], cells))
    print()
    table(("not resolved", "cells", "share [%]"), _ranked(found["unresolved, by cause"], cells))
    print(f"resolved without a regime or a number: {len(found['resolved without a regime or a number'])}")

"""Steady states: solved against marched, uniqueness for mu = 1, unresolved cells without damping.

Marching continues until the motion repeats, to 1e-12 per recurrence. It does not use Newton's method,
neighbouring cells or closed forms (`skip = "none"`). Its results are compared cell by cell, and the
differences are counted by cause.
"""

import math
from collections import Counter
from pathlib import Path

import numpy as np
import xarray as xr

import frictionmap as fm
from frictionmap import regimes

from .. import ROOT
from ..report.record import save, table

CONFIGS = ROOT / "configs"
OUTPUTS = ("regime", "stops_per_cycle", "contact_amplitude", "status", "period")

#: Excitation periods that marching may take.
CYCLES = 20000

#: Marching to 1e-12 a return is this far off where the motion creeps; a smaller Z than this [P/k1] is
#: compared relative to this, since what repeats is the whole state.
CLOSE = 1e-6
SMALL_Z = 1e-3

#: A cell this close to a boundary is on it, to rounding.
ON_BOUNDARY = 1e-14

#: Chains: masses, contact, load, damping ratio.
DAMPED = ((2, 2, 1, 0.02), (3, 1, 3, 0.01), (5, 3, 1, 0.01), (5, 5, 5, 0.05), (4, 2, 4, 0.003))


def _chain(masses: int, contact: int, load: int, zeta: float) -> fm.System:
    ones = [1.0] * masses
    return fm.System(
        contact_masses=[contact], load_mass=load, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=zeta
    )


def _status(value: int) -> str:
    return next(code.name for code in regimes.STATUSES if code.value == value)


def _cause(beta: float, ends: list[float], statuses: list[int]) -> str:
    """Cause of the difference between the solved and the marched result of one cell."""
    if min(abs(beta / end - 1.0) if end else math.inf for end in ends) < ON_BOUNDARY:
        return "beta on a boundary to rounding"
    for name, status in zip(("solved", "marched"), statuses, strict=True):
        if status:
            return f"{name}: {_status(status)}"
    return "unexplained"


def compare(
    solved: xr.Dataset, marched: xr.Dataset, statuses: bool = True
) -> tuple[int, list[str], np.ndarray]:
    """Cells that both resolve, the causes of different ones, and relative differences of Z.

    statuses : whether another status is a difference
    """
    regime = (solved.regime != marched.regime).values
    stops = (solved.stops_per_cycle != marched.stops_per_cycle).values & (
        solved.regime == regimes.STICK_SLIP
    ).values
    z = solved.contact_amplitude.values, marched.contact_amplitude.values
    with np.errstate(invalid="ignore"):
        off = np.abs(z[0] - z[1]) / np.maximum(np.abs(z[1]), SMALL_Z)
    status = (solved.status != marched.status).values
    both = ((solved.status == 0) & (marched.status == 0)).values
    moves = both & (solved.regime > 0).values & np.isfinite(z[1])
    different = (both & (regime | stops)) | (moves & (off > CLOSE)) | (status & statuses)
    found = []
    for m, i, j in np.argwhere(different):
        both_statuses = [int(ds["status"].values[m, i, j]) for ds in (solved, marched)]
        ends = [float(solved[name].values[m, i]) for name in ("beta_lim", "beta_stick")]
        found.append(_cause(float(solved["beta"].values[j]), ends, both_statuses))
    return int(both.sum()), found, off[moves]


def _summary(cells: int, both: int, causes: list[str], off: list[np.ndarray]) -> dict:
    largest = np.concatenate(off)
    largest = largest[np.isfinite(largest)]  # an infinite one is among the differences
    return {
        "cells": cells,
        "both resolved": both,
        "differences by cause": dict(Counter(causes)),
        "largest difference of Z": float(largest.max(initial=0.0)),
        "median difference of Z": float(np.median(largest)) if largest.size else 0.0,
    }


def published_map(quick: bool) -> dict:
    """Every cell of T Fig. 3.12, mu = 1 and 1.5, from rest."""
    config = fm.load_config(CONFIGS / "fig-3-12.toml")
    every = 5 if quick else 1
    grid = (config.system, config.r[::every], config.beta[::every], config.mu)
    solved = fm.sweep(*grid, outputs=OUTPUTS)
    marched = fm.sweep(*grid, outputs=OUTPUTS, skip="none", steady="marched", cycles=CYCLES)
    both, found, off = compare(solved, marched)
    return _summary(solved.regime.size, both, found, [off])


def random_cells(quick: bool) -> dict:
    """Random cells of damped chains, mu from 1 to 2, from rest and moving."""
    rng = np.random.default_rng(2000)
    every, off, both = 10 if quick else 400, [], 0
    found: list[str] = []
    for arguments in DAMPED:
        system = _chain(*arguments)
        for _ in range(every):
            r, mu = [float(rng.uniform(0.05, 3.0))], [float(rng.choice([1.0, 1.2, 1.5, 2.0]))]
            curves = fm.boundaries(system, r, mu)
            top = max(curves.beta_lim.item(), curves.beta_stick.item())
            grid = (system, r, [float(rng.uniform(0.0, 1.1 * top))], mu)
            start = str(rng.choice(["rest", "moving"]))
            pair = [
                fm.sweep(*grid, outputs=OUTPUTS, start=start, threads=1, **settings)
                for settings in ({}, {"skip": "none", "steady": "marched", "cycles": CYCLES})
            ]
            resolved, causes, difference = compare(*pair)
            both += resolved
            found += causes
            off.append(difference)
    return _summary(every * len(DAMPED), both, found, off)


def random_system(rng: np.random.Generator, zeta: float) -> fm.System:
    """Chain of 1 to 4 random masses and springs, any contact, any load."""
    n = int(rng.integers(1, 5))
    mass, stiffness = (np.concatenate(([1.0], rng.uniform(0.3, 3.0, n - 1))) for _ in range(2))
    contact = str(rng.choice(["fixed-wall", "joined-base-wall", "between-masses"][: 2 + (n > 1)]))
    first = int(rng.integers(1, n + 1)) if contact != "between-masses" else int(rng.integers(1, n))
    masses = [first] if contact != "between-masses" else [first, int(rng.integers(first + 1, n + 1))]
    load = 1 if contact == "joined-base-wall" else int(rng.integers(1, n + 1))
    return fm.System(
        contact=contact, contact_masses=masses, load_mass=load, mass_ratios=mass.tolist(),
        stiffness_ratios=stiffness.tolist(), damping_ratios=zeta,
    )  # fmt: skip


def one_answer(quick: bool) -> dict:
    """mu = 1: compare marching from rest, marching from the moving start, and the result of a map."""
    rng = np.random.default_rng(10000)
    wanted = 250 if quick else 10000
    cells = resolved = 0
    found: list[str] = []
    off = []
    while resolved < wanted:
        system = random_system(rng, float(rng.choice([0.0, 0.005, 0.03, 0.3, 1.5])))
        r = np.sort(rng.uniform(0.05, 2.5, 10))
        top = min(fm.boundaries(system, r).beta_stick.values.max(), 20.0)
        grid = (system, r, np.sort(rng.uniform(0.0, 1.2 * top, 25)))
        plain = fm.sweep(*grid, outputs=OUTPUTS)
        marched = [
            fm.sweep(*grid, outputs=OUTPUTS, skip="none", steady="marched", cycles=2000, start=start)
            for start in ("rest", "moving")
        ]
        decided = ((marched[0].status == 0) & (marched[1].status == 0) & (plain.status == 0)).values
        cells += decided.size
        resolved += int(decided.sum())
        for other in marched:
            _, causes, difference = compare(plain, other, statuses=False)
            found += causes
            off.append(difference)
    return {"resolved by all three": resolved} | _summary(cells, resolved, found, off)


def headings(quick: bool) -> dict:
    """One mass, mu > 1, with coexisting steady states: compare the solved one with the one that marching
    reaches.

    The result of a cell must be the same alone and in a map with other outputs, so no details are requested.
    """
    rng = np.random.default_rng(100000)
    maps, every = (1, 4) if quick else (25, 1)
    cells = both = 0
    found: list[str] = []
    off = []
    for _ in range(maps):
        contact = str(rng.choice(["fixed-wall", "joined-base-wall"]))
        zeta = float(rng.choice([0.0, 0.001, 0.01, 0.1]))
        system = fm.System(contact=contact, damping_ratios=zeta)
        r = np.sort(np.exp(rng.uniform(np.log(0.12), np.log(2.2), 60)))
        beta = np.sort(np.exp(rng.uniform(np.log(0.005), np.log(0.9), 40)))
        grid = (system, r[::every], beta[::every], np.sort(rng.uniform(1.05, 3.0, 2)))
        for start in ("rest", "moving"):
            solved = fm.sweep(*grid, outputs=OUTPUTS, start=start)
            marched = fm.sweep(*grid, outputs=OUTPUTS, start=start, steady="marched", cycles=CYCLES)
            resolved, causes, difference = compare(solved, marched)
            cells += solved.regime.size
            both += resolved
            found += causes
            off.append(difference)
    return _summary(cells, both, found, off)


def undamped(quick: bool) -> dict:
    """T Fig. 6.7 and 6.14, undamped: cells by status."""
    content: dict = {}
    for name in ("fig-6-7", "fig-6-14"):
        config = fm.load_config(CONFIGS / f"{name}.toml")
        every = 5 if quick else 1
        ds = fm.sweep(
            config.system, config.r[::every], config.beta[::every], config.mu, outputs=("regime", "status")
        )
        for m, mu in enumerate(ds.mu.values):
            values, counts = np.unique(ds.status.values[m], return_counts=True)
            content[f"{name}, mu = {mu:g}"] = {
                _status(int(value)): int(count) for value, count in zip(values, counts, strict=True)
            }
    return content


def run(quick: bool, results: Path) -> dict:
    """Compare, print and save."""
    content = {
        "T Fig. 3.12": published_map(quick),
        "five damped chains": random_cells(quick),
        "mu = 1, any start": one_answer(quick),
        "one mass, mu > 1": headings(quick),
    }

    def causes(row: dict) -> str:
        return ", ".join(f"{count} {cause}" for cause, count in row["differences by cause"].items()) or "none"

    table(
        ("cells of", "cells", "both resolved", "largest difference of Z", "differences by cause"),
        [
            (name, row["cells"], row["both resolved"], row["largest difference of Z"], causes(row))
            for name, row in content.items()
        ],
    )
    unresolved = undamped(quick)
    print()
    for name, row in unresolved.items():
        print(f"{name}: " + ", ".join(f"{count} {status}" for status, count in row.items()))
    content["undamped maps"] = unresolved
    save("steady", content, results)
    return content

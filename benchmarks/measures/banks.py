"""Banks of elastic elements: time of a map against the number of elements, as one contact and one by one.

Cells are one mass and three masses with a bank that is slipped through gradually: equal springs, of which
element i slips at i times the force of the first.  Element by element, maps have up to 40.  Ranges alone do
not depend on the places of elements that never slip, amplitudes do.
"""

import statistics
import time
from pathlib import Path

import numpy as np

import frictionmap as fm

from ..report.record import pinned, save, spread, table

_MASSES = {
    1: {"damping_ratios": 0.02},
    3: {"damping_ratios": 0.02, "mass_ratios": [1.0, 0.8, 0.6], "stiffness_ratios": [1.0, 1.2, 0.7]},
}

#: Elements of a bank as one contact, and of one whose elements are contacts.
_AS_ONE, _EACH = (2, 10, 40, 100, 200), (2, 10, 40)

#: Outputs that are asked for, by what is added to the names of the measurements.
_OUTPUTS = {"": "contact_amplitude", ", ranges alone": "contact_peak_to_peak"}

#: Cells by r and by beta, and repetitions; by quick.
_GRID = {False: (9, 14), True: (3, 4)}
_ROUNDS = {False: 3, True: 1}


def _system(masses: int, elements: int, bank: str | None) -> fm.System:
    """A chain whose last mass is at a bank of stiffness 1; of one element without a bank."""
    ranks = np.arange(1, elements + 1)
    stiffness, ratio = np.full(elements, 1.0 / elements), ranks / ranks.sum()
    given: dict = {"stiffness": stiffness.tolist(), "ratio": ratio.tolist(), "bank": bank}
    if elements == 1:
        given = {"stiffness": 1.0}
    return fm.System(contacts=[fm.Contact(masses=masses, **given)], **_MASSES[masses])


def _measure(system: fm.System, quick: bool) -> dict:
    """Seconds of a map, and what became of its cells."""
    many, friction = _GRID[quick]
    r, beta = np.linspace(0.5, 1.5, many), np.linspace(0.05, 3.0, friction)
    found: dict = {}
    for kind, output in _OUTPUTS.items():
        names = ["status", "cycles", output]
        fm.sweep(system, r[:1], beta[:1], outputs=names, threads=1)  # loads the kernels
        seconds = []
        for _ in range(_ROUNDS[quick]):
            began = time.process_time()
            ds = fm.sweep(system, r, beta, outputs=names, threads=1)
            seconds.append(time.process_time() - began)
        found |= {
            "cells": int(ds.status.size),
            f"unresolved{kind}": int((ds.status != fm.regimes.RESOLVED).sum()),
            f"seconds of a processor{kind}": spread(seconds),
            f"microseconds per cell{kind}": 1e6 * statistics.median(seconds) / ds.status.size,
            f"cycles per cell{kind}": float(ds.cycles.mean()),
        }
    return found


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    found: dict = {}
    rows = []
    with pinned():
        for masses in _MASSES:
            asked = [("one element", 1, None)]
            asked += [("bank", count, "contact") for count in _AS_ONE[: 2 if quick else None]]
            asked += [("elements", count, "elements") for count in _EACH[: 2 if quick else None]]
            for name, count, kind in asked:
                one = _measure(_system(masses, count, kind), quick)
                found[f"masses {masses}, {name}, {count}"] = one
                cost = [one[f"microseconds per cell{kind}"] for kind in _OUTPUTS]
                rows.append((masses, name, count, *cost, one["unresolved"]))
    table(("masses", "as", "elements", "us per cell", "us, ranges alone", "unresolved"), rows)
    content = {"scenes": found}
    save("banks", content, results)
    return content

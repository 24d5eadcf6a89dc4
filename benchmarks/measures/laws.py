"""Friction over speed: random cells without a proof of a single steady state, and other solvers.

Random cells: up to three masses and as many contacts, laws of up to four segments, belts, mu up to 1.5,
damping ratios down to some thousandths.  Each is followed from rest; counted are statuses and cycles.

Other solvers march one mass from rest, with a falling law that damping outweighs, for the periods after which
a disturbance has decayed to 1e-10.  Errors are those of max z - min z, relative to frictionmap.
"""

from collections import Counter
from pathlib import Path

import numpy as np

import frictionmap as fm

from ..peers.contacts import ContactBody, ContactCell
from ..peers.speed_law import LawHeyoka, LawPeer, LawSolveIvp
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table, timed
from .general.against import periods_needed

#: Random cells, by quick; cycles at most, see `Solver.cycles`.
_CELLS, CYCLES = {False: 10_000, True: 40}, 2000

#: The law of the comparison, its damping ratio, and cells by quick.
LAW = {"speed": [0.0, 0.2, 0.6], "factor": [1.0, 0.8, 0.7], "slope": 0.05}
_ZETA, _COMPARED = 0.15, {False: 10, True: 2}

#: Tolerances of the other solvers.
_TOLERANCES = {LawSolveIvp: (1e-6, 1e-9), LawHeyoka: (1e-6, 1e-9, 2.3e-16)}

_OURS, _THEIRS = {False: 20, True: 2}, {False: 3, True: 1}

_COLOURS = {LawSolveIvp.name: "#b2552f", LawHeyoka.name: "#6f9e3c"}


def random_law(rng: np.random.Generator) -> dict:
    """A law of up to four segments that falls and rises; one segment rises."""
    count = int(rng.integers(1, 5))
    speed = np.concatenate(([0.0], np.cumsum(rng.uniform(0.05, 0.5, count - 1))))
    factor = np.concatenate(([1.0], rng.uniform(0.4, 1.3, count - 1)))
    slope = float(rng.choice([0.0, rng.uniform(0.0, 0.3)]))
    slope = float(rng.uniform(0.02, 0.3)) if count == 1 else slope
    return {"speed": speed.round(3).tolist(), "factor": factor.round(3).tolist(), "slope": round(slope, 3)}


def random_system(rng: np.random.Generator) -> fm.System:
    """A chain with contacts under one or two harmonics."""
    n = int(rng.integers(1, 4))
    count = int(rng.integers(1, n + 1))
    mass, springs = np.diag(rng.uniform(0.6, 1.6, n)), rng.uniform(0.6, 1.6, n)
    stiffness = (
        np.diag(springs + np.append(springs[1:], 0.0)) - np.diag(springs[1:], 1) - np.diag(springs[1:], -1)
    )
    damping = rng.uniform(0.02, 0.15) * stiffness + rng.uniform(0.0, 0.1) * mass
    damping = damping * 0.2 if rng.random() < 0.3 else damping
    contacts = _contacts(rng, n, count)
    loads = {1: rng.normal(size=n) + 1j * rng.normal(size=n)}
    if rng.random() < 0.4:
        loads[int(rng.choice([2, 3]))] = 0.3 * (rng.normal(size=n) + 1j * rng.normal(size=n))
    return fm.System(
        matrices={"M": mass, "C": damping, "K": stiffness}, contacts=contacts, load_harmonics=loads,
        frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip


def _contacts(rng: np.random.Generator, n: int, count: int) -> list[fm.Contact]:
    """Independent contacts; the first one has a law."""
    contacts: list[fm.Contact] = []
    vectors = np.zeros((0, n))
    while len(contacts) < count:
        alone = n == 1 or rng.random() < 0.5
        places = [int(rng.integers(n))] if alone else sorted(rng.choice(n, 2, replace=False).tolist())
        vector = np.zeros(n)
        vector[places[-1]] = 1.0
        if len(places) == 2:
            vector[places[0]] = -1.0
        if np.linalg.matrix_rank(np.vstack((vectors, vector))) <= len(vectors):
            continue
        vectors = np.vstack((vectors, vector))
        belt = len(places) == 1 and rng.random() < 0.4
        more = {"wall_velocity": float(rng.uniform(-0.6, 0.6))} if belt else {}
        mu = float(rng.choice([1.0, 1.0, 1.2, 1.5]))
        law = random_law(rng) if not contacts or rng.random() < 0.7 else None
        kind = "fixed-wall" if len(places) == 1 else "between-masses"
        ratio = float(rng.uniform(0.3, 1.0))
        contacts.append(fm.Contact(kind, [one + 1 for one in places], ratio=ratio, law=law, mu=mu, **more))
    return contacts


def random_cell(seed: int, cycles: int = CYCLES) -> dict[str, int]:
    """Status, period and cycles of a random cell from rest."""
    rng = np.random.default_rng(seed)
    system, r = random_system(rng), float(rng.uniform(0.2, 1.8))
    beta = float(rng.uniform(0.05, 1.0))
    ds = fm.sweep(system, [r], [beta], cycles=cycles, outputs=["regime", "period", "cycles"])
    return {name: int(ds[name].item()) for name in ("status", "regime", "period", "cycles")}


def random_cells(quick: bool) -> dict:
    """Count how random cells end."""
    found = [random_cell(seed) for seed in range(_CELLS[quick])]
    names = {one.value: one.name for one in fm.regimes.STATUSES}
    statuses = Counter(names[one["status"]] for one in found)
    periods = Counter(one["period"] for one in found)
    content = {
        "cells": len(found),
        "cycles at most": max(one["cycles"] for one in found),
        "bound of cycles": CYCLES,
        "status": dict(statuses),
        "period": {str(period): count for period, count in sorted(periods.items())},
        "seeds not reached": [
            seed for seed, one in enumerate(found) if names[one["status"]] == "not_reached"
        ],
    }
    print(
        f"{len(found)} random cells: {dict(statuses)}, at most {content['cycles at most']} cycles", flush=True
    )
    return content


def _sample(quick: bool) -> list[tuple[ContactCell, int, float]]:
    """Cells of one mass that stop, the periods that others march, and the range of z."""
    system = fm.System(damping_ratios=_ZETA, contacts=[fm.Contact("fixed-wall", [1], law=LAW)])
    rng, found = np.random.default_rng(1), []
    while len(found) < _COMPARED[quick]:
        r, beta = float(rng.uniform(0.3, 1.4)), float(rng.uniform(0.1, 0.29))
        ds = fm.sweep(system, [r], [beta], outputs=["contact_peak_to_peak", "multiplier", "unique"])
        if ds.unique.item():
            periods = periods_needed(ds.multiplier.item())
            found.append((ContactCell(r, (beta,)), periods, ds.contact_peak_to_peak.item()))
    return found


def _our_seconds(cells: list, quick: bool) -> dict:
    """Time of a cell in a map of one row, with everything else of the call."""
    system = fm.System(damping_ratios=_ZETA, contacts=[fm.Contact("fixed-wall", [1], law=LAW)])
    r, beta = cells[0][0].r, np.linspace(0.1, 0.29, 400)
    outputs = ["regime", "contact_peak_to_peak"]
    runs = [
        timed(lambda: fm.sweep(system, [r], beta, threads=1, outputs=outputs))[0] for _ in range(_OURS[quick])
    ]
    return spread([seconds / beta.size for seconds in runs])


def _point(peer: LawPeer, cells: list, runs: int) -> dict:
    """Time and errors of one solver at one tolerance."""
    errors, seconds = [], []
    for cell, periods, expected in cells:
        taken = [timed(lambda cell=cell, n=periods: peer.run(cell, n)) for _ in range(runs)]
        seconds.append(min(one for one, _ in taken))
        errors.append(abs(taken[0][1].ranges[0] / expected - 1.0))
    return {"seconds a cell": spread(seconds), "relative errors of ranges": errors}


def other_solvers(quick: bool) -> dict:
    """Time against error of other solvers for the same cells."""
    cells, body = _sample(quick), ContactBody(((1,),), {1: 1.0}, zeta=_ZETA)
    found: dict = {"our seconds a cell": _our_seconds(cells, quick), "methods": {}}
    rows = [("frictionmap", "", found["our seconds a cell"]["median"], 0.0)]
    for kind, tolerances in _TOLERANCES.items():
        if missing := kind.why_missing():
            found["methods"][kind.name] = {"missing": missing}
            continue
        points = []
        for tolerance in tolerances[-1:] if quick else tolerances:
            name = {"rtol": tolerance} if kind is LawSolveIvp else {"tol": tolerance}
            point = _point(kind(body, **LAW, **name), cells, _THEIRS[quick])
            points.append({"tolerance": tolerance, **point})
            error = float(np.median(point["relative errors of ranges"]))
            rows.append((kind.name, tolerance, point["seconds a cell"]["median"], error))
        found["methods"][kind.name] = {"points": points}
    table(("solver", "tolerance", "seconds a cell", "median error"), rows)
    return found


def draw(found: dict, path: Path) -> None:
    """Draw time over error."""
    figure = new_figure(5.0, 3.6)
    axes = figure.subplots()
    for name, entry in found["methods"].items():
        points = [
            (max(float(np.median(one["relative errors of ranges"])), 1e-16), one["seconds a cell"]["median"])
            for one in entry.get("points", ())
        ]
        if points:
            axes.loglog(*zip(*points, strict=True), marker="o", color=_COLOURS[name], label=name)
    axes.axhline(found["our seconds a cell"]["median"], color="#2c5aa0", label="frictionmap, exact")
    axes.set_xlabel("relative error of the range")
    axes.set_ylabel("time per cell [s]")
    axes.set_title("One mass, friction over speed with three segments", fontsize=10)
    axes.legend(fontsize=8)
    axes.grid(alpha=0.25)
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    with pinned():
        content = {"random cells": random_cells(quick), "other solvers": other_solvers(quick)}
    save("laws", content, results)
    draw(content["other solvers"], results / "laws.png")
    return content

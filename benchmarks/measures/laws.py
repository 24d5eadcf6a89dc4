"""Friction over speed, contacts that open, belts without a load: how random cells end, and other solvers.

Random cells: up to three masses and as many contacts, laws of up to four segments, belts, mu up to 1.5,
damping ratios down to some thousandths.  Each is followed from rest; counted are statuses and cycles.

Other solvers march one mass from rest: with constant friction and with a falling law that damping outweighs,
for the periods after which a disturbance has decayed to 1e-10; with a contact that opens; on a belt without a
load, where little damping leaves a cycle.  Errors are those of max z - min z, relative to frictionmap, which
is timed in rows of a map.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import frictionmap as fm

from ..peers.contacts import ContactBody, ContactCell
from ..peers.peer import Peer
from ..peers.siconos import Siconos
from ..peers.slider import Slider, SliderSolveIvp
from ..peers.speed_law import LawHeyoka, LawPeer, LawSolveIvp
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table, timed
from .general.against import periods_needed

#: Random cells, by quick; cycles at most, see `Solver.cycles`.
_CELLS, CYCLES = {False: 10_000, True: 40}, 2000

#: The law of the comparison, its damping ratio, and cells by quick.
LAW: dict = {"speed": [0.0, 0.2, 0.6], "factor": [1.0, 0.8, 0.7], "slope": 0.05}
ZETA, _COMPARED = 0.15, {False: 10, True: 2}

CONSTANT = {"speed": [0.0], "factor": [1.0], "slope": 0.0}

#: Normal stiffness and coefficient of friction of the contact that opens, and the periods that others
#: march; damping ratio of the mass on a belt, and its cycles.
_PRESS, _PHI, _SETTLING = 0.5, 0.3, 40
_LOW_ZETA, _CYCLES = 0.02, 10

#: Cells of a row of a map.
_ROW = 400

_OURS, _THEIRS = {False: 20, True: 2}, {False: 3, True: 1}

_COLOURS = {LawSolveIvp.name: "#b2552f", LawHeyoka.name: "#6f9e3c", Siconos.name: "#8a8a8a"}


class Cell(NamedTuple):
    """A cell for other solvers: what they are given, the periods that they march, the range of z."""

    given: Any
    periods: int
    expected: float


Run = Callable[[Cell], float]
Way = Callable[[float], Run]


class Method(NamedTuple):
    """A solver with a setting that trades time for accuracy, and how a value of it makes a run."""

    kind: type[Peer]
    make: Way
    setting: str
    values: tuple[float, ...]


class Scene(NamedTuple):
    """Cells by quick, a row of a map of the same kind, and solvers."""

    cells: Callable[[bool], Iterator[Cell]]
    row: Callable[[], object]
    methods: tuple[Method, ...]


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


def law_cells(law: dict | None, quick: bool) -> Iterator[Cell]:
    """Cells of one mass under a load, mu = 1, whose steady state is the only one."""
    system = fm.System(damping_ratios=ZETA, contacts=[fm.Contact("fixed-wall", [1], law=law)])
    rng, count = np.random.default_rng(1), 0
    while count < _COMPARED[quick]:
        r, beta = float(rng.uniform(0.3, 1.4)), float(rng.uniform(0.1, 0.29))
        ds = fm.sweep(system, [r], [beta], outputs=["contact_peak_to_peak", "multiplier", "unique", "regime"])
        if ds.unique.item() and ds.regime.item() != fm.regimes.PERMANENT_STICKING:
            periods = periods_needed(ds.multiplier.item())
            count += 1
            yield Cell(ContactCell(r, (beta,)), periods, ds.contact_peak_to_peak.item())


def _opening_slider(r: float, beta: float) -> Slider:
    """One mass whose displacement presses its contact, over the phase of its load."""
    force = beta / _PHI

    def push(t: float, z: float, v: float) -> float:
        normal = max(0.0, force + _PRESS * z)
        return (math.cos(t) - 2.0 * ZETA * r * v - z - (normal - force)) / r**2

    def limit(z: float, _w: float) -> float:
        return _PHI * max(0.0, force + _PRESS * z) / r**2

    return Slider(push, limit, 0.0, (lambda z, _w: force + _PRESS * z,))


def opening_cells(quick: bool) -> Iterator[Cell]:
    """Cells of one mass whose contact opens; the others march until its damping has decayed everything."""
    rng = np.random.default_rng(2)
    for _ in range(_COMPARED[quick]):
        r, beta = float(rng.uniform(0.4, 1.2)), float(rng.uniform(0.05, 0.15))
        ds = fm.sweep(opening_system(), [r], [beta], outputs=["contact_peak_to_peak"])
        yield Cell((_opening_slider(r, beta), 2.0 * math.pi), _SETTLING, ds.contact_peak_to_peak.item())


def _belt_slider(speed: float, beta: float) -> Slider:
    """One mass on a belt under the law, in its natural time."""
    speeds, factors, slope = LAW["speed"], LAW["factor"], LAW["slope"]

    def push(_t: float, z: float, v: float) -> float:
        return -2.0 * _LOW_ZETA * v - z

    def limit(_z: float, w: float) -> float:
        return beta * (float(np.interp(w, speeds, factors)) + slope * max(0.0, w - speeds[-1]))

    bends = tuple(lambda _z, w, bend=bend: w - bend for bend in speeds[1:])
    return Slider(push, limit, speed, bends)


def belt_cells(quick: bool) -> Iterator[Cell]:
    """Cycles of one mass on a belt under the law."""
    rng = np.random.default_rng(3)
    for _ in range(_COMPARED[quick]):
        speed, beta = float(rng.uniform(0.05, 0.2)), float(rng.uniform(0.3, 0.6))
        ds = fm.sweep(belt_system(), wall_speed=[speed], beta=[beta])
        given = _belt_slider(speed, beta), ds.cycle_period.item()
        yield Cell(given, _CYCLES, (ds.z_max - ds.z_min).item())


def opening_system() -> fm.System:
    """One mass whose displacement presses its contact."""
    normal = {"mass": 1, "stiffness": _PRESS, "friction": _PHI}
    return fm.System(damping_ratios=ZETA, contacts=[fm.Contact("fixed-wall", [1], normal=normal)])


def belt_system() -> fm.System:
    """One mass on a belt, with little damping."""
    return fm.System(damping_ratios=_LOW_ZETA, contacts=[fm.Contact("fixed-wall", [1], law=LAW)])


def _with_law(law: dict | None) -> tuple[Method, ...]:
    """Solvers for one mass with friction over speed under a load."""
    body, given = ContactBody(((1,),), {1: 1.0}, zeta=ZETA), law or CONSTANT

    def way(kind: type[LawPeer], name: str) -> Way:
        def make(tolerance: float) -> Run:
            peer = kind(body, **given, **{name: tolerance})
            return lambda cell: peer.run(cell.given, cell.periods).ranges[0]

        return make

    def stepping(steps: float) -> Run:
        peer = Siconos(body, int(steps))
        return lambda cell: peer.run(cell.given, cell.periods).ranges[0]

    found = (
        Method(LawSolveIvp, way(LawSolveIvp, "rtol"), "rtol", (1e-6, 1e-9)),
        Method(LawHeyoka, way(LawHeyoka, "tol"), "tol", (1e-6, 1e-9, 2.3e-16)),
    )
    return found if law else (*found, Method(Siconos, stepping, "steps per period", (64, 256, 1024, 4096)))


def _slider(tolerance: float) -> Run:
    """Run of `SliderSolveIvp` at one tolerance."""

    def run(cell: Cell) -> float:
        slider, period = cell.given
        return SliderSolveIvp(slider, tolerance).range(0.0, period, cell.periods)

    return run


def _scenes() -> dict[str, Scene]:
    """What is compared: cells, a row of a map, solvers."""
    slider = (Method(SliderSolveIvp, _slider, "rtol", (1e-6, 1e-9)),)
    beta, outputs = np.linspace(0.1, 0.29, _ROW), ["regime", "contact_peak_to_peak"]

    def row(system: fm.System, beta: np.ndarray) -> Callable[[], object]:
        return partial(fm.sweep, system, [0.8], beta, threads=1, outputs=outputs)

    found = {
        name: Scene(
            partial(law_cells, law),
            row(fm.System(damping_ratios=ZETA, contacts=[fm.Contact("fixed-wall", [1], law=law)]), beta),
            _with_law(law),
        )
        for name, law in (("constant friction", None), ("friction over speed, three segments", LAW))
    }
    found["contact that opens"] = Scene(opening_cells, row(opening_system(), 0.5 * beta), slider)
    speeds = np.linspace(0.05, 0.2, _ROW)
    belt = partial(fm.sweep, belt_system(), wall_speed=speeds, beta=[0.4], threads=1)
    found["belt without a load, three segments"] = Scene(belt_cells, belt, slider)
    return found


def _point(run: Run, cells: list[Cell], runs: int) -> dict:
    """Time and errors of one solver at one tolerance."""
    errors, seconds = [], []
    for cell in cells:
        taken = [timed(lambda cell=cell: run(cell)) for _ in range(runs)]
        seconds.append(min(one for one, _ in taken))
        errors.append(abs(taken[0][1] / cell.expected - 1.0))
    return {"seconds a cell": spread(seconds), "relative errors of ranges": errors}


def other_solvers(quick: bool) -> dict:
    """Time against error of other solvers for the same cells."""
    found: dict = {}
    rows: list[tuple] = []
    for name, scene in _scenes().items():
        cells = list(scene.cells(quick))
        ours = spread([timed(scene.row)[0] / _ROW for _ in range(_OURS[quick] + 1)][1:])
        found[name] = {"cells": len(cells), "our seconds a cell": ours, "methods": {}}
        rows.append((name, "frictionmap", "", ours["median"], 0.0))
        for method in scene.methods:
            if missing := method.kind.why_missing():
                found[name]["methods"][method.kind.name] = {"skipped": missing}
                continue
            points = []
            for value in method.values[1:2] if quick else method.values:
                point = _point(method.make(value), cells, _THEIRS[quick])
                points.append({"value": value, **point})
                error = float(np.median(point["relative errors of ranges"]))
                label = f"{method.setting} = {value:g}"
                rows.append((name, method.kind.name, label, point["seconds a cell"]["median"], error))
            found[name]["methods"][method.kind.name] = {"setting": method.setting, "points": points}
    table(("cell", "solver", "setting", "seconds a cell", "median error"), rows)
    return found


def draw(content: dict, path: Path) -> None:
    """Draw time over error, a panel per scene."""
    figure = new_figure(10.0, 7.0)
    for axes, (name, found) in zip(figure.subplots(2, 2).flat, content.items(), strict=True):
        for solver, entry in found["methods"].items():
            points = [
                (
                    max(float(np.median(one["relative errors of ranges"])), 1e-16),
                    one["seconds a cell"]["median"],
                )
                for one in entry.get("points", ())
            ]
            if points:
                axes.loglog(*zip(*points, strict=True), marker="o", color=_COLOURS[solver], label=solver)
        axes.axhline(found["our seconds a cell"]["median"], color="#2c5aa0", label="frictionmap, exact")
        axes.set(xlabel="relative error of the range", ylabel="time per cell [s]")
        axes.set_title(f"One mass, {name}", fontsize=10)
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

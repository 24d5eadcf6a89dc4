"""Error against run time: the search of S, steady states by every method, and the number of scan steps.

Steady states. Random stick-slip cells in scenes of low and high frequency, both contacts, mu = 1 and above,
one mass and three. Every method marches `CYCLES` excitation periods from rest and reports the last one. The
exception is "frictionmap", the package with its default method, which ends when the steady state is found.
Only cells that repeat every excitation period are used, and only if their Floquet multipliers show that the
transient has decayed by then. The remaining error is that of the method. It is measured against 40-digit
orbits (`references.periodic_orbit`). Other solvers of one mass get the end of a stop in closed form (an
arccos), which favours them; fixed-step methods search for it. Siconos is in `laws`; its method,
Moreau-Jean time stepping, is implemented in `fixed_step`. The times are those of the cells alone; the time of
the curves at the frequency of a cell is given separately.

Random cells. 20,000 cells of one mass through the public interface at the default settings, compared with an
independent event-exact code (`settled.settle`).

Scan steps. Time for an open cell against `steps`.
"""

import math
import statistics
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

import frictionmap as fm
from frictionmap import regimes
from frictionmap.model.settings import Solver
from frictionmap.theory.boundary_curves import find_curves

from ..peers.body import TWO_PI, load_in_contact
from ..peers.cvode import OneMassCvode
from ..peers.fixed_step import Problem, march_rk4
from ..peers.heyoka import OneMassHeyoka
from ..peers.solve_ivp import OneMassSolveIvp
from ..references.periodic_orbit import DIGITS, Orbit, periodic_orbit
from ..references.settled import settle
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table, timed
from . import search_of_s
from .methods import MARCHED, METHODS, SOLVED, STEPS, Answer, Method, Scene, open_cells

#: Excitation periods that are marched.
CYCLES = 100

#: What the transient may have left after them, by the Floquet multipliers.
SETTLED = 1e-15

#: Steps a period of the fixed-step march that leads to the reference.
APPROACH = 2000

SCENES = (
    Scene("fixed wall, r 0.1-0.2, mu = 1", "fixed-wall", 1, (0.1, 0.2), 1.0, 0.0),
    Scene("fixed wall, r 1.5-2, mu = 1", "fixed-wall", 1, (1.5, 2.0), 1.0, 0.0),
    Scene("base-wall, r 0.1-0.2, mu = 1", "joined-base-wall", 1, (0.1, 0.2), 1.0, 0.0),
    Scene("base-wall, r 1.5-2, mu = 1", "joined-base-wall", 1, (1.5, 2.0), 1.0, 0.0),
    Scene("fixed wall, r 0.3-0.8, mu = 1.5", "fixed-wall", 1, (0.3, 0.8), 1.5, 0.0),
    Scene("3 masses, r 0.2-1.5, mu = 1", "fixed-wall", 3, (0.2, 1.5), 1.0, 0.05),
)
QUICK_SCENES = (1, 5)

#: A stop count is wrong if it is not the reference's.  Event times are compared where it is right; Z always.
WRONG = "cells with wrong stop counts"


# ---------------------------------------------------------------- cells and their references


def _reference(problem: Problem) -> Orbit | None:
    """Periodic orbit of one excitation period that a march from rest reaches; None if there is none."""
    near = march_rk4(problem, APPROACH, CYCLES, True)
    if not near.velocity.any():
        return None
    try:
        return periodic_orbit(problem, near.tau, near.place, near.velocity)
    except ArithmeticError:  # a grazing event, or a return map that has no single fixed point there
        return None


def sample_scene(scene: Scene, count: int, rng: np.random.Generator) -> tuple[list, list[Orbit], dict]:
    """Draw cells (r, beta), sorted by r, with their orbits; count the cells left out by reason."""
    system = scene.system
    found: list[tuple[tuple[float, float], Orbit]] = []
    left_out = {"no such orbit from rest, or a longer period": 0, "no stops": 0, "not settled in time": 0}
    while len(found) < count:
        r = float(rng.uniform(*scene.frequencies))
        ends = fm.boundaries(system, [r], scene.mu)
        low, high = ends.beta_lim.item(), ends.beta_stick.item()
        beta = float(rng.uniform(low, max(low, high)))
        if not low < beta < high:
            continue
        problem = scene.problem(r, beta)
        orbit = _reference(problem)
        if orbit is None:
            left_out["no such orbit from rest, or a longer period"] += 1
        elif not orbit.stops:
            left_out["no stops"] += 1
        elif orbit.multiplier**CYCLES > SETTLED:
            left_out["not settled in time"] += 1
        else:
            found.append(((r, beta), orbit))
    found.sort(key=lambda pair: pair[0])
    return [cell for cell, _ in found], [orbit for _, orbit in found], left_out


def time_error(begins: list[float], exact: list[float]) -> float:
    """Largest distance, on the circle, from an exact event time to the nearest one found."""
    return max(
        min(abs((mine - one + math.pi) % TWO_PI - math.pi) for mine in begins) for one in exact
    )  # fmt: skip


def digits(error: float) -> float:
    """Round an error to three digits."""
    return float(f"{error:.3g}")


def judge(answers: list[Answer], orbits: list[Orbit]) -> dict:
    """Count wrong stop counts; errors of Z (relative) and of event times where the count is right."""
    wrong = 0
    amplitudes, times = [], []
    for answer, orbit in zip(answers, orbits, strict=True):
        if answer.stops != orbit.stops:
            wrong += 1
        elif answer.begins:
            times.append(digits(time_error(answer.begins, orbit.begins)))
        if math.isfinite(answer.amplitude):
            amplitudes.append(digits(abs(answer.amplitude - orbit.amplitude) / orbit.amplitude))
    return {
        WRONG: wrong,
        "relative errors of Z": amplitudes,
        "errors of event times": times,
    }


# ---------------------------------------------------------------- steady states by every method


def _prepare(scene: Scene, cells: list, quick: bool, content: dict) -> list[tuple[Method, float, tuple]]:
    """Prepare every available method at every setting for a scene; record the others as skipped."""
    ready = []
    for method in METHODS:
        why = method.why_not(scene)
        if why:
            print(f"{scene.name}: {method.name}: skipped, {why}")
            content.setdefault("skipped", {})[method.name] = why
            continue
        for setting in method.quick if quick else method.settings:
            ready.append((method, setting, method.prepare(scene, cells, setting, CYCLES)))
    return ready


def compare_scene(scene: Scene, count: int, quick: bool, rng: np.random.Generator) -> dict:
    """Measure seconds per cell and errors of all methods in one scene."""
    cells, orbits, left_out = sample_scene(scene, count, rng)
    content: dict = {
        "cells": [{"r": r, "beta": beta} for r, beta in cells],
        "reference": [
            {"stops": o.stops, "Z": o.amplitude, "multiplier": o.multiplier, "residual": o.residual}
            for o in orbits
        ],
        "cells left out": left_out,
        "methods": {},
    }  # fmt: skip
    ready = _prepare(scene, cells, quick, content)
    seconds: list[list[float]] = [[] for _ in ready]
    answers: list[list[Answer]] = [[] for _ in ready]
    for name in (SOLVED, MARCHED):  # compiles
        next(solve for method, _, (solve, _, _) in ready if method.name == name)()
    for turn in range(1 if quick else 5):  # alternating: all see the same machine
        for k, (method, _, (solve, read, cells_a_call)) in enumerate(ready):
            if method.slow and turn >= 2:
                continue
            taken, raw = timed(solve)
            seconds[k].append(taken / cells_a_call)
            answers[k] = read(raw) if turn == 0 else answers[k]
    for k, (method, setting, _) in enumerate(ready):
        entry = content["methods"].setdefault(method.name, {"setting": method.setting, "points": []})
        entry["points"].append(
            {method.setting: setting, "seconds a cell": spread(seconds[k]), **judge(answers[k], orbits)}
        )
    r = np.linspace(*scene.frequencies, 500)
    find_curves(scene.system, r[:2], np.array([scene.mu]))
    content["our seconds a frequency for the curves, not counted"] = spread(
        [timed(lambda: find_curves(scene.system, r, np.array([scene.mu])))[0] / r.size for _ in range(3)]
    )
    return content


def steady_states(quick: bool) -> dict:
    """Compare all methods in all scenes."""
    rng = np.random.default_rng(5)
    found = {}
    for index, scene in enumerate(SCENES):
        if quick and index not in QUICK_SCENES:
            continue
        found[scene.name] = compare_scene(scene, 1 if quick else 4, quick, rng)
        print_scene(scene.name, found[scene.name])
    return found


def print_scene(name: str, content: dict) -> None:
    """Print a table of the best and the default settings."""
    print(f"\n{name}: {len(content['cells'])} cells, left out {content['cells left out']}")
    rows = []
    for method, entry in content["methods"].items():
        for point in entry["points"]:
            z, times = point["relative errors of Z"], point["errors of event times"]
            rows.append(
                (
                    method, f"{entry['setting']} {point[entry['setting']]:g}",
                    1e6 * point["seconds a cell"]["median"], statistics.median(z) if z else "-",
                    max(z, default="-"), max(times, default="-"), point[WRONG],
                )
            )  # fmt: skip
    table(("method", "setting", "us/cell", "Z median", "Z largest", "times largest", "wrong"), rows)


# ---------------------------------------------------------------- random cells


CONTACTS = ("fixed-wall", "joined-base-wall")
MUS = (1.0, 1.0, 1.2, 1.5, 2.0)
ZETAS = (0.0, 0.0, 0.01, 0.05, 0.3, 1.2)
OUTPUTS = ("regime", "stops_per_cycle", "contact_amplitude", "period", "status")

#: The reference marches so many periods, and wants so little left to come, relative to Z.
MOST_CYCLES = 4000
REMAINS = 1e-12


def random_cells(quick: bool) -> dict:
    """Compare stop counts and amplitudes of random cells at default settings with the event-exact code."""
    rng = np.random.default_rng(20_000)
    wanted = 100 if quick else 20_000
    count = unsettled = unresolved = 0
    kinds = {"stuck": 0, "stick-slip": 0, "continuous": 0}
    wrong, errors, scaled = [], [], []
    worst: dict = {}
    while count < wanted:
        contact, mu, zeta = str(rng.choice(CONTACTS)), float(rng.choice(MUS)), float(rng.choice(ZETAS))
        r = float(rng.uniform(0.05, 2.5))
        load, phase = load_in_contact(contact, r, zeta)
        beta = float(rng.uniform(0.01, 1.05)) * load / mu
        exact = settle(r, zeta, load, phase, beta, mu, MOST_CYCLES, REMAINS)
        if not exact.period:
            unsettled += 1
            continue
        system = fm.System(contact=contact, damping_ratios=zeta)
        ds = fm.sweep(system, [r], [beta], mu, outputs=OUTPUTS, threads=1).squeeze()
        if int(ds.status) != regimes.RESOLVED:
            unresolved += 1
            continue
        count += 1
        stops, z = float(ds.stops_per_cycle), float(ds.contact_amplitude)
        stuck = math.isnan(exact.stops)
        kinds["stuck" if stuck else "stick-slip" if exact.stops else "continuous"] += 1
        where = {"contact": contact, "r": r, "beta": beta, "mu": mu, "zeta": zeta}
        if np.float32(exact.stops) != np.float32(stops) and not (stuck and math.isnan(stops)):
            ends = [float(ds.beta_lim), float(ds.beta_stick)]
            wrong.append(
                {
                    **where, "exact stops": exact.stops, "stops": stops, "exact Z": exact.amplitude, "Z": z,
                    "relative distance to the nearest boundary": min(abs(beta / end - 1.0) for end in ends),
                    "shortest stop": exact.shortest, "periods marched": exact.cycles,
                }
            )  # fmt: skip
        elif not stuck:
            errors.append(abs(z - exact.amplitude) / exact.amplitude)
            scaled.append(abs(z - exact.amplitude) / max(exact.amplitude, load))
            if errors[-1] == max(errors):
                worst = {**where, "exact Z": exact.amplitude, "Z": z, "periods marched": exact.cycles}
    print(
        f"\n{count} random cells ({kinds}): {len(wrong)} wrong stop counts; error of Z: median "
        f"{statistics.median(errors):.1e}, largest {max(errors):.1e}; besides, {unsettled} that the "
        f"reference did not settle in {MOST_CYCLES} periods, {unresolved} that the package left unresolved"
    )
    return {
        "cells": count,
        "regimes": kinds,
        WRONG: len(wrong),
        "the cells that differ": wrong,
        "relative error of Z": {
            "median": statistics.median(errors),
            "99 % below": float(np.quantile(errors, 0.99)),
            "largest": max(errors),
            "where": worst,
            "largest, over the load in the contact where Z is smaller": max(scaled),
        },
        "left out, not settled by the reference": unsettled,
        "left out, with a status of the package": unresolved,
    }


# ---------------------------------------------------------------- scan steps


#: What the cells of `scan_steps` keep.
KEPT = ("stops_per_cycle", "contact_amplitude", "status")


def _open_sample(scene: Scene, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, int]:
    """Draw random cells between the boundaries, sorted by r; count those without a periodic steady state."""
    r = np.sort(rng.uniform(0.1, 2.0, 4 * count))
    ends = fm.boundaries(scene.system, np.unique(r), scene.mu)
    low, high = ends.beta_lim.values[0], ends.beta_stick.values[0]
    beta = low + rng.uniform(0.0, 1.0, r.size) * (high - low)
    chosen = np.flatnonzero(beta > low)
    chosen = np.sort(rng.choice(chosen, min(count, chosen.size), replace=False))
    r, beta = r[chosen], beta[chosen]
    solve, read = open_cells(scene.system, r, beta, scene.mu, Solver(outputs=KEPT))
    solve()
    resolved = read()[2] == regimes.RESOLVED
    return r[resolved], beta[resolved], int((~resolved).sum())


def scan_steps(quick: bool) -> dict:
    """Measure the seconds per open cell over `steps`, and the difference of Z from that with most steps."""
    rng = np.random.default_rng(24)
    settings = (2, 8, 12, 16, 24, 48, 200) if quick else STEPS
    found = {}
    for index in (0, 2, 4, 5):
        scene = SCENES[index]._replace(name=_SHORT[index])
        masses = scene.masses
        r, beta, left_out = _open_sample(
            scene, (20 if quick else 200) if masses > 1 else (100 if quick else 1000), rng
        )
        ready = [open_cells(scene.system, r, beta, scene.mu, Solver(steps=n, outputs=KEPT)) for n in settings]
        ready[0][0]()  # compiles
        times: list[list[float]] = [[] for _ in settings]
        for _ in range(7 if quick else 25):
            for k, (solve, _) in enumerate(ready):
                times[k].append(timed(solve)[0] / r.size)
        finest = ready[-1][1]()
        points = []
        for n, (_, read), taken in zip(settings, ready, times, strict=True):
            stops, z, status = read()
            points.append(
                {
                    "steps": n,
                    "seconds a cell": spread(taken),
                    "cells with other stop counts": int((~_same(stops, finest[0])).sum()),
                    "largest relative difference of Z": float(_difference(z, finest[1])),
                    "cells without a steady state": int((status != regimes.RESOLVED).sum()),
                }
            )
        medians = [statistics.median(taken) for taken in times]
        least = [min(taken) for taken in times]
        best = int(np.argmin(medians))
        default = settings.index(24)
        found[scene.name] = {
            "cells": r.size,
            "cells left out, without a steady state at the default": left_out,
            "points": points,
            "best steps by time": settings[best],
            "time at the default 24 over the best": medians[default] / medians[best],
            "best steps by least time": settings[int(np.argmin(least))],
            "least time at the default 24 over the best": least[default] / min(least),
        }
        print(
            f"{scene.name}: {r.size} open cells, best steps {settings[best]} "
            f"({1e6 * medians[best]:.3g} us a cell); 24: {1e6 * medians[default]:.3g} us"
        )
    return found


_SHORT = {
    0: "one mass, fixed wall",
    2: "one mass, base-wall",
    4: "one mass, mu = 1.5",
    5: "three masses",
}


def _same(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a == b) | (np.isnan(a) & np.isnan(b))


def _difference(a: np.ndarray, b: np.ndarray) -> float:
    """Largest relative difference where both values are positive and finite."""
    both = (a > 0.0) & (b > 0.0) & np.isfinite(a) & np.isfinite(b)
    return (np.abs(a - b)[both] / b[both]).max(initial=0.0)


# ---------------------------------------------------------------- picture


COLOURS = {
    SOLVED: "#d62728",
    MARCHED: "#ff9896",
    "RK4, events located": "#1f77b4",
    "RK4": "#7fb2dd",
    "Moreau-Jean": "#2ca02c",
    "solve_ivp DOP853": "#9467bd",
    "heyoka": "#111111",
    "CVODE": "#b8860b",
}
FLOOR = 1e-16


def _style(method: str) -> dict:
    """Line style: points for frictionmap, whose time and error hardly depend on the setting; else curves."""
    if method in (SOLVED, MARCHED):
        return {"marker": "D", "markersize": 6, "linestyle": "none", "zorder": 3}
    return {"marker": "o", "markersize": 4, "linewidth": 1.2, "zorder": 2}


def pooled(scenes: list[dict], method: str, value: Callable[[dict], list[float]]) -> tuple[list, list]:
    """Seconds per cell and the median of a value over all cells of some scenes, by setting."""
    points: dict[float, tuple[list, list]] = {}
    for scene in scenes:
        entry = scene["methods"].get(method)
        for point in entry["points"] if entry else ():
            seconds, values = points.setdefault(point[entry["setting"]], ([], []))
            seconds.append(point["seconds a cell"]["median"])
            values.extend(value(point))
    kept = [(statistics.mean(s), max(statistics.median(v), FLOOR)) for s, v in points.values() if v]
    return [s for s, _ in kept], [v for _, v in kept]


def _error_panel(axes: Axes, scenes: list[dict], key: str, title: str) -> None:
    for method, colour in COLOURS.items():
        x, y = pooled(scenes, method, lambda point: point[key])
        if x:
            axes.loglog(x, y, color=colour, label=method, **_style(method))
    axes.set_ylim(FLOOR / 2, 1.0)
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("time for one cell [s]")
    axes.grid(alpha=0.25)


def _wrong_panel(axes: Axes, scenes: list[dict]) -> None:
    for method, colour in COLOURS.items():
        points: dict[float, list] = {}
        for scene in scenes:
            entry = scene["methods"].get(method)
            for point in entry["points"] if entry else ():
                row = points.setdefault(point[entry["setting"]], [[], 0, 0])
                row[0].append(point["seconds a cell"]["median"])
                row[1] += point[WRONG]
                row[2] += len(scene["cells"])
        if points:
            x = [statistics.mean(row[0]) for row in points.values()]
            y = [100.0 * row[1] / row[2] for row in points.values()]
            axes.semilogx(x, y, color=colour, clip_on=False, **_style(method))
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time for one cell [s]")
    axes.set_ylabel("cells with wrong stop count [%]")
    axes.set_title("Wrong stop counts, all scenes", fontsize=10)
    axes.grid(alpha=0.25)


def _search_panel(axes: Axes, found: dict) -> None:
    for (name, entry), colour in zip(found.items(), ("#1f77b4", "#2ca02c"), strict=True):
        rows = entry["grid"].values()
        x = [row["seconds"]["median"] for row in rows]
        y = [max(row["relative error of S"]["largest"], FLOOR) for row in rows]
        axes.loglog(x, y, "o-", color=colour, markersize=4, label=f"grid, {name}")
        kernel = entry["kernel"]
        axes.loglog(
            kernel["seconds"]["median"], max(kernel["relative error of S"]["largest"], FLOOR), "D",
            color="#d62728", markerfacecolor=colour, markeredgewidth=2, markersize=8,
            label=f"frictionmap, {name}",
        )  # fmt: skip
    axes.set_ylim(FLOOR / 2, 1.0)
    axes.set_xlabel("time for one frequency [s]")
    axes.set_ylabel("largest relative error of S")
    axes.set_title("Search of S: 16 to 100,000 grid points", fontsize=10)
    axes.legend(fontsize=8, loc="lower right")
    axes.grid(alpha=0.25)


def _steps_panel(axes: Axes, found: dict) -> None:
    for (name, entry), colour in zip(
        found.items(), ("#1f77b4", "#2ca02c", "#9467bd", "#b8860b"), strict=True
    ):
        x = [point["steps"] for point in entry["points"]]
        y = [1e6 * point["seconds a cell"]["median"] for point in entry["points"]]
        axes.loglog(x, y, "o-", color=colour, markersize=4, label=name)
    axes.axvline(24, color="#d62728", linestyle="--", linewidth=1.0)
    axes.set_ylim(top=8.0 * axes.get_ylim()[1])
    axes.text(25.5, 0.3, "default", color="#d62728", fontsize=9, transform=axes.get_xaxis_transform())
    ticks = (2, 4, 8, 16, 24, 48, 100, 200)
    axes.set_xticks(ticks, [str(n) for n in ticks])
    axes.minorticks_off()
    axes.set_xlabel("scan steps per fastest period")
    axes.set_ylabel("time for one open cell [$\\mu$s]")
    axes.set_title("Time against scan steps: same answers", fontsize=10)
    axes.legend(fontsize=7)
    axes.grid(alpha=0.25)


def draw(content: dict, path: Path) -> None:
    """Draw error against time for one mass and three, wrong stop counts, the search of S, and scan steps."""
    scenes = content["steady states"]
    one = [entry for name, entry in scenes.items() if not name.startswith("3 masses")]
    three = [entry for name, entry in scenes.items() if name.startswith("3 masses")]
    figure = new_figure(13.0, 8.4)
    axes = figure.subplots(2, 3)
    figure.suptitle(
        "frictionmap gets to rounding error in the least time (lower left is better, one point a setting)",
        fontsize=13,
    )
    _error_panel(axes[0, 0], one, "relative errors of Z", "Amplitude, one mass")
    axes[0, 0].set_ylabel("median relative error of Z")
    _error_panel(axes[0, 1], three, "relative errors of Z", "Amplitude, three masses")
    axes[0, 1].set_ylabel("median relative error of Z")
    _error_panel(axes[0, 2], one + three, "errors of event times", "Times at which stops begin, all scenes")
    axes[0, 2].set_ylabel("median of a cell's error [rad of the load]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=8, fontsize=9)
    _wrong_panel(axes[1, 0], one + three)
    _search_panel(axes[1, 1], content["search of S"])
    _steps_panel(axes[1, 2], content["scan steps"])
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    with pinned():
        content = {
            "periods marched": CYCLES,
            "digits of the references": DIGITS,
            "versions of the peers": {
                peer.name: peer.version()
                for peer in (OneMassSolveIvp, OneMassHeyoka, OneMassCvode)
                if not peer.why_missing()
            },
            "search of S": search_of_s.measure(quick),
            "steady states": steady_states(quick),
            "scan steps": scan_steps(quick),
            "random cells": random_cells(quick),
        }
    save("accuracy", content, results)
    draw(content, results / "accuracy.png")
    return content

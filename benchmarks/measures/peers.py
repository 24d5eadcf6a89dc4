"""One mass by every solver: the same cells, alternating, one thread each; results are checked while timed.

Cells. Random moving cells of the open strip of T Fig. 3.12. The other solvers integrate 200 excitation
periods, as in the thesis. frictionmap ends when the steady state is found, and computes all constants of a
cell again. A round runs all cells with the other solver and all with frictionmap. The reported time is the
median of the means of the rounds, and the compared results are those of the timed calls. Compilation and
imports are done before (see `startup`).

Map. The time of another solver for the whole of T Fig. 3.12 is extrapolated from a random sample of its
cells, including stuck ones. frictionmap computes the whole map.

Solved and marched. The kernels with Newton's method on the return map, and without it (`steady = "marched"`),
for open cells and for continuous ones next to a resonance, which the default settings do not integrate. One
mass, and the chain of T Fig. 6.17.

Settings of the other solvers. heyoka runs with the settings that its documentation recommends for speed and
that were the fastest here (`peers.heyoka` lists them): one compiled program for all cells with their numbers
as parameters, fast_math, machine precision, terminal events, propagate_until. Its batch mode advances several
cells in one SIMD program. It is a separate solver here (`heyoka_batch`), with the logic of stops on whole
arrays. Its ensemble mode copies the integrator for each propagation and distributes them over processors. It
is not used, because all comparisons use one processor, and a propagation ends with each slide. For five
masses, see `structures`.
"""

import math
import statistics
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import frictionmap as fm
from frictionmap import regimes
from frictionmap._kernels.engine.march import steady_state
from frictionmap._kernels.engine.motion import at_frequency, contact_at, start
from frictionmap._kernels.engine.one_mass import Frequencies, OneMassSystem
from frictionmap._kernels.engine.records import Limits
from frictionmap.model.settings import Solver
from frictionmap.single.maps import Arrays
from frictionmap.theory.boundary_curves import one_mass_curves

from ..peers.body import Body, Cell, Outcome
from ..peers.heyoka import OneMassHeyoka
from ..peers.heyoka_batch import FEW_LANES, HeyokaBatch
from ..peers.peer import Peer
from ..peers.solve_ivp import OneMassSolveIvp
from ..report.figures import new_figure, save_figure
from ..report.quoting import two_digits
from ..report.record import pinned, save, spread, table, timed
from .own_entry import own_entry
from .own_kernel import cells_by_kernel
from .structures import SMALL_Z, equal_chain

PEERS = (OneMassSolveIvp, OneMassHeyoka, HeyokaBatch)

#: What T Fig. 3.12 shows.
BODY = Body(wall="joined-base-wall")
CYCLES = 200
R = np.arange(126) * 2 / 100
BETA = np.arange(401) / 100

#: Cells and rounds of each peer, in full and in quick.
COUNTS = {
    "solve_ivp RK45": ((20, 3), (2, 1)),
    "heyoka": ((200, 7), (20, 2)),
    "heyoka, batch": ((1000, 3), (256, 1)),
}


@own_entry
def solve_cells(system, beta, mu, limits):
    """Compute stops and amplitude of single cells, one per frequency, with all constants computed again."""
    cancel = np.zeros(1, dtype=np.uint8)
    out = np.empty((beta.size, 2))
    for k in range(beta.size):
        motion = at_frequency(system, k)
        contact = contact_at(system, 0, k, beta[k], mu[k])
        at = start(motion, system, k, contact, False)
        cell = steady_state(motion, contact, at, False, limits, cancel)
        out[k, 0] = cell.stops
        out[k, 1] = cell.amplitude * motion.load
    return out


def prepare(cells: list[Cell]) -> tuple:
    """Arguments of `solve_cells`."""
    system = fm.System(contact=BODY.wall, damping_ratios=BODY.zeta)
    found = [one_mass_curves(system, np.array([cell.r]), np.array([cell.mu])) for cell in cells]
    columns = zip(*(one.frequencies for one in found), strict=True)
    frequencies = Frequencies(*(np.concatenate(column) for column in columns))
    lim = np.hstack([one.lim for one in found])
    stick = np.hstack([one.curves.beta_stick for one in found])
    beta, mu = (np.array([getattr(cell, name) for cell in cells]) for name in ("beta", "mu"))
    return (
        OneMassSystem(frequencies, BODY.zeta, 24.0, lim, stick, 1, 1.0), beta, mu,
        Limits(2000.0, 1e-12, True, math.inf),
    )  # fmt: skip


def sample_cells(count: int, moving: bool, rng: np.random.Generator, mu: float = 1.0) -> list[Cell]:
    """Random cells of the map of T Fig. 3.12; with `moving`, of its open strip."""
    found = []
    while len(found) < count:
        r, beta = float(rng.choice(R[1:])), float(rng.choice(BETA[1:]))
        if not moving or beta < r * r / mu:
            found.append(Cell(r, beta, mu))
    return found


def _compare(ours: np.ndarray, theirs: list[Outcome], cells: list[Cell]) -> dict:
    """Compare results: cells with other stop counts, and the median difference of the amplitude."""
    other = [
        {"contact": BODY.wall, **cell._asdict(), "zeta": BODY.zeta}
        for (stops, _), (their_stops, _), cell in zip(ours, theirs, cells, strict=True)
        if stops != their_stops and not (math.isnan(stops) and math.isnan(their_stops))
    ]
    errors = [
        abs(z - their_z) / z
        for (_, z), (_, their_z) in zip(ours, theirs, strict=True)
        if 0.0 < z < math.inf and math.isfinite(their_z)
    ]
    return {
        "cells with other stop counts": len(other),
        "which": other,
        "median relative difference of Z": statistics.median(errors) if errors else None,
    }


# ---------------------------------------------------------------- cells


def against(make: Callable[[Body], Peer], cells: list[Cell], rounds: int) -> dict:
    """Time one solver on some cells, alternating with frictionmap."""
    began = perf_counter()
    peer = make(BODY)
    set_up = perf_counter() - began
    arguments = prepare(cells)
    solve_cells(*prepare(cells[:1]))  # compiles
    peer.run_all(cells[:1], CYCLES)
    seconds_theirs, seconds_ours, theirs, ours = [], [], [], np.empty((0, 2))
    for _ in range(rounds):
        taken, theirs = timed(lambda: peer.run_all(cells, CYCLES))
        seconds_theirs.append(taken / len(cells))
        for _ in range(3):
            taken, ours = timed(lambda: solve_cells(*arguments))
            seconds_ours.append(taken / len(cells))
    return {
        "version": peer.version(),
        "set-up seconds": set_up,
        "cells": len(cells),
        "seconds a cell": spread(seconds_theirs),
        "our seconds a cell": spread(seconds_ours),
        "ratio": statistics.median(seconds_theirs) / statistics.median(seconds_ours),
        "differences": _compare(ours, theirs, cells),
    }


class _Clocked:
    """Integrator of heyoka with a clock on `propagate_until`."""

    def __init__(self, integrator: Any) -> None:
        self.integrator = integrator
        self.seconds = 0.0

    @property
    def time(self) -> float:
        """Time of the integrator."""
        return self.integrator.time

    @time.setter
    def time(self, value: float) -> None:
        self.integrator.time = value

    def propagate_until(self, end: float) -> None:
        """Propagate with the integrator, timed."""
        began = perf_counter()
        self.integrator.propagate_until(end)
        self.seconds += perf_counter() - began


def share_in_integrator(cells: list[Cell]) -> float:
    """Share of heyoka's time inside its integrator; the rest is the logic of stops around it, in Python."""
    peer = OneMassHeyoka(BODY)
    total = timed(lambda: peer.run_all(cells, CYCLES))[0]
    peer.integrator = clocked = _Clocked(peer.integrator)
    peer.run_all(cells, CYCLES)
    return clocked.seconds / total


def single_cells(quick: bool, rng: np.random.Generator) -> dict:
    """Measure and print moving cells by every solver."""
    content: dict = {}
    rows = []
    for peer_class in PEERS:
        why = peer_class.why_missing()
        if why:
            print(f"{peer_class.name}: skipped, {why}")
            content[peer_class.name] = {"skipped": why}
            continue
        count, rounds = COUNTS[peer_class.name][quick]
        few = quick and peer_class is HeyokaBatch
        make = partial(HeyokaBatch, lanes=FEW_LANES) if few else peer_class
        found = against(make, sample_cells(count, True, rng), rounds)
        if peer_class is OneMassHeyoka:
            found["share of the time in the integrator"] = share_in_integrator(sample_cells(count, True, rng))
        content[peer_class.name] = found
        differences = found["differences"]
        rows.append(
            (
                f"{peer_class.name} {found['version']}", count, 1e6 * found["seconds a cell"]["median"],
                1e6 * found["our seconds a cell"]["median"], f"{found['ratio']:,.0f}",
                differences["cells with other stop counts"], differences["median relative difference of Z"],
            )
        )  # fmt: skip
    table(("moving cells of Fig. 3.12", "cells", "us", "ours, us", "ratio", "other stops", "Z off by"), rows)
    return content


# ---------------------------------------------------------------- map


def whole_map(quick: bool, rng: np.random.Generator) -> dict:
    """The published map, mu = 1 and 1.5, against heyoka extrapolated from random cells of it."""
    system = fm.System(contact=BODY.wall)
    found: dict = {}
    why = OneMassHeyoka.why_missing()
    peer = None if why else OneMassHeyoka(BODY)
    for mu in (1.0, 1.5):
        fm.sweep(system, R[10:12], BETA[5:40], mu, threads=1)  # compiles
        cells = sample_cells(20 if quick else 4000, False, rng, mu)  # costs of cells differ a lot
        ours: list[float] = []
        theirs = np.zeros(len(cells))
        for k, cell in enumerate(cells):  # alternating: a run of ours after some cells of theirs
            if peer is not None:
                theirs[k] = timed(lambda c=cell, p=peer: p.run(c, CYCLES))[0]
            if k % (10 if quick else 100) == 0:
                ours.append(timed(lambda m=mu: fm.sweep(system, R, BETA, m, threads=1))[0])
        entry: dict = {"cells": R.size * BETA.size, "seconds": spread(ours)}
        if peer is None:
            entry["heyoka"] = {"skipped": why}
        else:
            total = float(theirs.mean()) * entry["cells"]
            entry["heyoka, extrapolated from random cells"] = {
                "cells": len(cells),
                "seconds": total,
                "standard error of the sample": float(theirs.std(ddof=1) / math.sqrt(len(cells)))
                * entry["cells"],
            }
            entry["ratio"] = total / statistics.median(ours)
        found[f"mu = {mu:g}"] = entry
    if peer is None:
        print(f"map by heyoka: skipped, {why}")
        return found
    table(
        ("map of Fig. 3.12", "cells", "seconds", "heyoka, extrapolated", "from cells", "ratio"),
        [
            (
                name, entry["cells"], entry["seconds"]["median"],
                entry["heyoka, extrapolated from random cells"]["seconds"],
                entry["heyoka, extrapolated from random cells"]["cells"], f"{entry['ratio']:,.0f}",
            )
            for name, entry in found.items()
        ],
    )  # fmt: skip
    return found


# ---------------------------------------------------------------- solved and marched

MARCHED_CYCLES = {False: 200_000, True: 2_000}  # by quick
OPEN_CELLS = {False: 60, True: 10}
NEARNESS = (1e-2, 1e-3, 1e-4)  # to resonance, relative
BELOW_LIM = (0.05, 0.01)  # beta under beta_lim, relative
LARGEST_BETA = 4.0
LEAST_RUNS, MOST_RUNS = 3, 200

OPEN, NEAR = "open cells", "continuous cells next to resonance"


def _open_cells(system: fm.System, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Random r and beta between beta_lim and beta_stick."""
    r = np.sort(rng.uniform(0.1, 2.5, 4 * count))
    ends = fm.boundaries(system, r)
    low, high = ends.beta_lim.values[0], np.minimum(ends.beta_stick.values[0], LARGEST_BETA)
    keep = np.flatnonzero(low < high)
    keep = np.sort(rng.choice(keep, count, replace=False))
    return r[keep], rng.uniform(low[keep], high[keep])


def _near_cells(system: fm.System, quick: bool) -> tuple[np.ndarray, np.ndarray]:
    """r next to the first natural frequency on both sides, beta slightly below beta_lim."""
    nearness = NEARNESS[:1] if quick else NEARNESS
    off = np.sort([sign * near for near in nearness for sign in (-1.0, 1.0)])
    r = float(system.modes.w[0]) * (1.0 + off)
    lim = fm.boundaries(system, r).beta_lim.values[0]
    shares = 1.0 - np.array(BELOW_LIM)
    return np.repeat(r, shares.size), (lim[:, np.newaxis] * shares).ravel()


def _by_kernel(
    system: fm.System, r: np.ndarray, beta: np.ndarray, steady: str, cycles: int
) -> Callable[[], Arrays]:
    """Function that solves cells (r[k], beta[k]), mu = 1, with the kernel of maps; k is out[0, k, k]."""
    solver = Solver(
        steady=steady,
        cycles=cycles,
        tolerance=1e-10,
        outputs=("regime", "stops_per_cycle", "contact_amplitude", "cycles", "status"),
    )
    kernel, out = cells_by_kernel(system, r, beta, 1.0, solver)

    def solve() -> Arrays:
        kernel()
        return out

    return solve


def _diagonal(values: np.ndarray) -> np.ndarray:
    return values[0].diagonal()


def solved_and_marched(
    system: fm.System, r: np.ndarray, beta: np.ndarray, cycles: int, budget: float
) -> dict:
    """Time both methods on the cells that both resolve within `cycles`, alternating; `budget` in seconds."""
    resolved = np.ones(r.size, dtype=bool)
    for steady in ("solved", "marched"):  # compiles, too
        resolved &= _diagonal(_by_kernel(system, r, beta, steady, cycles)().status) == regimes.RESOLVED
    left_out = int((~resolved).sum())
    r, beta = r[resolved], beta[resolved]
    ways = {steady: _by_kernel(system, r, beta, steady, cycles) for steady in ("solved", "marched")}
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    answers: dict[str, Arrays] = {}
    spent, runs = 0.0, 0
    while runs < LEAST_RUNS or (spent < budget and runs < MOST_RUNS):
        runs += 1
        for name, way in ways.items():
            taken, answers[name] = timed(way)
            seconds[name].append(taken / r.size)
            spent += taken
    one, other = answers["solved"], answers["marched"]
    z, other_z = (_diagonal(out.contact_amplitude) for out in (one, other))
    return {
        "cells": int(r.size),
        "cells left out, not settled": left_out,
        "seconds a cell, solved": spread(seconds["solved"]),
        "seconds a cell, marched": spread(seconds["marched"]),
        "ratio": statistics.median(seconds["marched"]) / statistics.median(seconds["solved"]),
        "periods followed, solved": float(np.mean(_diagonal(one.cycles))),
        "periods followed, marched": float(np.mean(_diagonal(other.cycles))),
        "continuous cells": int((_diagonal(one.regime) == regimes.CONTINUOUS).sum()),
        "cells with other stop counts": int(
            (_diagonal(one.stops_per_cycle) != _diagonal(other.stops_per_cycle)).sum()
        ),
        "largest relative difference of Z": float(np.max(np.abs(z - other_z) / np.maximum(z, SMALL_Z))),
    }


def ways_to_the_steady_state(quick: bool, rng: np.random.Generator) -> dict:
    """Measure and print solved against marched, one and five masses."""
    cycles, budget = MARCHED_CYCLES[quick], 0.2 if quick else 2.0
    content: dict = {"tolerance": 1e-10, "periods at most": cycles}
    rows = []
    for masses in (1, 5):
        for zeta in (0.0, 0.01):
            system = fm.System(damping_ratios=zeta) if masses == 1 else equal_chain(5, 3, 1, zeta)
            name = f"{masses} mass{'es' if masses > 1 else ''}, zeta = {zeta:g}"
            entry = content[name] = {
                OPEN: solved_and_marched(
                    system, *_open_cells(system, OPEN_CELLS[quick], rng), cycles, budget
                ),
                NEAR: solved_and_marched(system, *_near_cells(system, quick), cycles, budget),
            }
            rows += [
                (
                    f"{name}: {kind}", one["cells"], one["cells left out, not settled"],
                    1e6 * one["seconds a cell, solved"]["median"],
                    1e6 * one["seconds a cell, marched"]["median"], one["ratio"],
                    one["periods followed, solved"], one["periods followed, marched"],
                    one["cells with other stop counts"], one["largest relative difference of Z"],
                )
                for kind, one in entry.items()
            ]  # fmt: skip
    table(
        (
            "steady states", "cells", "left out", "solved, us", "marched, us", "ratio", "periods", "marched",
            "other stops", "Z off by",
        ),
        rows,
    )  # fmt: skip
    return content


# ---------------------------------------------------------------- picture


def _bars(axes: Axes, rows: list[tuple[str, float, float]], labels: tuple[str, str], unit: str) -> None:
    """Two bars per row, with the ratio of the first to the second."""
    names = [name for name, _, _ in rows]
    places = np.arange(len(rows))
    for shift, values, colour, label in (
        (-0.2, [row[1] for row in rows], "#c8c8c8", labels[0]),
        (0.2, [row[2] for row in rows], "#2c5aa0", labels[1]),
    ):
        axes.barh(places + shift, values, 0.4, color=colour, label=label)
    for place, (_, slow, fast) in zip(places, rows, strict=True):
        axes.text(slow, place - 0.2, f" {two_digits(slow / fast)} x", va="center", fontsize=8)
    axes.set_xscale("log")
    axes.set_xlim(right=30.0 * max(max(row[1:]) for row in rows))
    axes.set_yticks(places, names, fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel(unit)
    axes.grid(alpha=0.25, axis="x")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)


def draw(content: dict, path: Path) -> None:
    """Draw the other solvers on the left, solved against marched on the right."""
    figure = new_figure(12.5, 4.6)
    left, right = figure.subplots(1, 2)
    rows = [
        (
            f"moving cell\n{name}",
            1e3 * entry["seconds a cell"]["median"],
            1e3 * entry["our seconds a cell"]["median"],
        )
        for name, entry in content["cells"].items()
        if "ratio" in entry
    ] + [
        (
            f"whole map, {name}\nheyoka (extrapolated)",
            1e3 * entry["heyoka, extrapolated from random cells"]["seconds"],
            1e3 * entry["seconds"]["median"],
        )
        for name, entry in content["map"].items()
        if "ratio" in entry
    ]
    _bars(left, rows, ("peer", "frictionmap"), "time [ms]")
    left.set_title("One mass, T Fig. 3.12, one thread: against general ODE solvers", fontsize=10)
    short = {OPEN: "open cells (mostly with stops)", NEAR: "continuous, next to resonance"}
    rows = [
        (
            f"{name}\n{short[kind]}",
            1e6 * one["seconds a cell, marched"]["median"],
            1e6 * one["seconds a cell, solved"]["median"],
        )
        for name, entry in content["solved and marched"].items()
        if isinstance(entry, dict)
        for kind, one in entry.items()
    ]
    _bars(right, rows, ("marched until it repeats", "with Newton's method (default)"), "time a cell [µs]")
    right.set_title("Our own kernels: what Newton's method gains", fontsize=10)
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    rng = np.random.default_rng(312)
    with pinned():
        content = {
            "cycles of the peers": CYCLES,
            "cells": single_cells(quick, rng),
            "map": whole_map(quick, rng),
            "solved and marched": ways_to_the_steady_state(quick, rng),
        }
    save("peers", content, results)
    draw(content, results / "peers.png")
    return content

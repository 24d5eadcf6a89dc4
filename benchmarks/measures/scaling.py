"""Computing time against cells, samples, harmonics, threads, low frequency, open cells; lower bound.

The map is that of T Fig. 3.12 (joined base-wall, no damping, r to 2.5, beta to 4) unless said otherwise, with
the three default outputs.  Every timing is of a whole `frictionmap.sweep`, labels and memory included.

cells           the map on successively finer grids, which all contain the points of the first: there regimes
                and stops must be the same, amplitudes to rounding (for mu = 1 a cell starts from the orbit
                of its neighbour).  Sizes that would not fit into memory are skipped with a message.
memory          peak memory of maps and of friction response spectra in new processes, compiled before
harmonics       stick-slip cells in rows of a map under square waves of up to 200 harmonics
threads         one map on 1 to all processors, alternating; results must be equal to the bit.
low frequency   cells of a fixed wall between beta_lim and beta_stick, down to r = 1e-4: one excitation period
                holds 1/r natural ones.  Stops and amplitude must not depend on the scan step.
open cells      a fixed wall at beta up to 1, where all cells are open, and increasingly beyond 1, where a
                formula gives permanent sticking: the open cells are of the same kind in every map.
phases          nanoseconds per slide or stop, and those of its closed forms alone: see `floor`.

Cost against the number of masses is in `structures`, against that of contacts in `general`.  A slope is that
of the logarithms, over the upper half of the sizes: 1 is proportional.
"""

import math
import os
import tracemalloc
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

import frictionmap as fm
from frictionmap import regimes
from frictionmap.checks import threads as usable_threads

from ..peers.contacts import ContactBody
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table, timed
from .floor import phase_floor
from .general.cost import rows_at, seconds_a_cell
from .general.scenes import Scene, square_wave
from .spectrum import record

#: Intervals of the coarsest grid in r and beta, and how many times finer the others are: 10^3 to 10^8 cells.
COARSEST = (25, 40)
FINER = {1.0: (1, 3, 10, 31, 100, 316), 1.5: (1, 3, 10, 31, 100)}
LARGEST_R, LARGEST_BETA = 2.5, 4.0
QUICK_CELLS = 1.2e5

#: Share of the free memory that a map may take.
MEMORY = 0.7

#: Sizes in new processes, 10^3 to 10^8 and more: maps, times finer than the coarsest; samples of a record,
#: with the periods of its spectrum, which has as many friction forces.
FINER_APART = (1, 3, 10, 31, 100, 316)
RECORDS_APART = ((16, 8), (160, 8), (1600, 8), (16_000, 8), (160_000, 8), (1_600_000, 8), (800_000, 32))
QUICK_APART = 3

#: Highest harmonic of the square wave; rows and cells of a row, by quick.
HARMONICS = (1, 5, 20, 50, 100, 200)
HARMONIC_ROWS = {False: (6, 100), True: (1, 20)}

#: r, and how many cells: fewer where each takes longer.
LOW = (
    (1.0, 2000), (0.3, 2000), (0.1, 2000), (0.03, 2000), (0.01, 2000), (3e-3, 500), (1e-3, 200), (3e-4, 50),
    (1e-4, 5),
)  # fmt: skip
QUICK_LOWEST = 0.01
LOW_DAMPING = (0.0, 0.02)
OTHER_STEPS = 37

SHARES = (0.0, 0.01, 0.03, 0.1, 0.3, 1.0)
OPEN_FROM = 0.8  # above the largest beta_lim of a fixed wall, pi/4

#: A map is timed until so many seconds are spent, this often at least and at most.
SECONDS, LEAST_RUNS, MOST_RUNS = 2.0, 3, 30


def repeated(function: Callable[[], object], quick: bool) -> tuple[list[float], list]:
    """Seconds of repeated calls, and the results of the first and the last."""
    seconds: list[float] = []
    answers: list = []
    budget = SECONDS / 50 if quick else SECONDS
    while len(seconds) < LEAST_RUNS or (sum(seconds) < budget and len(seconds) < MOST_RUNS):
        taken, answer = timed(function)
        seconds.append(taken)
        answers = [*answers[:1], answer]
    return seconds, answers


def same_bits(one: xr.Dataset, other: xr.Dataset) -> bool:
    """Whether two maps are equal to the bit, cell by cell."""
    return all(one[name].values.tobytes() == other[name].values.tobytes() for name in one.data_vars)


def agreement(one: xr.Dataset, other: xr.Dataset) -> tuple[bool, float]:
    """Whether two maps have the same regimes and stops, and the largest relative difference of Z."""
    same = one.regime.equals(other.regime) and one.stops_per_cycle.equals(other.stops_per_cycle)
    z, other_z = one.contact_amplitude.values, other.contact_amplitude.values
    moves = (z > 0.0) & np.isfinite(z) & np.isfinite(other_z)
    off = np.abs(z[moves] - other_z[moves]) / z[moves]
    return same, float(off.max(initial=0.0))


# ---------------------------------------------------------------- cells


def grid(finer: int) -> tuple[np.ndarray, np.ndarray]:
    """r and beta; every point of the coarsest grid is in each finer one, to the bit."""
    r, beta = (np.arange(n * finer + 1) for n in COARSEST)
    return r * LARGEST_R / (COARSEST[0] * finer), beta * LARGEST_BETA / (COARSEST[1] * finer)


def free_memory() -> float:
    """Bytes of free memory; infinite if the system does not report it."""
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
    except OSError:
        return float("inf")
    return next(1024.0 * float(line.split()[1]) for line in lines if line.startswith("MemAvailable"))


def memory_of_a_cell(system: fm.System) -> float:
    """Peak bytes of a sweep over its number of cells, measured on a map of 10^5."""
    r, beta = grid(10)
    tracemalloc.start()
    fm.sweep(system, r, beta, threads=1)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / (r.size * beta.size)


def cells_cost(quick: bool) -> dict:
    """Seconds of the map against its number of cells, one thread."""
    system = fm.System(contact="joined-base-wall")
    bytes_a_cell = memory_of_a_cell(system)
    content: dict = {"bytes a cell": bytes_a_cell, "maps": {}}
    rows = []
    for mu, sizes in FINER.items():
        coarsest = fm.sweep(system, *grid(1), mu, threads=1)
        found = content["maps"].setdefault(f"mu = {mu:g}", [])
        for finer in sizes:
            r, beta = grid(finer)
            cells = r.size * beta.size
            if quick and cells > QUICK_CELLS:
                continue
            needed = cells * bytes_a_cell
            if needed > MEMORY * free_memory():
                why = f"would take {needed / 2**30:.1f} GiB of memory"
                print(f"{cells:.3g} cells: skipped, {why}")
                found.append({"cells": cells, "skipped": why})
                continue
            seconds, answers = repeated(partial(fm.sweep, system, r, beta, mu, threads=1), quick)
            shared = answers[-1].isel(r=slice(None, None, finer), beta=slice(None, None, finer))
            same, off = agreement(coarsest, shared)
            del answers, shared
            each = 1e9 * float(np.median(seconds)) / cells
            found.append(
                {
                    "cells": cells,
                    "seconds": spread(seconds),
                    "ns a cell": each,
                    "cells shared with the coarsest map have its regimes and stops": same,
                    "their Z differs by": off,
                }
            )
            rows.append(
                (f"{mu:g}", f"{cells:,}", float(np.median(seconds)), each, "same" if same else "OTHER", off)
            )
    table(("mu", "cells", "seconds", "ns a cell", "shared cells", "Z off by"), rows)
    return content


def slope(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Exponent by which values grow with sizes, over the upper half of them."""
    half = min(len(sizes) // 2, len(sizes) - 2)
    return float(np.polyfit(np.log(sizes[half:]), np.log(values[half:]), 1)[0])


# ---------------------------------------------------------------- memory


def peak_memory() -> float:
    """Largest memory of this process so far [MB]; nan where the system does not report it."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return math.nan
    return next(float(line.split()[1]) * 1.024e-3 for line in lines if line.startswith("VmHWM"))


def map_apart(finer: int) -> dict:
    """Size, time and memory of a map in a process of its own."""
    system = fm.System(contact="joined-base-wall")
    fm.sweep(system, *grid(1), threads=1)  # compiles
    r, beta = grid(finer)
    before = peak_memory()
    seconds, _ = timed(lambda: fm.sweep(system, r, beta, threads=1))
    return {"size": r.size * beta.size, "seconds": seconds, "MB before": before, "MB": peak_memory()}


def spectrum_apart(size: tuple[int, int]) -> dict:
    """Measure a friction response spectrum likewise; its size is that of the record times the oscillators."""
    samples, count = size
    periods, friction = np.geomspace(0.15, 4.0, count), np.geomspace(0.01, 0.8, count)
    fm.spectrum(record(16), periods, friction, damping=0.05, threads=1)  # compiles
    given = record(samples)
    before = peak_memory()
    seconds, _ = timed(lambda: fm.spectrum(given, periods, friction, damping=0.05, threads=1))
    return {"size": samples * count**2, "seconds": seconds, "MB before": before, "MB": peak_memory()}


def memory_cost(quick: bool) -> dict:
    """Time and peak memory against the cells of a map and the samples of a spectrum."""
    content = {}
    for name, measure, sizes in (
        ("cells of a map", map_apart, FINER_APART),
        ("samples of a spectrum", spectrum_apart, RECORDS_APART),
    ):
        with ProcessPoolExecutor(1, mp_context=get_context("spawn"), max_tasks_per_child=1) as apart:
            rows = list(apart.map(measure, sizes[: QUICK_APART if quick else None]))
        found, seconds = [row["size"] for row in rows], [row["seconds"] for row in rows]
        content[name] = {"runs": rows, "slope of the time": slope(found, seconds)}
        table((name, "seconds", "MB before", "MB"), [tuple(row.values()) for row in rows])
        print(f"time grows as the power {content[name]['slope of the time']:.2f}")
    return content


# ---------------------------------------------------------------- harmonics


def harmonics_cost(quick: bool) -> dict:
    """Time per stick-slip cell in rows of a map against the highest harmonic of a square wave."""
    rows, cells = HARMONIC_ROWS[quick]
    found = []
    for highest in HARMONICS[: 2 if quick else None]:
        scene = Scene(ContactBody(((1,),), square_wave(highest), 1, 0.05), (1.0,))
        these = rows_at(scene.system(), np.geomspace(*scene.frequencies, rows), cells)
        per_cell = [seconds_a_cell(these) for _ in range(LEAST_RUNS)]
        found.append({"highest harmonic": highest, "us a cell": spread([1e6 * t for t in per_cell])})
    sizes = [row["highest harmonic"] for row in found]
    times = [row["us a cell"]["median"] for row in found]
    table(("highest harmonic", "us a cell"), list(zip(sizes, times, strict=True)))
    return {"rows": found, "slope": slope(sizes, times)}


# ---------------------------------------------------------------- threads


def threads_cost(quick: bool) -> dict:
    """Seconds of one map on 1 to all processors of this process."""
    system = fm.System(contact="joined-base-wall")
    r, beta = grid(10 if quick else 31)
    repeats = 3 if quick else 7
    counts = range(1, usable_threads() + 1)
    seconds: dict[int, list[float]] = {count: [] for count in counts}
    first = fm.sweep(system, r, beta, 1.5, threads=1)
    same = True
    for _ in range(repeats):
        for count in counts:
            taken, ds = timed(partial(fm.sweep, system, r, beta, 1.5, threads=count))
            seconds[count].append(taken)
            same = same and same_bits(first, ds)
    alone = float(np.median(seconds[1]))
    found = {
        str(count): {"seconds": spread(taken), "speed-up": alone / float(np.median(taken))}
        for count, taken in seconds.items()
    }
    table(
        ("threads", "seconds", "speed-up", "bits"),
        [
            (count, entry["seconds"]["median"], entry["speed-up"], "same" if same else "OTHER")
            for count, entry in found.items()
        ],
    )
    return {"cells": r.size * beta.size, "mu": 1.5, "the same bits": same, "threads": found}


# ---------------------------------------------------------------- low frequency


def _open_cells(system: fm.System, r: float, count: int) -> np.ndarray:
    """Values of beta evenly between beta_lim and beta_stick at one frequency."""
    ends = fm.boundaries(system, [r])
    low, high = ends.beta_lim.item(), ends.beta_stick.item()
    return low + (high - low) * (np.arange(count) + 0.5) / count


def _disagreement(one: xr.Dataset, other: xr.Dataset) -> tuple[int, float]:
    """Resolved cells with other stop counts, and the largest relative difference of Z in the others."""
    resolved = (one.status == regimes.RESOLVED).values & (other.status == regimes.RESOLVED).values
    equal = (one.stops_per_cycle == other.stops_per_cycle).values
    z, other_z = one.contact_amplitude.values, other.contact_amplitude.values
    off = np.abs(z - other_z)[resolved & equal] / z[resolved & equal]
    return int((resolved & ~equal).sum()), float(off.max(initial=0.0))


def low_frequency_cost(quick: bool) -> dict:
    """Microseconds per open cell of a fixed wall, from r = 1 down."""
    outputs = ("stops_per_cycle", "contact_amplitude", "status")
    content: dict = {"scan steps a period of the check": OTHER_STEPS}
    rows = []
    for zeta in LOW_DAMPING:
        system = fm.System(contact="fixed-wall", damping_ratios=zeta)
        found = content.setdefault(f"zeta = {zeta:g}", [])
        for r, count in LOW:
            if quick and r < QUICK_LOWEST:
                continue
            beta = _open_cells(system, r, count)

            sweep = partial(fm.sweep, system, [r], beta, threads=1, outputs=outputs)
            seconds, answers = repeated(sweep, quick)
            ds = answers[-1]
            other = sweep(steps=OTHER_STEPS)
            stops, off = _disagreement(ds, other)
            entry = {
                "r": r,
                "cells": count,
                "us a cell": spread([1e6 * t / count for t in seconds]),
                "most stops a cycle": float(ds.stops_per_cycle.max()),
                "cells that do not repeat": int((ds.status != regimes.RESOLVED).sum()),
                "with other scan steps: other stops": stops,
                "with other scan steps: Z differs by": off,
            }
            found.append(entry)
            rows.append(
                (
                    f"{zeta:g}", f"{r:g}", count, entry["us a cell"]["median"], entry["most stops a cycle"],
                    entry["cells that do not repeat"], stops, off,
                )
            )  # fmt: skip
    table(
        ("zeta", "r", "cells", "us a cell", "stops a cycle", "not repeating", "other stops", "Z off by"), rows
    )
    return content


# ---------------------------------------------------------------- open cells


def open_cells_cost(quick: bool) -> dict:
    """Nanoseconds per cell against the share of open cells, from none to all."""
    system = fm.System(contact="fixed-wall", damping_ratios=0.02)
    r = np.linspace(0.2, 2.0, 20 if quick else 200)
    count = 1000
    outputs = ("regime", "stops_per_cycle", "contact_amplitude", "origin")
    found = []
    for share in SHARES:
        first = OPEN_FROM if share else 1.0
        length = (1.0 - OPEN_FROM) / (share or 1.0)
        beta = first + length * (np.arange(count) + 0.5) / count
        seconds, answers = repeated(partial(fm.sweep, system, r, beta, threads=1, outputs=outputs), quick)
        ds = answers[-1]
        open_share = float((ds.origin != regimes.CLOSED_FORM).mean())
        stuck = (ds.regime == regimes.PERMANENT_STICKING).values
        cells = r.size * count
        found.append(
            {
                "share of open cells": open_share,
                "cells": cells,
                "ns a cell": spread([1e9 * t / cells for t in seconds]),
                "stuck where beta >= 1, and there only": bool(
                    (stuck == (beta >= 1.0)[np.newaxis, np.newaxis]).all()
                ),
            }
        )
    shares = [row["share of open cells"] for row in found]
    times = [row["ns a cell"]["median"] for row in found]
    slope, constant = np.polyfit(shares, times, 1, w=1.0 / np.array(times))
    table(
        ("share of open cells", "ns a cell", "regimes"),
        [
            (share, t, "right" if row["stuck where beta >= 1, and there only"] else "WRONG")
            for share, t, row in zip(shares, times, found, strict=True)
        ],
    )
    print(f"a closed cell takes {constant:.3g} ns, an open one {slope:.3g} ns more")
    return {
        "maps": found,
        "line: ns a closed cell": float(constant),
        "line: ns more an open cell": float(slope),
    }


# ---------------------------------------------------------------- picture


def _draw_cells(axes: Axes, found: dict) -> None:
    for (name, rows), marker in zip(found["maps"].items(), "os", strict=False):
        done = [row for row in rows if "seconds" in row]
        sizes, times = [row["cells"] for row in done], [row["seconds"]["median"] for row in done]
        end = f"{done[-1]['ns a cell'] / 1e3:.2g} µs a cell at the end, power {slope(sizes, times):.2f}"
        axes.loglog(sizes, times, marker=marker, label=f"{name}: {end}")
    axes.set(xlabel="cells of the map", ylabel="time [s]", title="Maps: a fixed cost, then so much a cell")
    axes.legend(loc="lower right", fontsize=7)


def _draw_memory(axes: Axes, found: dict) -> None:
    for (name, entry), marker in zip(found.items(), "os", strict=True):
        rows = entry["runs"]
        label = f"{name}: time to the power {entry['slope of the time']:.2f}"
        axes.loglog([row["size"] for row in rows], [row["MB"] for row in rows], marker=marker, label=label)
    axes.set(xlabel="cells, samples", ylabel="peak memory of the process [MB]", title="Memory")
    axes.set_ylim(bottom=100.0)
    axes.legend(loc="lower left", fontsize=8)


def _draw_harmonics(axes: Axes, found: dict) -> None:
    rows = found["rows"]
    axes.loglog(
        [row["highest harmonic"] for row in rows], [row["us a cell"]["median"] for row in rows], "o-",
        label=f"power {found['slope']:.2f} at the end",
    )  # fmt: skip
    axes.set(xlabel="highest harmonic", ylabel="time a stick-slip cell [µs]", title="Square waves")
    axes.legend(loc="upper left")


def _draw_threads(axes: Axes, found: dict) -> None:
    counts = [int(count) for count in found["threads"]]
    axes.plot(counts, [entry["speed-up"] for entry in found["threads"].values()], "o-", label="measured")
    axes.plot(counts, counts, "k:", label="ideal")
    axes.set(xlabel="threads", ylabel="times as fast", title="Threads: the same bits, sooner")
    axes.set_xticks(counts)
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper left")


def _draw_open(axes: Axes, found: dict) -> None:
    shares = [100.0 * row["share of open cells"] for row in found["maps"]]
    axes.plot(shares, [1e-3 * row["ns a cell"]["median"] for row in found["maps"]], "o", label="measured")
    closed, more = (1e-3 * found[key] for key in ("line: ns a closed cell", "line: ns more an open cell"))
    ends = np.linspace(0.0, 100.0, 1001)
    axes.plot(ends, closed + more * ends / 100.0, "k:", label=f"{closed:.2g} + {more:.2g} × share")
    axes.set_xscale("symlog", linthresh=1.0)
    axes.set_yscale("log")
    axes.set_xticks([0, 1, 10, 100], ["0", "1", "10", "100"])
    axes.set(xlabel="open cells [%]", ylabel="time a cell of the map [µs]", title="Only open cells cost")
    axes.legend(loc="upper left")


def _draw_low(axes: Axes, found: dict) -> None:
    for zeta, marker in zip(LOW_DAMPING, "os", strict=True):
        rows = found[f"zeta = {zeta:g}"]
        label = "no damping" if zeta == 0.0 else f"{100 * zeta:g} % damping"
        r = np.array([row["r"] for row in rows])
        times = np.array([row["us a cell"]["median"] for row in rows])
        axes.loglog(1.0 / r, times, marker=marker, label=label)
        aside = np.array([row["cells that do not repeat"] > 0 for row in rows])
        if aside.any():
            axes.loglog(
                1.0 / r[aside], times[aside], "o", markersize=13, fillstyle="none", color="#b03030",
                linestyle="none", label="some cells are never seen to repeat",
            )  # fmt: skip
    axes.set(xlabel="1/r", ylabel="time an open cell [µs]", title="Low frequency: more stops to follow")
    axes.legend(loc="upper left")


def _draw_floor(axes: Axes, found: dict) -> None:
    bars = {
        "frictionmap": ("kernel", "#2c5aa0"),
        "the same closed forms, no logic": ("closed forms of the kernel, no logic", "#8fb0dc"),
        "one closed form a phase, times known": ("closed form of each slide at once", "#c8c8c8"),
    }
    places = np.arange(len(found))
    for k, (label, (name, colour)) in enumerate(bars.items()):
        values = [entry[name]["median"] for entry in found.values()]
        axes.barh(places + 0.27 * (k - 1), values, 0.25, color=colour, label=label)
        for place, value in zip(places, values, strict=True):
            axes.text(value, place + 0.27 * (k - 1), f" {value:.0f}", va="center", fontsize=7)
    labels = [
        f"{name.partition(', b')[0]}\n{'one stop a slide' if entry['stops a slide'] else 'no stops'}"
        for name, entry in found.items()
    ]
    axes.set_yticks(places, labels, fontsize=8)
    axes.invert_yaxis()
    axes.set_xlim(right=1.45 * axes.get_xlim()[1])
    axes.set(xlabel="time a phase (a slide or a stop) [ns]", title="A phase, and the floor below it")
    axes.legend(loc="upper right")


def draw(content: dict, path: Path) -> None:
    """Draw seven panels."""
    figure = new_figure(13.0, 11.5)
    figure.suptitle("How cost grows (one mass; one thread unless said otherwise)")
    panels = figure.subplot_mosaic(
        [["cells", "memory", "harmonics"], ["threads", "open", "low"], ["floor", "floor", "floor"]]
    )
    _draw_cells(panels["cells"], content["cells"])
    _draw_memory(panels["memory"], content["memory"])
    _draw_harmonics(panels["harmonics"], content["harmonics"])
    _draw_threads(panels["threads"], content["threads"])
    _draw_open(panels["open"], content["open cells"])
    _draw_low(panels["low"], content["low frequency"])
    _draw_floor(panels["floor"], content["phases"])
    for axes in panels.values():
        axes.grid(alpha=0.25)
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    fm.sweep(fm.System(contact="joined-base-wall"), *grid(1), 1.5, threads=1)  # compiles
    with pinned():
        content = {"processors of this process": os.cpu_count(), "cells": cells_cost(quick)}
    content["threads"] = threads_cost(quick)  # on all processors
    with pinned():
        content["memory"] = memory_cost(quick)
        content["harmonics"] = harmonics_cost(quick)
        content["low frequency"] = low_frequency_cost(quick)
        content["open cells"] = open_cells_cost(quick)
    content["phases"] = phase_floor(quick)
    save("scaling", content, results)
    draw(content, results / "scaling.png")
    return content

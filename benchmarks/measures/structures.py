"""Structures: computing time against the number of masses, and five masses against general-purpose solvers.

Cost. Equal chains, contact and load on mass 1, 2 % damping, mu = 1, beta = 0.5, which is half of what holds
the contact permanently. The frequency is a third of the highest natural frequency, so an excitation period
has the same number of scan steps (75) for any number of masses. The scan step follows the fastest mode. A
segment (a slide or a stop) has a fixed cost and a cost per scan step. A line through its times with 24, 72
and 216 steps per period of the fastest mode separates the two.

Other solvers. The chain of T Fig. 6.17, mu = 1, random cells between beta_lim and beta_stick, from rest.
frictionmap ends when the steady state is found. The other solvers march for as many periods as `steady =
"marched"` needs for 1e-10, and are given this number and the period. Cells in which it is above `MOST_CYCLES`
are left out. Both favour the other solvers: they need not detect convergence, and Newton's method gains most
where marching is slow.
"""

import math
import statistics
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

import frictionmap as fm
from frictionmap import regimes
from frictionmap._kernels.event_codes import GRAZING, REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from frictionmap._kernels.one_mass import events
from frictionmap._kernels.one_mass import scan_step as phases
from frictionmap._kernels.structure.events import after_slide, slide_on
from frictionmap._kernels.structure.oscillators import FELL, make_scratch, make_state
from frictionmap._kernels.structure.state import make_structure
from frictionmap._kernels.taylor_series import MAX_TERMS
from frictionmap.model.settings import Solver
from frictionmap.single.cells import Cells
from frictionmap.single.maps import Arrays
from frictionmap.theory.boundary_curves import many_mode_curves, one_mass_curves

from ..peers.body import Body, Cell, Outcome
from ..peers.heyoka import ChainHeyoka
from ..peers.peer import Peer
from ..peers.solve_ivp import ChainSolveIvp
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, timed
from .own_entry import own_entry
from .own_kernel import cells_by_kernel
from .scaling import slope

MASSES = (1, 2, 5, 20, 50)
BETA = 0.5
STEPS = (24, 72, 216)  # the first is the default

PEERS = (ChainSolveIvp, ChainHeyoka)
CHAIN = Body(masses=5, contact=3, load=1)
DAMPING = (0.0, 0.01, 0.05)
FREQUENCIES = (0.1, 2.5)
LARGEST_BETA = 4.0
MOST_CYCLES = {"solve_ivp DOP853": 500, "heyoka": 2000}

#: A smaller Z than this [P/k1] is compared relative to this: what repeats to 1e-10 is the whole state.
SMALL_Z = 0.1

ONE_MASS = "1, kernel for one mass"


def equal_chain(masses: int, contact: int, load: int, zeta: float) -> fm.System:
    """Chain of equal masses and springs; friction between one mass and a wall."""
    ones = [1.0] * masses
    return fm.System(
        contact_masses=[contact], load_mass=load, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=zeta
    )


# ---------------------------------------------------------------- cost


@own_entry
def follow_one(step, b, mu_b, slides, work):
    """Follow one mass from rest: (slides, stops, scan steps); a stop needs no scan."""
    _, z, c, s, force, _ = events.after_slide(b, mu_b, 0.0, 1.0, 0.0)
    stops, steps = 0, 0.0
    for _ in range(slides):
        n, z, c, s = events.slide(step, b, z, 0.0, step.stiffness * force, c, s, 1e6, work)
        steps += n
        _, z, c, s, force, wait = events.after_slide(b, mu_b, z, c, s)
        stops += wait > 0.0
    return slides, stops, steps


@own_entry
def follow_structure(st, beta, mu_beta, slides, state, held, scratch):
    """Follow a structure from rest: (slides, stops, scan steps); fewer slides if it sticks permanently."""
    state[:] = 0.0
    allowed = 1e4
    _, c, s, force, _, _, _ = after_slide(st, beta, mu_beta, state, held, 1.0, 0.0, allowed, scratch)
    stops, steps = 0, 0.0
    for k in range(slides):
        n, end, c, s, _ = slide_on(st, beta, force, state, c, s, 1e6, scratch)
        steps += n
        if end != FELL:
            return k, stops, steps
        code, c, s, force, wait, _, _ = after_slide(st, beta, mu_beta, state, held, c, s, allowed, scratch)
        if code in (STOP_THEN_BACK, STOP_THEN_ON):
            stops += 1
            steps += wait / st.h
        elif code not in (REVERSE, GRAZING):
            return k, stops, steps
    return slides, stops, steps


def _fit(rows: list[dict]) -> tuple[float, float]:
    """(ns per segment, ns per scan step) of the line through the shortest times."""
    step, phase = np.polyfit(
        [row["scan steps a phase"] for row in rows], [row["ns a phase"] for row in rows], 1
    )
    return float(phase), float(step)


def _motion(system: fm.System, r: float, steps: int, special: bool) -> Callable[[int], tuple]:
    """Function that follows the motion for the given number of slides: slides done, stops, scan steps."""
    if special:
        step = phases.step_constants(r, system.zeta, float(steps))
        work = np.empty(MAX_TERMS)
        return lambda slides: follow_one(step, BETA, BETA, slides, work)
    found = Cells(system, np.array([r]), np.array([BETA]), np.ones(1), Solver()).structure_arrays
    n = found.participating.size
    st = make_structure(found.model, found.loads, 0, r, float(steps))
    state, held, scratch = make_state(n), make_state(n - 1), make_scratch(n)
    return lambda slides: follow_structure(st, BETA, BETA, slides, state, held, scratch)


def phase_cost(masses: int, special: bool, repeats: int) -> dict:
    """Nanoseconds per segment and per scan step of a chain, or of one mass by its own kernel."""
    system = equal_chain(masses, 1, 1, 0.02)
    r = float(system.modes.w[-1]) / 3.0
    slides = max(200, 4000 // masses)
    motions = [_motion(system, r, steps, special) for steps in STEPS]
    counts = [motion(slides) for motion in motions]  # compiles
    if any(done != slides for done, _, _ in counts):
        raise RuntimeError(f"{masses} masses: the motion ended before {slides} slides were done")
    times: list[list[float]] = [[] for _ in STEPS]
    for _ in range(repeats):  # alternating: all see the same machine
        for motion, taken, (_, stops, _) in zip(motions, times, counts, strict=True):
            taken.append(1e9 * timed(lambda m=motion: m(slides))[0] / (slides + stops))
    rows = [
        {
            "steps": steps,
            "ns a phase": statistics.median(taken),
            "ns a phase, spread": spread(taken),
            "scan steps a phase": scanned / (slides + stops),
            "stops a slide": stops / slides,
        }
        for steps, taken, (_, stops, scanned) in zip(STEPS, times, counts, strict=True)
    ]
    by_phase, by_step = _fit(rows)
    first = rows[0]
    return {
        "r": r,
        "steps": rows,
        "ns a phase": first["ns a phase"],
        "ns a phase and mass": first["ns a phase"] / masses,
        "scan steps a phase": first["scan steps a phase"],
        "ns a phase over its scan steps": first["ns a phase"] / first["scan steps a phase"],
        "fit: ns a phase": by_phase,
        "fit: ns a scan step": by_step,
        "fit: ns a scan step and mass": by_step / masses,
    }


def boundary_cost(masses: int, special: bool, count: int, repeats: int) -> dict:
    """Microseconds per frequency of all curves: V, U, G, H, S, beta_lim, its bound, beta_stick."""
    system = equal_chain(masses, 1, 1, 0.02)
    r, mu = np.linspace(0.1, 2.5, count), np.ones(1)
    curves = one_mass_curves if special else many_mode_curves
    curves(system, r[:2], mu)
    return spread([1e6 * timed(lambda: curves(system, r, mu))[0] / count for _ in range(repeats)])


def cell_cost(masses: int, special: bool, side: int, repeats: int) -> dict:
    """Microseconds per integrated cell of a map, including everything that a map needs; one thread."""
    system, scale = equal_chain(masses, 1, 1, 0.02), 1.0
    if masses == 1 and not special:  # in other units one mass is a structure like any other
        scale = 2.0
        system = fm.System(matrices={"M": [[1.0]], "K": [[1.0]]}, frequency_scale=scale, damping_ratios=0.02)
    r, beta = np.linspace(0.1, 2.0, side) / scale, np.linspace(0.02, 1.0, side)

    def sweep() -> xr.Dataset:
        return fm.sweep(system, r, beta, outputs=("stops_per_cycle", "origin", "status"), threads=1)

    ds = sweep()  # compiles
    count = int((ds.origin != regimes.CLOSED_FORM).sum())
    times = [1e6 * timed(sweep)[0] / count for _ in range(repeats)]
    unresolved = int((ds.status != regimes.RESOLVED).sum())
    return {"integrated cells": count, "unresolved cells": unresolved, "us a cell": spread(times)}


def step_line(found: dict) -> tuple[float, float]:
    """(a, b) of the line a N + b ns through the times of a scan step over N masses, by relative error."""
    times = np.array([found[str(n)]["fit: ns a scan step"] for n in MASSES])
    slope, constant = np.polyfit(MASSES, times, 1, w=1.0 / np.maximum(times, 1.0))
    return float(slope), float(constant)


def measured(found: dict) -> dict[str, list[float]]:
    """Nanoseconds over the number of masses."""
    rows = [found[str(masses)] for masses in MASSES]
    return {
        "integrated cell": [1e3 * row["map"]["us a cell"]["median"] for row in rows],
        "boundaries of a frequency": [1e3 * row["us a boundary evaluation"]["median"] for row in rows],
        "slide or stop": [row["ns a phase"] for row in rows],
        "scan step": [row["fit: ns a scan step"] for row in rows],
    }


def powers(found: dict) -> dict[str, float]:
    """Powers of the number of masses by which times grow, at its upper end; the scan step has its line."""
    return {name: slope(MASSES, times) for name, times in measured(found).items() if name != "scan step"}


def cost(quick: bool) -> dict:
    """Measure and print the computing time against the number of masses."""
    repeats = 10 if quick else 50
    content = {}
    print(
        f"{'masses':>22} {'steps/phase':>11} {'ns/phase':>9} {'/mass':>6} {'ns/phase/step':>13} | "
        f"{'fit: ns/phase':>13} {'+ ns/step':>9} {'/mass':>6} | {'us/boundary':>11} | {'us/cell':>8}"
    )
    for masses, special in [(1, True), *((n, False) for n in MASSES)]:
        name = ONE_MASS if special else str(masses)
        one = phase_cost(masses, special, repeats)
        boundary = boundary_cost(masses, special, 100 if quick else 1000, 3 if quick else 10)
        cell = cell_cost(masses, special, 8 if quick else 40, 1 if quick else 5)
        content[name] = {**one, "us a boundary evaluation": boundary, "map": cell}
        print(
            f"{name:>22} {one['scan steps a phase']:11.1f} {one['ns a phase']:9.0f} "
            f"{one['ns a phase and mass']:6.0f} {one['ns a phase over its scan steps']:13.1f} | "
            f"{one['fit: ns a phase']:13.0f} {one['fit: ns a scan step']:9.1f} "
            f"{one['fit: ns a scan step and mass']:6.2f} | {boundary['median']:11.2f} | "
            f"{cell['us a cell']['median']:8.1f}",
            flush=True,
        )
    per_mass, constant = step_line(content)
    print(f"a scan step of N masses takes {constant:.3g} + {per_mass:.3g} N ns")
    content["ns a scan step, line over masses"] = {"constant": constant, "a mass": per_mass}
    content["powers of the number of masses"] = powers(content)
    return content


# ---------------------------------------------------------------- peers


class Sampled(NamedTuple):
    """A random cell, with the result of `steady = "marched"`."""

    r: float
    beta: float
    cycles: int  # until the state repeats to 1e-10
    period: int


def sample_cells(
    system: fm.System, count: int, most_cycles: int, rng: np.random.Generator
) -> tuple[list[Sampled], int]:
    """Random cells between beta_lim and beta_stick, sorted by r; number of those not periodic."""
    found: list[Sampled] = []
    left_out = 0
    outputs = ("cycles", "period", "status")
    while len(found) < count:
        r = float(rng.uniform(*FREQUENCIES))
        ends = fm.boundaries(system, [r])
        low, high = ends.beta_lim.item(), min(ends.beta_stick.item(), LARGEST_BETA)
        beta = float(rng.uniform(low, max(low, high)))
        if not low < beta < high:
            continue
        ds = fm.sweep(
            system,
            [r],
            [beta],
            steady="marched",
            tolerance=1e-10,
            cycles=most_cycles,
            outputs=outputs,
            threads=1,
        ).squeeze()
        if int(ds.status) == regimes.RESOLVED:
            found.append(Sampled(r, beta, math.ceil(float(ds.cycles)), int(ds.period)))
        else:
            left_out += 1
    return sorted(found), left_out


def prepare(system: fm.System, sampled: list[Sampled]) -> tuple[Callable[[], None], Arrays]:
    """(solve, out) for the cells by the kernel of maps, with constants for each; cell k is out[0, k, k]."""
    r, beta = (np.array([getattr(cell, name) for cell in sampled]) for name in ("r", "beta"))
    return cells_by_kernel(system, r, beta, 1.0, Solver())


def _differences(ours: list[Outcome], theirs: list[Outcome], cells: list[Sampled]) -> dict:
    """Cells with other stop counts; relative differences of Z in the others."""
    other, errors = [], []
    for a, b, cell in zip(ours, theirs, cells, strict=True):
        if a.stops != b.stops:
            other.append({"r": cell.r, "beta": cell.beta, "ours": a, "theirs": b})
        else:
            errors.append(abs(a.Z - b.Z) / max(b.Z, SMALL_Z))
    return {
        "cells with other stop counts": other,
        "relative difference of Z": spread(errors) if errors else None,
        "cells with Z off by more than 1e-6": sum(error > 1e-6 for error in errors),
    }


def against(peer: Peer, system: fm.System, cells: list[Sampled], rounds: int) -> dict:
    """Time one solver on the cells of one chain, alternating with frictionmap; rounds of all cells."""
    solve, out = prepare(system, cells)
    solve()  # compiles
    peer.run(Cell(*cells[0][:2]), 2)
    theirs: list[Outcome] = []
    seconds_theirs, seconds_ours = [], []
    for _ in range(rounds):
        theirs, total = [], 0.0
        for cell in cells:
            taken, outcome = timed(lambda c=cell: peer.run(Cell(c.r, c.beta), c.cycles + c.period, c.period))
            theirs.append(outcome)
            total += taken
            seconds_ours.append(timed(solve)[0] / len(cells))
        seconds_theirs.append(total / len(cells))
    diagonal = range(len(cells))
    ours = [
        Outcome(float(out.stops_per_cycle[0, k, k]), float(out.contact_amplitude[0, k, k])) for k in diagonal
    ]
    # with what a map shares between the cells of one frequency, and by itself from Python
    batch = [timed(lambda: prepare(system, cells)[0]())[0] / len(cells) for _ in range(max(3, rounds))]
    alone = [timed(lambda c=cell: prepare(system, [c])[0]())[0] for cell in cells]
    mean = statistics.median(seconds_theirs)
    return {
        "version": peer.version(),
        "cells": len(cells),
        "periods marched": spread([cell.cycles + cell.period for cell in cells]),
        "seconds a cell": spread(seconds_theirs),
        "our seconds a cell": spread(seconds_ours),
        "our seconds a cell, with the curves of its frequency": spread(batch),
        "our seconds for one cell alone, with the curves": spread(alone),
        "ratio": mean / statistics.median(seconds_ours),
        "ratio with the curves": mean / statistics.median(batch),
        "differences": _differences(ours, theirs, cells),
    }


def peers(quick: bool) -> dict:
    """Measure and print five masses against other solvers."""
    content: dict = {}
    rng = np.random.default_rng(617)
    for zeta in DAMPING[-1:] if quick else DAMPING:
        chain = CHAIN._replace(zeta=zeta)
        system = equal_chain(chain.masses, chain.contact, chain.load, zeta)
        for peer_class in PEERS:
            slow = peer_class.name.startswith("solve_ivp")
            count = (2 if slow else 4) if quick else (15 if slow else 60)
            entry = content.setdefault(peer_class.name, {})
            why = peer_class.why_missing()
            if why:
                print(f"{peer_class.name}: skipped, {why}")
                entry["skipped"] = why
                continue
            cells, left_out = sample_cells(system, count, MOST_CYCLES[peer_class.name], rng)
            found = against(peer_class(chain), system, cells, 1 if quick else 2)
            entry[f"zeta = {zeta:g}"] = {"cells left out, too many periods": left_out, **found}
            differences = found["differences"]
            theirs, ours = found["seconds a cell"]["median"], found["our seconds a cell"]["median"]
            print(
                f"{peer_class.name:16} zeta = {zeta:<4}: {1e3 * theirs:.3g} ms a cell, "
                f"ours {1e3 * ours:.3g} ms: "
                f"{found['ratio']:,.0f} times ({found['ratio with the curves']:,.0f} with curves); of "
                f"{len(cells)} cells {len(differences['cells with other stop counts'])} with other stops, "
                f"{differences['cells with Z off by more than 1e-6']} with Z off by more than 1e-6; "
                f"{left_out} left out",
                flush=True,
            )
    return content


# ---------------------------------------------------------------- picture


def draw(content: dict, path: Path) -> None:
    """Draw the time against the number of masses, and the time per cell against other solvers."""
    found = content["cost"]
    n = np.array(MASSES)
    figure = new_figure(10.0, 4.4)
    left, right = figure.subplots(1, 2)
    growth = powers(found)
    for (name, values), marker in zip(measured(found).items(), "D^os", strict=True):
        label = f"{name}: power {growth[name]:.2f} at the end" if name in growth else name
        left.loglog(n, values, marker=marker, label=label)
    per_mass, alone = step_line(found)
    left.loglog(n, alone + per_mass * n, "k:", linewidth=1.0, label=f"{alone:.3g} + {per_mass:.2g} N ns")
    left.set_xticks(n, [str(k) for k in n])
    left.minorticks_off()
    left.set_xlabel("number of masses N")
    left.set_ylabel("time [ns]")
    left.set_title("Cost: chain, 2 % damping, contact and load on mass 1", fontsize=10)
    left.set_ylim(top=1e2 * left.get_ylim()[1])
    left.legend(fontsize=8, loc="upper left")
    names, ours, theirs = [], [], []
    for peer, entry in content["peers"].items():
        for damping, row in entry.items():
            if isinstance(row, dict):
                names.append(f"{peer}\n{damping}")
                ours.append(1e3 * row["our seconds a cell"]["median"])
                theirs.append(1e3 * row["seconds a cell"]["median"])
    places = np.arange(len(names))
    right.barh(places - 0.2, theirs, 0.4, color="#c8c8c8", label="peer")
    right.barh(places + 0.2, ours, 0.4, color="#2c5aa0", label="frictionmap")
    for place, a, b in zip(places, ours, theirs, strict=True):
        right.text(b, place - 0.2, f" {b / a:,.0f} x", va="center", fontsize=8)
    right.set_xscale("log")
    right.set_xlim(right=10.0 * max(theirs, default=1.0))
    right.set_yticks(places, names, fontsize=8)
    right.invert_yaxis()
    right.set_xlabel("time for one cell [ms]")
    right.set_title("Steady state of five masses (chain of T Fig. 6.17)", fontsize=10)
    right.legend(fontsize=8)
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    with pinned():
        content = {"cost": cost(quick), "peers": peers(quick)}
    save("structures", content, results)
    draw(content, results / "structures.png")
    return content

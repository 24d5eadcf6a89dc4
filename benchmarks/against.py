"""The same cells by every solver, alternating, one thread each, answers checked while timed.

The peers integrate 200 excitation periods, the thesis's number; ours ends when the steady state is found.
Compilation and imports are not counted (see `startup`).  The map of T Fig. 3.12 by a peer is extrapolated
from a random sample of its cells, stuck ones included.
"""

import math
import statistics
from pathlib import Path

import numpy as np
from numba import njit

import frictionmap as fm
from frictionmap._kernels.continuous import Oscillator
from frictionmap._kernels.cycle import HISTORY, HISTORY_ROWS, Limits, steady_cell
from frictionmap._kernels.phases import MAX_TERMS, step_constants
from frictionmap._kernels.sweep import FINE_STEPS, normalised_friction
from frictionmap.curves import one_mass_curves

from .peers import PEERS, Cell, HeyokaPeer
from .record import save, spread, timed

CYCLES = 200
R = np.arange(126) * 2 / 100
BETA = np.arange(401) / 100


@njit
def solve_cells(load, phase, oscillators, lim, stick, beta, mu, limits):
    """Stops and amplitude of single cells, each with all its constants computed anew."""
    history = np.empty((HISTORY_ROWS, HISTORY))
    work = np.empty(MAX_TERMS)
    stop = np.zeros(1, dtype=np.uint8)
    out = np.empty((beta.size, 2))
    for k in range(beta.size):
        r, zeta, v_abs, v_arg, u, g = oscillators[k]
        oscillator = Oscillator(r, zeta, v_abs, v_arg, u, g, False)
        step = step_constants(r, zeta, 24.0)
        fine = step_constants(r, zeta, FINE_STEPS)
        b, mu_b = normalised_friction(beta[k], load[k], mu[k], stick[k])
        cell = steady_cell(
            step, fine, oscillator, b, mu_b, lim[k], 0.0, 0.0, math.cos(phase[k]), math.sin(phase[k]),
            limits, stop, history, work,
        )  # fmt: skip
        out[k, 0] = cell.stops
        out[k, 1] = cell.amplitude * load[k]
    return out


def prepare(cells: list[Cell]) -> tuple:
    """Arguments of `solve_cells`."""
    rows = []
    for cell in cells:
        system = fm.System(contact=cell.contact, damping_ratios=cell.zeta)
        found = one_mass_curves(system, np.array([cell.r]), np.array([cell.mu]))
        f = found.frequencies
        rows.append(
            (
                f.load[0], f.phase[0], (cell.r, cell.zeta, f.v_abs[0], f.v_arg[0], f.u[0], f.g[0]),
                found.lim[0, 0], found.curves.beta_stick[0, 0], cell.beta, cell.mu,
            )
        )  # fmt: skip
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return (*columns, Limits(2000.0, 1e-12, True))


def sample_cells(count: int, moving: bool, rng: np.random.Generator, mu: float = 1.0) -> list[Cell]:
    """Random cells of the map of T Fig. 3.12; with `moving`, of its open strip."""
    found = []
    while len(found) < count:
        r, beta = float(rng.choice(R[1:])), float(rng.choice(BETA[1:]))
        if not moving or beta < r * r / mu:
            found.append(Cell("joined-base-wall", r, beta, mu))
    return found


def _compare(ours: np.ndarray, theirs: list, cells: list[Cell]) -> dict:
    """How the answers differ: cells with other stop counts, and the median error of the amplitude."""
    other = [
        cell._asdict()
        for (stops, _), (their_stops, _), cell in zip(ours, theirs, cells, strict=True)
        if stops != their_stops and not (math.isnan(stops) and math.isnan(their_stops))
    ]
    errors = [
        abs(z - their_z) / z
        for (_, z), (_, their_z) in zip(ours, theirs, strict=True)
        if 0.0 < z < math.inf and math.isfinite(their_z)
    ]
    return {
        "cells with other stop counts": other,
        "median relative difference of Z": statistics.median(errors) if errors else None,
    }


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    rng = np.random.default_rng(312)
    content: dict = {"cycles of the peers": CYCLES, "cells": {}, "map": {}}
    counts = {"solve_ivp": 2 if quick else 30, "heyoka": 20 if quick else 200}
    system = fm.System(contact="joined-base-wall")
    fm.sweep(system, R[10:12], BETA[5:40], 1.0, threads=1)  # compile
    for peer_class in PEERS:
        why = peer_class.why_missing()
        if why:
            print(f"{peer_class.name}: skipped, {why}")
            content["cells"][peer_class.name] = {"skipped": why}
            continue
        set_up, peer = timed(peer_class)
        cells = sample_cells(counts.get(peer_class.name, 20), True, rng)
        arguments = prepare(cells)
        solve_cells(*prepare(cells[:1]))  # compile
        seconds_theirs, seconds_ours, theirs, ours = [], [], [], None
        for cell in cells:  # alternating: both see the same machine
            taken, outcome = timed(lambda c=cell, p=peer: p.run(*c[:4], c.zeta, cycles=CYCLES))
            seconds_theirs.append(taken)
            theirs.append(outcome)
            taken, ours = timed(lambda a=arguments: solve_cells(*a))
            seconds_ours.append(taken / len(cells))
        ratio = statistics.mean(seconds_theirs) / statistics.median(seconds_ours)
        content["cells"][peer_class.name] = {
            "version": peer.version,
            "set-up seconds": set_up,
            "cells": len(cells),
            "seconds a cell": spread(seconds_theirs) | {"mean": statistics.mean(seconds_theirs)},
            "our seconds a cell": spread(seconds_ours),
            "ratio of means": ratio,
            "differences": _compare(ours, theirs, cells),
        }
        print(
            f"{peer_class.name}: {statistics.mean(seconds_theirs):.3g} s a moving cell, ours "
            f"{statistics.median(seconds_ours):.3g} s: {ratio:,.0f} times"
        )
    content["map"] = whole_map(system, quick, rng)
    save("peers", content, results)
    return content


def whole_map(system: fm.System, quick: bool, rng: np.random.Generator) -> dict:
    """The published map, mu = 1 and 1.5, against heyoka extrapolated from random cells of it."""
    found = {}
    for mu in (1.0, 1.5):
        seconds = [
            timed(lambda m=mu: fm.sweep(system, R, BETA, m, threads=1))[0] for _ in range(3 if quick else 15)
        ]
        entry = {"cells": R.size * BETA.size, "seconds": spread(seconds)}
        if not HeyokaPeer.why_missing():
            peer = HeyokaPeer()
            cells = sample_cells(20 if quick else 200, False, rng, mu)
            theirs = [timed(lambda c=c, p=peer: p.run(*c[:4], c.zeta, cycles=CYCLES))[0] for c in cells]
            total = statistics.mean(theirs) * R.size * BETA.size
            entry |= {
                "heyoka, extrapolated from random cells": {"cells": len(cells), "seconds": total},
                "ratio": total / statistics.median(seconds),
            }
            print(
                f"map of Fig. 3.12, mu = {mu:g}: {statistics.median(seconds):.3g} s; heyoka, extrapolated "
                f"from {len(cells)} random cells, {total:.3g} s: {entry['ratio']:,.0f} times"
            )
        found[f"mu = {mu:g}"] = entry
    return found

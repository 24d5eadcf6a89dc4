"""What every map of several contacts at mu = 1 must fulfil, in 100,000 random cells.

Each cell has a steady state.  Its multipliers, without those of contacts that rest, are at most 1: the energy
of the difference of two motions never grows.  Friction never exceeds beta nu(tau).  The numbers of a cell do
not depend on the cells that are computed with it.
"""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

import frictionmap as fm

from ..report.figures import new_figure, save_figure
from ..report.record import save, table

KINDS = ("rigid contacts", "elastic beside rigid contacts")

#: Systems of a kind, by quick: each has a grid of FREQUENCIES x RATIOS cells.
SYSTEMS = {False: 500, True: 4}
FREQUENCIES, RATIOS = 2, 50

#: Rounding errors of a multiplier and of a friction force, relative.
ROUNDING = 1e-9

#: Numbers compared between cuts; `cycles` alone depends on the cells before.
OUTPUTS = (
    "regime", "stops_per_cycle", "amplitude", "midpoint", "contact_amplitude", "contact_midpoint",
    "stuck_fraction", "sliding_distance", "multiplier", "status",
)  # fmt: skip


class Faults(NamedTuple):
    """Cells of one system that do not fulfil what they must."""

    cells: int
    unanswered: int
    growing: int
    overloaded: int
    different: int
    motions: int
    nearest: np.ndarray  # the largest multipliers of the cells


def _rigid_contacts(rng: np.random.Generator, n: int) -> list[tuple[str, tuple[int, ...]]]:
    """Up to three contacts that close no loop."""
    places = [("fixed-wall", (j,)) for j in range(1, n + 1)]
    places += [("between-masses", pair) for pair in pairwise(range(1, n + 1))]
    found: list[tuple[str, tuple[int, ...]]] = []
    vectors = np.empty((0, n))
    for k in rng.permutation(len(places)):
        kind, masses = places[k]
        vector = np.zeros(n)
        vector[[mass - 1 for mass in masses]] = (1.0, -1.0)[: len(masses)]
        more = np.vstack((vectors, vector))
        if np.linalg.matrix_rank(more) == len(more):
            found.append((kind, masses))
            vectors = more
    return found[: int(rng.integers(1, 4))]


def _contact(rng: np.random.Generator, kind: str, masses: tuple[int, ...], first: bool) -> fm.Contact:
    """A contact with random friction; some normal loads vary, and some walls are belts."""
    normal = {int(rng.integers(1, 3)): 0.8 * rng.random() * np.exp(2j * np.pi * rng.random())}
    belt = kind == "fixed-wall" and rng.random() < 0.15
    return fm.Contact(
        kind, masses, ratio=1.0 if first else float(rng.uniform(0.1, 1.5)),
        normal_load=normal if rng.random() < 0.15 else None,
        wall_velocity=float(rng.uniform(0.05, 0.6)) if belt else 0.0,
    )  # fmt: skip


def _spring(rng: np.random.Generator, n: int) -> fm.Contact:
    """An elastic contact at any place, also parallel to rigid ones."""
    first = int(rng.integers(1, n + 1))
    pair = (first, first + 1) if first < n and rng.random() < 0.5 else (first,)
    kind = "fixed-wall" if len(pair) == 1 else "between-masses"
    stiffness, ratio = 10.0 ** rng.uniform(-0.5, 1.5), rng.uniform(0.1, 1.5)
    return fm.Contact(kind, pair, ratio=float(ratio), stiffness=float(stiffness))


def random_system(rng: np.random.Generator, kind: str) -> fm.System:
    """Chain of 1 to 4 masses under 1 to 3 harmonics on every mass, damped by 0.003 to 0.2."""
    n = int(rng.integers(1, 5))
    contacts = [_contact(rng, *place, k == 0) for k, place in enumerate(_rigid_contacts(rng, n))]
    if kind == KINDS[1]:
        contacts += [_spring(rng, n) for _ in range(int(rng.integers(1, 3)))]
    elif len(contacts) == 1:  # alone, it would be another engine's
        contacts = [_contact(rng, "fixed-wall", (n,), True)]
    orders = [1, *(order for order in (2, 3) if rng.random() < 0.4)]
    loads = {order: (rng.normal(size=n) + 1j * rng.normal(size=n)) / order for order in orders}
    masses, springs = (np.concatenate(([1.0], rng.uniform(0.4, 2.0, n - 1))) for _ in range(2))
    return fm.System(
        mass_ratios=masses, stiffness_ratios=springs, damping_ratios=10.0 ** rng.uniform(-2.5, -0.7),
        contacts=contacts, load_harmonics=loads,
    )  # fmt: skip


def _grid(rng: np.random.Generator, system: fm.System) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, and friction ratios up to 1.3 times that from which all contacts stick."""
    r = np.sort(rng.uniform(0.2, 2.0, FREQUENCIES))
    stick = fm.boundaries(system, r).beta_stick.values
    top = float(stick[np.isfinite(stick)].max(initial=0.0)) or 3.0
    return r, np.sort(rng.uniform(0.01, 1.3, RATIOS) * top)


def _cuts(system: fm.System, r: np.ndarray, beta: np.ndarray) -> Iterator[xr.Dataset]:
    """The same cells in other company: a part of the row, every third cell of one row, cells alone."""
    parts = [(r, beta[RATIOS // 3 :]), (r[1:], beta[::3])]
    parts += [(r[:1], beta[k : k + 1]) for k in range(3, RATIOS, RATIOS // 4)]
    for axes in parts:
        yield fm.sweep(system, *axes, outputs=OUTPUTS, threads=1)


def _different(whole: xr.Dataset, part: xr.Dataset) -> int:
    """Cells of a cut that have any other bit than those of the whole grid."""
    same = whole.sel(r=part.r, beta=part.beta)
    differs = np.zeros(part.status.shape, dtype=bool)
    for name, one in part.data_vars.items():
        if "beta" not in one.dims:
            continue
        pair = [data.transpose("mu", "r", "beta", ...).values for data in (one, same[name])]
        odd = ~((pair[0] == pair[1]) | ((pair[0] != pair[0]) & (pair[1] != pair[1])))
        differs |= odd.reshape(*differs.shape, -1).any(axis=-1)
    return int(differs.sum())


def _overloaded(system: fm.System, r: float, beta: float) -> int:
    """Whether any friction force of a motion exceeds its limit, 0 or 1."""
    motion = fm.response(system, r, beta)
    groups = system.general.groups
    limits = np.array([group.friction(beta, 1.0)[0] for group in groups])
    normal = np.ones((len(groups), motion.tau.size))
    for j, group in enumerate(groups):
        for order, value in (group.first.nu or {}).items():
            normal[j] += (value * np.exp(1j * order * motion.tau.values)).real
    limit = limits[:, np.newaxis] * np.maximum(normal, 0.0)
    return int((np.abs(motion.friction.values) > limit * (1.0 + ROUNDING) + ROUNDING * limits.max()).any())


def check(rng: np.random.Generator, kind: str) -> Faults:
    """Compute the cells of a random system, and check them."""
    system = random_system(rng, kind)
    r, beta = _grid(rng, system)
    whole = fm.sweep(system, r, beta, outputs=OUTPUTS, threads=1)
    resolved = whole.status.values == 0
    multiplier = whole.multiplier.values
    answered = np.argwhere(resolved)
    overloaded = 0
    if answered.size:
        _, i, k = answered[rng.integers(len(answered))]
        overloaded = _overloaded(system, r[i], beta[k])
    return Faults(
        resolved.size, int((~resolved).sum()), int((multiplier > 1.0 + ROUNDING).sum()), overloaded,
        sum(_different(whole, part) for part in _cuts(system, r, beta)), int(answered.size > 0),
        multiplier[np.isfinite(multiplier)],
    )  # fmt: skip


def _summary(found: list[Faults]) -> dict:
    """Sums over systems."""
    nearest = np.concatenate([one.nearest for one in found])
    return {
        "systems": len(found),
        "cells": sum(one.cells for one in found),
        "cells without an answer": sum(one.unanswered for one in found),
        "multipliers above 1": sum(one.growing for one in found),
        "multipliers": nearest.size,
        "largest multiplier": float(nearest.max()),
        "motions": sum(one.motions for one in found),
        "motions with friction above its limit": sum(one.overloaded for one in found),
        "cells with other bits in a cut": sum(one.different for one in found),
    }


def _draw(multipliers: dict[str, np.ndarray], results: Path) -> None:
    """How far the multipliers are from 1."""
    figure = new_figure(7.0, 3.6)
    ax = figure.subplots()
    bins = np.logspace(-4.0, 0.0, 61)
    for name, values in multipliers.items():
        ax.hist(np.clip(1.0 - values, bins[0], 1.0), bins=bins, histtype="step", linewidth=1.5, label=name)
    ax.set(xscale="log", yscale="log", xlabel="1 - largest multiplier", ylabel="cells")
    ax.set_title("Steady states at mu = 1 attract: no multiplier above 1")
    ax.legend(fontsize=9, loc="upper left")
    save_figure(figure, results / "consistency.png")


def run(quick: bool, results: Path) -> dict:
    """Check, print, draw and save."""
    content, multipliers = {}, {}
    for number, kind in enumerate(KINDS):
        found = [check(np.random.default_rng([number, k]), kind) for k in range(SYSTEMS[quick])]
        content[kind] = _summary(found)
        multipliers[kind] = np.concatenate([one.nearest for one in found])
    keys = [key for key in content[KINDS[0]] if key not in ("systems", "largest multiplier")]
    table(("", *KINDS), [(key, *(content[kind][key] for kind in KINDS)) for key in keys])
    _draw(multipliers, results)
    content = {"random cells": content}
    save("consistency", content, results)
    return content

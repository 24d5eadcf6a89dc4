"""Design questions: time per answer, and answers against whole maps; borders between numbers of stops.

Times are those of one thread with everything compiled, medians of three. Random systems of one to three
masses, with a rigid contact of each kind or with a spring, are asked for the least peak; maps of 1,500
frequencies and 150 friction ratios, half of them around the answer, look for a better one. The peaks of their
three best friction ratios are refined by finer maps: without that a map misses up to 1 % of a narrow peak.

Borders are compared with a map: every change of the number of stops that is not beta_lim or beta_stick must
lie on one, and cells on both sides of its points must have their numbers.  Points beside which a cell has not
settled are left out.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr

import frictionmap as fm

from ..report.record import pinned, save, spread, table, timed

_ROUNDS = 3

#: Questions of the quick form.
_QUICK_QUESTIONS = ("two masses: least peak", "two masses, elastic contact: least peak", "two masses: margin")

#: Frequencies and friction ratios of the maps that look for better answers; random systems, of which the
#: quick form leaves out the first: three masses, for which the answer takes longer than for all others.
GRID, QUICK_GRID = (1500, 150), (150, 30)
RANDOM, QUICK_RANDOM = range(25), range(1, 4)

#: Lowest columns of a map that are compared, how many of their peaks, and how often these are refined.
_LOWEST, _PEAKS, _ZOOMS = 3, 4, 4

#: Relative distance from a border at which cells are compared, and from the ends of borders that is left out.
_BESIDE, _ENDS = 1e-6, 0.02

#: Relative distance within which a change of a map is on a border: chords are off by about 2e-5, more where
#: borders are steep.
_ON = 1e-3

#: Cells on a side of the maps that are compared with borders, and in the quick form.
_MAP, _QUICK_MAP = 2000, 150

CHAIN = {"contact_masses": [2], "mass_ratios": [1, 1], "stiffness_ratios": [1, 1]}
_FIVE = {"contact_masses": [3], "mass_ratios": [1] * 5, "stiffness_ratios": [1] * 5}

_BRACES = (
    fm.Contact("joined-base-wall", 1),
    fm.Contact("between-masses", (1, 2), ratio=0.5),
)


def _questions() -> dict[str, Callable[[], object]]:
    """Questions that are timed."""
    chain = fm.System(**CHAIN, damping_ratios=0.01)
    five = fm.System(**_FIVE, damping_ratios=0.02)
    elastic = fm.System(**CHAIN, contact_stiffness=2.0, damping_ratios=0.01)
    frame = fm.System(
        mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02, excitation="base",
        damping_reference="base", contacts=_BRACES,
    )  # fmt: skip
    design, band = fm.design, [0.3, 2.2]
    return {
        "two masses: least peak": lambda: design.least_peak(chain, band, threads=1),
        "two masses, mu = 1.2: least peak": lambda: design.least_peak(
            fm.System(**CHAIN, damping_ratios=0.05), [0.7, 1.9], mu=1.2, threads=1
        ),
        "two masses: robust to 20 %": lambda: design.robust(chain, band, 0.2, threads=1),
        "two masses: at most 4": lambda: design.at_most(chain, band, 4.0, threads=1),
        "five masses: least peak": lambda: design.least_peak(five, [0.2, 2.0], threads=1),
        "two masses, elastic contact: least peak": lambda: design.least_peak(elastic, [0.4, 2.2], threads=1),
        "two braces: least peak": lambda: design.least_peak(
            frame, [0.4, 2.0], mass=2, beta=[0.02, 10.0], threads=1
        ),
        "two masses: no stops": lambda: design.no_stop(chain, band),
        "two masses: stuck": lambda: design.stuck(chain, band),
        "two masses: margin": lambda: design.margin(chain, 0.9, 0.4),
    }


def times(quick: bool) -> dict:
    """Time per answer."""
    found = {}
    for name, ask in _questions().items():
        if quick and name not in _QUICK_QUESTIONS:
            continue
        ask()  # compiles
        found[name] = spread([timed(ask)[0] for _ in range(1 if quick else _ROUNDS)])
    table(("question", "s"), [(name, entry["median"]) for name, entry in found.items()])
    return found


def random_problem(random: np.random.Generator) -> tuple[fm.System, np.ndarray, int]:
    """A random damped system, a band, and a mass."""
    n = int(random.integers(1, 4))
    kind = random.choice(["fixed-wall", "between-masses", "joined-base-wall", "elastic"])
    keys = {
        "mass_ratios": [1.0, *random.uniform(0.4, 1.6, n - 1)],
        "stiffness_ratios": [1.0, *random.uniform(0.4, 1.6, n - 1)],
        "damping_ratios": random.uniform(0.005, 0.06),
        "contact_masses": [int(random.integers(1, n + 1))],
    }
    if kind == "between-masses" and n > 1:
        pair = random.choice(np.arange(1, n + 1), 2, replace=False)
        keys |= {"contact": "between-masses", "contact_masses": sorted(pair.tolist())}
    elif kind == "elastic":
        keys["contact_stiffness"] = 10.0 ** random.uniform(-1.0, 1.0)
    elif kind != "fixed-wall":
        keys |= {"contact": "joined-base-wall", "excitation": "base"}
    low, high = np.sort(random.uniform(0.3, 2.5, 2))
    return fm.System(**keys), np.array([low, max(high, 1.3 * low)]), int(random.integers(1, n + 1))


def better_in_a_map(quick: bool) -> dict:
    """Whether a map finds a better answer than the least peak, for random systems."""
    random, seconds, gains, kinds = np.random.default_rng(2026), [], [], []
    refused = 0
    counts, chosen = (QUICK_GRID, QUICK_RANDOM) if quick else (GRID, RANDOM)
    problems = [random_problem(random) for _ in range(chosen.stop)]
    for system, band, mass in problems[chosen.start :]:
        try:
            taken, ds = timed(lambda s=system, b=band, m=mass: fm.design.least_peak(s, b, mass=m, threads=1))
        except (fm.InputError, fm.NoSteadyState):
            refused += 1
            continue
        seconds.append(taken)
        kinds.append(str(ds.kind.values))
        gains.append(_gain(system, band, mass, ds, counts))
    found = {
        "systems": len(gains) + refused, "refused": refused, "grid": list(counts),
        "largest gain": max(gains), "seconds": spread(seconds),
        "kinds": {kind: kinds.count(kind) for kind in sorted(set(kinds))},
    }  # fmt: skip
    print(f"\n{len(gains)} random systems: maps are lower by up to {max(gains):.1e}; {found['kinds']}")
    return found


def _gain(system: fm.System, band: np.ndarray, mass: int, ds: xr.Dataset, counts: tuple[int, int]) -> float:
    """By how much the largest response of a map is lower than the answer, relative to it."""
    best, high = ds.beta.item(), float(ds.beta_search.values[-1])
    half = counts[1] // 2
    around = best or high / 500.0
    beta = np.union1d(np.geomspace(high / 500.0, high, half), np.linspace(0.5, 1.5, half) * around)
    beta = beta[beta >= ds.beta_search.values[0]]  # less friction is not asked for
    r = np.geomspace(*band, counts[0])
    found = fm.sweep(system, r, beta, outputs=["amplitude"], threads=1).amplitude.isel(mu=0, dof=mass - 1)
    columns = np.nan_to_num(found.values, nan=np.inf)
    lowest = np.argsort(columns.max(axis=0))[:_LOWEST]
    least = min(_zoomed(system, r, float(beta[j]), mass, columns[:, j]) for j in lowest)
    peak = float(ds.peak.values[0])
    return 1.0 - least / peak if peak > 1e-9 else 0.0


def _zoomed(system: fm.System, r: np.ndarray, beta: float, mass: int, column: np.ndarray) -> float:
    """Largest response at one beta: the local maxima of a column of a map, each by maps that are finer."""
    padded = np.concatenate(([-np.inf], column, [-np.inf]))
    peaks = np.flatnonzero((column > padded[:-2]) & (column >= padded[2:]))
    largest = 0.0
    for k in peaks[np.argsort(-column[peaks])[:_PEAKS]]:
        low, up = r[max(k - 1, 0)], r[min(k + 1, r.size - 1)]
        for _ in range(_ZOOMS):
            places = np.linspace(low, up, 21)
            cells = fm.sweep(system, places, [beta], outputs=["amplitude"], threads=1)
            sizes = cells.amplitude.values[0, :, 0, mass - 1]
            best = int(np.argmax(sizes))
            low, up = places[max(best - 1, 0)], places[min(best + 1, 20)]
        largest = max(largest, float(sizes[best]))
    return largest


#: Systems whose borders are found: window in r and beta, and the frequencies of the quick form.
_BORDERS = {
    "one mass, fixed wall": (fm.System(), (0.06, 1.3), (1e-3, 1.3), (0.32, 0.36)),
    "one mass, joined base-wall": (
        fm.System(contact="joined-base-wall"), (0.06, 2.5), (1e-3, 4.0), (0.32, 0.36),
    ),
    "two masses": (
        fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02), (0.12, 2.5), (1e-3, 2.0),
        None,
    ),
}  # fmt: skip


def borders(quick: bool) -> dict:
    """Borders of three systems against their maps."""
    found = {}
    for name, (system, wide, beta, narrow) in _BORDERS.items():
        r = narrow if quick else wide
        if r is None:
            continue
        taken, ds = timed(lambda s=system, x=r, y=beta: fm.borders(s, x, y))
        right, points = _counts_beside(system, ds)
        on, changes = _changes_on_borders(system, ds, r, beta, _QUICK_MAP if quick else _MAP)
        found[name] = {
            "r": list(r), "borders": ds.sizes["border"], "seconds": taken, "points compared": points,
            "points right": right, "changes of a map": changes, "changes on a border": on,
        }  # fmt: skip
        print(
            f"{name}: {ds.sizes['border']} borders in {taken:.1f} s; {right} of {points} points right, "
            f"{on} of {changes} changes of a map on a border",
            flush=True,
        )
    return found


def _border(ds: xr.Dataset, k: int) -> tuple[np.ndarray, np.ndarray]:
    r, beta = ds.border_r.values[k], ds.border_beta.values[k]
    known = ~np.isnan(r)
    return r[known], beta[known]


def _counts_beside(system: fm.System, ds: xr.Dataset) -> tuple[int, int]:
    """Points in the middle of borders with the stated numbers of stops on both sides, and all of them."""
    right = points = 0
    for k in range(ds.sizes["border"]):
        r, beta = _border(ds, k)
        length = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(np.log(r)), np.diff(np.log(beta))))))
        for j in np.flatnonzero((length > _ENDS) & (length < length[-1] - _ENDS))[:: max(1, r.size // 8)]:
            beside = beta[j] * np.array([1.0 - _BESIDE, 1.0 + _BESIDE])
            cells = fm.sweep(system, [r[j]], beside, outputs=["stops_per_cycle", "status"])
            if (cells.status != 0).any():
                continue
            stops = cells.stops_per_cycle.values.ravel()
            stated = ds.stops_below.values[k], ds.stops_above.values[k]
            right, points = right + int((stops == stated).all()), points + 1
    return right, points


def _changes_on_borders(
    system: fm.System, ds: xr.Dataset, r: tuple[float, float], beta: tuple[float, float], count: int
) -> tuple[int, int]:
    """Changes of the number of stops along beta in a map that lie on a border, and all of them."""
    x, y = np.linspace(*r, count), np.linspace(*beta, count)
    cells = fm.sweep(system, x, y, outputs=["stops_per_cycle", "status"])
    stops = np.where(cells.status == 0, cells.stops_per_cycle, np.nan)[0]
    changed = (stops[:, 1:] != stops[:, :-1]) & ~np.isnan(stops[:, 1:]) & ~np.isnan(stops[:, :-1])
    for name in ("beta_lim", "beta_stick"):
        limit = cells[name].values[0][:, np.newaxis]
        changed &= ~((y[:-1] <= limit) & (limit <= y[1:]))
    curves = [_border(ds, k) for k in range(ds.sizes["border"])]
    places = np.argwhere(changed)
    on = sum(any(_crosses(curve, x[i], y[j], y[j + 1]) for curve in curves) for i, j in places)
    return on, len(places)


def _crosses(curve: tuple[np.ndarray, np.ndarray], r: float, low: float, high: float) -> bool:
    x, y = curve
    inside = x[0] * (1.0 - _ON) <= r <= x[-1] * (1.0 + _ON)
    return bool(inside and low * (1.0 - _ON) <= np.interp(r, x, y) <= high * (1.0 + _ON))


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    with pinned():
        content = {
            "questions": times(quick),
            "random systems": better_in_a_map(quick),
            "borders": borders(quick),
        }
    save("design", content, results)
    return content

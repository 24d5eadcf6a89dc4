"""Boundary of continuous motion compared with the sum of maxima T(5.55) and with a simulation.

The structure is the chain of T Fig. 6.17: five masses, contact on mass 3, load on mass 1, mu = 1. The thesis
adds the maxima of S of the modes, each at its own time, which gives a lower bound (`beta_lim_modal`).
`beta_lim` takes the maximum of the sum. `references/naive.py` integrates the equations of motion and uses
neither. At some frequencies the smallest beta with stops is found by bisection, without damping and with a
little damping.

- Without damping, a march from rest takes thousands of periods. With mu = 1 the regime does not depend on the
  initial state, so any motion that repeats decides. A run starts from the steady state of
  `frictionmap.response`; the simulation checks that it is steady and whether it has stops. Where
  `frictionmap.response` finds none (next to the boundary), the run starts from the continuous motion at
  the largest beta without stops so far. It must stop in the last of 300 periods; otherwise the bisection
  ends.
- With 1 % damping every run starts from rest and continues until its state repeats, without any formula.

The full run draws docs/fig-5-55.png.
"""

import math
from pathlib import Path

import numpy as np

import frictionmap as fm

from .. import ROOT
from ..references.naive import naive_steady_state
from ..report.figures import new_figure, save_figure
from ..report.record import save

FIGURE = ROOT / "docs" / "fig-5-55.png"

MASSES, CONTACT = 5, 3
R = (0.2, 0.25, 0.27, 0.3, 0.36, 0.4, 0.42, 0.47, 0.53, 0.6, 0.7, 0.78)
QUICK_R = (0.6,)

#: Damping ratio of all modes, periods of a run, and width of the bracket left over its lower end.
UNDAMPED = (0.0, 300, 5e-4)
DAMPED = (0.01, 4000, 2e-3)


def chain(zeta: float) -> fm.System:
    """Chain of T Fig. 6.17."""
    ones = [1.0] * MASSES
    return fm.System(contact_masses=[CONTACT], mass_ratios=ones, stiffness_ratios=ones, damping_ratios=zeta)


def _state(system: fm.System, r: float, beta: float, below: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and velocities at tau = 0 of the computed steady state, or of a motion near it."""
    for start in ("rest", "moving"):
        try:
            ds = fm.response(system, r, beta, start=start, points=2)
        except fm.NoSteadyState:
            continue
        return ds.x.values[:, 0], ds.v.values[:, 0]
    motion = fm.continuous_motion(system, r, below)
    return motion.displacement(0.0)[:, 0], motion.velocity(0.0)[:, 0]


def stops(system: fm.System, r: float, beta: float, below: float, cycles: int) -> bool | None:
    """Whether the simulated steady state has stops, None if undecided; `below` is a beta without stops."""
    ones = [1.0] * MASSES
    start = "rest" if system.zeta else _state(system, r, beta, below)
    found = naive_steady_state(
        gamma=ones, kappa=ones, contact=("wall", CONTACT), load=1, zeta=system.zeta, r=r, beta=beta,
        start=start, cycles=cycles, tol=1e-10,
    )  # fmt: skip
    repeats = found.status in ("ok", "stuck")
    if not repeats and (system.zeta or found.stops == 0.0):
        return None
    return found.status == "stuck" or found.stops > 0.0


def bisect(system: fm.System, r: float, cycles: int, width: float) -> tuple[float, float]:
    """Find (largest beta without stops, smallest beta with stops)."""
    high = fm.boundaries(system, [r]).beta_stick.item()  # sticks there
    low = 1e-3 * high
    if stops(system, r, low, low, cycles) is not False:
        raise RuntimeError(f"r = {r}, beta = {low}: stops, or is left open, at the lower end of the search")
    while high - low > width * low:
        beta = math.sqrt(low * high)
        found = stops(system, r, beta, low, cycles)
        if found is None:
            break
        if found:
            high = beta
        else:
            low = beta
    return low, high


def _brackets(r: tuple[float, ...], zeta: float, cycles: int, width: float) -> list[dict]:
    """Brackets of the boundary by simulation, with the values of the formulas."""
    system = chain(zeta)
    curves = fm.boundaries(system, r)
    found = []
    for k, value in enumerate(r):
        low, high = bisect(system, value, cycles, width)
        exact, modal = curves.beta_lim.values[0, k], curves.beta_lim_modal.values[0, k]
        inside = bool(low <= exact <= high)
        found.append(
            {
                "r1": value,
                "no stops at": low,
                "stops at": high,
                "beta_lim": exact,
                "beta_lim_modal": modal,
                "beta_lim in the bracket": inside,
            }
        )
        print(
            f"zeta = {zeta:g}, r1 = {value:<4}: simulated {low:.6f} to {high:.6f}; beta_lim {exact:.6f} "
            f"({'inside' if inside else 'OUTSIDE'}), sum of maxima {modal:.6f}",
            flush=True,
        )
    return found


def draw(undamped: list[dict], damped: list[dict], path: Path) -> None:
    """Draw the curves and the simulated points."""
    ends = 0.17, 0.85
    r = np.unique(np.concatenate((np.linspace(*ends, 2721), [row["r1"] for row in undamped])))
    curves = fm.boundaries(chain(0.0), r)
    exact, modal = curves.beta_lim.values[0], curves.beta_lim_modal.values[0]
    purple = "#b04fa3"
    figure = new_figure(7.4, 6.8)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    top.set_title(
        "Friction above which a continuous motion begins to stop\n"
        r"five equal masses, contact on $m_3$, load on $m_1$ (thesis Fig. 6.17), $\mu = 1$, curves undamped",
        fontsize=10,
    )
    top.semilogy(
        r, exact, "k-", linewidth=1.4, label=r"$\beta_\mathrm{lim}$: maximum of the modes' sum (frictionmap)"
    )
    top.semilogy(r, modal, "-", color=purple, linewidth=1.2, label="sum of the modes' maxima, thesis (5.55)")
    top.set_ylim(2e-3, 9.0)
    top.set_ylabel(r"friction ratio $\beta$ [-]")
    top.text(0.5, 0.35, "stops in every cycle\n(or sticks for good, further up)", fontsize=9, style="italic")
    top.text(0.7, 0.012, "no stops", fontsize=9, style="italic")
    with np.errstate(invalid="ignore", divide="ignore"):
        bottom.plot(
            r, np.where(exact > 0.0, modal / exact, np.nan), "-", color=purple, linewidth=1.2,
            label="sum of the modes' maxima, thesis (5.55)",
        )  # fmt: skip
    bottom.axhline(1.0, color="k", linewidth=1.4, label=r"$\beta_\mathrm{lim}$")
    bottom.set_ylim(0.15, 1.1)
    bottom.set_ylabel(r"$\beta$ / $\beta_\mathrm{lim}$ [-]")
    bottom.set_xlabel(r"frequency ratio $r_1 = \omega/\sqrt{k_1/m_1}$ [-]")
    widest = 0.0
    for rows, marker, size, colour, label in (
        (undamped, "o", 6.0, "#e07b00", "simulated, no damping"),
        (
            damped,
            "s",
            10.0,
            "#2c5aa0",
            r"simulated from rest, 1 % damping, over its own $\beta_\mathrm{lim}$",
        ),
    ):
        low, high, own = (
            np.array([row[name] for row in rows]) for name in ("no stops at", "stops at", "beta_lim")
        )
        middle = np.sqrt(low * high)
        widest = max(widest, float(np.max(high / low - 1.0)))
        style = {
            "linestyle": "none", "marker": marker, "color": colour, "markersize": size,
            "markerfacecolor": "none", "markeredgewidth": 1.4,
        }  # fmt: skip
        places = [row["r1"] for row in rows]
        for axes in (top, bottom) if rows is undamped else (bottom,):
            axes.plot([], [], label=label, **style)
        if rows is undamped:
            top.errorbar(places, middle, (middle - low, high - middle), **style)
        bottom.errorbar(places, middle / own, ((middle - low) / own, (high - middle) / own), **style)
    bottom.text(
        0.175, 0.18, f"simulated brackets are at most {100.0 * widest:.2g} % wide", fontsize=8, color="0.3"
    )
    top.legend(loc="upper left", fontsize=9, framealpha=0.95)
    bottom.legend(loc="lower right", fontsize=8, framealpha=0.95)
    for axes in (top, bottom):
        axes.grid(alpha=0.25)
        axes.set_xlim(*ends)
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Bisect, print, save and draw."""
    r = QUICK_R if quick else R
    coarse = 10.0 if quick else 1.0
    undamped, damped = (
        _brackets(r, zeta, cycles, coarse * width) for zeta, cycles, width in (UNDAMPED, DAMPED)
    )
    content = {"no damping": undamped, "1 % damping, from rest": damped}
    save("bound", content, results)
    path = results / "fig-5-55.png" if quick else FIGURE
    draw(undamped, damped, path)
    return content

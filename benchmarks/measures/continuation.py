"""Response curves of one mass by programs for harmonic balance: time against error.

The curve is the amplitude over frequency at one friction, for a contact with a spring and for a rigid one.
Every program follows it by its own continuation, with more and more odd harmonics, and chooses frequencies by
itself; `frictionmap.sweep` then computes these frequencies.  Errors are those of max abs(z), relative to
frictionmap.  Times are per point, on one thread, without imports, compilation and start.
"""

import math
from pathlib import Path

import numpy as np

import frictionmap as fm

from ..peers.curve import CurvePeer, Rig
from ..peers.nlvib import NLvib
from ..peers.pyharm import PyHarm
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table, timed

PROGRAMS: tuple[type[CurvePeer], ...] = (PyHarm, NLvib)

#: What is followed.
RIGS = {
    "spring in the contact, kt/k_1 = 3": Rig(0.05, 0.4, 3.0, (0.4, 1.6)),
    "spring in the contact, kt/k_1 = 30": Rig(0.05, 0.4, 30.0, (0.4, 1.6)),
    "rigid contact": Rig(0.05, 0.4, None, (0.4, 1.6)),
}

#: Highest harmonic, by quick; runs of frictionmap.
HIGHEST, _ROUNDS = {False: (1, 3, 5, 9, 15), True: (3,)}, {False: 7, True: 2}

_COLOURS = {"pyHarm": "#9a4f96", "NLvib": "#b2552f"}


def system_of(rig: Rig) -> fm.System:
    """The rig as the package defines it."""
    return fm.System(contact="fixed-wall", damping_ratios=rig.zeta, contact_stiffness=rig.stiffness)


def point(program: CurvePeer, highest: int, rounds: int) -> dict:
    """Time and errors of one program at one number of harmonics; `failure` if there is no curve."""
    try:
        curve = program.curve(highest)
    except RuntimeError as error:
        return {"highest harmonic": highest, "failure": str(error)}
    r, places = np.unique(curve.r, return_index=True)
    if r.size < 2:
        return {"highest harmonic": highest, "failure": "the second step did not converge"}
    system, beta = system_of(program.rig), [program.rig.beta]
    runs = [timed(lambda: fm.sweep(system, r, beta, threads=1)) for _ in range(rounds + 1)][1:]
    exact = runs[0][1].contact_amplitude.values.squeeze()
    slides = exact > 0.0
    errors = np.abs(curve.amplitudes[places][slides] / exact[slides] - 1.0)
    ours = [seconds / r.size for seconds, _ in runs]
    return {
        "highest harmonic": highest,
        "points": int(r.size),
        "steps that did not converge": curve.failed,
        "followed up to r": curve.arrived,
        "seconds a point": curve.seconds / len(curve.r),
        "our seconds a point": spread(ours),
        "ratio": curve.seconds / len(curve.r) / spread(ours)["median"],
        "median relative error of Z": float(np.median(errors)),
        "largest relative error of Z": float(errors.max()),
    }


def curves(quick: bool) -> dict:
    """Measure and print all programs on all rigs."""
    content: dict = {}
    rows = []
    for name, rig in RIGS.items():
        content[name] = {"rig": rig._asdict(), "programs": {}}
        for kind in PROGRAMS:
            if why := kind.why_missing():
                print(f"{kind.name}: skipped, {why}")
                content[name]["programs"][kind.name] = {"skipped": why}
                continue
            program, counts = kind(rig), [one for one in HIGHEST[quick] if one <= kind.most]
            points = [point(program, highest, _ROUNDS[quick]) for highest in counts]
            content[name]["programs"][kind.name] = {"version": kind.version(), "points": points}
            rows += [(name, kind.name, *row(one)) for one in points]
    heads = "harmonics up to", "us a point", "ratio", "error, median", "largest", "points", "up to r"
    table(("curve", "program", *heads), rows)
    return content


def row(one: dict) -> tuple:
    """Row of the printed table."""
    if "failure" in one:
        return (one["highest harmonic"], *[math.nan] * 4, 0, one["failure"])
    return (
        one["highest harmonic"], 1e6 * one["seconds a point"], one["ratio"],
        one["median relative error of Z"], one["largest relative error of Z"], one["points"],
        one["followed up to r"],
    )  # fmt: skip


def draw(content: dict, path: Path) -> None:
    """Draw time over error, a panel per rig."""
    figure = new_figure(12.0, 4.0)
    for axes, (name, entry) in zip(figure.subplots(1, len(content)), content.items(), strict=True):
        for program, found in entry["programs"].items():
            points = [one for one in found.get("points", ()) if "failure" not in one]
            if not points:
                continue
            errors = [one["median relative error of Z"] for one in points]
            seconds = [one["seconds a point"] for one in points]
            axes.loglog(errors, seconds, marker="o", color=_COLOURS[program], label=program)
            for error, taken, one in zip(errors, seconds, points, strict=True):
                text, off = str(one["highest harmonic"]), (3, 3)
                axes.annotate(text, (error, taken), off, textcoords="offset points", fontsize=8)
            ours = points[-1]["our seconds a point"]["median"]
            axes.axhline(ours, color="#2c5aa0", label="frictionmap, exact")
        axes.set(xlabel="relative error, median", ylabel="time per point [s]")
        axes.set_title(name, fontsize=10)
        axes.grid(alpha=0.25)
        handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
        axes.legend(handles.values(), handles.keys(), fontsize=8)
    save_figure(figure, path)


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    with pinned():
        content = {"curves": curves(quick)}
    save("continuation", content, results)
    draw(content["curves"], results / "continuation.png")
    return content

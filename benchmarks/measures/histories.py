"""Motions in time under records: time against error, beside other solvers; time of long records.

One mass (period 0.8 s, damping ratio 0.05) and a frame of two storeys with a brace that rubs, under 1,000
samples of 0.02 s.  The error is the largest difference of a displacement at the samples, over the largest
displacement.  Solvers with events are compared with frictionmap's rigid contact, OpenSees with frictionmap's
elastic contact of the same stiffness; the difference of the two is given, too.  Times are those of
complete calls.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

import frictionmap as fm

from ..peers.shaken import (
    HeyokaShaken,
    OpenSees,
    OpenSeesBearing,
    ScipyShaken,
    ScipyThrough,
    Shaken,
    ShakenPeer,
)
from ..report.figures import new_figure, save_figure
from ..report.record import pinned, save, spread, table, timed

#: Samples of the compared record, by quick, and their distance [s].
SAMPLES, STEP = {False: 1000, True: 60}, 0.02

#: Largest acceleration of the base [m/s^2]; friction over m_1.
PEAK, FRICTION = 1.4, 0.175

PERIOD, DAMPING = 0.8, 0.05

#: Oscillators of a spectrum.
OSCILLATORS = 512

#: Contact stiffness of OpenSees over k_1.
STIFFNESSES = (3.0, 30.0, 1000.0)

#: Displacement at which OpenSees's bearing yields [m].
YIELD = 0.25e-3

_ROUNDS = {False: 5, True: 1}

#: Samples of the long record, by quick, and friction over that from which nothing moves.
LONG, SHARES = {False: 100_000, True: 400}, (1.01, 0.5, 0.05)


def noise(count: int) -> np.ndarray:
    """Coloured noise from 0, with the largest modulus 1."""
    white = np.random.default_rng(1).standard_normal(count)
    values = np.convolve(white, np.exp(-np.arange(40) / 8.0), "same")
    values[0] = 0.0
    return values / np.abs(values).max()


def system(masses: int, contact_stiffness: float | None = None) -> fm.System:
    """One mass, or two storeys, with a contact between base and first mass."""
    return fm.System(
        mass_ratios=[1.0] * masses, stiffness_ratios=[1.0] * masses, damping_ratios=DAMPING,
        excitation="base", damping_reference="base",
        contacts=[fm.Contact("joined-base-wall", 1, stiffness=contact_stiffness)],
    )  # fmt: skip


def body(masses: int, acceleration: np.ndarray) -> Shaken:
    """The same for other solvers, with the fundamental period `PERIOD`."""
    shape = 2.0 * np.eye(masses) - np.eye(masses, k=1) - np.eye(masses, k=-1)
    shape[-1, -1] = 1.0
    values, modes = np.linalg.eigh(shape)
    k1 = (2.0 * np.pi / PERIOD) ** 2 / values[0]
    damping = modes @ np.diag(2.0 * DAMPING * np.sqrt(k1 * values)) @ modes.T
    return Shaken(k1 * shape, damping, 0, FRICTION, acceleration, STEP)


def ours(given: Shaken, contact_stiffness: float | None, rounds: int) -> tuple[dict, np.ndarray]:
    """Seconds of `history`, and displacements at the samples [m]."""
    omega = np.sqrt(given.stiffness[0].sum())
    structure = system(given.n, contact_stiffness)
    record = fm.Record(given.acceleration, dt=STEP * omega)

    def follow() -> object:
        return fm.history(structure, record, beta=FRICTION, after=0.0, threads=1)

    runs = [timed(follow) for _ in range(rounds + 1)]
    ds = runs[-1][1].squeeze(["record", "scale", "mu", "beta"])
    times = np.arange(given.acceleration.size) * (STEP * omega)
    # both sides of every event are kept beside the samples
    at = np.searchsorted(ds.time.values, times * (1.0 - 1e-13))
    at = np.minimum(at, ds.time.size - 1)
    np.testing.assert_allclose(ds.time.values[at], times, rtol=1e-12)
    return spread([seconds for seconds, _ in runs[1:]]), ds.x.values[:, at] / omega**2


def many(given: Shaken, rounds: int) -> dict:
    """Seconds of a spectrum of `OSCILLATORS` frictions about `FRICTION`: peaks, residuals and stops."""
    record = fm.Record(given.acceleration, dt=STEP)
    friction = FRICTION * np.linspace(0.8, 1.2, OSCILLATORS)
    runs = [
        timed(lambda: fm.spectrum(record, PERIOD, friction, damping=DAMPING, threads=1))[0]
        for _ in range(rounds + 1)
    ]
    return {"oscillators": OSCILLATORS, "seconds": spread(runs[1:])}


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference over the largest displacement."""
    return float(np.abs(one - other).max() / np.abs(other).max())


def solvers(given: Shaken, quick: bool) -> Iterator[tuple[str, type[ShakenPeer], dict, tuple[float, ...]]]:
    """Name, class, further arguments and settings of the other solvers."""
    yield HeyokaShaken.name, HeyokaShaken, {}, (1e-6, 2.0**-52)
    yield ScipyShaken.name, ScipyShaken, {}, (1e-6, 1e-12)
    yield ScipyThrough.name, ScipyThrough, {}, (1e-3, 1e-6, 1e-9)
    for kt in STIFFNESSES[: 1 if quick else None]:
        yield f"OpenSeesPy, kt/k_1 = {kt:g}", OpenSees, {"kt": kt}, (1, 4, 16, 64)[: 2 if quick else None]
    if given.n == 1:
        kt = FRICTION / (YIELD * float(given.stiffness[0, 0]))
        yield "OpenSeesPy, singleFPBearing", OpenSeesBearing, {"kt": kt}, (1, 4, 16)[: 2 if quick else None]


def _points(given: Shaken, peer: type[ShakenPeer], more: dict, settings: tuple, expected: tuple) -> list:
    """Time and error of every setting; expected : displacements of the same contact, of a rigid one."""
    points = []
    for value in settings:
        solver = peer(given, value, **more)
        seconds, found = timed(solver.run)
        points.append(
            {
                peer.setting: value, "seconds": spread([seconds]),
                "error": difference(found, expected[0]),
                "from a rigid contact": difference(found, expected[1]),
                "repeated steps": getattr(solver, "repeated", 0),
            }
        )  # fmt: skip
    return points


def scene(masses: int, quick: bool) -> dict:
    """One structure by every solver."""
    given = body(masses, PEAK * noise(SAMPLES[quick] + 1))
    rigid = ours(given, None, _ROUNDS[quick])
    at_once = many(given, _ROUNDS[quick]) if masses == 1 else {}
    elastic = {kt: ours(given, kt, _ROUNDS[quick]) for kt in STIFFNESSES}
    others = {}
    for name, peer, more, settings in solvers(given, quick):
        if why := peer.why_missing():
            others[name] = {"skipped": why}
            continue
        kt = more.get("kt")
        if kt and kt not in elastic:
            elastic[kt] = ours(given, kt, _ROUNDS[quick])
        expected = (elastic[kt] if kt else rigid)[1], rigid[1]
        points = _points(given, peer, more, settings, expected)
        others[name] = {"setting": peer.setting, "version": peer.version(), "points": points}
    return {
        "samples": SAMPLES[quick],
        "frictionmap": {"seconds": rigid[0]},
        "frictionmap, many": at_once,
        "frictionmap, elastic": {
            f"{kt:g}": {"seconds": seconds, "from a rigid contact": difference(x, rigid[1])}
            for kt, (seconds, x) in elastic.items()
        },
        "other solvers": others,
    }


def long_record(quick: bool) -> dict:
    """Five masses with three contacts under a long record: time, and time of a sample with events."""
    count = LONG[quick]
    structure = fm.System(
        mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5, damping_ratios=0.02, excitation="base",
        damping_reference="base",
        contacts=[
            fm.Contact("joined-base-wall", 1), fm.Contact("between-masses", [2, 3]),
            fm.Contact("between-masses", [4, 5]),
        ],
    )  # fmt: skip
    record = fm.Record(noise(count), dt=0.2)
    hold = float(fm.history(structure, record, beta=1.0, samples="none", threads=1).beta_hold.squeeze())
    rows, quiet = {}, 0.0
    for share in SHARES:
        runs = [
            timed(
                lambda beta=share * hold: fm.history(
                    structure, record, beta=beta, after=0.0, samples="none", threads=1
                )
            )
            for _ in range(_ROUNDS[quick] + 1)
        ]
        seconds = spread([taken for taken, _ in runs[1:]])
        events = float(runs[-1][1].events.squeeze())
        quiet = quiet or seconds["least"]
        each = (seconds["least"] - quiet) / events if events else None
        rows[f"{share:g}"] = {
            "seconds": seconds, "events a sample": events / count, "seconds an event": each,
        }  # fmt: skip
    return {"samples": count, "friction over beta_hold": rows}


def _draw(scenes: dict, samples: int, folder: Path) -> None:
    """Time of a sample against error."""
    figure = new_figure(9.0, 4.2)
    axes = figure.subplots(1, 2, sharey=True)
    for ax, (name, found) in zip(axes, scenes.items(), strict=True):
        for solver, entry in found["other solvers"].items():
            if "points" not in entry:
                continue
            error = [max(point["error"], 1e-16) for point in entry["points"]]
            micro = [1e6 * point["seconds"]["median"] / samples for point in entry["points"]]
            ax.loglog(error, micro, "o-", label=solver, markersize=4, linewidth=1.0)
        ax.axhline(
            1e6 * found["frictionmap"]["seconds"]["median"] / samples, color="black", linewidth=1.2,
            label="frictionmap: exact",
        )  # fmt: skip
        if at_once := found["frictionmap, many"]:
            ax.axhline(
                1e6 * at_once["seconds"]["median"] / samples / at_once["oscillators"], color="black",
                linestyle=":", label=f"frictionmap: peaks of {at_once['oscillators']} masses",
            )  # fmt: skip
        ax.set_title(name, fontsize=10)
        ax.set_xlabel("error of the motion over its peak")
        ax.grid(visible=True, alpha=0.3)
    axes[0].set_ylabel("time per sample [µs]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    save_figure(figure, folder / "histories.png")


def run(quick: bool, results: Path) -> dict:
    """Measure, print, draw and save."""
    with pinned():
        scenes = {"one mass": scene(1, quick), "frame with a brace": scene(2, quick)}
        five = long_record(quick)
    for name, found in scenes.items():
        print(f"\n{name}: {1e6 * found['frictionmap']['seconds']['median'] / SAMPLES[quick]:.3g} us a sample")
        table(
            ("solver", "setting", "us a sample", "error", "from a rigid contact", "repeated steps"),
            [
                (
                    solver, f"{entry['setting']} = {point[entry['setting']]:g}",
                    1e6 * point["seconds"]["median"] / SAMPLES[quick], point["error"],
                    point["from a rigid contact"], point["repeated steps"],
                )
                for solver, entry in found["other solvers"].items()
                for point in entry.get("points", ())
            ],
        )  # fmt: skip
        for solver, entry in found["other solvers"].items():
            if "skipped" in entry:
                print(f"{solver}: {entry['skipped']}")
    table(
        ("five masses, friction over beta_hold", "seconds", "events a sample", "us an event"),
        [
            (share, row["seconds"]["least"], row["events a sample"], 1e6 * (row["seconds an event"] or 0.0))
            for share, row in five["friction over beta_hold"].items()
        ],
    )
    _draw(scenes, SAMPLES[quick], results)
    content = {"scenes": scenes, "five masses, three contacts": five}
    save("histories", content, results)
    return content

"""Tables of docs/results.md about motions in time: beside other solvers, and times of long records."""

from collections.abc import Iterator

from .quoting import duration, markdown, rounded_off, two_digits

_NAMES = {
    "heyoka": "heyoka with events",
    "solve_ivp DOP853": "`solve_ivp` (DOP853 with events), sample by sample",
    "solve_ivp DOP853, through samples": "`solve_ivp` (DOP853 with events), steps through samples",
}

#: Load of the machine per processor at which others compute beside the benchmark.
_BUSY = 0.75

#: Targets: name of a spectrum of one period or of a share of friction, and seconds.
_SAMPLE, _EVENT, _SEVERAL = 2.5e-9, 250e-9, 2e-6
_SPECTRUM, _LONG, _SUITE = 0.4, 60e-3, 30.0


def _setting(entry: dict, point: dict) -> str:
    value = point[entry["setting"]]
    return f"{entry['setting']} = {value:g}" if value >= 1 else f"{entry['setting']} = {rounded_off(value)}"


def _rows(name: str, found: dict, every: bool) -> Iterator[tuple[str, ...]]:
    """Every setting of every solver for one structure, or the most accurate ones."""
    samples = found["samples"]
    ours = duration(found["frictionmap"]["seconds"]["median"] / samples)
    yield name, "frictionmap (`history`)", "", ours, "exact", "exact"
    if at_once := found["frictionmap, many"]:
        count = at_once["oscillators"]
        each = duration(at_once["seconds"]["median"] / samples / count)
        yield name, "frictionmap (`spectrum`, peaks only)", f"{count} frictions", each, "exact", "exact"
    for solver, entry in found["other solvers"].items():
        for point in entry.get("points", [])[None if every else -1 :]:
            yield (
                name, _NAMES.get(solver, solver), _setting(entry, point),
                duration(point["seconds"]["median"] / samples), rounded_off(point["error"]),
                rounded_off(point["from a rigid contact"]),
            )  # fmt: skip


def _target(what: str, seconds: float, target: float) -> tuple[str, ...]:
    return what, duration(seconds), duration(target), "yes" if seconds <= target else "no"


def _spectrum_rows(spectrum: dict) -> Iterator[tuple[str, ...]]:
    periods = spectrum["one period"]
    yield _target("a sample of one oscillator, no event", 1e-9 * periods["held"]["ns_a_sample"], _SAMPLE)
    events = [row["ns_an_event"] for row in periods.values() if row["ns_an_event"]]
    if events:
        yield _target("an event of one oscillator", 1e-9 * max(events), _EVENT)
    whole = spectrum["spectrum"]["least"]
    yield _target(f"spectrum, 32 x 16 oscillators, {spectrum['samples']:,} samples", whole, _SPECTRUM)
    suite = spectrum["suite"]
    yield _target(
        f"suite of {suite['records']} records, 100 periods, 20 friction forces, 10,000 samples, from "
        f"{suite['measured records']} records",
        suite["seconds, all"], _SUITE,
    )  # fmt: skip


def _long_rows(five: dict) -> Iterator[tuple[str, ...]]:
    rows = list(five["friction over beta_hold"].values())
    each = [row["seconds an event"] for row in rows if (row["seconds an event"] or 0.0) > 0.0]
    if each:
        yield _target("an event of five masses with three contacts", max(each), _SEVERAL)
    busy = rows[-1]
    yield _target(
        f"five masses, three contacts, {five['samples']:,} samples, {two_digits(busy['events a sample'])} "
        "events per sample",
        busy["seconds"]["least"], _LONG,
    )  # fmt: skip


def _notes(histories: dict) -> Iterator[str]:
    yield (
        "DOP853 looks for changes of sign between the ends of its steps. Its error for the frame, sample by "
        "sample, is a missed event; with steps of a tenth of a sample it is at rounding. Where its steps do "
        "not end at the samples, the kinks of the load cost accuracy, too."
    )
    yield (
        "OpenSees converges to frictionmap's elastic contact with the square of its step. A spring of 30 k_1 "
        "in series with the contact changes the motion by several per cent. singleFPBearing has its own "
        "geometry of the dish: its difference falls with displacement over radius, not with the step."
    )
    skipped = {
        name: found["skipped"]
        for scene in histories["scenes"].values()
        for name, found in scene["other solvers"].items()
        if "skipped" in found
    }
    for name, why in skipped.items():
        yield f"Not measured: {name} ({why})."
    machine = histories["machine"]
    if (machine["load"] or 0.0) > _BUSY * machine["processors"]:
        yield (
            f"The machine was busy with other work during this run (load {two_digits(machine['load'])} on "
            f"{machine['processors']} processors), so that the times are upper bounds."
        )


def histories_lines(histories: dict | None, spectrum: dict | None) -> list[str]:
    """Lines of the section on motions in time."""
    lines = ["", "### Motions in time"]
    if histories:
        first, *_ = histories["scenes"]
        rows = [
            row for name, found in histories["scenes"].items() for row in _rows(name, found, name == first)
        ]
        samples = histories["scenes"][first]["samples"]
        lines += [
            "",
            "One mass, and a frame of two storeys with a friction brace, under a random record of "
            f"{samples:,} samples. Errors are the largest differences of the displacements at the samples "
            "over the peak. OpenSees has no rigid contact: its error is relative to frictionmap's elastic "
            "contact of the same stiffness, and the last column is the difference from the rigid contact.",
            *markdown(
                ("structure", "solver", "setting", "time per sample", "error", "from a rigid contact"), rows
            ),
            "",
            "![Time per sample against error, one mass and a frame](../benchmarks/results/histories.png)",
            "",
            *(f"- {note}" for note in _notes(histories)),
        ]
    targets = list(_spectrum_rows(spectrum)) if spectrum else []
    targets += list(_long_rows(histories["five masses, three contacts"])) if histories else []
    return [*lines, *markdown(("one thread", "time", "target", "met"), targets)]

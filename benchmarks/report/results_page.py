"""Tables of docs/results.md, generated from the results between two marker comments.

    python -m benchmarks all --results benchmarks/results
    python -m benchmarks page

measures everything and writes the tables again; a test compares them with the committed results.  Benchmarks
without results are left out.
"""

import json
from collections.abc import Iterator
from pathlib import Path

from .. import ROOT
from .quoted_coverage import coverage_lines
from .quoted_curves import continuation_lines, laws_lines
from .quoted_design import design_lines
from .quoted_errors import accuracy_lines, steady_lines, stress_lines
from .quoted_first_minute import first_minute_lines
from .quoted_general import consistency_lines, general_lines, many_contacts_lines
from .quoted_histories import histories_lines
from .quoting import duration, markdown, rounded_off, two_digits

PAGE = ROOT / "docs" / "results.md"
BEGIN = "<!-- from benchmarks/results by `python -m benchmarks page`: do not edit -->"
END = "<!-- end of the results -->"

#: Benchmarks whose results are quoted.
QUOTED = (
    "peers",
    "structures",
    "general",
    "continuation",
    "laws",
    "consistency",
    "design",
    "histories",
    "spectrum",
    "accuracy",
    "stress",
    "steady",
    "scaling",
    "startup",
    "large",
    "coupling",
    "coverage",
    "explore",
    "first_minute",
    "static",
    "banks",
)

#: Benchmarks that are quoted as soon as their results are there.
QUOTED_LATER = ("many_contacts",)


def _row(what: str, ours: float, theirs: float) -> tuple[str, ...]:
    return what, duration(ours), duration(theirs), two_digits(theirs / ours)


# ---------------------------------------------------------------- peers


_PEER_NAMES = {
    "solve_ivp RK45": "scipy's `solve_ivp` (RK45 with events)",
    "heyoka": "heyoka's Taylor integrator with events",
    "heyoka, batch": "heyoka's batch mode",
    "solve_ivp DOP853": "`solve_ivp` (DOP853)",
}

#: Names of scenes and measurements of `explore` and `startup` in the results, and the words in the tables.
_WORDS = {
    "started to address": "start of the server to its address",
    "loaded to painted": "first load to finished map",
    "loaded again to painted": "later load to finished map",
    "slider to painted": "slider to finished map",
    "hover to motion": "pointing at a cell to its motion",
    "first picture": "slider to first map",
    "full picture": "slider to finished map",
    "outdated": "cancellation of an old computation",
    "python, doing nothing": "python without a program",
}


def _peer_rows(peers: dict) -> Iterator[tuple[str, ...]]:
    for name, entry in peers["cells"].items():
        if "ratio" in entry:
            yield _row(
                f"a moving cell of T Fig. 3.12, against {_PEER_NAMES.get(name, name)}",
                entry["our seconds a cell"]["median"],
                entry["seconds a cell"]["median"],
            )
    for mu, entry in peers["map"].items():
        sample = entry.get("heyoka, extrapolated from random cells")
        if sample:
            yield _row(
                f"the map of T Fig. 3.12, {mu} ({entry['cells']:,} cells), against heyoka, extrapolated "
                f"from {sample['cells']} random cells",
                entry["seconds"]["median"],
                sample["seconds"],
            )


def _structure_rows(structures: dict) -> Iterator[tuple[str, ...]]:
    for name, by_damping in structures["peers"].items():
        for damping, entry in by_damping.items():
            if isinstance(entry, dict):
                yield _row(
                    f"an open cell of five masses, {damping}, against {_PEER_NAMES.get(name, name)}",
                    entry["our seconds a cell"]["median"],
                    entry["seconds a cell"]["median"],
                )


def _answers(peers: dict | None, structures: dict | None) -> str:
    """Sentence on the number of compared cells and the differences of the results."""
    one = [e for e in peers["cells"].values() if "ratio" in e] if peers else []
    many = [
        e
        for by_damping in (structures["peers"].values() if structures else ())
        for e in by_damping.values()
        if isinstance(e, dict)
    ]
    cells = sum(entry["cells"] for entry in one + many)
    other = sum(entry["differences"]["cells with other stop counts"] for entry in one)
    other += sum(len(entry["differences"]["cells with other stop counts"]) for entry in many)
    text = f"{cells:,} cells were compared; {other or 'none'} of them had a different number of stops."
    medians = [
        f"{rounded_off(entry['differences']['median relative difference of Z'])} ({name})"
        for name, entry in (peers["cells"].items() if peers else ())
        if "ratio" in entry
    ]
    return (
        f"{text} The median relative difference of the amplitudes of one mass is {', '.join(medians)}."
        if medians
        else text
    )


def _caveats(peers: dict | None, structures: dict | None) -> Iterator[str]:
    """Sentences on what the ratios do not include."""
    share = (peers or {"cells": {}})["cells"].get("heyoka", {}).get("share of the time in the integrator")
    if share is not None:
        yield (
            f"For one mass, heyoka spends {two_digits(100.0 * share)} % of its time in the integrator and "
            "the rest in the logic for stops, which is written in Python. With the batch mode this logic "
            "works on arrays."
        )
    lower = [
        entry["ratio with the curves"] / entry["ratio"]
        for by_damping in (structures["peers"].values() if structures else ())
        for entry in by_damping.values()
        if isinstance(entry, dict)
    ]
    if lower:
        yield (
            "The times of frictionmap are those of the kernel for maps. The cells of a map share the "
            "boundaries of their frequency. If the time for these boundaries is added to each cell, the "
            f"ratios for five masses are {two_digits(min(lower))} to {two_digits(max(lower))} times those in "
            "the table."
        )


def _newton(peers: dict) -> str:
    """Sentences on the gain of Newton's method, also next to a resonance."""
    ways = [
        (name, kind, one)
        for name, entry in peers["solved and marched"].items()
        if isinstance(entry, dict)
        for kind, one in entry.items()
    ]
    gains = sorted((one["ratio"], name) for name, kind, one in ways if kind == "open cells")
    near = [one["seconds a cell, solved"]["median"] for _, kind, one in ways if kind != "open cells"]
    least, most = (f"{two_digits(ratio)} ({name})" for ratio, name in (gains[0], gains[-1]))
    shares = [one["ratio"] for _, kind, one in ways if kind != "open cells"]
    return (
        f"Newton's method solves an open cell {least} to {most} times as fast as marching until the motion "
        'repeats. Continuous cells next to a resonance are integrated only with `skip = "none"` or mu > '
        f"1. They take {duration(min(near))} to {duration(max(near))}. Marching without Newton's method "
        f"takes {two_digits(min(shares))} to {two_digits(max(shares))} times as long."
    )


def _peer_lines(peers: dict | None, structures: dict | None) -> list[str]:
    """Lines of the section on general-purpose solvers."""
    rows = list(_peer_rows(peers)) if peers else []
    rows += _structure_rows(structures) if structures else []
    notes = [_answers(peers, structures), *_caveats(peers, structures)]
    notes += [_newton(peers)] if peers else []
    return [
        "",
        "### Against general-purpose solvers",
        *markdown(("one thread", "frictionmap", "other solver", "ratio"), rows),
        "",
        *(f"- {note}" for note in notes),
    ]


# ---------------------------------------------------------------- growth


def _growth_rows(scaling: dict) -> Iterator[tuple[str, ...]]:
    """Memory, and powers by which times grow."""
    for name, entry in scaling.get("memory", {}).items():
        most = max(entry["runs"], key=lambda run: run["size"])
        yield (
            f"{most['size']:,} {name} in one process",
            f"{duration(most['seconds'])}, {most['MB']:.0f} MB of memory, {most['MB before']:.0f} MB of them "
            f"for the program; time grows as the power {entry['slope of the time']:.2f} of the size",
        )
    if "harmonics" in scaling:
        first, *_, last = scaling["harmonics"]["rows"]
        yield (
            "stick-slip cell under a square wave of up to "
            f"{first['highest harmonic']} and {last['highest harmonic']} harmonics",
            f"{duration(1e-6 * first['us a cell']['median'])} and "
            f"{duration(1e-6 * last['us a cell']['median'])}; the power is "
            f"{scaling['harmonics']['slope']:.2f} at the end",
        )


def _scaling_rows(scaling: dict) -> Iterator[tuple[str, ...]]:
    for mu, rows in scaling["cells"]["maps"].items():
        done = [row for row in rows if "seconds" in row]
        last = done[-1]
        yield (
            f"map of T Fig. 3.12 on successively finer grids, {mu}, one thread",
            f"{duration(done[0]['seconds']['median'])} for {done[0]['cells']:,} cells, "
            f"{duration(last['seconds']['median'])} for {last['cells']:,} "
            f"({duration(1e-9 * last['ns a cell'])} per cell)",
        )
    memory = scaling["cells"]["bytes a cell"]
    yield "memory of the three default outputs", f"{two_digits(memory)} bytes per cell"
    yield from _growth_rows(scaling)
    threads = scaling["threads"]["threads"]
    most = max(threads, key=int)
    yield (
        f"{most} threads",
        f"{two_digits(threads[most]['speed-up'])} times as fast, results equal to the bit",
    )
    line = scaling["open cells"]
    closed = max(line["line: ns a closed cell"], 0.0)
    yield (
        "time per cell",
        f"{duration(1e-9 * closed)} for a cell that a formula decides, "
        f"{duration(1e-9 * line['line: ns more an open cell'])} more for an open cell",
    )
    low = scaling["low frequency"]["zeta = 0"]
    ends = [f"{duration(1e-6 * row['us a cell']['median'])} at r = {row['r']:g}" for row in low]
    settled = [text for text, row in zip(ends, low, strict=True) if row["cells that do not repeat"] == 0]
    yield "open cell of an undamped mass at low frequency", f"{settled[0]}, {settled[-1]}"
    odd = [
        f"{text} ({row['cells that do not repeat']} of {row['cells']} cells do not become periodic)"
        for text, row in zip(ends, low, strict=True)
        if row["cells that do not repeat"] > 0
    ]
    if odd:
        yield "the same, with motions that do not become periodic within `cycles`", ", ".join(odd)
    phases = scaling["phases"].values()
    kernel = [entry["kernel"]["median"] for entry in phases]
    ratios = [entry["kernel over its closed forms"] for entry in phases]
    least, most = two_digits(min(ratios)), two_digits(max(ratios))
    yield (
        "a slide or stop of one mass",
        f"{min(kernel):.0f} to {max(kernel):.0f} ns, {least if least == most else f'{least} to {most}'} "
        "times as long as its closed forms alone",
    )


def _large_rows(large: dict) -> Iterator[tuple[str, ...]]:
    last = large["size"][-1]
    yield (
        f"store with {last['n'] ** 2:,} cells of T Fig. 3.12, mu = 1",
        f"{duration(last['store']['seconds'])}, {last['store']['MB']:.0f} MB of memory, "
        f"{last['store']['disk MB']:.0f} MB on disk",
    )
    yield (
        "processor time of a store, relative to the same map in memory",
        f"{two_digits(large['overhead']['ratio'])}",
    )
    study = large["study"]
    each = study["cells"] // study["samples"]
    yield (
        f"{study['samples']:,} random variations of five masses, {each:,} cells each",
        duration(study["seconds"]),
    )
    if "speed-up" in large["workers"]:
        yield (
            "two worker processes",
            f"{two_digits(large['workers']['speed-up'])} times as fast as one, results equal to the byte",
        )
    kills = large["kills"]
    yield (
        "runs killed at random moments",
        f"{kills['killed']} killed, {kills['finished']} finished, {kills['different']} with different bytes",
    )
    ahead = large["ahead"]["minutes of 1e10 cells on 100 machines"]
    yield (
        "10^10 cells on 100 machines like this one, estimated from the above",
        ", ".join(f"{name} {two_digits(minutes)} min" for name, minutes in ahead.items()),
    )


def _static_rows(static: dict) -> Iterator[tuple[str, ...]]:
    for name, entry in static["scenes"].items():
        faster = f", {two_digits(entry['ratio'])} times as fast as version 0.2" if "ratio" in entry else ""
        yield (
            f"map of {name}, {entry['cells']:,} cells, one thread",
            (f"{duration(entry['seconds']['this']['median'])}{faster}"),
        )


def _bank_rows(banks: dict) -> Iterator[tuple[str, ...]]:
    scenes = banks["scenes"]
    for name, entry in scenes.items():
        masses, kind, count = name.removeprefix("masses ").split(", ")
        each = scenes.get(f"masses {masses}, elements, {count}")
        if kind != "bank" or each is None:
            continue
        own, other = entry["seconds of a processor"]["median"], each["seconds of a processor"]["median"]
        yield (
            f"map of {entry['cells']:,} cells, number of masses {masses}, bank of {count} elements as one "
            "contact, one thread",
            f"{duration(own)}; element by element {duration(other)}",
        )


def _mass_rows(structures: dict) -> Iterator[tuple[str, ...]]:
    cost = structures["cost"]
    line = cost["ns a scan step, line over masses"]
    special, general = cost["1, kernel for one mass"], cost["1"]
    step = f"{two_digits(line['constant'])} + {two_digits(line['a mass'])} N ns"
    yield "scan step of a structure with N masses", step
    cells = [entry["map"]["us a cell"]["median"] for entry in (special, general)]
    counts = sorted(int(name) for name in cost if name.isdigit())
    first, last = (cost[str(count)]["map"]["us a cell"]["median"] for count in (counts[0], counts[-1]))
    text = f"{duration(1e-6 * first)} and {duration(1e-6 * last)}"
    if "powers of the number of masses" in cost:
        text += f"; the power is {cost['powers of the number of masses']['integrated cell']:.2f} at the end"
    yield f"integrated cell of chains of {counts[0]} and {counts[-1]} masses", text
    yield (
        "one mass by its own kernel and by the code for structures",
        f"{duration(1e-9 * special['ns a phase'])} and {duration(1e-9 * general['ns a phase'])} per slide "
        f"or stop, {duration(1e-6 * cells[0])} and {duration(1e-6 * cells[1])} per integrated cell",
    )


# ---------------------------------------------------------------- the page in the browser


def _explore_lines(explore: dict) -> list[str]:
    rows = [
        (
            scene,
            _WORDS.get(what, what),
            *(duration(1e-3 * spread[name]) for name in ("median", "least", "most")),
        )
        for scene, measured in explore["milliseconds"].items()
        for what, spread in measured.items()
    ]
    return [
        "",
        "### The page in the browser",
        "",
        f"`frictionmap explore` in headless Chromium {explore['browser']}, map of {explore['pixels']} x "
        f"{explore['pixels']} pixels. The first load uses a new server, the later load a server that has "
        "shown the page before.",
        *markdown(("scene", "measured time", "median", "minimum", "maximum"), rows),
    ]


# ---------------------------------------------------------------- coupling


def _coupling_lines(coupling: dict) -> list[str]:
    rows = [
        (
            kind,
            level,
            str(entry["cells"]),
            rounded_off(entry["error of Z"]["median"]),
            rounded_off(entry["error of Z"]["nine of ten below"]),
            str(entry["cells with other stop counts"]),
        )
        for kind, levels in coupling["neglected coupling"].items()
        for level, entry in levels.items()
    ]
    return [
        "",
        "### Damping that couples the modes",
        "",
        "The table shows the error that results from neglecting the coupling. Random chains of 2 to 5 "
        "masses are computed twice: marched with the whole damping matrix, and with only its diagonal in "
        "modal coordinates.",
        *markdown(
            ("damping", "mean zeta", "cells", "error of Z, median", "90 % quantile", "different stop counts"),
            rows,
        ),
    ]


# ---------------------------------------------------------------- all


def _start_rows(startup: dict) -> list[tuple[str, ...]]:
    memory = startup.get("MB", {})
    return [
        (
            _WORDS.get(name, name),
            f"{duration(entry['median'])} ({duration(entry['least'])} to {duration(entry['most'])})"
            + (f", {memory[name]:.0f} MB" if name in memory else ""),
        )
        for name, entry in startup["seconds"].items()
    ]


def _machine(found: dict[str, dict]) -> str:
    """Sentence on the machines of the results."""
    machines = {
        json.dumps({key: value for key, value in content["machine"].items() if key != "load"})
        for content in found.values()
    }
    lines = []
    for text in sorted(machines):
        machine = json.loads(text)
        versions = ", ".join(f"{name} {number}" for name, number in machine["versions"].items())
        lines.append(
            f"{machine['processor']}, {machine['processors']} processors, {machine['system']}, "
            f"Python {machine['python']}, {versions}"
        )
    return f"Measured on: {'; '.join(lines)}."


def _busy(machine: dict) -> bool:
    """Whether much else was running; a benchmark itself takes up to all processors."""
    return (machine["load"] or 0.0) > 1.5 * machine["processors"]


def _commits(found: dict[str, dict]) -> str:
    """Sentences on the commits of the results; several commits, and quick forms, are named as a warning."""
    names: dict[str, list[str]] = {}
    for name, content in found.items():
        names.setdefault(content.get("commit") or "not recorded", []).append(name)
    runs = {name: content["run"] for name, content in found.items() if "run" in content}
    quick = [name for name, run in runs.items() if run["quick"]]
    warning = f" **Quick forms, which measure little:** {', '.join(quick)}." if quick else ""
    busy = [name for name, content in found.items() if _busy(content["machine"])]
    warning += f" **Measured on a busy machine:** {', '.join(busy)}." if busy else ""
    if list(names) == ["not recorded"]:
        return f"The commit of these results was not recorded.{warning}"
    if len(names) == 1:
        taken = f", in {round(sum(run['seconds'] for run in runs.values()) / 60)} minutes" if runs else ""
        return f"All tables are of commit {next(iter(names))}{taken}.{warning}"
    parts = "; ".join(f"{', '.join(some)}: {one}" for one, some in names.items())
    text = "**These results are of different commits**, so do not compare them with each other."
    return f"{text} {parts}.{warning}"


def block(results: Path) -> str:
    """Text of the page between the markers."""
    found = {
        name: json.loads((results / f"{name}.json").read_text(encoding="utf-8"))
        for name in (*QUOTED, *QUOTED_LATER)
        if (results / f"{name}.json").is_file()
    }
    peers, structures = found.get("peers"), found.get("structures")
    lines = [_machine(found), "", _commits(found)]
    if peers or structures:
        lines += _peer_lines(peers, structures)
    if "general" in found:
        lines += general_lines(found["general"])
    if "continuation" in found:
        lines += continuation_lines(found["continuation"])
    if "laws" in found:
        lines += laws_lines(found["laws"])
    if "many_contacts" in found:
        lines += many_contacts_lines(found["many_contacts"])
    if "consistency" in found:
        lines += consistency_lines(found["consistency"])
    if "design" in found:
        lines += design_lines(found["design"])
    if "histories" in found or "spectrum" in found:
        lines += histories_lines(found.get("histories"), found.get("spectrum"))
    for name, quote in (("accuracy", accuracy_lines), ("stress", stress_lines), ("steady", steady_lines)):
        if name in found:
            lines += quote(found[name])
    if "milliseconds" in found.get("explore", {}):  # there was a browser
        lines += _explore_lines(found["explore"])
    if "seconds" in found.get("first_minute", {}):
        lines += first_minute_lines(found["first_minute"])
    if "coupling" in found:
        lines += _coupling_lines(found["coupling"])
    if "coverage" in found:
        lines += coverage_lines(found["coverage"])
    growth = list(_scaling_rows(found["scaling"])) if "scaling" in found else []
    growth += _mass_rows(structures) if structures else []
    growth += _static_rows(found["static"]) if "static" in found else []
    growth += _bank_rows(found["banks"]) if "banks" in found else []
    growth += _large_rows(found["large"]) if "large" in found else []
    if growth or "startup" in found:
        lines += ["", "### Computing time and memory"]
    lines += markdown(("task", "time or memory"), growth)
    if "startup" in found:
        lines += markdown(
            ("fresh process", "time (minimum to maximum), peak memory"), _start_rows(found["startup"])
        )
    return "\n".join(lines)


def parts(text: str) -> tuple[str, str, str]:
    """Split the page into the text before the block, the block, and the text after it."""
    before, begin, rest = text.partition(f"{BEGIN}\n")
    inside, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"docs/results.md needs the lines\n{BEGIN}\n{END}")
    return before, inside.removesuffix("\n"), after


def rewrite(results: Path, page: Path = PAGE) -> None:
    """Write the block of these results into the page."""
    before, _, after = parts(page.read_text(encoding="utf-8"))
    text = f"{before}{BEGIN}\n{block(results)}\n{END}{after}"
    page.write_text(text, encoding="utf-8")
    print(f"written: {page}")

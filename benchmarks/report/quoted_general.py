"""Tables of docs/results.md about several contacts, elastic contacts and periodic loads."""

import statistics
from collections.abc import Iterator

from .quoting import duration, markdown, rounded_off, two_digits

_ERRORS, _WRONG = "relative errors of ranges", "cells with other stop counts"

_SOLVERS = {
    "solve_ivp DOP853": "`solve_ivp` (DOP853)",
    "heyoka": "heyoka with events",
    "Moreau-Jean": "Moreau-Jean time stepping",
}


def _seconds(entry: dict, key: str) -> str:
    return duration(entry[key]["median"])


def _cell_rows(general: dict) -> Iterator[tuple[str, ...]]:
    """Time per cell and per frequency of every system."""
    for name, entry in general["cells"].items():
        boundaries = general["boundaries"][name]
        yield name, _seconds(entry, "seconds a cell"), _seconds(boundaries, "seconds a frequency")


def _map_rows(general: dict) -> Iterator[tuple[str, ...]]:
    for name, entry in general["maps"].items():
        share = entry["computed, one of"]
        scaled = f", scaled from one of {share} rows" if share > 1 else ""
        yield f"{name}{scaled}", _seconds(entry, "seconds, scaled to the whole")


def _best(found: dict) -> dict | None:
    """The point with the smallest median error."""
    points = [point for point in found.get("points", ()) if point[_ERRORS]]
    return min(points, key=lambda point: statistics.median(point[_ERRORS]), default=None)


def _solver_rows(general: dict) -> Iterator[tuple[str, ...]]:
    """Every solver at its most accurate setting."""
    for name, entry in general["other solvers"].items():
        for method, found in entry["methods"].items():
            point = _best(found)
            if point is None:
                continue
            setting = point[found["setting"]]
            value = f"{setting:,g}" if setting >= 1 else rounded_off(setting)
            yield (
                name,
                f"{_SOLVERS.get(method, method)}; {found['setting']} = {value}",
                _seconds(entry, "our seconds a cell"),
                _seconds(entry, "our seconds a cell in rows"),
                _seconds(point, "seconds a cell"),
                two_digits(point["ratio"]),
                two_digits(point["ratio in rows"]),
                rounded_off(statistics.median(point[_ERRORS])),
                f"{point[_WRONG]} of {len(entry['cells'])}",
            )


def _balance_rows(found: dict) -> Iterator[tuple[str, ...]]:
    for point in found["points"]:
        yield (
            str(point["highest harmonic"]),
            _seconds(point, "seconds a cell"),
            two_digits(point["ratio"]),
            rounded_off(point["median relative error of Z"]),
            rounded_off(point["largest relative error of Z"]),
            f"{point['cells that did not converge']} of {found['cells']}",
        )


def _shorter(general: dict) -> str:
    """Sentence on one mass, whose cells need fewer periods than the other solvers march."""
    ratios = []
    for entry in general["other solvers"].values():
        marched, needed = (
            statistics.mean(entry[key])
            for key in ("periods marched", "periods until a disturbance has decayed")
        )
        if marched > needed:
            ratios.append(marched / needed)
    if not ratios:
        return ""
    return (
        "For one mass the other solvers march 200 periods, as in the thesis. That is "
        f"{two_digits(min(ratios))} to {two_digits(max(ratios))} times the number of periods after which a "
        "disturbance has decayed to 1e-10. A solver that ended there would reduce the ratios by this factor."
    )


def _notes(general: dict) -> Iterator[str]:
    counts = list(general["contacts"].items())
    least, most = (
        f"{_seconds(entry, 'seconds a cell')} with {count}" for count, entry in (counts[0], counts[-1])
    )
    yield f"A stick-slip cell of eight masses takes {least} contact and {most} contacts."
    square = next(entry for entry in general["cells"].values() if "over one harmonic" in entry)
    yield (
        "A cell under a square wave of 50 harmonics takes "
        f"{two_digits(square['over one harmonic'])} times as long as one under a single harmonic."
    )
    yield (
        "For more than one mass the other solvers march ten periods more than a disturbance needs to decay "
        "to 1e-10."
    )
    if shorter := _shorter(general):
        yield shorter
    skipped = {
        name: found["skipped"]
        for entry in general["other solvers"].values()
        for name, found in entry["methods"].items()
        if "skipped" in found
    }
    for name, why in skipped.items():
        yield f"Not measured: {name} ({why})."


def general_lines(general: dict) -> list[str]:
    """Lines of the section on several contacts, elastic contacts and periodic loads."""
    balance = general["harmonic balance"]
    return [
        "",
        "### Several contacts, elastic contacts and periodic loads",
        "",
        "Stick-slip cells at mu = 1 are computed in rows of a map. Each cell starts from the steady state "
        "of its neighbour. The boundaries of a frequency are computed once per row.",
        *markdown(
            ("system", "time per cell", "boundaries of one frequency"), list(_cell_rows(general))
        ),
        *markdown(("whole map, one thread", "time"), list(_map_rows(general))),
        "",
        "The next table compares cells with other solvers at their most accurate setting: single cells from "
        "rest, and cells in rows of a map at the same frequencies. "
        "Errors are those of max z - min z in the contacts, relative to frictionmap.",
        *markdown(
            (
                "stick-slip cell", "solver", "frictionmap, from rest", "frictionmap, in a row",
                "other solver", "ratio, from rest", "ratio, in a row", "error", "different stop counts",
            ),
            list(_solver_rows(general)),
        ),
        "",
        f"For an elastic contact, {balance['cells']:,} cells at kt = 3 were solved by harmonic balance with "
        "alternating frequency and time, row by row as in a map. frictionmap takes "
        f"{_seconds(balance, 'our seconds a cell')} per cell.",
        *markdown(
            (
                "harmonics up to", "time per cell", "over frictionmap", "error of Z, median", "largest",
                "not converged",
            ),
            list(_balance_rows(balance)),
        ),
        "",
        *(f"- {note}" for note in _notes(general)),
        "",
        "![Several contacts, elastic contacts and periodic loads](../benchmarks/results/general.png)",
    ]  # fmt: skip


def _consistency_rows(kinds: dict) -> Iterator[tuple[str, ...]]:
    """What must be fulfilled, and how often it is not, by kind of contacts."""
    for words, faults, whole in (
        ("cells without an answer", "cells without an answer", "cells"),
        ("multipliers above 1", "multipliers above 1", "multipliers"),
        ("cells with another bit in any of three cuts of the map", "cells with other bits in a cut", "cells"),
        ("motions with friction above its limit", "motions with friction above its limit", "motions"),
    ):
        yield words, *(f"{kind[faults]} of {kind[whole]:,}" for kind in kinds.values())


def consistency_lines(consistency: dict) -> list[str]:
    """Lines of the section on what every map must fulfil."""
    kinds = consistency["random cells"]
    systems = sum(kind["systems"] for kind in kinds.values())
    return [
        "",
        "### Several contacts: what must be true of every cell",
        "",
        f"For mu = 1 every cell has a steady state that attracts, and does not depend on the cells beside "
        f"it. {systems:,} random chains of 1 to 4 masses with up to 3 rigid and 2 elastic contacts, some of "
        "them parallel to each other, on belts or under varying normal loads, were checked.",
        *markdown(("to be fulfilled in random cells", *kinds), list(_consistency_rows(kinds))),
        "",
        "![Largest multipliers](../benchmarks/results/consistency.png)",
    ]


def _many_rows(many: dict) -> Iterator[tuple[str, ...]]:
    """Time of a cell of every kind of system with the most and with fewer contacts, and how it grows."""
    for kind, rows in many["cells"].items():
        for key, words in (
            ("seconds from rest", "a cell from rest"),
            ("seconds from neighbour", "a cell from its neighbour"),
            ("seconds of boundaries", "the boundaries at one frequency"),
        ):
            if key not in many["slopes"][kind]:
                continue
            shown = [n for n in rows if n in ("1", "8", "16", "32", "64")] or list(rows)
            times = ", ".join(f"{_seconds(rows[n], key)} (N = {n})" for n in shown)
            power = many["slopes"][kind][key]["power"]  # none of a run with few numbers of contacts
            yield f"{kind}, {words}", times, "-" if power is None else f"N^{power:.1f}"


def many_contacts_lines(many: dict) -> list[str]:
    """Lines of the section on the number of contacts."""
    whole = sum(row["cells"] for rows in many["cells"].values() for row in rows.values())
    unresolved = sum(row["unresolved"] for rows in many["cells"].values() for row in rows.values())
    return [
        "",
        "### Number of contacts",
        "",
        "Frames have as many storeys, and rings as many unequal blades, as contacts. Friction is 0.3 times "
        f"that with which no contact slips, and zeta is 0.05. {unresolved} of {whole:,} cells had no answer. "
        "A map also finds the boundaries at each frequency. Loops and contacts with a stiffness have no "
        "`beta_lim`.",
        *markdown(("system", "time", "growth from N = 8"), list(_many_rows(many))),
        "",
        "![Time of a cell over the number of contacts](../benchmarks/results/many_contacts.png)",
    ]

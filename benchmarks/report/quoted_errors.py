"""Tables of docs/results.md about accuracy: results of `accuracy`, `stress` and `steady`."""

import statistics
from collections.abc import Iterator

from .quoting import duration, markdown, rounded_off, two_digits

#: Names of the methods of `accuracy` in the table.
_METHODS = {
    "frictionmap": "frictionmap, until the steady state is found",
    "frictionmap, marched": "frictionmap's integrator alone",
    "heyoka": "heyoka (Taylor series)",
    "solve_ivp DOP853": "scipy's `solve_ivp` (DOP853)",
    "CVODE": "CVODE of SUNDIALS",
    "RK4, events located": "RK4, fixed step, events located",
    "RK4": "RK4, fixed step",
    "Moreau-Jean": "Moreau-Jean time stepping",
}
_OURS = ("frictionmap", "frictionmap, marched")
_DEFAULT_STEPS = 24

_Z, _TIMES, _WRONG = "relative errors of Z", "errors of event times", "cells with wrong stop counts"


# ---------------------------------------------------------------- accuracy


def _points(scenes: list[dict], method: str) -> dict[float, list[dict]]:
    """Results of a method in some scenes, by setting."""
    found: dict[float, list[dict]] = {}
    for scene in scenes:
        entry = scene["methods"].get(method)
        for point in entry["points"] if entry else ():
            found.setdefault(point[entry["setting"]], []).append(point)
    return found


def _values(points: list[dict], key: str) -> list[float]:
    return [value for point in points for value in point[key]]


def _median(values: list[float]) -> str:
    return rounded_off(statistics.median(values)) if values else "-"


def _setting(scenes: list[dict], method: str) -> float | None:
    """Setting to quote: the default for frictionmap, for others that of the smallest median error of Z."""
    points = _points(scenes, method)
    if method in _OURS:
        return _DEFAULT_STEPS if _DEFAULT_STEPS in points else None
    errors = {setting: _values(found, _Z) for setting, found in points.items()}
    settings = [setting for setting, values in errors.items() if values]
    return min(settings, key=lambda setting: statistics.median(errors[setting]), default=None)


def _method_rows(accuracy: dict) -> Iterator[tuple[str, ...]]:
    named = accuracy["steady states"]
    three = [scene for name, scene in named.items() if name.startswith("3 masses")]
    one = [scene for name, scene in named.items() if not name.startswith("3 masses")]
    everything = one + three
    for method, words in _METHODS.items():
        setting = _setting(everything, method)
        if setting is None:
            continue
        unit = next(s["methods"][method]["setting"] for s in everything if method in s["methods"])
        unit = unit.replace("steps a period", "steps per period")
        cells: list[str] = []
        for scenes in (one, three):
            points = _points(scenes, method).get(setting, [])
            seconds = [point["seconds a cell"]["median"] for point in points]
            cells += [duration(statistics.mean(seconds)) if seconds else "-", _median(_values(points, _Z))]
        points = _points(everything, method)[setting]
        tried = sum(len(scene["cells"]) for scene in everything if method in scene["methods"])
        wrong = sum(point[_WRONG] for point in points)
        yield (
            f"{words}; {unit} = {f'{setting:,g}' if setting >= 1 else rounded_off(setting)}",
            *cells,
            _median(_values(points, _TIMES)),
            f"{wrong} of {tried}",
        )


def _search_rows(accuracy: dict) -> Iterator[tuple[str, ...]]:
    """Rows of the kernel, and of the coarsest, a medium and the finest grid."""
    systems = accuracy["search of S"]

    def cells(entries: list[dict]) -> list[str]:
        return [
            text
            for entry in entries
            for text in (
                duration(entry["seconds"]["median"]),
                rounded_off(entry["relative error of S"]["largest"]),
            )
        ]

    yield "frictionmap", *cells([system["kernel"] for system in systems.values()])
    grids = list(next(iter(systems.values()))["grid"])
    for points in (grids[0], grids[len(grids) // 2], grids[-1]):
        yield (
            f"numpy on {int(points):,} points",
            *cells([system["grid"][points] for system in systems.values()]),
        )


def _accuracy_notes(accuracy: dict) -> Iterator[str]:
    random = accuracy["random cells"]
    error = random["relative error of Z"]
    wrong = random[_WRONG]
    yield (
        f"{random['cells']:,} random cells of one mass at the default settings were compared with an "
        f"independent event-exact code; {wrong or 'none'} of them had a different number of stops. The "
        f"median relative error of Z is {rounded_off(error['median'])}, the largest "
        f"{rounded_off(error['largest'])}. In addition, the reference did not converge in "
        f"{random['left out, not settled by the reference']:,} cells, and the package reported a status "
        f"other than resolved in {random['left out, with a status of the package']:,}."
    )
    steps = [
        f"{entry['best steps by time']} for {name} (the default takes "
        f"{entry['time at the default 24 over the best']:.2f} times as long)"
        for name, entry in accuracy["scan steps"].items()
    ]
    points = [point for entry in accuracy["scan steps"].values() for point in entry["points"]]
    other = sum(point["cells with other stop counts"] for point in points)
    off = max(point["largest relative difference of Z"] for point in points)
    yield (
        f"Scan steps (default {_DEFAULT_STEPS}) from {min(p['steps'] for p in points)} to "
        f"{max(p['steps'] for p in points)} change {other or 'no'} stop counts, and Z by at most "
        f"{rounded_off(off)}. The fastest numbers of steps are {'; '.join(steps)}."
    )
    for name, why in _skipped(accuracy).items():
        yield f"Not measured: {name} ({why})."


def _skipped(accuracy: dict) -> dict[str, str]:
    """Methods that were available in no scene, and why."""
    scenes = accuracy["steady states"].values()
    return {
        name: why
        for scene in scenes
        for name, why in scene.get("skipped", {}).items()
        if not any(name in other["methods"] for other in scenes)
    }


def accuracy_lines(accuracy: dict) -> list[str]:
    """Lines of the section on error against run time."""
    marched = accuracy["periods marched"]
    return [
        "",
        "### Error against run time",
        "",
        f"All methods compute the same random stick-slip cells. All except the first march {marched} "
        "periods from rest. frictionmap runs at its default settings, the others at their most accurate "
        f"setting. The errors are medians relative to {accuracy['digits of the references']}-digit orbits.",
        *markdown(
            (
                "steady state of a cell",
                "one mass",
                "error of Z",
                "three masses",
                "error of Z",
                "error of stop times [rad]",
                "wrong stop counts",
            ),
            list(_method_rows(accuracy)),
        ),
        *markdown(
            ("search of S, at one frequency", "one mass", "largest error", "five masses", "largest error"),
            list(_search_rows(accuracy)),
        ),
        "",
        *(f"- {note}" for note in _accuracy_notes(accuracy)),
        "",
        "![Error against run time](../benchmarks/results/accuracy.png)",
    ]


# ---------------------------------------------------------------- stress


def _kind(group: str) -> str:
    """Row of the table that a group of the torture test belongs to."""
    of_many = "chains" in group or "close modes" in group
    if group.startswith("curves"):
        return "boundaries, structures of 2 to 50 masses" if of_many else "boundaries, one mass"
    if group.startswith("marched"):
        return "marched to the end, one mass"
    return "cells, structures of 2 to 50 masses" if of_many else "cells, one mass"


def _of_counted(wrong: int, counted: int) -> str:
    return f"{wrong} of {counted:,}" if counted else "-"


def _stress_rows(stress: dict) -> Iterator[tuple[str, ...]]:
    allowed = stress["allowed beyond the condition number"]
    kinds: dict[str, list[dict]] = {}
    for name, group in stress["groups"].items():
        kinds.setdefault(_kind(name), []).append(group)
    for kind, groups in kinds.items():

        def total(key: str, groups: list[dict] = groups) -> int:
            return sum(group[key] for group in groups)

        cells = total("cells")
        compared = total("numbers compared")
        beyond = max(group["digits lost beyond, most"] for group in groups)
        has_regimes = not kind.startswith("boundaries")
        yield (
            kind,
            f"{compared:,}",
            f"{beyond:.1f} ({total('more than allowed')} above {allowed:g})",
            f"{total('wrong regimes')} of {cells:,}" if has_regimes else "-",
            _of_counted(total("wrong stop counts"), total("stops counted")),
        )


def _stress_notes(stress: dict) -> Iterator[str]:
    groups = stress["groups"].values()

    def total(key: str) -> int:
        return sum(group[key] for group in groups)

    yield (
        f"Not counted as wrong: {total('wrong regimes at rounding'):,} regimes and "
        f"{total('wrong stop counts at rounding'):,} stop counts that are right for a beta that differs by "
        f"rounding, and {total('wrong stop counts with a status'):,} stop counts with a status that warns "
        f"about them. Contradictory outputs: {total('inconsistent') or 'none'}. Exceptions, warnings and "
        f"hangs: {total('trouble') or 'none'}."
    )
    random = stress.get("random cells")
    if not random:
        return
    cells = random["cells"]
    least, most = random["periods at most"]
    shares = ", ".join(
        f"{two_digits(100.0 * count / cells)} % `{name}`"
        for name, count in sorted(random["statuses"].items(), key=lambda item: -item[1])
    )
    yield (
        f"{cells:,} random cells of 1 to 6 masses (r from 1e-3 to 1e3, mu up to 10, zeta up to 5) were "
        f"followed for at most {most} periods ({least} at small r). Status: {shares}. Resolved cells "
        f"without a regime or a number: {len(random['resolved without a regime or a number']) or 'none'}. "
        f"The slowest row of {random['cells of a row']} cells took "
        f"{duration(random['slowest row of cells [s]'])}."
    )


def stress_lines(stress: dict) -> list[str]:
    """Lines of the section on the torture test."""
    return [
        "",
        "### Torture test",
        "",
        "The results at and around every singular point are compared with 40-digit arithmetic. The table "
        "shows the digits lost beyond the condition number of the result; a double has 16 digits.",
        *markdown(
            (
                "quantity",
                "numbers compared",
                "digits lost beyond the condition number, largest",
                "wrong regimes",
                "wrong stop counts",
            ),
            list(_stress_rows(stress)),
        ),
        "",
        *(f"- {note}" for note in _stress_notes(stress)),
        "",
        "![Digits lost at singular points](../benchmarks/results/stress.png)",
    ]


# ---------------------------------------------------------------- steady


def _steady_rows(steady: dict) -> Iterator[tuple[str, ...]]:
    for name, row in steady.items():
        if "differences by cause" not in (row or {}):  # the commit, the machine
            continue
        causes = ", ".join(f"{cause} ({count:,})" for cause, count in row["differences by cause"].items())
        yield (
            name,
            f"{row['cells']:,}",
            f"{row['both resolved']:,}",
            causes or "none",
            rounded_off(row["median difference of Z"]),
            rounded_off(row["largest difference of Z"]),
        )


def _undamped_lines(maps: dict) -> list[str]:
    """Table of undamped maps: share of cells by status."""
    found = [status for statuses in maps.values() for status in statuses]
    names = list(dict.fromkeys(name for name in found if name != "resolved"))
    rows = []
    for map_name, statuses in maps.items():
        cells = sum(statuses.values())
        shares = [f"{two_digits(100.0 * statuses.get(name, 0) / cells)} %" for name in names]
        rows.append((map_name, f"{cells:,}", *shares))
    return markdown(("undamped map", "cells", *(f"`{name}`" for name in names)), rows)


def steady_lines(steady: dict) -> list[str]:
    """Lines of the section on solved and marched steady states, with the undamped maps."""
    return [
        "",
        "### Steady states, solved against marched",
        "",
        "Cells solved by Newton's method are compared with the same cells marched until the motion "
        "repeats, without skipping any cell. The second table gives the share of unresolved and special "
        "cells in undamped maps.",
        *markdown(
            (
                "set of cells",
                "cells",
                "both resolved",
                "different results, by cause",
                "error of Z, median",
                "largest",
            ),
            list(_steady_rows(steady)),
        ),
        *_undamped_lines(steady["undamped maps"]),
    ]

"""Tables of docs/results.md that say how good numbers are: of `accuracy`, `stress` and `steady`."""

import statistics
from collections.abc import Iterator

from .quoting import duration, markdown, rounded_off, two_digits

#: What a method of `accuracy` is called in the table.
_METHODS = {
    "frictionmap": "frictionmap, until the steady state is found",
    "frictionmap, marched": "its integrator alone",
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
    """What a method did in some scenes, by setting."""
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
    """Ours: the default.  Others: where the median error of Z is least over all scenes."""
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
    """The kernel, then the coarsest grid, one in the middle and the finest."""
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
        f"Of {random['cells']:,} random cells of one mass at the default settings, against an event-exact "
        f"code of its own, {wrong or 'none'} had another number of stops; Z is off by "
        f"{rounded_off(error['median'])} in the median, {rounded_off(error['largest'])} at most (relative). "
        f"Besides, {random['left out, not settled by the reference']:,} did not settle in the reference and "
        f"{random['left out, with a status of the package']:,} have a status instead of an answer."
    )
    steps = [
        f"{entry['best steps by time']} ({name}; the default takes "
        f"{entry['time at the default 24 over the best']:.2f} times as long)"
        for name, entry in accuracy["scan steps"].items()
    ]
    points = [point for entry in accuracy["scan steps"].values() for point in entry["points"]]
    other = sum(point["cells with other stop counts"] for point in points)
    off = max(point["largest relative difference of Z"] for point in points)
    yield (
        f"Scan steps (default {_DEFAULT_STEPS}) from {min(p['steps'] for p in points)} to "
        f"{max(p['steps'] for p in points)} change {other or 'no'} stop counts, and Z by "
        f"{rounded_off(off)} at most; the fastest are {', '.join(steps)}."
    )
    for name, why in _skipped(accuracy).items():
        yield f"Not measured: {name} ({why})."


def _skipped(accuracy: dict) -> dict[str, str]:
    """Methods that were to be had in no scene, and why."""
    scenes = accuracy["steady states"].values()
    return {
        name: why
        for scene in scenes
        for name, why in scene.get("skipped", {}).items()
        if not any(name in other["methods"] for other in scenes)
    }


def accuracy_lines(accuracy: dict) -> list[str]:
    """Error against run time."""
    marched = accuracy["periods marched"]
    return [
        "",
        "### Error against run time",
        "",
        f"The same random stick-slip cells for all; all but the first march {marched} periods from rest. "
        "Ours at the default, the others at their most accurate setting; medians of the errors against "
        f"{accuracy['digits of the references']}-digit orbits.",
        *markdown(
            (
                "steady state of a cell",
                "one mass",
                "error of Z",
                "three masses",
                "error of Z",
                "error of times of stops [rad]",
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
    """What a group of the torture test is about."""
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
        f"Besides, {total('wrong regimes at rounding'):,} regimes and "
        f"{total('wrong stop counts at rounding'):,} counts are those of a beta that differs by rounding; "
        f"{total('wrong stop counts with a status'):,} wrong counts come with a status that warns of it. "
        f"Outputs that contradict each other: {total('inconsistent') or 'none'}; exceptions, warnings and "
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
        f"{cells:,} random cells of 1 to 6 masses (r from 1e-3 to 1e3, mu to 10, zeta to 5; followed for at "
        f"most {most} periods, at small r {least}): {shares}. Resolved without a regime or a number: "
        f"{len(random['resolved without a regime or a number']) or 'none'}; the slowest "
        f"row of {random['cells of a row']} took {duration(random['slowest row of cells [s]'])}."
    )


def stress_lines(stress: dict) -> list[str]:
    """The torture test."""
    return [
        "",
        "### Torture test",
        "",
        "At and around every singular point, against 40-digit arithmetic. What counts is what is lost beyond "
        "the condition number of the answer; 16 digits are all that a double has.",
        *markdown(
            (
                "what",
                "numbers compared",
                "digits lost beyond, worst",
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
        if "differences by cause" not in row:
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
    """Maps of undamped structures: share of cells by status."""
    found = [status for statuses in maps.values() for status in statuses]
    names = list(dict.fromkeys(name for name in found if name != "resolved"))
    rows = []
    for map_name, statuses in maps.items():
        cells = sum(statuses.values())
        shares = [f"{two_digits(100.0 * statuses.get(name, 0) / cells)} %" for name in names]
        rows.append((map_name, f"{cells:,}", *shares))
    return markdown(("undamped map", "cells", *(f"`{name}`" for name in names)), rows)


def steady_lines(steady: dict) -> list[str]:
    """Solved against marched, and undamped maps."""
    return [
        "",
        "### Steady states, solved against marched",
        "",
        "The same cells marched until the motion repeats, with nothing skipped; undamped maps by status.",
        *markdown(
            ("cells of", "cells", "both resolved", "other answers, by cause", "Z off by, median", "largest"),
            list(_steady_rows(steady)),
        ),
        *_undamped_lines(steady["undamped maps"]),
    ]

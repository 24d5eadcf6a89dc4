"""Tables of docs/results.md about programs for harmonic balance, laws, opening contacts and belts."""

import statistics
from collections.abc import Iterator

from .quoting import duration, markdown, rounded_off, two_digits


def _program_rows(curves: dict) -> Iterator[tuple[str, ...]]:
    """Every program at every number of harmonics."""
    for name, entry in curves.items():
        for program, found in entry["programs"].items():
            for one in found.get("points", ()):
                if "failure" in one:
                    yield name, program, str(one["highest harmonic"]), *["-"] * 5
                    continue
                yield (
                    name,
                    program,
                    str(one["highest harmonic"]),
                    str(one["points"]),
                    duration(one["seconds a point"]),
                    two_digits(one["ratio"]),
                    rounded_off(one["median relative error of Z"]),
                    rounded_off(one["largest relative error of Z"]),
                )


def _program_notes(curves: dict) -> Iterator[str]:
    """What did not run, or ended early."""
    for name, entry in curves.items():
        wanted = entry["rig"]["frequencies"][1]
        for program, found in entry["programs"].items():
            for one in found.get("points", ()):
                what = f"{program}, {name}, harmonics up to {one['highest harmonic']}"
                if "failure" in one:
                    yield f"{what}: no result ({one['failure']})."
                elif one["followed up to r"] < wanted:
                    yield f"{what}: the continuation ended at r = {one['followed up to r']:.3g}."
    skipped = {
        program: found["skipped"]
        for entry in curves.values()
        for program, found in entry["programs"].items()
        if "skipped" in found
    }
    yield from (f"Not measured: {program} ({why})." for program, why in skipped.items())


def _versions(curves: dict) -> str:
    found = {
        program: entry["version"]
        for curve in curves.values()
        for program, entry in curve["programs"].items()
        if "version" in entry
    }
    return ", ".join(f"{program} {version}" for program, version in found.items()) or "none"


def continuation_lines(content: dict) -> list[str]:
    """Lines of the section on programs for harmonic balance."""
    curves = content["curves"]
    rig = next(iter(curves.values()))["rig"]
    low, high = rig["frequencies"]
    return [
        "",
        "### Response curves by programs for harmonic balance",
        "",
        f"Amplitude of one mass (zeta = {rig['zeta']:g}, beta = {rig['beta']:g}) from r = {low:g} to "
        f"{high:g}. Each program follows the curve by its own continuation and chooses the frequencies, "
        "`frictionmap.sweep` computes the same frequencies. Times are per point, on one thread, without "
        "start and compilation. The rigid contact is pyHarm's dynamic Lagrangian element; NLvib regularises "
        f"it by tanh. Versions: {_versions(curves)}.",
        *markdown(
            (
                "contact", "program", "harmonics up to", "points", "time per point", "over frictionmap",
                "error of Z, median", "largest",
            ),
            list(_program_rows(curves)),
        ),
        "",
        *(f"- {note}" for note in _program_notes(curves)),
        "",
        "![Response curves by programs for harmonic balance](../benchmarks/results/continuation.png)",
    ]  # fmt: skip


def _value(setting: float) -> str:
    return f"{setting:,g}" if setting >= 1.0 else rounded_off(setting)


def _law_rows(scenes: dict) -> Iterator[tuple[str, ...]]:
    for name, entry in scenes.items():
        ours = entry["our seconds a cell"]["median"]
        for solver, found in entry["methods"].items():
            for one in found.get("points", ()):
                taken = one["seconds a cell"]["median"]
                yield (
                    name,
                    f"{solver}; {found['setting']} = {_value(one['value'])}",
                    duration(ours),
                    duration(taken),
                    two_digits(taken / ours),
                    rounded_off(statistics.median(one["relative errors of ranges"])),
                )


def _skipped(scenes: dict) -> dict[str, str]:
    found = {}
    for entry in scenes.values():
        found |= {name: one["skipped"] for name, one in entry["methods"].items() if "skipped" in one}
    return found


def laws_lines(laws: dict) -> list[str]:
    """Lines of the section on friction over speed, contacts that open and belts without a load."""
    cells = laws["random cells"]
    ends = ", ".join(f"{count:,} {name}" for name, count in cells["status"].items())
    return [
        "",
        "### Friction over speed, contacts that open, belts without a load",
        "",
        "One mass. frictionmap is timed in rows of a map, with everything that a call of `sweep` does. The "
        "others march from rest until a disturbance has decayed to 1e-10, or ten cycles on the belt. Errors "
        "are those of max z - min z, relative to frictionmap.",
        *markdown(
            ("cell", "solver", "frictionmap", "other solver", "ratio", "error, median"),
            list(_law_rows(laws["other solvers"])),
        ),
        "",
        *(f"- Not measured: {name} ({why})." for name, why in _skipped(laws["other solvers"]).items()),
        f"- Status of {cells['cells']:,} random cells with friction over speed: {ends}. The longest takes "
        f"{cells['cycles at most']:,} periods.",
        "",
        "![One mass: laws, opening contact, belt](../benchmarks/results/laws.png)",
    ]

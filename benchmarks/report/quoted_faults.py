"""Table of docs/results.md that says what bad input and bad days do: of `faults`."""

from collections.abc import Iterator

from .quoting import markdown


def _cell(entry: dict | None) -> str:
    """How many trials of a family went wrong, and what most of them showed."""
    if entry is None:
        return "-"
    if not entry["wrong"]:
        return "0"
    kind, count = next(iter(entry["wrong by kind"].items()))
    return f"{entry['wrong']:,} ({kind}: {count:,})"


def _rows(now: dict, before: dict) -> Iterator[tuple[str, ...]]:
    for name, entry in now.items():
        yield name, f"{entry['tried']:,}", *([_cell(before.get(name))] if before else []), _cell(entry)
    counts = [f"{sum(entry['wrong'] for entry in found.values()):,}" for found in (before, now) if found]
    yield "all", f"{sum(entry['tried'] for entry in now.values()):,}", *counts


def _beyond(now: dict) -> str:
    """What is counted apart: trials that ended inside a library."""
    counts = [f"{count:,} {kind}" for entry in now.values() for kind, count in entry["beyond reach"].items()]
    return f"Counted apart: {', '.join(counts)}." if counts else "No trial ended inside the HDF5 library."


def faults_lines(faults: dict, before: dict | None) -> list[str]:
    """The section; `before`: the same of an earlier state."""
    now, earlier = faults["families"], (before or {"families": {}})["families"]
    header = ("what was tried", "trials", *(["wrong, before"] if earlier else []), "wrong")
    return [
        "",
        "### Careless hands and bad days",
        "",
        "Wrong is whatever is not an answer or a refusal in one line that names its cause: a traceback, "
        "a hang, input taken without a word, a file lost, changed or left behind. In brackets what most of "
        "them showed.",
        *markdown(header, list(_rows(now, earlier))),
        "",
        f"- {_beyond(now)}",
        "",
        "![Trials that went wrong](../benchmarks/results/faults.png)",
    ]

"""Table of docs/results.md about invalid input, interrupts and damaged files: results of `faults`."""

from collections.abc import Iterator

from .quoting import markdown

#: Names of families and kinds in the results, and the words for them in the table.
_WORDS = {
    "bad configurations": "invalid configurations",
    "bad command lines": "invalid command lines",
    "bad Python calls": "invalid Python calls",
    "good Python calls in unusual dress": "valid Python calls in unusual form",
    "settings honoured or refused": "settings respected or refused",
    "several runs to one name": "several runs that write the same file",
    "files that appear during a run": "output name taken during a run",
    "links and permissions of what is replaced": "links and permissions of replaced files",
    "package and home that cannot be written": "read-only package and home folders",
    "taken without a word": "accepted silently",
    "foreign error": "unexpected exception",
    "refused though good": "valid input refused",
    "other answer": "different result",
    "does not say what": "message without the cause",
    "not one line": "message of several lines",
    "changed values not seen": "changed values not detected",
    "warning of a library": "warning from a library",
}


def _cell(entry: dict | None) -> str:
    """Number of failed trials of a family, with the most frequent kind of failure."""
    if entry is None:
        return "-"
    if not entry["wrong"]:
        return "0"
    kind, count = next(iter(entry["wrong by kind"].items()))
    return f"{entry['wrong']:,} ({_WORDS.get(kind, kind)}: {count:,})"


def _rows(now: dict, before: dict) -> Iterator[tuple[str, ...]]:
    for name, entry in now.items():
        yield (
            _WORDS.get(name, name),
            f"{entry['tried']:,}",
            *([_cell(before.get(name))] if before else []),
            _cell(entry),
        )
    counts = [f"{sum(entry['wrong'] for entry in found.values()):,}" for found in (before, now) if found]
    yield "all", f"{sum(entry['tried'] for entry in now.values()):,}", *counts


def _beyond(now: dict) -> str:
    """Sentence on the trials that ended inside a library, which are counted separately."""
    counts = [f"{count:,} {kind}" for entry in now.values() for kind, count in entry["beyond reach"].items()]
    return (
        f"Counted separately: {', '.join(counts)}." if counts else "No trial ended inside the HDF5 library."
    )


def faults_lines(faults: dict, before: dict | None) -> list[str]:
    """Lines of the section; `before` holds the results of an earlier version."""
    now, earlier = faults["families"], (before or {"families": {}})["families"]
    header = ("what was tried", "trials", *(["failures, earlier version"] if earlier else []), "failures")
    return [
        "",
        "### Invalid input, interrupts and damaged files",
        "",
        "A trial succeeds if it ends with a correct result, or with a message of one line that names the "
        "cause. Failures are, for example, a traceback, a hang, invalid input that is accepted silently, "
        "and a file that is lost, changed or left behind. The most frequent kind of failure is given in "
        "brackets.",
        *markdown(header, list(_rows(now, earlier))),
        "",
        f"- {_beyond(now)}",
        "",
        "![Failed trials](../benchmarks/results/faults.png)",
    ]

"""Tables of docs/results.md about the first minute with the page, from a fresh clone."""

import re
from collections.abc import Sequence
from itertools import groupby

from .quoting import duration, markdown

#: Names of steps in the results, and the words in the table.
_WORDS = {
    "server": "start of `frictionmap explore` to its address",
    "boundaries": "address to boundaries",
    "map": "address to first map",
    "finest map": "address to finished map",
    "motion runs": "address to running motion",
    "pointed: motion": "pointing at a cell to its motion",
    "asked: response curve": "key R to response curve",
    "asked: amplitude": "choice of the amplitude to its map",
    "longest without a change": "longest time without a change on the screen",
    "longest without an estimate": "the longest of these times without an estimate on the screen",
}


#: Parts of a text on the screen that differ while the same is shown.
_COUNTED = re.compile(r"about \d+ s left|almost finished, \d+ s so far|longer than expected, \d+ s so far")

#: A text that says the same whenever something is compiled.
_ALWAYS = ". This happens once per machine"


def _stretches(screen: Sequence[Sequence]) -> list[tuple[str, str, str]]:
    """Rows of the seconds in which the same was on the screen, with the first and the last estimate."""

    def shown(row: Sequence) -> tuple[str, str]:
        return _COUNTED.sub("", row[1]), row[2]

    found = []
    for (_, asked), group in groupby(screen, key=shown):
        rows = list(group)
        words = rows[0][1].replace(_ALWAYS, "")
        first, last = (_COUNTED.findall(row[1]) for row in (rows[0], rows[-1]))
        if first and first != last:
            words = words.replace(first[0], f'from "{first[0]}" to "{last[0]}"')
        seconds = f"{rows[0][0]}" if len(rows) == 1 else f"{rows[0][0]} to {rows[-1][0]}"
        found.append((seconds, words, asked or "-"))
    return found


def first_minute_lines(first_minute: dict) -> list[str]:
    """Lines of the section on the first minute."""
    rows = [
        (_WORDS.get(name, name), *(duration(entry[key]) for key in ("median", "least", "most")))
        for name, entry in first_minute["seconds"].items()
    ]
    return [
        "",
        "### The first minute",
        "",
        "A fresh clone is installed into a new virtual environment, and `frictionmap explore "
        f"configs/{first_minute['configuration']}` is opened in headless Chromium {first_minute['browser']}. "
        "No kernel is compiled beforehand. When the motion runs, the user points at another cell, asks for a "
        "response curve and chooses the amplitude.",
        *markdown(("step", "median", "minimum", "maximum"), rows),
        "",
        "What was on the screen in the first round, in seconds since the start of the server:",
        *markdown(
            ("seconds", "on the screen", "requests without an answer"), _stretches(first_minute["screen"])
        ),
    ]

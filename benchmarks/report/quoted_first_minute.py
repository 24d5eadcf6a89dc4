"""Tables of docs/results.md about the first minute with the page, from a fresh clone."""

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


def first_minute_lines(first_minute: dict) -> list[str]:
    """Lines of the section on the first minute."""
    rows = [
        (_WORDS.get(name, name), *(duration(entry[key]) for key in ("median", "least", "most")))
        for name, entry in first_minute["seconds"].items()
    ]
    screen = [(str(second), words, asked or "-") for second, words, asked in first_minute["screen"]]
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
        "The first round, second by second since the start of the server:",
        *markdown(("second", "on the screen", "requests without an answer"), screen),
    ]

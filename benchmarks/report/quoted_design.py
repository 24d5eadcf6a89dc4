"""Tables of docs/results.md about design questions and borders between numbers of stops."""

from collections.abc import Iterator

from .quoting import duration, markdown, rounded_off


def design_lines(design: dict) -> Iterator[str]:
    """Section about design questions."""
    yield ""
    yield "### Design questions"
    yield ""
    yield "Time per answer on one thread, with everything compiled. The peaks are refined to rounding error."
    rows = [(name, duration(entry["median"])) for name, entry in design["questions"].items()]
    yield from markdown(("question", "time"), rows)
    yield ""
    random = design["random systems"]
    frequencies, ratios = random["grid"]
    kinds = ", ".join(f"{count} {kind}" for kind, count in random["kinds"].items())
    yield (
        f"- The least peaks of {random['systems']} random systems ({random['refused']} refused; {kinds}) "
        f"were compared with maps of {frequencies:,} frequencies and {ratios} friction ratios. Finer maps "
        "refined the peaks of the three best friction ratios. The lowest of these peaks is below the answer "
        f"by a relative difference of at most {rounded_off(max(random['largest gain'], 0.0))}."
    )
    yield ""
    yield "Borders between numbers of stops (mu = 1), compared with cells on both sides and with a map:"
    rows = [
        (
            name, f"{entry['borders']}", duration(entry["seconds"]),
            f"{entry['points right']:,} of {entry['points compared']:,}",
            f"{entry['changes on a border']:,} of {entry['changes of a map']:,}",
        )
        for name, entry in design["borders"].items()
    ]  # fmt: skip
    header = (
        "system",
        "borders",
        "time",
        "points with the right numbers of stops on both sides",
        "changes of a map on a border",
    )
    yield from markdown(header, rows)

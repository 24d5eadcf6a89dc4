"""Format of numbers in docs/results.md: times and ratios have two digits, because the third is noise."""

from collections.abc import Sequence

#: Units of a time, largest first [s].
_UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


def two_digits(value: float) -> str:
    """Format a number with two digits, without an exponent."""
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}" if rounded >= 10 else f"{rounded:.2g}"


def duration(seconds: float) -> str:
    """Format a time with two digits, in a suitable unit."""
    rounded = float(f"{seconds:.2g}")
    size, unit = next((u for u in _UNITS if rounded >= u[0]), _UNITS[-1])
    return f"{two_digits(rounded / size)} {unit}"


def rounded_off(value: float) -> str:
    """Format an error with one digit and an exponent: 7e-14."""
    return "0" if value == 0.0 else f"{value:.0e}".replace("e-0", "e-").removesuffix("e+00")


def markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Format a table, after an empty line; an empty list without rows."""
    if not rows:
        return []
    lines = [header, tuple("---" for _ in header), *rows]
    return ["", *(f"| {' | '.join(cells)} |" for cells in lines)]

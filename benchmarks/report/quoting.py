"""How numbers are quoted in docs/results.md: two digits of a time or a ratio, the third is noise."""

from collections.abc import Sequence

#: Units of a time, largest first [s].
_UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


def two_digits(value: float) -> str:
    """A number to two digits, without an exponent."""
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}" if rounded >= 10 else f"{rounded:.2g}"


def duration(seconds: float) -> str:
    """A time to two digits, in a unit that suits."""
    rounded = float(f"{seconds:.2g}")
    size, unit = next((u for u in _UNITS if rounded >= u[0]), _UNITS[-1])
    return f"{two_digits(rounded / size)} {unit}"


def rounded_off(value: float) -> str:
    """An error as a power of ten: 7e-14."""
    return "0" if value == 0.0 else f"{value:.0e}".replace("e-0", "e-").removesuffix("e+00")


def markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table, an empty one before it; nothing without rows."""
    if not rows:
        return []
    lines = [header, tuple("---" for _ in header), *rows]
    return ["", *(f"| {' | '.join(cells)} |" for cells in lines)]

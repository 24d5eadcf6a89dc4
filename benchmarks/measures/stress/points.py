"""Points of the torture test: distances from a singular point."""

from collections.abc import Iterable

from ...references.closed_forms import Number, mp


def exponents(quick: bool) -> tuple[int, ...]:
    return (3, 10) if quick else tuple(range(1, 16))


def around(centre: Number, exponents: Iterable[int]) -> list[tuple[int | None, float]]:
    """(k, centre (1 +- 10^-k)) as doubles, and the centre itself (k = 16)."""
    points: list[tuple[int | None, float]] = [(16, float(centre))]
    for k in exponents:
        points += [(k, float(centre * (1 + sign * mp.mpf(10) ** -k))) for sign in (1, -1)]
    return points

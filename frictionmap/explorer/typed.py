"""Numbers typed into the page, or into its address, as ratios: they may have units."""

from typing import Any

from . import cell, goal
from .queries import PAGE, Query

#: Keys of its query.
KEYS = tuple(dict.fromkeys((*cell.KEYS, *goal.KEYS, *PAGE)))


def typed(query: Query) -> dict[str, Any]:
    """The numbers of a query as ratios, each with the name under which it was given."""
    view, given = query.view, query.given
    found: dict[str, Any] = {view.across.key: view.r, "beta": view.beta, "mu": view.mu, **query.numbers}
    if "at" in given:
        found["at"] = cell.read(query)
    if "band" in given:
        found["band"] = goal.band_of(query)
    if "limit" in given:
        found["limit"] = goal.limit_of(query)
    return {name: value for name, value in found.items() if name in given}

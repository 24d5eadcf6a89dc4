"""What to mind of a fit, in words."""

from collections.abc import Sequence

import numpy as np

from .least_squares import Errors
from .levels import CORRELATED


def coloured(found: Errors) -> list[str]:
    """Residuals that are no white noise."""
    if found.inflation == 1.0:
        return []
    return [
        f"residuals are not white (lag-1 correlation {found.lag_correlation:.2f}): "
        f"errors are taken {found.inflation:.2f} times as large"
    ]


def trading(names: Sequence[str], correlation: np.ndarray) -> list[str]:
    """Pairs of estimates that can hardly be told apart."""
    pairs = np.argwhere(np.triu(np.abs(correlation) > CORRELATED, 1))
    return [f"{names[i]} and {names[j]} trade: correlation {correlation[i, j]:.2f}" for i, j in pairs]


def only_interval(name: str, bound: float, usable: bool) -> list[str]:
    """A parameter whose standard error cannot be used, as its interval begins on its bound."""
    if usable:
        return []
    return [f"the interval of {name} begins at {bound:g}: it has no standard error that could be used"]


def bounded(names: Sequence[str], floor: np.ndarray, at_bound: np.ndarray) -> list[str]:
    """Estimates on a bound."""
    words = []
    for bound in np.unique(floor[at_bound]):
        there = [name for name, on, at in zip(names, at_bound, floor, strict=True) if on and at == bound]
        words.append(f"{' and '.join(there)} on the bound {bound:g}: the interval is one-sided")
    return words

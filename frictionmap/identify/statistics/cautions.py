"""Warnings about a fit."""

from collections.abc import Sequence

import numpy as np

from .least_squares import Errors
from .levels import CORRELATED


def autocorrelation_warnings(found: Errors) -> list[str]:
    """Warn of autocorrelated residuals."""
    if found.inflation == 1.0:
        return []
    return [
        f"the model does not explain the data down to the noise (residual correlation "
        f"{found.lag_correlation:.2f}): standard errors were multiplied by {found.inflation:.3g}, look at "
        "the residuals with frictionmap plot"
    ]


def correlation_warnings(names: Sequence[str], correlation: np.ndarray) -> list[str]:
    """Warn of pairs of highly correlated estimates."""
    pairs = np.argwhere(np.triu(np.abs(correlation) > CORRELATED, 1))
    return [
        f"{names[i]} and {names[j]} are highly correlated ({correlation[i, j]:.2f}): hold one of them in "
        "[known] if you know it"
        for i, j in pairs
    ]


def interval_warnings(name: str, bound: float, usable: bool) -> list[str]:
    """Warn of a parameter whose standard error is meaningless, as its interval begins on its bound."""
    if usable:
        return []
    return [
        f"the interval of {name} begins at {bound:g}: its standard error is meaningless, use the interval"
    ]


def bound_warnings(names: Sequence[str], floor: np.ndarray, at_bound: np.ndarray) -> list[str]:
    """Warn of estimates on a bound."""
    words = []
    for bound in np.unique(floor[at_bound]):
        there = [name for name, on, at in zip(names, at_bound, floor, strict=True) if on and at == bound]
        words.append(f"{' and '.join(there)} on the bound {bound:g}: the interval is one-sided")
    return words

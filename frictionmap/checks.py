"""Checks of input at the door; every message names the argument, the value and what is legal."""

import difflib
import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from .errors import InputError

#: Cells of one map; 10^9 need at least 13 GB for the default outputs.
MOST_CELLS = 10**9

#: Beyond this the displacement in the contact is nothing beside the load in double precision.
LARGEST_RATIO = 1e8

#: Scan steps follow the fastest decay, 2 zeta/r: beyond this a cell takes more of them than is sensible.
LARGEST_DAMPING = 100.0


def nearest(word: str, legal: Iterable[str]) -> str:
    """' (did you mean ...?)' if a legal word is near, else ''."""
    found = difflib.get_close_matches(word, list(legal), n=1, cutoff=0.5)
    return f" (did you mean {found[0]}?)" if found else ""


def choice(value: object, name: str, legal: tuple[str, ...]) -> str:
    """`value`, if it is one of the legal words."""
    if not isinstance(value, str) or value not in legal:
        hint = nearest(value, legal) if isinstance(value, str) else ""
        raise InputError(f"{name} must be one of {', '.join(legal)}; got {value!r}{hint}")
    return value


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:  # a whole number beyond all doubles
        return math.inf if value > 0 else -math.inf


def number(
    value: object,
    name: str,
    *,
    least: float = -math.inf,
    above: float = -math.inf,
    most: float = math.inf,
) -> float:
    """`value` as a float, if it is a finite number with least <= value <= most and value > above."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise InputError(f"{name} must be a number; got {value!r}")
    result = _as_float(value)
    if not math.isfinite(result):
        raise InputError(f"{name} must be finite; got {result}")
    if result <= above:
        raise InputError(f"{name} must be > {above:g}; got {value}")
    if result < least:
        raise InputError(f"{name} must be >= {least:g}; got {value}")
    if result > most:
        raise InputError(f"{name} must be <= {most:g}; got {value}")
    return result


def whole(value: object, name: str, *, least: int, most: int | None = None) -> int:
    """`value` as an int, if it is a whole number in range."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise InputError(f"{name} must be a whole number; got {value!r}")
    number(int(value), name, least=least, most=math.inf if most is None else most)
    return int(value)


def one_line(value: object) -> str:
    """repr, without the line breaks that arrays have in theirs."""
    return " ".join(repr(value).split())


def axis(values: object, name: str, *, least: float, most: float = math.inf) -> np.ndarray:
    """`values` as a 1-D float64 array, if it is not empty, finite, increasing and in range."""
    try:
        given = np.atleast_1d(np.asarray(values))
    except ValueError:  # rows of different lengths
        given = np.empty(0, dtype=object)
    if given.dtype.kind not in "iuf":  # neither text, nor complex, nor true and false
        raise InputError(f"{name} must be numbers; got {one_line(values)}")
    result = given.astype(np.float64)
    if result.ndim != 1:
        raise InputError(f"{name} must be one-dimensional; got {result.ndim} dimensions")
    if result.size == 0:
        raise InputError(f"{name} must have at least one value; got none")

    def refuse(wrong: np.ndarray, legal: str) -> None:
        if wrong.any():
            index = int(np.argmax(wrong))
            raise InputError(f"{name} must be {legal}; got {result[index]} at index {index}")

    refuse(~np.isfinite(result), "finite")
    refuse(result < least, f">= {least:g}")
    refuse(result > most, f"<= {most:g}")
    refuse(np.concatenate(([False], np.diff(result) <= 0.0)), "increasing")
    return result


def cells(n_mu: int, n_r: int, n_beta: int, name: str = "grid") -> None:
    """Refuse a map too large to hold."""
    total = n_mu * n_r * n_beta
    if total > MOST_CELLS:
        raise InputError(
            f"{name} must have at most {MOST_CELLS:.0e} cells; got {total:.3g} "
            f"({n_mu} mu x {n_r} r x {n_beta} beta)"
        )

"""Checks of input; every message names the argument, its value and the valid range."""

import math
import os
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from .errors import InputError
from .errors import nearest as nearest  # hints, used with the checks

#: Cells of one map; 10^9 need at least 13 GB for the default outputs.
MOST_CELLS = 10**9

#: Beyond this the displacement in the contact is below the rounding of the load.
LARGEST_RATIO = 1e8

#: Scan steps resolve the fastest decay, 2 zeta/r: beyond this limit a cell takes too many of them.
LARGEST_DAMPING = 100.0


#: Characters that an error message quotes of a value; of a longer one its beginning and end.
_LONGEST_REPR = 160

T = TypeVar("T")


def threads(given: int | None = None) -> int:
    """Number of threads to use: the given one, or that of the processors that this process may use.

    The variable NUMBA_NUM_THREADS limits the latter, as it does for programs that are parallel by numba.
    """
    if given is not None:
        return whole(given, "threads", least=1)
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    text = os.environ.get("NUMBA_NUM_THREADS", "").strip()
    if not text:
        return processors
    if not text.isdecimal() or int(text) < 1:
        raise InputError("NUMBA_NUM_THREADS", f"must be a whole number >= 1; got {text!r}")
    return min(processors, int(text))


def one_line(value: object) -> str:
    """Short repr on one line."""
    text = " ".join(repr(value).split())
    half = _LONGEST_REPR // 2
    return text if len(text) <= _LONGEST_REPR else f"{text[:half]} ... {text[-half:]}"


def instance(value: object, name: str, kind: type[T]) -> T:
    """Check that `value` is an instance of a class of the package."""
    if not isinstance(value, kind):
        raise InputError(name, f"must be a frictionmap.{kind.__name__}; got {one_line(value)}")
    return value


def choice(value: object, name: str, valid: tuple[str, ...]) -> str:
    """Check that `value` is one of the valid words."""
    if not isinstance(value, str) or value not in valid:
        hint = nearest(value, valid) if isinstance(value, str) else ""
        raise InputError(name, f"must be one of {', '.join(valid)}; got {one_line(value)}{hint}")
    return value


def unmasked(values: object, name: str) -> None:
    """Refuse an array with masked values, whose hidden numbers are meaningless."""
    if np.ma.is_masked(values):
        raise InputError(name, f"must have no masked values; got {one_line(values)}")


def is_array(value: object) -> bool:
    """Whether a value is an array, also of xarray or pandas, of any size."""
    return hasattr(value, "__array__") and not isinstance(value, type)


def array(values: Any, name: str) -> np.ndarray:
    """Convert to an array; of type object if that fails."""
    unmasked(values, name)
    try:
        return np.asarray(values)
    except (TypeError, ValueError):  # rows of different lengths, a dataset
        return np.empty(0, dtype=object)


def _single(value: Any, name: str) -> Any:
    """Extract the number of an array without dimensions; return other values unchanged."""
    if isinstance(value, (int, float, np.generic)) or not is_array(value):
        return value
    given = array(value, name)
    return given[()] if given.shape == () and given.dtype.kind in "iuf" else value


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
    """Convert to float; refuse unless finite, least <= value <= most and value > above."""
    value = _single(value, name)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise InputError(name, f"must be a number; got {one_line(value)}")
    result = _as_float(value) + 0.0  # not -0.0
    if not math.isfinite(result):
        raise InputError(name, f"must be finite; got {result}")
    if result <= above:
        raise InputError(name, f"must be > {above:g}; got {value}")
    if result < least:
        raise InputError(name, f"must be >= {least:g}; got {value}")
    if result > most:
        raise InputError(name, f"must be <= {most:g}; got {value}")
    return result


def number_list(given: Any, name: str) -> tuple[float, ...]:
    """Check a list of numbers, not empty."""
    listed = isinstance(given, Sequence) and not isinstance(given, (str, bytes))
    if not listed and not (is_array(given) and array(given, name).ndim == 1):
        raise InputError(name, f"must be a list of numbers; got {one_line(given)}")
    if len(given) == 0:
        raise InputError(name, "must have at least one value; got none")
    return tuple(number(one, f"{name}[{k}]") for k, one in enumerate(given))


def whole(value: object, name: str, *, least: int, most: int | None = None) -> int:
    """Convert to int; refuse unless a whole number in range."""
    value = _single(value, name)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise InputError(name, f"must be a whole number; got {one_line(value)}")
    number(int(value), name, least=least, most=math.inf if most is None else most)
    return int(value)


def axis(values: object, name: str, *, least: float, most: float = math.inf) -> np.ndarray:
    """Convert to a 1-D float64 array; refuse unless non-empty, finite, increasing and in range."""
    given = np.atleast_1d(array(values, name))
    if given.dtype.kind not in "iuf":  # neither text, nor complex, nor true and false
        raise InputError(name, f"must be numbers; got {one_line(values)}")
    result = given.astype(np.float64) + 0.0  # not -0.0
    if result.ndim != 1:
        raise InputError(name, f"must be one-dimensional; got {result.ndim} dimensions")
    if result.size == 0:
        raise InputError(name, "must have at least one value; got none")

    first, last = float(result[0]), float(result[-1])  # of a good axis they bound all others
    increasing = bool((result[1:] > result[:-1]).all())
    if not (increasing and math.isfinite(first) and math.isfinite(last) and least <= first and last <= most):
        _refuse_axis(result, name, least, most)
    return result


def _refuse_axis(values: np.ndarray, name: str, least: float, most: float) -> None:
    """Say which value of a wrong axis is wrong."""

    def refuse(wrong: np.ndarray, valid: str) -> None:
        if wrong.any():
            index = int(np.argmax(wrong))
            raise InputError(name, f"must be {valid}; got {values[index]} at index {index}")

    refuse(~np.isfinite(values), "finite")
    refuse(values < least, f">= {least:g}")
    refuse(values > most, f"<= {most:g}")
    refuse(np.concatenate(([False], np.diff(values) <= 0.0)), "increasing")


def cells(n_mu: int, n_r: int, n_beta: int, name: str = "grid", points: int = 1) -> None:
    """Refuse maps that are too large, of one or several points of further axes."""
    total = n_mu * n_r * n_beta * points
    if total > MOST_CELLS:
        further = f" x {points} points" if points > 1 else ""
        raise InputError(
            name,
            f"must have at most {MOST_CELLS:.0e} cells in memory; got {total:.3g} "
            f"({n_mu} mu x {n_r} r x {n_beta} beta{further})",
        )

"""Samples of a record, checked: times that increase, the window, gaps."""

import numpy as np

from ... import checks
from ...errors import InputError
from .turning_points import GAP


def finite_numbers(
    values: object, name: str, size: int | None = None, per: str = "frequency", above: float = -np.inf,
    style: str = "",
) -> np.ndarray:  # fmt: skip
    """Check measured numbers: `size` of them, one `per` something, finite and > `above`.

    style : of a number in a message
    """
    given = np.atleast_1d(checks.array(values, name))
    if given.dtype.kind not in "iuf" or given.ndim != 1 or given.size == 0 or size not in (None, given.size):
        wanted = "a list of numbers" if size is None else f"{size} numbers, one per {per}"
        raise InputError(f"{name} must be {wanted}; got {checks.one_line(values)}")
    wrong = np.flatnonzero(~(np.isfinite(given) & (given > above)))
    if wrong.size:
        valid = "finite" if above == -np.inf else f"finite and > {above:g}"
        raise InputError(f"{name} must be {valid}; got {given[wrong[0]]:{style}} at index {wrong[0]}")
    return given.astype(float)


def checked_record(time: object, x: object, name: str = "x") -> tuple[np.ndarray, np.ndarray]:
    """Times and displacements as arrays of one length, finite, times increasing."""
    times = checks.axis(time, "time", least=-np.inf)
    return times, finite_numbers(x, name, times.size, "time")


def within(window: object, time: np.ndarray) -> np.ndarray:
    """Samples within a window, a list of two times."""
    if window is None:
        return np.ones(time.size, dtype=bool)
    times = checks.axis(window, "window", least=-np.inf)
    if times.size != 2:
        raise InputError(f"window must be two times; got {checks.one_line(window)}")
    begin, end = times
    inside = (time >= begin) & (time <= end)
    if not inside.any():
        raise InputError(
            f"window must hold samples, which lie between {time[0]:g} and {time[-1]:g} s; "
            f"got {begin:g} to {end:g}"
        )
    return inside


def largest_gap(time: np.ndarray) -> float:
    """The longest step between samples, if it is much longer than usual; else 0."""
    steps = np.diff(time)
    return float(steps.max()) if steps.max() > GAP * float(np.median(steps)) else 0.0

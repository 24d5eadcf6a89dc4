"""Samples of a record, checked: times that increase, the window, gaps."""

import numpy as np

from ... import checks
from ...errors import InputError
from .turning_points import GAP


def checked_record(time: object, x: object, name: str = "x") -> tuple[np.ndarray, np.ndarray]:
    """Times and displacements as arrays of one length, finite, times increasing."""
    times = checks.axis(time, "time", least=-np.inf)
    places = np.atleast_1d(checks.array(x, name))
    if places.dtype.kind not in "iuf" or places.shape != times.shape:
        raise InputError(f"{name} must be {times.size} numbers, one per time; got {checks.one_line(x)}")
    wrong = np.flatnonzero(~np.isfinite(places))
    if wrong.size:
        raise InputError(f"{name} must be finite; got {places[wrong[0]]} at index {wrong[0]}")
    return times, places.astype(float)


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

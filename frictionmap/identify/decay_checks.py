"""Checks of records of free decays, and selection of their samples."""

import numpy as np

from .. import checks
from ..errors import InputError
from .turning_points import (
    TurningPoints,
    grows,
    noise_level,
    regular_run,
    resolution,
    turning_points,
    undersampled,
    without_spikes,
)

#: Consecutive samples at an extreme value are clipped if the next one is far from it: by this many steps of
#: the resolution, of which a smooth turning point makes few.
_CLIPPED_ROW = 3
_CLIPPED_STEPS = 4.0

#: Residuals larger than the noise between samples by this factor, and beyond this share of the motion, are
#: not those of a free decay.  Higher harmonics and varying friction leave far smaller ones.
_MISFIT, _MISFIT_SHARE = 10.0, 0.1

#: Spikes make turning points that are not half a period apart; noise and a mass that is held make few.
_REGULAR = 0.5

#: Length of a gap, in usual steps.
_GAP = 3.0


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


def unclipped(x: np.ndarray) -> np.ndarray:
    """Samples that are not cut off at the ends of a measuring range."""
    good = np.ones(x.size, dtype=bool)
    for begin, end in clipped_runs(x):
        good[begin:end] = False
    return good


def clipped_runs(x: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end of every run of clipped samples, at an extreme value far from its neighbours."""
    step = resolution(x)
    found = []
    for extreme in (x.min(), x.max()):
        for begin, end in _runs(x == extreme):
            beside = [abs(x[k] - extreme) for k in (begin - 1, end) if 0 <= k < x.size]
            if end - begin >= _CLIPPED_ROW and beside and max(beside) > _CLIPPED_STEPS * step:
                found.append((begin, end))
    return found


def _runs(chosen: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end of every run of chosen samples."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], chosen.astype(int), [0]))))
    return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2)]


def largest_gap(time: np.ndarray) -> float:
    """The longest step between samples, if it is much longer than usual; else 0."""
    steps = np.diff(time)
    return float(steps.max()) if steps.max() > _GAP * float(np.median(steps)) else 0.0


def checked_turning_points(time: np.ndarray, x: np.ndarray) -> TurningPoints:
    """Turning points of a record that is a free decay.

    Raises
    ------
    InputError
        Nothing moves, samples are too few a cycle, there are fewer than 3 extrema, or the amplitude grows.
    """
    if float(np.ptp(x)) <= 2.0 * resolution(x):
        raise InputError(
            f"cannot fit x: it does not move by more than its resolution ({resolution(x):g}); check the data"
        )
    if wrong := undersampled(x):
        raise InputError(f"cannot fit x: sampling rate too low, {wrong}; sample faster")
    points = _turning_points(time, x)
    if points.time.size < 2:  # the last extremum is where it rests, or where the record ends
        gap = largest_gap(time)
        outside = f" outside a gap of {gap:.4g} s" if gap else ""
        raise InputError(
            f"cannot estimate damping: record too short, fewer than 3 extrema in {x.size} samples"
            f"{outside}; measure more cycles"
        )
    if grows(points, noise_level(x)):
        raise InputError(
            f"cannot fit x as a free decay: its amplitude grows (swings grow from "
            f"{abs(points.place[1] - points.place[0]):.4g} to {abs(points.place[-1] - points.place[-2]):.4g}"
            "); choose a window of one decay"
        )
    return points


def _turning_points(time: np.ndarray, x: np.ndarray) -> TurningPoints:
    """Turning points; if many are spikes, those of the record without spikes."""
    points = turning_points(time, x)
    if points.time.size < 2 or _share_regular(points) > _REGULAR:
        return points
    calm = turning_points(time, without_spikes(x))
    return calm if calm.time.size > 1 and _share_regular(calm) > _share_regular(points) else points


def _share_regular(points: TurningPoints) -> float:
    """The share of turning points in the longest run of those half a period apart."""
    run = regular_run(points)
    return (run.stop - run.start) / points.time.size


def check_misfit(x: np.ndarray, rms: float) -> None:
    """Refuse a fit whose residuals are far above the noise between samples.

    Raises
    ------
    InputError
        The record does not follow a free decay, or no fit of it was found.
    """
    noise = noise_level(x)
    if rms > _MISFIT * noise and rms > _MISFIT_SHARE * float(np.std(x)):
        raise InputError(
            f"cannot fit x as a free decay: the residuals ({rms:.4g} rms) are far above the noise between "
            f"samples ({noise:.4g}); choose a window of one decay, without gaps, impacts or other motion"
        )

"""Flat ends of a motion: clipped by the measuring range, or a mass that sticks at its turning points.

A motion that is cut off comes to the end of the range with the speed that it has there; a mass that sticks
has come to rest.  Beside a flat part of half length k the distance d from the extreme grows with the time t
as

    d = a ((t + k)^2 - k^2)/2,   k = 0 of a mass that came to rest,

so two such times determine k.  A record that shows its noise shows it in a stop as well: then only a clipped
plateau is flat.
"""

import numpy as np

from .samples import clipped_runs
from .turning_points import noise_level, resolution

#: Distances from the extreme at which times are taken: steps of the resolution, or shares of the range.
_STEPS, _SHARE = 8.0, 0.02

#: The second distance over the first one.
_FARTHER = 4.0

#: Steps between samples by which k is above that of a stop, which lies between -1 and 0.
_CUT_OFF = 0.5

#: Noise is as large in differences of a higher order, which a smooth motion is not.
_AS_LARGE = 0.5


def unclipped_mass(time: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Samples that are not clipped, for a mass that may stick at the extremes."""
    good = np.ones(x.size, dtype=bool)
    runs = clipped_runs(x)
    noisy = bool(runs) and _shows_noise(x, runs)
    for extreme in {float(x[begin]) for begin, _ in runs}:
        here = [(begin, end) for begin, end in runs if x[begin] == extreme]
        speeds = [steps for run in here for steps in _cut_off(time, x, run)]
        if noisy or not speeds or np.median(speeds) > _CUT_OFF:
            good[x == extreme] = False
    return good


def _shows_noise(x: np.ndarray, runs: list[tuple[int, int]]) -> bool:
    """Return whether there is noise above the resolution outside the flat parts, where it may be cut off."""
    moves = np.ones(x.size, dtype=bool)
    for begin, end in runs:
        moves[begin:end] = False
    higher = noise_level(x, 6, moves)
    return higher > max(resolution(x), _AS_LARGE * noise_level(x, 4, moves))


def _cut_off(time: np.ndarray, x: np.ndarray, run: tuple[int, int]) -> list[float]:
    """k over the step between samples, from before a flat part and from behind it."""
    begin, end = run
    step = float(np.median(np.diff(time[begin:end])))
    found = []
    for t, places in (
        (time[begin] - time[begin::-1], x[begin::-1]), (time[end - 1 :] - time[end - 1], x[end - 1 :]),
    ):  # fmt: skip
        times = _times_of_distances(t, np.abs(places - x[begin]), x)
        if times is not None:
            near, far = times
            steep = 2.0 * (_FARTHER * near - far)
            k = (far**2 - _FARTHER * near**2) / steep if steep > 0.0 else np.inf
            found.append(k / step)
    return found


def _times_of_distances(t: np.ndarray, d: np.ndarray, x: np.ndarray) -> tuple[float, float] | None:
    """Times at which two distances from the extreme are reached; None where the record ends before."""
    near = max(_STEPS * resolution(x), _SHARE * float(np.ptp(x)))
    times = []
    for distance in (near, _FARTHER * near):
        over = np.flatnonzero(d >= distance)
        if not over.size:
            return None
        k = int(over[0])
        share = (distance - d[k - 1]) / (d[k] - d[k - 1])
        times.append(float(t[k - 1] + share * (t[k] - t[k - 1])))
    return times[0], times[1]

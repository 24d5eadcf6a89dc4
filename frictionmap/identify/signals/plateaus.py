"""Flat ends of a motion: clipped by the measuring range, or a mass that sticks at its turning points.

A motion that is clipped reaches the end of the range with the speed that it has there, a mass that sticks has
come to rest.  So a smooth curve through the samples beside a flat part, continued into it, rises above the
end of the range by what was cut off, but above a stop by no more than resolution and noise.  What is cut off
by less than that does no harm.

If a record shows its noise everywhere but at its ends, it is clipped there, however little is cut off.
"""

from typing import NamedTuple

import numpy as np

from .turning_points import noise_level, resolution

#: Samples in a row at an extreme value that can be clipped.
_FLAT = 3

#: Distance from the extreme over which the curve follows a motion: multiples of the resolution, of the
#: standard deviation of the noise, or this share of the range, so that none of them bends it; at most half
#: the range, where a sine changes its curvature.
_STEPS, _DEVIATIONS, _SHARE, _MOST_SHARE = 40.0, 8.0, 0.02, 0.5

#: Samples that a curve takes at least, if they are within the largest distance; fewer than 3 are none.
_SAMPLES, _FEWEST = 4, 3

#: Height of the curve above the extreme that a stop can show.  Rounding moves the extreme and the samples of
#: the curve by half a step each, and continuation enlarges the error: two steps, as many standard deviations
#: of the noise, and this share of the distance, by which curves of other shapes are off.
_OF_STEPS, _OF_NOISE, _OF_REACH = 2.0, 2.0, 0.02

#: If a sample is farther from the flat part beside it than this many steps, that is no slow turn of a coarse
#: record; used if there are too few samples for a curve.
_JUMP = 4.0

#: White noise is as large in differences of a higher order, at least by this factor; a smooth motion is not.
_AS_LARGE = 0.5

#: Where noise covers the resolution, flat parts elsewhere are shorter than this share of those at the ends.
_SHORT = 0.5


class _Scale(NamedTuple):
    """Resolution and noise of a record."""

    step: float  # of the resolution
    noise: float  # standard deviation, rounding included
    extent: float  # from the least to the largest value
    reach: float  # distance from an extreme over which curves follow the motion


def unclipped(time: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Samples that are not cut off at the ends of a measuring range, bool (samples,).

    time, x : shape (samples,); flat parts of a motion that comes to rest at its extremes are not clipped
    """
    good = np.ones(x.size, dtype=bool)
    ends = [end for end in np.unique([x.min(), x.max()]) if _flat_parts(x == end)]
    if not ends or np.ptp(x) == 0.0:
        return good
    noise = _noise(x, ends)
    scale, certain = _scale(x, min(noise)), _only_ends_are_flat(x, ends, *noise)
    allowed = _OF_STEPS * scale.step + _OF_NOISE * scale.noise + _OF_REACH * scale.reach
    for end in ends:
        if certain or _cut_off(time, np.abs(x - end), scale) > allowed:
            good[x == end] = False
    return good


def _flat_parts(chosen: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end of every run of chosen samples that is long enough to be clipped."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], chosen.astype(int), [0]))))
    return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2) if end - begin >= _FLAT]


def _noise(x: np.ndarray, ends: list[float]) -> tuple[float, float]:
    """Standard deviations of the noise outside the flat ends, by differences of two orders."""
    moves = np.ones(x.size, dtype=bool)
    for end in ends:
        for begin, behind in _flat_parts(x == end):
            moves[begin:behind] = False
    return noise_level(x, 4, moves), noise_level(x, 6, moves)


def _scale(x: np.ndarray, noise: float) -> _Scale:
    """Resolution, noise and the distances that follow from them."""
    step, extent = resolution(x), float(np.ptp(x))
    reach = max(_STEPS * step, _DEVIATIONS * noise, _SHARE * extent)
    return _Scale(step, noise, extent, min(reach, _MOST_SHARE * extent))


def _only_ends_are_flat(x: np.ndarray, ends: list[float], lower: float, higher: float) -> bool:
    """Return whether there is noise above the resolution, also where the motion is slow, but not at the ends.

    A mass at rest may have less noise than one that slides.  Then its other stops are flat as well.

    lower, higher : standard deviations of the noise by differences of a lower and a higher order
    """
    if higher < _AS_LARGE * lower or min(lower, higher) <= resolution(x):
        return False
    at_ends = np.isin(x, ends)
    edges = np.flatnonzero(np.diff(x) != 0.0) + 1
    begins = np.concatenate(([0], edges))
    lengths = np.diff(np.append(begins, x.size))
    there = at_ends[begins]
    return bool(lengths[~there].max(initial=0) < _SHORT * lengths[there].max())


def _cut_off(time: np.ndarray, away: np.ndarray, scale: _Scale) -> float:
    """Height by which the motion rises above an extreme, from before the flat parts and from behind them.

    A stop begins at rest and ends slowly or with a jump of the force; so of both sides the lower one counts.

    away : shape (samples,), distances from the extreme
    """
    parts = _joined(away, scale.reach)
    sides: tuple[list[float | None], list[float | None]] = ([], [])
    for begin, end in parts:
        length = float(time[end - 1] - time[begin])
        if begin > 0:
            before = slice(begin - 1, None, -1)
            sides[0].append(_height(time[begin] - time[before], away[before], length, scale))
        if end < away.size:
            sides[1].append(_height(time[end:] - time[end - 1], away[end:], length, scale))
    found = [float(np.median(known)) for side in sides if (known := [one for one in side if one is not None])]
    if found:
        return min(found)
    beside = max(away[k] for begin, end in parts for k in (begin - 1, end) if 0 <= k < away.size)
    return np.inf if beside > _JUMP * scale.step else 0.0


def _joined(away: np.ndarray, reach: float) -> list[tuple[int, int]]:
    """Flat parts at an extreme, joined if the motion does not go farther than `reach` between them."""
    parts = _flat_parts(away == 0.0)
    joined = parts[:1]
    for begin, end in parts[1:]:
        if (away[joined[-1][1] : begin] <= reach).all():
            joined[-1] = joined[-1][0], end
        else:
            joined.append((begin, end))
    return joined


def _height(t: np.ndarray, away: np.ndarray, length: float, scale: _Scale) -> float | None:
    """Height of a curve through samples beside a flat part within it; None if there are too few samples.

    The curve is d = A (1 - cos w (t + t0)) - h with the extent as A: between the parabola of a constant force
    and the sine that ends at the other extreme.  For d it has the quadratic A/2 arccos(1 - d/A)^2, about d.

    t, away : times since the flat part (or before it) and distances from the extreme, increasing in t
    length : of the flat part, s
    """
    beyond = np.flatnonzero(away > scale.reach)
    if not beyond.size:
        return None
    outside = np.flatnonzero(away > _MOST_SHARE * scale.extent)
    count = min(max(_SAMPLES, int(beyond[0])), int(outside[0]) if outside.size else away.size)
    if count < _FEWEST:
        return None
    straightened = 0.5 * scale.extent * np.arccos(1.0 - away[:count] / scale.extent) ** 2
    place, slope, bend = np.polynomial.polynomial.polyfit(t[:count], straightened, 2)
    # the least distance in the flat part: at the vertex, if that lies within, else at the other end
    top = -length if bend <= 0.0 else float(np.clip(-0.5 * slope / bend, -length, 0.0))
    return -float(min(place, place + slope * top + bend * top**2))

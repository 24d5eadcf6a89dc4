"""Turning points of a measured decay, and results that need no model."""

import math
from typing import NamedTuple

import numpy as np

#: A swing back by this share of the largest one is a turning point, if noise does not swing as far.
_SHARE = 0.02

#: Shares of the changes from sample to sample, in order of size, up to which the least step is looked for,
#: and its multiples that are compared: more would add up the error of the step.
_SMALL_CHANGES, _MULTIPLES = (0.25, 0.1, 0.05, 0.02), 8

#: Changes are multiples of a step if this share of them, of this many or more, deviates by less than this
#: part of the step.  Of changes that are no multiples a fifth do.
_MOST, _ENOUGH, _DEVIATION = 0.9, 20, 0.1

#: Swings that count for the number of samples per cycle, over the range: noise does not reach this.
_LARGE = 0.2

#: Samples per cycle; with fewer, a turning point is not seen between two of them.
_LEAST_SAMPLES = 8

#: Length of a gap between two samples, in usual steps.
GAP = 3.0

#: A gap of this share of half a cycle, or less, hides one turning point at most, and a parabola through both
#: of its edges still locates that one.  A longer gap can hide several.
_BRIDGED = 0.9

#: Samples on each side of an extreme one through which a parabola locates the turning point.
_BESIDE = 3


class TurningPoints(NamedTuple):
    """Turning points in the order of time."""

    time: np.ndarray  # s
    place: np.ndarray
    upper: np.ndarray  # bool: a maximum
    number: np.ndarray  # half cycles since the first one, whole; those that a gap hides are counted


def noise_level(x: np.ndarray, order: int = 4, used: np.ndarray | None = None) -> float:
    """Standard deviation of the noise: the median of fourth differences, in which smooth motion cancels.

    used : bool (samples,), samples that may be part of a difference; default: all
    """
    if x.size <= order:
        return 0.0
    differences = np.diff(x, order)
    if used is not None:
        differences = differences[np.lib.stride_tricks.sliding_window_view(used, order + 1).all(axis=1)]
        if not differences.size:
            return 0.0
    # a normal deviate is below 0.6745 deviations in half of all cases; the squares 1, 4, 6, 4, 1 add to 70
    return float(np.median(np.abs(differences)) / (0.6745 * np.sqrt(math.comb(2 * order, order))))


def without_spikes(x: np.ndarray) -> np.ndarray:
    """Medians of five samples around each; at the ends, where there are fewer, the samples themselves."""
    if x.size < 5:
        return x
    windows = np.lib.stride_tricks.sliding_window_view(x, 5)
    return np.concatenate((x[:2], np.median(windows, axis=1), x[-2:]))


def resolution(x: np.ndarray) -> float:
    """The step of the converter that made a record; 0 if all values are equal.

    Readings of one step may differ a little, by the digits of a file or a change of units, so the least
    difference between two values can be far below the step.  If the small differences from one sample to the
    next are multiples of one number, that is the step.  Else it is the least difference between two values.
    """
    changes = np.abs(np.diff(x))
    changes = np.sort(changes[changes > 0.0])
    if not changes.size:
        return 0.0
    for share in _SMALL_CHANGES:
        step = _common_step(changes, float(changes[int(share * changes.size)]))
        if step is not None:
            return step
    return float(np.diff(np.unique(x)).min())


def _common_step(changes: np.ndarray, near: float) -> float | None:
    """The number near a given one of which small changes, increasing, are multiples; None if they are not."""
    small = changes[changes < (_MULTIPLES + 0.5) * near]
    if small.size < _ENOUGH:
        return None
    whole = small > 0.5 * near  # less than that is the deviation of two readings of one step
    step = float(np.median(small[whole] / np.rint(small[whole] / near)))
    off = np.abs(small / step - np.rint(small / step))
    return step if np.mean(off < _DEVIATION) > _MOST else None


def turning_points(time: np.ndarray, x: np.ndarray, larger: float = 1.0) -> TurningPoints:
    """Find turning points where the motion reverses by more than its noise, refined by parabolas.

    larger : factor of the noise over that between samples
    """
    # normal deviates span about 2 sqrt(2 ln n) deviations, give or take one
    noise = (2.0 * np.sqrt(2.0 * np.log(max(x.size, 2))) + 1.0) * larger * noise_level(x)
    swing = max(noise, _SHARE * float(np.ptp(x)))
    found = np.array(turns(x, swing), dtype=int)
    if found.size < 2:
        return _located(time, x, found, np.zeros(found.size, dtype=bool), np.zeros(0, dtype=bool), np.inf)
    upper = x[found] > x[np.roll(found, 1)]  # maxima and minima follow in turn
    upper[0] = not upper[1]
    half = _usual_half(time, found)
    gaps = gaps_after(time, _BRIDGED * half)
    # beside a long gap an extreme sample is where the record breaks off, not where the motion turns back
    kept = ~_spanned(found - _BESIDE, found + _BESIDE, gaps)
    found, upper = found[kept], upper[kept]
    return _located(time, x, found, upper, _spanned(found[:-1], found[1:], gaps), half)


def _located(
    time: np.ndarray, x: np.ndarray, found: np.ndarray, upper: np.ndarray, gaps: np.ndarray, half: float
) -> TurningPoints:
    """Turning points at some samples, refined and numbered; `gaps`: whether there is one before the next."""
    refined = np.array([_vertex(time, x, index) for index in found]).reshape(-1, 2)
    return TurningPoints(refined[:, 0], refined[:, 1], upper, _numbered(refined[:, 0], upper, gaps, half))


def gaps_after(time: np.ndarray, least: float = 0.0) -> np.ndarray:
    """Samples, by their indices, after which there is a gap that is longer than `least` [s]."""
    steps = np.diff(time)
    return np.flatnonzero(steps > max(GAP * float(np.median(steps)), least))


def hides_turning_points(time: np.ndarray, half: float) -> bool:
    """Whether there is a gap that can hide more than one turning point, `half` [s] apart."""
    return time.size > 1 and gaps_after(time, _BRIDGED * half).size > 0


def _spanned(begins: np.ndarray, ends: np.ndarray, gaps: np.ndarray) -> np.ndarray:
    """Whether there is a gap between two samples, for many pairs of their indices."""
    return np.searchsorted(gaps, ends) > np.searchsorted(gaps, begins)


def _usual_half(time: np.ndarray, found: np.ndarray) -> float:
    """Usual time between two turning points, if possible of those with no gap between them."""
    spanned = _spanned(found[:-1], found[1:], gaps_after(time))
    steps = np.diff(time[found])
    return float(np.median(steps if spanned.all() else steps[~spanned]))


def _numbered(times: np.ndarray, upper: np.ndarray, gaps: np.ndarray, half: float) -> np.ndarray:
    """Half cycles since the first turning point: across a gap odd from a maximum to a minimum, else even."""
    odd = (upper[1:] != upper[:-1]).astype(int)
    steps = 2 * np.rint((np.diff(times) / half - odd) / 2.0).astype(int) + odd
    return np.concatenate(([0], np.cumsum(np.where(gaps, np.maximum(steps, 2 - odd), 1))))[: times.size]


def regular_run(points: TurningPoints) -> slice:
    """The longest run of turning points half a period apart: none of them is noise, or a spike."""
    steps = np.diff(points.time) / np.diff(points.number)
    usual = float(np.median(steps))
    edges = np.flatnonzero(np.abs(steps - usual) >= 0.5 * usual)
    begins, ends = np.concatenate(([0], edges + 1)), np.concatenate((edges, [steps.size]))
    longest = int(np.argmax(ends - begins))
    return slice(int(begins[longest]), int(ends[longest]) + 1)


def samples_a_cycle(x: np.ndarray) -> float:
    """Samples per cycle of the large swings; infinite if there are not two turning points."""
    found = turns(x, _LARGE * float(np.ptp(x)))
    return 2.0 * float(np.median(np.diff(found))) if len(found) > 1 else np.inf


def undersampled(x: np.ndarray) -> str:
    """Describe a sampling rate that is too low; empty if it suffices."""
    found = samples_a_cycle(x)
    return f"{found:g} samples per cycle, {_LEAST_SAMPLES} needed" if found < _LEAST_SAMPLES else ""


def grows(points: TurningPoints, noise: float) -> bool:
    """Whether the later swings are larger than the earlier ones, by more than noise can make them."""
    swings = np.abs(np.diff(points.place))[np.diff(points.number) == 1]
    half = swings.size // 2
    if half == 0:
        return False
    early, late = float(swings[:half].mean()), float(swings[-half:].mean())
    return late - early > max(3.0 * noise, _SHARE * early)


def linear_decrement(points: TurningPoints) -> float | None:
    """x_F as T(4.3) has it: a quarter of the drop between subsequent maxima, averaged over every pair.

    Whatever damps counts as friction.  With viscous damping the drop gets smaller and smaller, so that the
    average depends on which maxima are seen; all are taken.  If there is but one, minima are.
    """
    peaks = points.upper if points.upper.sum() > 1 else ~points.upper
    if peaks.sum() < 2:
        return None
    places, numbers = points.place[peaks], points.number[peaks]
    return float(abs(places[0] - places[-1])) / (2.0 * float(numbers[-1] - numbers[0]))


def turns(x: np.ndarray, swing: float) -> list[int]:
    """Samples at which the motion turned back by more than `swing`; neither the first one nor the last."""
    found: list[int] = []
    low = high = 0  # the samples with the least and the largest value since the last turning point
    rising = 0
    for index in range(1, x.size):
        if x[index] > x[high]:
            high = index
        if x[index] < x[low]:
            low = index
        if rising >= 0 and x[high] - x[index] > swing:
            found.append(high)
            rising, low = -1, index
        elif rising <= 0 and x[index] - x[low] > swing:
            found.append(low)
            rising, high = 1, index
    return [index for index in found if index > 0]


def _vertex(time: np.ndarray, x: np.ndarray, index: int) -> tuple[float, float]:
    """The turning point of a parabola through up to seven samples around an extreme one."""
    around = slice(max(index - _BESIDE, 0), index + _BESIDE + 1)
    t, values = time[around] - time[index], x[around]
    curvature, slope, place = np.polyfit(t, values, 2)
    offset = -0.5 * slope / curvature if curvature else 0.0
    if not t[0] <= offset <= t[-1]:  # noise, or a plateau: no parabola
        return float(time[index]), float(x[index])
    return float(time[index] + offset), float(place + 0.5 * slope * offset)

"""Turning points of a measured decay, and what they tell without any model."""

import math
from typing import NamedTuple

import numpy as np

#: A swing back by this share of the largest one is a turning point, if noise does not swing as far.
_SHARE = 0.02

#: Swings by which the number of samples a cycle is judged: so large that no usual noise makes one.
_LARGE = 0.2

#: Samples a cycle; with fewer, a turning point is not seen between two of them.
_LEAST_SAMPLES = 8


class TurningPoints(NamedTuple):
    """Turning points in the order of time."""

    time: np.ndarray  # s
    place: np.ndarray


def noise_level(x: np.ndarray, order: int = 4) -> float:
    """Standard deviation of the noise: the median of fourth differences, in which smooth motion cancels."""
    if x.size <= order:
        return 0.0
    # a normal deviate is below 0.6745 deviations in half of all cases; the squares 1, 4, 6, 4, 1 add to 70
    return float(np.median(np.abs(np.diff(x, order))) / (0.6745 * np.sqrt(math.comb(2 * order, order))))


def without_spikes(x: np.ndarray) -> np.ndarray:
    """Medians of five samples around each; at the ends, where there are fewer, the samples themselves."""
    if x.size < 5:
        return x
    windows = np.lib.stride_tricks.sliding_window_view(x, 5)
    return np.concatenate((x[:2], np.median(windows, axis=1), x[-2:]))


def resolution(x: np.ndarray) -> float:
    """The least difference between two values; 0 if all are equal."""
    steps = np.diff(np.unique(x))
    return float(steps.min()) if steps.size else 0.0


def turning_points(time: np.ndarray, x: np.ndarray) -> TurningPoints:
    """Where the motion turns back by more than its noise, refined by parabolas."""
    # normal deviates span about 2 sqrt(2 ln n) deviations, give or take one
    noise = (2.0 * np.sqrt(2.0 * np.log(max(x.size, 2))) + 1.0) * noise_level(x)
    swing = max(noise, _SHARE * float(np.ptp(x)))
    refined = [_vertex(time, x, index) for index in turns(x, swing)]
    return TurningPoints(np.array([t for t, _ in refined]), np.array([place for _, place in refined]))


def samples_a_cycle(x: np.ndarray) -> float:
    """Samples in a cycle of the large swings; infinite if there are not two turning points."""
    found = turns(x, _LARGE * float(np.ptp(x)))
    return 2.0 * float(np.median(np.diff(found))) if len(found) > 1 else np.inf


def undersampled(x: np.ndarray) -> str:
    """What is wrong with the rate of sampling, or nothing."""
    found = samples_a_cycle(x)
    return f"{found:g} samples a cycle; {_LEAST_SAMPLES} are needed" if found < _LEAST_SAMPLES else ""


def grows(points: TurningPoints, noise: float) -> bool:
    """Whether the later swings are larger than the earlier ones, by more than noise can make them."""
    swings = np.abs(np.diff(points.place))
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
    begins_low = bool(points.place[0] < points.place[1])
    maxima, minima = points.place[int(begins_low) :: 2], points.place[int(not begins_low) :: 2]
    peaks = maxima if maxima.size > 1 else minima
    return float(abs(peaks[0] - peaks[-1])) / (4.0 * (peaks.size - 1)) if peaks.size > 1 else None


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
    around = slice(max(index - 3, 0), index + 4)
    t, values = time[around] - time[index], x[around]
    curvature, slope, place = np.polyfit(t, values, 2)
    offset = -0.5 * slope / curvature if curvature else 0.0
    if not t[0] <= offset <= t[-1]:  # noise, or a plateau: no parabola
        return float(time[index]), float(x[index])
    return float(time[index] + offset), float(place + 0.5 * slope * offset)

"""The friction with the smallest peak response over a band, also where the friction is uncertain."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..errors import InputError, NoSteadyState
from .extremes import Brackets, brackets_of, sharpened
from .minimum import Points, alike, local_minima, lowest, lowest_of, plateau_begin
from .performance import Peaks, PerformanceCurve
from .task import Task

#: Local minima of the samples that are refined: those below this multiple of the lowest one.
_PROMISING = 2.0

#: Values of the curve that count as one: of a plateau, of two peaks at the optimum.
_PLATEAU, TWO_PEAKS = 1e-9, 1e-8

#: A peak over the whole band above those that were followed by more than this was missed before.
_MISSED = 1e-10

#: The curve is also computed at these multiples of the answer, for pictures and for crossings.
_AROUND = np.linspace(0.5, 1.5, 21)

#: Rounds in which peaks that were missed are added.
_AGAIN = 5

#: Another minimum is reported up to this multiple of the best one.
_SECOND = 1.05


class Minimum(NamedTuple):
    """A local minimum of a performance curve."""

    beta: float
    size: float
    kind: str


class Optimum(NamedTuple):
    """The best minimum with its peaks, the second best or None, and points of the curve."""

    best: Minimum
    peaks: Peaks
    second: Minimum | None
    points: Points


def largest(peaks: list[Peaks]) -> np.ndarray:
    """M of peaks at several beta."""
    return np.array([one.largest for one in peaks])


def sampled(task: Task, curve: PerformanceCurve) -> Points:
    """The performance curve at the friction ratios of the search.

    Raises
    ------
    InputError
        Nothing moves in the band.
    """
    beta = task.searched()
    points = Points(beta, largest(curve.whole(beta)))
    if not points.size.any():
        raise InputError(
            f"response must be one that friction changes; got the {task.response.words()}, which is 0 over "
            f"the whole band"
        )
    return points


def _kind(points: Points, best: int, peaks: Peaks) -> str:
    """How the least value at the point `best` of a refined curve comes about."""
    if peaks.size.size > 1 and alike(peaks.size[:2], TWO_PEAKS):
        return "two equal peaks"
    return "at the bound" if best in (0, points.beta.size - 1) else "smooth"


def bracket(points: Points, k: int) -> tuple[float, float]:
    """Places of the neighbours of a point."""
    return float(points.beta[max(k - 1, 0)]), float(points.beta[min(k + 1, points.beta.size - 1)])


def _refined(curve: PerformanceCurve, values: Callable, points: Points, k: int) -> tuple[Minimum, Peaks]:
    """The local minimum next to point k of some, refined until a look at the whole band adds no peak."""
    low, high = bracket(points, k)
    for _ in range(_AGAIN):
        refined = lowest(values, points, low, high)
        k = lowest_of(refined, low, high)
        (peaks,) = curve.whole(refined.beta[k : k + 1], all_peaks=True)
        if peaks.largest <= refined.size[k] * (1.0 + _MISSED):
            break
        curve.forget(low, high)
        (peaks,) = curve.whole(refined.beta[k : k + 1], all_peaks=True)
        points = points.with_more(refined.beta[k : k + 1], np.array([peaks.largest]))
    _refuse_unknown(curve, low, high)
    if k + 1 < refined.beta.size and alike(refined.size[[k, _index(refined, high)]], _PLATEAU):
        beta = plateau_begin(values, refined, k, _PLATEAU)
        (peaks,) = curve.whole(np.array([beta]), all_peaks=True)
        return Minimum(beta, peaks.largest, "plateau"), peaks
    minimum = Minimum(float(refined.beta[k]), peaks.largest, _kind(refined, k, peaks))
    return minimum, peaks


def _index(points: Points, beta: float) -> int:
    """Index of a known place."""
    return int(np.searchsorted(points.beta, beta))


def _refuse_unknown(curve: PerformanceCurve, low: float, high: float) -> None:
    """Refuse an optimum next to cells that have no known response: theirs may be larger."""
    near = {beta: count for beta, count in curve.unknown.items() if low <= beta <= high}
    if near:
        beta, count = next(iter(near.items()))
        raise NoSteadyState(
            f"cannot answer: {count} cells of the band have no periodic steady state at beta = {beta:.6g}, "
            f"next to the optimum; narrow the band or the range of beta, or add damping"
        )


def find_optimum(task: Task, curve: PerformanceCurve) -> Optimum:
    """Find the least of the performance curve of a task.

    Raises
    ------
    NoSteadyState
        A cell of the band has no periodic steady state.
    """
    points = sampled(task, curve)

    def values(beta: np.ndarray) -> np.ndarray:
        return largest(curve.at(beta))

    promising = [k for k in local_minima(points) if points.size[k] <= _PROMISING * points.size.min()]
    found = [_refined(curve, values, points, k) for k in promising]
    found.sort(key=lambda one: one[0].size)
    best, peaks = found[0]
    around = best.beta * _AROUND
    curve.at(around[(around >= points.beta[0]) & (around <= points.beta[-1])])
    others = [one for one, _ in found[1:] if one.size <= _SECOND * best.size]
    table = curve.table
    refined = Points(np.array([one.beta for one in table]), largest(table))
    return Optimum(best, peaks, others[0] if others else None, refined)


def _inner_maxima(curve: PerformanceCurve, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Places and values of the local maxima of a performance curve, without its ends."""
    found = brackets_of(points.beta, np.where(np.isinf(points.size), np.finfo(float).max, points.size))
    inside = (found.a < found.m) & (found.m < found.b)
    chosen = Brackets(*(array[inside] for array in found))

    def values(_: np.ndarray, beta: np.ndarray) -> np.ndarray:
        places, back = np.unique(beta, return_inverse=True)
        return largest(curve.at(places))[back]

    return sharpened(values, chosen) if chosen.m.size else (np.empty(0), np.empty(0))


def find_robust(task: Task, curve: PerformanceCurve, spread: float) -> Optimum:
    """Find the least over beta of the largest of M between beta (1 - spread) and beta (1 + spread)."""
    points = sampled(task, curve)
    places, sizes = _inner_maxima(curve, points)

    def worst(beta: np.ndarray) -> np.ndarray:
        ends = np.union1d(beta * (1.0 - spread), beta * (1.0 + spread))
        known = dict(zip(ends.tolist(), largest(curve.at(ends)).tolist(), strict=True))
        low, high = beta * (1.0 - spread), beta * (1.0 + spread)
        found = [max(known[a], known[b]) for a, b in zip(low.tolist(), high.tolist(), strict=True)]
        inner = (places > low[:, np.newaxis]) & (places < high[:, np.newaxis])
        return np.maximum(found, np.where(inner, sizes, 0.0).max(axis=1, initial=0.0))

    beta = points.beta[
        (points.beta * (1.0 - spread) >= task.low) & (points.beta * (1.0 + spread) <= task.high)
    ]
    if beta.size < 3:
        raise InputError(f"spread must leave a range of friction to search; got {spread:g}")
    robust = Points(beta, worst(beta))
    best: Minimum | None = None
    for k in local_minima(robust):
        low, high = bracket(robust, k)
        refined = lowest(worst, robust, low, high)
        j = lowest_of(refined, low, high)
        kind = "at the bound" if j in (0, refined.beta.size - 1) else "smooth"
        one = Minimum(float(refined.beta[j]), float(refined.size[j]), kind)
        best = one if best is None or one.size < best.size else best
    assert best is not None
    ends = curve.whole(best.beta * np.array([1.0 - spread, 1.0 + spread]), all_peaks=True)
    table = curve.table
    refined = Points(np.array([one.beta for one in table]), largest(table))
    return Optimum(best, max(ends, key=lambda one: one.largest), None, refined)

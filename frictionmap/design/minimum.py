"""Minima and crossings of a performance curve: smooth ones by parabolas, kinks where two lines meet."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from .extremes import Brackets, vertex

#: New places beside each proposed one, as a share of the bracket.
_ASIDE = 0.05

#: Steps, at most.
_STEPS = 40

#: A smooth minimum ends where the values of its bracket agree to the first number, and its place is known to
#: about the second; where values agree in a narrower bracket the curve has a kink, and its minimum ends where
#: they agree to the third.
_SMOOTH, _PLACE, _KINK = 1e-8, 1e-5, 1e-12

#: Least width of a bracket, relative to its place.
_NARROW = 1e-14

#: The least positive number: everything that is not 0 is above it or equal.
_LEAST = float(np.finfo(float).tiny)

#: M(beta) at increasing beta.
Curve = Callable[[np.ndarray], np.ndarray]


class Points(NamedTuple):
    """Known points of a curve, by increasing beta."""

    beta: np.ndarray
    size: np.ndarray

    def with_more(self, beta: np.ndarray, size: np.ndarray) -> "Points":
        """These and further points; of equal places the new one."""
        places = np.concatenate((beta, self.beta))
        sizes = np.concatenate((size, self.size))
        places, first = np.unique(places, return_index=True)
        return Points(places, sizes[first])


def local_minima(points: Points) -> list[int]:
    """Indices of all local minima, ends included; of a plateau the first."""
    padded = np.concatenate(([np.inf], points.size, [np.inf]))
    lower = (points.size < padded[:-2]) & (points.size <= padded[2:])
    return np.flatnonzero(lower).tolist()


def _meeting(points: Points, a: int, b: int, c: int, d: int) -> float:
    """Place where the line through points a, b meets that through c, d; NaN without one."""
    if min(a, b, c, d) < 0 or max(a, b, c, d) >= points.beta.size:
        return np.nan
    x, y = points
    with np.errstate(all="ignore"):
        first, second = (y[b] - y[a]) / (x[b] - x[a]), (y[d] - y[c]) / (x[d] - x[c])
        return float((y[c] - y[a] + first * x[a] - second * x[c]) / (first - second))


def _proposals(points: Points, k: int) -> np.ndarray:
    """New places between the neighbours of the lowest point k."""
    low, high = max(k - 1, 0), min(k + 1, points.beta.size - 1)
    a, m, b = points.beta[[low, k, high]]
    at = -points.size[[low, k, high]]
    centres = [
        float(vertex(Brackets(*(np.array([value]) for value in (a, m, b, *at))))[0]),
        _meeting(points, k - 2, k - 1, k, k + 1),
        _meeting(points, k - 1, k, k + 1, k + 2),
    ]
    aside = _ASIDE * (b - a)
    found = [centre + shift for centre in centres if a <= centre <= b for shift in (-aside, 0.0, aside)]
    found += [0.5 * (a + m), 0.5 * (m + b)]
    places = np.unique(np.clip(found, a, b))
    return places[~np.isin(places, points.beta)]


def _is_found(points: Points, k: int) -> bool:
    low, high = max(k - 1, 0), min(k + 1, points.beta.size - 1)
    width = points.beta[high] - points.beta[low]
    spread = points.size[[low, high]].max() - points.size[k]
    size, place = abs(points.size[k]), abs(points.beta[k])
    smooth = spread <= _SMOOTH * size and width > _PLACE * place
    return smooth or spread <= _KINK * size or width <= _NARROW * place


def lowest_of(points: Points, low: float, high: float) -> int:
    """Index of the lowest of the points from low to high."""
    inside = np.flatnonzero((points.beta >= low) & (points.beta <= high))
    return int(inside[np.argmin(points.size[inside])])


def lowest(curve: Curve, points: Points, low: float, high: float) -> Points:
    """Points of a curve with its minimum between low and high, refined: see `lowest_of`."""
    for _ in range(_STEPS):
        k = lowest_of(points, low, high)
        places = np.empty(0) if _is_found(points, k) else _proposals(points, k)
        if not places.size:
            break
        points = points.with_more(places, curve(places))
    return points


def changes(points: Points, limit: float) -> np.ndarray:
    """Indices k for which a curve crosses a limit between its points k and k + 1."""
    above = points.size > limit
    return np.flatnonzero(above[1:] != above[:-1])


def crossing(curve: Curve, points: Points, k: int, limit: float) -> float:
    """Place at which a curve crosses a limit between its points k and k + 1, which lie on different sides."""
    points = Points(points.beta[k : k + 2], points.size[k : k + 2])
    for _ in range(_STEPS):
        k = int(changes(points, limit)[0])
        a, b = points.beta[k], points.beta[k + 1]
        gaps = points.size[k : k + 2] - limit
        if b - a <= _NARROW * b or not gaps.all():
            break
        share = gaps[0] / (gaps[0] - gaps[1]) if np.isfinite(gaps).all() else 0.5
        aside = _ASIDE * (b - a)
        centre = a + share * (b - a)
        found = np.unique(np.clip([centre - aside, centre, centre + aside, 0.5 * (a + b)], a, b))
        places = found[~np.isin(found, points.beta)]
        if not places.size:
            break
        points = Points(points.beta[k : k + 2], points.size[k : k + 2]).with_more(places, curve(places))
    gaps = np.abs(points.size - limit)
    return float(points.beta[np.argmin(gaps)])


def plateau_begin(curve: Curve, points: Points, k: int, alike: float) -> float:
    """Least beta from which a curve is as low as at its k-th point, to the relative difference `alike`."""
    limit = max(
        points.size[k] * (1.0 + alike), _LEAST
    )  # a plateau of zeros begins where the last motion ends
    higher = np.flatnonzero(points.size[:k] > limit)
    if not higher.size:
        return float(points.beta[0])
    return crossing(curve, points, int(higher[-1]), limit)


def alike(values: Sequence[float] | np.ndarray, tolerance: float) -> bool:
    """Whether values agree to a relative difference."""
    array = np.asarray(values)
    return bool(np.ptp(array) <= tolerance * np.abs(array).max())

"""The friction with the smallest peak response over a band, also where the friction is uncertain."""

from typing import NamedTuple

import numpy as np

from ..datasets.amounts import DIGITS, Amounts
from ..errors import InputError, NoSteadyState
from .extremes import Brackets, brackets_of, refine_maxima
from .limits import starts_matter
from .minimum import Curve, Points, alike, local_minima, lowest, lowest_of, plateau_begin
from .performance import Peaks, PerformanceCurve, Unclear
from .task import Task

#: Local minima of the samples that are refined: those below this multiple of the lowest one.
_PROMISING = 2.0

#: Kind of an optimum at or above which nothing moves.
THRESHOLD = "threshold"

#: Values of the curve that count as one: of a plateau, of two peaks at the optimum.
_PLATEAU, TWO_PEAKS = 1e-9, 1e-8

#: A peak over the whole band above those that were followed by more than this was missed before.
_MISSED = 1e-10

#: The curve is also computed at these multiples of the answer, for pictures and for crossings.
_AROUND = np.linspace(0.5, 1.5, 21)

#: A point that is off the line between its neighbours by more than this share of the answer is seen as a
#: corner in a picture.  Intervals are halved there, in this number of rounds at most, down to this share of
#: the answer's friction, and between these multiples of the answer.
_CORNER, _SMOOTHED, _FINEST, _SEEN = 0.01, 3, 0.01, (0.2, 3.0)

#: Rounds in which peaks that were missed are added.
_AGAIN = 5

#: Whether anything moves where everything holds, and whether nothing does with less friction already, is
#: looked at with these multiples of the friction that holds.  Motion grows with the square of the
#: friction removed: this much less leaves 1e-10, which is above rounding.
_ABOVE, _BELOW = 1.01, 1.0 - 1e-5

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
    worst: Points | None = None  # of the worst response within a spread


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
    if not points.size.any() and task.low >= curve.stuck.beta > 0.0:
        raise InputError(
            "beta",
            f"must begin below {task.amounts.friction(curve.stuck.beta, digits=DIGITS)}, at or above which "
            f"the {task.response_in_words} is 0 over the whole band; got {task.amounts.friction(task.low)}",
        )
    if not points.size.any():
        raise InputError(
            f"cannot minimise the {task.response_in_words}: it is 0 over the whole band, whatever the "
            f"friction; choose another response or another band"
        )
    return points


def _kind(points: Points, best: int, peaks: Peaks) -> str:
    """Kind of the minimum at the point `best` of a refined curve."""
    if peaks.size.size > 1 and alike(peaks.size[:2], TWO_PEAKS):
        return "two equal peaks"
    return "at the bound" if best in (0, points.beta.size - 1) else "smooth"


def bracket(points: Points, k: int) -> tuple[float, float]:
    """Places of the neighbours of a point."""
    return float(points.beta[max(k - 1, 0)]), float(points.beta[min(k + 1, points.beta.size - 1)])


def _refined(curve: PerformanceCurve, values: Curve, points: Points, k: int) -> tuple[Minimum, Peaks]:
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
    plateau = _plateau(values, refined, k, high)
    if plateau is not None:
        (peaks,) = curve.whole(np.array([plateau]), all_peaks=True)
        if peaks.largest == 0.0:
            return Minimum(plateau, 0.0, THRESHOLD), _at_rest(plateau)
        return Minimum(plateau, peaks.largest, "plateau"), peaks
    minimum = Minimum(float(refined.beta[k]), peaks.largest, _kind(refined, k, peaks))
    return minimum, peaks


def _plateau(values: Curve, points: Points, k: int, high: float) -> float | None:
    """Where the plateau begins that reaches from the lowest point k up to `high`; None without one."""
    if k + 1 < points.beta.size and alike(points.size[[k, _index(points, high)]], _PLATEAU):
        return plateau_begin(values, points, k, _PLATEAU)
    return None


def _index(points: Points, beta: float) -> int:
    """Index of a known place."""
    return int(np.searchsorted(points.beta, beta))


def _refuse_unknown(task: Task, curve: PerformanceCurve, best: Minimum, low: float, high: float) -> None:
    """Refuse an optimum with a cell that may be above its peak, or next to friction that may be better.

    Cells that are not known at friction ratios next to it are looked at with the friction of the optimum.
    """
    near = {beta: cells for beta, cells in curve.unknown.items() if low <= beta <= high}
    curve.look_at(best.beta, np.array([cells.r for cells in near.values()]), best.size)
    own = {best.beta: curve.unknown[best.beta]} if best.beta in curve.unknown else {}
    better = {beta: cells for beta, cells in near.items() if cells.peak < best.size}
    for beta, cells in (own | better).items():
        _refuse(task.amounts, beta, cells, best)


def _refuse(words: Amounts, beta: float, cells: Unclear, best: Minimum) -> None:
    raise NoSteadyState(
        f"cannot answer: {describe_cells(words, beta, cells)}, next to the optimum with the peak "
        f"{words.response(best.size, digits=DIGITS)}; narrow the band or the range of beta, or add damping"
    )


def describe_cells(words: Amounts, beta: float, cells: Unclear) -> str:
    """Cells at a friction ratio without a periodic steady state, in words."""
    counted = "1 cell of the band has" if cells.number == 1 else f"{cells.number} cells of the band have"
    found = f"{counted} no periodic steady state at {words.friction(beta, digits=DIGITS)}"
    at = words.frequency(cells.r, digits=DIGITS)
    if np.isnan(cells.seen):
        return f"{found} ({at})"
    return f"{found} ({at}: largest response seen {words.response(cells.seen, digits=DIGITS)})"


def irregular_cells(words: Amounts, curve: PerformanceCurve, beta: float) -> str:
    """The irregular cells next to a friction ratio that were left out, in words; empty without any."""
    if not curve.harmless:
        return ""
    nearest = min(curve.harmless, key=lambda known: abs(known - beta))
    count = len(curve.harmless) - 1
    others = f", as are those at {count} other friction ratios" if count else ""
    cells = describe_cells(words, nearest, curve.harmless[nearest])
    return f"{cells}: far below the peak, left out{others}"


def _threshold(task: Task, curve: PerformanceCurve, share: float = 1.0) -> tuple[Minimum, Peaks] | None:
    """The friction from which the response is 0 over the whole band, over a share of it; None without one."""
    beta = curve.stuck.beta / share
    if not task.low < beta <= task.high:
        return None
    below, held = curve.whole(curve.stuck.beta * np.array([_BELOW, _ABOVE]))
    at_rest_before = below.largest == 0.0 and not starts_matter(task.system, task.mu)
    if held.largest > 0.0 or at_rest_before:
        return None
    return Minimum(beta, 0.0, THRESHOLD), _at_rest(beta, curve.stuck.r)


def _at_rest(beta: float, r: float = np.nan) -> Peaks:
    """A peak of size 0 in place of none; r, the frequency that decides, if it is known."""
    return Peaks(beta, np.array([r]), np.zeros(1))


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

    threshold = _threshold(task, curve)
    if threshold is not None:
        return _optimum(curve, points, *threshold)
    promising = [k for k in local_minima(points) if points.size[k] <= _PROMISING * points.size.min()]
    found = [(*_refined(curve, values, points, k), bracket(points, k)) for k in promising]
    found.sort(key=lambda one: one[0].size)
    best, peaks, around = found[0]
    _refuse_unknown(task, curve, best, *around)
    others = [one for one, _, _ in found[1:] if one.size <= _SECOND * best.size]
    return _optimum(curve, points, best, peaks, others[0] if others else None)


def _optimum(
    curve: PerformanceCurve, points: Points, best: Minimum, peaks: Peaks, second: Minimum | None = None
) -> Optimum:
    """The optimum, with the curve around it."""
    around = best.beta * _AROUND
    curve.at(around[(around >= points.beta[0]) & (around <= points.beta[-1])])

    def values(beta: np.ndarray) -> np.ndarray:
        return largest(curve.at(beta))

    smooth(values, _table(curve), best)
    return Optimum(best, peaks, second, _table(curve))


def _table(curve: PerformanceCurve) -> Points:
    return Points(np.array([one.beta for one in curve.table]), largest(curve.table))


def smooth(values: Curve, points: Points, best: Minimum) -> Points:
    """Points of a curve, with more where lines between them would be seen as corners in a picture."""
    for _ in range(_SMOOTHED):
        x, y = points
        with np.errstate(invalid="ignore"):
            chord = y[:-2] + (y[2:] - y[:-2]) * (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
            bent = np.abs(y[1:-1] - chord) > _CORNER * best.size
        seen = (x[1:-1] >= _SEEN[0] * best.beta) & (x[1:-1] <= _SEEN[1] * best.beta) & np.isfinite(y[:-2])
        k = np.flatnonzero(bent & seen & (y[1:-1] <= _SEEN[1] * best.size))
        k = np.union1d(k, k + 1)
        k = k[x[k + 1] - x[k] > _FINEST * best.beta]
        if not k.size:
            break
        middle = 0.5 * (x[k] + x[k + 1])
        points = points.with_more(middle, values(middle))
    return points


def _inner_maxima(curve: PerformanceCurve, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Places and values of the local maxima of a performance curve, without its ends."""
    found = brackets_of(points.beta, np.where(np.isinf(points.size), np.finfo(float).max, points.size))
    inside = (found.a < found.m) & (found.m < found.b)
    chosen = Brackets(*(array[inside] for array in found))

    def values(_: np.ndarray, beta: np.ndarray) -> np.ndarray:
        places, back = np.unique(beta, return_inverse=True)
        return largest(curve.at(places))[back]

    return refine_maxima(values, chosen) if chosen.m.size else (np.empty(0), np.empty(0))


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

    def inside(beta: np.ndarray) -> np.ndarray:
        return beta[(beta * (1.0 - spread) >= task.low) & (beta * (1.0 + spread) <= task.high)]

    beta = inside(points.beta)
    if beta.size < 3:
        raise InputError("spread", f"must leave a range of friction to search; got {spread:g}")
    robust = Points(beta, worst(beta))

    def with_worst(found: Optimum) -> Optimum:
        best, around = found.best, inside(found.best.beta * _AROUND)
        shown = robust.with_more(around, worst(around)) if around.size else robust
        shown = smooth(worst, shown.with_more(np.array([best.beta]), np.array([best.size])), best)
        return found._replace(worst=shown)

    threshold = _threshold(task, curve, 1.0 - spread)
    if threshold is not None:
        return with_worst(_optimum(curve, points, *threshold))
    best = min((_refined_robust(worst, robust, k) for k in local_minima(robust)), key=lambda one: one.size)
    for level, cells in curve.unknown.items():
        if best.beta * (1.0 - spread) <= level <= best.beta * (1.0 + spread):
            _refuse(task.amounts, level, cells, best)
    if best.kind == THRESHOLD:
        return with_worst(_optimum(curve, points, best, _at_rest(best.beta)))
    ends = curve.whole(best.beta * np.array([1.0 - spread, 1.0 + spread]), all_peaks=True)
    return with_worst(_optimum(curve, points, best, max(ends, key=lambda one: one.largest)))


def _refined_robust(worst: Curve, robust: Points, k: int) -> Minimum:
    """The local minimum next to point k of the worst response within a spread."""
    low, high = bracket(robust, k)
    refined = lowest(worst, robust, low, high)
    k = lowest_of(refined, low, high)
    plateau = _plateau(worst, refined, k, high)
    if plateau is not None:
        size = float(refined.size[k])
        return Minimum(plateau, size, "plateau" if size > 0.0 else THRESHOLD)
    kind = "at the bound" if k in (0, refined.beta.size - 1) else "smooth"
    return Minimum(float(refined.beta[k]), float(refined.size[k]), kind)

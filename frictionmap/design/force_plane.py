"""The least peak in the plane of two friction forces: the friction of all contacts, and the ratio of one."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from .. import checks
from ..errors import InputError
from ..model.contact import Contact
from ..model.system import System
from .minimum import Points, local_minima, lowest
from .optimum import Optimum, bracket, find_optimum, largest
from .performance import PerformanceCurve
from .task import SEARCHED, Task

#: Ratios that are looked at first, and friction ratios for each of them.
_RATIOS, _LADDER = 9, 16

#: Friction ratios around the optimum of a neighbour, as multiples of it.
_NEAR = np.geomspace(0.6, 1.7, 9)

#: The ratio is known to this share of its range.
_PLACE = 1e-4


class Plane(NamedTuple):
    """The ratio of one contact that is free, and its range."""

    contact: int  # counted from 1
    low: float
    high: float


class Ridge(NamedTuple):
    """The least peak of every ratio that was looked at, by increasing ratio."""

    ratio: np.ndarray
    beta: np.ndarray
    peak: np.ndarray


def checked_plane(system: System, second: Any, ratio: Any) -> Plane:
    """Check which contact has a ratio that is free, and its range.

    Raises
    ------
    InputError
        There is no such contact, or it cannot have a ratio; the range is not two increasing numbers >= 0.
    """
    if system.contacts is None:
        raise InputError("cannot vary two forces: the system has no list of contacts; give contacts")
    number = checks.whole(second, "second", least=1, most=len(system.contacts))
    one = _contact(system, number)
    if one.force is not None or not isinstance(one.ratio, float):
        raise InputError(
            f"cannot vary the ratio of contact {number}: it has a force of its own or is a bank; "
            f"give it one ratio"
        )
    ends = checks.axis(ratio, "ratio", least=0.0)
    if ends.size != 2:
        raise InputError("ratio", f"must be two numbers; got {ends.size}")
    return Plane(number, float(ends[0]), float(ends[1]))


def _contact(system: System, number: int) -> Contact:
    assert system.contacts is not None
    one = system.contacts[number - 1]
    assert isinstance(one, Contact)
    return one


def with_ratio(task: Task, plane: Plane, ratio: float) -> Task:
    """The task of the system with another ratio of the contact."""
    assert task.system.contacts is not None
    contacts = list(task.system.contacts)
    contacts[plane.contact - 1] = replace(_contact(task.system, plane.contact), ratio=ratio)
    return replace(task, system=replace(task.system, contacts=contacts))


class _Search:
    """The least peak as a function of the ratio; it keeps what it has found."""

    def __init__(self, task: Task, plane: Plane) -> None:
        self._task, self._plane = task, plane
        self._found: dict[float, tuple[float, float]] = {}  # beta and peak by ratio

    @property
    def ridge(self) -> Ridge:
        """Everything that was found."""
        ratios = sorted(self._found)
        beta, peak = np.array([self._found[ratio] for ratio in ratios]).T
        return Ridge(np.array(ratios), beta, peak)

    def whole(self, ratio: float) -> float:
        """The least peak at a ratio, over the whole range of friction."""
        task = with_ratio(self._task, self._plane, ratio)
        some = task.searched()[:: SEARCHED // _LADDER]
        return self._least(ratio, task, np.append(some, task.high))

    def near(self, ratio: float) -> float:
        """The least peak at a ratio, near the best friction of the nearest known ratio."""
        nearest = min(self._found, key=lambda known: abs(known - ratio))
        task = with_ratio(self._task, self._plane, ratio)
        beta = self._found[nearest][0] * _NEAR
        inside = (beta >= task.low) & (beta <= task.high)
        return self._least(ratio, task, beta[inside])

    def _least(self, ratio: float, task: Task, ladder: np.ndarray) -> float:
        curve = task.performance()
        beta, peak = _minimum(curve, np.unique(ladder))
        self._found[ratio] = beta, peak
        return peak


def _minimum(curve: PerformanceCurve, ladder: np.ndarray) -> tuple[float, float]:
    """Place and value of the lowest local minimum of a curve over a ladder of friction ratios."""
    points = Points(ladder, largest(curve.whole(ladder)))
    if not np.isfinite(points.size).any():  # no friction at which all cells of the band have a steady state
        return float(ladder[0]), np.inf

    def values(beta: np.ndarray) -> np.ndarray:
        return largest(curve.at(beta))

    best = min(local_minima(points), key=lambda k: points.size[k])
    refined = lowest(values, points, *bracket(points, best))
    k = int(np.argmin(refined.size))
    return float(refined.beta[k]), float(refined.size[k])


def find_in_plane(task: Task, plane: Plane) -> tuple[Task, PerformanceCurve, Optimum, Ridge]:
    """Find the ratio and the friction with the least largest response over a band.

    Returns
    -------
    The task with that ratio, its performance curve and optimum, and the least peak over the ratio.

    Raises
    ------
    NoSteadyState
        A cell of the band next to the optimum has no periodic steady state.
    """
    search = _Search(task, plane)
    first = np.linspace(plane.low, plane.high, _RATIOS)
    sizes = [search.whole(ratio) for ratio in first.tolist()]
    k = int(np.argmin(sizes))
    low, high = first[max(k - 1, 0)], first[min(k + 1, _RATIOS - 1)]
    minimize_scalar(
        lambda ratio: search.near(float(ratio)),
        bounds=(low, high),
        method="bounded",
        options={"xatol": _PLACE * (plane.high - plane.low)},
    )
    ridge = search.ridge
    best = with_ratio(task, plane, float(ridge.ratio[np.argmin(ridge.peak)]))
    curve = best.performance()
    return best, curve, find_optimum(best, curve), ridge

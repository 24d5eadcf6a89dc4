"""The frequency next to a working point at which a boundary is at its friction ratio."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from .. import checks
from ..model.system import System
from ..solvers.choose import engine_of
from .band import Band
from .extremes import brackets_of, chosen, joined, refine_maxima
from .limits import (
    is_joint,
    may_reach,
    needed_friction,
    no_stop_limit,
    no_stop_samples,
    stick_limit,
    stick_samples,
)
from .minimum import Points, changes, crossing

#: A boundary is looked for within these distances from the working point, over its r, one after the other,
#: down to this share of r.
_DISTANCES, _LOWEST = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.5, 9.0), 0.1

#: Functions of frequencies (n_r,), (n_r, k).
Functions = Callable[[np.ndarray], np.ndarray]


class Limit(NamedTuple):
    """A boundary over frequency: where the largest of k functions is 0."""

    above: Functions
    samples: Callable[[Band], np.ndarray]
    least: float  # frequency down to which it is known


def stick_at(system: System, beta: float, mu: float) -> Limit:
    """The boundary beta_stick = beta: where a contact needs the friction that it has."""
    if is_joint(system):
        return Limit(
            lambda r: (stick_limit(system, r, mu) - beta)[:, np.newaxis],
            partial(stick_samples, system),
            engine_of(system).least_ratio,
        )
    levels = [group.friction(beta, mu)[1] for group in system.contact_system.groups]
    return Limit(
        lambda r: needed_friction(system, r) - np.array(levels),
        partial(stick_samples, system),
        engine_of(system).least_stick_ratio,
    )


def no_stop_at(system: System, beta: float, mu: float) -> Limit:
    """The boundary beta_lim = beta."""

    def above(r: np.ndarray) -> np.ndarray:
        return (no_stop_limit(system, r, mu) - beta)[:, np.newaxis]

    return Limit(above, partial(no_stop_samples, system), engine_of(system).least_ratio)


def around(limit: Limit, r: float) -> Band:
    """The frequencies in which a boundary next to r is looked for."""
    low = min(r, max(_LOWEST * r, limit.least))
    return Band(low, min(r * (1.0 + _DISTANCES[-1]), checks.LARGEST_RATIO))


class _Samples(NamedTuple):
    """Values (n_r, k) of the functions of a limit at increasing r (n_r,)."""

    r: np.ndarray
    values: np.ndarray

    def with_more(self, above: Functions, r: np.ndarray) -> "_Samples":
        """These and further ones."""
        new = np.setdiff1d(r, self.r)
        if not new.size:
            return self
        places, values = np.concatenate((self.r, new)), np.concatenate((self.values, above(new)))
        order = np.argsort(places)
        return _Samples(places[order], values[order])


def _with_extremes(above: Functions, samples: _Samples) -> _Samples:
    """Samples and the places between them at which a function may touch 0: maxima of one below 0, and minima
    of the largest above 0.
    """

    def columns(values: np.ndarray) -> np.ndarray:
        return np.column_stack((values, -values.max(axis=1)))

    parts = []
    for column in columns(samples.values).T:
        found = may_reach(brackets_of(samples.r, column), 0.0)
        between = (found.a < found.m) & (found.m < found.b)  # of an end, the next one is not known
        parts.append(chosen(found, np.flatnonzero((found.at_m < 0.0) & between)))
    function = np.repeat(np.arange(len(parts)), [one.m.size for one in parts])
    if not function.size:
        return samples

    def of(which: np.ndarray, r: np.ndarray) -> np.ndarray:
        return columns(above(r))[np.arange(r.size), function[which]]

    return samples.with_more(above, refine_maxima(of, joined(parts))[0])


def nearest(limit: Limit, r: float) -> float:
    """The frequency next to r, within a factor of ten, on a boundary; NaN without one."""

    def largest(r: np.ndarray) -> np.ndarray:
        return limit.above(r).max(axis=1)

    places = limit.samples(around(limit, r))
    own = np.array([r])
    samples = _Samples(own, limit.above(own))
    for distance in _DISTANCES:
        first = np.searchsorted(places, r - distance * r, side="right") - 1
        last = np.searchsorted(places, r + distance * r)
        samples = samples.with_more(limit.above, places[max(first, 0) : last + 1])
        samples = _with_extremes(limit.above, samples)
        points = Points(samples.r, samples.values.max(axis=1))
        found = changes(points, 0.0)
        beside = [*found[points.beta[found] < r][-1:], *found[points.beta[found] >= r][:1]]
        roots = [crossing(largest, points, int(k), 0.0) for k in beside]
        best = min(roots, key=lambda root: abs(root - r), default=np.nan)
        if abs(best - r) <= distance * r:
            return best
    return float(best)

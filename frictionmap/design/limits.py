"""Boundaries over a band: their least and largest values, and where they are at a friction ratio."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from ..general.boundaries import find_boundaries
from ..general.held import least_static_friction, rest_scales, stick_scales
from ..general.problem import least_ratio as least_general_ratio
from ..model.system import System
from ..theory.boundary_curves import find_curves, least_ratio
from .band import Band
from .extremes import Brackets, brackets_of, chosen, joined, sharpened
from .grading import FINE, FOLLOWED, graded, no_stop_poles, stick_poles
from .minimum import Points, changes, crossing
from .watching import current_watch, look

#: A maximum that falls to less than half within this relative distance is a pole: no damping is so small.
_POLE = 1e-9

#: beta_lim below this share of its largest value is 0: the frequency of a pole without damping is rounded.
_LOST = 4.0 * float(np.finfo(float).eps)

#: A local extremum of samples may be above its sample by so many times the step to its lower neighbour: an
#: eighth of it if the curve is smooth, one of it at a kink between two lines, 1.4 at the square root beside a
#: pole without damping.
_RISE = 2.0

#: A boundary next to a working point is looked for within these distances from it, over its r, one after the
#: other, down to this share of r.
_DISTANCES, _LOWEST = (0.02, 0.1, 0.4, 1.6, 9.0), 0.1

#: Functions of frequencies (n_r,), (n_r, k).
Functions = Callable[[np.ndarray], np.ndarray]


class Limit(NamedTuple):
    """A boundary over frequency as the largest of k functions over their value at the working point: 0."""

    above: Functions
    samples: Callable[[Band], np.ndarray]


class Extreme(NamedTuple):
    """The least or largest value of a boundary over a band, and the frequency at which it is."""

    beta: float
    r: float


def stick_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies that show all of a boundary to sticking over a band."""
    return graded(band, stick_poles(system), FINE)


def no_stop_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies that show all of beta_lim over a band."""
    return graded(band, no_stop_poles(system, band.low), FINE if system.general is None else FOLLOWED)


def boundary_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies that show all boundaries of a system over a band."""
    if not has_no_stop_limit(system):
        return stick_samples(system, band)
    poles = np.concatenate((no_stop_poles(system, band.low), stick_poles(system)))
    return graded(band, poles, FINE if system.general is None else FOLLOWED)


def _needed(system: System, r: np.ndarray) -> np.ndarray:
    """Friction with which each contact holds, over P, (n_r, N): half the range of its force."""
    look()
    if system.general is None:
        return find_curves(system, r, np.array([1.0])).beta_stick[0][:, np.newaxis]
    return least_static_friction(system, r)


def _scales(system: System, needed: np.ndarray, mu: float | None) -> np.ndarray:
    """Friction ratio at which each contact has the friction it needs, (n_r, N); mu as in `stick_limit`."""
    if system.general is None:
        return needed / (1.0 if mu is None else mu)
    if mu is None:
        return rest_scales(system.general, needed)
    return stick_scales(system.general, needed, np.array([mu]))[0]


def stick_limit(system: System, r: np.ndarray, mu: float | None) -> np.ndarray:
    """Friction ratio from which all contacts hold, (n_r,): beta_stick, or beta_noslip of elastic contacts.

    With static friction, of ratio mu, contacts that are at rest stay so.  With mu None kinetic friction
    alone is enough: every motion comes to rest (theory.md 6).
    """
    return _scales(system, _needed(system, r), mu).max(axis=1)


def no_stop_limit(system: System, r: np.ndarray, mu: float) -> np.ndarray:
    """Friction ratio up to which a motion without stops exists, (n_r,): beta_lim.

    Raises
    ------
    InputError
        All contacts are elastic: they have no such limit.
    """
    look()
    if system.general is None:
        return find_curves(system, r, np.array([mu])).beta_lim[0]
    if system.general.elastic.any():
        raise InputError(
            "cannot find friction without stops with contact_stiffness: a spring in the contact has no such "
            "limit; use question stuck"
        )
    return find_boundaries(system, r, np.array([mu]), watch=current_watch(), intervals=1).beta_lim[0]


def has_no_stop_limit(system: System) -> bool:
    """Whether `no_stop_limit` exists."""
    return system.general is None or not system.general.elastic.any()


def starts_matter(system: System, mu: float) -> bool:
    """Whether a cell may have several steady states: static friction exceeds kinetic friction somewhere."""
    if system.general is None:
        return mu > 1.0
    pairs = [group.friction(1.0, mu) for group in system.general.groups]
    return any(static > kinetic for kinetic, static in pairs)


def _may_reach(bracket: Brackets, level: float) -> Brackets:
    """The maxima that may be at a level or above it, see `_RISE`."""
    with np.errstate(invalid="ignore"):  # infinite less infinite: it is above every level
        rise = bracket.at_m - np.minimum(bracket.at_a, bracket.at_b)
        below = bracket.at_m + _RISE * rise < level
    return chosen(bracket, np.flatnonzero(~below))


def least_no_stop(system: System, band: Band, mu: float) -> tuple[Extreme, Points]:
    """The least beta_lim over a band, and the samples of it."""

    def negative(_: np.ndarray, r: np.ndarray) -> np.ndarray:
        return -no_stop_limit(system, r, mu)

    r = no_stop_samples(system, band)
    points = Points(r, no_stop_limit(system, r, mu))
    dips = brackets_of(r, -points.size)
    order = np.argsort(-dips.at_m, kind="stable")
    place, value = sharpened(negative, chosen(dips, order[:1]))
    others = _may_reach(chosen(dips, order[1:]), float(value[0]))
    if others.m.size:
        places, values = sharpened(negative, others)
        place, value = np.append(place, places), np.append(value, values)
    best = int(np.argmax(value))
    beta, most = float(-value[best]), points.size[np.isfinite(points.size)].max(initial=0.0)
    return Extreme(beta if beta > _LOST * most else 0.0, float(place[best])), points


def largest_stick(system: System, band: Band, mu: float | None) -> Extreme:
    """The largest friction ratio of `stick_limit` over a band; infinite at a pole."""
    r = stick_samples(system, band)
    needed = _needed(system, r)
    count = needed.shape[1]
    if np.isinf(needed).any():
        return Extreme(np.inf, float(r[np.argmax(needed.max(axis=1))]))
    peaks = [brackets_of(r, one) for one in needed.T]
    contact = np.repeat(np.arange(count), [one.m.size for one in peaks])

    def of_contacts(which: np.ndarray, r: np.ndarray) -> np.ndarray:
        return _needed(system, r)[np.arange(r.size), contact[which]]

    places, values = sharpened(of_contacts, joined(peaks))
    best = [np.flatnonzero(contact == j)[np.argmax(values[contact == j])] for j in range(count)]
    most, at = values[best], places[best]
    inside = (at > band.low) & (at < band.high)
    for sign in (-1.0, 1.0):
        beside = of_contacts(np.array(best), at * (1.0 + sign * _POLE))
        inside &= beside < 0.5 * most
    scales = _scales(system, np.where(inside, np.inf, most)[np.newaxis], mu)[0]
    j = int(np.argmax(scales))
    return Extreme(float(scales[j]), float(at[j]))


def stick_at(system: System, beta: float, mu: float) -> Limit:
    """The boundary beta_stick = beta: where a contact needs the friction that it has."""
    levels = [beta * mu]
    if system.general is not None:
        levels = [group.friction(beta, mu)[1] for group in system.general.groups]
    return Limit(lambda r: _needed(system, r) - np.array(levels), lambda band: stick_samples(system, band))


def no_stop_at(system: System, beta: float, mu: float) -> Limit:
    """The boundary beta_lim = beta."""
    return Limit(
        lambda r: (no_stop_limit(system, r, mu) - beta)[:, np.newaxis],
        lambda band: no_stop_samples(system, band),
    )


def _around(system: System, r: float) -> Band:
    """The frequencies in which a boundary next to r is looked for."""
    least = least_ratio(system) if system.general is None else least_general_ratio(system)
    return Band(max(_LOWEST * r, min(r, least)), min(r * (1.0 + _DISTANCES[-1]), checks.LARGEST_RATIO))


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
        found = _may_reach(brackets_of(samples.r, column), 0.0)
        between = (found.a < found.m) & (found.m < found.b)  # of an end, the next one is not known
        parts.append(chosen(found, np.flatnonzero((found.at_m < 0.0) & between)))
    function = np.repeat(np.arange(len(parts)), [one.m.size for one in parts])
    if not function.size:
        return samples

    def of(which: np.ndarray, r: np.ndarray) -> np.ndarray:
        return columns(above(r))[np.arange(r.size), function[which]]

    return samples.with_more(above, sharpened(of, joined(parts))[0])


def nearest(limit: Limit, system: System, r: float) -> float:
    """The frequency next to r, within a factor of ten, on a boundary; NaN without one."""

    def largest(r: np.ndarray) -> np.ndarray:
        return limit.above(r).max(axis=1)

    places = limit.samples(_around(system, r))
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

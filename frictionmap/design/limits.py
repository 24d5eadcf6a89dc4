"""Boundaries over a band: their least and largest values, and where they cross a friction ratio."""

from collections.abc import Callable

import numpy as np

from ..errors import InputError
from ..general.boundaries import find_boundaries
from ..general.held import least_static_friction, stick_scales
from ..model.system import System
from ..theory.boundary_curves import find_curves
from .band import Band, limit_samples
from .extremes import brackets_of, sharpened
from .minimum import Points, changes, crossing
from .watching import current_watch, look

#: A boundary of a system at frequencies (n_r,) for one mu.
Limit = Callable[[System, np.ndarray, float], np.ndarray]

#: Samples of beta_lim over a band where each is found by following motions.
_FOLLOWED_SAMPLES = 60

#: A maximum that falls to less than half within this relative distance is a pole: no damping is so small.
_POLE = 1e-9

#: The crossings next to a working point are looked for from this part of its frequency to the multiple.
_REACH = 10.0


def stick_limit(system: System, r: np.ndarray, mu: float) -> np.ndarray:
    """Friction ratio from which all contacts hold, (n_r,): beta_stick, or beta_noslip of elastic contacts."""
    look()
    if system.general is None:
        return find_curves(system, r, np.array([mu])).beta_stick[0]
    needed = least_static_friction(system, r)
    return stick_scales(system.general, needed, np.array([mu])).max(axis=2)[0]


def no_stop_limit(system: System, r: np.ndarray, mu: float) -> np.ndarray:
    """Friction ratio up to which no contact stops, (n_r,): beta_lim.

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


def boundary_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies at which beta_lim is sampled: closed forms cost little."""
    if system.general is None:
        return limit_samples(system, band)
    return band.samples(_FOLLOWED_SAMPLES, np.empty(0))


def least_no_stop(system: System, band: Band, mu: float) -> tuple[float, float]:
    """The most friction without a stop anywhere in a band, and the frequency that decides."""
    r = boundary_samples(system, band)
    bracket = brackets_of(r, -no_stop_limit(system, r, mu))
    low = bracket.at_m >= 2.0 * bracket.at_m.max()  # values are negative: other dips are far above
    bracket = type(bracket)(*(array[low] for array in bracket))
    together = np.zeros(bracket.m.size, int)  # the lowest of all is wanted
    places, values = sharpened(lambda _, x: -no_stop_limit(system, x, mu), bracket, together)
    best = int(np.argmax(values))
    return float(-values[best]), float(places[best])


def largest_stick(system: System, band: Band, mu: float) -> tuple[float, float]:
    """The least friction that holds over a band, and the frequency that decides; infinite at a pole."""
    r = limit_samples(system, band)
    values = stick_limit(system, r, mu)
    if np.isinf(values).any():
        return np.inf, float(r[np.argmax(values)])
    bracket = brackets_of(r, values)
    places, values = sharpened(lambda _, x: stick_limit(system, x, mu), bracket)
    best = int(np.argmax(values))
    place, value = float(places[best]), float(values[best])
    if band.low < place < band.high:
        beside = stick_limit(system, place * np.array([1.0 - _POLE, 1.0 + _POLE]), mu)
        if beside.max() < 0.5 * value:
            return np.inf, place
    return value, place


def nearest_crossing(limit: Limit, system: System, r: float, beta: float, mu: float) -> float:
    """The frequency next to r, within a factor of ten, at which a boundary is beta; NaN without one."""
    reach = Band(r / _REACH, r * _REACH)
    samples = np.union1d(boundary_samples(system, reach), [r])

    def boundary(x: np.ndarray) -> np.ndarray:
        return limit(system, x, mu)

    points = Points(samples, boundary(samples))
    found = changes(points, beta)
    beside = [*found[samples[found] < r][-1:], *found[samples[found] >= r][:1]]
    places = [crossing(boundary, points, int(k), beta) for k in beside]
    return min(places, key=lambda place: abs(place - r), default=np.nan)

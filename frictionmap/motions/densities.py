"""Spectral densities of random loads: one-sided, over the frequency in Hz or over omega_1.

The variance of a stationary record is the integral of its density over all frequencies above 0.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from .quantities import frequency_in, number_in

#: Length in Davenport's spectrum [m].
_DAVENPORT = 1200.0

#: A density of frequencies > 0.
Density = Callable[[np.ndarray], np.ndarray]


class Kind(NamedTuple):
    """A kind of spectrum."""

    keys: tuple[str, ...]  # what it needs
    make: Callable[[Mapping[str, Any], str | None], Density]


def _white(_given: Mapping[str, Any], _unit: str | None) -> Density:
    return np.ones_like


def _ground(given: Mapping[str, Any], unit: str | None) -> Density:
    """White noise of the bedrock, as a layer of soil with one mode passes it on."""
    frequency = frequency_in(given["frequency"], "frequency", unit)
    damping = checks.number(given["damping"], "damping", above=0.0)

    def density(f: np.ndarray) -> np.ndarray:
        q2, passed = (f / frequency) ** 2, (2.0 * damping * f / frequency) ** 2
        return (1.0 + passed) / ((1.0 - q2) ** 2 + passed)

    return density


def _filtered_ground(given: Mapping[str, Any], unit: str | None) -> Density:
    """The same without its lowest frequencies, whose displacements would grow without bound."""
    frequency = frequency_in(given["filter_frequency"], "filter_frequency", unit)
    damping = checks.number(given["filter_damping"], "filter_damping", above=0.0)
    ground = _ground(given, unit)

    def density(f: np.ndarray) -> np.ndarray:
        p2 = (f / frequency) ** 2
        return ground(f) * p2**2 / ((1.0 - p2) ** 2 + (2.0 * damping) ** 2 * p2)

    return density


def _wind(given: Mapping[str, Any], unit: str | None) -> Density:
    if unit is None:
        raise InputError(
            "unit", "must be given for kind davenport, whose frequencies are in Hz; got None, such as 'N'"
        )
    speed = number_in(given["wind_speed"], "wind_speed", "velocity", "m/s", above=0.0)

    def density(f: np.ndarray) -> np.ndarray:
        x = _DAVENPORT * f / speed
        return 4.0 * x * (_DAVENPORT / speed) / (1.0 + x * x) ** (4.0 / 3.0)

    return density


def _table(given: Mapping[str, Any], unit: str | None) -> Density:
    frequency, density = (checks.array(given[key], key) for key in ("frequency", "density"))
    places = np.array([frequency_in(one, "frequency", unit, above=-1.0) for one in np.ravel(frequency)])
    heights = np.array([checks.number(one, "density", least=0.0) for one in np.ravel(density)])
    places = checks.axis(places, "frequency", least=0.0)
    if heights.size != places.size or places.size < 2:
        raise InputError(
            "density",
            f"must have as many values as frequency, two or more; got {heights.size} and {places.size}",
        )
    return lambda f: np.interp(f, places, heights, left=0.0, right=0.0)


KINDS = {
    "white": Kind((), _white),
    "kanai-tajimi": Kind(("frequency", "damping"), _ground),
    "clough-penzien": Kind(("frequency", "damping", "filter_frequency", "filter_damping"), _filtered_ground),
    "davenport": Kind(("wind_speed",), _wind),
    "table": Kind(("frequency", "density"), _table),
}

#: Keys of all kinds.
KEYS = tuple(dict.fromkeys(key for kind in KINDS.values() for key in kind.keys))


def density_of(kind: str, given: Mapping[str, Any], unit: str | None) -> Density:
    """The density of a kind, times which a level is.

    Raises
    ------
    InputError
        The kind or a key is unknown, a key is missing, or a value is out of range.
    """
    needed = KINDS[checks.choice(kind, "kind", tuple(KINDS))]
    for key in given:
        if key not in needed.keys:
            valid = ", ".join(needed.keys) or "none"
            raise InputError(
                f"unknown key {key!r} of kind {kind}{checks.nearest(key, needed.keys)}; valid: {valid}"
            )
    for key in needed.keys:
        if key not in given:
            raise InputError(key, f"must be given for kind {kind}; got nothing")
    return needed.make(given, unit)

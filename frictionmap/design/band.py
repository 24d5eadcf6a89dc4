"""The frequency band of a design, and the frequencies at which a curve over it is sampled."""

from collections.abc import Iterator
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.held_structure import frequencies_of_phases, frequencies_with_held
from ..model.system import System
from ..units.axes import KINDS, ratios
from ..units.scales import Scales

#: Samples over a band to find peaks, spaced in proportion.
PEAK_SAMPLES = 240

#: Places of further samples around a natural frequency, in units of zeta times the frequency.
_AROUND = np.array([-4.0, -2.0, -1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0, 2.0, 4.0])

#: For this the damping ratio stands in where there is none.
_LEAST_ZETA = 1e-3

#: Largest number of contacts of which every combination is tried.
_ALL_PATTERNS = 3


class Band(NamedTuple):
    """A range of frequency ratios."""

    low: float
    high: float

    def samples(self, count: int, further: np.ndarray) -> np.ndarray:
        """Increasing frequencies from end to end: `count` in proportion, and further ones inside."""
        inside = further[(further > self.low) & (further < self.high)]
        even = np.geomspace(self.low, self.high, count)
        even[[0, -1]] = self.low, self.high
        return np.union1d(even, inside)


def checked_band(band: Any, scales: Scales) -> Band:
    """Check a band: two frequencies r1 < r2 above 0, which may have units."""
    given = ratios(band, "band", KINDS["r"], scales)
    _refuse_decreasing(band, given)
    ends = checks.axis(given, "band", least=0.0, most=checks.LARGEST_RATIO)
    if ends.size != 2:
        raise InputError("band", f"must be two frequencies; got {ends.size}")
    if ends[0] <= 0.0:
        raise InputError("band", f"must be > 0; got {ends[0]:g}")
    return Band(float(ends[0]), float(ends[1]))


def _refuse_decreasing(band: Any, given: Any) -> None:
    """Refuse a band that begins at its upper end, by the ends that the user wrote."""
    ends = checks.array(given, "band")
    if ends.shape == (2,) and ends.dtype.kind in "iuf" and ends[0] >= ends[1]:
        first, last = (end if isinstance(end, str) else f"{end:g}" for end in band)
        raise InputError("band", f"must be two increasing frequencies; got {first} to {last}")


def _patterns(count: int) -> Iterator[tuple[int, ...]]:
    """Sets of contacts that are held: all sets of few contacts, else none, each alone, and all."""
    sizes = range(count + 1) if count <= _ALL_PATTERNS else (0, 1, count)
    for size in sizes:
        yield from combinations(range(count), size)


def natural_frequencies(system: System) -> np.ndarray:
    """Natural frequency ratios with contacts free and held, in all combinations of few; increasing."""
    if system.contact_system.has_phases:
        return frequencies_of_phases(system)
    patterns = _patterns(system.contact_system.count)
    return np.unique(np.concatenate([frequencies_with_held(system, pattern) for pattern in patterns]))


def _zeta(system: System) -> float:
    return max(float(np.max(system.modes.zeta)), _LEAST_ZETA)


def _clusters(frequencies: np.ndarray, zeta: float) -> np.ndarray:
    """Samples around frequencies, close together where damping is small."""
    places = frequencies[:, np.newaxis] * (1.0 + min(zeta, 0.2) * _AROUND)
    return np.unique(places[places > 0.0])


def peak_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies at which responses are sampled to find their peaks: close together at w/n of a load n."""
    orders = np.array(system.contact_system.orders, dtype=float)
    resonances = (natural_frequencies(system) / orders[:, np.newaxis]).ravel()
    return band.samples(PEAK_SAMPLES, _clusters(resonances, _zeta(system)))

"""The most friction without a stop whatever the start, for mu > 1: motions are followed from many starts.

Below beta_lim a motion without stops exists, and motions near it approach it; but with mu > 1 others may go
on stopping (theory.md 6).  They are looked for at frequencies and friction ratios over the band, each from
some phases of the load, and where they are found at the least friction that is found down to, from more.
No proof says that none is missed.
"""

from typing import NamedTuple

import numpy as np

from .. import checks
from ..general.resting_starts import Places, stops_of
from ..model.general import in_general_form
from ..model.system import System
from .band import Band
from .grading import graded, no_stop_poles
from .limits import Extreme, least_no_stop, starts_matter
from .minimum import Points
from .watching import current_watch

#: Friction ratios of the search: from the least beta_lim of the band down, each this share of the one before.
_LEVELS, _STEP = 18, 0.93

#: Distance of its frequencies over that from the nearest pole; those are left at which beta_lim is more than
#: this multiple of the least one: stops were found down to 0.4 of beta_lim, at zeta = 0.001.
_SHARE, _FAR = 0.5, 4.0

#: Phases of the load of the search, and of the refinement: spread over a turn, and as many close to those
#: that led to stops with a little more friction, where there are fewer the nearer the end is.
_PHASES, _MORE_PHASES = 12, 24

#: Phases at the frequency that decides, in the end.
_ALL_PHASES = 192

#: The end is found to this share of the friction: below, starts that lead to stops are too few to be met.
_CLOSE = 1e-3

#: Of a turn: multiples of it are spread evenly.
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)

#: Number of lowest frequencies that are refined, between their neighbours, and number of rounds.
_LOWEST_OF, _ROUNDS = 3, 4


class _Start(NamedTuple):
    """A start that leads to stops, and the width of the phases around it in which more are looked for."""

    phase: float
    contact: int
    sense: float
    width: float


def _start(places: Places, k: int, width: float) -> _Start:
    """The start of motion k of some."""
    return _Start(float(places.phase[k]), int(places.contact[k]), float(places.sense[k]), width)


class _Found(NamedTuple):
    """Where stops were found: frequency, friction ratio, and the start that led to them."""

    r: float
    beta: float
    start: _Start


class _Search(NamedTuple):
    """A system for the engine that takes any start, and mu."""

    system: System
    mu: float

    def stops(self, places: Places) -> np.ndarray:
        """Whether motions go on stopping, (k,) bool."""
        return stops_of(self.system, places, self.mu, checks.threads(), current_watch()) > 0.0

    def spread(self, r: np.ndarray, beta: np.ndarray, count: int) -> Places:
        """Motions from `count` phases at every point (k,), from each contact.

        From one phase to the next the direction of friction changes; from one point to the next the phases
        move on, so that neighbours complement one another.
        """
        shape = (r.size, self.system.contact_system.count, count)
        point, contact, step = np.indices(shape).reshape(3, -1)
        phase = 2.0 * np.pi * (step + point * _GOLDEN % 1.0) / count
        return Places(r[point], beta[point], phase, contact, 1.0 - 2.0 * (step % 2))

    def any_start(self, r: float, beta: float) -> _Start | None:
        """A start that leads to stops at a point, looked for among many phases."""
        places = self.spread(np.array([r]), np.array([beta]), _ALL_PHASES)
        which = np.flatnonzero(self.stops(places))
        return _start(places, int(which[0]), 2.0 * np.pi / _ALL_PHASES) if which.size else None

    def start(self, r: float, beta: float, near: _Start) -> _Start | None:
        """A start that leads to stops at a point, looked for near one that does so at another point."""
        phase = near.phase + near.width * np.linspace(-1.0, 1.0, _MORE_PHASES)
        ones = np.ones(_MORE_PHASES)
        close = Places(r * ones, beta * ones, phase, near.contact * ones.astype(int), near.sense * ones)
        spread = self.spread(np.array([r]), np.array([beta]), _MORE_PHASES)
        places = Places(*(np.concatenate(pair) for pair in zip(close, spread, strict=True)))
        which = np.flatnonzero(self.stops(places))
        if not which.size:
            return None
        inside = which[which < _MORE_PHASES]
        step = 2.0 * near.width / (_MORE_PHASES - 1) if inside.size else 2.0 * np.pi / _MORE_PHASES
        own = inside if inside.size else which[:1]
        return _start(places, int(own[own.size // 2]), (0.5 * own.size + 1.0) * step)

    def lower(self, r: float, best: _Found) -> _Found:
        """The least friction with stops at a frequency if it is below the best known."""
        start = self.start(r, best.beta, best.start)
        return best if start is None else self.least(_Found(r, best.beta, start))

    def least(self, found: _Found) -> _Found:
        """The least friction with stops below that of a point, at its frequency."""
        low = _STEP * found.beta
        while (start := self.start(found.r, low, found.start)) is not None:
            found, low = _Found(found.r, low, start), _STEP * low
        while found.beta - low > _CLOSE * found.beta:
            middle = 0.5 * (low + found.beta)
            start = self.start(found.r, middle, found.start)
            low, found = (middle, found) if start is None else (low, _Found(found.r, middle, start))
        return found

    def lowest(self, r: np.ndarray, levels: np.ndarray) -> list[_Found]:
        """Stops at frequencies (n_r,) with the least of decreasing friction ratios, the lowest ones first."""
        level, place = np.indices((levels.size, r.size)).reshape(2, -1)
        places = self.spread(r[place], levels[level], _PHASES)
        which = np.flatnonzero(self.stops(places))[::-1]
        _, first = np.unique(places.r[which], return_index=True)
        lowest = which[np.sort(first)].tolist()
        width = 2.0 * np.pi / _PHASES
        return [_Found(float(places.r[k]), float(places.beta[k]), _start(places, k, width)) for k in lowest]


def least_with_stops(system: System, band: Band, mu: float) -> tuple[Extreme, Extreme, Points]:
    """The most friction without a stop over a band: from all starts that were tried, and from some; and the
    samples of the latter, beta_lim.
    """
    some, points = least_no_stop(system, band, mu)
    if not starts_matter(system, mu) or not 0.0 < some.beta < np.inf:
        return some, some, points
    search = _Search(in_general_form(system), mu)
    r = graded(band, no_stop_poles(search.system, band.low), _SHARE)
    r = r[np.interp(r, *points) <= _FAR * some.beta]
    found = search.lowest(r, (1.0 - _CLOSE) * some.beta * _STEP ** np.arange(_LEVELS))
    every = some
    if found:
        best = search.least(found[0])
        for other in found[1:_LOWEST_OF]:
            best = search.lower(other.r, best)
        best = _refined(search, r, best)
        every = Extreme((1.0 - _CLOSE) * best.beta, best.r)
    return _checked(search, every), some, points


def _checked(search: _Search, every: Extreme) -> Extreme:
    """The friction without a stop, less if one of many starts goes on stopping below it where it decides."""
    below = (1.0 - _CLOSE) * every.beta
    while (start := search.any_start(every.r, below)) is not None:
        best = search.least(_Found(every.r, below, start))
        every = Extreme((1.0 - _CLOSE) * best.beta, best.r)
        below = (1.0 - _CLOSE) * every.beta
    return every


def _refined(search: _Search, r: np.ndarray, best: _Found) -> _Found:
    """The least friction with stops between the frequencies r (n_r,) beside the best of them."""
    for _ in range(_ROUNDS):
        k = int(np.searchsorted(r, best.r))
        beside = 0.5 * (best.r + np.array([*r[max(k - 1, 0) : k], *r[k + 1 : k + 2]]))
        r = np.union1d(r, beside)
        for place in beside.tolist():
            best = search.lower(place, best)
    return best

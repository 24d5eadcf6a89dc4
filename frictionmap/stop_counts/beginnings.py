"""First points of borders: those that end the orbits on the two sides of a seed."""

import math
from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from .conditions import DOUBLING, FOLD, Condition
from .margins import Margin, margins
from .orbits import Sequence
from .phases import Phases
from .seeds import Source, orbit_at
from .tracing import Place, at_frequency, is_on_border, solve

#: Nearest borders of an orbit that are tried.
_TRIED = 5

#: A point of a border lies in the bracket of a seed, widened by this multiple of its width.
_WIDER = 3.0

#: Half periods of an orbit whose borders are sought, at most.  For mu > 1 longer ones follow each other
#: without end where stops are added period by period.
HALVES = 4

#: The same for folds and period doublings, and their events: determinants take long for long orbits.
_SINGULAR, _SINGULAR_EVENTS = 2, 6

#: The factor in beta by which the end of an orbit may lie beyond a seed.
_FAR = 1.3

Orbit: TypeAlias = tuple[Sequence, np.ndarray]


def orbits_beside(
    source: Source, phases: Phases, seed: tuple[float, float, float], halves: int = HALVES
) -> list[Orbit]:
    """The orbits at both ends of a seed (r, low, high) that return after at most `halves` half periods."""
    r, low, high = seed
    found = [orbit_at(source, r, beta) for beta in (low, high)]
    short = [orbit for orbit in found if orbit is not None and orbit[0].half_periods <= halves]
    exact = [_exact(phases, *orbit) for orbit in short]
    return [orbit for orbit in exact if orbit is not None]


def begun(phases: Phases, orbits: list[Orbit], low: float, high: float) -> Place | None:
    """The border inside a bracket that one of its orbits is near; None if there is none."""
    slack = _WIDER * (high - low)
    for near in (_events, _singularities):
        for sequence, unknowns in orbits:
            for place in _points(phases, sequence, unknowns, near(phases, sequence, unknowns)):
                if low - slack <= place.unknowns[-1] <= high + slack and is_on_border(phases, place):
                    return place
    return None


def ends(phases: Phases, orbits: list[Orbit], low: float, high: float) -> list[Place]:
    """The borders next in beta at which the orbits on the sides of a bracket end, both ways.

    For mu > 1 an orbit may live on where the motion from a start has left it.
    """
    found: list[Place] = []
    for sequence, unknowns in orbits:
        near = _events(phases, sequence, unknowns) + _singularities(phases, sequence, unknowns)
        places = [place for place in _points(phases, sequence, unknowns, near) if _is_near(place, low, high)]
        places.sort(key=lambda place: abs(math.log(place.unknowns[-1] / low)))
        for above in (False, True):
            side = (place for place in places if (place.unknowns[-1] > low) == above)
            found += next(([place] for place in side if is_on_border(phases, place)), [])
    return found


def _is_near(place: Place, low: float, high: float) -> bool:
    return low / _FAR < place.unknowns[-1] < high * _FAR


def _events(phases: Phases, sequence: Sequence, unknowns: np.ndarray) -> list[Margin]:
    return margins(phases, sequence, unknowns)[:_TRIED]


def _singularities(phases: Phases, sequence: Sequence, unknowns: np.ndarray) -> list[Margin]:
    """Folds and period doublings, which need mu > 1."""
    if sequence.mu == 1.0 or sequence.half_periods > _SINGULAR or sequence.events > _SINGULAR_EVENTS:
        return []
    return [Margin(Condition(kind, 0), 0.0, 0.0) for kind in (FOLD, DOUBLING)]


def _points(phases: Phases, sequence: Sequence, unknowns: np.ndarray, near: list[Margin]) -> Iterator[Place]:
    for margin in near:
        yield from at_frequency(phases, sequence, unknowns, margin)


def _exact(phases: Phases, sequence: Sequence, unknowns: np.ndarray) -> Orbit | None:
    """The same orbit to rounding, at its r and beta."""
    fixed = np.zeros((2, unknowns.size))
    fixed[0, -2] = fixed[1, -1] = 1.0
    exact = solve(phases, sequence, None, unknowns, fixed)
    return None if exact is None else (sequence, exact)

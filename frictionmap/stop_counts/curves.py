"""All borders between numbers of stops in a window, as exact curves."""

from typing import NamedTuple

import numpy as np

from ..model.general import refuse_general
from ..model.system import System
from .margins import is_physical, margins
from .phases import Phases
from .seeds import Seeds, counts_at, orbit_at, seeds_of_map
from .tracing import Place, Window, at_frequency, orbit_unknowns, solve, traced

#: Cells on a side of the maps that are searched, one after the other.
_MAPS = (160, 400)

#: Nearest borders of an orbit that are tried.
_TRIED = 5

#: A point of a border lies in the bracket of a seed, widened by this multiple of its width.
_WIDER = 3.0

#: Relative distance from a border at which the numbers of stops beside it are taken.
_BESIDE = 1e-6

#: Points put between two points of a curve, on the cubic through their tangents.
_BETWEEN = 8

#: Relative distance within which a point is on a curve: that of a chord between its points.
_ALIKE = 3e-5

#: The same next to the ends of curves.
_NEAR_END = 2e-4


class Border(NamedTuple):
    """A border over increasing r, its kind, and the stops per cycle below and above it in beta."""

    r: np.ndarray
    beta: np.ndarray
    kind: str
    below: float
    above: float


class _Curve(NamedTuple):
    kind: str
    r: np.ndarray
    beta: np.ndarray
    exact: np.ndarray  # whether a point was computed, not put between


def find_borders(system: System, r: tuple[float, float], beta: tuple[float, float]) -> list[Border]:
    """Find the borders between numbers of stops per cycle for mu = 1, in ranges of r and beta.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    r, beta : two numbers each, > 0
        Below some r borders are dense: about as many as 1/r^2.

    Returns
    -------
    list of Border
    """
    refuse_general(system, "find borders between numbers of stops")
    window = Window(r, beta)
    phases = Phases(system)
    found: list[_Curve] = []
    for count in _MAPS:
        _add(system, phases, window, seeds_of_map(system, window, 1.0, count), found)
    return _beside(system, [piece for curve in found for piece in _pieces(curve)])


def _add(system: System, phases: Phases, window: Window, seeds: Seeds, found: list[_Curve]) -> None:
    """Trace the borders through seeds that no known border explains."""
    for k in range(seeds.r.size):
        r, low, high = float(seeds.r[k]), float(seeds.low[k]), float(seeds.high[k])
        if any(_crosses(curve, r, low, high) for curve in found):
            continue
        begun = _begun(system, phases, r, low, high)
        if begun is not None and not any(_is_on(curve, begun) for curve in found):
            points = traced(phases, begun, window)
            exact = np.arange(_BETWEEN * (len(points) - 1) + 1) % _BETWEEN == 0
            found.append(_Curve(begun.condition.kind, *_dense(points), exact))


def _crosses(curve: _Curve, r: float, low: float, high: float) -> bool:
    """Whether a curve crosses a bracket in beta at a frequency."""
    x, y = curve.r, curve.beta
    left, right = x[:-1], x[1:]
    between = (np.minimum(left, right) <= r) & (r <= np.maximum(left, right)) & (left != right)
    share = (r - left[between]) / (right[between] - left[between])
    place = y[:-1][between] + share * (y[1:][between] - y[:-1][between])
    slack = _ALIKE * high + _WIDER * (high - low)
    return bool(((place >= low - slack) & (place <= high + slack)).any())


def _is_on(curve: _Curve, place: Place) -> bool:
    """Whether a point is on a curve of its kind, near whose ends cubics are less exact."""
    r, beta = place.unknowns[-2:]
    same = curve.kind == place.condition.kind
    return same and _crosses(curve, float(r), (1.0 - _NEAR_END) * beta, (1.0 + _NEAR_END) * beta)


def _begun(system: System, phases: Phases, r: float, low: float, high: float) -> Place | None:
    """The border inside a bracket; None if none of the nearest ones is there."""
    slack = _WIDER * (high - low)
    for beta in (low, high):
        orbit = orbit_at(system, r, beta, 1.0)
        if orbit is None:
            continue
        sequence, unknowns = orbit
        fixed = np.zeros((2, unknowns.size))
        fixed[0, -2] = fixed[1, -1] = 1.0
        exact = solve(phases, sequence, None, unknowns, fixed)
        if exact is None:
            continue
        for margin in margins(phases, sequence, exact)[:_TRIED]:
            place = at_frequency(phases, sequence, exact, margin)
            if place is None or not low - slack <= place.unknowns[-1] <= high + slack:
                continue
            if is_physical(phases, place.sequence, orbit_unknowns(place.condition, place.unknowns)):
                return place
    return None


def _pieces(curve: _Curve) -> list[Border]:
    """Parts of a curve over which r increases or decreases, with points between its own."""
    r, beta = curve.r[curve.exact], curve.beta[curve.exact]
    sense = np.sign(np.diff(r))
    cuts = np.flatnonzero(sense[1:] != sense[:-1]) + 1
    pieces = []
    for first, last in zip([0, *cuts.tolist()], [*cuts.tolist(), r.size - 1], strict=True):
        part = slice(first, last + 1)
        order = np.argsort(r[part], kind="stable")
        if order.size > 1:
            pieces.append(Border(r[part][order], beta[part][order], curve.kind, np.nan, np.nan))
    return pieces


def _dense(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """r and beta of a curve at more points: cubics through its points and tangents, over the chord."""
    places, tangents = points[:, :2], points[:, 2:]
    steps = np.diff(places, axis=0)
    chords = np.hypot(*steps.T)[:, np.newaxis]
    share = (np.arange(_BETWEEN) / _BETWEEN)[:, np.newaxis, np.newaxis]
    low, high = chords * tangents[:-1], chords * tangents[1:]
    cubic = low + high - 2.0 * steps
    found = places[:-1] + share * (low + share * (3.0 * steps - 2.0 * low - high + share * cubic))
    between = found.transpose(1, 0, 2).reshape(-1, 2)
    r, beta = np.exp(np.concatenate((between, places[-1:]))).T
    return r, beta


def _beside(system: System, pieces: list[Border]) -> list[Border]:
    """The same with the numbers of stops below and above them, taken in the middle of each."""
    if not pieces:
        return pieces
    middle = [piece.r.size // 2 for piece in pieces]
    r = np.array([piece.r[k] for piece, k in zip(pieces, middle, strict=True)])
    beta = np.array([piece.beta[k] for piece, k in zip(pieces, middle, strict=True)])
    below, above = (counts_at(system, r, beta * (1.0 + sign * _BESIDE), 1.0) for sign in (-1.0, 1.0))
    return [
        piece._replace(below=float(low), above=float(high))
        for piece, low, high in zip(pieces, below, above, strict=True)
    ]

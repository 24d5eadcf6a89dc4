"""All borders between numbers of stops in a window, as exact curves."""

from typing import NamedTuple

import numpy as np

from ..model.general import refuse_general
from ..model.system import System
from .margins import margins
from .phases import Phases
from .seeds import Seeds, counts_at, narrowed, orbit_at, seeds_of_map
from .tracing import Place, Window, at_frequency, is_on_border, solve, traced

#: Maps that are searched one after the other: frequencies, friction ratios, whether frequencies are spaced
#: in proportion.  The last one has the rows of a fine map of the window.
_MAPS = ((160, 160, True), (400, 400, True), (2000, 500, False))

#: Nearest borders of an orbit that are tried.
_TRIED = 5

#: A point of a border lies in the bracket of a seed, widened by this multiple of its width.
_WIDER = 3.0

#: Relative distance from a border at which the numbers of stops beside it are taken.
_BESIDE = 1e-6

#: Points of a border whose numbers of stops are compared.
_COMPARED = 7

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
    for rows, columns, proportional in _MAPS:
        r_map = (np.geomspace if proportional else np.linspace)(*window.r, rows)
        seeds = _unexplained(seeds_of_map(system, window, 1.0, r_map, columns), found)
        _add(system, phases, window, narrowed(system, 1.0, seeds), found)
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


def _unexplained(seeds: Seeds, found: list[_Curve]) -> Seeds:
    """Seeds that no known border crosses."""
    known = np.zeros(seeds.r.size, dtype=bool)
    for curve in found:
        known |= _crossed(curve, seeds)
    return Seeds(*(array[~known] for array in seeds))


def _crossed(curve: _Curve, seeds: Seeds) -> np.ndarray:
    """Which seeds a curve crosses, (k,)."""
    order = np.argsort(seeds.r, kind="stable")
    r, low, high = seeds.r[order], seeds.low[order], seeds.high[order]
    crossed = np.zeros(r.size, dtype=bool)
    for k in range(curve.r.size - 1):
        (left, first), (right, last) = sorted(zip(curve.r[k : k + 2], curve.beta[k : k + 2], strict=True))
        if left == right:
            continue
        near = slice(*np.searchsorted(r, (left, right), side="left"))
        place = first + (r[near] - left) / (right - left) * (last - first)
        crossed[near] |= (place >= low[near] * (1.0 - _ALIKE)) & (place <= high[near] * (1.0 + _ALIKE))
    found = np.empty(r.size, dtype=bool)
    found[order] = crossed
    return found


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
            if is_on_border(phases, place):
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
    """The same with the numbers of stops below and above them, which most of some points of each have."""
    if not pieces:
        return pieces
    which = [_spread(piece) for piece in pieces]
    r = np.concatenate([piece.r[k] for piece, k in zip(pieces, which, strict=True)])
    beta = np.concatenate([piece.beta[k] for piece, k in zip(pieces, which, strict=True)])
    sides = [counts_at(system, r, beta * (1.0 + sign * _BESIDE), 1.0) for sign in (-1.0, 1.0)]
    ends = np.cumsum([k.size for k in which])[:-1]
    below, above = (np.split(side, ends) for side in sides)
    return [
        piece._replace(below=low, above=high)
        for piece, (low, high) in zip(pieces, map(_most, below, above), strict=True)
    ]


def _spread(piece: Border) -> np.ndarray:
    """Indices of points spread evenly over the length of a piece, its ends left out if it has others."""
    steps = np.hypot(np.diff(np.log(piece.r)), np.diff(np.log(piece.beta)))
    length = np.concatenate(([0.0], np.cumsum(steps)))
    places = (np.arange(_COMPARED) + 0.5) / _COMPARED * length[-1]
    return np.unique(np.clip(np.searchsorted(length, places), 0, piece.r.size - 1))


def _most(below: np.ndarray, above: np.ndarray) -> tuple[float, float]:
    """The pair of different numbers of stops that most points have; NaN if none has any."""
    pairs = np.stack((below, above), axis=1)
    pairs = pairs[~np.isnan(pairs).any(axis=1) & (below != above)]
    if not len(pairs):
        return np.nan, np.nan
    found, count = np.unique(pairs, axis=0, return_counts=True)
    low, high = found[np.argmax(count)].tolist()
    return low, high

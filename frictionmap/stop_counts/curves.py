"""All borders between numbers of stops in a window, as exact curves."""

from typing import NamedTuple

import numpy as np

from ..model.general import refuse_general
from ..model.settings import Start
from ..model.system import System
from ..theory.boundary_curves import find_curves
from .beginnings import HALVES, begun, ends, orbits_beside
from .conditions import DOUBLING, TURN
from .phases import Phases
from .seeds import Seeds, Source, narrowed, seeds_of_map
from .tracing import Place, Window, ends_with_stop, traced


class _Map(NamedTuple):
    """A map that is searched: frequencies, friction ratios, whether frequencies are spaced in proportion."""

    rows: int
    columns: int
    proportional: bool
    start: Start = "rest"


#: Maps that are searched one after the other.  For mu = 1 the last has the rows of a fine map of the window.
_UNIQUE = (_Map(160, 160, True), _Map(400, 400, True), _Map(2000, 500, False))
_SEVERAL = (_Map(160, 160, True), _Map(160, 160, True, "moving"), _Map(400, 400, True))

#: Seeds for mu > 1 are alike within this relative distance in r and beta.  Numbers of stops are integers,
#: stored in single precision.
_ALIKE_SEEDS, _WHOLE = 0.01, 1e-5

#: A curve crosses a bracket that is widened by this multiple of its width.
_WIDER = 3.0

#: Points put between two points of a curve, on the cubic through their tangents.
_BETWEEN = 8

#: Relative distance within which a point is on a curve: that of a chord between its points.
_ALIKE = 3e-5

#: The same next to the ends of curves.
_NEAR_END = 2e-4

#: Relative distance within which a point is one of beta_lim: Newton's method ends within this distance of it.
_SAME = 1e-9


class Border(NamedTuple):
    """A border over increasing r, its kind, and the stops per cycle below and above it in beta.

    For mu > 1 these are the stops of the orbit that ends there; NaN where it does not exist.
    """

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
    side: np.ndarray  # of the orbit, weighted by the tangent in r: where r turns, the side changes
    stops: float  # of the orbit
    other: float  # on the other side


def find_borders(
    system: System, r: tuple[float, float], beta: tuple[float, float], mu: float
) -> list[Border]:
    """Find the borders between numbers of stops per cycle in ranges of r and beta.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    r, beta : two numbers each, > 0
        Below some r borders are dense: about as many as 1/r^2.
    mu : >= 1
        For mu > 1 the borders of the orbits that maps from two starts contain: where each of them ends.

    Returns
    -------
    list of Border
    """
    refuse_general(system, "find borders between numbers of stops")
    window = Window(r, beta)
    phases = Phases(system)
    found: list[_Curve] = []
    for searched in _UNIQUE if mu == 1.0 else _SEVERAL:
        source = Source(system, mu, searched.start)
        r_map = (np.geomspace if searched.proportional else np.linspace)(*window.r, searched.rows)
        seeds = _unexplained(seeds_of_map(source, window, r_map, searched.columns), found)
        if mu > 1.0:
            seeds = _thinned(seeds)
        _add(source, phases, window, narrowed(source, seeds), found)
    borders = [piece for curve in found for piece in _pieces(curve)]
    return [border for border in borders if not _is_beta_lim(system, mu, border)]


def _is_beta_lim(system: System, mu: float, border: Border) -> bool:
    """Whether a border is that of the continuous motion, or of stops that have no length there.

    Other borders share single points with beta_lim.  This one ends where its orbit does, beyond a corner of
    beta_lim by as much as an orbit may miss its conditions: most points decide.
    """
    limit = find_curves(system, border.r, np.array([mu])).beta_lim[0]
    return bool(np.mean(np.abs(border.beta - limit) <= _SAME * limit) > 0.5)


def _add(source: Source, phases: Phases, window: Window, seeds: Seeds, found: list[_Curve]) -> None:
    """Trace the borders through seeds that no known border explains."""
    for k in range(seeds.r.size):
        r, low, high = float(seeds.r[k]), float(seeds.low[k]), float(seeds.high[k])
        if any(_crosses(curve, r, low, high) for curve in found):
            continue
        orbits = orbits_beside(source, phases, (r, low, high))
        place = begun(phases, orbits, low, high)
        places = [] if place is None else [place]
        if source.mu > 1.0 and place is None:
            places = ends(phases, orbits, low, high)
        for first in places:
            if not any(_is_on(curve, first) for curve in found):
                found.append(_curve(first, traced(phases, first, window)))


def _curve(place: Place, points: np.ndarray) -> _Curve:
    """A traced border with points between its own, and the stops of its orbit on both sides."""
    sequence, kind = place.sequence, place.condition.kind
    exact = np.arange(_BETWEEN * (len(points) - 1) + 1) % _BETWEEN == 0
    stops = other = sequence.stops_per_cycle
    if sequence.mu == 1.0 or (kind == TURN and not ends_with_stop(sequence, place.condition)):
        other += 2.0 / sequence.half_periods
    elif kind != DOUBLING:
        other = np.nan
    side = points[:, 4] * np.abs(points[:, 2])
    return _Curve(kind, *_dense(points[:, :4]), exact, side, stops, other)


def _unexplained(seeds: Seeds, found: list[_Curve]) -> Seeds:
    """Seeds that no known border crosses."""
    known = np.zeros(seeds.r.size, dtype=bool)
    for curve in found:
        known |= _crossed(curve, seeds)
    return Seeds(*(array[~known] for array in seeds))


def _thinned(seeds: Seeds) -> Seeds:
    """Seeds beside an orbit whose ends are sought, one of those with the same numbers close to each other.

    For mu > 1 most changes are where a start leaves a basin, and explained by no border.
    """
    sides = (seeds.below, seeds.above)
    halves = np.arange(1, HALVES + 1)[:, np.newaxis]
    stops = [0.5 * halves * side for side in sides]  # of an orbit of this many half periods
    short = np.any([np.abs(each - np.round(each)) < _WHOLE for each in stops], axis=(0, 1))
    places = [np.floor(np.log(array) / _ALIKE_SEEDS) for array in (seeds.r, seeds.low)]
    keys = np.column_stack((*places, *sides))[short]
    first = np.sort(np.unique(keys, axis=0, return_index=True)[1])
    return Seeds(*(array[short][first] for array in seeds))


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
            sides = _sides(curve, float(curve.side[part].sum()))
            pieces.append(Border(r[part][order], beta[part][order], curve.kind, *sides))
    return pieces


def _sides(curve: _Curve, side: float) -> tuple[float, float]:
    """Stops below and above a border whose orbit is on one side of it."""
    if side == 0.0 and curve.kind != DOUBLING:
        return np.nan, np.nan
    return (curve.other, curve.stops) if side > 0.0 else (curve.stops, curve.other)


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

"""Borders as curves: Newton's method for a point, pseudo-arclength from point to point."""

import math
from typing import NamedTuple

import numpy as np

from .conditions import DOUBLING, FOLD, GRAZE, SLIDE_END, SLIP, TURN, Condition, residuals
from .margins import Margin, is_physical
from .orbits import Sequence
from .phases import Phases

#: Steps of differences: of phases, and of r and beta relative to them.
_DIFFERENCE = 1e-6

#: Step, in phases, by which the second derivative of an orbit's equations at a fold is found.
_BENT = 1e-3

#: Newton's method: steps, at most; the largest one; and the one after which the next would be rounding: the
#: error left is its square, or its product with the error of the derivatives.
_NEWTON, _LARGEST, _FOUND = 12, 0.5, 1e-9

#: Weight of phases against relative changes of r and beta, in the length of a curve.
_PHASE = 1.0 / 30.0

#: Steps along a curve: first, largest, least; the factor of a longer one.
_FIRST, _LONGEST, _SHORTEST, _GROWTH = 0.01, 0.02, 1e-7, 1.5

#: Least distance of a border's event from the beginning of its piece, in periods of the orbit.
_INSIDE = 1e-5

#: Length of a step times the angle by which the curve turns in it: the chord is off by an eighth of that.
#: Steps are chosen for it, and repeated if it is exceeded by a factor, unless they are short.
_TURNED, _EXCEEDED, _SHORT = 1e-4, 3.0, 1e-3

#: Turns of a curve in r are found to this component of the tangent; largest number of steps.
_VERTICAL, _SECANTS = 1e-9, 8

#: Points closer than this to others are not kept, except for the ends.
_APART = 5e-4

#: A curve ends after this many steps in sequence below this length: its equations become singular there.
_CRAWLS, _CRAWL = 20, 1e-4

#: Points of a curve in one direction, at most.
_MOST = 4000


class Window(NamedTuple):
    """Ranges of r and beta in which borders are followed."""

    r: tuple[float, float]
    beta: tuple[float, float]

    def holds(self, r: float, beta: float) -> bool:
        """Whether a point is inside."""
        return self.r[0] <= r <= self.r[1] and self.beta[0] <= beta <= self.beta[1]


def _scales(unknowns: np.ndarray) -> np.ndarray:
    """Lengths of the unknowns: a change by one of them counts alike."""
    scales = np.full(unknowns.size, 1.0 / _PHASE)
    scales[-2:] = np.abs(unknowns[-2:])
    return scales


def _linearise(
    phases: Phases, sequence: Sequence, condition: Condition | None, unknowns: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Residuals (n,) and their derivatives (n, unknowns), by central differences."""
    steps = np.full(unknowns.size, _DIFFERENCE)
    steps[-2:] *= np.abs(unknowns[-2:])
    cases = np.concatenate((unknowns[np.newaxis], unknowns + np.diag(steps), unknowns - np.diag(steps)))
    values = residuals(phases, sequence, condition, cases)
    count = unknowns.size
    return values[0], ((values[1 : count + 1] - values[count + 1 :]) / (2.0 * steps)[:, np.newaxis]).T


def solve(
    phases: Phases, sequence: Sequence, condition: Condition | None, guess: np.ndarray, fixed: np.ndarray
) -> np.ndarray | None:
    """Point of a border on planes through the guess, normals `fixed` (k, unknowns) scaled; None: none."""
    unknowns, scales = guess.copy(), _scales(guess)
    for _ in range(_NEWTON):
        try:
            values, slopes = _linearise(phases, sequence, condition, unknowns)
            plane = fixed @ ((unknowns - guess) / scales)
            matrix = np.concatenate((slopes * scales, fixed))
            sizes = np.abs(matrix).max(axis=1)
            step = np.linalg.solve(matrix / sizes[:, np.newaxis], -np.concatenate((values, plane)) / sizes)
        except np.linalg.LinAlgError:
            return None
        size = float(np.abs(step).max())
        if not np.isfinite(size) or size > _LARGEST:
            return None
        unknowns = unknowns + step * scales
        if unknowns[-1] <= 0.0 or unknowns[-2] <= 0.0:
            return None
        if size <= _FOUND:
            return unknowns
    return None


class Place(NamedTuple):
    """A point of a border: its orbit, the condition, and all unknowns."""

    sequence: Sequence
    condition: Condition
    unknowns: np.ndarray


def centred(place: Place) -> Place:
    """The same point with its orbit begun in the middle of the longest piece, unless it begins near there."""
    sequence, condition, unknowns = place
    count = sequence.events
    times = unknowns[:count]
    turn = sequence.end - sequence.start
    begins = np.concatenate(([times[-1] - turn], times))  # of the first piece, and of all others
    lengths = np.diff(np.concatenate((begins, [times[0] + turn])))[:count]
    longest = int(np.argmax(lengths))
    inside = (sequence.start - begins[0]) / lengths[0]
    if longest == 0 and 0.25 < inside < 0.75:
        return place
    back = -1 if sequence.mirrored else 1
    senses = (*sequence.senses[longest:], *(back * sense for sense in sequence.senses[1 : longest + 1]))
    moved = np.concatenate((times[longest:], times[:longest] + turn))
    start = float(begins[longest] + 0.5 * lengths[longest])
    piece, sign, tau = condition.piece, condition.sign, unknowns[count:-2]
    if condition.inside and piece == count:  # continues as the first piece
        piece, sign, tau = 0, back * sign, tau - turn
    if piece < longest:
        piece, sign, tau = piece + count, back * sign, tau + turn
    piece -= longest
    if condition.inside and piece == 0:
        piece, sign, tau = count, back * sign, tau + turn
    return Place(
        sequence._replace(senses=senses, start=start), condition._replace(piece=piece, sign=sign),
        np.concatenate((moved, tau, unknowns[-2:])),
    )  # fmt: skip


def _tangent(place: Place, slopes: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Scaled direction of a border at one of its points, of the sense of `along` in r and beta."""
    scaled = slopes * _scales(place.unknowns)
    direction = np.linalg.svd(scaled / np.abs(scaled).max(axis=1, keepdims=True))[2][-1]
    return direction if direction[-2:] @ along >= 0.0 else -direction


def _side(phases: Phases, place: Place, slopes: np.ndarray) -> float:
    """Whether the orbit lives above (1) or below (-1) its border in beta, or neither alone (0)."""
    sequence, condition, unknowns = place
    if condition.kind == DOUBLING:
        return 0.0
    count = sequence.events
    by_times, by_beta = slopes[:count, :count], slopes[:count, -1]
    if condition.kind in (FOLD, SLIDE_END):  # two orbits meet, or the two times at which a slide may end
        left, _, right = np.linalg.svd(by_times)
        away = np.append(right[-1], [0.0, 0.0]) * _BENT
        values = residuals(phases, sequence, None, unknowns + np.outer([1.0, 0.0, -1.0], away))
        return float(-np.sign((left[:, -1] @ values.T @ [1.0, -2.0, 1.0]) * (left[:, -1] @ by_beta)))
    try:
        moved = np.linalg.solve(by_times, -by_beta)
    except np.linalg.LinAlgError:
        return 0.0  # it is one of a family of orbits
    margin = slopes[count, -1] + slopes[count, :count] @ moved
    within = condition.sign if condition.kind == SLIP else sequence.senses[condition.piece]
    positive = condition.kind == GRAZE or ends_with_stop(sequence, condition)
    return float(np.sign(margin * (within if positive else -within)))


def ends_with_stop(sequence: Sequence, condition: Condition) -> bool:
    """Whether an orbit ends at turn/stop with a stop that has a length."""
    return condition.kind == TURN and sequence.senses[condition.piece + 1] == 0


def at_frequency(phases: Phases, sequence: Sequence, unknowns: np.ndarray, margin: Margin) -> list[Place]:
    """The points of a border at the frequency of an orbit that is near it.

    At turn/stop a stop becomes a turn as its length vanishes.  For mu > 1 the orbit may also end there with a
    stop of some length, which the force leaves at its beginning already.
    """
    places = []
    if margin.condition.kind == TURN:
        shorter = _without_stop(sequence, unknowns, margin.condition.piece)
        if shorter is not None:
            places.append(_at_frequency(phases, *shorter, margin))
    if margin.condition.kind != TURN or sequence.mu > 1.0 or not places:
        places.append(_at_frequency(phases, sequence, unknowns, margin))
    return [place for place in places if place is not None]


def _at_frequency(phases: Phases, sequence: Sequence, unknowns: np.ndarray, margin: Margin) -> Place | None:
    condition = margin.condition
    guess = unknowns
    if condition.inside:
        guess = np.insert(unknowns, unknowns.size - 2, margin.tau)
    fixed = np.zeros((1, guess.size))
    fixed[0, -2] = 1.0
    found = solve(phases, sequence, condition, guess, fixed)
    return None if found is None else Place(sequence, condition, found)


def _without_stop(sequence: Sequence, unknowns: np.ndarray, k: int) -> tuple[Sequence, np.ndarray] | None:
    """A sequence in which the stop after slide k is a turn: on their border it has no length."""
    if sequence.senses[k + 1] or k + 2 > sequence.events:
        return None
    if sequence.senses[k + 2] == sequence.senses[k]:
        return None
    senses = (*sequence.senses[: k + 1], *sequence.senses[k + 2 :])
    return sequence._replace(senses=senses), np.delete(unknowns, k + 1)


def is_on_border(phases: Phases, place: Place) -> bool:
    """Whether the orbit of a point is consistent, and the border's own event is inside its piece."""
    sequence, condition, unknowns = place
    if condition.inside and not _is_inside(sequence, condition, unknowns):
        return False
    return is_physical(phases, sequence, orbit_unknowns(condition, unknowns))


def _is_inside(sequence: Sequence, condition: Condition, unknowns: np.ndarray) -> bool:
    """Whether the event of a border lies between the ends of its piece.

    For mu = 1 a slide that follows a stop fulfils the equations of a graze at its beginning.
    """
    count, piece = sequence.events, condition.piece
    times, tau = unknowns[:count], unknowns[count]
    end = times[piece] if piece < count else times[0] + sequence.end - sequence.start
    return bool(times[piece - 1] + _INSIDE * (sequence.end - sequence.start) < tau < end)


def orbit_unknowns(condition: Condition, unknowns: np.ndarray) -> np.ndarray:
    """Event times, r and beta of a point of a border."""
    return np.delete(unknowns, unknowns.size - 3) if condition.inside else unknowns


class _Course(NamedTuple):
    """Point, scaled tangent and curvature of a border, and the side on which its orbit lives, see `_side`."""

    place: Place
    along: np.ndarray
    bend: np.ndarray
    side: float

    def ahead(self, step: float) -> np.ndarray:
        """Unknowns of the point at a length further on, to second order."""
        unknowns = self.place.unknowns
        return unknowns + step * (self.along + 0.5 * step * self.bend) * _scales(unknowns)


def _begun(phases: Phases, begin: Place, direction: np.ndarray) -> _Course:
    """The course at the first point of a border."""
    place = centred(begin)
    _, slopes = _linearise(phases, *place)
    along = _tangent(place, slopes, direction)
    return _Course(place, along, np.zeros(along.size), _side(phases, place, slopes))


def _step_along(phases: Phases, course: _Course, step: float) -> _Course | None:
    """The course at a length further on; None if there is no such point, or its orbit is not physical."""
    sequence, condition, last = course.place
    guess = course.ahead(step)
    if guess[-1] <= 0.0 or guess[-2] <= 0.0:
        return None
    found = solve(phases, sequence, condition, guess, course.along[np.newaxis])
    if found is None or not is_on_border(phases, Place(sequence, condition, found)):
        return None
    place = centred(Place(sequence, condition, found))
    _, slopes = _linearise(phases, *place)
    along = _tangent(place, slopes, np.log(found[-2:] / last[-2:]))
    bend = (along - course.along) / step if place.sequence is sequence else np.zeros(along.size)
    return _Course(place, along, bend, _side(phases, place, slopes))


def _follow(phases: Phases, begin: Place, direction: np.ndarray, window: Window) -> list[np.ndarray]:
    """Points of a border from one on, to the end of the window or of the orbit, see `_point`.

    direction : (2,) in which log r and log beta are to change at first
    """
    course, step = _begun(phases, begin, direction), _FIRST
    points, crawled = [_point(course)], 0
    while len(points) < _MOST and crawled < _CRAWLS:
        ahead = _step_along(phases, course, step)
        turned = 0.0 if ahead is None else _turning(points[-1], _point(ahead))
        if ahead is None or (turned > _EXCEEDED * _TURNED and step > _SHORT):
            step *= 0.5
            if step < _SHORTEST:
                break
            continue
        if ahead.along[-2] * course.along[-2] < 0.0:
            turn = _vertical(phases, course, ahead, step)
            if turn is not None:
                points.append(_point(turn))
        points.append(_point(ahead))
        course = ahead
        if not window.holds(*course.place.unknowns[-2:]) or _closed(points):
            break
        crawled = crawled + 1 if step < _CRAWL else 0
        longer = _GROWTH if turned * _GROWTH**2 <= _TURNED else max(0.5, math.sqrt(_TURNED / turned))
        step = min(_LONGEST, step * longer)
    return points


def _turning(first: np.ndarray, second: np.ndarray) -> float:
    """Distance of two points times the sine of the angle between their tangents."""
    sine = first[2] * second[3] - first[3] * second[2]
    return float(np.hypot(*(second[:2] - first[:2])) * abs(sine))


def _vertical(phases: Phases, course: _Course, ahead: _Course, step: float) -> _Course | None:
    """The point of a step at which r turns, by secants; None if they lose it."""
    low, high = (0.0, float(course.along[-2])), (step, float(ahead.along[-2]))
    for _ in range(_SECANTS):
        if high[1] == low[1]:
            return None
        middle = low[0] - low[1] * (high[0] - low[0]) / (high[1] - low[1])
        if not 0.0 < middle < step:
            return None
        found = _step_along(phases, course, middle)
        if found is None:
            return None
        slope = float(found.along[-2])
        if abs(slope) <= _VERTICAL:
            return found
        low, high = (high if abs(high[1]) < abs(low[1]) else low), (middle, slope)
    return None


def _point(course: _Course) -> np.ndarray:
    """log r and log beta of a place, their unit tangent, and the side of the orbit."""
    along = course.along[-2:]
    return np.array([*np.log(course.place.unknowns[-2:]), *(along / np.linalg.norm(along)), course.side])


def _closed(points: list[np.ndarray]) -> bool:
    """Whether a border has come back to where it began."""
    if len(points) < 8:
        return False
    first, last, before = (points[k][:2] for k in (0, -1, -2))
    return bool(np.abs(last - first).max() < np.abs(last - before).max())


def traced(phases: Phases, begin: Place, window: Window) -> np.ndarray:
    """Points (points, 5) of a border through one of its points, in both directions: see `_follow`."""
    direction = _begun(phases, begin, np.array([1.0, 0.0])).along[-2:]
    forward = _follow(phases, begin, direction, window)
    if _closed(forward):
        return _thin_out(np.array(forward))
    backward = _follow(phases, begin, -direction, window)
    turned = [point * [1.0, 1.0, -1.0, -1.0, 1.0] for point in backward[:0:-1]]
    return _thin_out(np.array([*turned, *forward]))


def _thin_out(points: np.ndarray) -> np.ndarray:
    """The same points without those that crowd, mostly where the last steps to an end were halved."""
    kept = [0]
    for k in range(1, len(points)):
        near = np.hypot(*(points[k, :2] - points[kept[-1], :2])) < _APART
        if near and k + 1 < len(points) and abs(points[k, 2]) > _VERTICAL:
            continue
        if near and len(kept) > 1:
            kept.pop()
        kept.append(k)
    return points[kept]

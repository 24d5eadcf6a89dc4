"""Borders as curves: Newton's method for a point, pseudo-arclength from point to point."""

from typing import NamedTuple

import numpy as np

from .margins import Margin, is_physical
from .orbits import TURN, Condition, Sequence, residuals
from .phases import Phases

#: Steps of differences: of phases, and of r and beta relative to them.
_DIFFERENCE = 1e-6

#: Newton's method: steps, at most; the relative step at which it ends, and the largest one it begins with.
_NEWTON, _FOUND, _LARGEST = 12, 1e-13, 0.5

#: What Newton's method has reached when it no longer improves.
_REACHED = 1e-10

#: Weight of phases against relative changes of r and beta, in the length of a curve.
_PHASE = 1.0 / 30.0

#: Steps along a curve: first, largest, least; the factor of a longer one.
_FIRST, _LONGEST, _SHORTEST, _GROWTH = 0.01, 0.02, 1e-7, 1.5

#: So many steps in sequence below this length are the end of a curve: its equations become singular there.
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


def _linearised(
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
    before = np.inf
    for _ in range(_NEWTON):
        try:
            values, slopes = _linearised(phases, sequence, condition, unknowns)
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
        if size <= _FOUND or (size <= _REACHED and size >= 0.25 * before):
            return unknowns
        before = size
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
    if condition.inside and piece == count:  # goes on as the first piece
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


def _tangent(phases: Phases, place: Place, along: np.ndarray) -> np.ndarray:
    """Scaled direction of a border at one of its points, of the sense of `along` in r and beta."""
    _, slopes = _linearised(phases, *place)
    scaled = slopes * _scales(place.unknowns)
    direction = np.linalg.svd(scaled / np.abs(scaled).max(axis=1, keepdims=True))[2][-1]
    return direction if direction[-2:] @ along >= 0.0 else -direction


def at_frequency(phases: Phases, sequence: Sequence, unknowns: np.ndarray, margin: Margin) -> Place | None:
    """The point of a border at the frequency of an orbit that is near it; None if there is none."""
    condition = margin.condition
    if condition.kind == TURN:
        sequence, condition, unknowns = _without_stop(sequence, condition, unknowns)
    guess = unknowns
    if condition.inside:
        guess = np.insert(unknowns, unknowns.size - 2, margin.tau)
    fixed = np.zeros((1, guess.size))
    fixed[0, -2] = 1.0
    found = solve(phases, sequence, condition, guess, fixed)
    return None if found is None else Place(sequence, condition, found)


def _without_stop(
    sequence: Sequence, condition: Condition, unknowns: np.ndarray
) -> tuple[Sequence, Condition, np.ndarray]:
    """A sequence in which the stop after slide k is a turn: on their border it has no length."""
    k = condition.piece
    if sequence.senses[k + 1] or k + 2 > sequence.events:
        return sequence, condition, unknowns
    if sequence.senses[k + 2] == sequence.senses[k]:
        return sequence, condition, unknowns
    senses = (*sequence.senses[: k + 1], *sequence.senses[k + 2 :])
    return sequence._replace(senses=senses), condition, np.delete(unknowns, k + 1)


def orbit_unknowns(condition: Condition, unknowns: np.ndarray) -> np.ndarray:
    """Event times, r and beta of a point of a border."""
    return np.delete(unknowns, unknowns.size - 3) if condition.inside else unknowns


def _follow(phases: Phases, begin: Place, direction: np.ndarray, window: Window) -> list[np.ndarray]:
    """Points of a border from one on, to the end of the window or of the orbit: log r, log beta, tangent.

    direction : (2,) in which log r and log beta are to change at first
    """
    place, step = centred(begin), _FIRST
    along = _tangent(phases, place, direction)
    points, crawled = [_point(place, along)], 0
    while len(points) < _MOST and crawled < _CRAWLS:
        sequence, condition, last = place
        guess = last + step * along * _scales(last)
        found = None
        if guess[-1] > 0.0 and guess[-2] > 0.0:
            found = solve(phases, sequence, condition, guess, along[np.newaxis])
        if found is None or not is_physical(phases, sequence, orbit_unknowns(condition, found)):
            step *= 0.5
            if step < _SHORTEST:
                break
            continue
        place = centred(Place(sequence, condition, found))
        along = _tangent(phases, place, np.log(found[-2:] / last[-2:]))
        points.append(_point(place, along))
        if not window.holds(found[-2], found[-1]) or _closed(points):
            break
        crawled = crawled + 1 if step < _CRAWL else 0
        step = min(_LONGEST, step * _GROWTH)
    return points


def _point(place: Place, along: np.ndarray) -> np.ndarray:
    """log r and log beta of a place, and their unit tangent."""
    return np.concatenate((np.log(place.unknowns[-2:]), along[-2:] / np.linalg.norm(along[-2:])))


def _closed(points: list[np.ndarray]) -> bool:
    """Whether a border has come back to where it began."""
    if len(points) < 8:
        return False
    first, last, before = (points[k][:2] for k in (0, -1, -2))
    return bool(np.abs(last - first).max() < np.abs(last - before).max())


def traced(phases: Phases, begin: Place, window: Window) -> np.ndarray:
    """Points (points, 4) of a border through one of its points, in both directions: see `_follow`."""
    direction = _tangent(phases, centred(begin), np.array([1.0, 0.0]))[-2:]
    forward = _follow(phases, begin, direction, window)
    if _closed(forward):
        return np.array(forward)
    backward = _follow(phases, begin, -direction, window)
    turned = [point * [1.0, 1.0, -1.0, -1.0] for point in backward[:0:-1]]
    return np.array([*turned, *forward])

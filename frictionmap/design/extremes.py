"""Maxima of functions of one variable, many at a time: the vertex of a parabola, safeguarded."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: New points of a bracket: around the vertex of the parabola, at this share of the bracket.
_ASIDE = 0.06

#: Shares of a bracket that begins at its largest value.
_FROM_AN_END = (0.02, 0.1, 0.3, 0.6)

#: Rounds, at most.  A smooth maximum needs about five; one that is not found then lies at a kink or a jump,
#: and that side of its bracket is cut into this many parts.
_ROUNDS, _SMOOTH_ROUNDS, _PARTS = 60, 6, 13

#: A maximum is dropped if the largest of its group is above it by more than this multiple of its rise.
_RISE = 4.0

#: A bracket ends where its values differ by less than this: of a smooth maximum the square of it is lost.
_ALIKE = 1e-10

#: Least width of a bracket, in units of rounding of its place.
_NARROW = 8.0 * float(np.finfo(float).eps)

#: f(which, x): values (k,) of the functions `which` (k,) at x (k,).
Functions = Callable[[np.ndarray, np.ndarray], np.ndarray]


class Brackets(NamedTuple):
    """Places a <= m <= b, where m is the largest of three values; arrays (k,)."""

    a: np.ndarray
    m: np.ndarray
    b: np.ndarray
    at_a: np.ndarray
    at_m: np.ndarray
    at_b: np.ndarray


def brackets_of(x: np.ndarray, values: np.ndarray, rounding: float = 0.0) -> Brackets:
    """Brackets of all local maxima of samples, values (n,) at increasing x (n,); of a plateau the first.

    Values are compared in units of `rounding`, where it is given and finite.
    """
    level = np.round(values / rounding) if 0.0 < rounding < np.inf else values
    padded = np.concatenate(([-np.inf], level, [-np.inf]))
    place = np.flatnonzero((level > padded[:-2]) & (level >= padded[2:]))
    before, after = np.maximum(place - 1, 0), np.minimum(place + 1, x.size - 1)
    return Brackets(x[before], x[place], x[after], values[before], values[place], values[after])


def chosen(bracket: Brackets, which: np.ndarray) -> Brackets:
    """Some of the brackets."""
    return Brackets(*(array[which] for array in bracket))


def joined(parts: list[Brackets]) -> Brackets:
    """Brackets of several functions in one."""
    return Brackets(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def vertex(bracket: Brackets) -> np.ndarray:
    """Place of the maximum of the parabola through each bracket; m where there is none inside."""
    left, right = bracket.m - bracket.a, bracket.b - bracket.m
    with np.errstate(all="ignore"):
        down = (bracket.at_m - bracket.at_a) / left
        up = (bracket.at_b - bracket.at_m) / right
        bend = (up - down) / (left + right)
        place = 0.5 * (bracket.a + bracket.m - down / bend)
    inside = np.isfinite(place) & (place > bracket.a) & (place < bracket.b)
    return np.where(inside, place, bracket.m)


def _proposals(bracket: Brackets) -> np.ndarray:
    """New places for each bracket, (k, 5)."""
    width = bracket.b - bracket.a
    u, aside = vertex(bracket), _ASIDE * width
    inner = [u - aside, u, u + aside, 0.5 * (bracket.a + bracket.m), 0.5 * (bracket.m + bracket.b)]
    found = np.stack(inner, axis=1)
    for at_end, sign in ((bracket.a == bracket.m, 1.0), (bracket.b == bracket.m, -1.0)):
        shares = [bracket.m + sign * share * width for share in (*_FROM_AN_END, 0.85)]
        found = np.where(at_end[:, np.newaxis], np.stack(shares, axis=1), found)
    return np.clip(found, bracket.a[:, np.newaxis], bracket.b[:, np.newaxis])


def _sections(bracket: Brackets) -> np.ndarray:
    """New places for each bracket, (k, _PARTS): equally spaced on its lower side, and one beyond m."""
    after = bracket.at_b <= bracket.at_a
    step = np.where(after, bracket.b - bracket.m, bracket.a - bracket.m) / _PARTS
    found = bracket.m[:, np.newaxis] + step[:, np.newaxis] * np.array([-1, *range(1, _PARTS)])
    return np.clip(found, bracket.a[:, np.newaxis], bracket.b[:, np.newaxis])


def _narrowed(bracket: Brackets, places: np.ndarray, values: np.ndarray) -> Brackets:
    """The largest of the old and new places of each bracket, and its neighbours."""
    x = np.column_stack((bracket.a, bracket.m, bracket.b, places))
    f = np.column_stack((bracket.at_a, bracket.at_m, bracket.at_b, values))
    order = np.argsort(x, axis=1, kind="stable")
    x, f = np.take_along_axis(x, order, axis=1), np.take_along_axis(f, order, axis=1)
    rows, best = np.arange(len(x)), np.argmax(f, axis=1)
    before, after = best.copy(), best.copy()
    for _ in range(x.shape[1]):  # equal places are one
        before = np.where((before > 0) & (x[rows, before] == x[rows, best]), before - 1, before)
        after = np.where((after < x.shape[1] - 1) & (x[rows, after] == x[rows, best]), after + 1, after)
    return Brackets(
        x[rows, before], x[rows, best], x[rows, after], f[rows, before], f[rows, best], f[rows, after]
    )


def open_brackets(bracket: Brackets, alike: float = _ALIKE) -> np.ndarray:
    """Indices of the brackets whose maximum is not known yet."""
    finite = np.isfinite(bracket.at_m)
    low = np.minimum(bracket.at_a, bracket.at_b)
    with np.errstate(invalid="ignore"):
        apart = bracket.at_m - low > alike * np.abs(bracket.at_m)
    wide = bracket.b - bracket.a > _NARROW * np.abs(bracket.m)
    return np.flatnonzero(finite & apart & wide)


def _at_a_jump(bracket: Brackets, alike: float = _ALIKE) -> np.ndarray:
    """Whether the largest value lies next to a jump, and equals one just as far away on the other side."""
    left, right = bracket.m - bracket.a, bracket.b - bracket.m
    after = bracket.at_b <= bracket.at_a
    higher = np.maximum(bracket.at_a, bracket.at_b)
    near, beyond = np.where(after, left, right), np.where(after, right, left)
    with np.errstate(invalid="ignore"):
        return (bracket.at_m - higher <= alike * np.abs(bracket.at_m)) & (beyond > 0.0) & (beyond <= near)


def _is_outdone(bracket: Brackets, group: np.ndarray) -> np.ndarray:
    """Whether a maximum stays below the largest one of its group, (k,).

    It may rise by what it has risen over its higher neighbour, here taken `_RISE` times.
    """
    largest = np.full(int(group.max(initial=-1)) + 1, -np.inf)
    np.maximum.at(largest, group, bracket.at_m)
    with np.errstate(invalid="ignore"):
        rise = bracket.at_m - np.maximum(bracket.at_a, bracket.at_b)
        return bracket.at_m + _RISE * rise < largest[group]


def refine_maxima(
    functions: Functions, bracket: Brackets, group: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Places and values of the maxima in brackets, function k in bracket k.

    A value that is NaN is never the largest; one that is infinite is left as it is.  With `group` (k,) only
    the largest maximum of every group is wanted: others are left where it is clear that they are lower.
    """
    bracket = Brackets(*(array.copy() for array in bracket))
    for count in range(_ROUNDS):
        which = open_brackets(bracket)
        if count > _SMOOTH_ROUNDS:
            which = which[~_at_a_jump(chosen(bracket, which))]
        if group is not None:
            which = which[~_is_outdone(bracket, group)[which]]
        if not which.size:
            break
        part = chosen(bracket, which)
        places = _proposals(part) if count < _SMOOTH_ROUNDS else _sections(part)
        values = functions(np.repeat(which, places.shape[1]), places.ravel()).reshape(places.shape)
        narrow = _narrowed(part, places, np.where(np.isnan(values), -np.inf, values))
        for array, new in zip(bracket, narrow, strict=True):
            array[which] = new
    return bracket.m, bracket.at_m

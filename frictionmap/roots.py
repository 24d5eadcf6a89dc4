"""Roots of functions with known poles: samples close to poles, looks into dips, and the Illinois method."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

_EPS = float(np.finfo(float).eps)

#: Between two poles a change of sign is looked for at these shares of the way: ever closer to the poles,
#: where a mode of little weight bends the sum only at its own.
_NEAR = 0.25 ** np.arange(1.0, 16.0)
_SHARES = np.unique(np.concatenate((_NEAR, 1.0 - _NEAR, np.arange(1.0, 16.0) / 16.0)))

#: A dip that may hold two roots is sampled at so many places, and again between the neighbours of the least,
#: until its samples are alike but for this share of the least, and at most until it is as narrow as rounding
#: lets a pair be, half of the digits.
_DIP_SAMPLES = 9
_DIP_ALIKE = 0.25
_DIP_ROUNDS = 12

#: Roots of two functions that differ by less of their size are one: sums that cancel round off some digits.
_ONE_ROOT = 1e-11

#: Steps to a root at most: every third is a halving, and no interval is halved more often than a double's
#: bits allow.
_STEPS = 200


class FrequencyRange(NamedTuple):
    """A stretch of frequencies, and where in it the sums over modes turn sharply."""

    low: float
    high: float
    edges: np.ndarray  # increasing, strictly inside
    poles: np.ndarray  # of the edges, those where a sum may be infinite


def with_poles(where: FrequencyRange, poles: np.ndarray) -> FrequencyRange:
    """The same stretch with more poles in it."""
    inside = poles[(poles > where.low) & (poles < where.high)]
    return where._replace(edges=np.union1d(where.edges, inside), poles=np.union1d(where.poles, inside))


def polish(
    f: Callable[[np.ndarray, np.ndarray], np.ndarray],
    which: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    at_low: np.ndarray,
    at_high: np.ndarray,
) -> np.ndarray:
    """Roots of the functions `which` between low and high, all (n_roots,), to two units of rounding.

    The Illinois method: false position, where the value at an end that stays twice is halved; every third
    step is a bisection, which bounds their number.
    """
    root = high.copy()
    left = np.arange(low.size)
    stayed = np.zeros(low.size)  # which end did: -1 low, 1 high
    for step in range(_STEPS):
        least = 2.0 * _EPS * high
        open_ = (high - low > 2.0 * least) & (at_high != 0.0)
        root[left] = np.where(open_, root[left], high)
        left, which, low, high, at_low, at_high, least, stayed = (
            part[open_] for part in (left, which, low, high, at_low, at_high, least, stayed)
        )
        if left.size == 0:
            break
        if step % 3 == 2:
            new = 0.5 * (low + high)
        else:
            new = np.clip(low + (high - low) * (at_low / (at_low - at_high)), low + least, high - least)
        value = f(new, which)
        moves_low = value * np.sign(at_low) > 0.0
        low, high = np.where(moves_low, new, low), np.where(moves_low, high, new)
        at_high = np.where(moves_low, np.where(stayed > 0.0, 0.5 * at_high, at_high), value)
        at_low = np.where(moves_low, value, np.where(stayed < 0.0, 0.5 * at_low, at_low))
        stayed = np.where(moves_low, 1.0, -1.0)
    return root


class _Brackets(NamedTuple):
    """Intervals between which functions `which` change their sign; arrays of one size."""

    which: np.ndarray
    low: np.ndarray
    high: np.ndarray
    at_low: np.ndarray
    at_high: np.ndarray


def _dips(r: np.ndarray, values: np.ndarray, cut: np.ndarray) -> _Brackets:
    """Samples that are nearer to zero than those beside them and of their sign: (r of) both these neighbours.

    cut : (n_r + 1,) bool, whether the sample before, or the end of all, is beyond a pole
    """
    size, sign = np.abs(values), np.sign(values)
    start, end = cut[:-1, np.newaxis], cut[1:, np.newaxis]
    before, after = np.roll(size, 1, axis=0), np.roll(size, -1, axis=0)
    same = (start | (np.roll(sign, 1, axis=0) == sign)) & (end | (np.roll(sign, -1, axis=0) == sign))
    lowest = (start | (size <= before)) & (end | (size < after))
    k, which = np.nonzero(same & lowest & (sign != 0.0))
    low, high = np.where(cut[k], k, k - 1), np.where(cut[k + 1], k, k + 1)
    return _Brackets(which, r[low], r[high], values[low, which], values[high, which])


def _pairs(f: Callable[..., np.ndarray], dips: _Brackets) -> _Brackets:
    """Changes of sign within dips, two a dip that has any."""
    which, low, high, side = dips.which, dips.low, dips.high, np.sign(dips.at_low)
    share = np.linspace(0.0, 1.0, _DIP_SAMPLES + 2)
    found = []
    for _ in range(_DIP_ROUNDS):
        if which.size == 0:
            break
        nodes = low[:, np.newaxis] + (high - low)[:, np.newaxis] * share
        inside = f(nodes.ravel(), np.repeat(which, share.size)).reshape(nodes.shape)
        depth = inside * side[:, np.newaxis]
        rows, least = np.arange(which.size), np.argmin(depth, axis=1)
        across = depth[rows, least] < 0.0
        for one, other in ((np.zeros_like(least), least), (least, np.full_like(least, share.size - 1))):
            ends = [part[rows, at][across] for part in (nodes, inside) for at in (one, other)]
            found.append(_Brackets(which[across], *ends))
        open_ = ~across & (np.ptp(depth, axis=1) > _DIP_ALIKE * depth[rows, least])
        low = nodes[rows, np.maximum(least - 1, 0)][open_]
        high = nodes[rows, np.minimum(least + 1, share.size - 1)][open_]
        which, side = which[open_], side[open_]
    return _joined(found)


def _joined(brackets: list[_Brackets]) -> _Brackets:
    if not brackets:
        return _Brackets(np.empty(0, dtype=np.intp), *np.empty((4, 0)))
    return _Brackets(*(np.concatenate(part) for part in zip(*brackets, strict=True)))


def find_roots(f: Callable[..., np.ndarray], where: FrequencyRange) -> list[np.ndarray]:
    """Roots of several functions, all that sampling and a look into every dip of it can find.

    f(r) returns the values of all functions, (n_r, n_functions); f(r, which) those of one a frequency,
    (n_r,).
    """
    edges = np.concatenate(([where.low], where.edges, [where.high]))
    r = np.unique(edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * _SHARES)
    r = r[~np.isin(r, where.poles)]  # a narrow stretch has samples that round to its ends
    values = f(r)
    sign = np.sign(values)
    cut = np.searchsorted(where.poles, r[1:]) != np.searchsorted(where.poles, r[:-1])
    k, which = np.nonzero((sign[1:] * sign[:-1] < 0.0) & ~cut[:, np.newaxis])
    changes = _Brackets(which, r[k], r[k + 1], values[k, which], values[k + 1, which])
    brackets = _joined([changes, _pairs(f, _dips(r, values, np.concatenate(([True], cut, [True]))))])
    found = polish(f, *brackets)
    exact = (sign == 0.0) & (values != 0.0).any(axis=0)  # not of a function that is zero everywhere
    return [
        np.unique(np.concatenate((found[brackets.which == j], r[exact[:, j]])))
        for j in range(values.shape[1])
    ]


def union(*roots: np.ndarray) -> np.ndarray:
    """Roots of several functions, increasing, each once."""
    every = np.sort(np.concatenate(roots))
    return every[np.diff(every, prepend=-np.inf) > _ONE_ROOT * every]


def without(roots: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Roots that are none of the others."""
    apart = np.abs(roots[:, np.newaxis] - others) > _ONE_ROOT * roots[:, np.newaxis]
    return roots[apart.all(axis=1)]


def shaped(values: np.ndarray, which: np.ndarray | None) -> np.ndarray:
    """Values (n_r,) of all functions alike, as `find_roots` wants them."""
    return values[:, np.newaxis] if which is None else values

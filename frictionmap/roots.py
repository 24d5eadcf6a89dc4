"""Roots of functions with known poles: samples close to poles, search of dips, and the Illinois method."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

_EPS = float(np.finfo(float).eps)

#: Positions of the samples between two poles, as shares of the distance: increasingly dense towards the
#: poles, since a mode of little weight affects the sum only close to its own pole.
_NEAR = 0.25 ** np.arange(1.0, 16.0)
_SHARES = np.unique(np.concatenate((_NEAR, 1.0 - _NEAR, np.arange(1.0, 16.0) / 16.0)))

#: A dip that may hold two roots is sampled at `_DIP_SAMPLES` points, and again between the neighbours of the
#: smallest sample, until the samples differ by less than `_DIP_ALIKE` of the smallest, for at most
#: `_DIP_ROUNDS` rounds; the dip is then as narrow as a pair of roots that rounding can separate, half of the
#: digits.
_DIP_SAMPLES = 9
_DIP_ALIKE = 0.25
_DIP_ROUNDS = 12

#: Relative distance below which roots of two functions coincide; cancellation in the sums costs some digits.
_ONE_ROOT = 1e-11

#: Largest number of steps to a root: every third is a bisection, and an interval can be halved only as often
#: as a double has bits.
_STEPS = 200


class FrequencyRange(NamedTuple):
    """A range of frequencies, and where in it sums over modes change sharply."""

    low: float
    high: float
    edges: np.ndarray  # increasing, strictly inside
    poles: np.ndarray  # of the edges, those where a sum may be infinite


def with_poles(where: FrequencyRange, poles: np.ndarray) -> FrequencyRange:
    """Add poles to a range."""
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
    """Refine roots of the functions `which` between low and high, all (n_roots,), to two units of rounding.

    The Illinois method is false position in which the value at an end that is retained twice is halved; every
    third step is a bisection, which bounds the number of steps.
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


class Brackets(NamedTuple):
    """Intervals in which functions `which` change sign; arrays of equal size."""

    which: np.ndarray
    low: np.ndarray
    high: np.ndarray
    at_low: np.ndarray
    at_high: np.ndarray


def _dips(r: np.ndarray, values: np.ndarray, cut: np.ndarray) -> Brackets:
    """Samples closer to zero than their neighbours of equal sign, with the frequencies of both neighbours.

    cut : (n_r + 1,) bool, whether a pole, or an end of the range, precedes the sample
    """
    size, sign = np.abs(values), np.sign(values)
    start, end = cut[:-1, np.newaxis], cut[1:, np.newaxis]
    before, after = np.roll(size, 1, axis=0), np.roll(size, -1, axis=0)
    same = (start | (np.roll(sign, 1, axis=0) == sign)) & (end | (np.roll(sign, -1, axis=0) == sign))
    lowest = (start | (size <= before)) & (end | (size < after))
    k, which = np.nonzero(same & lowest & (sign != 0.0))
    low, high = np.where(cut[k], k, k - 1), np.where(cut[k + 1], k, k + 1)
    return Brackets(which, r[low], r[high], values[low, which], values[high, which])


def _pairs(f: Callable[..., np.ndarray], dips: Brackets) -> Brackets:
    """Sign changes within dips, two for each dip that has any."""
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
            found.append(Brackets(which[across], *ends))
        open_ = ~across & (np.ptp(depth, axis=1) > _DIP_ALIKE * depth[rows, least])
        low = nodes[rows, np.maximum(least - 1, 0)][open_]
        high = nodes[rows, np.minimum(least + 1, share.size - 1)][open_]
        which, side = which[open_], side[open_]
    return _joined(found)


def _joined(brackets: list[Brackets]) -> Brackets:
    if not brackets:
        return Brackets(np.empty(0, dtype=np.intp), *np.empty((4, 0)))
    return Brackets(*(np.concatenate(part) for part in zip(*brackets, strict=True)))


def find_roots(f: Callable[..., np.ndarray], where: FrequencyRange) -> list[np.ndarray]:
    """Find the roots of several functions that sampling, and examining each dip of the samples, can reveal.

    f(r) returns the values of all functions, (n_r, n_functions); f(r, which) those of one function per
    frequency, (n_r,).
    """
    edges = np.concatenate(([where.low], where.edges, [where.high]))
    r = np.unique(edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * _SHARES)
    r = r[~np.isin(r, where.poles)]  # samples of a narrow interval may round to its ends
    values = f(r)
    sign = np.sign(values)
    cut = np.searchsorted(where.poles, r[1:]) != np.searchsorted(where.poles, r[:-1])
    k, which = np.nonzero((sign[1:] * sign[:-1] < 0.0) & ~cut[:, np.newaxis])
    changes = Brackets(which, r[k], r[k + 1], values[k, which], values[k + 1, which])
    brackets = _joined([changes, _pairs(f, _dips(r, values, np.concatenate(([True], cut, [True]))))])
    found = polish(f, *brackets)
    exact = (sign == 0.0) & (values != 0.0).any(axis=0)  # excludes functions that are zero everywhere
    return [
        np.unique(np.concatenate((found[brackets.which == j], r[exact[:, j]])))
        for j in range(values.shape[1])
    ]


def union(*roots: np.ndarray) -> np.ndarray:
    """Merge roots of several functions, increasing, each root once."""
    every = np.sort(np.concatenate(roots))
    return every[np.diff(every, prepend=-np.inf) > _ONE_ROOT * every]


def without(roots: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Roots that are not among the others."""
    apart = np.abs(roots[:, np.newaxis] - others) > _ONE_ROOT * roots[:, np.newaxis]
    return roots[apart.all(axis=1)]


def shaped(values: np.ndarray, which: np.ndarray | None) -> np.ndarray:
    """Arrange values (n_r,) as `find_roots` requires for a single function."""
    return values[:, np.newaxis] if which is None else values

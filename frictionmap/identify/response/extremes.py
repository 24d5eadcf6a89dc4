"""Extremes between samples: where sampled functions come nearest to zero without a change of sign.

A function that rises and comes back passes zero twice, or not at all, where samples beside its extreme are
all of one sign.  Only these are looked at more closely.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Samples between the neighbours of the least one, and rounds of them: each round leaves a fifth, all of them
#: 1e-7 of what they began with, within which an extreme changes by less than a double can hold.
_SAMPLES, _ROUNDS = 9, 10

#: Samples around an extreme that are alike except for this share of the least are too far away from
#: zero to pass it.
_ALIKE = 0.25


class Extremes(NamedTuple):
    """Extremes on the way to zero of functions `which`; arrays of one size."""

    which: np.ndarray
    low: np.ndarray  # the sample before it, or the first one
    high: np.ndarray  # the sample behind it, or the last one
    at_low: np.ndarray
    at_high: np.ndarray
    place: np.ndarray
    value: np.ndarray  # of the other sign than the samples if the function passes zero

    @property
    def crossed(self) -> np.ndarray:
        """Whether the function passes zero on either side of its extreme, bool."""
        return self.value * np.where(self.at_low != 0.0, self.at_low, self.at_high) < 0.0


def extremes_near_zero(
    f: Callable[[np.ndarray, np.ndarray], np.ndarray], x: np.ndarray, values: np.ndarray, far: bool = False
) -> Extremes:
    """Refine samples that are nearer to zero than their neighbours and of their sign, the ends included.

    f : values of the functions `which` at places, (k,) each
    x, values : (samples, functions), increasing places of each function and its values
    far : whether extremes that stay far from zero are refined as well
    """
    k, which = np.nonzero(_dips(values))
    before, behind = np.maximum(k - 1, 0), np.minimum(k + 1, x.shape[0] - 1)
    low, high, place, value = x[before, which], x[behind, which], x[k, which].copy(), values[k, which].copy()
    found = Extremes(which, low, high, values[before, which], values[behind, which], place, value)
    side, open_ = np.sign(value), np.arange(which.size)
    shares = np.linspace(0.0, 1.0, _SAMPLES + 2)
    for _ in range(_ROUNDS):
        if not open_.size:
            break
        places = low[:, np.newaxis] + (high - low)[:, np.newaxis] * shares
        looked = f(places.ravel(), np.repeat(which[open_], shares.size)).reshape(places.shape)
        depth = np.where(np.isnan(looked), np.inf, looked * side[open_, np.newaxis])
        rows, least = np.arange(open_.size), depth.argmin(axis=1)
        nearer = depth[rows, least] < (value * side)[open_]
        place[open_[nearer]] = places[rows, least][nearer]
        value[open_[nearer]] = looked[rows, least][nearer]
        on = far | (np.ptp(depth, axis=1) > _ALIKE * depth[rows, least])
        low = places[rows, np.maximum(least - 1, 0)][on]
        high = places[rows, np.minimum(least + 1, shares.size - 1)][on]
        open_ = open_[on]
    return found


def _dips(values: np.ndarray) -> np.ndarray:
    """Samples nearer to zero than both neighbours, and of their sign; an end has one neighbour only."""
    size, sign = np.abs(values), np.sign(values)
    found = sign != 0.0
    found[1:] &= (sign[1:] == sign[:-1]) & (size[1:] <= size[:-1])
    found[:-1] &= (sign[:-1] == sign[1:]) & (size[:-1] < size[1:])
    return found

"""Search on both sides of samples for resonances and standstills, which a fit without damping cannot cross.

A place near a sample has nearly the same amplitude there as its mirror image on the other side.
"""

from collections.abc import Iterator

import numpy as np

from ..statistics.least_squares import Problem, Solution, minimise
from .inverse import chain_of
from .response import modes

#: A sum of squares is less if it is by more than this share.
_LESS = 1e-4


def other_sides(task: Problem, found: Solution, f: np.ndarray, n: int) -> list[Solution]:
    """Minima with every resonance and standstill of mass 1 on either side of the sample next to it.

    f : frequencies at which mass 1 was measured, increasing

    Returns
    -------
    list of Solution
        By their sums, `found` among them: where a sample is very near, both sides may be as good.
    """
    best, minima, again = found, [found], True
    while again:
        tried = [
            minimise(task, np.where(task.free, start, best.values)) for start in _mirrored(best.values, f, n)
        ]
        minima = sorted([*minima, *tried], key=lambda one: one.sum)
        again = minima[0].sum < best.sum * (1.0 - _LESS)
        best = minima[0]
    return minima


def standstills(values: np.ndarray, n: int) -> np.ndarray:
    """Frequencies at which mass 1 stands still, (n - 1,) Hz: the natural ones of the others with it held."""
    f_k1m1 = float(np.exp(values[0]))
    masses, springs = np.exp(values[1:n]), np.exp(values[n : 2 * n - 1])
    stretches = np.eye(n - 1) - np.eye(n - 1, k=-1)
    stiffness = stretches.T @ (springs[:, np.newaxis] * stretches)
    scaled = stiffness / np.sqrt(np.outer(masses, masses))
    return np.asarray(f_k1m1 * np.sqrt(np.linalg.eigvalsh(scaled)))


def _mirrored(values: np.ndarray, f: np.ndarray, n: int) -> Iterator[np.ndarray]:
    """Chains with one of the places on the other side of the sample nearest to it."""
    places = np.empty(2 * n - 1)
    places[::2], places[1::2] = modes(values).frequencies, standstills(values, n)
    for k, place in enumerate(places):
        other = places.copy()
        other[k] = 2.0 * f[np.abs(f - place).argmin()] - place
        if other[0] > 0.0 and (np.diff(other) > 0.0).all():
            start = values.copy()
            start[: 2 * n - 1] = chain_of(other[::2], other[1::2])
            yield start

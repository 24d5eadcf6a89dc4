"""Masses that do not move because rigid contacts with walls at rest hold them."""

import numpy as np

from .. import regimes
from ..model.general import ContactSystem, rank_of

#: Part of a vector outside the span of others, over its length, that is rounding error.
_ROUNDING = 1e-12

#: Displacement of a mass at rest, over the largest in its cell, that is rounding error of sums over modes.
_AT_ZERO = 2.0**-44


def still_masses(general: ContactSystem, rests: np.ndarray) -> np.ndarray:
    """Whether each mass is at rest if some contacts are, (n,) bool.

    rests : (N,) bool
    """
    holding = rests & ~general.elastic & np.array([not group.base for group in general.groups])
    vectors, points = general.vectors[holding], general.points
    n = general.vectors.shape[1]
    rows = np.eye(n) if points is None else points.shapes
    if points is not None and general.base:  # modes are relative to the base, which carries points, too
        vectors = np.column_stack((vectors, (points.vectors @ points.carried)[holding]))
        rows = np.column_stack((rows, points.carried))
    if not len(vectors):
        return np.zeros(len(rows), dtype=bool)
    # contacts that close loops span fewer directions than they are
    span = np.linalg.svd(vectors.T, full_matrices=False)[0][:, : rank_of(vectors)]
    if points is None:
        return np.asarray(np.linalg.norm(rows - span @ span.T, axis=0) <= _ROUNDING)
    rest = np.linalg.norm(rows - rows @ span @ span.T, axis=1)
    return np.asarray(rest <= _ROUNDING * np.linalg.norm(rows, axis=1))


def put_still(
    general: ContactSystem, contact_regime: np.ndarray, lowest: np.ndarray, highest: np.ndarray
) -> None:
    """Take the rounding errors from the displacements of masses that are at rest.

    contact_regime : (..., N)
    lowest, highest : (..., N + n) and more, changed
    """
    count = general.count
    rests = contact_regime == regimes.PERMANENT_STICKING
    for pattern in np.unique(rests.reshape(-1, count), axis=0):
        masses = np.flatnonzero(still_masses(general, pattern)) + count
        if not masses.size:
            continue
        cells = np.nonzero((rests == pattern).all(axis=-1))
        low, high = lowest[cells], highest[cells]
        with np.errstate(invalid="ignore"):  # infinite at a resonance of the held structure
            middle = 0.5 * (low + high)[:, masses]
        largest = np.maximum(np.abs(low), np.abs(high)).max(axis=1, keepdims=True)
        middle = np.where(np.abs(middle) <= _AT_ZERO * largest, 0.0, middle)
        low[:, masses] = high[:, masses] = middle
        lowest[cells], highest[cells] = low, high

"""Steady sliding of any structure: growth of small vibrations.

Time is counted over 1/omega_1; a slope of friction over speed times beta acts as the damping beta g' c c^T.
"""

from typing import NamedTuple

import numpy as np

from ..general.slopes import first_order

#: Real part of a root, over the largest root, that is rounding error.
_ROUNDING = 1e-13


class Growth(NamedTuple):
    """Fastest growing small vibration about steady sliding."""

    growth: float  # rate over omega_1; < 0: steady sliding is stable
    frequency: float  # over omega_1; 0 without oscillation


def growth_of_sliding(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, vectors: np.ndarray, slopes: np.ndarray
) -> Growth:
    """Growth rate and frequency of the fastest growing small vibration.

    Parameters
    ----------
    mass, damping, stiffness : (n, n)
    vectors : (N, n) the contacts' vectors c
    slopes : (N,) beta g'(v) of the contacts
    """
    roots = np.linalg.eigvals(vibrations(mass, damping, stiffness, vectors, slopes))
    fastest = roots[np.argmax(roots.real)]
    grows = abs(fastest.real) > _ROUNDING * np.abs(roots).max()
    return Growth(float(fastest.real) if grows else 0.0, float(abs(fastest.imag)))


def vibrations(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, vectors: np.ndarray, slopes: np.ndarray
) -> np.ndarray:
    """Matrix of small vibrations, of first order; see `growth_of_sliding`."""
    whole = damping + np.einsum("j,ja,jb->ab", slopes, vectors, vectors)
    return first_order(mass, whole, stiffness)

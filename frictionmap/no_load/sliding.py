"""Steady sliding of any structure: growth of small vibrations, and the slope of friction at which they grow.

Time is counted over 1/omega_1; a slope of friction over speed times beta acts as the damping beta g' c c^T.
"""

from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..general.slopes import SlopeLimits, first_order, limits_of

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


def slope_limit(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, vector: np.ndarray
) -> SlopeLimits:
    """Slope at which steady sliding on one contact loses stability, see `general.slopes`.

    Raises
    ------
    InputError
        A mode has no damping.
    """
    if not np.linalg.eigvals(first_order(mass, damping, stiffness)).real.max() < 0.0:
        raise InputError(
            "damping",
            "must act on every mode; got a mode without it, in which vibration grows under any falling slope",
        )
    return limits_of(mass, damping, stiffness, vector)

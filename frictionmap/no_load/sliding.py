"""Steady sliding of any structure: growth of small vibrations, and the slope of friction at which they grow.

Time is counted over 1/omega_1; a slope of friction over speed times beta acts as the damping beta g' c c^T.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eig

from ..errors import InputError

#: An eigenvalue lambda counts as imaginary if its real part is below this share of its modulus: a double root
#: splits by the square root of a rounding error.
_IMAGINARY = 1e-6


class Growth(NamedTuple):
    """Fastest growing small vibration about steady sliding."""

    growth: float  # rate over omega_1; < 0: steady sliding is stable
    frequency: float  # over omega_1; 0 without oscillation


class SlopeLimit(NamedTuple):
    """Falling slope of friction at which steady sliding loses stability."""

    beta_slope: float  # beta |g'|; infinite if none does
    frequency: float  # of the vibration there, over omega_1; NaN if there is none
    certificate: float  # beta |g'| below which every motion ends in steady sliding, for a contact (Q)


def _companion(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Matrix of the states x, x'."""
    n = mass.shape[0]
    low = -np.linalg.solve(mass, np.hstack((stiffness, damping)))
    return np.vstack((np.hstack((np.zeros((n, n)), np.eye(n))), low))


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
    whole = damping + np.einsum("j,ja,jb->ab", slopes, vectors, vectors)
    roots = np.linalg.eigvals(_companion(mass, whole, stiffness))
    fastest = roots[np.argmax(roots.real)]
    return Growth(float(fastest.real), float(abs(fastest.imag)))


def slope_limit(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, vector: np.ndarray
) -> SlopeLimit:
    """Slope at which steady sliding on one contact loses stability: 1/max{Y : Im Y = 0}.

    Y(o) = i o c^T (K - o^2 M + i o C)^-1 c.  Im Y = 0 where c^T (Z^-1 + conj Z^-1) c = 0, which is a
    quadratic eigenvalue problem with lambda = i o, so no frequency is missed.

    Raises
    ------
    InputError
        A mode has no damping.
    """
    if not np.linalg.eigvals(_companion(mass, damping, stiffness)).real.max() < 0.0:
        raise InputError(
            "damping",
            "must act on every mode; got a mode without it, in which vibration grows under any falling slope",
        )
    n = mass.shape[0]
    zero, edge = np.zeros((n, n)), vector[:, np.newaxis]
    corner = np.zeros((1, 1))
    blocks = ((stiffness, stiffness, 1.0), (damping, -damping, 0.0), (mass, mass, 0.0))
    two = [
        np.block([[a, zero, edge * s], [zero, b, edge * s], [edge.T * s, edge.T * s, corner]])
        for a, b, s in blocks
    ]
    size = 2 * n + 1
    left = np.block([[np.zeros((size, size)), np.eye(size)], [-two[0], -two[1]]])
    right = np.block([[np.eye(size), np.zeros((size, size))], [np.zeros((size, size)), two[2]]])
    found = eig(left, right, right=False)
    found = found[np.isfinite(found)]
    on_axis = found[(abs(found.real) <= _IMAGINARY * abs(found)) & (found.imag > 0.0)].imag
    values = [_rate(mass, damping, stiffness, vector, o) for o in on_axis]
    certificate = _certificate(damping, vector)
    if not values or max(values) <= 0.0:
        return SlopeLimit(np.inf, np.nan, certificate)
    best = int(np.argmax(values))
    return SlopeLimit(1.0 / values[best], float(on_axis[best]), certificate)


def _rate(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, vector: np.ndarray, o: float
) -> float:
    """Real part of Y at a frequency."""
    z = stiffness - o * o * mass + 1j * o * damping
    return float((1j * o * (vector @ np.linalg.solve(z, vector))).real)


def _certificate(damping: np.ndarray, vector: np.ndarray) -> float:
    """1/(c^T C^-1 c); 0 where C does not act on c alone."""
    if not np.linalg.eigvalsh(damping).min() > 0.0:
        return 0.0
    return float(1.0 / (vector @ np.linalg.solve(damping, vector)))

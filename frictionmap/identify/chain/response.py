"""Response of a chain of masses to a shaken base, without friction, and its derivatives.

With m_1 = k_1 = 1, stretches B x = x_i - x_{i-1}, the matrix A = M^{-1/2} B^T diag(kappa) B M^{-1/2} and its
modes Q diag(lambda) Q^T, r = f/f_k1m1:

    X_k/Y = sum over i of Q_ki Q_1i h_i/sqrt(gamma_k),   h = n/(lambda - r^2 + 2 i zeta sqrt(lambda) r)

where n = 1, or 1 + 2 i zeta r/sqrt(lambda) if dampers see the base.  A chain has no frequency twice, so that
Q' = Q S with S_ij = (Q^T A' Q)_ij/(lambda_j - lambda_i).

Unknowns are ln f_k1m1, ln gamma_2.., ln kappa_2.., zeta_1..: 3 n - 1 of n masses.
"""

from typing import NamedTuple

import numpy as np


class Modes(NamedTuple):
    """A chain and its modes."""

    f_k1m1: float  # Hz
    masses: np.ndarray  # gamma, shape (n,)
    springs: np.ndarray  # kappa, shape (n,)
    zeta: np.ndarray  # shape (n,)
    stretches: np.ndarray  # B M^{-1/2}, shape (n, n)
    squares: np.ndarray  # lambda, shape (n,), increasing
    shapes: np.ndarray  # Q, shape (n, n)

    @property
    def frequencies(self) -> np.ndarray:
        """Natural frequencies, Hz."""
        return self.f_k1m1 * np.sqrt(self.squares)


def modes(values: np.ndarray) -> Modes:
    """The chain with these unknowns, shape (3 n - 1,)."""
    n = (values.size + 1) // 3
    masses = np.exp(np.concatenate(([0.0], values[1:n])))
    springs = np.exp(np.concatenate(([0.0], values[n : 2 * n - 1])))
    stretches = (np.eye(n) - np.eye(n, k=-1)) / np.sqrt(masses)
    squares, shapes = np.linalg.eigh(stretches.T @ (springs[:, np.newaxis] * stretches))
    f_k1m1 = float(np.exp(values[0]))
    return Modes(f_k1m1, masses, springs, values[2 * n - 1 :], stretches, squares, shapes)


def response_and_slopes(
    values: np.ndarray, frequency: np.ndarray, base_damping: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """X_k/Y, shape (samples, n), and its derivatives by the unknowns, shape (samples, n, 3 n - 1).

    base_damping : whether dampers see the base, or the ground
    """
    chain = modes(values)
    n = chain.masses.size
    r = (frequency / chain.f_k1m1)[:, np.newaxis]
    h, by_square, by_ratio, by_zeta = _modal(chain.squares, chain.zeta, r, base_damping)
    seen = chain.shapes / np.sqrt(chain.masses)[:, np.newaxis]  # of mass k in mode i
    first = chain.shapes[0]
    response = (h * first) @ seen.T
    slopes = np.empty((*response.shape, values.size), dtype=complex)
    slopes[:, :, 0] = (-r * by_ratio * first) @ seen.T
    slopes[:, :, 2 * n - 1 :] = (by_zeta * first)[:, np.newaxis, :] * seen
    for place, change in enumerate(_changes(chain), start=1):
        turned = chain.shapes.T @ change @ chain.shapes
        gaps = chain.squares - chain.squares[:, np.newaxis]
        turn = np.divide(turned, gaps, out=np.zeros((n, n)), where=~np.eye(n, dtype=bool))
        shapes = chain.shapes @ turn
        slope = (by_square * np.diag(turned) * first + h * shapes[0]) @ seen.T
        slope += (h * first) @ (shapes / np.sqrt(chain.masses)[:, np.newaxis]).T
        if place < n:
            slope[:, place] -= 0.5 * response[:, place]
        slopes[:, :, place] = slope
    return response, slopes


def _changes(chain: Modes) -> list[np.ndarray]:
    """Derivatives of A by ln gamma_2.., ln kappa_2.., shape (n, n) each."""
    weighted = chain.springs[:, np.newaxis] * chain.stretches
    matrix = chain.stretches.T @ weighted
    changes = []
    for k in range(1, chain.masses.size):
        change = np.zeros_like(matrix)
        change[k] -= 0.5 * matrix[k]
        change[:, k] -= 0.5 * matrix[:, k]
        changes.append(change)
    return changes + [np.outer(chain.stretches[k], weighted[k]) for k in range(1, chain.masses.size)]


def _modal(
    squares: np.ndarray, zeta: np.ndarray, r: np.ndarray, base_damping: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """h, shape (samples, n), and its derivatives by lambda, r and zeta."""
    w = np.sqrt(squares)
    seen = float(base_damping)
    over = 1.0 / (squares - r**2 + 2j * zeta * w * r)
    h = (1.0 + 2j * seen * zeta * r / w) * over
    by_square = (-1j * seen * zeta * r / w**3 - h * (1.0 + 1j * zeta * r / w)) * over
    by_ratio = (2j * seen * zeta / w - h * (2j * zeta * w - 2.0 * r)) * over
    by_zeta = (2j * seen * r / w - h * 2j * w * r) * over
    return h, by_square, by_ratio, by_zeta

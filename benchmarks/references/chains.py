"""Chains of masses on a shaken base by M, K and C: response without friction, continuous motion with it.

r^2 M x'' + r C x' + K x + beta c sgn(z') = Re(p e^{i tau}),   z = c.x - b cos(tau),   m_1 = k_1 = Y = 1
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

#: Phases of half a period at which a continuous motion is checked.
_PHASES = 400


class Chain(NamedTuple):
    """Matrices, and the load of a base that moves by cos(tau)."""

    M: np.ndarray
    K: np.ndarray
    C: np.ndarray
    base_damping: bool  # whether dampers see the base

    def load(self, r: float) -> np.ndarray:
        """p, shape (n,)."""
        damper = 1j * r * self.base_damping * self.C
        return (self.K + damper) @ np.ones(self.K.shape[0])

    def response(self, r: float) -> np.ndarray:
        """X/Y without friction, shape (n,)."""
        return np.linalg.solve(self.K - r**2 * self.M + 1j * r * self.C, self.load(r))


def chain(
    masses: Sequence[float], springs: Sequence[float], zeta: Sequence[float], base_damping: bool
) -> Chain:
    """Build a chain from the ratios to mass 1 and spring 1, and the damping ratios of the modes."""
    n = len(masses)
    M = np.diag(np.asarray(masses, dtype=float))
    stretches = np.eye(n) - np.eye(n, k=-1)
    K = stretches.T @ np.diag(springs) @ stretches
    squares, shapes = eigh(K, M)
    momenta = M @ shapes
    C = momenta @ np.diag(2.0 * np.asarray(zeta) * np.sqrt(squares)) @ momenta.T
    return Chain(M, K, C, base_damping)


def continuous(structure: Chain, contact: int, wall_moves: bool, r: float, beta: float) -> np.ndarray | None:
    """First harmonics X/Y, shape (n,), of the continuous motion; None if there is none.

    From a maximum of z, z falls for half a period: (x, x') = s_c + Re(H e^{i (tau + phi)}) + e^{A tau} y,
    with s_c the static displacement under the constant friction force. The second half is the mirror image of
    the first: (e^{A pi} + 1) y = -2 s_c. z'(0) = 0 gives phi.

    contact : number of the mass that rubs, from 0, on the ground or on a wall that moves with the base
    """
    n = structure.K.shape[0]
    inverse = np.linalg.inv(structure.M)
    A = np.block([
        [np.zeros((n, n)), np.eye(n)],
        [-inverse @ structure.K / r**2, -inverse @ structure.C / r],
    ])  # fmt: skip
    rates, shapes = np.linalg.eig(A)
    back = np.linalg.inv(shapes)
    rest = np.concatenate((beta * np.linalg.inv(structure.K)[:, contact], np.zeros(n)))
    half = ((shapes * np.exp(np.pi * rates)) @ back).real
    y = np.linalg.solve(half + np.eye(2 * n), -2.0 * rest)
    driven = structure.response(r)
    along = driven[contact] - wall_moves
    sine = y[n + contact] / abs(along)
    if abs(sine) > 1.0:
        return None
    phi = np.arcsin(sine) - np.angle(along)
    tau = np.linspace(0.0, np.pi, _PHASES)[1:-1]
    free = np.exp(np.multiply.outer(tau, rates)) @ (shapes[n + contact] * (back @ y))
    if (free.real - abs(along) * np.sin(tau + phi + np.angle(along)) > 0.0).any():
        return None
    turn = np.linalg.solve(A - 1j * np.eye(2 * n), -(half + np.eye(2 * n)) @ y) + rest * 2.0 / 1j
    return driven + 2.0 / np.pi * np.exp(-1j * phi) * turn[:n]

"""The sliding structure as oscillators that friction pushes and does not strike.

A jump of friction is a jump of their accelerations alone, so that they scan as modes do.  Without coupling by
the damping they are the modes; with it their roots are taken two by two, and the motion in the contact is
``z = sum Z_i q_i + ZR_i q_i'`` of both coordinates and velocities, less the load's direct part.
"""

from typing import NamedTuple

import numpy as np

from .damped_oscillators import damped_oscillators


class FreeStructure(NamedTuple):
    """n oscillators q of n modes u that the contact sees, in time t = tau/r.

    omega, zeta : (n,) frequency and damping ratio
    push : (n,) what a force in the contact is on each
    to_modes : (2n, 2n) (u, u') of (q, p), p = q' less the load's direct part; an identity without coupling
    to_oscillators : (2n, 2n) the inverse
    joined : (j,) which of them are pairs of roots of modes that the damping couples
    """

    omega: np.ndarray
    zeta: np.ndarray
    push: np.ndarray
    to_modes: np.ndarray
    to_oscillators: np.ndarray
    coupled_indices: np.ndarray

    @property
    def coupled(self) -> bool:
        """Whether the damping couples any modes."""
        return self.coupled_indices.size > 0

    def compliances(self, rows: np.ndarray) -> np.ndarray:
        """The answers of sums of modes to friction by those of the oscillators: weights of h_i and R_i h_i'.

        rows : (k, n) of the modes
        Returns (k, n + j), of the h_i and of the joined ones' R_i h_i', R_i = r/w_i: they do not depend on r
        """
        share = self.push / self.omega**2
        if not self.coupled:
            return rows * share
        n, coupled = self.omega.size, self.coupled_indices
        both = rows @ self.to_modes[:n]
        return np.hstack((both[:, :n] * share, both[:, n + coupled] * (share * self.omega)[coupled]))

    def weights(self, chi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The answer of z to friction by those of the oscillators, h = sum a_i h_i + b_i r h_i'.

        a, b : (n,), of unit static answers h_i; chi_i^2/w_i^2 and 0 without coupling
        """
        if not self.coupled:
            return (self.push / self.omega) ** 2, np.zeros_like(self.push)
        n = chi.size
        rows = chi @ self.to_modes[:n]
        share = self.push / self.omega**2
        return rows[:n] * share, rows[n:] * share

    def norm(self, w: np.ndarray) -> float:
        """The most that sqrt(sum w^2 u^2 + u'^2), of modes, is over that of the oscillators."""
        if not self.coupled:
            return 1.0
        one, own = np.ones_like(w), np.concatenate((self.omega, np.ones_like(w)))
        return float(np.linalg.norm(np.concatenate((w, one))[:, np.newaxis] * self.to_modes / own, 2))


def modal_structure(w: np.ndarray, zeta: np.ndarray, chi: np.ndarray) -> FreeStructure:
    """That of modes that the damping does not couple."""
    same = np.eye(2 * w.size)
    return FreeStructure(w, zeta, chi, same, same, np.zeros(0, dtype=int))


def coupled_structure(
    w: np.ndarray, zeta: np.ndarray, coupling: np.ndarray, chi: np.ndarray
) -> FreeStructure:
    """That of modes between which the damping has `coupling` (n, n), with zeros on the diagonal.

    A mode that it leaves alone stays an oscillator as it is.
    Raises InputError as `damped_oscillators`.
    """
    free = modal_structure(w, zeta, chi)
    coupled = np.flatnonzero(coupling.any(axis=1))
    damping = np.diag(2.0 * zeta * w)[np.ix_(coupled, coupled)] + coupling[np.ix_(coupled, coupled)]
    part = damped_oscillators(np.diag(w[coupled]), damping, "structure one", chi[coupled])
    both = np.concatenate((coupled, w.size + coupled))
    to_modes, to_oscillators = free.to_modes.copy(), free.to_oscillators.copy()
    to_modes[np.ix_(both, both)] = part.to_coordinates
    to_oscillators[np.ix_(both, both)] = part.to_oscillators
    omega, ratio, push = free.omega.copy(), free.zeta.copy(), free.push.copy()
    omega[coupled], ratio[coupled], push[coupled] = part.omega, part.zeta, part.push
    return FreeStructure(omega, ratio, push, to_modes, to_oscillators, coupled)

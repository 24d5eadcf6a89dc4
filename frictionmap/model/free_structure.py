"""The sliding structure as oscillators whose velocities friction never changes abruptly.

A jump of the friction force changes their accelerations only, so that they can be scanned like modes.
Without coupling by the damping they are the modes.  With coupling their characteristic roots are taken in
pairs, and the motion in the contact, ``z = sum Z_i q_i + ZR_i q_i'``, depends on coordinates and velocities,
less the direct feedthrough of the load.
"""

from typing import NamedTuple

import numpy as np

from .damped_oscillators import damped_oscillators


class FreeStructure(NamedTuple):
    """The n participating modes u as n oscillators q, in time t = tau/r.

    omega, zeta : (n,) frequency and damping ratio
    push : (n,) modal load of a unit force in the contact
    to_modes : (2n, 2n) maps (q, p) to (u, u'), p = q' less the feedthrough of the load; an identity without
    coupling
    to_oscillators : (2n, 2n) the inverse
    coupled_indices : (j,) the oscillators that are pairs of roots of coupled modes
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
        """Response of sums of modes to friction in terms of the oscillators: weights of h_i and R_i h_i'.

        rows : (k, n) coefficients of the modes
        Returns (k, n + j), for the h_i and for R_i h_i' of the coupled oscillators, R_i = r/w_i; independent
        of r
        """
        share = self.push / self.omega**2
        if not self.coupled:
            return rows * share
        n, coupled = self.omega.size, self.coupled_indices
        both = rows @ self.to_modes[:n]
        return np.hstack((both[:, :n] * share, both[:, n + coupled] * (share * self.omega)[coupled]))

    def weights(self, chi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Response of z to friction in terms of the oscillators, h = sum a_i h_i + b_i r h_i'.

        a, b : (n,), for unit static responses h_i; chi_i^2/w_i^2 and 0 without coupling
        """
        if not self.coupled:
            return (self.push / self.omega) ** 2, np.zeros_like(self.push)
        n = chi.size
        rows = chi @ self.to_modes[:n]
        share = self.push / self.omega**2
        return rows[:n] * share, rows[n:] * share

    def norm(self, w: np.ndarray) -> float:
        """Largest ratio of sqrt(sum w^2 u^2 + u'^2) over the modes to the same sum over the oscillators."""
        if not self.coupled:
            return 1.0
        one, own = np.ones_like(w), np.concatenate((self.omega, np.ones_like(w)))
        return float(np.linalg.norm(np.concatenate((w, one))[:, np.newaxis] * self.to_modes / own, 2))


def modal_structure(w: np.ndarray, zeta: np.ndarray, chi: np.ndarray) -> FreeStructure:
    """Free structure of modes that the damping does not couple."""
    same = np.eye(2 * w.size)
    return FreeStructure(w, zeta, chi, same, same, np.zeros(0, dtype=int))


def coupled_structure(
    w: np.ndarray, zeta: np.ndarray, coupling: np.ndarray, chi: np.ndarray
) -> FreeStructure:
    """Free structure of modes that the damping couples by `coupling` (n, n), with zeros on the diagonal.

    A mode that is not coupled remains an oscillator.
    Raises InputError as `damped_oscillators`.
    """
    free = modal_structure(w, zeta, chi)
    coupled = np.flatnonzero(coupling.any(axis=1))
    damping = np.diag(2.0 * zeta * w)[np.ix_(coupled, coupled)] + coupling[np.ix_(coupled, coupled)]
    part = damped_oscillators(np.diag(w[coupled]), damping, "structure", chi[coupled])
    both = np.concatenate((coupled, w.size + coupled))
    to_modes, to_oscillators = free.to_modes.copy(), free.to_oscillators.copy()
    to_modes[np.ix_(both, both)] = part.to_coordinates
    to_oscillators[np.ix_(both, both)] = part.to_oscillators
    omega, ratio, push = free.omega.copy(), free.zeta.copy(), free.push.copy()
    omega[coupled], ratio[coupled], push[coupled] = part.omega, part.zeta, part.push
    return FreeStructure(omega, ratio, push, to_modes, to_oscillators, coupled)

"""Modes of a structure, participation of contact and load, and the structure with its contact held."""

from dataclasses import dataclass

import numpy as np


def solve_modes(mass: np.ndarray, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies w (n,) and modes phi (n, n), one a column, with phi^T M phi = 1."""
    if mass.shape == (1, 1):
        return np.sqrt(stiffness[0] / mass[0]), 1.0 / np.sqrt(mass)
    from scipy.linalg import eigh  # not needed, and not loaded, for one mass

    squares, phi = eigh(stiffness, mass)
    return np.sqrt(squares), phi


def modal_damping(mass: np.ndarray, w: np.ndarray, phi: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """The matrix C1 with phi^T C1 phi = diag(2 zeta w)."""
    shaped = mass @ phi
    return (shaped * (2.0 * zeta * w)) @ shaped.T


@dataclass(frozen=True)
class ModalModel:
    """A structure in its modes; nothing here depends on r (theory.md 1).

    w, phi, zeta: natural frequencies (n,), modes (n, n) and damping ratios (n,); contact: c (n,);
    load: phasor p (n,); base_motion: s; mass, stiffness, damping: matrices (n, n), damping over r.
    """

    w: np.ndarray
    phi: np.ndarray
    zeta: np.ndarray
    contact: np.ndarray
    load: np.ndarray
    base_motion: int
    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray

    @property
    def chi(self) -> np.ndarray:
        """Participation of the contact, c.phi_i (n,)."""
        return self.contact @ self.phi

    @property
    def participation(self) -> np.ndarray:
        """Participation of the load, lambda_i = p.phi_i (n,), complex."""
        return self.load @ self.phi

    @property
    def inverse_mass(self) -> float:
        """1/m_eff of the contact."""
        return float(self.contact @ np.linalg.solve(self.mass, self.contact))

    def dynamic_stiffness(self, r: np.ndarray) -> np.ndarray:
        """w_i^2 - r^2 + 2 i zeta_i w_i r, shape (r.size, n), without cancellation at resonance."""
        r = np.asarray(r, dtype=float)[:, np.newaxis]
        return (self.w - r) * (self.w + r) + 2j * self.zeta * self.w * r

    def response(self, r: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """sum_i weights_i lambda_i/(w_i^2 - r^2 + 2 i zeta_i w_i r), complex (r.size,).

        Infinite at an undamped resonance that is both loaded and seen.
        """
        stiffness = self.dynamic_stiffness(r)
        part = weights * self.participation
        resonant = (stiffness == 0.0) & (part != 0.0)
        terms = np.where(part != 0.0, part, 0.0) / np.where(stiffness == 0.0, 1.0, stiffness)
        return np.where(resonant.any(axis=1), np.inf, np.where(resonant, 0.0, terms).sum(axis=1))

    def held_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor F of the force that holds the contact at z' = 0, theory.md 4; complex (r.size,).

        Infinite where the held structure resonates without damping.
        """
        n = self.w.size
        bordered = np.zeros((r.size, n + 1, n + 1), dtype=complex)
        bordered[:, :n, :n] = (
            self.stiffness
            - (r**2)[:, np.newaxis, np.newaxis] * self.mass
            + 1j * r[:, np.newaxis, np.newaxis] * self.damping
        )
        bordered[:, :n, n] = self.contact
        bordered[:, n, :n] = self.contact
        right = np.append(self.load, complex(self.base_motion))
        held = np.empty(r.size, dtype=complex)
        for k in range(r.size):
            try:
                held[k] = np.linalg.solve(bordered[k], right)[n]
            except np.linalg.LinAlgError:
                held[k] = np.inf
        return held

    def held_frequencies(self) -> np.ndarray:
        """Natural frequencies of the undamped structure with its contact held, shape (n - 1,)."""
        n = self.w.size
        if n == 1:
            return np.empty(0)
        # an orthonormal basis of the motions that leave the contact alone: c.x = 0
        from scipy.linalg import eigh

        basis = np.linalg.svd(self.contact[np.newaxis])[2][1:].T
        squares = eigh(basis.T @ self.stiffness @ basis, basis.T @ self.mass @ basis, eigvals_only=True)
        return np.sqrt(squares)

"""The structure with its contact held, as a set of oscillators that do not depend on r.

With the contact held, chi.q = 0 in the free modes q.  Modal damping does not leave the held modes real: they
are `damped_oscillators`.
"""

from typing import NamedTuple

import numpy as np

from .damped_oscillators import damped_oscillators


class HeldStructure(NamedTuple):
    """m = n - 1 oscillators for n free modes that the contact sees; see the module.

    omega, zeta : (m,) frequency and damping ratio of every oscillator
    to_free : (2n, 2m) free coordinates (u, u') of (y, p), relative to the static shape
    to_held : (2m, 2n) the inverse on motions that leave the contact alone
    static_shape : (n,) free coordinates of a unit static displacement of the contact
    stiffness : static stiffness at the contact
    """

    omega: np.ndarray
    zeta: np.ndarray
    to_free: np.ndarray
    to_held: np.ndarray
    static_shape: np.ndarray
    stiffness: float


def held_structure(
    w: np.ndarray, zeta: np.ndarray, chi: np.ndarray, coupling: np.ndarray | None = None
) -> HeldStructure:
    """The held structure of free modes w, zeta (n,) with participation chi (n,), none of them 0.

    coupling : (n, n) what the damping has between the modes, 0 on the diagonal; then chi may have zeros

    Raises InputError where two held modes are nearly one with nearly the same shape (critically damped twice
    over): their motion cannot be told apart in double precision.
    """
    n = w.size
    m = n - 1
    compliance = float(np.sum((chi / w) ** 2))
    static_shape = chi / w**2 / compliance
    if m == 0:
        empty = np.empty(0)
        to_free, to_held = np.empty((2 * n, 0)), np.empty((0, 2 * n))
        return HeldStructure(empty, empty, to_free, to_held, static_shape, 1.0 / compliance)
    allowed = np.linalg.svd(chi[np.newaxis])[2][1:].T  # orthonormal, chi.allowed = 0
    stiffness = allowed.T @ (w[:, np.newaxis] ** 2 * allowed)
    if not zeta.any():
        squares, shapes = np.linalg.eigh(stiffness)
        zero = np.zeros_like(shapes)
        basis = np.block([[shapes, zero], [zero, shapes]])
        omega, ratio = np.sqrt(squares), np.zeros(m)
        inverse = basis.T
    else:
        damping = allowed.T @ ((2.0 * zeta * w)[:, np.newaxis] * allowed)
        if coupling is not None:
            damping += allowed.T @ coupling @ allowed
        root = np.linalg.cholesky(stiffness).T
        what = f"held structure one; got ratios {zeta.tolist()}"
        omega, ratio, basis, inverse, _ = damped_oscillators(root, damping, what)
    zero = np.zeros_like(allowed)
    spread = np.block([[allowed, zero], [zero, allowed]])
    return HeldStructure(omega, ratio, spread @ basis, inverse @ spread.T, static_shape, 1.0 / compliance)

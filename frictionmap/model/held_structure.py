"""The structure with its contact held, as a set of oscillators that do not depend on r.

With the contact held, chi.q = 0 in the free modes q.  Modal damping does not leave the held modes real, so
they come in pairs of roots s of the held structure, each pair one oscillator ``y'' + 2 zeta omega y' +
omega^2 y = load`` (over-damped and double roots included).  Its motion is ``u = A y + B p``, where p is y'
less the load's direct part.  In time t = tau/r nothing depends on r.
"""

from typing import NamedTuple

import numpy as np

from ..errors import InputError

#: Roots whose imaginary part is a smaller share of them than this are taken as a real subspace, which exists
#: for a double root too; eigenvectors do not.
_NEARLY_REAL = 1e-3

#: A basis of held motions worse conditioned than this would cost half of the digits.
_WORST_BASIS = 1e8


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


def _from_subspace(matrix: np.ndarray, pair: tuple[complex, complex]) -> np.ndarray:
    """Columns (a, b) of the motions a y + b y' in the invariant subspace of two real roots; (2m, 2)."""
    total, product = (pair[0] + pair[1]).real, (pair[0] * pair[1]).real
    polynomial = matrix @ matrix - total * matrix + product * np.eye(matrix.shape[0])
    basis = np.linalg.svd(polynomial)[2][-2:].T  # its null space
    inner = basis.T @ matrix @ basis
    best = None
    for row in (np.array([1.0, 0.0]), np.array([0.0, 1.0]), np.array([1.0, 1.0])):
        rows = np.array([row, row @ inner])
        condition = np.linalg.cond(rows)
        if best is None or condition < best[0]:
            best = (condition, rows)
    assert best is not None
    return basis @ np.linalg.inv(best[1]) if best[0] < 1.0 / np.finfo(float).eps else np.zeros_like(basis)


def _from_vector(vector: np.ndarray, root: complex) -> np.ndarray:
    """The same from a complex eigenvector: a + b root = vector."""
    b = vector.imag / root.imag
    return np.column_stack((vector.real - b * root.real, b))


def _pairings(roots: np.ndarray) -> list[list[tuple[complex, complex]]]:
    """Ways to pair nearly real roots: complex ones with their conjugates; real ones each with its nearest,
    which a double root needs, or slow with fast."""
    pairs = [(root, root.conjugate()) for root in roots if root.imag > 0.0]
    real = np.sort(roots[roots.imag == 0.0].real)
    half = real.size // 2
    left = list(real)
    near = []
    while left:
        gaps = np.diff(left) / np.abs(left[1:])
        k = int(np.argmin(np.abs(gaps)))
        near.append((complex(left.pop(k)), complex(left.pop(k))))
    far = [(complex(a), complex(b)) for a, b in zip(real[:half], real[half:], strict=True)]
    return [pairs + near, pairs + far]


def _basis(matrix: np.ndarray, pairs: list[tuple[complex, complex]], vectors: np.ndarray) -> np.ndarray:
    """All pairs' columns, (2m, 2m): those of y first, then those of p."""
    columns = [
        _from_vector(vectors[:, k], pair[0]) if vectors[:, k].any() else _from_subspace(matrix, pair)
        for k, pair in enumerate(pairs)
    ]
    # unit columns, so that the condition number says what rounding does
    sizes = [np.max(np.abs(c * [1.0, abs(p[0])])) or 1.0 for c, p in zip(columns, pairs, strict=True)]
    return np.array([c[:, j] / s for j in range(2) for c, s in zip(columns, sizes, strict=True)]).T


def held_structure(w: np.ndarray, zeta: np.ndarray, chi: np.ndarray) -> HeldStructure:
    """The held structure of free modes w, zeta (n,) with participation chi (n,), none of them 0.

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
        # in (R u, u') with R^T R the stiffness: nearly normal for little damping
        root = np.linalg.cholesky(stiffness).T
        zero = np.zeros((m, m))
        matrix = np.block([[zero, root], [-root.T, -damping]])
        values, vectors = np.linalg.eig(matrix)
        upper = np.flatnonzero(values.imag > _NEARLY_REAL * np.abs(values))
        oscillating = [(values[k], values[k].conjugate()) for k in upper]
        others = values[np.abs(values.imag) <= _NEARLY_REAL * np.abs(values)]
        choices = [oscillating + pairs for pairs in _pairings(others)] if others.size else [oscillating]
        known = np.zeros((2 * m, m), dtype=complex)
        known[:, : upper.size] = vectors[:, upper]
        bases = [_basis(matrix, pairs, known) for pairs in choices]
        conditions = [np.linalg.cond(b) for b in bases]
        k = int(np.argmin(conditions))
        if not conditions[k] < _WORST_BASIS:
            raise InputError(
                f"the damping must not make two modes of the held structure one; got ratios {zeta.tolist()}, "
                f"which leave a basis of condition number {conditions[k]:.1e}: change one of them a little"
            )
        pairs = choices[k]
        omega = np.sqrt(np.array([(a * b).real for a, b in pairs]))
        ratio = -0.5 * np.array([(a + b).real for a, b in pairs]) / omega
        scaled = np.linalg.inv(bases[k])
        unscale = np.block([[np.linalg.inv(root), zero], [zero, np.eye(m)]])
        rescale = np.block([[root, zero], [zero, np.eye(m)]])
        basis = unscale @ bases[k]
        inverse = scaled @ rescale
    zero = np.zeros_like(allowed)
    spread = np.block([[allowed, zero], [zero, allowed]])
    return HeldStructure(omega, ratio, spread @ basis, inverse @ spread.T, static_shape, 1.0 / compliance)

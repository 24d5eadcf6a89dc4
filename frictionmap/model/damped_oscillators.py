"""A damped structure as a set of oscillators that do not depend on r.

Damping need not leave the modes real, so the roots s of the structure are taken two by two, each pair one
oscillator ``y'' + 2 zeta omega y' + omega^2 y = load`` (over-damped and double roots included).  Its motion
is ``u = A y + B p``, where p is y' less the load's direct part.  In time t = tau/r nothing depends on r.
"""

from typing import NamedTuple

import numpy as np

from ..errors import InputError

#: Roots whose imaginary part is a smaller share of them than this are taken as a real subspace, which exists
#: for a double root too; eigenvectors do not.
_NEARLY_REAL = 1e-3

#: A basis of held motions worse conditioned than this would cost half of the digits.
_WORST_BASIS = 1e8


#: A pair of roots that a force moves by less than this times m eps of the most it could is not moved by it.
_UNMOVED = 64.0

_EPS = float(np.finfo(float).eps)

#: Two roots, conjugate or real.
_Pair = tuple[complex, complex]


class DampedOscillators(NamedTuple):
    """m oscillators of m coordinates u; see the module.

    omega, zeta : (m,) frequency and damping ratio of every oscillator
    to_coordinates : (2m, 2m) (u, u') of (y, p)
    to_oscillators : (2m, 2m) the inverse
    push : (m,) what the given force is on each; it has no direct part.  Without one: zeros
    """

    omega: np.ndarray
    zeta: np.ndarray
    to_coordinates: np.ndarray
    to_oscillators: np.ndarray
    push: np.ndarray


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


def _aligned_with_force(
    basis: np.ndarray, pairs: list[_Pair], force: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The basis in which a force on the velocities acts on y'' alone, and its push on every oscillator.

    Of a pair the force is b, a vector of its plane; with the roots' polynomial s^2 + D s + K the motion
    a y + b y', a = (A + D) b, has A a = -K b: the push is on y'' and nowhere else.
    """
    m = len(pairs)
    inverse = np.linalg.inv(basis) @ np.concatenate((np.zeros(m), force))
    unmoved = _UNMOVED * m * _EPS * np.linalg.norm(force)
    found, push = np.empty_like(basis), np.zeros(m)
    for k, pair in enumerate(pairs):
        rate, stiffness = -(pair[0] + pair[1]).real, (pair[0] * pair[1]).real
        a, b = basis[:, k], basis[:, m + k]
        on_y, on_p = inverse[k], inverse[m + k]
        along, across = (on_p + rate * on_y) * a - stiffness * on_y * b, on_y * a + on_p * b
        moved = np.linalg.norm(across) > unmoved
        if moved:
            a, b = along, across
        # of the size of its energy, so that a mode stays as it is
        size = max(np.linalg.norm(a) / np.sqrt(abs(stiffness)), np.linalg.norm(b))
        found[:, k], found[:, m + k] = a / size, b / size
        push[k] = size if moved else 0.0
    return found, push


def _condition(basis: np.ndarray, pairs: list[_Pair]) -> float:
    """Condition number of a basis in y times its frequency, and p."""
    pace = np.sqrt(np.array([abs(a * b) for a, b in pairs]))
    scaled = basis / np.concatenate((pace, np.ones_like(pace)))
    return float(np.linalg.cond(scaled)) if np.isfinite(scaled).all() else np.inf


def damped_oscillators(
    root: np.ndarray, damping: np.ndarray, what: str, force: np.ndarray | None = None
) -> DampedOscillators:
    """The oscillators of u'' + damping u' + root^T root u = load, (m, m) both.

    force : (m,) a load that shall have no direct part, so that y and y' are continuous where it jumps
    Raises InputError where two modes are nearly one with nearly the same shape (critically damped twice
    over): their motion cannot be told apart in double precision.  `what` says of what structure, and why.
    """
    m = len(damping)
    # in (R u, u') with R^T R the stiffness: nearly normal for little damping
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
    pushes = [np.zeros(m)] * len(bases)
    conditions = [np.linalg.cond(b) for b in bases]
    if force is not None:
        for k, pairs in enumerate(choices):
            if conditions[k] < 1.0 / _EPS:
                bases[k], pushes[k] = _aligned_with_force(bases[k], pairs, force)
                conditions[k] = _condition(bases[k], pairs)
    k = int(np.argmin(conditions))
    if not conditions[k] < _WORST_BASIS:
        raise InputError(
            f"the damping must not make two modes of the {what}, which leave a basis of condition number "
            f"{conditions[k]:.1e}: change one of them a little"
        )
    pairs = choices[k]
    omega = np.sqrt(np.array([(a * b).real for a, b in pairs]))
    ratio = -0.5 * np.array([(a + b).real for a, b in pairs]) / omega
    scaled = np.linalg.inv(bases[k])
    unscale = np.block([[np.linalg.inv(root), zero], [zero, np.eye(m)]])
    rescale = np.block([[root, zero], [zero, np.eye(m)]])
    return DampedOscillators(omega, ratio, unscale @ bases[k], scaled @ rescale, pushes[k])

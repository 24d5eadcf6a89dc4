"""A damped structure as a set of oscillators that do not depend on r.

The damped modes need not be real, so the characteristic roots s of the structure are taken in pairs; each
pair is one oscillator ``y'' + 2 zeta omega y' + omega^2 y = load`` (over-damped and double roots included).
Its motion is ``u = A y + B p``, where p is y' less the direct feedthrough of the load.  In time t = tau/r
nothing depends on r.
"""

from typing import NamedTuple

import numpy as np

from ..errors import InputError

#: Roots with a smaller relative imaginary part than this are represented by a real invariant subspace, which
#: also exists for a double root; eigenvectors do not.
_NEARLY_REAL = 1e-3

#: Largest condition number of a basis of held motions; a larger one would cost half of the digits.
_WORST_BASIS = 1e8


#: A force whose effect on a pair of roots is below this factor times m eps of its upper bound does not excite
#: the pair.
_UNMOVED = 64.0

_EPS = float(np.finfo(float).eps)

#: Two roots, conjugate or real.
_Pair = tuple[complex, complex]


class DampedOscillators(NamedTuple):
    """The m oscillators of m coordinates u; see the module.

    omega, zeta : (m,) frequency and damping ratio of every oscillator
    to_coordinates : (2m, 2m) maps (y, p) to (u, u')
    to_oscillators : (2m, 2m) the inverse
    push : (m,) load of the given force on each oscillator, without feedthrough; zeros if no force is given
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
    """Columns (a, b) of the motions a y + b y' from a complex eigenvector: a + b root = vector."""
    b = vector.imag / root.imag
    return np.column_stack((vector.real - b * root.real, b))


def _pairings(roots: np.ndarray) -> list[list[tuple[complex, complex]]]:
    """Ways to pair the roots: complex ones with their conjugates; real ones with the nearest, as a double
    root requires, or slow with fast.
    """
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
    """Columns of all pairs, (2m, 2m): those of y first, then those of p."""
    columns = [
        _from_vector(vectors[:, k], pair[0]) if vectors[:, k].any() else _from_subspace(matrix, pair)
        for k, pair in enumerate(pairs)
    ]
    # unit columns, so that the condition number measures the effect of rounding
    sizes = [np.max(np.abs(c * [1.0, abs(p[0])])) or 1.0 for c, p in zip(columns, pairs, strict=True)]
    return np.array([c[:, j] / s for j in range(2) for c, s in zip(columns, sizes, strict=True)]).T


def _aligned_with_force(
    basis: np.ndarray, pairs: list[_Pair], force: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Basis in which a force on the velocities acts on y'' only, and its load on every oscillator.

    Within the plane of a pair the force is a vector b.  With the polynomial s^2 + D s + K of the roots and a
    = (A + D) b, A a = -K b holds for the motion a y + b y': the force acts on y'' and on nothing else.
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
        # scaled by its energy, so that an uncoupled mode is unchanged
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
    """Oscillators of u'' + damping u' + root^T root u = load, both matrices (m, m).

    force : (m,) a load that must have no direct feedthrough, so that y and y' are continuous where it jumps
    what : which structure this is, for the message of an error

    Raises InputError where two modes nearly coincide in frequency and shape (repeated critical damping):
    their motions cannot be separated in double precision.
    """
    m = len(damping)
    # in (R u, u') with R^T R the stiffness: nearly normal for light damping
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
            f"cannot separate two nearly equal damped modes of the {what}: condition number "
            f"{conditions[k]:.1e}; change the damping of one of them slightly"
        )
    pairs = choices[k]
    omega = np.sqrt(np.array([(a * b).real for a, b in pairs]))
    ratio = -0.5 * np.array([(a + b).real for a, b in pairs]) / omega
    scaled = np.linalg.inv(bases[k])
    unscale = np.block([[np.linalg.inv(root), zero], [zero, np.eye(m)]])
    rescale = np.block([[root, zero], [zero, np.eye(m)]])
    return DampedOscillators(omega, ratio, unscale @ bases[k], scaled @ rescale, pushes[k])

"""The structure with its contact held, as a set of oscillators that do not depend on r.

With the contact held, chi.q = 0 for the free modes q.  Modal damping does not leave the held modes real: they
are `damped_oscillators`.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .damped_oscillators import damped_oscillators

if TYPE_CHECKING:
    from .general import MergedContact
    from .system import System

#: Largest number of combinations of the states of contacts and springs that are all tried.
_ALL_COMBINATIONS = 64


class HeldStructure(NamedTuple):
    """The m = n - 1 held oscillators of n participating free modes; see the module.

    omega, zeta : (m,) frequency and damping ratio of every oscillator
    to_free : (2n, 2m) maps (y, p) to free coordinates (u, u') relative to the static shape
    to_held : (2m, 2n) the inverse on motions with the contact at rest
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
    """Build the held structure of free modes w, zeta (n,) with participation factors chi (n,), all nonzero.

    coupling : (n, n) coupling of the modes by the damping, 0 on the diagonal; with it chi may have zeros

    Raises InputError where two held modes nearly coincide in frequency and shape (repeated critical damping):
    their motions cannot be separated in double precision.
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
        what = f"held structure with damping ratios {zeta.tolist()}"
        omega, ratio, basis, inverse, _ = damped_oscillators(root, damping, what)
    zero = np.zeros_like(allowed)
    spread = np.block([[allowed, zero], [zero, allowed]])
    return HeldStructure(omega, ratio, spread @ basis, inverse @ spread.T, static_shape, 1.0 / compliance)


def _allowed(held: np.ndarray, n: int) -> np.ndarray:
    """Orthonormal displacements (n, m) in which the displacements held (k, n) are 0."""
    from scipy.linalg import null_space  # not needed, and not loaded, for one mass

    return null_space(held) if len(held) else np.eye(n)


def frequencies_with_held(system: "System", contacts: Sequence[int]) -> np.ndarray:
    """Natural frequencies with these contacts held, the others free.

    Rigid ones do not move; springs of elastic ones are stuck at one end.
    """
    modes, groups = system.modes, [system.contact_system.groups[j] for j in contacts]
    stiffness = modes.stiffness + sum(
        ((one.stiffness or 0.0) * np.outer(one.vector, one.vector) for one in groups), 0.0 * modes.stiffness
    )
    rigid = np.array([one.vector for one in groups if one.stiffness is None])
    return constrained_frequencies(modes.mass, stiffness, rigid)


def frequencies_of_phases(system: "System") -> np.ndarray:
    """Natural frequencies with contacts open, sliding and held, and springs on each of their pieces.

    Friction that follows the normal force, whose stiffness is not symmetric, is left out.  Of many
    combinations those are tried in which one part differs from all the others.
    """
    general = system.contact_system
    parts: list[list[tuple[np.ndarray, np.ndarray | None]]] = []  # states: stiffness, and a held direction
    for group in general.groups:
        c, none = group.vector, np.zeros((system.n, system.n))
        states = [none] if group.normal is None else [none, _pressed(group)]
        own = (group.stiffness or 0.0) * np.outer(c, c)
        held = None if group.stiffness else c
        parts.append([*((one, None) for one in states), (states[-1] + own, held)])
    for spring in general.springs:
        square = np.outer(spring.direction, spring.direction)
        parts.append([(slope * square, None) for slope in sorted(set(spring.slopes))])
    found = []
    for places in _combinations([len(part) for part in parts]):
        chosen = [part[k] for part, k in zip(parts, places, strict=True)]
        stiffness = system.modes.stiffness + sum((one for one, _ in chosen), 0.0 * system.modes.stiffness)
        held = np.array([c for _, c in chosen if c is not None])
        found.append(constrained_frequencies(system.modes.mass, stiffness, held))
    return np.unique(np.concatenate(found))


def _pressed(group: "MergedContact") -> np.ndarray:
    """Stiffness of the normal spring of a closed contact."""
    assert group.normal is not None
    return group.normal.stiffness * np.outer(group.normal.direction, group.normal.direction)


def _combinations(counts: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """States of all parts: all of few combinations, else those in which one part differs from the others."""
    if math.prod(counts) <= _ALL_COMBINATIONS:
        yield from itertools.product(*map(range, counts))
        return
    for all_in in (0, 1):
        base = [all_in * (count - 1) for count in counts]
        yield tuple(base)
        for k, count in enumerate(counts):
            for state in range(count):
                if state != base[k]:
                    yield (*base[:k], state, *base[k + 1 :])


def constrained_frequencies(mass: np.ndarray, stiffness: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Natural frequencies of a structure in which the displacements held (k, n) are 0."""
    from scipy.linalg import eigh

    allowed = _allowed(held, len(mass))
    if not allowed.shape[1]:
        return np.empty(0)
    squares = eigh(allowed.T @ stiffness @ allowed, allowed.T @ mass @ allowed, eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0))


def complex_frequencies(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, held: np.ndarray
) -> np.ndarray:
    """Complex frequencies p of free vibrations e^{i p t}, Re p >= 0, with the displacements held (k, n) 0.

    They are w (sqrt(1 - zeta^2) + i zeta) of a mode; of two that are overdamped Re p is 0.
    """
    if not damping.any():
        return constrained_frequencies(mass, stiffness, held).astype(complex)
    allowed = _allowed(held, len(mass))
    m, c, k = (allowed.T @ one @ allowed for one in (mass, damping, stiffness))
    size = len(m)
    rates = np.hstack((-np.linalg.solve(m, k), -np.linalg.solve(m, c)))
    found = -1j * np.linalg.eigvals(np.vstack((np.eye(size, 2 * size, size), rates)))
    return found[found.real >= 0.0]

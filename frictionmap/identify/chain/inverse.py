"""A chain from where its first mass resonates and where it stands still: an inverse problem with one answer.

With the base shaken, X_1 is infinite at the natural frequencies f_i and zero at the frequencies z_j of the
chain with mass 1 held; they alternate, f_1 < z_1 < f_2 < ...  The weights of its partial fractions,

    w_i = prod over j of (z_j^2 - f_i^2)/prod over l != i of (f_l^2 - f_i^2),

are the squares of what mass 1 has of the modes, and Lanczos' recursion on diag(f_i^2) from sqrt(w) gives the
one tridiagonal A = M^{-1/2} K M^{-1/2} with them.  For two masses it is the closed form of `two_masses`.

A fit without damping cannot move a resonance or a standstill across a sample: both sides are searched.  A
place near a sample has nearly the same amplitude there as its mirror image on the other side.
"""

from collections.abc import Iterator

import numpy as np

from ..statistics.least_squares import Problem, Solution, minimise
from .response import modes

#: A sum of squares is less if it is by more than this share.
_LESS = 1e-4


def chain_of(poles: np.ndarray, zeros: np.ndarray) -> np.ndarray:
    """ln f_k1m1, ln gamma_2.., ln kappa_2.., shape (2 n - 1,), from f (n,) and z (n - 1,) in turn, Hz."""
    squares, n = poles**2, poles.size
    weights = [
        np.prod(zeros**2 - one) / np.prod(np.delete(squares, i) - one) for i, one in enumerate(squares)
    ]
    basis = np.zeros((n, n))
    basis[:, 0] = np.sqrt(weights) / np.sqrt(np.sum(weights))
    for j in range(1, n):
        rest = -squares * basis[:, j - 1]
        for _ in range(2):  # once more, as the first projection rounds
            rest -= basis[:, :j] @ (basis[:, :j].T @ rest)
        basis[:, j] = rest / np.linalg.norm(rest)
    matrix = basis.T @ (squares[:, np.newaxis] * basis)
    # a base at rest but displaced takes all masses along: A M^{1/2} 1 = k_1 e_1
    along = np.linalg.solve(matrix, np.eye(n)[0])
    first_spring = 1.0 / along[0]
    masses = (along * first_spring) ** 2
    springs = -np.diag(matrix, 1) * np.sqrt(masses[:-1] * masses[1:]) / first_spring
    return np.log(np.concatenate(([np.sqrt(first_spring)], masses[1:], springs)))


def other_sides(task: Problem, found: Solution, f: np.ndarray, n: int) -> list[Solution]:
    """Minima with every resonance and standstill of mass 1 on either side of the sample next to it.

    f : frequencies at which mass 1 was measured, increasing

    Returns
    -------
    list of Solution
        By their sums, `found` among them: where a sample is very near, both sides may be as good.
    """
    best, minima, again = found, [found], True
    while again:
        tried = [
            minimise(task, np.where(task.free, start, best.values)) for start in _mirrored(best.values, f, n)
        ]
        minima = sorted([*minima, *tried], key=lambda one: one.sum)
        again = minima[0].sum < best.sum * (1.0 - _LESS)
        best = minima[0]
    return minima


def standstills(values: np.ndarray, n: int) -> np.ndarray:
    """Frequencies at which mass 1 stands still, (n - 1,) Hz: the natural ones of the others with it held."""
    f_k1m1 = float(np.exp(values[0]))
    masses, springs = np.exp(values[1:n]), np.exp(values[n : 2 * n - 1])
    stretches = np.eye(n - 1) - np.eye(n - 1, k=-1)
    stiffness = stretches.T @ (springs[:, np.newaxis] * stretches)
    scaled = stiffness / np.sqrt(np.outer(masses, masses))
    return np.asarray(f_k1m1 * np.sqrt(np.linalg.eigvalsh(scaled)))


def _mirrored(values: np.ndarray, f: np.ndarray, n: int) -> Iterator[np.ndarray]:
    """Chains with one of the places on the other side of the sample nearest to it."""
    places = np.empty(2 * n - 1)
    places[::2], places[1::2] = modes(values).frequencies, standstills(values, n)
    for k, place in enumerate(places):
        other = places.copy()
        other[k] = 2.0 * f[np.abs(f - place).argmin()] - place
        if other[0] > 0.0 and (np.diff(other) > 0.0).all():
            start = values.copy()
            start[: 2 * n - 1] = chain_of(other[::2], other[1::2])
            yield start

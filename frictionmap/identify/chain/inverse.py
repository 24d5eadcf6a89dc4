"""A chain from where its first mass resonates and where it stands still: an inverse problem with one answer.

With the base shaken, X_1 is infinite at the natural frequencies f_i and zero at the frequencies z_j of the
chain with mass 1 held; they alternate, f_1 < z_1 < f_2 < ...  The weights of its partial fractions,

    w_i = prod over j of (z_j^2 - f_i^2)/prod over l != i of (f_l^2 - f_i^2),

are the squares of what mass 1 has of the modes, and Lanczos' recursion on diag(f_i^2) from sqrt(w) gives the
one tridiagonal A = M^{-1/2} K M^{-1/2} with them.  For two masses it is the closed form of `two_masses`.
"""

import numpy as np


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

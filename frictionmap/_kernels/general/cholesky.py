"""Cholesky factors of a small positive definite matrix, by a list of its rows."""

import numpy as np

from ..compiler import inner_kernel, kernel


@kernel
def factor(matrix, which, count, factors):
    """Factor the rows and columns `which` of a matrix; False if they are singular.

    Parameters
    ----------
    matrix : (N, N)
    which, count : (N + 1,) int: rows, and how many
    factors : (N + 1, N) overwritten
    """
    for a in range(count):
        for b in range(a + 1):
            rest = matrix[which[a], which[b]]
            for c in range(b):
                rest -= factors[a, c] * factors[b, c]
            if a > b:
                factors[a, b] = rest / factors[b, b]
            elif rest > 0.0:
                factors[a, a] = np.sqrt(rest)
            else:
                return False
    return True


@inner_kernel
def solve_factored(factors, count, right):
    """Solve for one right side, which is overwritten."""
    for a in range(count):
        for c in range(a):
            right[a] -= factors[a, c] * right[c]
        right[a] /= factors[a, a]
    for a in range(count - 1, -1, -1):
        for c in range(a + 1, count):
            right[a] -= factors[c, a] * right[c]
        right[a] /= factors[a, a]

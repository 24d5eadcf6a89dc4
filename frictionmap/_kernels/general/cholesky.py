"""Cholesky factors of a small positive definite matrix, by a list of its rows."""

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, load, store


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


@inner_kernel
def solve_columns(factors, count, right):
    """`solve_factored` for all columns of `right`."""
    size = right.shape[1]
    for i in range(0, size, LANES):
        for a in range(count):
            part = load(right, a * size + i)
            for c in range(a):
                part = part - load(right, c * size + i) * factors[a, c]
            store(part * (1.0 / factors[a, a]), right, a * size + i)
        for a in range(count - 1, -1, -1):
            part = load(right, a * size + i)
            for c in range(a + 1, count):
                part = part - load(right, c * size + i) * factors[c, a]
            store(part * (1.0 / factors[a, a]), right, a * size + i)

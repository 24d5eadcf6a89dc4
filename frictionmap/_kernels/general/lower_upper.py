"""Factors of a general matrix, for several right sides."""

from ..compiler import kernel


@kernel
def factor_rows(matrix, rows, n):
    """Replace a matrix by its lower and upper triangular factors, with pivots; False if it is singular.

    Parameters
    ----------
    matrix : (size or more, size) replaced
    rows : (size,) int: filled, where the rows of the matrix have gone
    n : the size that is used
    """
    for k in range(n):
        rows[k] = k
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if not abs(matrix[pivot, k]) > 0.0:  # also where it is not a number
            return False
        if pivot != k:
            rows[k], rows[pivot] = rows[pivot], rows[k]
            for j in range(n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            matrix[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    matrix[i, j] -= factor * matrix[k, j]
    return True


@kernel
def solve_rows(factors, rows, n, right):
    """Solve for one right side, which is overwritten.

    Parameters
    ----------
    factors, rows, n : see `factor_rows`; row n of `factors` is scratch
    right : (size,)
    """
    solution = factors[n]
    for k in range(n):
        solution[k] = right[rows[k]]
        for j in range(k):
            solution[k] -= factors[k, j] * solution[j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            solution[k] -= factors[k, j] * solution[j]
        solution[k] /= factors[k, k]
    for k in range(n):
        right[k] = solution[k]

"""Factors of general matrices."""

import numpy as np
import pytest

from frictionmap._kernels.general.lower_upper import factor_rows, solve_rows


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_against_lapack(n):
    """Several right sides with the same factors; the first pivots are zero."""
    rng = np.random.default_rng(n)
    matrix = rng.normal(size=(n, n))
    matrix[0, 0] = 0.0 if n > 1 else 2.0
    factors, rows = np.zeros((n + 1, n)), np.zeros(n, np.int64)
    factors[:n] = matrix
    assert factor_rows.py_func(factors, rows, n)
    for _ in range(3):
        right = rng.normal(size=n)
        found = right.copy()
        solve_rows.py_func(factors, rows, n, found)
        assert found == pytest.approx(np.linalg.solve(matrix, right), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("bad", [0.0, np.nan])
def test_singular_matrices_are_refused(bad):
    """A row of zeros, or of NaN."""
    factors, rows = np.eye(4, 3), np.zeros(3, np.int64)
    factors[1] = bad
    assert not factor_rows.py_func(factors, rows, 3)

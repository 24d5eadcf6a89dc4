"""Orthonormal columns of tall matrices."""

import numpy as np

from ...errors import InputError


def orthonormal(columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Q and the inverse of R: twice by Cholesky's decomposition, exact to rounding while columns differ.

    Three products of matrices; LAPACK's decomposition of tall matrices waits for its threads at every column.
    """
    orthogonal, inverse = columns, np.eye(columns.shape[1])
    for _ in range(2):
        try:
            triangle = np.linalg.cholesky(orthogonal.T @ orthogonal).T
        except np.linalg.LinAlgError:
            raise InputError(
                "cannot determine harmonics of the base: a gap in time makes some of them "
                "indistinguishable; choose a window without it"
            ) from None
        step = np.linalg.inv(triangle)
        orthogonal, inverse = orthogonal @ step, inverse @ step
    return orthogonal, inverse

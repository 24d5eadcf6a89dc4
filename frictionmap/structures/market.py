"""Matrix Market: coordinate and array files, general and symmetric ones."""

from pathlib import Path

import numpy as np

from ..errors import InputError
from ..packages import read_by
from .entries import Matrix, assembled, mirrored

#: How such a file begins.
BANNER = "%%MatrixMarket"


def read_market(path: Path) -> Matrix:
    """A real matrix; of one that the file calls symmetric the lower triangle is there.

    Raises
    ------
    InputError
        It cannot be read, is not a square matrix of real numbers, or has an entry twice.
    """
    from scipy.io import mminfo, mmread

    rows, columns, _, form, field, symmetry = read_by(path, "Matrix Market file", lambda: mminfo(path))
    if field not in ("real", "double", "integer", "unsigned-integer") or symmetry not in (
        "general",
        "symmetric",
    ):
        raise InputError(
            f"file {path} must have a real matrix, general or symmetric; it has a {field} {symmetry} one"
        )
    if rows != columns:
        raise InputError(f"file {path} must have a square matrix; got {rows} by {columns}")
    values = read_by(path, "Matrix Market file", lambda: mmread(path, spmatrix=False))
    if form == "array":
        return Matrix(np.asarray(values))
    row, column = values.coords
    if symmetry == "general":
        return Matrix(assembled(path, rows, row, column, values.data))
    # the reader has mirrored them: taken apart again, so that an entry above the diagonal shows
    lower = row >= column
    return Matrix(mirrored(assembled(path, rows, row[lower], column[lower], values.data[lower])))

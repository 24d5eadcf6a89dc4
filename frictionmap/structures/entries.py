"""Matrices in files: entries, and labels of the rows where the file has any."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError

#: Largest number of rows; more indicate an error in the file.
_MOST = 10**7

#: Node and degree of freedom at it.
Label = tuple[int, int]


class Matrix(NamedTuple):
    """A matrix (n, n), an array or a sparse one, and the labels of its rows, and so of its columns."""

    values: Any
    labels: tuple[Label, ...] | None = None


def refuse(path: Path, line: int, valid: str, got: str) -> NoReturn:
    """Refuse a line of a file."""
    raise InputError(f"cannot read {path}, line {line}: expected {valid}; got {' '.join(got.split())[:60]!r}")


def text_of(path: Path) -> str:
    """The text of a file.

    Raises
    ------
    InputError
        It is no text.
    """
    content = path.read_bytes()
    try:
        if b"\0" in content:
            raise ValueError
        return content.decode("utf-8-sig")
    except ValueError:
        raise InputError(f"cannot read {path}: it is not text; write the matrix as text") from None


def numbered(text: str, comment: str) -> Iterator[tuple[int, str]]:
    """Lines with their numbers, without empty lines and comments."""
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith(comment):
            yield number, line


def as_whole(text: str) -> int:
    """Convert an integer in digits; ValueError if it is none."""
    _check_digits(text)
    return int(text)


def as_number(text: str) -> float:
    """Convert a number as Fortran or C writes it, also 1.5D+03 and 1.5+03; ValueError if it is none."""
    _check_digits(text)
    try:
        return float(text)
    except ValueError:
        return float(re.sub(r"(?<=[0-9.])[dD]?(?=[+-])|[dD]", "e", text.strip(), count=1))


def _check_digits(text: str) -> None:
    """Refuse numbers that only Python accepts: 1_000, and digits of other alphabets."""
    if "_" in text or not text.isascii():
        raise ValueError(text)


def assembled(path: Path, size: int, rows: ArrayLike, columns: ArrayLike, values: ArrayLike) -> Any:
    """Assemble a sparse matrix from entries, counted from 0, each given once."""
    from scipy.sparse import coo_array

    if size > _MOST:
        raise InputError(f"cannot read {path}: a matrix may have at most {_MOST} rows; got {size}")
    at = np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64)
    places, counts = np.unique(at[0] * size + at[1], return_counts=True)
    if (counts > 1).any():
        row, column = divmod(int(places[np.argmax(counts > 1)]), size)
        raise InputError(
            f"cannot read {path}: an entry is given twice; got row {row + 1}, column {column + 1}"
        )
    return coo_array((np.asarray(values, dtype=float), at), shape=(size, size)).tocsr()


def mirrored(matrix: Any) -> Any:
    """The symmetric matrix of which this is a triangle."""
    from scipy.sparse import diags_array

    return (matrix + matrix.T - diags_array(matrix.diagonal())).tocsr()


def half_or_whole(matrix: Any) -> Any:
    """Complete a symmetric matrix that may be given by one triangle or in full."""
    pattern = matrix.copy()
    pattern.data = np.ones_like(pattern.data)
    pattern.setdiag(0.0)
    pattern.eliminate_zeros()
    both = pattern.multiply(pattern.T)
    return mirrored(matrix) if pattern.nnz and both.nnz == 0 else matrix


def in_one_order(matrices: dict[str, Matrix]) -> tuple[dict[str, Any], tuple[Label, ...] | None]:
    """Give all matrices the same rows, one per label, increasing; return them and the labels.

    Raises
    ------
    InputError
        Some have labels and some have none.
    """
    labelled = {name for name, one in matrices.items() if one.labels is not None}
    if not labelled:
        return {name: one.values for name, one in matrices.items()}, None
    bare = [name for name in matrices if name not in labelled]
    if bare:
        raise InputError(
            "matrices",
            f": cannot match the rows: {min(labelled)} has labels of nodes, {bare[0]} has none; "
            f"give all files with labels, or none",
        )
    every = tuple(sorted({label for one in matrices.values() for label in one.labels or ()}))
    return {name: _placed(one, every) for name, one in matrices.items()}, every


def _placed(one: Matrix, labels: Iterable[Label]) -> Any:
    """A matrix with rows for all these labels."""
    from scipy.sparse import coo_array

    place = {label: k for k, label in enumerate(labels)}
    where = np.array([place[label] for label in one.labels or ()], dtype=np.int64)
    entries = coo_array(one.values)
    rows, columns = (where[at] for at in entries.coords)
    return coo_array((entries.data, (rows, columns)), shape=(len(place), len(place))).tocsr()

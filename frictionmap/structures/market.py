"""Matrix Market: coordinate and array files of real numbers, general and symmetric ones.

Read here: the reader of scipy, compiled, crashes with the process on some damaged files.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from .entries import Matrix, as_number, as_whole, assembled, mirrored, numbered, refuse, text_of

#: How such a file begins.
BANNER = "%%MatrixMarket"

_FORMS = ("coordinate", "array")
_FIELDS = ("real", "double", "integer", "unsigned-integer")
_SYMMETRIES = ("general", "symmetric")


def read_market(path: Path) -> Matrix:
    """Read a real matrix; a symmetric one is stored by its lower triangle.

    Raises
    ------
    InputError
        It is not a square matrix of real numbers, a line is not as the header says, or an entry is there
        twice.
    """
    text = text_of(path)
    banner = text.split("\n", 1)[0]
    words = banner.lower().split()
    valid = len(words) == 5 and words[1] == "matrix" and words[2] in _FORMS
    if not valid or words[3] not in _FIELDS or words[4] not in _SYMMETRIES:
        refuse(path, 1, f"{BANNER} matrix coordinate|array real general|symmetric", banner)
    lines = numbered(text, "%")
    coordinates, symmetric = words[2] == "coordinate", words[4] == "symmetric"
    rows, *further = _sizes(path, lines, 3 if coordinates else 2)
    if coordinates:
        matrix = _coordinates(path, lines, rows, further[1], symmetric)
        return Matrix(mirrored(matrix) if symmetric else matrix)
    return Matrix(_array(path, lines, rows, symmetric))


def _sizes(path: Path, lines: Iterator[tuple[int, str]], count: int) -> list[int]:
    """Read the size of the matrix; refuse one that is not square."""
    number, line = next(lines, (2, ""))
    try:
        sizes = [as_whole(word) for word in line.split()]
        if len(sizes) != count or min(sizes) < 0 or sizes[0] < 1:
            raise ValueError(line)
    except ValueError:
        refuse(path, number, f"{count} whole numbers, the size of the matrix", line)
    if sizes[0] != sizes[1]:
        raise InputError(f"cannot read {path}: the matrix must be square; got {sizes[0]} by {sizes[1]}")
    return sizes


def _coordinates(path: Path, lines: Iterator[tuple[int, str]], size: int, count: int, symmetric: bool) -> Any:
    rows, columns, values = [], [], []
    for number, line in lines:
        try:
            first, second, entry = line.split()
            row, column, value = as_whole(first), as_whole(second), as_number(entry)
        except ValueError:
            refuse(path, number, "row column entry", line)
        if not 1 <= row <= size or not 1 <= column <= size:
            refuse(path, number, f"a row and a column from 1 to {size}", line)
        if symmetric and row < column:
            refuse(path, number, "an entry of the lower triangle", line)
        rows.append(row - 1)
        columns.append(column - 1)
        values.append(value)
    _complete(path, len(values), count)
    return assembled(path, size, rows, columns, values)


def _array(path: Path, lines: Iterator[tuple[int, str]], size: int, symmetric: bool) -> np.ndarray:
    """All entries, or those of the lower triangle, column by column."""
    values = []
    for number, line in lines:
        try:
            values.append(as_number(line))
        except ValueError:
            refuse(path, number, "one entry", line)
    _complete(path, len(values), size * (size + 1) // 2 if symmetric else size * size)
    if not symmetric:
        return np.array(values).reshape(size, size).T
    matrix = np.zeros((size, size))
    columns, rows = np.triu_indices(size)
    matrix[rows, columns] = matrix[columns, rows] = values
    return matrix


def _complete(path: Path, found: int, count: int) -> None:
    if found != count:
        raise InputError(f"cannot read {path}: its header announces {count} entries; got {found}")

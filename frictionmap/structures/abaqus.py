"""Matrices as text that Abaqus writes with *MATRIX GENERATE and *MATRIX OUTPUT.

Lines of ``node, dof, node, dof, entry`` (FORMAT=MATRIX INPUT or LABELS) or of ``row column entry``
(FORMAT=COORDINATE).  Of a symmetric matrix either triangle is there, or all of it.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from .entries import Label, Matrix, as_number, as_whole, assembled, half_or_whole, numbered, refuse, text_of

#: Entry on the diagonal that Abaqus gives a degree of freedom that a boundary condition holds.
HELD = 1e36

_LABELLED, _COUNTED = 5, 3


def read_abaqus(path: Path) -> Matrix:
    """A matrix; the rows of one with labels in increasing order of these.

    Raises
    ------
    InputError
        A line is not one of such entries, or an entry comes twice.
    """
    rows: list[Label | int] = []
    columns: list[Label | int] = []
    values: list[float] = []
    count = 0
    for number, line in numbered(text_of(path), "**"):
        if line.lstrip().startswith("*"):
            _keyword(path, number, line)
            continue
        fields = line.replace(",", " ").split()
        count = count or len(fields)
        try:
            if len(fields) != count or count not in (_LABELLED, _COUNTED):
                raise ValueError(line)
            places = [as_whole(field) for field in fields[:-1]]
            values.append(as_number(fields[-1]))
        except ValueError:
            refuse(path, number, _expected(count), line)
        if count == _COUNTED and min(places) < 1:
            refuse(path, number, "rows and columns counted from 1", line)
        half = len(places) // 2
        rows.append((places[0], places[1]) if count == _LABELLED else places[0] - 1)
        columns.append((places[half], places[half + 1]) if count == _LABELLED else places[half] - 1)
    if not values:
        raise InputError(f"cannot read {path}: it has no entries; write one line per entry of the matrix")
    return _matrix(path, rows, columns, values)


def _expected(count: int) -> str:
    forms = {_LABELLED: "node, dof, node, dof, entry", _COUNTED: "row column entry"}
    return forms.get(count, " or ".join(forms.values()))


def _keyword(path: Path, number: int, line: str) -> None:
    """Refuse a keyword other than that of a symmetric matrix."""
    words = re.sub(r"\s", "", line).upper().split(",")
    if not words[0].startswith("*MATRIX") or "TYPE=UNSYMMETRIC" in words:
        refuse(path, number, "no keyword but *MATRIX of a symmetric matrix", line)


def _matrix(path: Path, rows: list[Any], columns: list[Any], values: list[float]) -> Matrix:
    if isinstance(rows[0], int):
        size = max(*rows, *columns) + 1
        return Matrix(half_or_whole(assembled(path, size, rows, columns, values)))
    labels: tuple[Label, ...] = tuple(sorted({*rows, *columns}))
    place = {label: k for k, label in enumerate(labels)}
    at_row, at_column = ([place[label] for label in one] for one in (rows, columns))
    return Matrix(half_or_whole(assembled(path, len(labels), at_row, at_column, values)), labels)


def held(stiffness: Any) -> np.ndarray:
    """Rows of K that a boundary condition holds, bool (n,)."""
    return np.asarray(stiffness.diagonal()) >= HELD

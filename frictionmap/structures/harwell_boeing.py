"""Harwell-Boeing and Rutherford-Boeing files: assembled real matrices, symmetric or not.

Numbers stand in columns of fixed width, as the Fortran formats of the header say.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from .entries import Matrix, as_number, as_whole, assembled, mirrored, refuse, text_of

_FORMAT = re.compile(r"(?:(\d+)P,?)?(\d*)([IEDFG])(\d+)(?:\.(\d+))?(?:E\d+)?", re.IGNORECASE)

#: Digits, decimal point and more digits, exponent.
_REAL = re.compile(r"\s*([+-]?\d*)(\.\d*)?(?:[ED]?([+-]?\d+))?\s*", re.IGNORECASE | re.ASCII)


class _Card(NamedTuple):
    """Fortran format of the numbers on a line."""

    most: int
    kind: str
    width: int
    decimals: int  # of a number without a decimal point
    scale: int  # what is written without an exponent is 10 to this times as large

    def number(self, field: str) -> float:
        """A number as Fortran reads it.  ValueError if it is none."""
        if self.kind == "I":
            return as_whole(field)
        parts = _REAL.fullmatch(field)
        if parts is None:
            return as_number(field)
        digits, point, exponent = parts.groups()
        shift = (0 if point else self.decimals) + (0 if exponent else self.scale)
        return float(f"{digits}{point or ''}e{int(exponent or 0) - shift}") if shift else as_number(field)


def read_harwell_boeing(path: Path) -> Matrix:
    """Read a matrix; a symmetric one is stored by its lower triangle.

    Raises
    ------
    InputError
        It is not an assembled, real, square matrix, or a line is not as the header says.
    """
    lines = text_of(path).splitlines()
    if len(lines) < 4:
        raise InputError(
            f"cannot read {path}: a Harwell-Boeing header has four lines or more; got {len(lines)}"
        )
    cards = _whole(path, lines, 1)[:5]
    kind, sizes = lines[2][:3].upper(), _whole(path, lines, 2, 3)
    right_sides = cards[4] if len(cards) > 4 else 0
    if not re.fullmatch("[RI][SU]A", kind) or len(sizes) < 3 or len(cards) < 4 or right_sides:
        refuse(path, 3, "an assembled real matrix (RSA or RUA), without right-hand sides", lines[2])
    if sizes[0] != sizes[1]:
        refuse(path, 3, "a square matrix", lines[2])
    formats = [_card(path, lines[3], word) for word in lines[3].upper().split()[:3]]
    if len(formats) < 3:
        refuse(path, 4, "the formats of pointers, rows and entries", lines[3])
    begin, parts = 4, []
    for size, count, card in zip((sizes[1] + 1, sizes[2], sizes[2]), cards[1:4], formats, strict=True):
        parts.append(_numbers(path, lines, begin, count, card, size))
        begin += count
    pointers, rows = (part.astype(np.int64) - 1 for part in parts[:2])
    valid = pointers[0] == 0 and pointers[-1] == sizes[2] and (np.diff(pointers) >= 0).all()
    if not valid or rows.min() < 0 or rows.max() >= sizes[0]:
        raise InputError(
            f"cannot read {path}: pointers and rows do not fit a matrix of size {sizes[0]}; write it again"
        )
    columns = np.repeat(np.arange(sizes[1]), np.diff(pointers))
    if kind[1] == "S" and (rows < columns).any():
        raise InputError(
            f"cannot read {path}: a symmetric matrix is given by its lower triangle; got entries above it"
        )
    matrix = assembled(path, sizes[0], rows, columns, parts[2])
    return Matrix(mirrored(matrix) if kind[1] == "S" else matrix)


def _whole(path: Path, lines: list[str], index: int, begin: int = 0) -> list[int]:
    """Read the integers of a header line."""
    try:
        return [as_whole(word) for word in lines[index][begin:].split()]
    except ValueError:
        refuse(path, index + 1, "whole numbers of a Harwell-Boeing header", lines[index])


def _card(path: Path, line: str, word: str) -> _Card:
    matched = _FORMAT.fullmatch(word.strip("()"))
    if not matched:
        refuse(path, 4, "Fortran formats such as (10I8) and (3E25.17)", line)
    scale, most, kind, width, decimals = matched.groups()
    return _Card(int(most or 1), kind.upper(), int(width), int(decimals or 0), int(scale or 0))


def _numbers(path: Path, lines: list[str], begin: int, count: int, card: _Card, size: int) -> np.ndarray:
    """Read numbers from several lines, separated by blanks or, where they touch, by the width of the format.

    Some programs keep the blanks and not the width.
    """
    part = lines[begin : begin + count]
    fields = [line.split() for line in part]
    if sum(map(len, fields)) != size:
        fields = [
            [line[k : k + card.width] for k in range(0, len(line.rstrip()), card.width)] for line in part
        ]
    found: list[float] = []
    for index, words in enumerate(fields):
        try:
            found += [card.number(word) for word in words]
        except ValueError:
            words = []
        if not words or len(words) > card.most:
            refuse(path, begin + index + 1, f"{card.most} numbers of {card.width} characters", part[index])
    if len(found) != size:
        raise InputError(
            f"cannot read {path}: expected {size} numbers from line {begin + 1} on; got {len(found)}"
        )
    return np.array(found, dtype=float)

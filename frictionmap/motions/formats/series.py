"""`Series`: what is read of a file of a record; and numbers in lines of text."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...errors import InputError

#: Unit of the values of files that state it in words of their own, by these words in small letters.
_SPELLINGS = {
    "g": "g", "cm/sec": "cm/s", "cm/s": "cm/s", "cm": "cm", "cm/sec2": "cm/s^2", "cm/sec^2": "cm/s^2",
    "cm/sec/sec": "cm/s^2", "cm/s/s": "cm/s^2", "cm/s^2": "cm/s^2", "cm/s2": "cm/s^2", "gal": "cm/s^2",
    "m/s^2": "m/s^2", "m/s": "m/s", "m": "m",
}  # fmt: skip

#: Numbers of fixed width that fill it.
_TOUCHING = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")

#: A header quotes this many characters of a file at most.
_LONGEST = 160


class Series(NamedTuple):
    """Samples of a file, and what it says about them."""

    values: np.ndarray
    dt: float | None  # between samples [s]; None: see `time`
    time: np.ndarray | None
    quantity: str
    unit: str | None  # of the values; None: dimensionless
    header: str  # event and station, one line, or empty
    baseline: str = "none"  # what is taken off unless another is asked for
    remark: str = ""  # what was made of the file, or empty


def unit_of(words: str) -> str | None:
    """The unit that a header states; None if it is unknown."""
    return _SPELLINGS.get(words.strip(" .,;").lower())


def lines_of(path: Path) -> list[str]:
    """Lines of a file of text, in any of the codings that agree on the characters of numbers."""
    content = path.read_bytes()
    if b"\0" in content:
        raise InputError(f"cannot read {path}: it contains zero bytes and is not text; export it as text")
    return content.decode("latin-1").splitlines()


def shortened(parts: Sequence[str]) -> str:
    """Parts of a header as one line."""
    return " ".join("; ".join(part for part in parts if part.strip()).split())[:_LONGEST]


def numbers(path: Path, lines: Sequence[str], first: int, width: int | None = None) -> np.ndarray:
    """All numbers of the lines; `first` is the number of the first line, `width` that of a field, if fixed.

    Raises
    ------
    InputError
        There is something that is no finite number; the message names file and line.
    """
    found = []
    for k, line in enumerate(lines):
        for field in _fields(line) if width is None else re.findall(f".{{1,{width}}}", line.rstrip()):
            if field.strip():
                found.append(_number(path, field.strip(), first + k))
    return np.array(found)


def _fields(line: str) -> list[str]:
    """Fields between blanks; where a minus stands in the place of the blank, the numbers that touch."""
    fields: list[str] = []
    for field in line.split():
        parts = _TOUCHING.findall(field)
        fields += parts if "".join(parts) == field else [field]
    return fields


def _number(path: Path, field: str, line: int) -> float:
    try:
        value = float(field)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(
            f"cannot read {path}, line {line}: expected a finite number; got {field!r}; download the file "
            "again, or cut the record before it"
        )
    return value


def stated(path: Path, text: str, pattern: str, what: str) -> float:
    """The number that a header states, above zero.

    Raises
    ------
    InputError
        It is missing or not above zero.
    """
    found = re.search(pattern, text, re.IGNORECASE)
    try:
        value = float(found[1]) if found else np.nan
    except ValueError:
        value = np.nan
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(
            f"cannot read {path}: its header must state {what} > 0; got "
            f"{found[0].strip() if found else 'none'}; download the file again"
        )
    return value


def check_count(path: Path, values: np.ndarray, count: int, what: str) -> np.ndarray:
    """Refuse a file that holds fewer or more values than its header says.

    Raises
    ------
    InputError
        They differ.
    """
    if values.size != count:
        word = "truncated" if values.size < count else "damaged"
        raise InputError(
            f"cannot read {path}: {what} says {count} values; got {values.size}: it is {word}; download it "
            "again"
        )
    return values

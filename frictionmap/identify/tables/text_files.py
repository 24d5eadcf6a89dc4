"""Text files of data loggers as rows below a line of names.

Before the names a logger may write what it likes: `sep=;`, its model, its settings.  The names are the line
above the first row of numbers, with or without a line of units.  A remark names the lines that are not read.
"""

import csv
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ... import checks
from ...errors import InputError
from .headings import is_units
from .stamps import is_stamp

#: Signs between columns, and what they are called.
SEPARATORS = {";": "semicolon", "\t": "tab", ",": "comma", "|": "bar", " ": "blanks"}

#: Decimal signs.
DECIMALS = (".", ",")

_SEPARATOR_LINE = re.compile(r'^"?sep=(.)"?$', re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+(\.\d*)?")

#: Lines that are searched for the first row, and rows whose length is compared.
_SEARCHED, _COMPARED = 500, 50

#: Fields of rows without a value.
_NOTHING = ("", "nan", "-", "n/a", "na", "null", "none", "inf", "-inf", "+inf")


class TextTable(NamedTuple):
    """Names and rows of a text file, all fields as text."""

    names: list[str]
    rows: list[list[str]]
    first: int  # number of the line of the first row, from 1
    decimal: str
    form: str  # of the file, in words
    remark: str  # what was left out, or empty


def read_text(path: Path, decimal: str | None = None) -> TextTable:
    """Read a file of text.

    decimal : the decimal sign, "." or ","; None: as the numbers show it

    Raises
    ------
    InputError
        It is no text, it is empty, names stand twice, rows differ in length, or the decimal sign cannot be
        known; one line with file and line.
    """
    lines = _text(path).splitlines()
    if not any(line.strip() and not line.startswith("#") for line in lines):
        raise InputError(f"cannot read {path}: it is empty; the first line must name the columns")
    separator, begin = _separator(lines)
    header = _header(lines, begin, separator)
    names, first = _names(lines, header, separator)
    rows = _rows(lines[first:], separator)
    while rows and not "".join(rows[-1]):
        rows.pop()
    names, rows = _without_empty_columns(names, rows)
    _check_rows(path, names, rows, first)
    sign = _decimal(path, rows, decimal)
    words = f"CSV, {SEPARATORS[separator]} between columns, decimal {'comma' if sign == ',' else 'point'}"
    return TextTable(names, rows, first + 1, sign, words, _remark(path, lines, begin, header))


def _names(lines: Sequence[str], header: int, separator: str) -> tuple[list[str], int]:
    """Names of the columns, with their units where the line below holds these, and the first line of rows."""
    names = _fields(lines[header].lstrip("# "), separator)
    below = _fields(lines[header + 1], separator) if header + 1 < len(lines) else []
    if len(below) == len(names) and is_units(below):
        units = [unit.strip("[](){} ") for unit in below]
        named = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, units, strict=True)]
        return named, header + 2
    return names, header + 1


def checked_decimal(value: object, where: str) -> str | None:
    """A decimal sign, or None: as the numbers show it; `where` is the key that holds it."""
    return None if value is None else checks.choice(value, where, DECIMALS)


def number(field: str, comma: bool) -> float:
    """The number in a field; NaN if there is none."""
    try:
        # float() takes 1_000 as well, which no data logger means
        return float(field.replace(",", ".") if comma else field) if "_" not in field else np.nan
    except ValueError:
        return np.nan


def _text(path: Path) -> str:
    """The text of a file, as UTF-8, UTF-16 with its mark, or what programs of Windows write."""
    content = path.read_bytes()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        raise InputError(f"cannot read {path}: it contains zero bytes and is not text; save it as UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _separator(lines: Sequence[str]) -> tuple[str, int]:
    """Separator of the columns, and the line from which on there may be names."""
    top = next(k for k, line in enumerate(lines) if line.strip())
    said = _SEPARATOR_LINE.match(lines[top].strip())
    if said and said[1] in SEPARATORS:
        return said[1], top + 1
    last = lines[max(k for k, line in enumerate(lines) if line.strip())]  # preambles stand at the beginning
    sign = next((sign for sign in ";\t|" if sign in last), ",")
    return (" " if sign not in last and len(last.split()) > 1 and _is_row(last.split()) else sign), 0


def _fields(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    return [field.strip() for field in next(csv.reader([line], delimiter=separator), [])]


def _rows(lines: Sequence[str], separator: str) -> list[list[str]]:
    if separator == " ":
        return [line.split() for line in lines]
    return [[field.strip() for field in row] for row in csv.reader(lines, delimiter=separator)]


def _is_row(fields: Sequence[str]) -> bool:
    """Whether these are values, one at least: numbers, times, or gaps."""
    values = [_NUMBER.fullmatch(field) is not None or is_stamp(field) for field in fields]
    return any(values) and all(
        value or field.lower() in _NOTHING for value, field in zip(values, fields, strict=True)
    )


def _header(lines: Sequence[str], begin: int, separator: str) -> int:
    """The line of names.

    It is the first that is neither empty nor a comment, if it has as many fields as the rows; else the line
    above the first row of values, beyond a line of units.
    """
    there = [k for k in range(begin, len(lines)) if lines[k].strip()]
    plain = [k for k in there if not lines[k].startswith("#")] or there
    rows = [k for k in plain[:_SEARCHED] if _is_row(_fields(lines[k], separator))]
    count = _common([len(_fields(lines[k], separator)) for k in [*rows[:_COMPARED], *plain[-_COMPARED:]]])
    first = _fields(lines[plain[0]], separator)
    if plain[0] in rows:
        above = [k for k in there if k < plain[0]]  # a comment may hold the names
        named = above and len(_fields(lines[above[-1]].lstrip("# "), separator)) == len(first)
        return above[-1] if named else plain[0]
    begins = next((k for k in rows if len(_fields(lines[k], separator)) == count), None)
    if begins is None or (len(first) > 1 and _width(first) == count) or len(first) == count:
        return plain[0]
    above = [k for k in plain if k < begins]
    if len(above) > 1 and is_units(_fields(lines[above[-1]], separator)):
        above.pop()
    return above[-1]


def _common(sizes: Sequence[int]) -> int:
    """The most frequent size."""
    return max(set(sizes), key=sizes.count)


def _width(fields: Sequence[str]) -> int:
    """Number of fields up to the last that is not empty."""
    return max((k + 1 for k, field in enumerate(fields) if field), default=0)


def _without_empty_columns(names: list[str], rows: list[list[str]]) -> tuple[list[str], list[list[str]]]:
    """Names and rows without columns at the end that have neither a name nor a value."""
    count = len(names)
    while count > 1 and not names[count - 1] and not any("".join(row[count - 1 :]) for row in rows):
        count -= 1
    more = any(len(row) > count for row in rows) and not any("".join(row[count:]) for row in rows)
    if count < len(names) or more:
        rows = [row[:count] if len(row) > count else row for row in rows]
    return names[:count], rows


def _check_rows(path: Path, names: list[str], rows: list[list[str]], first: int) -> None:
    """Refuse names that stand twice, and rows of another length."""
    twice = next((name for name in names if names.count(name) > 1), None)
    # numbers twice: the file has no names at all, which the search for columns reports
    if twice is not None and not np.isfinite(number(twice, comma=False)):
        raise InputError(f"cannot read {path}, line {first}: column names must differ; got {twice!r} twice")
    for line, row in enumerate(rows, start=first + 1):
        if len(row) != len(names):
            raise InputError(
                f"cannot read {path}, line {line}: expected {len(names)} values, one per column; "
                f"got {len(row)}"
            )


def _decimal(path: Path, rows: list[list[str]], given: str | None) -> str:
    """The decimal sign of the numbers.

    Raises
    ------
    InputError
        Commas may be decimal signs or stand between thousands.
    """
    if given is not None:
        return given
    commas = [field for row in rows for field in row if "," in field and _DECIMAL_COMMA.fullmatch(field)]
    if not commas:
        return "."
    points = any(_NUMBER.fullmatch(field) and "." in field for row in rows for field in row)
    if points and all(_THOUSANDS.fullmatch(field) for field in commas):
        raise InputError(
            f"cannot read {path}: whether the comma of {commas[0]!r} is a decimal sign is not known, as "
            f'other numbers have a point; add decimal = "," or decimal = "." below [data]'
        )
    return ","


def _remark(path: Path, lines: Sequence[str], begin: int, header: int) -> str:
    """What was left out above the names, or empty."""
    left = [line for line in lines[:header] if line.strip() and not line.startswith("#")][1 if begin else 0 :]
    if not left:
        return ""
    return f"{len(left)} lines above the names of {path.name} are not read: {checks.one_line(left[0])}, .."

"""Files of measured data as tables of named columns: CSV, MAT, NPZ, and those of `lab_files`."""

import csv
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ...mat_files import read_mat
from .lab_files import read_tdms, read_uff

_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d+([eE][+-]?\d+)?\s*")

#: Arrays in a MAT or NPZ file.
Arrays = dict[str, np.ndarray]


class Table(NamedTuple):
    """Columns of equal length by their names."""

    file: Path
    columns: dict[str, np.ndarray]  # numbers, NaN where there is none
    texts: dict[str, list[str]]  # what stands there, of a file of text
    first: int  # where the first row is
    row_word: str  # "line" or "index"
    form: str  # of the file, in words

    def place(self, name: str, row: int) -> str:
        """Describe the place of a value."""
        return f"file {self.file}, column {name}, {self.row_word} {self.first + row}"

    def text(self, name: str, row: int) -> str:
        """A value as it stands in the file."""
        return self.texts[name][row] if name in self.texts else f"{self.columns[name][row]}"


def read_table(path: Path) -> Table:
    """Read a file of measured data by its ending.

    Raises
    ------
    InputError
        There is no such file, it is of no known form, or its rows differ in length; one line with the file.
    """
    forms: dict[str, Callable[[Path], Table]] = {
        ".csv": _read_csv,
        ".npz": _read_npz,
        ".mat": lambda path: _from_arrays(path, *read_mat(path)),
        ".uff": lambda path: _from_arrays(path, read_uff(path), "UFF"),
        ".unv": lambda path: _from_arrays(path, read_uff(path), "UFF"),
        ".tdms": lambda path: _from_arrays(path, read_tdms(path), "TDMS"),
    }
    read = forms.get(path.suffix.lower())
    if read is None:
        raise InputError(f"data.file must end in {', '.join(forms)}; got {path}")
    try:
        return read(path)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}; check data.file") from None


def _read_csv(path: Path) -> Table:
    content = path.read_bytes()
    if b"\0" in content:
        raise InputError(f"cannot read {path}: it contains zero bytes and is not text; save it as UTF-8")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:  # what measuring programs of Windows write
        text = content.decode("cp1252", errors="replace")
    lines = text.splitlines()
    header = next((k for k, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if header is None:
        raise InputError(f"cannot read {path}: it is empty; the first line must name the columns")
    delimiter = next((mark for mark in ";\t" if mark in lines[header]), ",")
    rows = list(csv.reader(lines[header:], delimiter=delimiter))
    while len(rows) > 1 and not "".join(rows[-1]).strip():
        rows.pop()
    names = [name.strip() for name in rows[0]]
    _check_rows(path, names, rows, header + 1)
    comma = delimiter != "," and any(_DECIMAL_COMMA.fullmatch(field) for row in rows[1:] for field in row)
    texts = {name: [row[k].strip() for row in rows[1:]] for k, name in enumerate(names)}
    columns = {name: np.array([_number(field, comma) for field in fields]) for name, fields in texts.items()}
    separator = {",": "comma", ";": "semicolon", "\t": "tab"}[delimiter]
    form = f"CSV, {separator} between columns, decimal {'comma' if comma else 'point'}"
    return Table(path, columns, texts, header + 2, "line", form)


def _check_rows(path: Path, names: list[str], rows: list[list[str]], line: int) -> None:
    """Refuse names that stand twice, and rows of another length."""
    twice = next((name for name in names if names.count(name) > 1), None)
    # numbers twice: the file has no names at all, which the search for columns reports
    if twice is not None and not np.isfinite(_number(twice, comma=False)):
        raise InputError(f"cannot read {path}, line {line}: column names must differ; got {twice!r} twice")
    for offset, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise InputError(
                f"cannot read {path}, line {line + offset}: expected {len(names)} values, one per column; "
                f"got {len(row)}"
            )


def _number(field: str, comma: bool) -> float:
    """The number in a field; NaN if there is none."""
    try:
        # float() takes 1_000 as well, which no data logger means
        return float(field.replace(",", ".") if comma else field) if "_" not in field else np.nan
    except ValueError:
        return np.nan


def _read_npz(path: Path) -> Table:
    try:
        with np.load(path, allow_pickle=False) as stored:
            return _from_arrays(path, {name: stored[name] for name in stored.files}, "NPZ")
    except (ValueError, EOFError, AttributeError, zipfile.BadZipFile) as error:
        raise InputError(
            f"cannot read {path}: it is not a valid NPZ file ({error}); save it with numpy.savez"
        ) from None


def _from_arrays(path: Path, arrays: Arrays, form: str) -> Table:
    """Make a table of all one-dimensional arrays of real numbers; others are ignored."""
    columns = {name: np.ravel(array).astype(float) for name, array in arrays.items() if _is_column(array)}
    return Table(path, columns, {}, 0, "index", form)


def _is_column(array: np.ndarray) -> bool:
    return (
        isinstance(array, np.ndarray)
        and array.dtype.kind in "iuf"
        and array.size == max(array.shape, default=0)
    )

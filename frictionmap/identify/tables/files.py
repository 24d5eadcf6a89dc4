"""Files of measured data as tables of named columns: CSV, MAT, NPZ, and those of `lab_files`."""

import json
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import InputError
from ...mat_files import read_mat
from .headings import heading
from .lab_files import read_tdms, read_uff
from .stamps import is_stamp, seconds
from .text_files import number, read_text

#: Endings of text files, and of all files that are read.
_TEXT = (".csv", ".txt", ".tsv", ".dat", ".asc")
FORMS = (*_TEXT, ".npz", ".mat", ".json", ".uff", ".unv", ".tdms")

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
    units: Mapping[str, str] = {}  # of columns whose names do not say them
    aliases: Mapping[str, str] = {}  # other names of columns, such as 1:X+
    remark: str = ""  # what of the file was not read, or empty

    def unit(self, name: str) -> str:
        """The unit of a column as its name says it, or as the file or the configuration does elsewhere."""
        return self.units.get(name) or heading(name).unit

    def place(self, name: str, row: int) -> str:
        """Describe the place of a value."""
        return f"file {self.file}, column {name}, {self.row_word} {self.first + row}"

    def text(self, name: str, row: int) -> str:
        """A value as it stands in the file."""
        return self.texts[name][row] if name in self.texts else f"{self.columns[name][row]}"


def read_table(path: Path, decimal: str | None = None) -> Table:
    """Read a file of measured data by its ending.

    decimal : the decimal sign of a text file; None: as the numbers show it

    Raises
    ------
    InputError
        There is no such file, it is of no known form, or its rows differ in length; one line with the file.
    """
    forms: dict[str, Callable[[Path], Table]] = {
        **dict.fromkeys(_TEXT, lambda path: _read_text(path, decimal)),
        ".npz": _read_npz,
        ".mat": lambda path: _from_arrays(path, *read_mat(path)),
        ".json": _read_json,
        **dict.fromkeys((".uff", ".unv"), _read_universal),
        ".tdms": lambda path: _from_arrays(path, read_tdms(path), "TDMS"),
    }
    read = forms.get(path.suffix.lower())
    if read is None:
        raise InputError(f"data.file must end in {', '.join(forms)}; got {path}")
    try:
        return read(path)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}; check data.file") from None


def _read_text(path: Path, decimal: str | None = None) -> Table:
    """A table of text: numbers, and columns of stamps as seconds."""
    found = read_text(path, decimal)
    texts = {name: [row[k] for row in found.rows] for k, name in enumerate(found.names)}
    units = {name: "s" for name, fields in texts.items() if fields and is_stamp(fields[0])}
    comma = found.decimal == ","
    columns = {
        name: seconds(fields, name) if name in units else np.array([number(field, comma) for field in fields])
        for name, fields in texts.items()
    }
    return Table(path, columns, texts, found.first, "line", found.form, units, remark=found.remark)


def _read_npz(path: Path) -> Table:
    try:
        with np.load(path, allow_pickle=False) as stored:
            return _from_arrays(path, {name: stored[name] for name in stored.files}, "NPZ")
    except (ValueError, EOFError, AttributeError, zipfile.BadZipFile) as error:
        raise InputError(
            f"cannot read {path}: it is not a valid NPZ file ({error}); save it with numpy.savez"
        ) from None


def _read_json(path: Path) -> Table:
    """Lists of numbers by name, or a list of records with the same names."""
    try:
        stored = json.loads(path.read_text(encoding="utf-8-sig"))
    except ValueError as error:
        raise InputError(f"cannot read {path}: it is not valid JSON ({error}); correct it") from None
    if isinstance(stored, list) and all(isinstance(one, dict) for one in stored):
        names = dict.fromkeys(name for one in stored for name in one)
        stored = {name: [one.get(name) for one in stored] for name in names}
    if not isinstance(stored, dict):
        raise InputError(
            f"cannot read {path}: it has no lists of numbers by name; write it as "
            '{"time_s": [0, 0.001], "x_mm": [5.0, 4.9]}'
        )
    arrays = {
        str(name): np.array([np.nan if one is None else one for one in values])
        for name, values in _lists(stored)
    }
    return _from_arrays(path, arrays, "JSON")


def _lists(stored: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, list[Any]]]:
    """Lists by name, those of nested objects by the names of these and a point."""
    for name, value in stored.items():
        if isinstance(value, Mapping):
            yield from _lists(value, f"{prefix}{name}.")
        elif isinstance(value, list) and not any(isinstance(one, (list, Mapping)) for one in value):
            yield f"{prefix}{name}", value


def _read_universal(path: Path) -> Table:
    columns, aliases = read_uff(path)
    return _from_arrays(path, columns, "UFF")._replace(aliases=aliases)


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

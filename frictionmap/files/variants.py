"""CSV files of parameters that vary together: names in the first row, one point per further row."""

import csv
import math
import re
from collections.abc import Mapping
from pathlib import Path

from .. import checks
from ..errors import InputError
from ..units.axes import has_units

#: Most frequent cause of a row of another length.
_HINT = "separate numbers by commas, use decimal points"

#: A name with the unit of its column: `contact_stiffness [N/mm]`.  The number of an entry, as in
#: `mass_ratios[2]`, has no letter.
_WITH_UNIT = re.compile(r"(.*\S)\s*\[\s*([^\]]*[A-Za-z][^\]]*?)\s*\]")


def put_variants(axes: object, folder: Path) -> tuple[Path, ...]:
    """Replace names of CSV files in a table [axes] by their numbers; return the files.

    The stored configuration then defines its systems even if the files are lost.

    Raises
    ------
    InputError
        A file cannot be read, or is no table of numbers; the message names the row.
    """
    files: list[Path] = []
    if isinstance(axes, dict):
        for key, given in axes.items():
            if isinstance(given, Mapping) and set(given) == {"file"}:
                name, file = f"axes.{key}.file", given["file"]
                if not isinstance(file, str) or not file:
                    raise InputError(f"{name} must be the path of a CSV file; got {checks.one_line(file)}")
                files.append(folder / file)
                axes[key] = _columns(files[-1], name)
    return tuple(files)


def _columns(path: Path, name: str) -> dict[str, list[float | str]]:
    """The columns of a file by the names in its first row; numbers of one with a unit are texts with it."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as opened:
            reader = csv.reader(opened)
            (_, header), *rows = [(reader.line_num, row) for row in reader if any(map(str.strip, row))]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "it has no rows of text"
        raise InputError(
            f"cannot read {name}, {path}: {reason}; give a CSV file with names in its first row"
        ) from None
    named = [_WITH_UNIT.fullmatch(key.strip()) for key in header]
    units = {
        found[1] if found else key.strip(): found and found[2]
        for key, found in zip(header, named, strict=True)
    }
    columns: dict[str, list[float | str]] = {key: [] for key in units}
    if len(columns) < len(header):
        raise InputError(f"{name} must name every number once in its first row; got {','.join(header)}")
    for line, row in rows:
        if len(row) != len(columns):
            raise InputError(f"{name}, row {line} must have {len(columns)} numbers; got {len(row)} ({_HINT})")
        for key, text in zip(columns, row, strict=True):
            value, unit = _number(text, f"{name}, row {line}, {key}"), units[key]
            columns[key].append(f"{text.strip()} {unit}" if unit else value)
    return columns


def _number(text: str, name: str) -> float:
    try:
        value = math.nan if "_" in text else float(text)  # 1_000 is a number of Python only
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        hint = ", whose unit belongs to the first row, as in force [N]" if has_units(text.strip()) else ""
        raise InputError(f"{name} must be a number{hint}; got {text!r}")
    return value

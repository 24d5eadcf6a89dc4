"""Columns of a table by role, with their units; no unit is guessed, no value is repaired."""

import json
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ... import checks
from ...errors import InputError
from ...units.table import COLUMN_NAMES, COLUMN_UNITS, suffixes
from .even_times import evened
from .files import Table
from .headings import ELECTRICAL, heading, words_of
from .text_files import number

#: Treatment of values that are not numbers.
MISSING = ("refuse", "drop")

#: Columns that are not used are named, no more than these.
_NAMED = 8

#: The share of rows that may be dropped.
_DROPPED = 0.01


class Column(NamedTuple):
    """A column of a table, with its unit."""

    name: str
    unit: str
    values: np.ndarray


class Columns(NamedTuple):
    """Columns by role, all of one length."""

    columns: dict[str, Column]
    rows: np.ndarray  # of the table
    dropped: int
    remark: str = ""  # what was made of the times, or empty


def pick_columns(
    table: Table, wanted: Mapping[str, str], names: Mapping[str, str], missing: str = "refuse"
) -> Columns:
    """Select the columns that a fit needs.

    wanted : what it measures ("time", "length", ..., or "ratio", which has no unit) of every column, such as
        {"time": "time", "x": "length"}
    names : names in the file where they are not the default, which is what the column is with a suffix
    missing : "refuse", or "drop" rows without a number, of which there may be 1 %

    Raises
    ------
    InputError
        A column or its unit is missing or unknown, lengths differ, or there is no number where one must be;
        one line with file, column and row.
    """
    checks.choice(missing, "data.missing", MISSING)
    found = {role: _find(table, role, names, measures) for role, measures in wanted.items()}
    _check_lengths(table, found)
    bad = np.zeros(next(iter(found.values())).values.size, dtype=bool)
    for column in found.values():
        bad |= ~np.isfinite(column.values)
    if bad.any():
        _refuse(table, found, bad, missing)
    rows = np.flatnonzero(~bad)
    kept = {role: column._replace(values=column.values[rows]) for role, column in found.items()}
    remark = ""
    if wanted.get("time") == "time":
        times, remark = evened(kept["time"].name, kept["time"].values)
        kept["time"] = kept["time"]._replace(values=times)
    return Columns(kept, rows, int(bad.sum()), remark)


def columns_like(
    table: Table, role: str, measures: str, names: Mapping[str, str], sure: bool = False
) -> list[str]:
    """Columns that `pick_columns` would take for a role, or refuse because of their unit.

    sure : whether only columns count that have a unit of what is measured
    """
    if role in names:
        return [names[role]]
    others = set(names.values())
    free = [name for name in table.columns if name not in others]
    return _named_like(table, free, role, suffixes(measures), sure)


def unused_columns(table: Table, used: Collection[str]) -> str:
    """Remark that names the unused columns of a file, or empty."""
    others = [name for name in table.columns if name not in used]
    if not others:
        return ""
    more = len(others) - _NAMED
    words = ", ".join(others[:_NAMED]) + (f" and {more} more" if more > 0 else "")
    return f"columns of {table.file.name} that are not used: {words}"


def check_increasing(table: Table, time: Column, rows: np.ndarray) -> None:
    """Refuse times that repeat or go back."""
    wrong = np.flatnonzero(np.diff(time.values) <= 0.0)
    if wrong.size:
        before, after = time.values[wrong[0]], time.values[wrong[0] + 1]
        raise InputError(
            f"{table.place(time.name, int(rows[wrong[0] + 1]))} must be > {before:g}, "
            f"the time of the previous row; got {after:g} (sort the rows)"
        )


def check_positive(table: Table, column: Column, rows: np.ndarray) -> None:
    """Refuse values that are not above zero."""
    wrong = np.flatnonzero(column.values <= 0.0)
    if wrong.size:
        raise InputError(
            f"{table.place(column.name, int(rows[wrong[0]]))} must be > 0; got {column.values[wrong[0]]:g}"
        )


def _find(table: Table, role: str, names: Mapping[str, str], measures: str) -> Column:
    """Find a column by name, or by its role and a unit."""
    valid, name = suffixes(measures), names.get(role)
    has = f"the file has {', '.join(table.columns) or 'none'}"
    known = f" (suffixes: {', '.join(valid)})" if valid else ""
    wanted = f"column {name or role + next(iter(valid), '')}{known}"
    if name is not None and name not in table.columns:
        raise InputError(
            f"cannot read {table.file}: {wanted} is missing, named by data.columns.{role}; {has}"
            f"{checks.nearest(name, table.columns)}"
        )
    candidates = columns_like(table, role, measures, names)
    if not candidates:
        raise InputError(
            f"cannot read {table.file}: {wanted} is missing; {has}; {_remedy(table, role, names, valid)}"
        )
    if len(candidates) > 1:
        raise InputError(
            f"cannot read {table.file}: several columns may be {role}, {', '.join(candidates)}; "
            f"choose one with data.columns.{role}, such as {_line(role, candidates[0])}"
        )
    column = candidates[0]
    unit = _unit(table, column, role, valid) if valid else "1"
    return Column(column, unit, table.columns[column])


def _line(role: str, name: str, more: str = "") -> str:
    """The line of [data] that names a column."""
    value = f"{{ name = {_quoted(name)}, {more} }}" if more else _quoted(name)
    return f"columns = {{ {role} = {value} }}"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)  # a text of TOML


def _remedy(table: Table, role: str, names: Mapping[str, str], valid: Sequence[str]) -> str:
    """What to write where no column is named as its role: the line that names one."""
    if role == "time" and any(f"_{table.unit(name)}" in suffixes("frequency") for name in table.columns):
        return "it has frequencies, so it is a spectrum or a response; export the time history"
    if table.columns and all(np.isfinite(number(name, comma=True)) for name in table.columns):
        return "these are no names; write a line of names above the numbers, such as time_s,x_mm"
    free = [name for name in table.columns if name not in names.values()]
    fit = [name for name in free if f"_{table.unit(name)}" in valid] if valid else []
    if fit:
        return f"name it in data.columns.{role}, such as {_line(role, fit[0])}"
    free = sorted(
        (name for name in free if not table.unit(name) and np.isfinite(table.columns[name]).any()),
        key=lambda name: not name.lower().startswith(role[0]),
    )
    if free and valid:
        line = _line(role, free[0], _unit_key(valid[0]))
        return f"name it in data.columns.{role}, with its unit, such as {line}"
    return f"name it in data.columns.{role}"


def _unit_key(suffix: str) -> str:
    return f'unit = "{COLUMN_NAMES[suffix[1:]]}"'


def _unit(table: Table, column: str, role: str, valid: Sequence[str]) -> str:
    """The unit of a column, which its name, the file or the configuration says."""
    unit = table.unit(column)
    if f"_{unit}" in valid:
        return unit
    what = repr(unit) if unit else "none"
    calibration = "scale = 1.0, " if unit in ELECTRICAL else ""
    where, endings = f"file {table.file}, column {column}", ", ".join(valid)
    line = f"or write {_line(role, column, calibration + _unit_key(valid[0]))} below [data]"
    if calibration:
        line += f", with the {COLUMN_NAMES[valid[0][1:]]} per {unit} of the sensor as scale"
    raise InputError(f"{where}: its name must end in a unit, {endings}; got {what} ({line})")


def _named_like(
    table: Table, columns: Sequence[str], role: str, valid: Sequence[str], sure: bool = False
) -> list[str]:
    """Columns of a role, by exact name with a unit, or by a name that begins with the role.

    The latter has a unit of what is measured at its end, or, unless it must be sure, nothing but one word or
    another unit behind it: base_frequency_rad_s is no base.
    """
    if not valid:
        return [name for name in columns if name == role]
    words = words_of(role)
    stems = {name: heading(name).stem.lower() for name in columns}
    measured = {name: f"_{table.unit(name)}" in valid for name in columns}
    exact = [name for name in columns if stems[name] in words and measured[name]]
    if exact:
        return exact
    like = [name for name in columns if stems[name] in words or name.lower().startswith(f"{role}_")]
    certain = [name for name in like if measured[name]]
    if certain or sure:
        return certain
    rests = {name: name[len(role) :].removeprefix("_") for name in like}
    return [
        name
        for name, rest in rests.items()
        if stems[name] in words or "_" not in rest or rest in COLUMN_UNITS
    ]


def _check_lengths(table: Table, found: Mapping[str, Column]) -> None:
    sizes = {column.name: column.values.size for column in found.values()}
    if len(set(sizes.values())) > 1:
        words = ", ".join(f"{name} {size}" for name, size in sizes.items())
        raise InputError(f"cannot read {table.file}: columns must have the same length; got {words}")
    if 0 in sizes.values():
        raise InputError(f"cannot read {table.file}: no values below {', '.join(sizes)}; add rows")


def _refuse(table: Table, found: Mapping[str, Column], bad: np.ndarray, missing: str) -> None:
    """Refuse the first value that is not a number, unless there are few and they may be dropped."""
    if missing == "drop" and bad.mean() <= _DROPPED:
        return
    row = int(np.argmax(bad))
    column = next(column for column in found.values() if not np.isfinite(column.values[row]))
    few = bad.mean() <= _DROPPED
    remedy = (
        'data.missing = "drop" ignores such rows'
        if few
        else f"{int(bad.sum())} of {bad.size} rows have none; at most {_DROPPED:.0%} may be ignored"
    )
    raise InputError(
        f"{table.place(column.name, row)} must be a finite number; "
        f"got {checks.one_line(table.text(column.name, row))} ({remedy})"
    )

"""Tables: text of any data logger, MAT, NPZ and the other forms of measured data, see `identify.tables`.

A column is named by its quantity with a unit, such as acceleration_g beside time_s; without units by its
quantity alone, beside `time`.  A file of one column has the time step besides.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ... import checks
from ...errors import InputError
from ...identify.tables.choices import checked_choices, chosen
from ...identify.tables.columns import Column, Columns, check_increasing, columns_like, pick_columns
from ...identify.tables.files import FORMS, Table, read_table
from ...identify.tables.headings import words_of
from ...identify.tables.text_files import checked_decimal, number
from ...units.table import COLUMN_NAMES, COLUMN_UNITS, UNITS
from .series import Series

#: What columns of the quantities measure.
MEASURES = {
    "force": "force",
    "acceleration": "acceleration",
    "velocity": "velocity",
    "displacement": "length",
}

ENDINGS = FORMS


def read_columns(
    path: Path, quantity: str | None, dt: float | None, unit: str | None, decimal: str | None,
    columns: Mapping[str, object] | None,
) -> Series:  # fmt: skip
    """Read the column of a quantity, and the times.

    Parameters
    ----------
    path : of the file
    quantity : of several columns, the one to take; or what a column without a name is
    dt : time step of a file without times
    unit : of a column that does not state it
    decimal : decimal sign of a file of text
    columns : names, units and calibrations by `time` and the quantities, as of `identify`
    """
    choices = checked_choices({} if columns is None else columns, "columns")
    valid = ("time", *MEASURES)
    wrong = next((role for role in choices if role not in valid), None)
    if wrong is not None:
        raise InputError("columns", f"must name {', '.join(valid)}; got {wrong!r}")
    try:
        table = _named(read_table(path, checked_decimal(decimal, "decimal")), quantity)
        table, names = chosen(table, choices)
        if unit is not None:
            table = _with_unit(table, quantity, unit, names)
        role = quantity or _only(table, names)
        return _series(table, role, dt, names)
    except InputError as error:
        raise _renamed(error) from None


def _renamed(error: InputError) -> InputError:
    """The error with the keys of records in the place of those of measured data."""
    words = str(error).replace("data.file must", "file must").replace("; check data.file", "; check the path")
    return InputError(words.replace("data.columns", "record.columns").replace("[data]", "[record]"))


def _named(table: Table, quantity: str | None) -> Table:
    """A table whose only column has a name: where the first number stood in its place, it is a value."""
    if len(table.columns) != 1:
        return table
    ((name, values),) = table.columns.items()
    first = number(name, comma=False)
    if not np.isfinite(first):
        return table
    if quantity is None:
        raise InputError(
            f"cannot read {table.file}: its column has no name; write one in its first line, such as "
            "acceleration_g, or give quantity and unit"
        )
    return table._replace(
        columns={quantity: np.append(first, values)}, texts={}, first=table.first - 1, units={}
    )


def _with_unit(table: Table, quantity: str | None, unit: str, names: Mapping[str, str]) -> Table:
    """A table in which the column of the record has the unit, which it does not state otherwise."""
    role = quantity or _only(table, names)
    found = columns_like(table, role, MEASURES[role], names)
    for name in found:
        said = table.unit(name)
        if said in COLUMN_UNITS and COLUMN_NAMES[said] != unit:
            raise InputError(
                "unit", f"must be that of column {name}, {COLUMN_NAMES[said]}, or be left out; got {unit!r}"
            )
    units = {name: UNITS[unit].column for name in found if name in table.columns}
    return table._replace(units={**table.units, **units})


def _only(table: Table, names: Mapping[str, str]) -> str:
    """The only quantity that the table has."""
    found = [role for role, measures in MEASURES.items() if columns_like(table, role, measures, names)]
    if len(found) == 1:
        return found[0]
    has = ", ".join(table.columns) or "none"
    if found:
        raise InputError(
            f"cannot choose a column of {table.file}: it has {', '.join(found)}; give one of them as quantity"
        )
    raise InputError(
        f"cannot read {table.file}: it must have a column acceleration_g, velocity_m_s, displacement_mm or "
        f"force_N, or in another unit; got {has}; name it in record.columns, such as "
        f'columns = {{ acceleration = {{ name = "a", unit = "g" }} }}'
    )


def _series(table: Table, role: str, dt: float | None, names: Mapping[str, str]) -> Series:
    """The samples of a table."""
    stated = any(_has_unit(table, name) for name in columns_like(table, role, MEASURES[role], names))
    measures = MEASURES[role] if stated or role in names else "ratio"
    timed = [name for name in table.columns if name == names.get("time") or _is_time(table, name)]
    if timed and dt is not None:
        raise InputError("cannot use", "dt", f"with column {timed[0]}: {table.file} has times; omit dt")
    if not timed and dt is None:
        raise InputError(
            f"cannot read {table.file}: it has no times; give dt, or write a column "
            f"{'time_s' if measures != 'ratio' else 'time'}"
        )
    wanted = {role: measures}
    if timed:
        wanted["time"] = "ratio" if measures == "ratio" else "time"
    found = pick_columns(table, wanted, names)
    column = found.columns[role]
    unit = COLUMN_NAMES[column.unit] if measures != "ratio" else None
    return Series(column.values, dt, _times(table, found), role, unit, "", remark=found.remark)


def _has_unit(table: Table, name: str) -> bool:
    return table.unit(name) != ""


def _is_time(table: Table, name: str) -> bool:
    return bool(columns_like(table._replace(columns={name: table.columns[name]}), "time", "time", {})) or (
        name.lower() in words_of("time")
    )


def _times(table: Table, found: Columns) -> np.ndarray | None:
    """Times in seconds, or dimensionless ones; increasing."""
    if "time" not in found.columns:
        return None
    time: Column = found.columns["time"]
    check_increasing(table, time, found.rows)
    if time.unit == "1":
        return time.values
    return time.values * float(COLUMN_UNITS[time.unit].size)


def checked_unit(unit: object) -> str:
    """A unit of records, as the table of units writes it."""
    valid = [name for name, one in UNITS.items() if one.measures in MEASURES.values()]
    return checks.choice(unit, "unit", tuple(valid))

"""What a configuration says about columns: their names, and units and calibrations in place of the file's.

columns = { time = "time_s", x = { name = "Weg", unit = "mm", scale = 4.0, offset = 2.5 } }
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ... import checks
from ...errors import InputError
from ...files.config import unknown_key
from ...units.table import COLUMN_NAMES
from .files import Table
from .headings import column_unit, heading, words_of

KEYS = ("name", "unit", "scale", "offset")


class Choice(NamedTuple):
    """A column: value = scale * (number in the file) + offset, in `unit`."""

    name: str | None  # None: as columns of its role are named
    unit: str  # in the form that names of columns end in; "" as the file says
    scale: float
    offset: float


def checked_choices(columns: object, where: str) -> dict[str, Choice]:
    """Choices by role.

    Raises
    ------
    InputError
        They are no table, or a key is unknown or of the wrong type; `where` is the key of the table.
    """
    if not isinstance(columns, Mapping) or not all(
        isinstance(one, (str, Mapping)) for one in columns.values()
    ):
        raise InputError(
            f'{where} must be a table of column names, such as {{ time = "time_s", x = "x_mm" }}; '
            f"got {checks.one_line(columns)}"
        )
    return {role: _checked(one, f"{where}.{role}") for role, one in columns.items()}


def _checked(value: str | Mapping[str, object], where: str) -> Choice:
    if isinstance(value, str):
        return Choice(value, "", 1.0, 0.0)
    for key in value:
        if key not in KEYS:
            raise unknown_key(key, where, KEYS)
    name, unit = value.get("name"), value.get("unit", "")
    for key in ("name", "unit"):
        if key in value and not (isinstance(value[key], str) and value[key]):
            raise InputError(f"{where}.{key} must be text; got {checks.one_line(value[key])}")
    suffix = column_unit(str(unit))
    if unit and not suffix:
        valid = list(COLUMN_NAMES.values())
        raise InputError(
            f"{where}.unit must be one of {', '.join(valid)}; got {unit!r}{checks.nearest(str(unit), valid)}"
        )
    scale = checks.number(value.get("scale", 1.0), f"{where}.scale")
    if scale == 0.0:
        raise InputError(f"{where}.scale must not be 0; got 0: all values would be equal")
    return Choice(
        None if name is None else str(name),
        suffix,
        scale,
        checks.number(value.get("offset", 0.0), f"{where}.offset"),
    )


def chosen(table: Table, choices: Mapping[str, Choice]) -> tuple[Table, dict[str, str]]:
    """A table with the units and calibrations of the choices, and the names of their columns by role."""
    columns, units, names = dict(table.columns), dict(table.units), {}
    for role, choice in choices.items():
        name = _name(table, role, choice)
        if name is not None:
            names[role] = name
        if name is None or name not in columns:  # a missing one is reported where it is needed
            continue
        if choice.unit:
            units[name] = choice.unit
        if (choice.scale, choice.offset) != (1.0, 0.0):
            columns[name] = choice.scale * np.asarray(columns[name]) + choice.offset
    return table._replace(columns=columns, units=units), names


def _name(table: Table, role: str, choice: Choice) -> str | None:
    """Name of a column as the file has it; of its heading, the name without the unit is enough."""
    if choice.name in table.columns:
        return choice.name
    if choice.name is None:
        same = [name for name in table.columns if heading(name).stem.lower() in words_of(role)]
    else:
        same = [
            name for name in table.columns if choice.name in (heading(name).stem, table.aliases.get(name))
        ]
    return same[0] if len(same) == 1 else choice.name

"""Configuration of measured data, and the properties of a kind of data."""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from ...files.config import unknown_key
from ..tables.choices import Choice
from ..tables.columns import Columns, unused_columns
from ..tables.files import Table


class Rig(NamedTuple):
    """A checked configuration; values that depend on the kind of data are checked where they are used."""

    title: str
    kind: str
    file: Path
    columns: Mapping[str, str]  # names in the file, by what the column is, once the file is read
    choices: Mapping[str, Choice]  # what [data] says about columns
    decimal: str | None  # decimal sign of a text file; None: as its numbers show it
    data: Mapping[str, object]  # what else [data] says
    missing: str
    system: Mapping[str, object]
    known: Mapping[str, float]  # in Hz, mm, s, N/m
    free: tuple[str, ...] | None  # None: by kind
    fit: Mapping[str, object]  # what else [fit] says
    text: str
    name: str  # of the configuration, without its ending
    files: tuple[Path, ...]


#: Units of numbers of [known] that have one; as text they may be in another of its kind.
KNOWN_UNITS = {
    "f_n": "Hz", "f_k1m1": "Hz", "x_F": "mm", "X0": "mm", "centre": "mm", "offset_x": "mm", "base_mm": "mm",
    "stiffness": "N/m", "t0": "s", "delay": "s",
}  # fmt: skip


class Kind(NamedTuple):
    """A kind of data: its keys, and the function that fits it."""

    identify: Callable[[Rig, Table], xr.Dataset]
    parameters: tuple[str, ...]  # that [known] may hold and fit.free may name
    known: tuple[str, ...] = ()  # further keys of [known]
    data: tuple[str, ...] = ()  # further keys of [data]
    fit: tuple[str, ...] = ()  # further keys of [fit]
    system: bool = False  # whether there is a table [system]


def check_columns(rig: Rig, valid: Sequence[str]) -> None:
    """Refuse unknown roles in data.columns."""
    for key in rig.columns:
        if key not in valid:
            raise unknown_key(key, "data.columns", tuple(valid))


def with_remarks(ds: xr.Dataset, table: Table, picked: Columns, known_of: Collection[str] = ()) -> xr.Dataset:
    """Put remarks about the table before the warnings of the dataset.

    known_of : columns that the configuration leaves out itself, or that are no numbers; they are not named
    """
    used = {column.name for column in picked.columns.values()} | set(known_of)
    remarks = (
        table.remark, picked.remark, _dropped_rows(table, picked), unused_columns(table, used),
        ds.attrs["warnings"],
    )  # fmt: skip
    ds.attrs["warnings"] = "; ".join(filter(None, remarks))
    return ds


def _dropped_rows(table: Table, picked: Columns) -> str:
    """Warning of ignored rows, or empty."""
    if not picked.dropped:
        return ""
    total = picked.dropped + picked.rows.size
    return f"{picked.dropped} of {total} rows of {table.file.name} have no number and were ignored"

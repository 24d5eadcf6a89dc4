"""Several free decays and records of one mass from the files of a rig."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError, naming
from ...files.config import unknown_key
from ...units.table import conversion
from ..joint_fit.joint import KNOWN, joint
from ..signals.samples import within
from ..tables.choices import checked_choices, chosen
from ..tables.columns import MISSING, check_increasing, pick_columns
from ..tables.files import Table, read_table
from ..tables.text_files import checked_decimal
from .record import RECORD, one_mass_on_base
from .rig import LOSS, STIFFNESS, Kind, Rig, named

#: Kinds of data that can be fitted together, and their columns.
JOINED = {
    "free-decay": {"time": "time", "x": "length"},
    "record": {"time": "time", "base": "length", "x": "length"},
}

#: Keys of each table [[data]].
DATA_KEYS = ("kind", "file", "label", "columns", "decimal", "missing", "window")

#: The unit of all results.
_UNIT = "mm"


def checked_data(tables: list[object]) -> list[dict[str, object]]:
    """Tables [[data]] with every key; labels are their numbers unless they are given.

    Raises
    ------
    InputError
        There are fewer than two, or a key is unknown, missing or of the wrong type.
    """
    if len(tables) < 2:
        raise InputError(
            f"data must be one table [data], or two or more tables [[data]] to be fitted together; "
            f"got {len(tables)} in a list"
        )
    found = [_checked(table, f"data[{index}]", str(index + 1)) for index, table in enumerate(tables)]
    labels = [str(one["label"]) for one in found]
    for label in labels:
        if labels.count(label) > 1:
            raise InputError(f"label must be different in every table [[data]]; got {label!r} twice")
    return found


def _checked(table: object, name: str, label: str) -> dict[str, object]:
    if not isinstance(table, Mapping):
        raise InputError(f"{name} must be a table [[data]]; got {checks.one_line(table)}")
    for key in table:
        if key not in DATA_KEYS:
            raise unknown_key(key, name, DATA_KEYS)
    kind = checks.choice(table.get("kind"), f"{name}.kind", tuple(JOINED))
    result = {"label": label, "columns": {}, "decimal": None, "missing": MISSING[0], "window": None, **table}
    for key in ("file", "label"):
        if not isinstance(result.get(key), str) or not result[key]:
            raise InputError(f"{name}.{key} must be text; got {checks.one_line(result.get(key))}")
    result["columns"] = checked_choices(result["columns"], f"{name}.columns")
    checked_decimal(result["decimal"], f"{name}.decimal")
    for role in result["columns"]:
        if role not in JOINED[kind]:
            raise unknown_key(role, f"{name}.columns", tuple(JOINED[kind]))
    checks.choice(result["missing"], f"{name}.missing", MISSING)
    return result


def fit_together(rig: Rig) -> xr.Dataset:
    """Fit all files of a rig with tables [[data]]; see `joint`."""
    contact, reference = one_mass_on_base(rig)
    parts: Any = rig.data["parts"]
    remarks: list[str] = []
    data = [
        _arrays(read_table(path, part["decimal"]), part, remarks)
        for path, part in zip(rig.files[1:], parts, strict=True)
    ]
    known = dict(rig.known)
    stiffness = known.pop("stiffness", None)
    options: dict[str, Any] = dict(rig.fit)
    with naming(f"files {', '.join(map(str, rig.files[1:]))}"):
        ds = joint(
            data, labels=[part["label"] for part in parts], unit=_UNIT, contact=contact,
            damping_reference=reference, known=known, stiffness=stiffness, **options,
        )  # fmt: skip
    ds.attrs["warnings"] = "; ".join(filter(None, (*remarks, ds.attrs["warnings"])))
    ds.attrs["data_file"] = ", ".join(path.as_posix() for path in rig.files[1:])
    return ds


def _arrays(table: Table, part: Mapping[str, Any], remarks: list[str]) -> list[np.ndarray]:
    """Times [s] and displacements [mm] within the window."""
    wanted = JOINED[part["kind"]]
    table, names = chosen(table, part["columns"])
    picked = pick_columns(table, wanted, names, part["missing"])
    remarks += [f"{part['label']}: {remark}" for remark in (table.remark, picked.remark) if remark]
    check_increasing(table, picked.columns["time"], picked.rows)
    if picked.dropped:
        remarks.append(f"{part['label']}: {picked.dropped} rows have no number and were ignored")
    units = {"time": "s", "length": _UNIT}
    arrays = [
        picked.columns[role].values * conversion(picked.columns[role].unit, units[measures])
        for role, measures in wanted.items()
    ]
    with naming(f"file {table.file}"):
        inside = within(part["window"], arrays[0])
    return [values[inside] for values in arrays]


def data_paths(parts: list[dict[str, object]], folder: Path) -> tuple[Path, ...]:
    """The files of all tables [[data]]."""
    return tuple(folder / str(part["file"]) for part in parts)


def _refused(rig: Rig, table: Table) -> xr.Dataset:
    """Refuse to fit a single table."""
    raise InputError("data must be tables [[data]] for several measurements; got one")


JOINT = Kind(_refused, named(*KNOWN), known=STIFFNESS, fit=(LOSS,), system=RECORD.system)

"""Configurations of measured data: files, known parameters, options of the fit.

A kind of data is a `Kind`: its keys, and the function that fits it.  To add another, write one like
`FREE_DECAY` in `decay` and add it to `KINDS`.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast

import xarray as xr

from ... import checks
from ...errors import InputError
from ...files.config import read_tree, unknown_key
from ...files.key import Key
from ...units.axes import rounded
from ...units.quantities import quantity
from ...units.table import UNITS
from ..parameters import checked_free
from ..tables.choices import checked_choices, chosen
from ..tables.columns import MISSING
from ..tables.files import FORMS, read_table
from ..tables.text_files import checked_decimal
from .decay import FREE_DECAY
from .forced import FORCED
from .joint import JOINT, checked_data, data_paths, fit_together
from .loop import LOOP
from .record import RECORD
from .rig import Kind, Rig
from .sweep import SWEEP

#: Description of every kind of data.
KINDS = {"free-decay": FREE_DECAY, "forced": FORCED, "record": RECORD, "sweep": SWEEP, "loop": LOOP}


#: What several measurements in tables [[data]] are called.
JOINT_NAME = "joint"

#: Endings of what is data, not a configuration.
_DATA = (*FORMS, ".xlsx")


def load_rig(path: str | Path, overrides: Sequence[str] = ()) -> Rig:
    """Read the configuration of a rig and apply overrides such as ``data.file=other.csv``.

    The data file is relative to the folder of the configuration.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing, of the wrong type or out of range.
    """
    _refuse_data(path)
    tree, text = read_tree(path, overrides)
    path = Path(path)
    if isinstance(tree.get("data"), list):
        return _joint_rig(tree, text, path)
    data, known, fit = (_table(tree, name) for name in ("data", "known", "fit"))
    name = _checked_kind(tree, data)
    kind = KINDS[name]
    _check_keys(tree, name, kind)
    file = data.get("file")
    if not isinstance(file, str) or not file:
        given = checks.one_line(file) if "file" in data else "nothing"
        raise InputError(f"data.file must be the path of a file of measured data; got {given}")
    choices = checked_choices(data.get("columns", {}), "data.columns")
    missing = checks.choice(data.get("missing", MISSING[0]), "data.missing", MISSING)
    values, free = _held_and_free(known, fit, kind)
    source = path.parent / file
    return Rig(
        _title(tree, Path(file).stem), name, source, {}, choices,
        checked_decimal(data.get("decimal"), "data.decimal"),
        _chosen(data, kind.data) | _chosen(known, kind.lists), missing,
        _table(tree, "system"), values, free, _chosen(fit, kind.fit), text, path.stem, (path, source),
    )  # fmt: skip


def _joint_rig(tree: Mapping[str, object], text: str, path: Path) -> Rig:
    """A rig with several measurements, tables [[data]]."""
    parts = checked_data(list(cast(list[object], tree["data"])))
    _check_keys({key: value for key, value in tree.items() if key != "data"}, JOINT_NAME, JOINT)
    known, fit = _table(tree, "known"), _table(tree, "fit")
    values, free = _held_and_free(known, fit, JOINT)
    files = data_paths(parts, path.parent)
    return Rig(
        _title(tree, path.stem), JOINT_NAME, files[0], {}, {}, None, {"parts": parts}, MISSING[0],
        _table(tree, "system"),
        values, free, _chosen(fit, JOINT.fit), text, path.stem, (path, *files),
    )  # fmt: skip


def _title(tree: Mapping[str, object], default: str) -> str:
    title = tree.get("title", default)
    if not isinstance(title, str):
        raise InputError(f"title must be text; got {checks.one_line(title)}")
    return title


def identify(rig: Rig) -> xr.Dataset:
    """Fit the data of a rig; see the function of its kind, such as `free_decay`.

    Raises
    ------
    InputError
        The data cannot be read or fitted; the message names the file.
    """
    if rig.kind == JOINT_NAME:
        ds = fit_together(rig)
        ds.attrs |= {"title": rig.title, "config": rig.text}
        return ds
    table, names = chosen(read_table(rig.file, rig.decimal), rig.choices)
    rig = rig._replace(columns=names)
    ds = KINDS[rig.kind].identify(rig, table)
    ds.attrs |= {
        "title": rig.title, "config": rig.text, "data_file": rig.file.as_posix(), "data_form": table.form,
    }  # fmt: skip
    return ds


def _table(tree: Mapping[str, object], name: str) -> Mapping[str, object]:
    table = tree.get(name, {})
    if not isinstance(table, Mapping):
        raise InputError(f"{name} must be a table [{name}]; got {checks.one_line(table)}")
    return table


def _refuse_data(path: object) -> None:
    """Refuse a data file in place of its configuration."""
    if isinstance(path, (str, Path)) and Path(path).suffix.lower() in _DATA:
        raise InputError(
            f"cannot read a configuration from {path}: it is a data file; give a RIG.toml that names it "
            "under data.file"
        )


def _checked_kind(tree: Mapping[str, object], data: Mapping[str, object]) -> str:
    kinds = ", ".join(KINDS)
    if "kind" in data:
        return checks.choice(data["kind"], "data.kind", tuple(KINDS))
    if "grid" in tree:
        raise InputError(
            "cannot identify from a configuration with [grid]: it describes a map; use frictionmap map, "
            f"or give [data] with kind, one of {kinds}"
        )
    raise InputError(f"the configuration must have a table [data] with kind, one of {kinds}; got none")


def _check_keys(tree: Mapping[str, object], name: str, kind: Kind) -> None:
    """Refuse unknown keys of the kind; [system] is checked as in maps, where it is used."""
    sections = {
        "data": ("kind", "file", "columns", "decimal", "missing", *(key.name for key in kind.data)),
        "known": (*kind.numbers, *(key.name for key in kind.lists)),
        "fit": ("free", *(key.name for key in kind.fit)),
    }
    valid = ("title", *sections, *(("system",) if kind.system else ()))
    for key in tree:
        if key not in valid:
            raise _unknown(key, "", valid, name)
    for section, keys in sections.items():
        for key in _table(tree, section):
            if key not in keys:
                raise _unknown(key, section, keys, name)


def _unknown(key: str, section: str, valid: Sequence[str], kind: str) -> InputError:
    """Return the error of a key that is unknown for this kind of data."""
    return InputError(f"data.kind = {kind!r}: {unknown_key(key, section, valid)}")


def _held_and_free(
    known: Mapping[str, object], fit: Mapping[str, object], kind: Kind
) -> tuple[dict[str, float], tuple[str, ...] | None]:
    """Numbers of [known], and fit.free, which must list exactly the parameters that are not known."""
    lists = [key.name for key in kind.lists]
    values = {key: _known_number(value, key, kind) for key, value in known.items() if key not in lists}
    free = fit.get("free")
    if free is not None and not kind.parameters:
        raise InputError(
            "cannot use fit.free for this kind of data: all parameters not in [known] are fitted; omit it"
        )
    return values, checked_free(free, values, tuple(kind.parameters), file=True, optional=kind.optional)


def _known_number(value: object, key: str, kind: Kind) -> float:
    """Convert a number of [known], with a unit to that of the key."""
    unit = kind.numbers[key].unit
    if unit and isinstance(value, str):
        found = quantity(value, f"known.{key}", UNITS[unit].measures)
        number = rounded(found.value / UNITS[unit].size)
        if math.isinf(number):
            raise InputError(f"known.{key} must be finite in {unit}; got {value!r}")
        value = number
    return checks.number(value, f"known.{key}")


def _chosen(table: Mapping[str, object], keys: Sequence[Key]) -> dict[str, object]:
    return {key.name: table[key.name] for key in keys if key.name in table}

"""Configurations of rigs: which file is read, what is known, what is fitted.

A kind of data is a `Kind`: what may be said of it, and the function that fits it.  To build another, write
one like `rig_decay` and add it to `_KINDS`.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import xarray as xr

from .. import checks
from ..errors import InputError
from ..files.config import read_tree, unknown_key
from .columns import MISSING
from .rig import Kind, Rig
from .rig_decay import FREE_DECAY
from .rig_forced import FORCED
from .rig_record import RECORD
from .rig_sweep import SWEEP
from .tables import read_table

_KINDS = {"free-decay": FREE_DECAY, "forced": FORCED, "record": RECORD, "sweep": SWEEP}


def load_rig(path: str | Path, overrides: Sequence[str] = ()) -> Rig:
    """Read the configuration of a rig and apply overrides such as ``data.file=other.csv``.

    The data file is relative to the folder of the configuration.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing, of the wrong type or out of range.
    """
    tree, text = read_tree(path, overrides)
    path = Path(path)
    data, known, fit = (_table(tree, name) for name in ("data", "known", "fit"))
    name = checks.choice(data.get("kind"), "data.kind", tuple(_KINDS))
    kind = _KINDS[name]
    _check_keys(tree, kind)
    file = data.get("file")
    if not isinstance(file, str) or not file:
        raise InputError(
            f"data.file must be the path of a file of measured data; got {checks.one_line(file)}"
        )
    missing = checks.choice(data.get("missing", MISSING[0]), "data.missing", MISSING)
    title = tree.get("title", path.stem)
    if not isinstance(title, str):
        raise InputError(f"title must be text; got {checks.one_line(title)}")
    values = {key: checks.number(value, f"known.{key}") for key, value in known.items()}
    free = _checked_free(fit.get("free"), values, kind.parameters)
    source = path.parent / file
    return Rig(
        title, name, source, _names(data.get("columns", {})), _chosen(data, kind.data), missing,
        _table(tree, "system"), values, free, _chosen(fit, kind.fit), text, path.stem, (path, source),
    )  # fmt: skip


def identify(rig: Rig) -> xr.Dataset:
    """Fit what the data of a rig tell; see the function of its kind, such as `free_decay`.

    Raises
    ------
    InputError
        The data cannot be read or fitted; one line with the file.
    """
    table = read_table(rig.file)
    ds = _KINDS[rig.kind].identify(rig, table)
    ds.attrs |= {
        "title": rig.title, "config": rig.text, "data_file": rig.file.as_posix(), "data_form": table.form,
    }  # fmt: skip
    return ds


def _table(tree: Mapping[str, object], name: str) -> Mapping[str, object]:
    table = tree.get(name, {})
    if not isinstance(table, Mapping):
        raise InputError(f"{name} must be a table [{name}]; got {checks.one_line(table)}")
    return table


def _check_keys(tree: Mapping[str, object], kind: Kind) -> None:
    """Refuse what no key of the kind is; [system] is checked as in maps, where it is used."""
    sections = {
        "data": ("kind", "file", "columns", "missing", *kind.data),
        "known": (*kind.parameters, *kind.known),
        "fit": ("free", *kind.fit),
    }
    legal = ("title", *sections, *(("system",) if kind.system else ()))
    for key in tree:
        if key not in legal:
            raise unknown_key(key, "", legal)
    for name, keys in sections.items():
        for key in _table(tree, name):
            if key not in keys:
                raise unknown_key(key, name, keys)


def _checked_free(
    free: object, known: Mapping[str, float], parameters: Sequence[str]
) -> tuple[str, ...] | None:
    """What is fitted is what is not known: a list of it must say the same."""
    if free is None:
        return None
    if not parameters:
        raise InputError("fit.free must be left out for this kind: what [known] does not hold is fitted")
    if not isinstance(free, list) or not free:
        raise InputError(f"fit.free must be a list of parameters; got {checks.one_line(free)}")
    for index, name in enumerate(free):
        checks.choice(name, f"fit.free[{index}]", tuple(parameters))
    for name in parameters:
        if name in free and name in known:
            raise InputError(f"fit.free must not name what [known] holds; got {name}")
        if name not in free and name not in known:
            raise InputError(f"fit.free must name {name}, or known.{name} give its value; got {free}")
    return tuple(free)


def _names(columns: object) -> dict[str, str]:
    if not isinstance(columns, Mapping) or not all(isinstance(name, str) for name in columns.values()):
        raise InputError(
            f'data.columns must be names of columns, such as {{ time = "time_s", x = "x_mm" }}; '
            f"got {checks.one_line(columns)}"
        )
    return dict(columns)


def _chosen(table: Mapping[str, object], keys: Sequence[str]) -> dict[str, object]:
    return {key: table[key] for key in keys if key in table}

"""Configurations of rigs: which file is read, what is known, what is fitted."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from .. import checks
from ..errors import InputError
from ..files.config import read_tree, unknown_key
from .columns import MISSING, Columns, check_increasing, pick_columns
from .decay_motion import PARAMETERS
from .free_decay import free_decay
from .tables import Table, read_table
from .units import conversion

#: Kinds of data that are fitted, and those that have a name and are not.
_KINDS = ("free-decay",)
_NOT_BUILT = ("forced", "record", "sweep")

_SECTIONS = {
    "title": (),
    "data": ("kind", "file", "columns", "window", "missing"),
    "known": (*PARAMETERS, "base_mm", "stiffness"),
    "fit": ("free",),
}

#: What is given in mm, whatever the unit of the data.
_LENGTHS = ("x_F", "X0", "centre", "base_mm")


class Rig(NamedTuple):
    """A checked configuration."""

    title: str
    file: Path
    columns: Mapping[str, str]
    window: object  # [begin, end] in s, or None
    missing: str
    known: Mapping[str, float]  # in Hz, mm, s, N/m
    text: str
    name: str  # of the configuration, without its ending
    files: tuple[Path, ...]


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
    _check_kind(data)
    for name in ("data", "known", "fit"):
        _check_keys(tree, name)
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
    _check_free(fit.get("free"), values)
    source = path.parent / file
    columns = _names(data.get("columns", {}))
    return Rig(title, source, columns, data.get("window"), missing, values, text, path.stem, (path, source))


def identify(rig: Rig) -> xr.Dataset:
    """Fit what the data of a rig tell; see `free_decay`.

    Raises
    ------
    InputError
        The data cannot be read or fitted; one line with the file.
    """
    table = read_table(rig.file)
    picked = pick_columns(table, {"time": "time", "x": "length"}, rig.columns, rig.missing)
    time, x = picked.columns["time"], picked.columns["x"]
    check_increasing(table, time, picked.rows)
    known = {
        key: value * conversion("mm", x.unit) if key in _LENGTHS else value
        for key, value in rig.known.items()
    }
    base, stiffness = known.pop("base_mm", None), known.pop("stiffness", None)
    try:
        ds = free_decay(
            time.values * conversion(time.unit, "s"), x.values, unit=x.unit, known=known, base=base,
            stiffness=stiffness, window=rig.window,
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"file {rig.file}, columns {time.name} and {x.name}: {error}") from None
    ds.attrs |= {"title": rig.title, "config": rig.text, "data_form": table.form}
    ds.attrs["warnings"] = "; ".join(filter(None, (_dropped(table, picked), ds.attrs["warnings"])))
    return ds


def _table(tree: Mapping[str, object], name: str) -> Mapping[str, object]:
    table = tree.get(name, {})
    if not isinstance(table, Mapping):
        raise InputError(f"{name} must be a table [{name}]; got {checks.one_line(table)}")
    return table


def _check_keys(tree: Mapping[str, object], name: str) -> None:
    """Refuse what no key of a free decay is."""
    for key in tree:
        if key not in _SECTIONS:
            raise unknown_key(key, "", tuple(_SECTIONS))
    for key in _table(tree, name):
        if key not in _SECTIONS[name]:
            raise unknown_key(key, name, _SECTIONS[name])


def _check_kind(data: Mapping[str, object]) -> None:
    kind = data.get("kind")
    if kind in _NOT_BUILT:
        raise InputError(f"data.kind = {kind!r} cannot be fitted yet; {', '.join(_KINDS)} can")
    checks.choice(kind, "data.kind", _KINDS)


def _check_free(free: object, known: Mapping[str, float]) -> None:
    """What is fitted is what is not known: a list of it must say the same."""
    if free is None:
        return
    if not isinstance(free, list) or not free:
        raise InputError(f"fit.free must be a list of parameters; got {checks.one_line(free)}")
    for index, name in enumerate(free):
        checks.choice(name, f"fit.free[{index}]", PARAMETERS)
    for name in PARAMETERS:
        if name in free and name in known:
            raise InputError(f"fit.free must not name what [known] holds; got {name}")
        if name not in free and name not in known:
            raise InputError(f"fit.free must name {name}, or known.{name} give its value; got {free}")


def _names(columns: object) -> dict[str, str]:
    legal = ("time", "x")
    if not isinstance(columns, Mapping) or not all(isinstance(name, str) for name in columns.values()):
        raise InputError(
            f'data.columns must be names of columns, such as {{ time = "time_s", x = "x_mm" }}; '
            f"got {checks.one_line(columns)}"
        )
    for key in columns:
        if key not in legal:
            raise unknown_key(key, "data.columns", legal)
    return dict(columns)


def _dropped(table: Table, picked: Columns) -> str:
    if not picked.dropped:
        return ""
    total = picked.dropped + picked.rows.size
    return f"{picked.dropped} of {total} rows of {table.file.name} have no number and were left out"

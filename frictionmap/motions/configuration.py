"""The tables [record], [history] and [spectrum] of a configuration."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

from ..errors import InputError
from ..files.config import checked_table, common_tables, read_tree, within
from ..model.system import System
from ..units.scales import Units
from .dataset import history
from .record import Record
from .table import records_of

#: Keys of [record] that say how motions are followed, not what the records are.
_OF_MOTIONS = ("scale", "after")


@dataclass(frozen=True)
class Task:
    """A configuration of motions in time."""

    title: str
    name: str  # of the file, without its ending
    text: str  # the TOML text used, overrides applied
    files: tuple[Path, ...]
    motions: int  # how many
    ask: Callable[..., xr.Dataset]


def _read(path: Path, overrides: Sequence[str]) -> tuple[Mapping[str, Any], str, tuple[Record, ...], Any]:
    tree, text = read_tree(path, overrides)
    common = common_tables(tree, path)
    if "record" not in tree:
        raise InputError("the configuration must have a table [record]; got none")
    given = checked_table(tree, "record")
    try:
        records, files = records_of({k: v for k, v in given.items() if k not in _OF_MOTIONS}, path.parent)
    except InputError as error:
        raise (within("record", error) if error.where else error) from None
    return tree, text, records, (common, files)


def _count(*axes: object) -> int:
    found = 1
    for axis in axes:
        found *= len(axis) if isinstance(axis, list) else 1
    return found


def load_history(path: str | Path, overrides: Sequence[str] = ()) -> Task:
    """Read a configuration of motions in time; [grid] is not used.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing or of the wrong type.
    """
    path = Path(path)
    tree, text, records, (common, files) = _read(path, overrides)
    given, record = dict(checked_table(tree, "history")), checked_table(tree, "record")
    arguments = {name: record[name] for name in _OF_MOTIONS if name in record}
    if "friction" in given:
        if "beta" in given:
            raise InputError(
                "cannot use", "history.friction", "with history.beta: both are the friction; omit one"
            )
        given["beta"] = given.pop("friction")
    start = given.get("start")
    if isinstance(start, str) and start != "rest":
        given["start"] = str(path.parent / start)
        files = (*files, path.parent / start)
    arguments |= given
    ask = partial(_ask, common.system, records, common.units, arguments)
    motions = len(records) * _count(*(arguments.get(name) for name in ("scale", "beta", "mu")))
    return Task(common.title, path.stem, text, (*common.files, *files), motions, ask)


def _ask(
    system: System, records: tuple[Record, ...], units: Units | None, arguments: Mapping[str, Any],
    **options: Any,
) -> xr.Dataset:  # fmt: skip
    """Follow the motions; errors name keys of the tables."""
    try:
        return history(system, records, units=units, **arguments, **options)
    except InputError as error:
        where = error.where.partition("[")[0].partition(".")[0]
        table = "record" if where in _OF_MOTIONS else "history"
        raise (within(table, error) if where in (*_OF_MOTIONS, *arguments) else error) from None

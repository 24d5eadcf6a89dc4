"""Which module reads a file, by its ending."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from ... import checks
from ...errors import InputError
from ...units.table import known_unit
from . import cosmos, knet, peer, seismic, tables
from .esm import is_esm, read_esm
from .series import Series

#: Endings of files that state everything about their values themselves.
_STATED = (*(ending.upper() for ending in peer.QUANTITIES), ".EW", ".NS", ".UD", ".V2", ".ASC")


class Given(NamedTuple):
    """What is said about a file besides its path."""

    quantity: str | None = None
    unit: str | None = None
    dt: float | None = None
    decimal: str | None = None
    columns: Mapping[str, object] | None = None


def read_series(path: Path, given: Given) -> Series:
    """Read the samples of a file.

    Raises
    ------
    InputError
        There is no such file, it is of no known format or damaged, or it says something else than is given.
    """
    unit = None if given.unit is None else tables.checked_unit(known_unit(given.unit) or given.unit)
    dt = None if given.dt is None else checks.number(given.dt, "dt", above=0.0)
    if given.quantity is not None:
        checks.choice(given.quantity, "quantity", tuple(tables.MEASURES))
    ending = path.suffix.lower()
    try:
        if not _is_stated(path, ending) and ending in tables.ENDINGS:
            return tables.read_columns(path, given.quantity, dt, unit, given.decimal, given.columns)
        for key in ("dt", "decimal", "columns"):
            if getattr(given, key) is not None:
                raise InputError("cannot use", key, f"with {path.name}: the file states it itself; omit it")
        series = _read_stated(path, ending, given._replace(unit=unit))
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}; check the path") from None
    for key, said in (("quantity", series.quantity), ("unit", series.unit)):
        other = unit if key == "unit" else given.quantity
        if other not in (None, said):
            raise InputError(key, f"must be that of {path.name}, {said}, or be left out; got {other!r}")
    return series


def states_everything(path: Path) -> bool:
    """Whether a file is a record by its ending alone, and not a table that may be something else."""
    ending = path.suffix.lower()
    return ending in (*peer.QUANTITIES, *knet.ENDINGS, *cosmos.ENDINGS) or _is_stated(path, ending)


def _is_stated(path: Path, ending: str) -> bool:
    """Whether a file is in a format that states everything; a table may have the same ending."""
    return ending == ".asc" and is_esm(path)


def _read_stated(path: Path, ending: str, given: Given) -> Series:
    if ending in peer.QUANTITIES:
        return peer.read_peer(path)
    if ending in knet.ENDINGS:
        return knet.read_knet(path)
    if ending == ".asc":
        return read_esm(path)
    if ending in cosmos.ENDINGS:
        return cosmos.read_cosmos(path, given.quantity)
    if ending in seismic.ENDINGS:
        return seismic.read_seismic(path, given.unit)
    valid = ", ".join((*_STATED, *seismic.ENDINGS, *tables.ENDINGS))
    raise InputError("file", f"must end in {valid}; got {path}")

"""What a dataset remembers of how it was made: the system and the start, from the configuration in it."""

import xarray as xr

from .config import parse
from .errors import InputError
from .settings import Solver
from .system import System


def stored_system(ds: xr.Dataset) -> System | None:
    """The system of a dataset; None if it has no configuration, or one that needs a file of matrices."""
    table = _table(ds, "system")
    if table is None or "matrices" in table:
        return None
    try:
        return System(**table)
    except (InputError, TypeError):
        return None


def stored_start(ds: xr.Dataset) -> str | None:
    """The starting state of a map's cells, "rest" or "moving"; None if it has no configuration."""
    if _table(ds, "system") is None:
        return None
    return str((_table(ds, "solver") or {}).get("start", Solver().start))


def _table(ds: xr.Dataset, name: str) -> dict | None:
    """A table of the configuration; None if there is none, or none that can be read."""
    try:
        table = parse(str(ds.attrs.get("config", ""))).get(name)
    except InputError:
        return None
    return table if isinstance(table, dict) else None

"""System and initial state of a dataset, from the configuration stored in it."""

import xarray as xr

from ..errors import InputError
from ..model.settings import Solver
from ..model.system import System
from .config import parse, system_in


def stored_system(ds: xr.Dataset) -> System | None:
    """The system that a dataset was computed for, from its attribute `config`; None if that does not say.

    Then the matrices are in a file of their own or too large to be stored, or there is no configuration.
    """
    return system_in(str(ds.attrs.get("config", "")))


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

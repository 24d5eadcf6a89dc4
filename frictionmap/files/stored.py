"""System and initial state of a dataset, from the configuration stored in it."""

import xarray as xr

from ..errors import InputError
from ..model.general import ContactSystem
from ..model.settings import Solver
from ..model.system import System
from ..solvers.choose import has_closed_forms
from .config import parse, system_in


def stored_system(ds: xr.Dataset) -> System | None:
    """The system that a dataset was computed for, from its attribute `config`; None if that does not say.

    Then the matrices are in a file of their own or too large to be stored, or there is no configuration.
    None also of systems with several contacts, springs, belts or harmonics: what a picture marks of a system,
    its resonant peaks and invariant points, is known for one rigid contact under one harmonic load.
    """
    system = system_in(str(ds.attrs.get("config", "")))
    return system if system is not None and has_closed_forms(system) else None


def stored_contacts(ds: xr.Dataset) -> ContactSystem | None:
    """Contacts and loads of the system of a dataset, from `config`; None where that does not say."""
    system = system_in(str(ds.attrs.get("config", "")))
    return None if system is None else system.contact_system


def has_equal_friction(ds: xr.Dataset, mu: float) -> bool:
    """Whether static and kinetic friction of every contact of a dataset are equal at this mu of its grid.

    The list of contacts says so, also where the matrices are in a file of their own; its numbers may have
    units.
    """
    contacts = (_table(ds, "system") or {}).get("contacts")
    if contacts is None:
        return mu == 1.0
    rigid = [one for one in contacts if one.get("stiffness") is None]
    return all(one.get("mu", mu) == 1.0 for one in rigid)


def stored_excitation(ds: xr.Dataset) -> str | None:
    """Excitation of the system: "base", "force" or "forces", see `excitation_of`; None if unknown.

    Files made before there was an attribute `excitation` have it in their configuration.
    """
    if "excitation" in ds.attrs:
        return str(ds.attrs["excitation"])
    table = _table(ds, "system")
    if table is None:
        return None
    if "load" in table:
        return "forces"
    moves = table.get("excitation") == "base" or table.get("contact") == "joined-base-wall"
    return "base" if moves else "force"


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

"""States at the beginning of a motion: at rest, given, or where another motion ended."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import checks
from .._kernels.history.course import BY_LAW
from ..errors import InputError
from ..files.opening import open as open_dataset
from ..model.general import DISPLACEMENT
from ..model.system import System
from .structure import Structure


class Start(NamedTuple):
    """State at the beginning."""

    q: np.ndarray  # (m,)
    p: np.ndarray  # (m,) q'
    f: np.ndarray  # (N,) forces of springs in contacts
    sense: np.ndarray  # (N,) int; BY_LAW where it follows from the velocities

    @property
    def moves(self) -> bool:
        """Whether it is not the state of rest without forces."""
        return bool(self.q.any() or self.p.any() or self.f.any())


def start_of(structure: Structure, given: Any) -> Start:
    """The state that a motion begins with; see `history`."""
    m, contacts = structure.modal.chi.shape[1], structure.spring.size
    by_law = np.full(contacts, BY_LAW)
    if isinstance(given, xr.Dataset):
        return _from_motion(structure, given)
    if isinstance(given, (str, Path)) and given != "rest":
        return _from_motion(structure, open_dataset(given))
    if isinstance(given, Mapping):
        return _from_mapping(structure, given)
    if given != "rest":
        raise InputError(
            "start",
            f'must be "rest", {{ x = [...], v = [...] }}, a motion or its file; got {checks.one_line(given)}',
        )
    return Start(np.zeros(m), np.zeros(m), np.zeros(contacts), by_law)


def _modal(structure: Structure, x: np.ndarray) -> np.ndarray:
    return structure.modal.phi.T @ (structure.modal.mass @ x)


def _vector(given: Any, name: str, n: int) -> np.ndarray:
    values = checks.array(given, name).astype(float)
    if values.shape != (n,) or not np.isfinite(values).all():
        raise InputError(name, f"must have one finite number per mass ({n}); got {values.tolist()}")
    return values


def _from_mapping(structure: Structure, given: Mapping) -> Start:
    n, contacts = structure.system.n, structure.spring.size
    for key in given:
        if key not in ("x", "v"):
            raise InputError(f"unknown key {f'start.{key}'!r}; valid: x, v")
    x, v = (_vector(given.get(key, np.zeros(n)), f"start.{key}", n) for key in ("x", "v"))
    return Start(_modal(structure, x), _modal(structure, v), np.zeros(contacts), np.full(contacts, BY_LAW))


def _base_at_start(system: System, r: float) -> tuple[float, float]:
    """Displacement of the base of a response at tau = 0, and its velocity over tau; 0 of loads on masses."""
    given = system if system.base_control == DISPLACEMENT else system.at_frequency(r)
    base = given.contact_system.base
    return sum(one.real for one in base.values()), sum(-n * one.imag for n, one in base.items())


def _from_motion(structure: Structure, ds: xr.Dataset) -> Start:
    """The last state of a history, or that of a response at tau = 0, which is its last one, too."""
    axis = "time" if "time" in ds.dims else "tau"
    needed = [axis, "x", "v", "friction", "direction"]
    missing = [name for name in needed if name not in ds.variables]
    if missing:
        raise InputError("start", f"must have {', '.join(needed)}, as a history has; got no {missing[0]}")
    last = ds.isel({axis: -1}).squeeze()
    n, contacts = structure.system.n, structure.spring.size
    x, v = _vector(np.atleast_1d(last["x"]), "start.x", n), _vector(np.atleast_1d(last["v"]), "start.v", n)
    rate = 1.0
    if axis == "tau":  # a response has velocities over tau, and displacements in space
        rate = float(ds["r"])
        place, velocity = _base_at_start(structure.system, rate)
        x, v = x - place, v - velocity
    f, sense = np.atleast_1d(last["friction"]).astype(float), np.atleast_1d(last["direction"])
    if f.shape != (contacts,):
        raise InputError("start", f"must have {contacts} contacts, as the system has; got {f.size}")
    springs = structure.spring > 0.0
    return Start(
        _modal(structure, x), rate * _modal(structure, v), np.where(springs, f, 0.0), sense.astype(int)
    )

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

#: Difference of displacements of points from those of modes, over the largest, that is rounding error.
_BESIDE = 1e-9


class Start(NamedTuple):
    """State at the beginning."""

    q: np.ndarray  # (m,)
    p: np.ndarray  # (m,) q'
    f: np.ndarray  # (N,) forces of springs in contacts
    sense: np.ndarray  # (N,) int; BY_LAW where it follows from the velocities
    stretch: np.ndarray | None = None  # (E,) elongations of the springs of the elements of banks; None: 0

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


def _modal(structure: Structure, x: np.ndarray, name: str) -> np.ndarray:
    """The modes (m,) that move the masses, or points, by x."""
    if structure.points is None:
        return np.asarray(structure.modal.phi.T @ (structure.modal.mass @ x))
    found, _, rank, _ = np.linalg.lstsq(structure.shapes, x)
    modes, off = structure.shapes.shape[1], np.abs(structure.shapes @ found - x).max()
    if x.any() and (rank < modes or off > _BESIDE * np.abs(x).max()):
        raise InputError(
            name,
            f"must determine the {modes} modes, as displacements of as many independent points, that agree "
            f"with them; give q and q_rate, those of the modes; got {checks.one_line(x.tolist())}",
        )
    return np.asarray(found) if x.any() else np.zeros(modes)


def _vector(given: Any, name: str, n: int, each: str = "mass") -> np.ndarray:
    values = checks.array(given, name).astype(float)
    if values.shape != (n,) or not np.isfinite(values).all():
        raise InputError(name, f"must have one finite number per {each} ({n}); got {values.tolist()}")
    return values


def _turned(structure: Structure, given: Any, name: str) -> np.ndarray:
    """Modal coordinates (m,) of a structure from those of the modes that it was given by."""
    q = _vector(given, name, structure.modal.squares.size, "mode")
    return np.asarray(np.linalg.solve(structure.given_modes, q))


def _from_mapping(structure: Structure, given: Mapping) -> Start:
    valid = ("x", "v") if structure.points is None else ("x", "v", "q", "q_rate")
    for key in given:
        if key not in valid:
            raise InputError(f"unknown key {f'start.{key}'!r}; valid: {', '.join(valid)}")
    q, p = (_part(structure, given, *keys) for keys in (("x", "q"), ("v", "q_rate")))
    contacts = structure.spring.size
    return Start(q, p, np.zeros(contacts), np.full(contacts, BY_LAW))


def _part(structure: Structure, given: Mapping, key: str, modal: str) -> np.ndarray:
    """Modal displacements or velocities (m,) that are given as such, or of the masses or points; else 0."""
    if key in given and modal in given:
        raise InputError("cannot use", f"start.{modal}", f"with start.{key}: both are the same; omit one")
    if modal in given:
        return _turned(structure, given[modal], f"start.{modal}")
    n, name = structure.system.n, f"start.{key}"
    return _modal(structure, _vector(given.get(key, np.zeros(n)), name, n, structure.system.dofs.noun), name)


def _base_at_start(system: System, r: float) -> tuple[float, float]:
    """Displacement of the base of a response at tau = 0, and its velocity over tau; 0 of loads on masses."""
    given = system if system.base_control == DISPLACEMENT else system.at_frequency(r)
    base = given.contact_system.base
    return sum(one.real for one in base.values()), sum(-n * one.imag for n, one in base.items())


def _from_motion(structure: Structure, ds: xr.Dataset) -> Start:
    """The last state of a history, or that of a response at tau = 0, which is its last one, too."""
    axis = "time" if "time" in ds.dims else "tau"
    by_modes = structure.points is not None and (axis == "time" or structure.softer)
    place, velocity = ("modal_place", "modal_velocity") if by_modes else ("x", "v")
    banks = structure.system.contact_system.has_banks
    needed = [axis, place, velocity, "friction", "direction", *(["elongation"] if banks else [])]
    missing = [name for name in needed if name not in ds.variables]
    if missing:
        raise InputError("start", f"must have {', '.join(needed)}, as a history has; got no {missing[0]}")
    last = ds.isel({axis: -1}).squeeze()
    contacts, n = structure.spring.size, structure.system.n
    rate, base = 1.0, (0.0, 0.0)
    if axis == "tau":  # a response has velocities over tau, and displacements in space
        rate = float(ds["r"])
        base = (0.0, 0.0) if by_modes else _base_at_start(structure.system, rate)
    carried = 1.0 if structure.points is None else structure.points.carried

    def part(name: str, moved: float) -> np.ndarray:
        given = np.atleast_1d(last[name])
        if by_modes:
            return _turned(structure, given, f"start.{name}")
        return _modal(structure, _vector(given, f"start.{name}", n) - moved * carried, f"start.{name}")

    q, p = part(place, base[0]), part(velocity, base[1])
    f, sense = np.atleast_1d(last["friction"]).astype(float), np.atleast_1d(last["direction"])
    if f.shape != (contacts,):
        raise InputError("start", f"must have {contacts} contacts, as the system has; got {f.size}")
    stretch = _stretch(structure, ds, last) if banks else None
    springs = structure.spring > 0.0
    return Start(q, rate * p, np.where(springs, f, 0.0), sense.astype(int), stretch)


def _stretch(structure: Structure, ds: xr.Dataset, last: xr.Dataset) -> np.ndarray:
    """Elongations of the springs of the elements of banks, which a history has at its end."""
    if "end_time" in ds and not np.isclose(float(last["time"]), float(last["end_time"]), rtol=1e-9):
        raise InputError(
            "start",
            f"must have its last sample at its end, {float(last['end_time']):g}, where the elongations of "
            f'the elements are; got {float(last["time"]):g}; make it with samples = "all"',
        )
    count = sum(group.element_count for group in structure.system.contact_system.groups)
    found = np.atleast_1d(last["elongation"]).astype(float)
    if found.shape != (count,):
        raise InputError("start", f"must have {count} elements, as the system has; got {found.size}")
    return found

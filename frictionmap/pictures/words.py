"""Titles, captions, and the names of loads."""

import re

import numpy as np
import xarray as xr

from ..files.stored import stored_excitation, stored_start
from ..units.table import wrapped


def balanced(text: str, width: int) -> str:
    """Wrap text into as few lines of `width` characters as possible, all of about equal length."""
    lines = wrapped(text, width)
    narrow = max(1, -(-len(text) // max(1, len(lines))))
    while len(wrapped(text, narrow)) > len(lines):
        narrow += 1
    return "\n".join(wrapped(text, narrow))


def system_words(ds: xr.Dataset) -> str:
    """Description of the system from the file, with repeated numbers written once."""
    words = str(ds.attrs.get("system", ""))
    return re.sub(r"(?<=[( ])([^\s,()]+)(?:, \1(?=[,)])){2,}", _times, words)


def _times(repeated: re.Match) -> str:
    return f"{repeated[0].count(',') + 1} × {repeated[1]}"


def name_of_contact(ds: xr.Dataset) -> str:
    """Name of the contact that was chosen of several, such as "contact 2 (joint)"; empty if there is none."""
    if "contact" not in ds.coords or ds["contact"].ndim:
        return ""
    name = f" ({ds['contact_name'].item()})" if "contact_name" in ds.coords else ""
    return f"contact {int(ds['contact'])}{name}"


def _points(ds: xr.Dataset) -> list[str]:
    """Names of the points of a structure given by modes; none of masses."""
    names = ds["point_name"].values if "point_name" in ds.coords else np.empty(0, dtype=str)
    return [str(name).replace("$", r"\$") for name in np.atleast_1d(names)]  # not as formulas


def names_of_masses(ds: xr.Dataset) -> list[str]:
    """Names along `dof`, such as "mass 2" or "point tip"."""
    points = [f"point {name}" for name in _points(ds)]
    return points or [f"mass {number}" for number in np.atleast_1d(ds["dof"].values)]


def symbols_of_masses(ds: xr.Dataset) -> list[str]:
    """What displacements along `dof` are called at the ends of their lines: symbols, or names of points."""
    return _points(ds) or [rf"$x_{{{number}}}$" for number in np.atleast_1d(ds["dof"].values)]


def title_of_map(ds: xr.Dataset) -> str:
    """Title of a map: its own, and the contact that was chosen."""
    return ", ".join(filter(None, (str(ds.attrs.get("title", "")), name_of_contact(ds))))


def moves_base(ds: xr.Dataset) -> bool:
    """Whether the system has base excitation."""
    return stored_excitation(ds) == "base"


def length_unit(ds: xr.Dataset) -> str:
    """Unit of displacements in a figure: the amplitude of the base where it moves."""
    return "$Y$" if moves_base(ds) else "$(P/k_1)$"


#: Labels of cos(tau), by the excitation.
_LOADS: dict[str | None, str | None] = {"base": "base / $Y$", "forces": None}


def load_of(ds: xr.Dataset) -> str | None:
    """Label of cos(tau); None where loads are given mass by mass, each with its own phase."""
    return _LOADS.get(stored_excitation(ds), "load / $P$")


#: Grid points per axis above which a panel has fewer pixels than the map has cells.
_MANY = 640


_STARTS: dict[str | None, str] = {"rest": "start: at rest", "moving": "start: moving"}


def caption(ds: xr.Dataset, *, cells_counted: bool = False) -> str:
    """Heading of a legend: system, damping, and how to read the numbers."""
    parts = [system_words(ds)]
    if cells_counted:
        parts.append(_STARTS.get(stored_start(ds), ""))
        parts.append("in brackets: numbers of cells")
        if max(ds.sizes["r"], ds.sizes["beta"]) > _MANY:
            parts.append(
                "cells that share a pixel show the most frequent class; isolated cells are never dropped"
            )
    return "; ".join(part for part in parts if part)

"""Summaries of files with further axes and of stores, finished or not, read part by part."""

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.labels import CELL, CELL_VARIABLES, COORDINATES, LABELS, MARKS
from ..datasets.schema import check_structure, in_brackets, is_own, kind
from ..errors import InputError, naming
from .reading import opened
from .slices import further_axes, natural
from .summary import (
    axis_lines,
    describe_reduction,
    header_lines,
    in_causes,
    in_cells,
    name_lines,
    variable_lines,
)

#: Cells that are read at a time: those of a block of a store.
_AT_ONCE = 1 << 20


def is_study(path: Path) -> bool:
    """Whether a file is a store of maps or has further axes."""
    with opened(path) as ds, naming(f"file {path}"):
        check_structure(ds, in_parts=True)
        return not is_own(kind(ds)) and (MARKS in ds or bool(further_axes(ds)))


def describe_study(path: Path, verbose: bool = False) -> str:
    """Describe on one screen: title, system, axes, variables, finished blocks, regimes of their cells.

    verbose : also the meanings of variables, the program and the command that wrote it

    Raises
    ------
    InputError
        An axis has no value, or the marks of blocks are not along the axes of the cells.
    """
    with opened(path) as found:
        with naming(f"file {path}"):
            ds = _reorder(found)
            _check_sizes(ds)
        variables = variable_lines(ds) if verbose else name_lines(ds)
        lines = [*header_lines(ds, "map", verbose), *axis_lines(ds), *variables]
        lines += _blocks(ds)
        cells, *causes = cell_lines(ds)
        return "\n".join([*lines, cells, *(f"  {line}" for line in causes)])


def _reorder(ds: xr.Dataset) -> xr.Dataset:
    """Axes and variables as a map has them: a store lists them in any order."""
    others = [name for name in ds.coords if name not in COORDINATES and ds[name].dtype.kind in "iufU"]
    numbers = sorted(map(str, others), key=natural)
    known = dict.fromkeys((*further_axes(ds), *numbers, *COORDINATES))
    coords = {name: ds.variables[name] for name in known if name in ds.coords}
    variables = {name: ds.variables[name] for name in (*LABELS, MARKS) if name in ds.data_vars}
    return xr.Dataset(variables, coords, ds.attrs)


def _check_sizes(ds: xr.Dataset) -> None:
    """Refuse files without cells, and marks that do not match the blocks."""
    for dim in (*further_axes(ds), *CELL):
        if ds.sizes.get(dim, 1) == 0:
            raise InputError(f"{dim} must have at least one value; got none")
    for name in {"regime", "status"} & set(ds.variables) if MARKS in ds else ():
        dims = {*ds[name].dims, "row_block"} - {"r", "beta"}
        if set(ds[MARKS].dims) != dims:
            raise InputError(
                f"{MARKS} must have the dimensions {in_brackets(sorted(map(str, dims)))}; "
                f"got {in_brackets(ds[MARKS].dims)}"
            )


def describe_cells(path: Path) -> list[str]:
    """Count the cells of a store by regime and by cause of unresolved cells."""
    with opened(path) as ds:
        return [*cell_lines(ds), *describe_reduction(ds)]


def cell_lines(ds: xr.Dataset) -> list[str]:
    """Count cells by regime and by cause of unresolved cells."""
    codes = {"regime": regimes.BELT_REGIMES, "status": regimes.STATUSES}
    found = {}
    for name, known in codes.items():
        counter = count_codes(ds, name)
        found[name] = [(code, counter[code.value]) for code in known if counter[code.value]]
    further = [dim for dim in further_axes(ds) if dim != "contact"]  # a cell has several contacts
    dims = (*further, *CELL)
    cells = math.prod(ds.sizes.get(dim, 1) for dim in dims)
    return [in_cells(cells, found["regime"]), *in_causes(found["status"])]


def _blocks(ds: xr.Dataset) -> Iterator[str]:
    if MARKS in ds:
        marks = ds[MARKS].values
        done = int(np.count_nonzero(marks))
        words = "all computed" if done == marks.size else "repeat the command to resume"
        yield f"{done:,} of {marks.size:,} blocks; {words}"


def count_codes(ds: xr.Dataset, name: str) -> Counter[int]:
    """Count cells by code, reading part by part and only where blocks are computed."""
    counter: Counter[int] = Counter()
    if name not in ds:
        return counter
    variable = ds[name]
    outer = [str(dim) for dim in variable.dims if dim not in ("r", "beta")]
    begun = (ds[MARKS] != 0).any("row_block").transpose(*outer).values if MARKS in ds else None
    for place in np.ndindex(*(variable.sizes[dim] for dim in outer)):
        one = variable.isel(dict(zip(outer, place, strict=True)))
        if begun is not None and not begun[place]:
            counter[int(CELL_VARIABLES[name].unresolved)] += one.size
            continue
        for part in _row_blocks(one):
            values, counts = np.unique(part.values, return_counts=True)
            counter.update(dict(zip(values.tolist(), counts.tolist(), strict=True)))
    return counter


def _row_blocks(one: xr.DataArray) -> Iterator[xr.DataArray]:
    """The cells of one map, whole rows of them at a time."""
    step = max(1, _AT_ONCE // one.sizes.get("beta", 1))
    for first in range(0, one.sizes.get("r", 1), step):
        yield one.isel(r=slice(first, first + step), missing_dims="ignore")

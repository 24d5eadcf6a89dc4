"""Files with further axes, and stores, in words; read part by part, finished or not."""

import math
import string
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.labels import CELL, COORDINATES, LABELS, MARKS
from ..datasets.schema import check_structure
from .reading import opened
from .slices import further_axes
from .summary import axis_lines, header_lines, in_causes, in_cells, variable_lines


def is_study(path: Path) -> bool:
    """Whether a file is a store or has further axes."""
    with opened(path) as ds:
        check_structure(ds)
        return MARKS in ds or bool(further_axes(ds))


def describe_study(path: Path) -> str:
    """One screen: title, system, axes, variables, blocks that are done, regimes of the cells in them."""
    with opened(path) as found:
        ds = _in_order(found)
        lines = [*header_lines(ds, "map"), *axis_lines(ds), *variable_lines(ds)]
        lines += _blocks(ds)
        cells, *causes = cell_lines(ds)
        return "\n".join([*lines, cells, *(f"  {line}" for line in causes)])


def _in_order(ds: xr.Dataset) -> xr.Dataset:
    """Axes and variables as a map has them: a store lists them in any order."""
    numbers = sorted(
        (str(name) for name in ds.coords if name not in COORDINATES),
        key=lambda name: (name.rstrip(string.digits), len(name), name),  # ratios_2 before ratios_10
    )
    known = dict.fromkeys((*further_axes(ds), *numbers, *COORDINATES))
    coords = {name: ds.variables[name] for name in known if name in ds.coords}
    variables = {name: ds.variables[name] for name in (*LABELS, MARKS) if name in ds.data_vars}
    return xr.Dataset(variables, coords, ds.attrs)


def describe_cells(path: Path) -> list[str]:
    """How many cells a store has of each regime, and why some are unresolved."""
    with opened(path) as ds:
        return cell_lines(ds)


def cell_lines(ds: xr.Dataset) -> list[str]:
    """How many cells of each regime, and why some are unresolved."""
    codes = {"regime": regimes.REGIMES, "status": regimes.STATUSES}
    found = {}
    for name, known in codes.items():
        counter = count_codes(ds, name)
        found[name] = [(code, counter[code.value]) for code in known if counter[code.value]]
    dims = (*further_axes(ds), *CELL)
    cells = math.prod(ds.sizes[dim] for dim in dims)
    return [in_cells(cells, found["regime"]), *in_causes(found["status"])]


def _blocks(ds: xr.Dataset) -> Iterator[str]:
    if MARKS in ds:
        marks = ds[MARKS].values
        done = int(np.count_nonzero(marks))
        words = "all are computed" if done == marks.size else "run the command again to go on"
        yield f"{done:,} of {marks.size:,} blocks; {words}"


def count_codes(ds: xr.Dataset, name: str) -> Counter[int]:
    """How many cells have each code; read row by row of the further axes and mu."""
    counter: Counter[int] = Counter()
    if name in ds:
        variable = ds[name]
        outer = [dim for dim in variable.dims if dim not in ("r", "beta")]
        for place in np.ndindex(*(variable.sizes[dim] for dim in outer)):
            part = variable.isel(dict(zip(outer, place, strict=True)))
            values, counts = np.unique(part.values, return_counts=True)
            counter.update(dict(zip(values.tolist(), counts.tolist(), strict=True)))
    return counter

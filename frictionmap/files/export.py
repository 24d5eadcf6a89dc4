"""Export of slices of files and stores as NetCDF or CSV."""

import math
from pathlib import Path
from typing import Any

import xarray as xr

from .. import checks
from ..datasets.estimate_labels import OF_PARAMETERS
from ..datasets.labels import COORDINATES
from ..datasets.motion_labels import CELL, axes_of_motions
from ..datasets.schema import kind
from ..errors import InputError
from .short_tables import cell_table, decode_flags, design_table, is_single, short_table
from .storage import write_netcdf

FORMATS = (".nc", ".csv")


def check_export(path: Path) -> None:
    """Refuse a file name with an unknown suffix."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"-o must end in {' or '.join(FORMATS)}; got {path}")


def write_export(ds: xr.Dataset, path: Path, command: str = "", everything: bool = False) -> None:
    """Write a dataset as NetCDF or as `csv_of` returns it."""
    if path.suffix.lower() == ".nc":
        write_netcdf(ds, path, command)
    else:
        _table(ds, everything).to_csv(path)


def csv_of(ds: xr.Dataset, everything: bool = False) -> str:
    """Return a dataset as CSV, with the names of codes.

    everything : all variables of motions and response curves, in place of their short tables
    """
    return str(_table(ds, everything).to_csv(lineterminator="\n"))


def in_rows(ds: xr.Dataset) -> str:
    """What a row of the table of several motions is, and how to get one over time; of others nothing."""
    if kind(ds) != "history" or "time" not in ds.dims or is_single(ds):
        return ""
    axes = [axis for axis in (*axes_of_motions(ds), *CELL) if ds.sizes.get(axis, 1) > 1]
    at = " ".join(f"--at {axis}={ds[axis].values[0]:g}" for axis in axes)
    return f", a row per motion; {at} writes one of them over time"


def _table(ds: xr.Dataset, everything: bool = False) -> Any:
    """Data frame: of motions, curves and cells a short one, else a row for every point of all axes.

    Of estimates it is a row for every parameter; of the result of a design question it is the curve that was
    searched.
    """
    what = kind(ds)
    short = None if everything else short_table(ds)
    if short is not None:
        return short
    if what == "estimates":
        return ds[list(OF_PARAMETERS)].to_dataframe()
    if what == "design":
        return design_table(ds, everything)
    if what in ("belt", "history", "spectrum", "shares"):
        return cell_table(ds, everything)
    dims = [str(name) for name in COORDINATES if name in ds.dims]
    table: dict[str, xr.DataArray] = {}
    for name, variable in ds.data_vars.items():
        if set(variable.dims) <= set(dims):
            table[str(name)] = decode_flags(variable, what)
        elif set(variable.dims) - set(dims) == {"contact"}:
            table |= _split_contacts(str(name), decode_flags(variable, what))
    wide = xr.Dataset(table)
    checks.cells(1, 1, math.prod(wide.sizes.values()), name="a table")
    return wide.to_dataframe(dim_order=[dim for dim in dims if dim in wide.dims])


def _split_contacts(name: str, variable: xr.DataArray) -> dict[str, xr.DataArray]:
    """A variable of every contact as one of each, by the numbers of the contacts."""
    numbers = range(1, variable.sizes["contact"] + 1)
    return {f"{name}_{k}": variable.isel({"contact": k - 1}, drop=True) for k in numbers}

"""Files that are read: with a check that they are ours."""

from pathlib import Path

import xarray as xr

from .errors import InputError
from .labels import LABELS


def read(path: Path) -> xr.Dataset:
    """Read a file that this package wrote, as it is (nothing is held open)."""
    if not path.is_file():
        wrong = "is not a file" if path.exists() else "does not exist"
        raise InputError(f"file {path} {wrong}; give a file written by frictionmap")
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            ds = opened.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(
            f"file {path} must be NetCDF written by frictionmap; it cannot be opened ({error})"
        ) from None
    if not str(ds.attrs.get("source", "")).startswith("frictionmap") or not any(
        name in LABELS for name in ds.data_vars
    ):
        raise InputError(
            f"file {path} must be written by frictionmap; "
            f"its source is {ds.attrs.get('source', 'not given')!r}"
        )
    return ds


def kind(ds: xr.Dataset) -> str:
    """What a dataset holds: "map", "response" or "boundaries"."""
    if "tau" in ds.dims:
        return "response"
    return "map" if "beta" in ds.dims else "boundaries"

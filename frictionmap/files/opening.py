"""`open`: a file or store of the package as a dataset."""

from pathlib import Path

import xarray as xr

from .. import checks
from ..datasets.schema import with_current_names
from ..errors import InputError
from .reading import opened


def open(path: str | Path) -> xr.Dataset:  # fm.open
    """Read a file or store written by frictionmap: a map, curves, a motion, borders, estimates, a design.

    Parameters
    ----------
    path : str or Path
        A NetCDF file, or a zarr store.

    Returns
    -------
    xarray.Dataset
        In memory, with its names and labels as the functions of this version return them, whichever version
        wrote it.

    Raises
    ------
    InputError
        It cannot be read, was not written by frictionmap, or is damaged.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.open("map.nc")  # doctest: +SKIP
    >>> ds.frictionmap.labels  # doctest: +SKIP
    """
    if not isinstance(path, (str, Path)):
        raise InputError("path", f"must be the path of a file or store; got {checks.one_line(path)}")
    with opened(Path(path)) as ds:
        return with_current_names(ds).load()

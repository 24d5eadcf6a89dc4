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
    >>> import tempfile
    >>> from pathlib import Path
    >>> import frictionmap as fm
    >>> path = Path(tempfile.mkdtemp()) / "map.nc"
    >>> fm.sweep(fm.System(), r=[0.3], beta=[0.01, 0.5, 1.0]).to_netcdf(path)
    >>> fm.open(path).frictionmap.labels.values.ravel().tolist()
    ['continuous', 'stick-slip', 'permanent-sticking']
    """
    if not isinstance(path, (str, Path)):
        raise InputError("path", f"must be the path of a file or store; got {checks.one_line(path)}")
    with opened(Path(path)) as ds:
        return with_current_names(ds).load()

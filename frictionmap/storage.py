"""Files: written beside their place and moved there whole."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import xarray as xr

from .errors import InputError

#: A regime map of 10^6 cells takes 32 kB at this level; higher ones only take longer.
_COMPRESSION = {"zlib": True, "complevel": 4, "shuffle": True}


def check_output(path: Path, overwrite: bool) -> None:
    """Refuse a place that cannot be written to, before any work is done."""
    try:
        if path.is_dir():
            raise InputError(f"-o must be a file; got the folder {path}")
        if not path.parent.is_dir():
            raise InputError(f"-o must lie in a folder that exists; got {path}")
        if path.exists() and not path.is_file():  # /dev/null, say: it would be replaced by a file
            raise InputError(f"-o must be an ordinary file; got {path}")
        if path.exists() and not overwrite:
            raise InputError(f"output {path} exists already; use --overwrite or another -o")
        _scratch_beside(path).unlink()
    except OSError as error:
        raise InputError(
            f"-o must be a place that can be written to; got {path} ({error.strerror})"
        ) from None


def _scratch_beside(path: Path) -> Path:
    """A new empty file in the same folder, with the same ending."""
    handle, name = tempfile.mkstemp(prefix=".frictionmap-", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    return Path(name)


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A name beside `path` to write to; what was written appears as `path` if all went well."""
    scratch = _scratch_beside(path)
    try:
        yield scratch
        umask = os.umask(0)
        os.umask(umask)
        scratch.chmod(0o666 & ~umask)  # as any other new file, not private as temporary ones are
        os.replace(scratch, path)
    finally:
        scratch.unlink(missing_ok=True)


def write(ds: xr.Dataset, path: Path, command: str = "") -> None:
    """Write a dataset as NetCDF-4, whole or not at all."""
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    ds = ds.assign_attrs(history=f"{now} {command}".strip())
    # no fill value: it would turn integer codes into floats on reading, and CF forbids it on axes
    encoding: dict = {name: {"_FillValue": None} for name in ds.variables}
    for name, variable in ds.data_vars.items():
        if variable.ndim:
            encoding[name] |= _COMPRESSION
    with whole_file(path) as scratch:
        try:
            ds.to_netcdf(scratch, format="NETCDF4", engine="netcdf4", encoding=encoding)
        except RuntimeError as error:  # the library's word for any trouble, a full disk above all
            raise OSError(f"{path} cannot be written ({error}); is there room on the disk?") from error

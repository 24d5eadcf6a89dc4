"""Arrays of MAT files, of all versions."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .packages import package, read_by


def read_mat(path: Path) -> tuple[dict[str, Any], str]:
    """Read the numbers of a MAT file as arrays or sparse arrays by name; return them and the file format.

    Fields of structures have the names of both with a point between, such as run.x_mm.  Version 7.3, which is
    HDF5, is read through h5py of the extra `lab`; its texts are left out.  Logical ones are bool.

    Raises
    ------
    InputError
        It is no such file, or the package is not installed.
    """
    from scipy.io import loadmat, whosmat

    def read() -> dict[str, Any] | None:
        try:
            with open(path, "rb") as file:
                logical = {name for name, _, kind in whosmat(file) if kind == "logical"}
                file.seek(0)
                stored = loadmat(file, spmatrix=False)
            return {
                name: one.astype(bool) if name in logical else one
                for key, whole in stored.items()
                if key[:2] != "__"
                for name, one in _fields(str(key), whole)
            }
        except NotImplementedError:  # what scipy says of version 7.3
            return None

    stored = read_by(path, "MAT file", read)
    return (stored, "MAT") if stored is not None else (_read_hdf(path), "MAT v7.3")


def _fields(name: str, one: Any) -> Iterator[tuple[str, Any]]:
    """An array, or those of a structure."""
    names = getattr(getattr(one, "dtype", None), "names", None)
    if not names or one.size != 1:
        yield name, one
        return
    for field in names:
        yield from _fields(f"{name}.{field}", one.flat[0][field])


def _read_hdf(path: Path) -> dict[str, Any]:
    h5py = package("h5py", path, "lab")

    def read() -> dict[str, Any]:
        with h5py.File(path, "r") as stored:
            found = {name: _numbers(h5py, one) for name, one in _variables(h5py, stored)}
            return {name: one for name, one in found.items() if one is not None}

    return read_by(path, "MAT file", read)


def _variables(h5py: Any, group: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Variables, and those of structures."""
    for name, one in group.items():
        if str(name).startswith("#"):  # what cells refer to
            continue
        if isinstance(one, h5py.Group) and "MATLAB_sparse" not in one.attrs:
            yield from _variables(h5py, one, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", one


def _numbers(h5py: Any, one: Any) -> Any:
    """A variable of HDF5 as an array, rows first, or as a sparse one; None if it is neither."""
    kind = one.attrs.get("MATLAB_class")
    if isinstance(one, h5py.Dataset):
        array = np.asarray(one).T
        return None if kind == b"char" else array.astype(bool) if kind == b"logical" else array
    if "MATLAB_sparse" not in one.attrs:
        return None
    from scipy.sparse import csc_array

    begins = np.asarray(one["jc"]).astype(np.int64)
    data, rows = (np.asarray(one[name]) if name in one else np.empty(0) for name in ("data", "ir"))
    shape = (int(one.attrs["MATLAB_sparse"]), begins.size - 1)
    if kind == b"logical":
        data = data.astype(bool)
    return csc_array((data, rows.astype(np.int64), begins), shape=shape)

"""Arrays of MAT files, of all versions."""

from pathlib import Path
from typing import Any

import numpy as np

from .packages import package, read_by


def read_mat(path: Path) -> tuple[dict[str, Any], str]:
    """Read the numbers of a MAT file as arrays or sparse arrays by name; return them and the file format.

    Version 7.3, which is HDF5, is read through h5py of the extra `lab`; its texts and structures are left
    out.  Logical ones are bool.

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
                str(name): one.astype(bool) if name in logical else one
                for name, one in stored.items()
                if name[:2] != "__"
            }
        except NotImplementedError:  # what scipy says of version 7.3
            return None

    stored = read_by(path, "MAT file", read)
    return (stored, "MAT") if stored is not None else (_read_hdf(path), "MAT v7.3")


def _read_hdf(path: Path) -> dict[str, Any]:
    h5py = package("h5py", path, "lab")

    def read() -> dict[str, Any]:
        with h5py.File(path, "r") as stored:
            found = {str(name): _numbers(h5py, one) for name, one in stored.items()}
            return {name: one for name, one in found.items() if one is not None}

    return read_by(path, "MAT file", read)


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

"""Files that hold several arrays by their names: NPZ and MAT."""

import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..mat_files import read_mat

#: Exceptions of numpy for files that are not .npz, or damaged.
_NOT_NPZ = (ValueError, EOFError, NotImplementedError, RuntimeError, zipfile.BadZipFile, zlib.error)


def read_npz(path: Path) -> dict[str, Any]:
    """The arrays of an .npz file; never a pickled object, which could run any program."""
    try:
        # opened here, since numpy leaves what it cannot read open
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as opened:
            return {name: opened[name] for name in opened.files}
    except OSError as error:
        reason = error.strerror or "it is not an .npz file"
    except _NOT_NPZ:
        reason = "it is not an .npz file of plain arrays"
    except (AttributeError, TypeError):  # one array, as numpy.save writes it, has no names
        reason = "it is not an .npz file but one array"
    raise InputError(
        "matrices", f"must be an .npz file with arrays M, K and optionally C; got {path}: {reason}"
    )


def write_npz(arrays: Mapping[str, np.ndarray], path: Path) -> None:
    """Write arrays by their names, so that `read_npz` reads them."""
    with open(path, "wb") as file:  # opened here, since numpy changes names without the ending
        np.savez(file, **arrays)  # type: ignore[arg-type]


def read_npy(path: Path) -> dict[str, Any]:
    """The one array of an .npy file, by the name of the file."""
    try:
        with open(path, "rb") as file:
            return {path.stem: np.lib.format.read_array(file, allow_pickle=False)}
    except _NOT_NPZ:
        raise InputError(
            "matrices", f": cannot read {path}: it is not an .npy file of numbers; save it with numpy.save"
        ) from None


def read_sparse_or_npz(path: Path) -> dict[str, Any]:
    """The arrays of an .npz file, or the one sparse matrix that scipy.sparse.save_npz wrote into it."""
    arrays = read_npz(path)
    if not {"format", "data", "shape"} <= arrays.keys():
        return arrays
    from scipy.sparse import load_npz

    try:
        return {path.stem: load_npz(path)}
    except (*_NOT_NPZ, KeyError):
        raise InputError(
            "matrices", f": cannot read {path}: its sparse matrix is damaged; save it again"
        ) from None


def read_mat_arrays(path: Path) -> dict[str, Any]:
    """The arrays of a MAT file, sparse ones among them."""
    arrays, _ = read_mat(path)
    return {name: np.ravel(one) if name == "dofs" else one for name, one in arrays.items()}

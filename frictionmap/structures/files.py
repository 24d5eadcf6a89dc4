"""Matrices of a structure from one file, from one file each, or from arrays."""

import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from .abaqus import held, read_abaqus
from .arrays import read_mat_arrays, read_npy, read_npz, read_sparse_or_npz
from .entries import Label, Matrix, in_one_order
from .harwell_boeing import read_harwell_boeing
from .market import BANNER, read_market
from .nastran import read_op4, read_punch

#: Names of the matrices, of an array with numbers that degrees of freedom are called by, and of one with
#: their labels beside it.
NAMES = ("M", "K", "C")
DOFS, LABELS = "dofs", "labels"

_SEVERAL: dict[str, Callable[[Path], dict[str, Matrix]]] = {
    ".op4": read_op4,
    ".pch": read_punch,
    ".punch": read_punch,
    ".dmig": read_punch,
}
_BOEING = (".hb", ".rb", ".rsa", ".rua")

#: What M, K and C are called in files of arrays.
_CALLED = {
    "M": re.compile(r"m|mass", re.IGNORECASE),
    "K": re.compile(r"k|stiff(ness)?", re.IGNORECASE),
    "C": re.compile(r"c|d|damp(ing)?", re.IGNORECASE),
}

#: Endings of files with one matrix, or with several by names.
_ENDINGS = (".mtx", *_BOEING, *_SEVERAL, ".npz", ".npy", ".mat")

#: Readers of files of arrays of which each is one matrix.
_ARRAYS: dict[str, Callable[[Path], dict[str, Any]]] = {
    ".npz": read_sparse_or_npz, ".npy": read_npy, ".mat": read_mat_arrays,
}  # fmt: skip

_ONE_EACH = '{ M = "m.mtx", K = "k.mtx" }'


class GivenMatrices(NamedTuple):
    """Given matrices; only names and labels are checked."""

    arrays: dict[str, Any]  # M, K and perhaps C, unchecked or sparse
    dofs: Any  # their numbers, if they were given, else None
    labels: tuple[Label | str, ...] | None
    held: np.ndarray | None  # rows that a boundary condition holds, bool (n,)
    source: str  # names of the files, or ""


def read_files(given: object) -> GivenMatrices:
    """The arrays from the path of a file, or from a mapping of arrays or of paths.

    Raises
    ------
    InputError
        A file cannot be read, or does not match its ending; an array is missing or has an unknown name.
    """
    if isinstance(given, (str, os.PathLike)):
        return _from_path(Path(given))
    if isinstance(given, Mapping):
        return _from_mapping(given)
    raise InputError(
        "matrices",
        f"must be the path of an .npz file or a mapping with arrays M, K and optionally C; "
        f"got {checks.one_line(given)}",
    )


def _by_name(given: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Matrices by M, K and C, and the names of other arrays.

    A matrix may have another common name, also as a field of a structure, if no array has its own one.

    Raises
    ------
    InputError
        M or K is missing, or several arrays may be one of the three.
    """
    found: dict[str, str] = {}
    for name, pattern in _CALLED.items():
        like = [other for other in given if pattern.fullmatch(other.rpartition(".")[2])]
        if "M" in found:  # D may be anything, if it is not of the size of M
            like = [other for other in like if np.shape(given[other]) == np.shape(given[found["M"]])]
        like = [name] if name in given else like
        if len(like) > 1:
            raise InputError(
                "matrices",
                f": cannot use {', '.join(like)}: several may be {name}; name the one that is meant {name}",
            )
        if like:
            found[name] = like[0]
    _check_there(found, list(given))
    others = [name for name in given if name not in (*found.values(), DOFS)]
    return {name: given[other] for name, other in found.items()}, others


def _check_there(found: Collection[str], listed: Sequence[str]) -> None:
    if not {"M", "K"} <= set(found):
        raise InputError(
            "matrices", f"must have arrays M, K and optionally C; got {', '.join(listed) or 'none'}"
        )


def _known_names(names: Iterable[Any]) -> None:
    """Refuse names of a mapping that mean nothing: they are the user's own."""
    listed = [name for name in names if name != DOFS]
    for name in listed:
        if name not in NAMES:
            raise InputError("matrices", f": unknown array {name!r}; valid: {', '.join((*NAMES, DOFS))}")
    _check_there(listed, listed)


def _from_path(path: Path) -> GivenMatrices:
    ending = path.suffix.lower()
    if ending == ".mtx" or ending in _BOEING:
        raise InputError(
            "matrices", f"must be given one by one for {ending} files, such as {_ONE_EACH}; got {path.name}"
        )
    if ending in _SEVERAL:
        matrices = _opened(path, _SEVERAL[ending])
        _known_names(matrices)
        arrays, labels = in_one_order(matrices)
        return GivenMatrices(arrays, None, labels, None, path.name)
    every = _opened(path, read_mat_arrays if ending == ".mat" else read_npz)
    arrays, others = _by_name(every)
    words = _labels(every, np.shape(arrays["M"])[0]) if LABELS in others else None
    others = [name for name in others if words is None or name != LABELS]
    source = f"{path.name} ({', '.join(others)} not used)" if others else path.name
    return GivenMatrices(arrays, every.get(DOFS), words, None, source)


def _labels(every: Mapping[str, Any], n: int) -> tuple[str, ...] | None:
    """Labels beside the numbers of all degrees of freedom; None if the array of this name is another one."""
    given = np.asarray(every[LABELS])
    if DOFS not in every or given.dtype.kind != "U" or given.shape != (n,) or np.unique(given).size < n:
        return None
    return tuple(given.tolist())


def _from_mapping(given: Mapping[Any, Any]) -> GivenMatrices:
    _known_names(given)
    arrays = {name: given[name] for name in NAMES if name in given}
    paths = {name: Path(one) for name, one in arrays.items() if isinstance(one, (str, os.PathLike))}
    if not paths:
        return GivenMatrices(arrays, given.get(DOFS), None, None, "")
    if len(paths) < len(arrays) or DOFS in given:
        raise InputError(
            "matrices", f"must all be files, such as {_ONE_EACH}, or arrays; got a file of {', '.join(paths)}"
        )
    matrices = {name: _one(path, name) for name, path in paths.items()}
    whole, labels = in_one_order(matrices)
    abaqus = paths["K"].suffix.lower() == ".mtx" and not _is_market(paths["K"])
    fixed = held(whole["K"]) if abaqus else None
    return GivenMatrices(
        whole, None, labels, fixed, ", ".join(dict.fromkeys(path.name for path in paths.values()))
    )


def _one(path: Path, name: str) -> Matrix:
    """The matrix of that name in a file."""
    ending = path.suffix.lower()
    if ending in _SEVERAL:
        found = _opened(path, _SEVERAL[ending])
        if name not in found:
            raise InputError("matrices", f": {name} must be in file {path}; got {', '.join(found)}")
        return found[name]
    if ending in _BOEING:
        return _opened(path, read_harwell_boeing)
    if ending in _ARRAYS:
        return Matrix(_only(path, _opened(path, _ARRAYS[ending]), name))
    if ending == ".mtx":
        return _opened(path, lambda file: read_market(file) if _is_market(file) else read_abaqus(file))
    raise InputError(
        "matrices", f": {name} must be a file that ends in {', '.join(_ENDINGS)}; got {path.name!r}"
    )


def _only(path: Path, arrays: Mapping[str, Any], name: str) -> Any:
    """The array of that name in a file, or its only one."""
    if name not in arrays and len(arrays) != 1:
        raise InputError(
            "matrices",
            f": {name} must be in file {path}, or its only array; got {', '.join(arrays) or 'none'}",
        )
    return arrays[name] if name in arrays else next(iter(arrays.values()))


def _is_market(path: Path) -> bool:
    with open(path, "rb") as file:
        return file.read(len(BANNER)).decode("ascii", errors="replace").lower() == BANNER.lower()


def _opened(path: Path, read: Callable[[Path], Any]) -> Any:
    """Read a file; refusals begin with the key."""
    try:
        return read(path)
    except InputError as error:
        raise (error if error.where == "matrices" else InputError("matrices", f": {error}")) from None
    except OSError as error:
        raise InputError(
            "matrices", f": cannot read {path}: {error.strerror or error}; check the path"
        ) from None
    except ValueError as error:  # a null character in the name
        raise InputError("matrices", f": cannot read {path}: {error}; check the path") from None

"""Mass, stiffness and damping matrices of a structure, from a file or from Python: read and checked."""

import os
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError

_NAMES = ("M", "K", "C")

#: Of the largest entry: a matrix is symmetric, and C has no negative eigenvalue, up to this.  Assembly
#: leaves some units of rounding; a slip leaves more.
_TOLERANCE = 1e-12

#: Entries of all matrices must lie within 1/this to this: then squares and products stay within doubles.
_LARGEST = 1e100

#: What a file that is not an .npz, or a damaged one, makes numpy raise.
_NOT_NPZ = (ValueError, EOFError, NotImplementedError, RuntimeError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True, eq=False, repr=False)
class Matrices:
    """Checked matrices (n, n), read-only, in consistent units; equal if their entries are."""

    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray | None
    source: str  # name of the file, or ""

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)

    def _content(self) -> tuple[bytes, ...]:
        # adding 0.0 makes -0.0 the 0.0 that it equals
        return tuple((a + 0.0).tobytes() for a in (self.mass, self.stiffness, self.damping) if a is not None)

    def __eq__(self, other: object) -> bool:
        return self._content() == other._content() if isinstance(other, Matrices) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._content())

    def __repr__(self) -> str:
        return f"<{self.n} by {self.n} matrices{' from ' * bool(self.source)}{self.source}>"

    def scaled(self, frequency: float, stiffness: float) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Dimensionless M, K and C1 (theory.md 1) for units of frequency and of stiffness."""
        with np.errstate(over="ignore", invalid="ignore"):  # what is out of range is refused below
            scaled = (
                self.mass * (frequency / stiffness * frequency),
                self.stiffness / stiffness,
                None if self.damping is None else self.damping * (frequency / stiffness),
            )
        for name, matrix in zip(_NAMES, scaled, strict=True):
            if matrix is not None and not _in_range(matrix, name):
                raise InputError(
                    f"frequency_scale and stiffness_scale must leave {name} with entries of "
                    f"{1.0 / _LARGEST:g} to {_LARGEST:g}; got {frequency:g} and {stiffness:g}"
                )
        return scaled


def read_matrices(given: object) -> Matrices:
    """Matrices from the path of an .npz file, from a mapping, or as they are if they were read before.

    Raises
    ------
    InputError
        The file cannot be read; an array is missing, has an unknown name, or is not a real, finite,
        symmetric, definite matrix of the size of the others.
    """
    if isinstance(given, Matrices):
        return given
    if isinstance(given, (str, os.PathLike)):
        path = Path(given)
        return _checked(_from_file(path), path.name)
    if isinstance(given, Mapping):
        return _checked(given, "")
    raise InputError(
        f"matrices must be the path of an .npz file or a mapping with arrays M, K and optionally C; "
        f"got {checks.one_line(given)}"
    )


def _known_names(names: Any) -> None:
    for name in names:
        if name not in _NAMES:
            raise InputError(f"matrices must have arrays M, K and optionally C, no others; got {name!r}")
    for name in ("M", "K"):
        if name not in names:
            raise InputError(
                f"matrices must have arrays M, K and optionally C; {name} is missing, "
                f"got {', '.join(names) or 'none'}"
            )


def _from_file(path: Path) -> dict[str, np.ndarray]:
    """The arrays of an .npz file; never a pickled object, which could run any program."""
    try:
        # opened here, since numpy leaves what it cannot read open
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as opened:
            _known_names(opened.files)
            return {name: opened[name] for name in opened.files}
    except InputError:
        raise
    except OSError as error:
        reason = error.strerror or "it is not an .npz file"
    except _NOT_NPZ:
        reason = "it is not an .npz file of plain arrays"
    except (AttributeError, TypeError):  # one array, as numpy.save writes it, has no names
        reason = "it is not an .npz file but one array"
    raise InputError(f"matrices must be an .npz file with arrays M, K and optionally C; {path}: {reason}")


def _checked(given: Mapping[str, object], source: str) -> Matrices:
    _known_names(list(given))
    arrays = {name: _symmetric(_square(given[name], name), name) for name in _NAMES if name in given}
    n = len(arrays["M"])
    for name, array in arrays.items():
        if len(array) != n:
            raise InputError(
                f"matrices: {name} must have the shape of M, ({n}, {n}); got ({len(array)}, {len(array)})"
            )
    _definite(arrays["M"], "M")
    _definite(arrays["K"], "K")
    if "C" in arrays:
        _semidefinite(arrays["C"])
    for array in arrays.values():
        array.setflags(write=False)
    return Matrices(arrays["M"], arrays["K"], arrays.get("C"), source)


def _in_range(array: np.ndarray, name: str) -> bool:
    """Whether the largest entry is of a size to calculate with; C may be zero."""
    largest = float(np.abs(array).max())
    return 1.0 / _LARGEST <= largest <= _LARGEST or (name == "C" and largest == 0.0)


def _square(given: object, name: str) -> np.ndarray:
    """`given` as a new float64 array, if it is a square matrix of finite real numbers."""
    array = checks.array(given, f"matrices: {name}")
    if array.dtype.kind not in "iuf":  # neither text, nor complex, nor true and false
        kind = f"numbers of type {array.dtype}" if array.dtype.kind == "c" else f"type {array.dtype}"
        raise InputError(f"matrices: {name} must be an array of real numbers; got {kind}")
    if array.ndim != 2 or array.shape[0] != array.shape[1] or array.size == 0:
        raise InputError(f"matrices: {name} must be square, (n, n); got shape {array.shape}")
    result = array.astype(np.float64)
    wrong = np.argwhere(~np.isfinite(result))
    if wrong.size:
        i, j = wrong[0]
        raise InputError(f"matrices: {name} must be finite; got {result[i, j]} at [{i}, {j}]")
    if not _in_range(result, name):
        raise InputError(
            f"matrices: {name} must have a largest entry of {1.0 / _LARGEST:g} to {_LARGEST:g}; "
            f"got {np.abs(result).max():g}"
        )
    return result


def _symmetric(array: np.ndarray, name: str) -> np.ndarray:
    """The symmetric part, if the rest of it is rounding."""
    difference = np.abs(array - array.T)
    i, j = np.unravel_index(np.argmax(difference), array.shape)
    if difference[i, j] > _TOLERANCE * np.abs(array).max():
        raise InputError(
            f"matrices: {name} must be symmetric; got {float(array[i, j])!r} at [{i}, {j}] and "
            f"{float(array[j, i])!r} at [{j}, {i}]"
        )
    return 0.5 * (array + array.T)


def _definite(array: np.ndarray, name: str) -> None:
    """Refuse a matrix that is not positive definite beyond the rounding of its eigenvalues."""
    eigenvalues = np.linalg.eigvalsh(array)
    rounding = len(array) * np.finfo(float).eps * np.abs(eigenvalues).max()
    if eigenvalues[0] <= rounding:
        word = "singular" if eigenvalues[0] >= -rounding else "indefinite"
        raise InputError(
            f"matrices: {name} must be positive definite; it is {word}, with eigenvalues from "
            f"{eigenvalues[0]:.3g} to {eigenvalues[-1]:.3g}"
        )


def _semidefinite(damping: np.ndarray) -> None:
    eigenvalues = np.linalg.eigvalsh(damping)
    if eigenvalues[0] < -_TOLERANCE * np.abs(eigenvalues).max():
        raise InputError(
            f"matrices: C must be positive semi-definite, or it would feed the motion; it is indefinite, "
            f"with eigenvalues from {eigenvalues[0]:.3g} to {eigenvalues[-1]:.3g}"
        )

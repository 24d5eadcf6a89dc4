"""Checked matrices of a structure: square, real, finite, symmetric, of one size, dense or sparse."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from .dofs import Dofs
from .files import GivenMatrices, read_files

#: Tolerance of symmetry, over the largest entry.  Assembly leaves some units of rounding; a mistake
#: leaves more.
TOLERANCE = 1e-12

#: Entries of all matrices must lie within 1/this to this: then squares and products stay within doubles.
LARGEST = 1e100


@dataclass(frozen=True, eq=False)
class Structure:
    """Matrices (n, n) by M, K and perhaps C; arrays, or sparse ones with their rows one after the other."""

    arrays: dict[str, Any]
    dofs: Dofs
    source: str  # names of the files, or ""
    held: int  # degrees of freedom left out, as a boundary condition holds them

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return self.dofs.n

    def massless(self) -> list[int]:
        """Numbers of degrees of freedom without any mass, rows of zeros in M."""
        rows = abs(self.arrays["M"]).sum(axis=1)
        return [self.dofs.numbers[row] for row in np.flatnonzero(np.asarray(rows) == 0.0)]


def read_structure(given: object) -> Structure:
    """The structure of a path or a mapping, see `files.read_files`.

    Raises
    ------
    InputError
        A file cannot be read; an array is missing, has an unknown name, or is not a real, finite,
        symmetric matrix of the size of the others.
    """
    found = read_files(given)
    arrays = {name: _square(one, name) for name, one in found.arrays.items()}
    n = arrays["M"].shape[0]
    if n > 1 and "C" in arrays and arrays["C"].shape == (1, 1) and abs(arrays["C"]).max() == 0.0:
        del arrays["C"]  # Nastran's matrix of what a model does not have
    for name, array in arrays.items():
        if array.shape[0] != n:
            raise InputError("matrices", f": {name} must have the shape of M, ({n}, {n}); got {array.shape}")
    dofs, order = _dofs(found, n)
    arrays = {name: one[order][:, order] for name, one in arrays.items()} if order is not None else arrays
    free = np.arange(n)
    if found.held is not None and found.held.any():
        free = np.flatnonzero(~found.held)
        if not free.size:
            raise InputError(
                "matrices", ": cannot use K: boundary conditions hold all degrees of freedom; leave one free"
            )
        arrays = {name: one[free][:, free] for name, one in arrays.items()}
    # only now: beside the stiffness of a row that is held any difference would be rounding
    arrays = {name: _symmetric(one, name, free) for name, one in arrays.items()}
    return Structure(arrays, dofs.at(free), found.source, n - free.size)


def _dofs(found: GivenMatrices, n: int) -> tuple[Dofs, np.ndarray | None]:
    """The degrees of freedom, and the order of the rows in which their numbers increase, if it is another."""
    if found.dofs is None:
        return Dofs.counted(n, found.labels), None
    given = np.atleast_1d(np.squeeze(checks.array(found.dofs, "matrices: dofs")))
    if given.dtype.kind == "U" and given.shape == (n,) and len(set(given.tolist())) == n:
        return Dofs.counted(n, tuple(name.strip() for name in given.tolist())), None
    whole = given.dtype.kind in "iuf" and given.shape == (n,) and np.array_equal(given, np.round(given))
    if not whole or np.unique(given).size < n or given.min() < 1:
        raise InputError(
            "matrices",
            f": dofs must be {n} different integers >= 1, or names; got {checks.one_line(found.dofs)}",
        )
    order = np.argsort(given)
    labels = None if found.labels is None else tuple(found.labels[place] for place in order)
    numbers = Dofs(tuple(int(number) for number in given[order]), labels)
    return numbers, None if (np.diff(order) == 1).all() else order


def in_range(array: Any, name: str) -> bool:
    """Whether the largest entry is of a size to calculate with; K and C may be zero."""
    largest = float(abs(array).max())
    return 1.0 / LARGEST <= largest <= LARGEST or (name != "M" and largest == 0.0)


def _square(given: Any, name: str) -> Any:
    """`given` as a new float64 array, dense or sparse, if it is a square matrix of finite real numbers."""
    array = given if _is_sparse(given) else checks.array(given, f"matrices: {name}")
    if array.dtype.kind not in "iuf":  # neither text, nor complex, nor true and false
        kind = f"numbers of type {array.dtype}" if array.dtype.kind == "c" else f"type {array.dtype}"
        raise InputError("matrices", f": {name} must be an array of real numbers; got {kind}")
    if array.ndim != 2 or array.shape[0] != array.shape[1] or array.shape[0] == 0:
        raise InputError("matrices", f": {name} must be square, (n, n); got shape {array.shape}")
    result = _as_rows(array) if _is_sparse(given) else array.astype(np.float64)
    numbers = result.data if _is_sparse(given) else result
    if not np.isfinite(numbers).all():
        i, j, value = _first_wrong(result)
        raise InputError("matrices", f": {name} must be finite; got {value} at [{i}, {j}]")
    if not in_range(result, name):
        raise InputError(
            "matrices",
            f": {name} must have a largest entry of {1.0 / LARGEST:g} to {LARGEST:g}; "
            f"got {abs(result).max():g}",
        )
    return result


def _is_sparse(given: object) -> bool:
    """Whether it is a sparse matrix or array, determined without importing scipy."""
    return hasattr(given, "tocsr") and hasattr(given, "nnz")


def _as_rows(array: Any) -> Any:
    from scipy.sparse import csr_array

    rows = csr_array(array).astype(np.float64)
    rows.sum_duplicates()
    return rows


def _first_wrong(array: Any) -> tuple[int, int, float]:
    """Row, column and value of the first entry that is not finite."""
    if not _is_sparse(array):
        i, j = np.argwhere(~np.isfinite(array))[0]
        return int(i), int(j), float(array[i, j])
    entries = array.tocoo()
    k = int(np.flatnonzero(~np.isfinite(entries.data))[0])
    return int(entries.coords[0][k]), int(entries.coords[1][k]), float(entries.data[k])


def _symmetric(array: Any, name: str, free: np.ndarray) -> Any:
    """The symmetric part, if the rest of it is rounding; `free`: which rows of the file these are."""
    difference = abs(array - array.T)
    i, j = np.unravel_index(difference.argmax(), array.shape)
    if difference[i, j] > TOLERANCE * abs(array).max():
        raise InputError(
            "matrices",
            f": {name} must be symmetric; got {float(array[i, j])!r} at [{free[i]}, {free[j]}] and "
            f"{float(array[j, i])!r} at [{free[j]}, {free[i]}]",
        )
    whole = 0.5 * (array + array.T)
    return whole.tocsr() if _is_sparse(whole) else whole

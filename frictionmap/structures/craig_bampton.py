"""Reduction of a structure to a few degrees of freedom after Craig and Bampton (AIAA J. 6, 1968).

A motion is that of the kept degrees of freedom, which the others follow statically, and of the modes of the
others with the kept ones held: x = T u.  The coordinates u are displacements of degrees of freedom of the
file, those kept and as many more as there are modes, taken where they distinguish the modes best.  Then the
reduced structure has masses and springs like any other, and results are displacements of all of it.  What
T spans does not depend on that choice.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from .dofs import Dofs
from .structure import Structure

#: Default of the allowed relative error of natural frequencies and compliances.
_ALLOWED = 1e-3

#: Number of degrees of freedom up to which all modes are computed.
_FEW = 400

#: Remainder of the rigid motion below which it needs no column of its own.
_SPANNED = 1e-7

#: Share of the largest entry of a shape below which entries are rounding.
_ROUNDING = 1e-10

_KEYS = ("keep", "modes", "allow")


class Reduce(NamedTuple):
    """Settings of a reduction."""

    keep: tuple[int, ...]  # numbers of degrees of freedom, beside contact and load
    modes: int
    allow: float  # relative error


def checked_reduce(given: object, dofs: Dofs) -> Reduce:
    """The key `reduce`, checked."""
    if isinstance(given, Reduce):
        return given
    if not isinstance(given, Mapping) or "modes" not in given:
        raise InputError("reduce", f"must be {{ keep = [...], modes = 16 }}; got {checks.one_line(given)}")
    for key in given:
        if key not in _KEYS:
            raise InputError(f"unknown key of reduce {checks.one_line(key)}; valid: {', '.join(_KEYS)}")
    keep = given.get("keep", ())
    if isinstance(keep, str) or not isinstance(keep, (Sequence, np.ndarray)):
        raise InputError("reduce.keep", f"must be a list of degrees of freedom; got {checks.one_line(keep)}")
    numbers = {dofs.number(one, f"reduce.keep[{index}]") for index, one in enumerate(keep)}
    modes = checks.whole(given["modes"], "reduce.modes", least=0)
    allow = checks.number(given.get("allow", _ALLOWED), "reduce.allow", above=0.0, most=1.0)
    return Reduce(tuple(sorted(numbers)), modes, allow)


@dataclass(frozen=True, eq=False)
class FixedInterface:
    """A structure with some rows held: how the others follow, and their modes."""

    kept: np.ndarray  # rows, increasing
    others: np.ndarray
    follow: np.ndarray  # (others, kept) displacements by unit displacements of the kept ones
    shapes: np.ndarray  # (others, modes) modes with the kept ones held, slow ones first

    def spanned(self, modes: int, base: bool) -> np.ndarray:
        """Columns (n, kept + modes) that span the motions; with `base` also that of all by one."""
        inner = self.shapes[:, :modes]
        if base:  # what of it the others do not follow
            left = 1.0 - self.follow.sum(axis=1, keepdims=True)
            left -= inner @ np.linalg.lstsq(inner, left, rcond=None)[0]
            if abs(left).max(initial=0.0) > _SPANNED:
                inner = np.column_stack((inner, left))
        columns = np.zeros((self.kept.size + self.others.size, self.kept.size + inner.shape[1]))
        columns[self.kept, np.arange(self.kept.size)] = 1.0
        columns[self.others, : self.kept.size] = self.follow
        columns[self.others, self.kept.size :] = inner
        return columns

    def rows(self, columns: np.ndarray) -> np.ndarray:
        """Rows whose displacements are the coordinates: the kept ones, and those that separate modes best."""
        from scipy.linalg import qr

        inner = columns[self.others, self.kept.size :]
        if not inner.shape[1]:
            return self.kept
        order = qr((inner / abs(inner).max(axis=0)).T, mode="r", pivoting=True)[1]
        return np.sort(np.concatenate((self.kept, self.others[order[: inner.shape[1]]])))


def factor(matrix: Any) -> Any:
    """The factors of a sparse symmetric matrix, which must be positive definite.

    Raises
    ------
    InputError
        K is singular or indefinite.
    """
    from scipy.sparse.linalg import splu

    try:
        found = splu(
            matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:  # exactly singular
        found = None
    # without row exchanges the pivots have the signs of the eigenvalues
    if found is None or not (found.U.diagonal() > 0.0).all():
        raise InputError(
            "matrices",
            ": K must be positive definite; got a singular or indefinite matrix; a free structure can be "
            "used without reduce, or with a spring to the ground, such as 1e-6 of the others",
        )
    return found


def slowest(mass: Any, stiffness: Any, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The lowest natural frequencies (count,), increasing, and their modes (n, count), of sparse M and K.

    Modes of M u = u K/w^2, so that degrees of freedom without mass follow the others, as they do.
    """
    from scipy.linalg import eigh
    from scipy.sparse.linalg import LinearOperator, eigsh

    n = mass.shape[0]
    if count == 0:
        return np.empty(0), np.empty((n, 0))
    factors = factor(stiffness)
    if n <= _FEW or 3 * count > n:
        some = [n - count, n - 1]
        squares, shapes = eigh(mass.toarray(), stiffness.toarray(), subset_by_index=some)
    else:
        solve = LinearOperator((n, n), matvec=factors.solve, dtype=float)
        start = 1.0 + np.cos(np.arange(n))  # always the same, along no mode that a symmetry makes
        squares, shapes = eigsh(mass, count, stiffness, Minv=solve, v0=start)
    order = np.argsort(squares)[::-1]
    with np.errstate(divide="ignore"):
        return 1.0 / np.sqrt(np.maximum(squares[order], 0.0)), np.ascontiguousarray(shapes[:, order])


def fixed_interface(structure: Structure, kept: Sequence[int], modes: int) -> FixedInterface:
    """Hold some rows of a structure with sparse matrices and find modes of the others.

    Raises
    ------
    InputError
        K is not positive definite, M has a negative diagonal, or there are fewer modes.
    """
    mass, stiffness = structure.arrays["M"], structure.arrays["K"]
    diagonal = np.asarray(mass.diagonal())
    _refuse_where(structure, "M", "a negative mass", diagonal < 0.0)
    _refuse_where(structure, "K", "no positive stiffness", np.asarray(stiffness.diagonal()) <= 0.0)
    rows = np.array(sorted(kept))
    others = np.setdiff1d(np.arange(structure.n), rows)
    most = int(np.count_nonzero(diagonal[others]))
    if modes > most:
        raise InputError("reduce.modes", f"must be at most {most}, as many as there are; got {modes}")
    if not others.size:
        return FixedInterface(rows, others, np.empty((0, rows.size)), np.empty((0, 0)))
    inner = stiffness[others][:, others]
    follow = -factor(inner).solve(stiffness[others][:, rows].toarray())
    _, shapes = slowest(mass[others][:, others], inner, modes)
    shapes = np.where(abs(shapes) > _ROUNDING * abs(shapes).max(axis=0, initial=0.0), shapes, 0.0)
    return FixedInterface(rows, others, follow, shapes)


def _refuse_where(structure: Structure, name: str, what: str, wrong: np.ndarray) -> None:
    """Refuse a matrix by the first degree of freedom whose entry on the diagonal is wrong."""
    if wrong.any():
        where = structure.dofs.word(structure.dofs.numbers[int(np.argmax(wrong))])
        raise InputError(
            "matrices", f": {name} must be positive definite; got {what} of degree of freedom {where}"
        )


class Reduced(NamedTuple):
    """Reduced matrices (m, m) by their names, and what their rows are."""

    arrays: dict[str, np.ndarray]
    rows: np.ndarray  # of the structure, (m,)
    motions: np.ndarray  # T (n, m)


def project(structure: Structure, fixed: FixedInterface, modes: int, base: bool) -> Reduced:
    """Project the structure onto the kept degrees of freedom and some modes."""
    columns = fixed.spanned(modes, base)
    rows = fixed.rows(columns)
    motions = np.linalg.solve(columns[rows].T, columns.T).T
    motions[rows] = np.eye(rows.size)
    arrays = {}
    for name, matrix in structure.arrays.items():
        small = motions.T @ (matrix @ motions)
        arrays[name] = 0.5 * (small + small.T)
    return Reduced(arrays, rows, motions)

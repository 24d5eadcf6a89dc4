"""Mass, stiffness and damping matrices used in the computation: small, dense, definite."""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import InputError
from ..structures.dofs import Dofs
from ..structures.files import DOFS, LABELS, NAMES
from ..structures.reduction import Reduction
from ..structures.structure import LARGEST, TOLERANCE, Structure, in_range
from .rigid_modes import count_rigid

#: Largest number of degrees of freedom without reduction; the modes of more would take minutes and gigabytes.
_MOST_WHOLE = 2000


@dataclass(frozen=True, eq=False, repr=False)
class Matrices:
    """Checked matrices (n, n), read-only, in consistent units; equal if entries and numbers of the rows are
    equal.
    """

    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray | None
    source: str  # names of the files, or ""
    dofs: Dofs  # numbers or labels of the rows
    reduction: Reduction | None = None  # reduction of a larger structure to these matrices
    rigid_modes: int = 0  # number of zero eigenvalues of K

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """The matrices by name, and the numbers of their rows unless these are 1 to n."""
        named = dict(zip(NAMES, (self.mass, self.stiffness, self.damping), strict=True))
        found = {name: array for name, array in named.items() if array is not None}
        return found if self.dofs.all_there else {**found, DOFS: np.array(self.dofs.numbers)}

    @property
    def named_arrays(self) -> dict[str, np.ndarray]:
        """The matrices by name, and numbers and labels of their rows, as a file keeps them."""
        words = self.dofs.written_labels
        more = {LABELS: np.array(words)} if words else {}
        return {**self.arrays, DOFS: np.array(self.dofs.numbers), **more}

    def _content(self) -> tuple[bytes, ...]:
        # adding 0.0 makes -0.0 the 0.0 that it equals
        return tuple((array + 0.0).tobytes() for array in self.arrays.values())

    def __eq__(self, other: object) -> bool:
        return self._content() == other._content() if isinstance(other, Matrices) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._content())

    def __repr__(self) -> str:
        return f"<{self.n} by {self.n} matrices{' from ' * bool(self.source)}{self.source}>"

    def scaled(self, frequency: float, stiffness: float) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Dimensionless M, K and C1 (theory.md 1) for given units of frequency and stiffness."""
        with np.errstate(over="ignore", invalid="ignore"):  # values out of range are refused below
            scaled = (
                self.mass * (frequency / stiffness * frequency),
                self.stiffness / stiffness,
                None if self.damping is None else self.damping * (frequency / stiffness),
            )
        for name, matrix in zip(NAMES, scaled, strict=True):
            if matrix is not None and not in_range(matrix, name):
                raise InputError(
                    "frequency_scale and stiffness_scale",
                    f"must leave {name} with entries of {1.0 / LARGEST:g} to {LARGEST:g}; "
                    f"got {frequency:g} and {stiffness:g}",
                )
        return scaled


def full_matrices(structure: Structure) -> Matrices:
    """Dense matrices of a structure, without reduction.

    Raises
    ------
    InputError
        There are too many degrees of freedom, or M is not positive definite, or K or C is indefinite.
    """
    if structure.n > _MOST_WHOLE:
        raise InputError(
            "matrices",
            f"must have at most {_MOST_WHOLE} degrees of freedom, unless they are reduced (key "
            f"reduce); got {structure.n}",
        )
    dense = {
        name: array if isinstance(array, np.ndarray) else array.toarray()
        for name, array in structure.arrays.items()
    }
    massless = structure.massless()
    if massless:
        largest = np.linalg.eigvalsh(dense["M"])[-1]
        raise InputError(
            "matrices",
            f": M must be positive definite; got a singular matrix, with eigenvalues from 0 to "
            f"{largest:.3g}: degree of freedom {structure.dofs.word(massless[0])} has no mass; "
            f"eliminate it with reduce",
        )
    return definite(dense, structure.dofs, structure.source)


def reduced_matrices(reduction: Reduction) -> Matrices:
    """Dense matrices of a reduced structure."""
    structure, reduced = reduction.structure, reduction.reduced
    small = definite(reduced.arrays, structure.dofs.at(reduced.rows), structure.source)
    return replace(small, reduction=reduction)


def definite(arrays: dict[str, np.ndarray], dofs: Dofs, source: str) -> Matrices:
    """Matrices (n, n) of a structure, after checking that M is positive definite, and K and C are not
    indefinite.
    """
    _definite(arrays["M"], "M")
    rigid = count_rigid(arrays["K"])
    if "C" in arrays:
        _semidefinite(arrays["C"])
    for array in arrays.values():
        array.setflags(write=False)
    return Matrices(arrays["M"], arrays["K"], arrays.get("C"), source, dofs, rigid_modes=rigid)


def _definite(array: np.ndarray, name: str) -> None:
    """Refuse a matrix that is not positive definite to within the rounding error of its eigenvalues."""
    eigenvalues = np.linalg.eigvalsh(array)
    rounding = len(array) * np.finfo(float).eps * np.abs(eigenvalues).max()
    if eigenvalues[0] <= rounding:
        word = "a singular" if eigenvalues[0] >= -rounding else "an indefinite"
        raise InputError(
            "matrices",
            f": {name} must be positive definite; got {word} matrix, with eigenvalues from "
            f"{eigenvalues[0]:.3g} to {eigenvalues[-1]:.3g}",
        )


def _semidefinite(damping: np.ndarray) -> None:
    eigenvalues = np.linalg.eigvalsh(damping)
    if eigenvalues[0] < -TOLERANCE * np.abs(eigenvalues).max():
        raise InputError(
            "matrices",
            f": C must be positive semi-definite; got an indefinite matrix, which feeds energy into "
            f"the motion, with eigenvalues from {eigenvalues[0]:.3g} to {eigenvalues[-1]:.3g}",
        )

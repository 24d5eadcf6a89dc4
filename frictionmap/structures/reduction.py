"""Reduction of a structure, checked against the allowed error in the range of frequency."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import InputError
from .accuracy import Accuracy, Comparison, FullStructure, Ranges
from .craig_bampton import FixedInterface, Reduce, Reduced, fixed_interface, project, slowest
from .structure import Structure

#: Largest number of modes tried for a sufficient one, over the requested number, and the factor of the steps.
_MORE = 8
_STEP = 1.25

#: Smallest number of modes of the reduction used for comparison.  Structures with fewer are compared as a
#: whole, which is exact.  This number takes below a millisecond per frequency.
_LEAST_REFINED = 100


@dataclass(frozen=True, eq=False)
class Reduction:
    """A structure, its reduction and the accuracy of the reduction."""

    asked: Reduce
    structure: Structure  # the whole one
    kept: tuple[int, ...]  # numbers of the degrees of freedom kept for their own sake
    contacts: np.ndarray  # the vectors c of the contacts (N, n) of the whole one, linearly independent
    base: bool  # whether its base moves
    reduced: Reduced
    _found: Ranges[Accuracy] = field(default_factory=Ranges)

    def like(self, asked: Reduce, kept: tuple[int, ...], contacts: np.ndarray, base: bool) -> bool:
        """Whether this reduction has the given settings."""
        same = self.asked == asked and self.kept == kept and self.base == base
        return same and bool(np.array_equal(self.contacts, contacts))

    @cached_property
    def first_frequency(self) -> float:
        """The first natural frequency of the whole structure, in the units of sqrt(K/M)."""
        arrays = _sparse(self.structure)
        return float(slowest(arrays["M"], arrays["K"], 1)[0][0])

    @property
    def most_modes(self) -> int:
        """Number of modes with the kept degrees of freedom held."""
        return int(np.count_nonzero(self.structure.arrays["M"].diagonal())) - len(self.kept)

    @cached_property
    def refined(self) -> "Reduction | None":
        """Reduction to twice as many modes and no fewer than 100, or to all; None if it has all already."""
        modes = min(max(2 * self.asked.modes, _LEAST_REFINED), self.most_modes)
        if modes <= self.asked.modes:
            return None
        asked = self.asked._replace(modes=modes, allow=1.0)  # for comparison only, without a limit
        return reduce_structure(self.structure, asked, self.kept, self.contacts, self.base)

    def checked(self, low: float, high: float) -> Accuracy:
        """Its accuracy from one angular frequency to another, in the units of sqrt(K/M).

        Within a range requested before, the accuracy of that range is returned at once, e.g. for a motion at
        one of its frequencies.

        Raises
        ------
        InputError
            The error exceeds the limit; the message states how many modes suffice.
        """
        return self._found.lookup(low, high, lambda: self._accuracy(low, high))

    def _accuracy(self, low: float, high: float) -> Accuracy:
        comparison = Comparison(self._whole(), low, high)
        accuracy = comparison.accuracy(self.reduced)
        if not accuracy.worst <= self.asked.allow:
            self._refuse(comparison, accuracy)
        return accuracy

    def _whole(self) -> FullStructure:
        arrays = _sparse(self.structure)
        rows = self.structure.dofs.rows(self.kept)
        forces = np.zeros((self.structure.n, len(rows)))
        forces[rows, np.arange(len(rows))] = 1.0
        if self.base:  # what a base shakes
            forces = np.column_stack((forces, arrays["M"].sum(axis=1)))
        return FullStructure(arrays["M"], arrays["K"], self.contacts, forces)

    def _refuse(self, comparison: Comparison, accuracy: Accuracy) -> None:
        whole = _with_sparse(self.structure)
        tried = min(_MORE * max(self.asked.modes, 8), self.most_modes)
        fixed = fixed_interface(whole, whole.dofs.rows(self.kept), tried)

        def do(modes: int) -> bool:
            return comparison.accuracy(project(whole, fixed, modes, self.base)).worst <= self.asked.allow

        enough = _enough(do, self.asked.modes, tried)
        advice = (
            f"{tried} modes do not suffice either, increase reduce.allow"
            if enough is None
            else f"{enough} mode{'s' * (enough > 1)} suffice{'s' * (enough == 1)}"
        )
        raise InputError(
            "reduce",
            f": cannot keep the error below {self.asked.allow:g} in the range of r with "
            f"{self.asked.modes} modes: {accuracy.describe()}; {advice}",
        )


def _enough(do: Callable[[int], bool], too_few: int, most: int) -> int | None:
    """Smallest sufficient number of modes, found by bisection.

    None if `most` does not.
    """
    modes = too_few
    while modes < most:
        modes = min(max(modes + 1, round(_STEP * modes)), most)
        if do(modes):
            break
        too_few = modes
    else:
        return None
    while modes - too_few > 1:
        middle = (modes + too_few) // 2
        modes, too_few = (middle, too_few) if do(middle) else (modes, middle)
    return modes


def _sparse(structure: Structure) -> dict[str, Any]:
    """The matrices, sparse."""
    from scipy.sparse import csr_array

    return {name: csr_array(one) for name, one in structure.arrays.items()}


def _with_sparse(structure: Structure) -> Structure:
    return Structure(_sparse(structure), structure.dofs, structure.source, structure.held)


def reduce_structure(
    structure: Structure, asked: Reduce, kept: tuple[int, ...], contacts: np.ndarray, base: bool
) -> Reduction:
    """Reduce a structure to kept degrees of freedom (numbers, increasing) and modes.

    Raises
    ------
    InputError
        One of the kept has no mass, or see `fixed_interface`.
    """
    massless = set(structure.massless())
    for number in kept:
        if number in massless:
            raise InputError(
                "matrices",
                f": cannot keep degree of freedom {structure.dofs.word(number)}: no mass in M; "
                f"contacts, loads and reduce.keep need degrees of freedom with mass",
            )
    whole = _with_sparse(structure)
    fixed: FixedInterface = fixed_interface(whole, whole.dofs.rows(kept), asked.modes)
    return Reduction(asked, structure, kept, contacts, base, project(whole, fixed, asked.modes, base))

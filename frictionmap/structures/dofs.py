"""Degrees of freedom by what a file calls them: a number, counted from 1, or a label NODE.DOF."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from .. import checks
from ..errors import InputError
from .entries import Label

#: What the degrees of freedom of a structure given by modes are.
POINT = "point"


@dataclass(frozen=True)
class Dofs:
    """The degrees of freedom of a structure, in the order of its rows.

    numbers : increasing, from 1; with gaps where rows of the file were left out
    labels : node and degree of freedom at it, or names, if the file has them
    noun : what they are: masses, or points of a structure given by modes
    """

    numbers: tuple[int, ...]
    labels: tuple[Label | str, ...] | None = None
    noun: str = "mass"

    @classmethod
    @lru_cache(maxsize=16)  # a system asks for them with every call
    def counted(cls, n: int, labels: tuple[Label | str, ...] | None = None) -> "Dofs":
        """Number the degrees of freedom from 1 to n."""
        return cls(tuple(range(1, n + 1)), labels)

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return len(self.numbers)

    @property
    def all_there(self) -> bool:
        """Whether the numbers are 1 to n."""
        return self.numbers[-1] == self.n

    def at(self, rows: Sequence[int] | np.ndarray) -> "Dofs":
        """Select the degrees of freedom of some rows, increasing."""
        labels = None if self.labels is None else tuple(self.labels[row] for row in rows)
        return Dofs(tuple(self.numbers[row] for row in rows), labels, self.noun)

    @cached_property
    def _rows(self) -> dict[int, int]:
        return {number: row for row, number in enumerate(self.numbers)}

    @cached_property
    def _labelled(self) -> dict[str, int]:
        words = self.labels or ()
        return {_written(label): number for label, number in zip(words, self.numbers, strict=bool(words))}

    @property
    def written_labels(self) -> list[str]:
        """The labels as text; empty without."""
        return list(self._labelled)

    def row(self, number: int) -> int:
        """The row of a number, counted from 0."""
        return self._rows[number]

    def rows(self, numbers: Sequence[int]) -> list[int]:
        """The rows of numbers."""
        return [self._rows[number] for number in numbers]

    def number(self, given: object, name: str) -> int:
        """The number of a degree of freedom that was given by number or label.

        Raises
        ------
        InputError
            There is none.
        """
        if isinstance(given, str) and self.labels is not None:
            if given not in self._labelled:
                words = list(self._labelled)
                if self.noun == POINT:
                    raise InputError(
                        name,
                        f"must be one of the points {', '.join(words)}; got {checks.one_line(given)}"
                        f"{checks.nearest(given, words)}",
                    )
                raise InputError(
                    name,
                    f"must be a number, or a label of the file such as {words[0]} or "
                    f"{words[-1]}; got {checks.one_line(given)}{checks.nearest(given, words)}",
                )
            return self._labelled[given]
        if isinstance(given, float) and self.labels is not None:
            raise InputError(name, f"must be a whole number, or a label in quotes; got {given}")
        found = checks.whole(given, name, least=1, most=self.numbers[-1])
        if found not in self._rows:
            shown = ", ".join(str(number) for number in self.numbers[:12])
            more = ", ..." if self.n > 12 else ""
            raise InputError(name, f"must be one of {shown}{more}; got {found}")
        return found

    def word(self, number: int) -> str:
        """A number, with its label; of points the label alone."""
        if self.labels is None:
            return str(number)
        if self.noun == POINT:
            return _written(self.labels[self.row(number)])
        return f"{number} ({_written(self.labels[self.row(number)])})"

    def name(self, number: int) -> str:
        """What a number is called in a sentence: mass 2, mass 2 (17.3), or point tip."""
        return f"{self.noun} {self.word(number)}"


def _written(label: Label | str) -> str:
    return label if isinstance(label, str) else f"{label[0]}.{label[1]}"

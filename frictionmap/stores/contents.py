"""What a store holds, and its division: cells in rows, rows in blocks, and blocks in batches.

Whatever is computed cell by cell can be stored: a client says along which axes its rows lie, computes the
rows of a batch, and describes itself in a text from which workers build it again.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from typing import Any, ClassVar, NamedTuple

import numpy as np
import xarray as xr

#: Maximum number of cells of a block, for any computing time: limits memory and number of files.
BLOCK_CELLS = 2**20

#: Maximum number of small blocks computed and written together, and the inverse of their share of the cells.
TOGETHER = 64


class Batch(NamedTuple):
    """Blocks that are computed and written together: one large block, or small neighbouring ones."""

    first: tuple[int, ...]  # place of the first of them among the marks
    sizes: tuple[int, ...]  # how many along every axis of the marks

    @property
    def places(self) -> tuple[slice, ...]:
        """Their places among the marks."""
        return tuple(slice(k, k + size) for k, size in zip(self.first, self.sizes, strict=True))


class Cut(NamedTuple):
    """Division of the cells of a store into blocks, and of blocks into batches."""

    rows: int  # of a block; the last one along its axis may have fewer
    #: blocks of a batch along every axis of the marks; those at the ends may have fewer
    together: tuple[int, ...]


class Contents(ABC):
    """What is computed into a store; clients are dataclasses with `block_cells` and `cut`."""

    #: Its name in stores, and the axis whose values are the rows.
    kind: ClassVar[str]
    row_axis: ClassVar[str]
    #: The attribute of a store with the description.
    described_in: ClassVar[str]

    #: Whether the description does not identify the data beside it.
    hashes_data: ClassVar[bool] = True

    block_cells: int
    cut: Cut | None  # as its store is cut; None: by the number of cells alone

    @classmethod
    @abstractmethod
    def stored(cls, text: str, arrays: Mapping[str, np.ndarray]) -> "Contents":
        """Contents by their description, and arrays that are stored beside it and read when used."""

    @abstractmethod
    def description(self, title: str) -> str:
        """TOML text that says what the contents are, to the bit, except for `arrays`."""

    @abstractmethod
    def attributes(self) -> dict[str, Any]:
        """Further attributes of the store."""

    @abstractmethod
    def arrays(self) -> Iterator[tuple[str, np.ndarray]]:
        """Data that are too large for text, by their places in the store."""

    def differing_data(self, there: Mapping[str, np.ndarray]) -> str:
        """Name of the `arrays` that differ in a store with the same description; empty if none do."""
        return ""

    @property
    @abstractmethod
    def outer(self) -> dict[str, int]:
        """Axes before the rows, with their sizes: a block is at one point of them."""

    @property
    @abstractmethod
    def row_count(self) -> int:
        """Number of rows at one point of the outer axes."""

    @property
    @abstractmethod
    def row_cells(self) -> int:
        """Cells of a row."""

    @property
    def row_values(self) -> int:
        """Size of a row, as a number of cells."""
        return self.row_cells

    @property
    @abstractmethod
    def sizes(self) -> dict[str, int]:
        """Sizes of the axes of the store; the others are those of the sample."""

    @property
    @abstractmethod
    def sample(self) -> xr.Dataset:
        """One cell, computed once: it shows the variables, and compiles all kernels."""

    #: Outer axes that the variables of the sample do not have.
    added: tuple[str, ...] = ()

    @abstractmethod
    def companions(self) -> Mapping[str, tuple[str, ...]]:
        """Coordinates that are not axes, with their dimensions."""

    @abstractmethod
    def coordinates(self) -> dict[str, xr.Variable]:
        """All coordinates of the store."""

    @abstractmethod
    def fill_value(self, name: str) -> float:
        """Value of a variable in cells that are not computed."""

    @abstractmethod
    def compute(self, batch: Batch, threads: int | None) -> dict[str, np.ndarray]:
        """The variables of a batch; the same to the bit as if all cells are computed at once."""

    @abstractmethod
    def cell_seconds(self, threads: int | None) -> float:
        """Computing time of a cell on average, counted and not measured; `threads` may look at some cells."""

    @property
    def rows(self) -> int:
        """Rows of a block; the last one may have fewer."""
        return self._cut.rows

    @property
    def together(self) -> tuple[int, ...]:
        """Blocks of a batch along every axis of the marks; batches at the ends may have fewer."""
        return self._cut.together

    @property
    def _cut(self) -> Cut:
        return self.cut or self.cut_at(self.cells)

    @property
    def shape(self) -> tuple[int, ...]:
        """Blocks along the outer axes and the rows."""
        return self._shape(self.rows)

    def _shape(self, rows: int) -> tuple[int, ...]:
        return (*self.outer.values(), math.ceil(self.row_count / rows))

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return math.prod(self.shape)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return math.prod(self.outer.values()) * self.row_count * self.row_cells

    def cut_at(self, cells: int) -> Cut:
        """Divide the contents into blocks and batches of at most `cells` cells; a block has at least one row.

        Large blocks are alone; small ones share files, and what it costs to write them.
        """
        rows = max(1, min(self.row_count, self.block_cells // self.row_values, cells // self.row_cells))
        small = self.block_cells // TOGETHER // (rows * self.row_values)
        room = min(TOGETHER, small, cells // (rows * self.row_cells))
        sizes: list[int] = []
        for size in reversed(self._shape(rows)):
            sizes.append(max(1, min(size, room)))
            room //= sizes[-1]
        return Cut(rows, tuple(reversed(sizes)))

    def batch(self, first: tuple[int, ...]) -> Batch:
        """The batch whose first block is at this place among the marks."""
        ends = zip(first, self.shape, self.together, strict=True)
        return Batch(first, tuple(min(most, size - k) for k, size, most in ends))

    def batches(self) -> Iterator[Batch]:
        """Iterate over all batches."""
        steps = zip(self.shape, self.together, strict=True)
        return map(self.batch, product(*(range(0, size, step) for size, step in steps)))

    def rows_of(self, batch: Batch) -> slice:
        """Rows that a batch has."""
        first = batch.first[-1] * self.rows
        return slice(first, min(first + self.rows * batch.sizes[-1], self.row_count))


#: Finds where the cells of contents are cut.
FindCut = Callable[[Contents], Cut]


def with_cut(contents: Contents, cut: Cut) -> Contents:
    """The contents, cut in this way."""
    return replace(contents, cut=cut)  # type: ignore[type-var]

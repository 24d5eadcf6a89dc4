"""Contents of a store: systems along further axes, a grid, settings; and the blocks it is computed in.

A block consists of complete rows in r at one point of the further axes and one mu.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
import xarray as xr

from ..model.settings import Solver
from ..model.system import System
from ..model.variations import Variations
from ..steady.refinement import reduction_check
from ..steady.sweep import regime_map, study_coordinates
from ..units.scales import Scales, Units, scales_of

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

    @property
    def points(self) -> Iterator[tuple[int, ...]]:
        """The points of the further axes that they are of."""
        return product(*(range(part.start, part.stop) for part in self.places[:-2]))


class Cut(NamedTuple):
    """Division of the cells of a study into blocks, and of blocks into batches."""

    rows: int  # of a block; the last one of a map may have fewer
    #: blocks of a batch along every axis of the marks; those at the ends may have fewer
    together: tuple[int, ...]


@dataclass(frozen=True)
class Study:
    """Maps of one system, or of many along further axes."""

    variations: Variations
    mu: np.ndarray
    r: np.ndarray
    beta: np.ndarray
    solver: Solver
    block_cells: int = BLOCK_CELLS
    units: Units | None = None
    cut: Cut | None = None  # as its store is cut; None: by the number of cells alone

    @property
    def system(self) -> System:
        """System of which the others are variations."""
        return self.variations.system

    @property
    def scales(self) -> Scales:
        """Reference values of the ratios in SI units."""
        return scales_of(self.units, self.system, self.variations)

    @cached_property
    def _cut(self) -> Cut:
        return self.cut or self.cut_at(self.cells)

    @property
    def reduction_check(self) -> dict[str, str]:
        """Effect of all modes, or many more, of a reduced structure, see `steady.refinement`."""
        return reduction_check(self.system, {"mu": self.mu, "r": self.r, "beta": self.beta}, self.solver)

    @property
    def rows(self) -> int:
        """Rows of a block; the last one of a map may have fewer."""
        return self._cut.rows

    @property
    def together(self) -> tuple[int, ...]:
        """Blocks of a batch along every axis of the marks; batches at the ends may have fewer."""
        return self._cut.together

    @property
    def _row(self) -> int:
        """Size of a row, as a number of cells."""
        return self.beta.size * (self.system.n if "amplitude" in self.solver.outputs else 1)

    @property
    def shape(self) -> tuple[int, ...]:
        """Blocks along the further axes, mu and r."""
        return self._shape(self.rows)

    def _shape(self, rows: int) -> tuple[int, ...]:
        return (*self.variations.shape, self.mu.size, math.ceil(self.r.size / rows))

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return math.prod(self.shape)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return self.variations.count * self.mu.size * self.r.size * self.beta.size

    def cut_at(self, cells: int) -> Cut:
        """Divide the study into blocks and batches of at most `cells` cells; a block has at least one row.

        Large blocks are alone; small ones share files, and what it costs to write them.
        """
        rows = max(1, min(self.r.size, self.block_cells // self._row, cells // self.beta.size))
        small = self.block_cells // TOGETHER // (rows * self._row)
        room = min(TOGETHER, small, cells // (rows * self.beta.size))
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

    def frequencies(self, batch: Batch) -> slice:
        """Rows of the map that a batch has."""
        return slice(batch.first[-1] * self.rows, min((batch.first[-1] + 1) * self.rows, self.r.size))

    def compute(self, batch: Batch, threads: int | None) -> dict[str, np.ndarray]:
        """The variables of a batch, along the further axes first; the same to the bit as in whole maps."""
        grid = {"mu": self.mu[batch.places[-2]], "r": self.r[self.frequencies(batch)], "beta": self.beta}
        maps = [
            regime_map(self.variations.at(point), grid, self.solver, threads, None) for point in batch.points
        ]
        along = batch.sizes[:-2]
        return {
            str(name): np.stack([one[name].values for one in maps]).reshape(*along, *variable.shape)
            for name, variable in maps[0].data_vars.items()
        }

    @cached_property
    def sample(self) -> xr.Dataset:
        """Compute one cell of the study, once: it shows the variables, and compiles all kernels."""
        grid = {"mu": self.mu[-1:], "r": self.r[-1:], "beta": self.beta[-1:]}
        return regime_map(self.system, grid, self.solver, 1, None)

    def coordinates(self) -> dict[str, xr.Variable]:
        """The further axes and what goes with them."""
        return study_coordinates(self.variations)


def study_of(
    system: System, variations: Variations | None, axes: dict[str, np.ndarray], solver: Solver,
    units: Units | None = None,
) -> Study:  # fmt: skip
    """The study of one system, or of its variations, on axes mu, r and beta.

    Every cell has a `status` in a store, as it is unknown beforehand which cells need one.
    """
    solver = replace(solver, outputs=tuple(dict.fromkeys((*solver.outputs, "status"))))
    return Study(
        variations or Variations(system, ()), axes["mu"], axes["r"], axes["beta"], solver, units=units
    )

"""What a store holds: systems along further axes, a grid, settings; and the blocks it is computed in."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr

from ..model.settings import Solver
from ..model.system import System
from ..model.variations import Variations
from ..steady.sweep import regime_map, study_coordinates
from ..units.scales import Scales, Units, scales_of

#: Cells of a block: some seconds of work at most, and few files.
BLOCK_CELLS = 2**20


class Block(NamedTuple):
    """Whole rows in r of one point of the further axes and one mu."""

    point: tuple[int, ...]
    mu: int
    rows: int  # which part of the rows

    @property
    def place(self) -> tuple[int, ...]:
        """Its place among the marks."""
        return (*self.point, self.mu, self.rows)


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

    @property
    def system(self) -> System:
        """The one that the others are variations of."""
        return self.variations.system

    @property
    def scales(self) -> Scales:
        """What the ratios are in SI units."""
        return scales_of(self.units, self.system, self.variations)

    @property
    def rows(self) -> int:
        """Rows of a block; the last one of a map may have fewer."""
        row = self.beta.size * (self.system.n if "amplitude" in self.solver.outputs else 1)
        return max(1, min(self.r.size, self.block_cells // row))

    @property
    def shape(self) -> tuple[int, ...]:
        """Blocks along the further axes, mu and r."""
        return (*self.variations.shape, self.mu.size, math.ceil(self.r.size / self.rows))

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return math.prod(self.shape)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return self.variations.count * self.mu.size * self.r.size * self.beta.size

    def block(self, place: tuple[int, ...]) -> Block:
        """The block at a place among the marks."""
        *point, mu, rows = place
        return Block(tuple(point), mu, rows)

    def places(self) -> Iterator[tuple[int, ...]]:
        """All places among the marks."""
        return iter(np.ndindex(self.shape))

    def frequencies(self, block: Block) -> slice:
        """Rows of the map that a block has."""
        return slice(block.rows * self.rows, min((block.rows + 1) * self.rows, self.r.size))

    def compute(self, block: Block, threads: int | None) -> xr.Dataset:
        """The variables of a block; the same to the bit as in the whole map."""
        grid = {
            "mu": self.mu[block.mu : block.mu + 1], "r": self.r[self.frequencies(block)], "beta": self.beta,
        }  # fmt: skip
        return regime_map(self.variations.at(block.point), grid, self.solver, threads, None)

    @cached_property
    def sample(self) -> xr.Dataset:
        """One cell of the study, computed once: which variables there are, and all kernels compiled."""
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

    Every cell has a `status` in a store: which cells want one is not known before all are computed.
    """
    solver = replace(solver, outputs=tuple(dict.fromkeys((*solver.outputs, "status"))))
    return Study(
        variations or Variations(system, ()), axes["mu"], axes["r"], axes["beta"], solver, units=units
    )

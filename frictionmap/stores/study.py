"""Maps of one system, or of many along further axes, as the contents of a store.

A block consists of complete rows in r at one point of the further axes and one mu.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from ..datasets.labels import LABELS
from ..datasets.physical import physical_axes, scale_attributes
from ..datasets.provenance import configuration, excitation_of
from ..datasets.variables import coordinate
from ..model.matrices import Matrices
from ..model.settings import Solver
from ..model.system import System
from ..model.variations import Variations
from ..steady.cost import seconds_of_cells
from ..steady.refinement import reduction_check
from ..steady.sweep import regime_map, study_coordinates
from ..units.scales import Scales, Units, scales_of
from .contents import BLOCK_CELLS, Batch, Contents, Cut

#: The group of the matrices of a structure that has any.
_MATRICES = "matrices"


@dataclass(frozen=True)
class Study(Contents):
    """Maps of one system, or of many along further axes."""

    kind: ClassVar[str] = "map"
    row_axis: ClassVar[str] = "r"
    described_in: ClassVar[str] = "config"

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

    @property
    def reduction_check(self) -> dict[str, str]:
        """Effect of all modes, or many more, of a reduced structure, see `steady.refinement`."""
        return reduction_check(self.system, {"mu": self.mu, "r": self.r, "beta": self.beta}, self.solver)

    @classmethod
    def stored(cls, text: str, arrays: Mapping[str, np.ndarray]) -> "Study":
        """The study of a configuration."""
        from ..files.config import config_of  # knows all tables, which no cell comes from

        matrices = _matrices_in(arrays)
        config = config_of(text, {_MATRICES: matrices} if matrices else {})
        axes = {"mu": config.mu, "r": config.r, "beta": config.beta}
        return study_of(config.system, config.variations, axes, config.solver, config.units)

    def description(self, title: str) -> str:
        """Configuration that reproduces the study; matrices are stored as arrays."""
        grid = {"r": self.r, "beta": self.beta, "mu": self.mu}
        further = self.variations.described or None
        return configuration(
            title, self.system, grid, self.solver, study=further, matrices=_MATRICES, units=self.units
        )

    def attributes(self) -> dict[str, Any]:
        """What datasets of maps say of the system."""
        return {
            "system": self.variations.describe(), "excitation": excitation_of(self.system),
            **self.system.costs(self.r), **self.reduction_check, **scale_attributes(self.scales),
        }  # fmt: skip

    def arrays(self) -> Iterator[tuple[str, np.ndarray]]:
        """Matrices of a structure by their places; none of a chain."""
        matrices = self.system.matrices
        if isinstance(matrices, Matrices):
            for name, one in matrices.arrays.items():
                yield f"{_MATRICES}/{name}", one

    def differing_data(self, there: Mapping[str, np.ndarray]) -> str:
        """The key of the matrices if they differ."""
        here, found = dict(self.arrays()), _matrices_in(there)
        same = len(here) == len(found) and all(
            np.array_equal(one, there[name]) for name, one in here.items() if name in there
        )
        return "" if same and set(here) <= set(there) else "system.matrices"

    @property
    def outer(self) -> dict[str, int]:
        """The further axes and mu."""
        return {**dict(zip(self.added, self.variations.shape, strict=True)), "mu": self.mu.size}

    @property
    def added(self) -> tuple[str, ...]:  # type: ignore[override]
        """The further axes."""
        return tuple(axis.name for axis in self.variations.axes)

    @property
    def row_count(self) -> int:
        """Number of frequencies."""
        return self.r.size

    @property
    def row_cells(self) -> int:
        """Number of values of beta."""
        return self.beta.size

    @property
    def row_values(self) -> int:
        """Size of a row, as a number of cells."""
        return self.beta.size * (self.system.n if "amplitude" in self.solver.outputs else 1)

    @property
    def sizes(self) -> dict[str, int]:
        """The further axes and those of a map."""
        return self.outer | {"r": self.r.size, "beta": self.beta.size, "dof": self.system.n}

    def companions(self) -> dict[str, tuple[str, ...]]:
        """What goes with the further axes, and axes in SI units."""
        further = {
            name: one for name, one in study_coordinates(self.variations).items() if name not in self.added
        }
        return {name: tuple(map(str, one.dims)) for name, one in (further | self._physical()).items()}

    def coordinates(self) -> dict[str, xr.Variable]:
        """The further axes, those of the grid, and what goes with them."""
        grid = {name: coordinate(name, getattr(self, name)) for name in ("mu", "r", "beta")}
        own = ("dof", "contact", "contact_name", "segment", "point_name", "spring", "spring_name")
        further = {name: self.sample[name].variable for name in own if name in self.sample.coords}
        return study_coordinates(self.variations) | grid | self._physical() | further

    def _physical(self) -> dict[str, xr.Variable]:
        """The axes r and beta in hertz and newtons."""
        return physical_axes({"r": self.r, "beta": self.beta}, self.scales)

    def fill_value(self, name: str) -> float:
        """The value of unresolved cells; NaN of boundaries."""
        return LABELS[name].unresolved if "beta" in LABELS[name].dims else np.nan

    def cell_seconds(self, threads: int | None) -> float:
        """By the numbers of steps in some cells."""
        axes = {"mu": self.mu, "r": self.r, "beta": self.beta}
        return seconds_of_cells(self.system, axes, self.solver, threads)

    def compute(self, batch: Batch, threads: int | None) -> dict[str, np.ndarray]:
        """The variables of a batch, along the further axes first; the same to the bit as in whole maps."""
        grid = {"mu": self.mu[batch.places[-2]], "r": self.r[self.rows_of(batch)], "beta": self.beta}
        points = product(*(range(part.start, part.stop) for part in batch.places[:-2]))
        maps = [regime_map(self.variations.at(point), grid, self.solver, threads, None) for point in points]
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


def _matrices_in(arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The matrices among the arrays of a store."""
    own = f"{_MATRICES}/"
    return {name.removeprefix(own): arrays[name] for name in arrays if name.startswith(own)}


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

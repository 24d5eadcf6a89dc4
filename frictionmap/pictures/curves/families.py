"""The parameter in which the lines of a picture of response curves differ: friction ratio, or mu for a single
beta.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr

from ... import regimes
from ...datasets.labels import regime_of_choice
from ...files.stored import stored_system
from ...model.system import System
from ..grids import Grid
from ..palette import sequence
from ..second_axes import in_brackets


class Family(NamedTuple):
    """Curves over frequency, one for each value of beta (or of mu)."""

    cells: xr.Dataset  # dims (beta or mu, r, ...)
    r: Grid
    line: str  # dimension in which the lines differ
    labels: list[str]
    colours: list[str]
    regime: np.ndarray  # (lines, r)
    chosen: str  # the common value of the other dimension
    system: System | None  # system stored in the file, if any

    def rows(self, name: str, **chosen: int) -> np.ndarray:
        """Values of a variable that depends on frequency, (lines, r); one row if common to all lines."""
        values = self.cells[name].isel(chosen)
        return np.atleast_2d(values.transpose(*({self.line} & set(values.dims)), "r").values)

    def contacts(self, name: str) -> list["Family"]:
        """The family with the values of each contact that a variable has; itself if there is one contact."""
        if "contact" not in self.cells[name].dims:
            return [self]
        own = [self.cells.isel(contact=k) for k in range(self.cells.sizes["contact"])]
        return [self._replace(cells=cells, regime=_regime_of(cells, self.line, self.regime)) for cells in own]

    @property
    def beta(self) -> np.ndarray:
        """Friction ratio of every line."""
        return np.broadcast_to(self.cells["beta"].values, (len(self.labels),))


def _regime_of(cells: xr.Dataset, line: str, otherwise: np.ndarray) -> np.ndarray:
    """Regime of every point, (lines, r): of the contact that was chosen, or of all."""
    name = regime_of_choice(cells)
    return cells[name].transpose(line, "r").values if name in cells else otherwise


def _one_of(symbol: str, values: np.ndarray) -> str:
    first = f"{symbol} = {values[0]:g}"
    return first if values.size == 1 else f"{first} (the first of {values.size})"


def family_of(ds: xr.Dataset) -> Family:
    """Curves of a dataset; for several mu the first one, unless there is a single beta.

    A single frequency extends over its cell.
    """
    r = Grid(ds["r"].values)
    if r.values.size == 1:
        ds = ds.isel(r=[0, 0]).assign_coords(r=r.edges)
    line, other = ("mu", "beta") if ds.sizes["beta"] == 1 < ds.sizes["mu"] else ("beta", "mu")
    symbols = {"beta": "β", "mu": "μ"}
    values = ds[line].values
    cells = ds.isel({other: 0})
    shape = values.size, ds.sizes["r"]
    regime = _regime_of(cells, line, np.full(shape, regimes.CONTINUOUS))
    return Family(
        cells=cells,
        r=r,
        line=line,
        labels=[
            f"{symbols[line]} = {value:g}{in_brackets(ds, line, index)}" for index, value in enumerate(values)
        ],
        colours=sequence(values.size),
        regime=regime,
        chosen=_one_of(symbols[other], ds[other].values),
        system=stored_system(ds),
    )

"""Where fitted motions lie among the regimes of the structure that they are of."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ...files.config import system_in
from ...model.settings import GeneralOutput, Output
from ...model.system import System
from ...solvers.choose import has_closed_forms
from ...steady.sweep import sweep
from ..curves.axes import Panel
from ..maps.regime_map import cells_of, draw_map
from ..palette import CLASSES
from ..panels import Handle, distinct, halo, patch

#: Cells of the map each way: of one mass, and of structures, whose cells take longer.
_CELLS, _CELLS_OF_STRUCTURES = (150, 120), (70, 50)

#: The map extends beyond the motions by this factor, and at least to these values.
_ABOVE, _LEAST_R, _LEAST_BETA = 1.15, 1.0, 1.2


#: Height of its panel [inch].
MAP_HEIGHT = 4.2


class Positions(NamedTuple):
    """Motions of one colour."""

    r: np.ndarray
    beta: np.ndarray
    colour: str


def fitted_system(ds: xr.Dataset) -> System | None:
    """The structure with the fitted damping and spring in its contact, as far as the dataset contains it."""
    system = system_in(str(ds.attrs.get("config", "")))
    if system is None:
        return None
    system = replace(system, contact_stiffness=None)
    if not has_closed_forms(system):
        return None
    if not system.modes.zeta.any() and "zeta" in ds["parameter"].values:
        system = replace(system, damping_ratios=max(fitted(ds, "zeta", 0.0), 0.0))
    spring = fitted(ds, "contact_stiffness", 0.0)
    if spring <= 0.0 or ds["at_bound"].sel(
        parameter="contact_stiffness"
    ):  # on its bound the contact is rigid
        return system
    return replace(system, contact_stiffness=spring)


def fitted(ds: xr.Dataset, name: str, default: float) -> float:
    """The estimate of a parameter, or what it is where it is none."""
    there = name in ds["parameter"].values
    return float(ds["estimate"].sel(parameter=name)) if there else default


def position_panel(system: System, mu: float, positions: list[Positions]) -> Panel:
    """A panel with the regimes over r and beta, and dots where the motions are."""
    grid = _CELLS if system.n == 1 else _CELLS_OF_STRUCTURES
    r_end = max(_ABOVE * max(float(part.r.max()) for part in positions), _LEAST_R)
    beta_end = max(_ABOVE * max(float(part.beta.max()) for part in positions), _LEAST_BETA)
    r, beta = (
        np.linspace(0.0, end, number + 1)[1:] for end, number in zip((r_end, beta_end), grid, strict=True)
    )

    def position(ax: Axes) -> list[Handle]:
        elastic = system.contact_system.elastic.any()
        count: Output | GeneralOutput = "slip_reversals_per_cycle" if elastic else "stops_per_cycle"
        panel = sweep(system, r, beta, mu, outputs=["regime", count]).isel(mu=0)
        cells = cells_of(panel)
        handles = draw_map(ax, panel, cells)
        for part in positions:
            ax.plot(
                part.r, part.beta, "o", color=part.colour, markersize=5.5, markeredgecolor="black",
                markeredgewidth=0.7, path_effects=halo(1.8), zorder=4.0,
            )  # fmt: skip
        classes = [
            patch(cells.by.labels[index], CLASSES[index].colour) for index in np.flatnonzero(cells.counts)
        ]
        return distinct([*classes, *handles])

    return position

"""Pictures of records: the steady motion in time, and all its cycles over each other."""

from dataclasses import replace

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ...errors import InputError
from ..palette import LINES, MEASURED
from ..panels import Handle
from .data import FITTED, Samples, draw_data, draw_residuals, in_brackets, samples_of
from .picture import FitPicture, Tall
from .position import MAP_HEIGHT, Positions, fitted, fitted_system, position_panel
from .samples import RESIDUALS, VALUES

_NEEDED = ("time", "base", "base_frequency")
_BASE_COLOUR, _DOT_COLOUR = LINES[1], LINES[4]

#: Height of the panel of one cycle [inch].
_CYCLE = 2.6


def is_record(ds: xr.Dataset) -> bool:
    """Whether all is there that a record needs."""
    return set(_NEEDED) <= set(ds) and {"f_n", "beta"} <= set(ds["parameter"].values.tolist())


def record_picture(ds: xr.Dataset) -> FitPicture:
    """Base and mass over time, residuals, all cycles as one, and where the motion lies on the map."""
    frequency, f_n = float(ds["base_frequency"]), fitted(ds, "f_n", 1.0)
    if frequency <= 0.0 or f_n <= 0.0:
        raise InputError(f"base_frequency and f_n must be > 0 to be drawn; got {frequency:g}, {f_n:g}")
    samples = samples_of(ds)
    base = ds["base"].values[np.argsort(ds["time"].values, kind="stable")]

    def values(ax: Axes) -> list[Handle]:
        ax.set_ylabel(f"displacement{in_brackets(samples.unit)}")
        return [*_draw_base(ax, samples.x, base), *_draw_motion(ax, samples)]

    def residuals(ax: Axes) -> list[Handle]:
        return draw_residuals(ax, samples, f"residual{in_brackets(samples.unit)}")

    def cycle(ax: Axes) -> list[Handle]:
        turns = np.mod(samples.x * frequency, 1.0)
        order = np.argsort(turns, kind="stable")
        folded = samples._replace(
            x=turns[order], data=samples.data[order], model=samples.model[order], sigma=samples.sigma[order]
        )
        ax.set_xlabel("cycles of the base, one over the other")
        ax.set_ylabel(f"displacement{in_brackets(samples.unit)}")
        return [*_draw_base(ax, folded.x, base[order]), *_draw_motion(ax, folded)]

    beside = [(_CYCLE, cycle), *_position(ds, frequency / f_n)]
    return FitPicture([(VALUES, values), (RESIDUALS, residuals)], beside, [])


def _draw_base(ax: Axes, x: np.ndarray, base: np.ndarray) -> list[Handle]:
    return [
        *ax.plot(x, base, color=_BASE_COLOUR, linewidth=0.9, linestyle=(0, (4, 2)), label="base, measured")
    ]


def _draw_motion(ax: Axes, samples: Samples) -> list[Handle]:
    """Samples of the mass under the fitted motion."""
    fitted_line = ax.plot(samples.x, samples.model, color=FITTED, linewidth=1.0, zorder=2.6, label="fitted")
    ends = samples.data - samples.sigma, samples.data + samples.sigma
    return [*draw_data(ax, samples, ends, MEASURED), *fitted_line]


def _position(ds: xr.Dataset, r: float) -> list[Tall]:
    """The map of the structure on a base that moves with one harmonic, if the file contains the structure."""
    system = fitted_system(ds)
    if system is None or system.n > 1:
        return []
    system = replace(system, excitation="base")
    beta = max(fitted(ds, "beta", 0.0), 0.0)
    where = Positions(np.array([r]), np.array([beta]), _DOT_COLOUR)
    return [(MAP_HEIGHT, position_panel(system, max(fitted(ds, "mu", 1.0), 1.0), [where]))]

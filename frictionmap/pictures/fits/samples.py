"""Pictures of fits to any data: what was measured over what was fitted."""

import xarray as xr
from matplotlib.axes import Axes

from ...units.table import UNITS
from ..panels import Handle
from .data import FITTED, draw_data, draw_residuals, in_brackets, samples_of
from .picture import FitPicture

#: Names of what was measured, by the measure of its unit.
_MEASURED = {"force": "force", "length": "displacement"} | {
    name: name for name in ("angle", "velocity", "acceleration")
}

#: Heights of the panels of values and of residuals [inch].
VALUES, RESIDUALS = 3.2, 1.5


def samples_picture(ds: xr.Dataset) -> FitPicture:
    """Samples over the values fitted to them, and residuals below."""
    samples = samples_of(ds)
    unit = UNITS.get(samples.unit)
    what = _MEASURED.get(unit.measures, "data") if unit is not None else "data"

    def values(ax: Axes) -> list[Handle]:
        ax.set_ylabel(f"{what}{in_brackets(samples.unit)}")
        fitted = ax.plot(samples.x, samples.model, color=FITTED, linewidth=1.1, label="fitted")
        ends = samples.data - samples.sigma, samples.data + samples.sigma
        return [*draw_data(ax, samples, ends), *fitted]

    def residuals(ax: Axes) -> list[Handle]:
        return draw_residuals(ax, samples, f"residual{in_brackets(samples.unit)}")

    return FitPicture([(VALUES, values), (RESIDUALS, residuals)], [], [])

"""Pictures of damper tests: force and residuals in time, and force over the motion."""

import xarray as xr
from matplotlib.axes import Axes

from ..palette import MEASURED
from ..panels import Handle
from .data import FITTED
from .picture import FitPicture
from .samples import RESIDUALS, VALUES, samples_picture


def is_loop(ds: xr.Dataset) -> bool:
    """Whether the fit is one of a damper test."""
    return {"motion", "motion_model"} <= set(ds)


def loop_picture(ds: xr.Dataset) -> FitPicture:
    """Force in time over the fitted one, residuals below, and both over the motion beside."""
    picture = samples_picture(ds)

    def loops(ax: Axes) -> list[Handle]:
        motion = ds["motion"]
        ax.set_xlabel(f"{motion.attrs['long_name']} [{motion.attrs['units']}]")
        ax.set_ylabel("force [N]")
        dots = ax.plot(
            motion.values, ds["data"].values, ".", color=MEASURED, markersize=2.8, label="measured"
        )
        fitted = ax.plot(
            ds["motion_model"].values, ds["model"].values, color=FITTED, linewidth=1.0, label="fitted"
        )
        return [*dots, *fitted]

    return FitPicture(picture.panels, [(VALUES + RESIDUALS, loops)], [])

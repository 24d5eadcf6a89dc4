"""Pictures of one motion on a belt without a load: in time, and in the plane of displacement and velocity."""

from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...datasets.motion_labels import stuck_times
from ...datasets.physical import ones_of
from ...units.table import UNITS, handy_unit
from ..drawing import with_options
from ..options import FigureOptions
from ..palette import CLASSES, LINES, STUCK, in_turn
from ..panels import Handle, new_figure
from ..shapes import check_holds, to_draw
from ..sizes import figure_size
from .in_time import end_picture
from .loops import draw_arrow
from .traces import contact_colours, is_at_rest

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Width below which the unit has a line of its own below the narrow panel [inch].
_NARROW = 4.5

#: Size of the picture [inch].
_WIDTH, _HEIGHT = 9.0, 5.4


@with_options
def plot_belt_motion(ds: xr.Dataset, **options: Unpack[FigureOptions]) -> "AxesArray":
    """Draw one motion on a belt without a load.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `response` with wall_speed.

    Returns
    -------
    Axes of the displacements and of the friction over time, and of the velocities over the displacements.

    Raises
    ------
    InputError
        The dataset is another one.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.response(fm.System(damping_ratios=0.05), wall_speed=0.1, beta=0.5, mu=1.5)
    >>> axes = fm.plot_belt_motion(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['displacement', 'friction', 'velocity']
    """
    ds = to_draw(ds, "plot_belt_motion", "belt")
    check_holds(ds, ("time", "x", "v", "friction", "direction"), "a motion")
    figure = new_figure(_WIDTH, _HEIGHT)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.6, 1.0))
    above = figure.add_subplot(grid[0, 0])
    axes = np.array([above, figure.add_subplot(grid[1, 0], sharex=above), figure.add_subplot(grid[:, 1])])
    _draw_times(axes[0], axes[1], ds)
    _draw_plane(axes[2], ds)
    end_picture(ds, axes, _handles(ds), "")
    return axes


def _handy(ds: xr.Dataset, name: str, measure: str) -> tuple[float, str]:
    """Factor of ratios in a handy unit, and the unit in brackets; 1 where none is known."""
    one = ones_of(ds).get(measure)
    if one is None:
        return 1.0, ""
    unit = handy_unit(one * float(np.abs(ds[name].values).max()), measure)
    return one / float(UNITS[unit].size), f" [{unit}]"


def _draw_times(places: Axes, forces: Axes, ds: xr.Dataset) -> None:
    """Draw displacements and friction over time; all contacts stick where it is shaded."""
    in_seconds = "time_s" in ds
    time = ds["time_s" if in_seconds else "time"].values
    place, length = _handy(ds, "x", "length")
    force, newton = _handy(ds, "friction", "force")
    x, friction = place * ds["x"].values, force * np.atleast_2d(ds["friction"].values)
    for ax, rows, colours, words in (
        (places, x, in_turn(LINES, len(x)), f"displacement{length}"),
        (forces, friction, contact_colours(len(friction)), f"friction{newton}"),
    ):
        for row, colour in zip(rows, colours, strict=True):
            ax.plot(time, row, color=colour, linewidth=1.2)
        ax.set_ylabel(words)
        ax.margins(x=0.0)
        for begin, end in stuck_times(time, np.atleast_2d(ds["direction"].values)):
            ax.axvspan(begin, end, color=CLASSES[STUCK].colour, alpha=0.35, linewidth=0.0)
    forces.set_xlabel("time [s]" if in_seconds else r"time [1/$\omega_1$]")


def _draw_plane(ax: Axes, ds: xr.Dataset) -> None:
    """Draw velocities over displacements, and the speed of the belt."""
    place, length = _handy(ds, "x", "length")
    speed, unit = _handy(ds, "wall_speed", "velocity")
    colours = in_turn(LINES, ds.sizes["dof"])
    for x, v, colour in zip(ds["x"].values, ds["v"].values, colours, strict=True):
        ax.plot(place * x, speed * v, color=colour, linewidth=1.2)
        if not is_at_rest(x):
            draw_arrow(ax, place * x, speed * v, int(np.argmin(v)), colour)
    ax.axhline(speed * float(ds["wall_speed"]), color="black", linewidth=0.8, linestyle=(0, (4, 2)))
    gap = "\n" if length and figure_size(_WIDTH, _HEIGHT)[0] < _NARROW else " "
    ax.set_xlabel(f"displacement{gap}{length.strip()}".strip())
    ax.set_ylabel(f"velocity{unit}")


def _handles(ds: xr.Dataset) -> list[Handle]:
    masses, contacts = ds["dof"].values, np.atleast_1d(ds["contact"].values if "contact" in ds else 1)
    handles: list[Handle] = []
    for numbers, colours, words in (
        (masses, in_turn(LINES, masses.size), "mass"),
        (contacts, contact_colours(contacts.size), "friction of contact"),
    ):
        if numbers.size > 1:
            pairs = zip(numbers, colours, strict=True)
            handles += [Line2D([], [], color=colour, label=f"{words} {number}") for number, colour in pairs]
    handles.append(Line2D([], [], color="black", linestyle=(0, (4, 2)), label="speed of the belt"))
    return [*handles, Patch(color=CLASSES[STUCK].colour, alpha=0.35, label="all contacts stick")]

"""Modes of structures, with their points."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

import numpy as np
from matplotlib.axes import Axes

from .. import checks
from ..errors import InputError
from ..model.system import System
from ..structures.dofs import POINT
from ..structures.modes import Modes
from ..structures.uniform import Beam, Plate
from ..units.scales import OF_MODEL, Units, scales_of
from .drawing import with_options
from .options import FigureOptions, current
from .palette import LINES
from .panels import given_axes, grid_of_panels, halo
from .shapes import check_options
from .sizes import points
from .structures import geometry_of

if TYPE_CHECKING:
    from .panels import AxesArray

#: Places along a beam, and along each side of a plate.
_PLACES, _ACROSS = 401, 81

#: Points of a mode that have their names at the axis, at most.
_NAMED = 12

#: Modes that are drawn at most.
_MOST = 24


def _structure_of(given: object) -> Beam | Plate | Modes:
    """What is drawn: of a system its beam, its plate, or its modes."""
    found = geometry_of(given)
    if found is not None:
        return found
    if isinstance(given, System):
        modes, dofs = given.modes, given.dofs
        names = dofs.written_labels or [str(number) for number in dofs.numbers]
        return Modes(modes.w, 0.0, modes.phi, names, source="masses without friction")
    raise InputError(
        "structure", f"must be a frictionmap.System, Beam, Plate or Modes; got {checks.one_line(given)}"
    )


def _draw_beam(ax: Axes, beam: Beam, k: int, length: str) -> None:
    """Draw a mode over the place on a beam; `length`: the unit of places in brackets, if it is known."""
    x = np.linspace(0.0, beam.length, _PLACES)
    ax.axhline(0.0, color="0.6", linewidth=0.8)
    ax.plot(x, beam.shapes_at(x)[:, k], color=LINES[0], linewidth=1.4)
    for (name, place), value in zip(beam.points.items(), beam.shapes[:, k], strict=True):
        ax.plot(place, value, "o", color=LINES[4], markersize=4.0)
        _name_point(ax, name, place, value)
    ax.set_xlabel(f"place on the beam{length}")
    ax.set_ylabel("shape")


def _draw_plate(ax: Axes, plate: Plate, k: int, length: str) -> None:
    """Draw a mode of a plate as colours, with its nodal lines; `length` as of a beam."""
    x, y = (np.linspace(0.0, side, _ACROSS) for side in plate.size)
    places = np.stack(np.meshgrid(x, y), axis=-1)
    values = plate.shapes_at(places.reshape(-1, 2))[:, k].reshape(_ACROSS, _ACROSS)
    most = float(np.abs(values).max())
    ax.pcolormesh(x, y, values, cmap="RdBu_r", vmin=-most, vmax=most, shading="gouraud", rasterized=True)
    # edges at rest are no nodal lines: there the signs are those of rounding errors
    left, right, front, back = (int(kind != "free") for kind in plate.kinds)
    inside = slice(front, _ACROSS - back), slice(left, _ACROSS - right)
    if values[inside].min() < 0.0 < values[inside].max():
        ax.contour(x[inside[1]], y[inside[0]], values[inside], levels=[0.0], colors="black", linewidths=0.8)
    for name, (px, py) in plate.points.items():
        ax.plot(px, py, "o", color="black", markersize=4.0, clip_on=False)
        _name_point(ax, name, px, py, below=True)
    ax.set_aspect("equal")
    ax.set_xlabel(f"$x${length}")
    ax.set_ylabel(f"$y${length}")


def _draw_points(ax: Axes, modes: Modes, k: int, noun: str) -> None:
    """Draw a mode at points, or of masses, side by side."""
    place = np.arange(len(modes.points))
    values = modes.shapes[:, modes.rigid_modes + k]
    ax.axhline(0.0, color="0.6", linewidth=0.8)
    ax.vlines(place, 0.0, values, color=LINES[0], linewidth=1.4)
    ax.plot(place, values, "o", color=LINES[4], markersize=4.0)
    ax.set_xlim(-0.5, len(place) - 0.5)
    shown = place[:: -(-len(place) // _NAMED)]
    ax.set_xticks(shown, [modes.points[k] for k in shown])
    ax.set_xlabel(noun)
    ax.set_ylabel("shape")


def _name_point(ax: Axes, name: str, x: float, y: float, below: bool = False) -> None:
    """Write the name of a point next to it."""
    shift = (-4.0, -10.0) if below else (-4.0, 4.0)
    ax.annotate(
        name, (x, y), xytext=shift, textcoords="offset points", ha="right",
        fontsize=points(8.0, "xtick.labelsize"), path_effects=halo(), parse_math=False, annotation_clip=False,
    )  # fmt: skip


def _frequency_words(structure: object, frequency: float, units: Units | None) -> str:
    """The natural frequency of a mode: in hertz, or of masses without units a frequency ratio."""
    of_masses = geometry_of(structure) is None
    hertz = scales_of(units, structure).of("frequency") if isinstance(structure, System) else None
    if isinstance(structure, System) and hertz is not None:
        one = 1.0 if of_masses else structure.omega_1
        return f"{frequency / one * hertz:.5g} Hz"
    if of_masses:
        return f"$r$ = {frequency:.5g}"
    return f"$\\omega/2\\pi$ = {frequency / (2.0 * np.pi):.5g} (Hz in SI units)"


@with_options
def plot_modes(
    structure: Beam | Plate | Modes | System,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    count: int = 4,
    units: Units | None = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw the first elastic modes of a beam, a plate, or of any structure at its points or masses.

    Parameters
    ----------
    structure : Beam, Plate, Modes or System
        Of a system its modes without friction.
    ax : array of matplotlib axes, optional
        As many axes as modes to draw into.
    count : int
        Number of modes, 1 to 24; fewer where there are fewer.
    units : Units, optional
        Of a system: natural frequencies are then in hertz.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The structure has no modes at points, or the number of axes differs from that of the modes.

    Examples
    --------
    >>> import frictionmap as fm
    >>> beam = fm.Beam("clamped-free", length=1.0, bending_stiffness=1.0, mass_per_length=1.0,
    ...                points={"tip": 1.0})
    >>> len(fm.plot_modes(beam, count=2))
    2
    """
    found = _structure_of(structure)
    check_options("plot_modes")
    number = min(checks.whole(count, "count", least=1, most=_MOST), found.frequencies.size)
    draw = current().chosen(list(range(number)))
    if ax is None:
        title = (found.source or "structure") if isinstance(found, Modes) else found.describe()
        axes = grid_of_panels(len(draw), current().columns(min(len(draw), 2)), 2.6, f"Modes of the {title}")
    else:
        axes = given_axes(ax, len(draw), "one for each mode")
    length = " [m]" if units is not None and units.natural_frequency == OF_MODEL else ""
    noun = structure.dofs.noun if isinstance(structure, System) else POINT
    for one, k in zip(axes, draw, strict=True):
        if isinstance(found, Beam):
            _draw_beam(one, found, k, length)
        elif isinstance(found, Plate):
            _draw_plate(one, found, k, length)
        else:
            _draw_points(one, found, k, noun)
        frequency = found.frequencies[k]
        words = f"mode {k + 1}, {_frequency_words(structure, frequency, units)}"
        one.set_title(words, fontsize=points(10.0, "axes.titlesize"))
    return axes

"""Pictures of one steady state without time axis: phase portrait, friction loop, harmonics."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..curves.harmonics import LOWEST, levels_of
from ..drawing import with_options
from ..options import FigureOptions, current
from ..palette import LINES, in_turn
from ..panels import Handle, given_axes, grid_of_panels, legend_below, legend_under
from ..second_axes import length_on_top
from ..shapes import check_holds, to_draw
from ..sizes import points
from ..words import caption, length_unit, names_of_masses
from .history import MOST_LABELS, check_can_be_seen, is_a_mass, title_of
from .loops import draw_arrow, draw_loop, draw_stops
from .traces import CONTACT_COLOUR, at_rest, is_at_rest, traces_of

if TYPE_CHECKING:
    from ..panels import AxesArray


#: Marker of the contacts where there are several: it shows them in grey, too.
_CONTACT_MARKER = "s"


def _colours(ds: xr.Dataset) -> list[str]:
    return in_turn(LINES, ds.sizes["dof"])


def _draw_portrait(ax: Axes, ds: xr.Dataset) -> None:
    """Draw velocity over displacement of every mass; one at rest is a point."""
    traces = traces_of(ds)
    for x, v, colour in zip(ds["x"].values, ds["v"].values, _colours(ds), strict=True):
        if is_at_rest(x):
            x, v = at_rest(x), at_rest(v)
            ax.scatter(x[:1], v[:1], s=25.0, color=colour)
        else:
            draw_arrow(ax, x, v, int(np.argmax(v)), colour)
        ax.plot(x, v, color=colour, linewidth=1.2)
        for trace in traces:
            if np.allclose(x, trace.z, rtol=0.0, atol=1e-12):
                places = trace.stops[1]
                draw_stops(ax, places, np.zeros_like(places), colour)
    unit = length_unit(ds)
    ax.set_xlabel(f"displacement $x$ / {unit}")
    ax.set_ylabel(f"velocity $x'$ / {unit}")
    ax.set_title("phase portrait", fontsize=points(10.0, "axes.titlesize"))
    length_on_top(ax, ds, "displacement")


def _draw_loops(ax: Axes, ds: xr.Dataset) -> None:
    draw_loop(ax, ds, traces_of(ds))


def _contact_levels(ds: xr.Dataset) -> list[tuple[np.ndarray, str]]:
    """Harmonics and colours of the contacts that no mass moves with."""
    if "contact_harmonic" not in ds:
        return []
    values = ds["contact_harmonic"].values
    several = values if "contact" in ds["contact_harmonic"].dims else values[np.newaxis]
    return [
        (levels_of(one), trace.colour)
        for one, trace in zip(several, traces_of(ds), strict=True)
        if not is_a_mass(ds, trace)
    ]


def _draw_spectrum(ax: Axes, ds: xr.Dataset) -> None:
    """Draw harmonics as stems, those of several motions side by side."""
    motions = [*zip(levels_of(ds["displacement_harmonic"].values), _colours(ds), strict=True)]
    masses = len(motions)
    motions += _contact_levels(ds)
    seen = False
    for k, (levels, colour) in enumerate(motions):
        n = np.flatnonzero(levels >= LOWEST)
        seen |= bool(n.size)
        beside = n + 0.6 * (k + 0.5) / len(motions) - 0.3
        ax.vlines(beside, LOWEST, levels[n], color=colour, linewidth=1.0)
        marker = _CONTACT_MARKER if k >= masses and "contact" in ds.dims else "o"
        ax.plot(beside, levels[n], marker, color=colour, markersize=3.5)
    ax.set_ylim(LOWEST, None if seen else 0.0)
    if not seen:
        ax.text(0.5, 0.5, "at rest", transform=ax.transAxes, ha="center", va="center", fontsize=points(9.0))
        ax.set_xticks([])
    ax.set_xlabel("harmonic $n$")
    ax.set_ylabel("dB re first harmonic")
    ax.set_title("harmonics", fontsize=points(10.0, "axes.titlesize"))


def _handles(ds: xr.Dataset) -> list[Handle]:
    """Legend entries of the masses, the first ones if there are many, and of the contact."""
    named = zip(names_of_masses(ds)[:MOST_LABELS], _colours(ds), strict=False)
    handles: list[Handle] = [Line2D([], [], color=colour, label=name) for name, colour in named]
    traces = traces_of(ds)
    if traces[0].label:
        handles += [
            Line2D([], [], color=trace.colour, label=trace.label, marker=_CONTACT_MARKER, markersize=3.5)
            for trace in traces
        ]
    else:
        handles.append(Line2D([], [], color=CONTACT_COLOUR, label="contact"))
    if any(trace.stops[0].size for trace in traces):
        words = "slip ends" if all(trace.elastic for trace in traces) else "stop begins"
        handles.append(
            Line2D([], [], color="black", marker="o", markersize=4.5, linestyle="none", label=words)
        )
    return handles


@with_options
def plot_orbit(
    ds: xr.Dataset,
    ax: "Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw one steady state without time axis.

    The panels show velocity over displacement of every mass, friction over the motion in the contact and,
    where the dataset has them, harmonics in dB relative to the first.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `response`.
    ax : array of matplotlib axes, optional
        Two axes to draw into, three if there are harmonics.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is not a response or lacks a variable to draw, or the number of axes differs from that of
        the panels.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.response(fm.System(), 0.3, 0.5)
    >>> axes = fm.plot_orbit(ds)
    >>> [ax.get_xlabel() for ax in axes.flat]
    ['displacement $x$ / $(P/k_1)$', 'motion in the contact $z$ / $(P/k_1)$', 'harmonic $n$']
    """
    ds = to_draw(ds, "plot_orbit", "response")
    check_holds(ds, ("x", "v", "z", "friction"), "its orbit")
    check_can_be_seen(ds, ("x", "v", "z", "friction"))
    draw = [_draw_portrait, _draw_loops]
    if "displacement_harmonic" in ds:
        draw.append(_draw_spectrum)
    draw = current().chosen(draw)
    if ax is None:
        columns = current().columns(len(draw))
        axes = grid_of_panels(len(draw), columns, 3.6, title_of(ds))
    else:
        axes = given_axes(ax, len(draw), "one for each panel")
    for one, panel in zip(axes, draw, strict=True):
        panel(one, ds)
    if ax is None:
        legend_below(axes[0].figure, _handles(ds), caption(ds))
    else:
        legend_under(axes[-1], _handles(ds))
    return axes

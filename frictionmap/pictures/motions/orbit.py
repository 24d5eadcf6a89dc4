"""Pictures of one steady state without time axis: phase portrait, friction loop, harmonics."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..curves.harmonics import LOWEST, levels_of
from ..palette import LINES
from ..panels import Handle, given_axes, legend_below, table_of_panels
from ..second_axes import length_on_top, on_the_right
from ..shapes import check_holds, to_draw
from ..words import caption
from .history import MOST_LABELS, check_can_be_seen, contact_is_a_mass, title_of

if TYPE_CHECKING:
    from ..panels import AxesArray

_CONTACT_COLOUR = "black"


def _colours(ds: xr.Dataset) -> list[str]:
    return [LINES[k % len(LINES)] for k in range(ds.sizes["dof"])]


def _draw_portrait(ax: Axes, ds: xr.Dataset) -> None:
    """Draw velocity over displacement of every mass."""
    for x, v, colour in zip(ds["x"].values, ds["v"].values, _colours(ds), strict=True):
        ax.plot(x, v, color=colour, linewidth=1.2)
    ax.set_xlabel(r"displacement $x$ / $(P/k_1)$")
    ax.set_ylabel(r"velocity $x'$ / $(P/k_1)$")
    ax.set_title("phase portrait", fontsize=10)
    length_on_top(ax, ds, "displacement")


def _draw_loop(ax: Axes, ds: xr.Dataset) -> None:
    """Draw friction over the motion in the contact; the loop encloses the work of friction."""
    ax.plot(ds["z"].values, ds["friction"].values, color=_CONTACT_COLOUR, linewidth=1.2)
    ax.set_xlabel(r"motion in the contact $z$ / $(P/k_1)$")
    ax.set_ylabel("friction / $P$")
    ax.set_title("friction loop", fontsize=10)
    length_on_top(ax, ds, "motion in the contact")
    on_the_right(ax, ds, "force", "friction")


def _draw_spectrum(ax: Axes, ds: xr.Dataset) -> None:
    """Draw harmonics as stems, those of several motions side by side."""
    motions = [*zip(levels_of(ds["displacement_harmonic"].values), _colours(ds), strict=True)]
    if "contact_harmonic" in ds and not contact_is_a_mass(ds):
        motions.append((levels_of(ds["contact_harmonic"].values), _CONTACT_COLOUR))
    for k, (levels, colour) in enumerate(motions):
        n = np.flatnonzero(levels >= LOWEST)
        beside = n + 0.6 * (k + 0.5) / len(motions) - 0.3
        ax.vlines(beside, LOWEST, levels[n], color=colour, linewidth=1.0)
        ax.plot(beside, levels[n], "o", color=colour, markersize=3.5)
    ax.set_ylim(LOWEST, None)
    ax.set_xlabel("harmonic $n$")
    ax.set_ylabel("dB re first harmonic")
    ax.set_title("harmonics", fontsize=10)


def _handles(ds: xr.Dataset) -> list[Handle]:
    """Legend entries of the masses, the first ones if there are many, and of the contact."""
    named = zip(ds["dof"].values[:MOST_LABELS], _colours(ds), strict=False)
    handles: list[Handle] = [Line2D([], [], color=colour, label=f"mass {k}") for k, colour in named]
    return [*handles, Line2D([], [], color=_CONTACT_COLOUR, label="contact")]


def plot_orbit(ds: xr.Dataset, ax: "Sequence[Axes] | AxesArray | None" = None) -> "AxesArray":
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
    """
    ds = to_draw(ds, "plot_orbit", "response")
    check_holds(ds, ("x", "v", "z", "friction"), "its orbit")
    check_can_be_seen(ds, ("x", "v", "z", "friction"))
    draw = [_draw_portrait, _draw_loop]
    if "displacement_harmonic" in ds:
        draw.append(_draw_spectrum)
    if ax is None:
        axes = table_of_panels(1, len(draw), 3.6, title_of(ds)).ravel()
    else:
        axes = given_axes(ax, len(draw), "one for each panel")
    for one, panel in zip(axes, draw, strict=True):
        panel(one, ds)
    if ax is None:
        legend_below(axes[0].figure, _handles(ds), caption(ds))
    return axes

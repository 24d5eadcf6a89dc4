"""Pictures of many motions: peaks over the scale of records, and where the energy of the load goes."""

from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...errors import InputError
from ...motions.statistics import over_scale
from ..drawing import with_options
from ..options import FigureOptions
from ..palette import LINES, sequence
from ..panels import Handle, legend_under
from ..shapes import check_holds, to_draw
from .in_time import (
    caption_of,
    draw_band,
    drawn_peak,
    end_picture,
    friction_axis,
    in_handy_unit,
    of_one_system,
    one_motion,
    one_panel,
    peaks_in_words,
    refuse_several,
    time_words,
    unit_of,
    values_in_si,
)

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Periods that are drawn at most.
_MOST_LINES = len(LINES)


@with_options
def plot_incremental(
    ds: xr.Dataset,
    ax: "Axes | None" = None,
    friction: float | None = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw an incremental dynamic analysis: peaks over the factor of the records, at one friction.

    It is read from a friction spectrum along friction/scale.  There is a line for every period, the median
    over records, and a band between their quartiles.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `spectrum`, at one mu and one scale, with at least two values of friction above 0.
    ax : axes of matplotlib, optional
    friction : float, optional
        In the unit of `beta`; default: the middle of its values above 0.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is no spectrum, or has several scales, or too few values of friction.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    >>> ds = fm.spectrum(pulse, period=[1.0, 2.0], friction=[0.1, 0.2, 0.4])
    >>> axes = fm.plot_incremental(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['largest displacement']
    """
    ds = of_one_system(to_draw(ds, "plot_incremental", "spectrum"))
    name = drawn_peak(ds)
    refuse_several(ds, "scale", "mu")
    positive = ds["beta"].values[ds["beta"].values > 0.0]
    if positive.size < 2:
        raise InputError(f"ds must have at least 2 values of beta above 0; got {positive.size}")
    chosen = float(positive[positive.size // 2]) if friction is None else friction
    values, words = peaks_in_words(ds, name)
    ds = ds.assign({name: values})
    peaks = over_scale(ds, chosen, name).isel(mu=0).transpose("record", "period", "scale")
    axes = one_panel(ax)
    periods = ds["period"].values
    count = min(periods.size, _MOST_LINES)
    handles: list[Handle] = []
    drawn = np.linspace(0, periods.size - 1, count).round().astype(int)
    for p, colour in zip(drawn, sequence(count), strict=True):
        draw_band(axes[0], peaks["scale"].values, peaks.values[:, p], colour)
        label = f"period {periods[p]:.3g}{unit_of(ds['period'])}"
        handles.append(Line2D([], [], color=colour, label=label))
    axes[0].set_xlabel(f"factor of the records, friction {chosen:.3g}{unit_of(ds['beta'])}")
    axes[0].set_ylabel(words)
    axes[0].set_xlim(0.0, float(peaks["scale"].max()))
    axes[0].set_ylim(bottom=0.0)
    if ax is None:
        end_picture(ds, axes, handles, caption_of(ds.sizes["record"]))
    else:
        legend_under(axes[-1], handles)
    return axes


@with_options
def plot_energies(
    ds: xr.Dataset,
    ax: "Axes | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw where the energy of the load goes: contacts, damping, and what is stored.

    Of several motions over friction, as means over the records, at the end; of one over time.  The areas add
    up to the work of the load and of walls that move, and the energy at the beginning.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `history`, at one mu and one scale: with several values of beta, or of one motion with its
        samples.
    ax : axes of matplotlib, optional

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is no history, or has several mu or scales, or one value of beta and no samples.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    >>> ds = fm.history(fm.System(), pulse, beta=[0.1, 0.2, 0.4])
    >>> axes = fm.plot_energies(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['energy']
    """
    ds = of_one_system(to_draw(ds, "plot_energies", "history"))
    refuse_several(ds, "scale", "mu")
    if "lost_friction" in ds:
        return _over_time(ds, one_panel(ax), ax is None)
    check_holds(ds, ("work_friction", "work_damping", "energy"), "its works")
    if ds.sizes["beta"] == 1:
        raise InputError(
            "ds must have several values of beta, over which energies are drawn, or be one motion with its "
            'samples; got one without: follow it with samples="all"'
        )
    joule = ""
    layers = []
    for name in ("work_friction", "work_damping", "energy"):
        values, joule = values_in_si(ds, name, "J", "J")
        whole = values.reshape(*values.shape[:4], -1).sum(axis=-1)  # of all contacts
        layers.append(whole[:, 0, 0].mean(axis=0))
    axes = one_panel(ax)
    friction, words = friction_axis(ds)
    _stack(axes[0], friction, layers, joule)
    axes[0].set_xlabel(words)
    handles = _entries("stored at the end")
    if ax is None:
        end_picture(ds, axes, handles, "mean of the records" if ds.sizes["record"] > 1 else "")
    else:
        legend_under(axes[-1], handles)
    return axes


def _over_time(ds: xr.Dataset, axes: "AxesArray", is_new: bool) -> "AxesArray":
    """Draw the energies of one motion over time."""
    one, joule, layers = one_motion(ds), "", []
    for name in ("lost_friction", "lost_damping", "stored_energy"):
        values, joule = values_in_si(one, name, "J", "J")
        layers.append(values.reshape(-1, values.shape[-1]).sum(axis=0))  # of all contacts
    _stack(axes[0], one["time"].values, layers, joule)
    axes[0].set_xlabel(time_words(one))
    if is_new:
        end_picture(ds, axes, _entries("stored"), "")
    else:
        legend_under(axes[-1], _entries("stored"))
    return axes


def _stack(ax: Axes, at: np.ndarray, layers: list[np.ndarray], joule: str) -> None:
    """Draw layers above each other, and their sum; joules in the unit that is handy for them."""
    drawn = np.array(layers)
    if joule:
        whole, joule = in_handy_unit(np.vstack([drawn, drawn.sum(axis=0)]), "work")
        drawn = whole[:-1]
    ax.stackplot(at, drawn, colors=LINES[:3], alpha=0.55, linewidth=0.0)
    ax.plot(at, drawn.sum(axis=0), color="black", linewidth=1.2)
    ax.set_ylabel(f"energy{joule}")
    ax.margins(x=0.0)
    ax.set_ylim(bottom=0.0)


def _entries(stored: str) -> list[Handle]:
    """Legend of the energies."""
    words = ("lost in the contacts", "lost in the damping", stored)
    handles: list[Handle] = [Patch(color=LINES[k], alpha=0.55, label=one) for k, one in enumerate(words)]
    return [*handles, Line2D([], [], color="black", label="put in")]

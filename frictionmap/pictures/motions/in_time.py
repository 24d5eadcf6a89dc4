"""Pictures of motions in time under records, and of friction response spectra."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...datasets.labels import SCALES
from ...datasets.motion_labels import CELL, DRIVES, axes_of_motions, spans, stuck_times
from ...datasets.physical import ones_of
from ...errors import InputError
from ...units.table import UNITS, handy_unit
from ..drawing import with_options
from ..options import FigureOptions
from ..palette import CLASSES, LINES, OPEN_COLOUR, STUCK, Shade, in_turn, sequence
from ..panels import Handle, given_axes, legend_below, legend_under, new_figure, title_figure
from ..shapes import check_holds, check_range, to_draw
from ..words import names_of_masses
from .traces import contact_colours

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Size of the panels over time, and of the one over friction or period [inch].
_WIDE, _HIGH = 7.4, 2.0
_WIDTH, _HEIGHT = 5.6, 4.0

#: Times in which all contacts stick, and those in which one is open.
_SHADES: tuple[Shade, Shade] = (
    {"color": CLASSES[STUCK].colour, "alpha": 0.35, "linewidth": 0.0},
    {"color": OPEN_COLOUR, "alpha": 0.55, "linewidth": 0.0},
)

#: Lines of single records, behind their median.
_FAINT: dict[str, Any] = {"linewidth": 0.7, "alpha": 0.35}

#: Friction values that spectra have a colour for.
_MOST_LINES = len(LINES)


def values_in_si(ds: xr.Dataset, name: str, suffix: str, unit: str) -> tuple[np.ndarray, str]:
    """Values of a variable in SI units where they are there, and the unit in brackets."""
    in_si = f"{name}_{suffix}"
    return (ds[in_si].values, f" [{unit}]") if in_si in ds else (ds[name].values, "")


def one_panel(ax: "Axes | None") -> "AxesArray":
    """The given axes, or those of a new picture."""
    if ax is not None:
        return given_axes(ax, 1, "")
    return new_figure(_WIDTH, _HEIGHT).subplots(1, 1, squeeze=False).ravel()


def end_picture(ds: xr.Dataset, axes: "AxesArray", handles: list[Handle], caption: str) -> None:
    """Give a new picture the title of the dataset, and the legend."""
    title_figure(axes[0].figure, str(ds.attrs.get("title", "")))
    legend_below(axes[0].figure, handles, caption)


def drawn_peak(ds: xr.Dataset) -> str:
    """The peak of a spectrum that is drawn.

    Raises
    ------
    InputError
        There is none.
    """
    name = next((one for one in ("amplitude", "acceleration_amplitude") if one in ds), None)
    if name is None:
        raise InputError("ds must hold amplitude or acceleration_amplitude to be drawn; got neither")
    return name


def draw_band(ax: Axes, at: np.ndarray, values: np.ndarray, colour: str) -> None:
    """Draw the median over records, and a band between their quartiles; values : (records, places)."""
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75], axis=0)
    ax.plot(at, middle, color=colour, linewidth=1.7)
    if len(values) > 1:
        ax.fill_between(at, low, high, color=colour, alpha=0.15, linewidth=0.0)


def caption_of(records: int) -> str:
    """What lines and bands of several records are."""
    return "median of the records, with their quartiles" if records > 1 else ""


def unit_of(values: xr.DataArray) -> str:
    """The unit after a number; nothing of ratios."""
    unit = str(values.attrs.get("units", "1"))
    return "" if unit == "1" else f" {unit.replace(' s-2', '/s²')}"


def words_of(values: xr.DataArray) -> str:
    """Name of an axis of a variable, with its unit in brackets."""
    unit = unit_of(values).strip()
    return str(values.attrs.get("long_name", values.name)) + (f" [{unit}]" if unit else "")


def peaks_in_words(ds: xr.Dataset, name: str) -> tuple[xr.DataArray, str]:
    """Peaks of a spectrum, lengths in the unit that is handy for the largest one; the name of their axis."""
    peaks = ds[name]
    if peaks.attrs.get("units") != "m":
        return peaks, words_of(peaks)
    values, unit = in_handy_unit(peaks.values, "length")
    return peaks.copy(data=values), f"{peaks.attrs.get('long_name', name)}{unit}"


def _by_rows(values: np.ndarray) -> np.ndarray:
    return values.reshape(-1, values.shape[-1])


def _shaded_times(ds: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Beginnings and ends of the times in which all contacts stick, and of those in which one is open."""
    time = ds["time"].values
    stuck = stuck_times(time, _by_rows(ds["direction"].values))
    return stuck, spans(time, (_by_rows(ds["open"].values) == 1).any(axis=0)) if "open" in ds else stuck[:0]


def _shade(ax: Axes, ds: xr.Dataset) -> None:
    """Shade the times in which all contacts stick, and those in which one is open."""
    for times, look in zip(_shaded_times(ds), _SHADES, strict=True):
        for begin, end in times:
            ax.axvspan(begin, end, **look)


def _draw_rows(
    ax: Axes, time: np.ndarray, values: np.ndarray, colours: Sequence[str], names: Sequence[str]
) -> list[Handle]:
    """Draw a line for every mass or contact; return legend entries where there are several."""
    rows = _by_rows(values)
    for row, colour in zip(rows, colours, strict=True):
        ax.plot(time, row, color=colour, linewidth=1.1)
    if len(rows) == 1:
        return []
    return [Line2D([], [], color=colour, label=name) for colour, name in zip(colours, names, strict=True)]


def time_words(ds: xr.Dataset) -> str:
    """Name of the axis of time."""
    return "time [s]" if ds["time"].attrs.get("units") == "s" else r"time [1/$\omega_1$]"


def draw_record(ax: Axes, ds: xr.Dataset) -> None:
    """Draw the record of a motion over time, with its states shaded."""
    time = ds["time"].values
    values, label = _record_with_label(ds)
    ax.plot(time, values, color="black", linewidth=0.8)
    ax.set_ylabel(label)
    ax.margins(x=0.0)
    _shade(ax, ds)


def _record_with_label(ds: xr.Dataset) -> tuple[np.ndarray, str]:
    """The record, in units where they are known, and the name of its axis."""
    values, ones = ds["drive"].values, ones_of(ds)
    what = str(ds["drive"].attrs.get("long_name", ""))
    if what == DRIVES["force"]:
        values, unit = (
            in_handy_unit(values * ones["force"], "force") if "force" in ones else (values, " / $P$")
        )
        return values, f"load\n{unit.strip()}"
    if what != DRIVES["base"]:
        return values, "record"
    if "acceleration" in ones:
        return values * ones["acceleration"], "base acceleration\n[m/s²]"
    return values, "base acceleration\n" + r"/ $(\omega_1^2 P/k_1)$"


def _draw_traces(axes: "AxesArray", ds: xr.Dataset) -> list[Handle]:
    """Draw the record, the masses, and the forces in the contacts."""
    time = ds["time"].values
    draw_record(axes[0], ds)
    x, length = values_in_si(ds, "x", "m", "m")
    x, length = in_handy_unit(x, "length") if length else (x, " / $(P/k_1)$")
    names = names_of_masses(ds)
    handles = _draw_rows(axes[1], time, x, in_turn(LINES, len(names)), names)
    axes[1].set_ylabel(f"displacement\n{length.strip()}")
    force, newton = values_in_si(ds, "friction", "N", "N")
    force, newton = in_handy_unit(force, "force") if newton else (force, " / $P$")
    contacts = [f"contact {k}" for k in range(1, len(_by_rows(force)) + 1)]
    handles += _draw_rows(axes[2], time, force, contact_colours(len(contacts)), contacts)
    axes[2].set_ylabel(f"contact force\n{newton.strip()}")
    axes[2].set_xlabel(time_words(ds))
    for ax in axes[1:]:
        ax.margins(x=0.0)
        _shade(ax, ds)
    handles.append(Patch(**_SHADES[0], label="all contacts stick"))
    if _shaded_times(ds)[1].size:
        handles.append(Patch(**_SHADES[1], label="a contact is open"))
    return handles


def _is_single(ds: xr.Dataset) -> bool:
    return all(ds.sizes[dim] == 1 for dim in CELL)


def choice_of(ds: xr.Dataset, *dims: str) -> str:
    """How to choose one of several values along axes: an option of the command, and the same in Python."""
    several = {dim: ds[dim].values[0].item() for dim in dims if ds.sizes[dim] > 1}
    options = " ".join(f"--at {dim}={value!r}" for dim, value in several.items())
    chosen = ", ".join(f"{dim}=[{value!r}]" for dim, value in several.items())
    return f"choose one, such as {options} or ds.sel({chosen})"


def refuse_several(ds: xr.Dataset, *dims: str) -> None:
    """Refuse a dataset with several values along an axis that a picture does not show.

    Raises
    ------
    InputError
        There are several; the message shows how to choose one.
    """
    for dim in dims:
        if ds.sizes[dim] > 1:
            raise InputError(f"ds must have one value of {dim}; got {ds.sizes[dim]}: {choice_of(ds, *dims)}")


def of_one_system(ds: xr.Dataset) -> xr.Dataset:
    """Motions without further axes.

    Raises
    ------
    InputError
        An axis has several values; the message shows how to choose one.
    """
    further = axes_of_motions(ds)
    refuse_several(ds, *further)
    return ds.isel(dict.fromkeys(further, 0))


def one_motion(ds: xr.Dataset) -> xr.Dataset:
    """The only motion of a dataset; one of several that took longer is padded with NaN after its end."""
    one = ds.squeeze(list(CELL))
    return one.isel(time=np.isfinite(one["drive"].values))


def single_motion(ds: xr.Dataset) -> xr.Dataset:
    """The only motion of a history, without the dimensions of several.

    Raises
    ------
    InputError
        There are several, or its samples are missing.
    """
    ds = of_one_system(ds)
    if not _is_single(ds):
        raise InputError(f"cannot move several motions: one is drawn; {choice_of(ds, *CELL)}")
    if "time" not in ds.dims:
        raise InputError(
            'cannot move a motion without samples: the dataset has none; follow it with samples="all"'
        )
    check_holds(ds, ("x", "z", "friction", "direction", "drive"), "its motion")
    one = one_motion(ds)
    check_range(one, ("x", "z", "friction", "drive"))
    return one


@with_options
def plot_history(
    ds: xr.Dataset,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw a motion in time under its record; of several motions the largest displacement over friction.

    Times in which all contacts stick are shaded, and those in which one is open.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `history`; one motion needs its samples.
    ax : axes of matplotlib, optional
        Three for one motion: record, masses, forces in the contacts.  Else one.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is no history or lacks a variable to draw, or the number of axes is wrong.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    >>> ds = fm.history(fm.System(), pulse, beta=[0.2])
    >>> axes = fm.plot_history(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['load\\n/ $P$', 'displacement\\n/ $(P/k_1)$', 'contact force\\n/ $P$']
    """
    ds = of_one_system(to_draw(ds, "plot_history", "history"))
    single = _is_single(ds) and "time" in ds.dims
    if single:
        check_holds(ds, ("x", "friction", "direction", "drive"), "its motion")
    elif ds.sizes["beta"] == 1:
        raise InputError(
            "cannot draw several motions with one friction: their peaks have no axis; "
            f"{choice_of(ds, *CELL)}, or follow them with several values of beta"
        )
    count = 3 if single else 1
    if ax is None:
        size = (_WIDE, _HIGH * count) if single else (_WIDTH, _HEIGHT)
        axes = new_figure(*size).subplots(count, 1, sharex=True, squeeze=False).ravel()
    else:
        axes = given_axes(ax, count, "for a history")
    one = one_motion(ds) if single else ds
    handles = _draw_traces(axes, one) if single else _draw_peaks(axes[0], ds)
    if ax is None:
        motions = 1 if single else ds.sizes["record"] * ds.sizes["scale"]
        end_picture(ds, axes, handles, caption_of(motions))
    else:
        legend_under(axes[-1], handles)
    return axes


def friction_axis(ds: xr.Dataset) -> tuple[np.ndarray, str]:
    """Values of friction and the name of their axis: forces where their unit is known, else ratios."""
    force = ds.attrs.get(SCALES["force"])
    if force is None:
        return ds["beta"].values, r"friction ratio $\beta$"
    values, unit = in_handy_unit(ds["beta"].values * float(force), "force")
    return values, f"friction force{unit}"


def _draw_peaks(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the largest displacement of the last mass over friction: every record, and their median."""
    values, unit = values_in_si(ds, "amplitude", "m", "m")
    if unit:
        values, unit = in_handy_unit(values, "length")
    peaks = values[..., -1].reshape(-1, *values.shape[2:-1])  # records and scales, mu, beta
    beta, of_friction = friction_axis(ds)
    handles: list[Handle] = []
    for k, mu in enumerate(ds["mu"].values):
        colour = LINES[k % len(LINES)]
        if len(peaks) > 1:
            ax.plot(beta, peaks[:, k].T, color=colour, **_FAINT)
        draw_band(ax, beta, peaks[:, k], colour)
        handles.append(Line2D([], [], color=colour, label=rf"$\mu = {mu:g}$"))
    ax.set_xlabel(of_friction)
    of_mass = f" of {names_of_masses(ds)[-1]}" if ds.sizes["dof"] > 1 else ""
    ax.set_ylabel(f"largest displacement{of_mass}{unit}")
    ax.set_ylim(bottom=0.0)
    return handles


def in_handy_unit(values: np.ndarray, measure: str) -> tuple[np.ndarray, str]:
    """Values in SI units in the unit that is handy for the largest one, and this unit in brackets."""
    unit = handy_unit(float(np.nanmax(np.abs(values), initial=0.0)) or 1.0, measure)
    return values / float(UNITS[unit].size), f" [{unit}]"


@with_options
def plot_spectrum(
    ds: xr.Dataset,
    ax: "Axes | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw friction response spectra: largest displacement over the natural period.

    There is a line for every friction, the median over records, and a band between their quartiles.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `spectrum`, at one mu and one scale.
    ax : axes of matplotlib, optional

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is no spectrum, or has more than one mu or scale, or too many values of friction.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    >>> ds = fm.spectrum(pulse, period=[1.0, 2.0, 4.0], friction=[0.1, 0.2])
    >>> axes = fm.plot_spectrum(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['largest displacement']
    """
    ds = of_one_system(to_draw(ds, "plot_spectrum", "spectrum"))
    name = drawn_peak(ds)
    refuse_several(ds, "mu", "scale")
    beta = ds["beta"].values
    chosen = np.unique(np.linspace(0, beta.size - 1, min(beta.size, _MOST_LINES)).round().astype(int))
    axes = one_panel(ax)
    peaks, words = peaks_in_words(ds, name)
    values = peaks.isel(scale=0, mu=0).transpose("record", "period", "beta").values
    period = ds["period"].values
    handles: list[Handle] = []
    for b, colour in zip(chosen, sequence(len(chosen)), strict=True):
        draw_band(axes[0], period, values[:, :, b], colour)
        label = f"friction {beta[b]:.3g}{unit_of(ds['beta'])}"
        handles.append(Line2D([], [], color=colour, label=label))
    if period.size > 1 and period[0] > 0.0 and period[-1] / period[0] > 20.0 and np.isfinite(period[-1]):
        axes[0].set_xscale("log")
    axes[0].set_xlabel("natural period" + (" [s]" if ds["period"].attrs.get("units") == "s" else ""))
    axes[0].set_ylabel(words)
    axes[0].set_ylim(bottom=0.0)
    if ax is None:
        end_picture(ds, axes, handles, caption_of(len(values)))
    else:
        legend_under(axes[-1], handles)
    return axes

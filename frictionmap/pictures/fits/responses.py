"""Panels of first harmonics over frequency: amplitudes and lags, mass by mass, and their residuals."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from ...errors import InputError
from ..curves.axes import Panel
from ..curves.lines import draw_curve, regime_handles
from ..panels import Handle
from .data import BAND, FITTED, Samples, draw_data, samples_of
from .picture import Tall
from .samples import RESIDUALS

#: Codes of what a sample is.
_AMPLITUDE, LAG = 0, 1
_MARKERS = {_AMPLITUDE: "o", LAG: "^"}

#: Height of a panel [inch].
_HEIGHT = 2.5

#: Axes reach beyond the data by this factor in amplitude, and by this many degrees.
_ABOVE, _ROOM = 1.3, 10.0

#: Amplitudes that differ by more than this have a logarithmic axis.
_WIDE = 10.0


class ResponseSet(NamedTuple):
    """One friction force."""

    label: str
    colour: str
    beta: float  # at the mean load
    chosen: np.ndarray  # its samples, bool


class ResponseCurves(NamedTuple):
    """First harmonics over frequency."""

    frequency: np.ndarray  # Hz
    found: xr.Dataset  # over r, beta and dof
    several: bool = True  # whether motions may be of several regimes, which a legend names


def response_panels(ds: xr.Dataset, sets: list[ResponseSet], dense: ResponseCurves | None) -> list[Tall]:
    """A panel for amplitudes and one for lags of every mass that was measured, and one of residuals."""
    _check_amplitudes(ds)
    panels: list[Tall] = [(_HEIGHT, _values_panel(ds, sets, dense, which)) for which in _measured(ds)]
    return [*panels, (RESIDUALS, _residuals_panel(ds, sets))]


def _check_amplitudes(ds: xr.Dataset) -> None:
    """Refuse amplitudes that have no place on a logarithmic axis."""
    least = float(ds["data"].values[ds["quantity"].values == _AMPLITUDE].min(initial=np.inf))
    if least <= 0.0:
        raise InputError(f"amplitudes must be > 0 to be drawn; got {least:g}")


def _measured(ds: xr.Dataset) -> Iterator[tuple[int, int]]:
    """Quantity and mass of the panels, amplitudes first."""
    for quantity in (_AMPLITUDE, LAG):
        for mass in np.unique(ds["mass"].values[ds["quantity"].values == quantity]):
            yield quantity, int(mass)


def _values_panel(
    ds: xr.Dataset, sets: list[ResponseSet], dense: ResponseCurves | None, which: tuple[int, int]
) -> Panel:
    """Measured values of a quantity of a mass over the curves of all sets."""
    quantity, mass = which
    chosen = (ds["quantity"].values == quantity) & (ds["mass"].values == mass)
    measured = ds["data"].values[chosen]
    of_mass = f" of mass {mass}" if np.unique(ds["mass"].values).size > 1 else ""

    def values(ax: Axes) -> list[Handle]:
        handles: list[Handle] = []
        for one in sets:
            samples = _samples(ds, chosen & one.chosen)
            if dense is None:
                ax.plot(samples.x, samples.model, color=one.colour, linewidth=1.3)
            else:
                _draw_curve(ax, dense, one, which, measured)
            draw_data(ax, samples, _ends(samples, quantity), one.colour)
            handles.append(_set_handle(one))
        _name_axis(ax, quantity, of_mass, measured, _are_wide(ds))
        if dense is not None and dense.several:
            handles += regime_handles(dense.found["regime"].values)
        return handles

    return values


def _samples(ds: xr.Dataset, chosen: np.ndarray) -> Samples:
    """Some of the samples by their frequency."""
    part = ds.isel(sample=np.flatnonzero(chosen))
    return samples_of(part)


def _ends(samples: Samples, quantity: int) -> tuple[np.ndarray, np.ndarray]:
    """A standard error below and above; errors of amplitudes are relative."""
    if quantity == LAG:
        return samples.data - samples.sigma, samples.data + samples.sigma
    return samples.data * np.exp(-samples.sigma), samples.data * np.exp(samples.sigma)


def _draw_curve(
    ax: Axes, dense: ResponseCurves, one: ResponseSet, which: tuple[int, int], measured: np.ndarray
) -> None:
    """The fitted curve of a set in the styles of its regimes; lags also a turn off, where data are."""
    quantity, mass = which
    cells = dense.found.sel(beta=one.beta, method="nearest").sel(dof=mass)
    regime = cells["regime"].values
    if quantity == _AMPLITUDE:
        top = float(measured.max())
        draw_curve(ax, dense.frequency, cells["first_harmonic_amplitude"].values, regime, one.colour, top)
        return
    lag = np.degrees(cells["first_harmonic_phase"].values)
    turns = [0.0] + [360.0] * bool(measured.max() > 180.0) + [-360.0] * bool(measured.min() < -180.0)
    for turn in turns:
        draw_curve(ax, dense.frequency, lag + turn, regime, one.colour, None)


def _are_wide(ds: xr.Dataset) -> bool:
    """Whether amplitudes of some mass want a logarithmic axis: then all have one."""
    for quantity, mass in _measured(ds):
        values = ds["data"].values[(ds["quantity"].values == quantity) & (ds["mass"].values == mass)]
        if quantity == _AMPLITUDE and values.max() > _WIDE * values.min():
            return True
    return False


def _name_axis(ax: Axes, quantity: int, of_mass: str, measured: np.ndarray, wide: bool) -> None:
    low, high = float(measured.min()), float(measured.max())
    if quantity == _AMPLITUDE:
        if wide:
            ax.set_yscale("log")
            ax.yaxis.set_major_formatter(FuncFormatter(_plain))
            ax.yaxis.set_minor_formatter(FuncFormatter(_plain))
        ax.set_ylim(low / _ABOVE if wide else 0.0, _ABOVE * high)
        ax.set_ylabel(f"amplitude{of_mass}")
    else:
        ax.set_ylim(min(0.0, low - _ROOM), high + _ROOM)
        ax.set_ylabel(f"lag{of_mass} [deg]")


def _plain(value: float, _: int | None) -> str:
    """The name of a tick that is 1, 2 or 5 times a power of ten."""
    first = f"{value:e}"[0]
    return f"{value:g}" if first in "125" else ""


def _set_handle(one: ResponseSet) -> Handle:
    return Line2D(
        [], [], color=one.colour, linewidth=1.3, marker="o", markeredgecolor=FITTED, label=one.label
    )


def _residuals_panel(ds: xr.Dataset, sets: list[ResponseSet]) -> Panel:
    """Residuals of all samples over their standard errors: dots of amplitudes, triangles of lags."""
    sigma = ds["sigma"].values
    over = np.divide(ds["residual"].values, sigma, out=np.zeros(sigma.size), where=sigma > 0.0)

    def residuals(ax: Axes) -> list[Handle]:
        ax.axhspan(-1.0, 1.0, **BAND)
        ax.axhline(0.0, color=FITTED, linewidth=0.8)
        for one in sets:
            for quantity, marker in _MARKERS.items():
                chosen = one.chosen & (ds["quantity"].values == quantity)
                ax.plot(
                    ds["frequency"].values[chosen], over[chosen], marker, color=one.colour, markersize=4.5,
                    markeredgecolor=FITTED, markeredgewidth=0.6,
                )  # fmt: skip
        ax.set_xlabel("frequency [Hz]")
        ax.set_ylabel("residual / error")
        return [
            Line2D([], [], color="white", linestyle="", marker=marker, markeredgecolor=FITTED, label=label)
            for marker, label in (("o", "residuals of amplitudes"), ("^", "residuals of lags"))
        ]

    return residuals

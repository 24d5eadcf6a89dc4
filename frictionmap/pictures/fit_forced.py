"""Pictures of forced responses: amplitude and lag over frequency with the fitted curve of every set."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from .. import checks
from ..errors import InputError
from ..model.system import System
from ..steady.curves import curves
from .curve_axes import Panel
from .curve_lines import draw_curve, regime_handles
from .fit_data import BAND, FITTED, Samples, draw_data, samples_of
from .fit_picture import FitPicture, Tall
from .fit_position import MAP_HEIGHT, Positions, fitted, fitted_system, position_panel
from .fit_samples import RESIDUALS
from .palette import sequence
from .panels import Handle

_NEEDED = ("frequency", "quantity", "mass", "set", "sigma", "frequency_ratio", "friction_ratio")

#: Codes of what a sample is.
_AMPLITUDE, _LAG = 0, 1
_MARKERS = {_AMPLITUDE: "o", _LAG: "^"}

#: Sets of one picture; more cannot be told apart.
_MOST_SETS = 40

#: Height of a panel [inch]; points of a curve; room beside the data, as a share of their frequencies.
_HEIGHT, _POINTS, _MARGIN = 2.5, 300, 0.05

#: Axes reach beyond the data by this factor in amplitude, and by so many degrees.
_ABOVE, _ROOM = 1.3, 10.0

#: Amplitudes that differ by more than this have a logarithmic axis.
_WIDE = 10.0


class _Set(NamedTuple):
    """One friction force."""

    label: str
    colour: str
    beta: float  # at the mean load
    chosen: np.ndarray  # its samples, bool


class _Curves(NamedTuple):
    """First harmonics over frequency."""

    frequency: np.ndarray  # Hz
    found: xr.Dataset  # over r, beta and dof


def is_forced(ds: xr.Dataset) -> bool:
    """Whether all is there that forced responses need."""
    return set(_NEEDED) <= set(ds) and "f_n" in ds["parameter"].values


def forced_picture(ds: xr.Dataset) -> FitPicture:
    """Amplitudes and lags, mass by mass, residuals over their errors, and where motions lie on the map."""
    f_n = checks.number(fitted(ds, "f_n", 1.0), "f_n", above=0.0)
    _check_amplitudes(ds)
    sets, system, mu = _sets(ds), fitted_system(ds), fitted(ds, "mu", 1.0)
    dense = None if system is None else _dense(ds, sets, system, f_n, mu)
    panels: list[Tall] = [(_HEIGHT, _values_panel(ds, sets, dense, which)) for which in _measured(ds)]
    panels.append((RESIDUALS, _residuals_panel(ds, sets)))
    beside: list[Tall] = []
    if system is not None:
        beside.append((MAP_HEIGHT, position_panel(system, mu, list(_positions(ds, sets)))))
    return FitPicture(panels, beside, _remarks(mu, dense))


def _check_amplitudes(ds: xr.Dataset) -> None:
    """Refuse amplitudes that have no place on a logarithmic axis."""
    least = float(ds["data"].values[ds["quantity"].values == _AMPLITUDE].min(initial=np.inf))
    if least <= 0.0:
        raise InputError(f"amplitudes must be > 0 to be drawn; got {least:g}")


def _sets(ds: xr.Dataset) -> list[_Set]:
    """The sets in the order of their samples, with the mean of their friction ratios."""
    labels = ds["set"].values.astype(str)
    names = list(dict.fromkeys(labels.tolist()))
    if len(names) > _MOST_SETS:
        raise InputError(f"a dataset must have at most {_MOST_SETS} sets to be drawn; got {len(names)}")
    beta = ds["friction_ratio"].values
    result = []
    for label, colour in zip(names, sequence(len(names)), strict=True):
        chosen = labels == label
        result.append(_Set(label, colour, _of_set(ds, label, float(beta[chosen].mean())), chosen))
    return result


def _of_set(ds: xr.Dataset, label: str, mean: float) -> float:
    """beta of a set at the mean of its loads."""
    return fitted(ds, f"beta_{label}", fitted(ds, "beta", mean))


def _dense(ds: xr.Dataset, sets: list[_Set], system: System, f_n: float, mu: float) -> _Curves:
    f = ds["frequency"].values
    span = np.linspace((1.0 - _MARGIN) * f.min(), (1.0 + _MARGIN) * f.max(), _POINTS)
    beta = np.unique([max(one.beta, 0.0) for one in sets])
    found = curves(system, span / f_n, beta, max(mu, 1.0), quantities=["first_harmonic"])
    return _Curves(span, found.isel(mu=0))


def _measured(ds: xr.Dataset) -> Iterator[tuple[int, int]]:
    """Quantity and mass of the panels, amplitudes first."""
    for quantity in (_AMPLITUDE, _LAG):
        for mass in np.unique(ds["mass"].values[ds["quantity"].values == quantity]):
            yield quantity, int(mass)


def _values_panel(ds: xr.Dataset, sets: list[_Set], dense: _Curves | None, which: tuple[int, int]) -> Panel:
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
        return handles + ([] if dense is None else regime_handles(dense.found["regime"].values))

    return values


def _samples(ds: xr.Dataset, chosen: np.ndarray) -> Samples:
    """Some of the samples by their frequency."""
    part = ds.isel(sample=np.flatnonzero(chosen))
    return samples_of(part)


def _ends(samples: Samples, quantity: int) -> tuple[np.ndarray, np.ndarray]:
    """A standard error below and above; errors of amplitudes are relative."""
    if quantity == _LAG:
        return samples.data - samples.sigma, samples.data + samples.sigma
    return samples.data * np.exp(-samples.sigma), samples.data * np.exp(samples.sigma)


def _draw_curve(ax: Axes, dense: _Curves, one: _Set, which: tuple[int, int], measured: np.ndarray) -> None:
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


def _set_handle(one: _Set) -> Handle:
    label = f"set {one.label}: β = {one.beta:.3g}"
    return Line2D([], [], color=one.colour, linewidth=1.3, marker="o", markeredgecolor=FITTED, label=label)


def _residuals_panel(ds: xr.Dataset, sets: list[_Set]) -> Panel:
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


def _positions(ds: xr.Dataset, sets: list[_Set]) -> Iterator[Positions]:
    """Frequency and friction ratio of every row, once."""
    for one in sets:
        pairs = np.column_stack((ds["frequency_ratio"].values, ds["friction_ratio"].values))[one.chosen]
        r, beta = np.unique(pairs, axis=0).T
        yield Positions(r, beta, one.colour)


def _remarks(mu: float, dense: _Curves | None) -> list[str]:
    if dense is None:
        return ["fitted values are joined, as the file does not tell the structure"]
    return ["bars and band: one standard error"] + ["curves: as reached from rest"] * (mu > 1.0)

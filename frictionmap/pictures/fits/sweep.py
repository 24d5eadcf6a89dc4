"""Pictures of sweeps of two masses without friction: amplitude over frequency with its peaks and its zero."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ...errors import InputError
from ...identify.chain.two_masses import log_amplitude
from ..panels import Handle
from ..sizes import points
from .data import FITTED, Samples, check_logarithms, draw_data, draw_residuals, samples_of
from .picture import FitPicture
from .samples import RESIDUALS, VALUES

_FREQUENCIES = ("f0", "f1", "f2")

#: Points of the fitted curve over the axis.
_POINTS = 2001

#: Room beside the data, as a share of their span.
_MARGIN = 0.04

#: The curve is infinite, and zero, within the axis: its ends are beyond the data by this factor.
_BEYOND = 4.0


def is_sweep(ds: xr.Dataset) -> bool:
    """Whether these are amplitudes of the first of two masses without damping, and their frequencies."""
    names = ds["parameter"].values.tolist()
    if not set(_FREQUENCIES) <= set(names) or "zeta_1" in names or "frequency" not in ds:
        return False
    return "mass" not in ds or bool((ds["mass"] == 1).all())


def sweep_picture(ds: xr.Dataset) -> FitPicture:
    """Amplitudes over the fitted curve, and residuals of their logarithms below."""
    samples = samples_of(ds)
    frequencies = np.array([float(ds["estimate"].sel(parameter=name)) for name in _FREQUENCIES])
    _check(samples, frequencies)

    def values(ax: Axes) -> list[Handle]:
        return [*_draw_curve(ax, samples, frequencies), *_draw_amplitudes(ax, samples)]

    def residuals(ax: Axes) -> list[Handle]:
        return draw_residuals(ax, samples, "residual of ln")

    return FitPicture([(VALUES, values), (RESIDUALS, residuals)], [], [])


def _check(samples: Samples, frequencies: np.ndarray) -> None:
    """Refuse what no fit can be: frequencies of zero, amplitudes beyond all doubles."""
    if frequencies.min() <= 0.0:
        raise InputError(f"f0, f1 and f2 must be > 0 to be drawn; got {frequencies.min():g}")
    check_logarithms(samples.data, samples.sigma)


def _draw_amplitudes(ax: Axes, samples: Samples) -> list[Handle]:
    """Data are logarithms; the axis is logarithmic."""
    ends = np.exp(samples.data - samples.sigma), np.exp(samples.data + samples.sigma)
    return draw_data(ax, samples._replace(data=np.exp(samples.data)), ends)


def _draw_curve(ax: Axes, samples: Samples, frequencies: np.ndarray) -> list[Handle]:
    """The fitted amplitude; its peaks and its zero are named."""
    margin = _MARGIN * (float(np.ptp(samples.x)) or float(samples.x[0]) or 1.0)
    low, high = max(float(samples.x[0]) - margin, 0.0), float(samples.x[-1]) + margin
    f = np.linspace(low, high, _POINTS)
    f = f[~np.isin(f, frequencies)]  # there it is infinite, or zero
    bottom, top = (np.exp(end) for end in (samples.data.min(), samples.data.max()))
    ax.set_yscale("log")
    ax.set_xlim(low, high)
    ax.set_ylim(bottom / _BEYOND, top * _BEYOND)
    ax.set_ylabel("amplitude of mass 1 / base")
    for name, place in zip(_FREQUENCIES, frequencies.tolist(), strict=True):
        if low < place < high:
            _name_frequency(ax, name, place)
    return [*ax.plot(f, np.exp(log_amplitude(frequencies, f)), color=FITTED, linewidth=1.1, label="fitted")]


def _name_frequency(ax: Axes, name: str, place: float) -> None:
    ax.axvline(place, color="#606060", linewidth=0.9, linestyle=":", zorder=0.7)
    ax.annotate(
        f"${name[0]}_{name[1]}$", (place, 1.0), xycoords=("data", "axes fraction"), xytext=(3, -11),
        textcoords="offset points", fontsize=points(9.0),
    )  # fmt: skip

"""Pictures of measured samples over the fitted curve, with residuals."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ...errors import InputError
from ...files.estimates import unit_in_words
from ..palette import CLASSES, LINES, MEASURED, STUCK, Shade
from ..panels import Handle

#: With more samples, error bars would hide them: the band beside the residuals shows the error instead.
_MOST_BARS = 120

#: Lag-1 correlations within this many standard errors, each 1/sqrt(samples), are not significant.
_CHANCE = 2.0

#: Amplitudes whose logarithms are larger have no place on an axis of doubles.
_LARGEST_LOGARITHM = 600.0

#: Of dots, and of many dots.
_SIZE, _MANY_SIZE = 4.5, 2.8

#: Light dots beside dark lines, also in grey.
FITTED = LINES[2]

BAND: Shade = {"color": CLASSES[STUCK].colour, "alpha": 0.7, "linewidth": 0.0}

_OVER = {"time": "time [s]", "frequency": "frequency [Hz]"}


class Samples(NamedTuple):
    """Measured values in the order of what they are drawn over; shapes (samples,)."""

    x: np.ndarray
    data: np.ndarray
    model: np.ndarray
    residual: np.ndarray
    sigma: np.ndarray  # of one sample; 0 where the file does not say
    over: str  # what x is, in words
    unit: str  # of data; empty of pure numbers

    @property
    def few(self) -> bool:
        """Whether every sample has room for its error."""
        return self.x.size <= _MOST_BARS


def samples_of(ds: xr.Dataset) -> Samples:
    """The samples of a fit over time, frequency, or their number."""
    name = next((name for name in _OVER if name in ds), None)
    count = ds.sizes["sample"]
    x = np.arange(1.0, count + 1.0) if name is None else ds[name].values
    order = np.argsort(x, kind="stable")
    data, model, residual = (ds[key].values[order] for key in ("data", "model", "residual"))
    sigma = ds["sigma"].values[order] if "sigma" in ds else np.zeros(count)
    unit = unit_in_words(ds["data"].attrs.get("units", "1"))
    return Samples(x[order], data, model, residual, sigma, "sample" if name is None else _OVER[name], unit)


def in_brackets(unit: str) -> str:
    """A unit as the name of an axis has it."""
    return f" [{unit}]" if unit else ""


def draw_data(
    ax: Axes, samples: Samples, ends: tuple[np.ndarray, np.ndarray], colour: str = MEASURED
) -> list[Handle]:
    """Draw samples as dots, with error bars if there are few enough to distinguish them."""
    size = _SIZE if samples.few else _MANY_SIZE
    ax.plot(
        samples.x, samples.data, "o", color=colour, markersize=size, zorder=2.5,
        markeredgecolor=FITTED, markeredgewidth=0.6 if samples.few else 0.0,
    )  # fmt: skip
    bars = samples.few and bool(samples.sigma.any())
    if bars:
        ax.vlines(samples.x, *ends, color=FITTED, linewidth=0.9, zorder=2.4)
    label = "measured, with one standard error" if bars else "measured"
    return [*ax.plot([], [], "o", color=colour, markersize=_SIZE, markeredgecolor=FITTED, label=label)]


def draw_residuals(ax: Axes, samples: Samples, name: str) -> list[Handle]:
    """Residuals with the standard error of a sample, as bars or, of many samples, as a band."""
    ax.axhline(0.0, color=FITTED, linewidth=0.8)
    ax.set_xlabel(samples.over)
    ax.set_ylabel(name)
    if samples.few:
        ends = samples.residual - samples.sigma, samples.residual + samples.sigma
        return draw_data(ax, samples._replace(data=samples.residual), ends)
    ax.fill_between(samples.x, -samples.sigma, samples.sigma, **BAND)
    ax.plot(samples.x, samples.residual, "o", color=MEASURED, markersize=_MANY_SIZE, markeredgewidth=0.0)
    return [Patch(**BAND, label="standard error of a sample")] if samples.sigma.any() else []


def about_residuals(ds: xr.Dataset) -> str:
    """The lag-1 correlation of residuals, and whether chance makes as much."""
    if "residual_correlation" not in ds:
        return ""
    lag = float(ds["residual_correlation"])
    chance = _CHANCE / np.sqrt(ds.sizes["sample"])
    words = f"lag-1 correlation of residuals {round(lag, 2) + 0.0:.2f}"  # not -0.00
    if abs(lag) <= chance:
        return f"{words}, no more than chance makes ({chance:.2f})"
    inflation = float(ds["error_inflation"]) if "error_inflation" in ds else 1.0
    taken = f": errors are taken {inflation:.2f} times as large" if inflation > 1.0 else ""
    return f"{words}, more than chance makes ({chance:.2f}){taken}"


def check_logarithms(data: np.ndarray, sigma: np.ndarray) -> None:
    """Refuse logarithms of amplitudes that no axis could show."""
    largest = float((np.abs(data) + sigma).max())
    if largest > _LARGEST_LOGARITHM:
        raise InputError(
            f"data must be logarithms of at most {_LARGEST_LOGARITHM:g} to be drawn; got {largest:g}"
        )

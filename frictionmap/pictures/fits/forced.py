"""Pictures of forced responses: amplitude and lag over frequency with the fitted curve of every set."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError
from ...model.system import System
from ...steady.curves import curves
from ..palette import sequence
from .picture import FitPicture, Tall
from .position import MAP_HEIGHT, Positions, fitted, fitted_system, position_panel
from .responses import ResponseCurves, ResponseSet, response_panels

_NEEDED = ("frequency", "quantity", "mass", "set", "sigma", "frequency_ratio", "friction_ratio")

#: Largest number of sets in one picture; more cannot be distinguished.
_MOST_SETS = 40

#: Points of a curve; room beside the data, as a share of their frequencies.
_POINTS, _MARGIN = 300, 0.05


def is_forced(ds: xr.Dataset) -> bool:
    """Whether all is there that forced responses need."""
    return set(_NEEDED) <= set(ds) and "f_n" in ds["parameter"].values


def forced_picture(ds: xr.Dataset) -> FitPicture:
    """Amplitudes and lags, mass by mass, residuals over their errors, and where motions lie on the map."""
    f_n = checks.number(fitted(ds, "f_n", 1.0), "f_n", above=0.0)
    sets, system, mu = _sets(ds), fitted_system(ds), fitted(ds, "mu", 1.0)
    dense = None if system is None else _dense(ds, sets, system, f_n, mu)
    beside: list[Tall] = []
    if system is not None:
        beside.append((MAP_HEIGHT, position_panel(system, mu, list(_positions(ds, sets)))))
    return FitPicture(response_panels(ds, sets, dense), beside, _remarks(mu, dense))


def _sets(ds: xr.Dataset) -> list[ResponseSet]:
    """The sets in the order of their samples, with the mean of their friction ratios."""
    labels = ds["set"].values.astype(str)
    names = list(dict.fromkeys(labels.tolist()))
    if len(names) > _MOST_SETS:
        raise InputError(f"a dataset must have at most {_MOST_SETS} sets to be drawn; got {len(names)}")
    beta = ds["friction_ratio"].values
    result = []
    for label, colour in zip(names, sequence(len(names)), strict=True):
        chosen = labels == label
        own = _set_friction(ds, label, float(beta[chosen].mean()))
        result.append(ResponseSet(f"set {label}: β = {own:.3g}", colour, own, chosen))
    return result


def _set_friction(ds: xr.Dataset, label: str, mean: float) -> float:
    """beta of a set at the mean of its loads."""
    return fitted(ds, f"beta_{label}", fitted(ds, "beta", mean))


def _dense(ds: xr.Dataset, sets: list[ResponseSet], system: System, f_n: float, mu: float) -> ResponseCurves:
    f = ds["frequency"].values
    span = np.linspace((1.0 - _MARGIN) * f.min(), (1.0 + _MARGIN) * f.max(), _POINTS)
    beta = np.unique([max(one.beta, 0.0) for one in sets])
    found = curves(system, span / f_n, beta, max(mu, 1.0), quantities=["first_harmonic"])
    return ResponseCurves(span, found.isel(mu=0))


def _positions(ds: xr.Dataset, sets: list[ResponseSet]) -> Iterator[Positions]:
    """Frequency and friction ratio of every row, once."""
    for one in sets:
        pairs = np.column_stack((ds["frequency_ratio"].values, ds["friction_ratio"].values))[one.chosen]
        r, beta = np.unique(pairs, axis=0).T
        yield Positions(r, beta, one.colour)


def _remarks(mu: float, dense: ResponseCurves | None) -> list[str]:
    if dense is None:
        return ["fitted values are joined, as the file does not contain the structure"]
    return ["bars and band: one standard error"] + ["curves: as reached from rest"] * (mu > 1.0)

"""Pictures of sweeps of chains without friction: amplitudes and lags of the masses that were measured."""

import re

import numpy as np
import xarray as xr

from ... import regimes
from ...errors import InputError
from ...identify.chain.estimates import chain_names
from ...identify.chain.response import response_and_slopes
from ..palette import MEASURED
from .data import check_logarithms
from .picture import FitPicture
from .responses import LAG, ResponseCurves, ResponseSet, response_panels

_NEEDED = ("frequency", "quantity", "mass", "sigma")

#: Points of a curve; room beside the data, as a share of their span.
_POINTS, _MARGIN = 1001, 0.03


def is_chain(ds: xr.Dataset) -> bool:
    """Whether all is there that the curves of a chain need."""
    names = ds["parameter"].values.tolist()
    if "f_k1m1" not in names or not set(_NEEDED) <= set(ds):
        return False
    n = _masses(names)
    return set(chain_names(n)[: 2 * n - 1]) <= set(names) and int(ds["mass"].max()) <= n


def chain_picture(ds: xr.Dataset) -> FitPicture:
    """Amplitudes and lags, mass by mass, over the fitted curves; residuals over their errors below."""
    check_logarithms(ds["data"].values, ds["sigma"].values)
    every = ResponseSet("fitted, and measured", MEASURED, 0.0, np.ones(ds.sizes["sample"], dtype=bool))
    panels = response_panels(_as_measured(ds), [every], _dense(ds))
    return FitPicture(panels, [], ["bars and band: one standard error"])


def _masses(names: list[str]) -> int:
    """Number of masses of the parameters."""
    numbers = [int(found[1]) for name in names if (found := re.fullmatch(r"mass_ratio_(\d)", name))]
    return 2 if "gamma" in names else max(numbers, default=1)


def _as_measured(ds: xr.Dataset) -> xr.Dataset:
    """Amplitudes instead of their logarithms, degrees instead of radians."""
    is_lag = ds["quantity"] == LAG
    logarithms = {name: np.exp(ds[name].where(~is_lag, 0.0)) for name in ("data", "model")}
    changed = {name: xr.where(is_lag, np.degrees(ds[name]), values) for name, values in logarithms.items()}
    errors = {name: ds[name] * xr.where(is_lag, 180.0 / np.pi, 1.0) for name in ("sigma", "residual")}
    return ds.assign(changed | errors)


def _dense(ds: xr.Dataset) -> ResponseCurves:
    """The response of the fitted chain."""
    f = ds["frequency"].values
    margin = _MARGIN * float(np.ptp(f))
    span = np.linspace(max(f.min() - margin, 0.0), f.max() + margin, _POINTS)
    values = _unknowns(ds)
    response = response_and_slopes(values, span, _damped_by_base(ds, values))[0][:, np.newaxis]
    dims = ("r", "beta", "dof")
    found = xr.Dataset(
        {
            "first_harmonic_amplitude": (dims, np.abs(response)),
            "first_harmonic_phase": (dims, -np.angle(response)),
            "regime": (dims[:2], np.full(response.shape[:2], regimes.CONTINUOUS)),
        },
        {"beta": [0.0], "dof": np.arange(1, response.shape[2] + 1)},
    )
    return ResponseCurves(span, found, False)


def _unknowns(ds: xr.Dataset) -> np.ndarray:
    """Logarithms of the frequency and of the ratios, then damping ratios."""
    estimate = dict(zip(ds["parameter"].values.tolist(), ds["estimate"].values.tolist(), strict=True))
    n = _masses(list(estimate))
    names = chain_names(n)
    positive = np.array([estimate[name] for name in names[: 2 * n - 1]])
    if positive.min() <= 0.0:
        raise InputError(f"frequency and ratios must be > 0 to be drawn; got {positive.min():g}")
    return np.concatenate((np.log(positive), [estimate.get(name, 0.0) for name in names[2 * n - 1 :]]))


def _damped_by_base(ds: xr.Dataset, values: np.ndarray) -> bool:
    """Whether dampers see the base: which of the two the fitted samples are of."""

    def off(base_damping: bool) -> float:
        response = response_and_slopes(values, ds["frequency"].values, base_damping)[0]
        own = response[np.arange(response.shape[0]), ds["mass"].values - 1]
        with np.errstate(divide="ignore"):
            model = np.where(ds["quantity"].values == LAG, -np.angle(own), np.log(np.abs(own)))
        return float(np.nan_to_num(np.abs(np.exp(1j * (model - ds["model"].values)) - 1.0), posinf=2.0).sum())

    return off(True) < off(False)

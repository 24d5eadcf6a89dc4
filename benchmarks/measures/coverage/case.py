"""One case: data with known true values, the public fit, and the result of one trial."""

import re
import time
from collections.abc import Callable, Mapping
from inspect import signature
from typing import NamedTuple

import numpy as np
import xarray as xr

import frictionmap as fm

#: Steps of the difference quotients of the Cramer-Rao bound, relative to the parameter or absolute.
_STEP = 1e-6

#: Seeds of a case, unless it is slow or an example.
SEEDS = 400

#: Numbers in a message: trials with other numbers have the same reason.
_NUMBER = re.compile(r"-?\d[\d.]*(?:e[+-]?\d+)?")


class Made(NamedTuple):
    """Data of one seed: their true values, and the call that fits them."""

    truth: Mapping[str, float]
    fit: Callable[[], xr.Dataset]
    bound: Mapping[str, float] | None = None  # the Cramer-Rao bound of the noise alone, if it is known


class Case(NamedTuple):
    """One row of the table: the disturbance, and the function that generates the data."""

    name: str
    make: Callable[[np.random.Generator], Made]
    seeds: int = SEEDS


class Estimate(NamedTuple):
    """Comparison of an estimate with its true value."""

    inside: bool  # the 95 % interval holds the truth
    deviation: float  # estimate less truth, over its standard error; NaN where that is zero
    of_bound: float  # standard error over the Cramer-Rao bound; NaN where that is not known


class Trial(NamedTuple):
    """Result of one fit."""

    seed: int
    seconds: float  # processor time: whatever else the machine does, it counts the work of the fit
    refusal: str | None  # why there is no answer, numbers left out
    warnings: tuple[str, ...]  # numbers left out
    estimates: dict[str, Estimate]


def robust(fit: Callable[..., xr.Dataset]) -> dict[str, str]:
    """Option that reduces the weight of outliers, for a fit that has it."""
    return {"loss": "soft_l1"} if "loss" in signature(fit).parameters else {}


def attempt(made: Made, seed: int) -> Trial:
    """Fit and compare; an exception other than a refusal is a defect, recorded with its name."""
    began = time.process_time()
    try:
        ds = made.fit()
    except fm.InputError as error:
        return Trial(seed, time.process_time() - began, _reason(str(error)), (), {})
    except Exception as error:  # one defect must not end the benchmark
        reason = f"{type(error).__name__}: {_reason(str(error))}"
        return Trial(seed, time.process_time() - began, reason, (), {})
    seconds = time.process_time() - began
    warnings = tuple(dict.fromkeys(_reason(one) for one in ds.attrs["warnings"].split("; ") if one))
    return Trial(seed, seconds, None, warnings, _compared(ds, made))


def _compared(ds: xr.Dataset, made: Made) -> dict[str, Estimate]:
    found = {}
    for name, truth in made.truth.items():
        one = ds.sel(parameter=name)
        if int(one["known"]):
            continue
        value, error, lower, upper = (
            float(one[key]) for key in ("estimate", "standard_error", "lower", "upper")
        )
        deviation = (value - truth) / error if error > 0.0 else np.nan
        of_bound = error / made.bound[name] if made.bound and name in made.bound else np.nan
        found[name] = Estimate(bool(lower <= truth <= upper), deviation, of_bound)
    return found


def _reason(message: str) -> str:
    """Replace the numbers in a message by #."""
    return _NUMBER.sub("#", message)


def cramer_rao(
    model: Callable[[np.ndarray], np.ndarray], truth: Mapping[str, float], sigma: float | np.ndarray
) -> dict[str, float]:
    """Smallest standard errors that unbiased estimates of `truth` can have with normal noise `sigma`.

    model : noiseless data, shape (samples,), from the values of `truth` in their order

    sigma : standard deviation of every sample, or of each
    """
    values = np.array(list(truth.values()))
    slopes = np.empty((model(values).size, values.size))
    for k, step in enumerate(_STEP * np.maximum(np.abs(values), _STEP)):
        change = step * np.eye(values.size)[k]
        slopes[:, k] = (model(values + change) - model(values - change)) / (2.0 * step)
    weighted = slopes / np.reshape(sigma, (-1, 1))
    scale = np.linalg.norm(weighted, axis=0)
    least = np.sqrt(np.diag(np.linalg.inv((weighted / scale).T @ (weighted / scale)))) / scale
    return dict(zip(truth, least.tolist(), strict=True))

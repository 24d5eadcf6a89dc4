"""The likelihood of what was measured, for samplers: normal errors about the fitted model."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from .. import checks
from ..errors import InputError
from .chain.estimates import chain_names
from .chain.fit import Measured
from .chain.fit import problem as chain_problem
from .decay.motion import PARAMETERS
from .decay.problem import DRIFT, OFFSET, record_of
from .decay.problem import problem as decay_problem
from .statistics.least_squares import Problem


@dataclass(frozen=True)
class LogLikelihood:
    """ln p(data | theta) of normal errors, with the errors of the samples that the fit had.

    Called with theta, shape (parameters,): values of `names`, in this order and in the units of the dataset.
    It is -inf where a parameter is beyond its bound.
    """

    names: tuple[str, ...]
    _problem: Problem
    _start: np.ndarray  # all unknowns of the fit
    _logarithmic: np.ndarray  # which of them are logarithms
    _level: float  # ln p of no residuals

    def __call__(self, theta: np.ndarray) -> float:
        free = self._problem.free
        given = np.atleast_1d(checks.array(theta, "theta"))
        if given.shape != (len(self.names),) or given.dtype.kind not in "iuf":
            raise InputError(
                f"theta must be {len(self.names)} numbers: {', '.join(self.names)}; "
                f"got {checks.one_line(theta)}"
            )
        natural = given.astype(float)
        logarithmic = self._logarithmic[free]
        if not np.isfinite(natural).all() or (natural[logarithmic] <= 0.0).any():
            return -np.inf
        part = np.where(logarithmic, np.log(np.where(logarithmic, natural, 1.0)), natural)
        lowest = np.maximum(self._problem.lowest, self._problem.floor)[free]
        if (part < lowest).any() or (part > self._problem.highest[free]).any():
            return -np.inf
        values = self._start.copy()
        values[free] = part
        residual, _ = self._problem.residuals(values)
        return self._level - 0.5 * float(residual @ residual)


def log_likelihood(ds: xr.Dataset) -> LogLikelihood:
    """The likelihood of the data of a fit, as a function of the parameters that were fitted.

    Parameters
    ----------
    ds : xarray.Dataset
        Of `free_decay` or `sweep`, also read from a file.

    Returns
    -------
    LogLikelihood
        A function of theta; its attribute `names` says which parameters theta holds.  Errors of the samples
        are those of the variable `sigma`.  A decay has as many half cycles before rest as the fit found;
        the polynomial of a wandering zero and the states of filters
        at the first sample are integrated out.

    Raises
    ------
    InputError
        The dataset is of another kind, or lacks a variable.

    Examples
    --------
    It is largest at the estimates:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> n = np.floor(2 * t)  # half cycles
    >>> x = (9.5 - (2 * n + 1) * 0.5) * np.cos(2 * np.pi * t) + (-1) ** n * 0.5
    >>> x += np.random.default_rng(1).normal(0.0, 0.02, t.size)
    >>> fit = fm.identify.free_decay(t, x, known={"zeta": 0.0})
    >>> likelihood = fm.identify.log_likelihood(fit)
    >>> theta = [float(fit.estimate.sel(parameter=name)) for name in likelihood.names]
    >>> bool(likelihood(theta) > likelihood([1.001 * theta[0], *theta[1:]]))
    True
    """
    if not isinstance(ds, xr.Dataset):
        raise InputError(f"ds must be a dataset of estimates; got {checks.one_line(ds)}")
    for needed in ("estimate", "known", "data", "sigma"):
        if needed not in ds:
            raise InputError(
                f"cannot evaluate the likelihood: ds has no variable {needed}; give a dataset of identify"
            )
    if {"time", "half_cycles", "at_rest"} <= set(ds.variables):
        return _decay_likelihood(ds)
    if {"frequency", "mass", "quantity"} <= set(ds.variables) and "f_k1m1" in ds["parameter"]:
        return _chain_likelihood(ds)
    raise InputError(
        "cannot evaluate the likelihood: ds is neither of a free decay nor of a sweep; use one of these"
    )


def _function(
    names: tuple[str, ...], problem: Problem, start: np.ndarray, logarithmic: np.ndarray, sigma: np.ndarray
) -> LogLikelihood:
    if not (sigma > 0.0).all():
        raise InputError("cannot evaluate the likelihood: sigma is not > 0; give the errors of the data")
    level = -float(np.sum(np.log(sigma))) - 0.5 * sigma.size * np.log(2.0 * np.pi)
    fitted = tuple(name for name, free in zip(names, problem.free, strict=True) if free)
    return LogLikelihood(fitted, problem, start, logarithmic, level)


def _decay_likelihood(ds: xr.Dataset) -> LogLikelihood:
    last = OFFSET if OFFSET in ds["parameter"] else PARAMETERS[-1]
    names = (*PARAMETERS[:-1], last, DRIFT)[: ds.sizes["parameter"]]
    record, n, start = record_of(ds, names)
    values, sigma = start[: len(names)], ds["sigma"].values
    plain = decay_problem(record._replace(wander=None, transients=None), n, values)

    # coefficients of a wander and states of filters have a flat prior: what they can follow is no residual
    free = [basis for basis in (record.wander, record.transients) if basis is not None]
    slow = np.linalg.qr(np.concatenate(free, axis=1))[0] if free else np.zeros((sigma.size, 0))

    def residuals(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found, slopes = plain.residuals(at)
        found, slopes = found - slow @ (slow.T @ found), slopes - slow @ (slow.T @ slopes)
        return found / sigma, slopes / sigma[:, np.newaxis]

    return _function(
        names, plain._replace(residuals=residuals), values, np.zeros(values.size, dtype=bool), sigma
    )


def _chain_likelihood(ds: xr.Dataset) -> LogLikelihood:
    shown = ds["parameter"].values.tolist()
    n = sum(name in ("f_k1m1", "gamma") or name.startswith("mass_ratio") for name in shown)
    names = chain_names(n)
    estimate, known = (
        {name: float(ds[key].sel(parameter=name)) for name in shown} for key in ("estimate", "known")
    )
    natural = np.array(
        [estimate.get(name, 0.0) for name in names]
    )  # damping ratios that are not shown are zero
    logarithmic = np.arange(natural.size) < 2 * n - 1
    values = np.where(logarithmic, np.log(np.where(logarithmic, natural, 1.0)), natural)
    data = Measured(
        ds["frequency"].values, ds["mass"].values.astype(int) - 1, ds["quantity"].values == 1,
        ds["data"].values, ds["sigma"].values, n, ds.attrs.get("damping") == "base",
        ds.attrs.get("cost") == "relative",
    )  # fmt: skip
    held = np.array([known.get(name, 1.0) == 1.0 for name in names])
    problem = chain_problem(data, np.where(held, values, np.nan))
    return _function(names, problem, values, logarithmic, data.sigma)

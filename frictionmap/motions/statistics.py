"""Statistics over records: medians and quantiles with intervals, lognormal fits, exceedance over scale.

Records are a sample of the motions that may come, so that every estimate has an interval.  That of a quantile
is between two of the ordered values: the number of values below the quantile is binomial, whatever the
distribution is.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..errors import InputError

_CONFIDENCE = 0.95


class Ranks(NamedTuple):
    """Ordered values, counted from 0, that an interval of a quantile is between; -1 and n: no value."""

    low: int
    high: int


def quantile_ranks(count: int, share: float, confidence: float) -> Ranks:
    """The narrowest central interval of ranks that holds the quantile with this probability at least.

    Value k of n lies above the quantile q with P(at most k of n values below it), the binomial distribution
    of n and q.
    """
    from scipy.stats import binom  # loads slowly

    below = binom.cdf(np.arange(count + 1), count, share)  # P(at most k values below the quantile)
    tail = 0.5 * (1.0 - confidence)
    low = int(np.searchsorted(below, tail, side="right")) - 1  # P(value `low` is above it) <= tail
    high = int(np.searchsorted(below, 1.0 - tail, side="left"))  # P(value `high` is below it) <= tail
    return Ranks(low, high)


def _checked(values: xr.DataArray, name: str) -> xr.DataArray:
    if not isinstance(values, xr.DataArray) or "record" not in values.dims:
        raise InputError(name, f"must be a variable over record; got {checks.one_line(values)}")
    return values.transpose("record", ...)


def quantiles(
    values: xr.DataArray, shares: ArrayLike = (0.16, 0.5, 0.84), *, confidence: float = _CONFIDENCE
) -> xr.Dataset:
    """Quantiles over records, with intervals that hold for any distribution.

    Parameters
    ----------
    values : DataArray
        A variable over `record` and other dimensions.
    shares : array_like
        Shares of the records below the quantile, 0 < share < 1, increasing.
    confidence : float
        Probability of the intervals at least, 0 < confidence < 1.

    Returns
    -------
    xarray.Dataset
        `estimate`, `low` and `high` over `quantile` and the other dimensions.  An interval without an end,
        for want of records, is -inf or inf there.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.
    """
    given = _checked(values, "values")
    wanted = checks.axis(shares, "shares", least=0.0, most=1.0)
    if wanted[0] == 0.0 or wanted[-1] == 1.0:
        raise InputError("shares", f"must be above 0 and below 1; got {checks.one_line(wanted.tolist())}")
    checks.number(confidence, "confidence", above=0.0, most=np.nextafter(1.0, 0.0))
    ordered = np.sort(given.values, axis=0)
    count = len(ordered)
    ends = np.full((1, *ordered.shape[1:]), np.inf)
    missing = np.isnan(ordered).any(axis=0)
    padded = np.where(missing, np.nan, np.concatenate((-ends, ordered, ends)))
    ranks = [quantile_ranks(count, float(share), confidence) for share in wanted]
    found = {
        "estimate": np.where(missing, np.nan, np.quantile(ordered, wanted, axis=0)),
        "low": np.array([padded[rank.low + 1] for rank in ranks]),
        "high": np.array([padded[rank.high + 1] for rank in ranks]),
    }
    coords = {name: one for name, one in given.coords.items() if "record" not in one.dims}
    quantity = given.attrs.get("long_name", "value")
    meanings = {
        "estimate": "quantile",
        "low": "lower end of the interval",
        "high": "upper end of the interval",
    }
    variables = {
        name: (
            ("quantile", *given.dims[1:]), one,
            {"long_name": f"{quantity}: {meanings[name]}", "units": given.attrs.get("units", "1")},
        )
        for name, one in found.items()
    }  # fmt: skip
    axis = ("quantile", wanted, {"long_name": "share of the records below", "units": "1"})
    return xr.Dataset(variables, {"quantile": axis} | coords, {"confidence": confidence, "records": count})


def median(values: xr.DataArray, *, confidence: float = _CONFIDENCE) -> xr.Dataset:
    """Median over records, with an interval that holds for any distribution; see `quantiles`."""
    return quantiles(values, [0.5], confidence=confidence).isel(quantile=0)


def lognormal(values: xr.DataArray) -> xr.Dataset:
    """Fit lognormal distributions over records: `median` and `dispersion`, with their standard errors.

    The dispersion is the standard deviation of the logarithms.  All are NaN where a value is not above zero.

    Parameters
    ----------
    values : DataArray
        A variable over at least two `record`s.
    """
    given = _checked(values, "values")
    count = given.sizes["record"]
    if count < 2:
        raise InputError("values", f"must have at least 2 records; got {count}")
    logs: xr.DataArray = xr.apply_ufunc(np.log, given.where(given > 0.0))
    mean = logs.mean("record", skipna=False)
    spread = np.sqrt(((logs - mean) ** 2).sum("record", skipna=False) / (count - 1.0))
    middle = np.exp(mean)
    quantity, units = given.attrs.get("long_name", "value"), given.attrs.get("units", "1")
    found = xr.Dataset(
        {
            "median": middle,
            "dispersion": spread,
            "median_error": middle * spread / np.sqrt(count),
            "dispersion_error": spread / np.sqrt(2.0 * (count - 1.0)),
        }
    )
    found["median"].attrs = {"long_name": f"{quantity}: median", "units": units}
    found["median_error"].attrs = {"long_name": f"{quantity}: standard error of the median", "units": units}
    found["dispersion"].attrs = {"long_name": "standard deviation of the logarithm", "units": "1"}
    found["dispersion_error"].attrs = {"long_name": "standard error of the dispersion", "units": "1"}
    return found


#: Powers of the scale that variables grow with where friction grows with it, too.
_POWERS = {
    "amplitude": 1, "acceleration_amplitude": 1, "residual": 1, "sliding_distance": 1, "stops": 0, "turns": 0,
}  # fmt: skip


def over_scale(ds: xr.Dataset, friction: float, name: str) -> xr.DataArray:
    """Read a variable over the scale of the records at one friction from a friction spectrum.

    A record times s moves an oscillator with friction times s by s times as much.  A spectrum over beta at
    one scale s0 therefore holds the variable at the scales s0 friction/beta: no new runs are needed.

    Parameters
    ----------
    ds : Dataset
        Of `spectrum`, with one value of `scale`.
    friction : float
        Kinetic friction force over the mass, > 0, in the unit of `beta`.
    name : str
        Variable.

    Returns
    -------
    DataArray
        Over `scale`, increasing, in place of `beta`.
    """
    checks.choice(name, "name", tuple(_POWERS))
    checks.number(friction, "friction", above=0.0)
    if ds.sizes.get("scale") != 1:
        raise InputError("ds", f"must have one value of scale; got {ds.sizes.get('scale', 'none')}")
    one = ds[name].isel(scale=0, drop=True)
    beta = one.beta.values
    one = one.isel(beta=np.flatnonzero(beta > 0.0)[::-1])
    factor = friction / one.beta.values
    found = one * xr.DataArray(factor ** _POWERS[name], dims="beta")
    found = found.assign_coords(beta=factor * float(ds.scale[0])).rename(beta="scale")
    found.attrs = dict(ds[name].attrs)
    found["scale"].attrs = dict(ds["scale"].attrs)
    return found


def exceedance(values: xr.DataArray, limit: float) -> xr.Dataset:
    """Share of the records under which a limit is exceeded, with intervals of 95 % (Clopper and Pearson).

    Parameters
    ----------
    values : DataArray
        A variable over `record` and other dimensions, as of `over_scale`.
    limit : float
        In the unit of the variable.
    """
    from scipy.stats import beta  # loads slowly

    given = _checked(values, "values")
    checks.number(limit, "limit")
    count = given.sizes["record"]
    above = (given > limit).sum("record").where(given.notnull().all("record"))
    tail = 0.5 * (1.0 - _CONFIDENCE)
    with np.errstate(invalid="ignore"):
        low = np.where(above == 0, 0.0, beta.ppf(tail, above, count - above + 1))
        high = np.where(above == count, 1.0, beta.ppf(1.0 - tail, above + 1, count - above))
    found = xr.Dataset({"share": above / count, "low": (above.dims, low), "high": (above.dims, high)})
    for name, meaning in (("share", "share"), ("low", "lower end of the share"), ("high", "upper end of it")):
        found[name].attrs = {"long_name": f"{meaning} of records above the limit", "units": "1"}
    found.attrs = {"limit": limit, "records": count}
    return found


def stationary(
    values: xr.DataArray, *, start: float = 0.0, window: float | None = None, batches: int = 20
) -> xr.Dataset:
    """Mean, variance and peak of a stationary motion over time, with standard errors by batch means.

    The time from `start` on is divided into equal batches, whose means give the error of the whole mean if
    they are much longer than the motion remembers; `batch_correlation` of neighbouring means then is below
    2/sqrt(batches) or so, else the errors are too small.  Between two times the motion is taken as straight.

    Parameters
    ----------
    values : DataArray
        A variable over `time`, such as `v` of `history`, and other dimensions; times do not decrease.
    start : float
        Time that is left out, in which the motion becomes stationary.
    window : float, optional
        Length of time of the peak: the mean largest absolute value in windows that long; default: a batch.
    batches : int
        >= 4.

    Returns
    -------
    xarray.Dataset
        `mean`, `variance`, `peak` and their standard errors, `mean_error`, `variance_error` and `peak_error`,
        and `batch_correlation`, over the other dimensions.

    Raises
    ------
    InputError
        There is no time, a value is missing, or the time is too short for two windows.

    Examples
    --------
    A sine has the variance 1/2 and the peak 1:

    >>> import numpy as np
    >>> import xarray as xr
    >>> import frictionmap as fm
    >>> time = np.linspace(0.0, 200 * np.pi, 20001)
    >>> found = fm.stationary(xr.DataArray(np.sin(time), {"time": time}))
    >>> round(found.variance.item(), 3), round(found.peak.item(), 3)
    (0.5, 1.0)
    """
    if not isinstance(values, xr.DataArray) or "time" not in values.dims or "time" not in values.coords:
        raise InputError("values", f"must be a variable over time; got {checks.one_line(values)}")
    batches = checks.whole(batches, "batches", least=4)
    given = values.transpose("time", ...)
    time = given["time"].values
    start = checks.number(start, "start", least=float(time[0]), most=float(time[-1]))
    span = (float(time[-1]) - start) / batches
    window = span if window is None else checks.number(window, "window", above=0.0)
    count = int(
        (float(time[-1]) - start) / window * (1.0 + 1e-12)
    )  # a whole number of them, except for rounding
    if count < 2 or span == 0.0:
        raise InputError("window", f"must fit twice into the time after start; got {window:g}")
    if not np.isfinite(given.values).all():
        raise InputError("values", "must be finite at all times; got NaN: select one motion")
    edges = start + span * np.arange(batches + 1)
    means = _batch_means(time, given.values, edges, square=False)
    mean, error = means.mean(axis=0), _error(means)
    squares = _batch_means(time, given.values - mean, edges, square=True)
    peaks = _peaks(time - start, np.abs(given.values), window, count)
    found = {
        "mean": (mean, "mean"), "mean_error": (error, "standard error of the mean"),
        "variance": (squares.mean(axis=0) + error**2, "variance"),  # the mean takes its own error off
        "variance_error": (_error(squares), "standard error of the variance"),
        "peak": (peaks.mean(axis=0), f"mean of the largest modulus in a time of {window:g}"),
        "peak_error": (_error(peaks), "standard error of the mean largest modulus"),
        "batch_correlation": (_neighbours(means), "correlation of the means of neighbouring batches"),
    }  # fmt: skip
    attrs = {"start": start, "window": window, "batches": batches}
    return xr.Dataset(
        {name: (given.dims[1:], one, {"long_name": words}) for name, (one, words) in found.items()},
        {name: one for name, one in given.coords.items() if "time" not in one.dims}, attrs,
    )  # fmt: skip


def _batch_means(time: np.ndarray, values: np.ndarray, edges: np.ndarray, square: bool) -> np.ndarray:
    """Means of straight lines, or of their squares, between the edges, (batches, ...)."""
    flat = values.reshape(time.size, -1)
    at = np.array([np.interp(edges, time, one) for one in flat.T]).T
    order = np.argsort(np.concatenate((time, edges)), kind="stable")
    t, x = np.concatenate((time, edges))[order], np.concatenate((flat, at))[order]
    a, b = x[:-1], x[1:]
    part = (a * a + a * b + b * b) / 3.0 if square else 0.5 * (a + b)
    total = np.cumsum(
        np.concatenate((np.zeros((1, flat.shape[1])), np.diff(t)[:, np.newaxis] * part)), axis=0
    )
    places = np.flatnonzero(order >= time.size)
    means = np.diff(total[places], axis=0) / np.diff(edges)[:, np.newaxis]
    return means.reshape(edges.size - 1, *values.shape[1:])


def _peaks(time: np.ndarray, values: np.ndarray, window: float, count: int) -> np.ndarray:
    """Largest values in windows from time 0 on, (windows, ...); both ends of a window belong to it."""
    begins = np.searchsorted(time, window * np.arange(count))
    ends = np.searchsorted(time, window * np.arange(1, count + 1), side="right")
    if (begins == ends).any():
        raise InputError("window", f"must hold a time at least; got {window:g}")
    return np.array([values[i:j].max(axis=0) for i, j in zip(begins, ends, strict=True)])


def _error(parts: np.ndarray) -> np.ndarray:
    """Standard error of the mean of independent parts."""
    return np.asarray(parts.std(axis=0, ddof=1) / np.sqrt(len(parts)))


def _neighbours(parts: np.ndarray) -> np.ndarray:
    """Correlation of neighbouring parts; 0 of parts that are all equal."""
    away = parts - parts.mean(axis=0)
    power = (away**2).sum(axis=0)
    both = (away[1:] * away[:-1]).sum(axis=0)
    return np.asarray(np.divide(both, power, out=np.zeros_like(both), where=power > 0.0))

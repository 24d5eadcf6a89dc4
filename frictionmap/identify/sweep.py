"""Frequencies and ratios of two masses from the amplitude of the first one, base shaken, without friction.

    X_1 = (f1 f2/f0)^2 (f0^2 - f^2)/((f1^2 - f^2)(f2^2 - f^2)),   f1 < f0 < f2
    sqrt(k1/m1)/2 pi = f1 f2/f0,   gamma = m2/m1 = (f0^2 - f1^2)(f2^2 - f0^2)/f0^4,
    kappa = k2/k1 = (f0^2 - f1^2)(f2^2 - f0^2)/(f1 f2)^2

f1 and f2 are the natural frequencies, f0 is that of the second mass on its spring alone, where the first one
stands still.  gamma and kappa are those of T(6.17) to T(6.19), in closed form.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.special import gammaincc

from .. import checks
from ..errors import InputError
from .estimates import estimates, verdict
from .least_squares import Errors, Problem, Solution, errors, minimise

_MEANINGS = {
    "f0": "natural frequency of the second mass on its spring alone",
    "f1": "first natural frequency",
    "f2": "second natural frequency",
    "f_k1m1": "natural frequency of the first mass on its spring alone",
    "gamma": "mass ratio m2/m1",
    "kappa": "stiffness ratio k2/k1",
}
_UNITS = ("Hz", "Hz", "Hz", "Hz", "1", "1")

#: f0, f1 and f2; the rest follows.
_FITTED = 3

#: Scatter that chance makes more rarely is beyond the errors that are given.
_CHANCE = 1e-3

_VERDICTS = {
    "two_frequencies_found": "two natural frequencies found, and the one between them",
    "scatter_beyond_errors": "two natural frequencies found, but residuals are larger than the errors given",
}


class Ratios(NamedTuple):
    """What three frequencies say of two masses."""

    f_k1m1: float  # Hz
    gamma: float
    kappa: float


def ratios(f0: float, f1: float, f2: float) -> Ratios:
    """Of two masses with natural frequencies f1 < f2, the first one at rest at f0 between them."""
    split = (f0**2 - f1**2) * (f2**2 - f0**2)
    return Ratios(f1 * f2 / f0, split / f0**4, split / (f1 * f2) ** 2)


def _ratio_slopes(f0: float, f1: float, f2: float) -> np.ndarray:
    """Derivatives of `ratios`, shape (3, 3), by f0, f1 and f2."""
    f_k1m1, gamma, kappa = ratios(f0, f1, f2)
    below, above = f0**2 - f1**2, f2**2 - f0**2
    split = np.array([2.0 * f0 / below - 2.0 * f0 / above, -2.0 * f1 / below, 2.0 * f2 / above])  # of its log
    product = np.array([0.0, 1.0 / f1, 1.0 / f2])
    last = np.array([1.0 / f0, 0.0, 0.0])
    return np.array(
        [f_k1m1 * (product - last), gamma * (split - 4.0 * last), kappa * (split - 2.0 * product)]
    )


def log_amplitude(frequencies: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ln |X_1| at `f` and its derivatives by f0, f1 and f2."""
    f0, f1, f2 = frequencies
    zero, first, second = f0**2 - f**2, f1**2 - f**2, f2**2 - f**2
    value = 2.0 * np.log(f1 * f2 / f0) + np.log(np.abs(zero)) - np.log(np.abs(first * second))
    slopes = [
        2.0 * f0 / zero - 2.0 / f0,
        2.0 / f1 - 2.0 * f1 / first,
        2.0 / f2 - 2.0 * f2 / second,
    ]
    return value, np.stack(slopes, axis=1)


def sweep(
    frequency: Sequence[float] | np.ndarray,
    amplitude_ratio: Sequence[float] | np.ndarray,
    *,
    sigma_amplitude: float | None = None,
) -> xr.Dataset:
    """Fit two masses without friction to amplitudes of the first one over that of the base.

    Parameters
    ----------
    frequency : array, shape (samples,)
        Of the base [Hz], > 0, increasing.
    amplitude_ratio : array, shape (samples,)
        |X_1|/Y > 0; with a peak on either side of a least value.
    sigma_amplitude : float
        Relative error of the amplitudes, > 0; by default it is taken from the residuals.

    Returns
    -------
    xarray.Dataset
        As of `free_decay`, on parameter (f0, f1, f2, f_k1m1, gamma, kappa), the last three from the first
        three in closed form; data, model and residual are natural logarithms of the amplitude.

    Raises
    ------
    InputError
        An argument is illegal, data are fewer than four, or there are not two peaks.
    """
    f = checks.axis(frequency, "frequency", least=0.0)
    amplitude = _checked_amplitudes(amplitude_ratio, f)
    sigma = 1.0
    if sigma_amplitude is not None:
        sigma = checks.number(sigma_amplitude, "sigma_amplitude", above=0.0)
    data = np.log(amplitude)
    best, problem = _nearest(f, data, sigma)
    found = errors(problem, best, 1.0 if sigma_amplitude is not None else None)
    solution = best._replace(residual=sigma * best.residual)
    ds = estimates(
        _MEANINGS, _UNITS, *_all_six(solution, found), np.ones(6, dtype=bool), data, "1", sigma_amplitude
    )
    ds["frequency"] = xr.Variable("sample", f, {"long_name": "frequency of the base", "units": "Hz"})
    beyond = sigma_amplitude is not None and gammaincc(0.5 * (f.size - _FITTED), 0.5 * best.sum) < _CHANCE
    ds["verdict"] = verdict(int(beyond), _VERDICTS)
    ds.attrs["title"] = "Sweep of two masses"
    ds.attrs["warnings"] = ""
    return ds


def _checked_amplitudes(values: object, f: np.ndarray) -> np.ndarray:
    amplitude = np.atleast_1d(checks.array(values, "amplitude_ratio"))
    if amplitude.dtype.kind not in "iuf" or amplitude.shape != f.shape:
        raise InputError(
            f"amplitude_ratio must be {f.size} numbers, one a frequency; got {checks.one_line(values)}"
        )
    wrong = np.flatnonzero(~(np.isfinite(amplitude) & (amplitude > 0.0)))
    if wrong.size:
        raise InputError(
            f"amplitude_ratio must be finite and > 0; got {amplitude[wrong[0]]} at index {wrong[0]}"
        )
    if f.size <= _FITTED:
        raise InputError(f"frequency must have more values than there are unknowns, {_FITTED}; got {f.size}")
    return amplitude.astype(float)


def _nearest(f: np.ndarray, data: np.ndarray, sigma: float) -> tuple[Solution, Problem]:
    """The least sum, and of what.

    A logarithm is infinite where a peak, or the zero between them, passes a sample: each of the three lies
    between two samples.  All intervals beside the highest and the lowest samples are tried.
    """
    tries = [_within(f, data, sigma, intervals) for intervals in product(*_intervals(f, data))]
    return min(tries, key=lambda found: found[0].sum)


def _within(
    f: np.ndarray, data: np.ndarray, sigma: float, intervals: tuple[int, ...]
) -> tuple[Solution, Problem]:
    """The least sum with f0, f1 and f2 each between the sample of that index and the next."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        model, slopes = log_amplitude(values, f)
        return (model - data) / sigma, slopes / sigma

    begin = np.array(intervals)
    every, no_floor = np.ones(_FITTED, dtype=bool), np.full(_FITTED, -np.inf)
    problem = Problem(residuals, every, no_floor, f[begin], f[begin + 1])
    return minimise(problem, 0.5 * (f[begin] + f[begin + 1])), problem


def _intervals(f: np.ndarray, data: np.ndarray) -> tuple[tuple[int, int], ...]:
    """Intervals in which f0, f1 and f2 may lie: beside the least value, and beside the peaks around it."""
    inner = np.arange(1, f.size - 1)
    peaks = inner[(data[inner] > data[inner - 1]) & (data[inner] > data[inner + 1])]
    dips = inner[(data[inner] < data[inner - 1]) & (data[inner] < data[inner + 1])]
    if peaks.size < 2 or not dips.size:
        raise InputError(
            f"amplitude_ratio must have two peaks; it has {'one peak' if peaks.size else 'no peak'}: "
            "two frequencies wanted"
        )
    zero = int(dips[np.argmin(data[dips])])
    left, right = peaks[peaks < zero], peaks[peaks > zero]
    if not left.size or not right.size:
        raise InputError(
            "amplitude_ratio must have a peak on either side of its least value; it has one peak only"
        )
    chosen = (zero, left[np.argmax(data[left])], right[np.argmax(data[right])])
    return tuple((int(index) - 1, int(index)) for index in chosen)


def _all_six(solution: Solution, found: Errors) -> tuple[Solution, Errors]:
    """The three frequencies, and what follows from them with its errors to first order."""
    f0, f1, f2 = (float(value) for value in solution.values)
    slopes = np.vstack((np.eye(_FITTED), _ratio_slopes(f0, f1, f2)))
    covariance = found.correlation * np.outer(found.standard_error, found.standard_error)
    all_six = slopes @ covariance @ slopes.T
    deviation = np.sqrt(np.diag(all_six))
    values = np.concatenate((solution.values, ratios(f0, f1, f2)))
    reach = deviation * float(found.upper[0] - solution.values[0]) / float(found.standard_error[0])
    wider = found._replace(
        standard_error=deviation,
        lower=values - reach,
        upper=values + reach,
        correlation=all_six / np.outer(deviation, deviation),
    )
    return solution._replace(values=values, at_bound=np.zeros(values.size, dtype=bool)), wider

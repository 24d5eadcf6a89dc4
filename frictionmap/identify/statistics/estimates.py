"""Estimates with their errors as a labelled dataset."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import xarray as xr

from ... import checks
from ...datasets.labels import REFERENCES
from ...datasets.provenance import now
from ...units.table import conversion
from ...version import __version__
from .least_squares import Errors, Solution

#: What a sample of a first harmonic is; files hold the place in this list.
QUANTITIES = ("amplitude_ratio", "phase_lag")


def number(value: float, long_name: str, units: str = "1") -> xr.Variable:
    """A labelled number."""
    return xr.Variable((), float(value), {"long_name": long_name, "units": units})


def _squared(unit: str) -> str:
    """The square of a unit."""
    if unit == "1":
        return unit
    return f"({unit})^2" if "/" in unit else f"{unit}2"


def with_error(
    name: str, value: float, error: float, words: str, units: str, words_of_error: str = ""
) -> dict[str, xr.Variable]:
    """A labelled number and its standard error."""
    return {
        name: number(value, words, units),
        f"{name}_standard_error": number(error, words_of_error or f"standard error of the {words}", units),
    }


def friction_force(
    length: float, error: float, stiffness: float, unit: str, label: str = ""
) -> dict[str, xr.Variable]:
    """The friction force k x_F [N] of a length x_F in `unit`, with its standard error.

    stiffness : k [N/m]
    label : of the measurement, one of several
    """
    newtons = checks.number(stiffness, "stiffness", above=0.0) * conversion(unit, "m")
    name, words = "friction_force", "kinetic friction force k x_F"
    if label:
        name, words = f"{name}_{label}", f"{words}, {label}"
    return with_error(name, newtons * length, newtons * error, words, "N")


def flags(meanings: Collection[str]) -> dict[str, object]:
    """Attributes of a variable whose codes count meanings from 0."""
    return {"flag_values": np.arange(len(meanings), dtype=np.int8), "flag_meanings": " ".join(meanings)}


def verdict(code: int, meanings: Mapping[str, str]) -> xr.Variable:
    """Verdict as a CF flag; codes count the meanings from 0."""
    attributes = {
        "long_name": "what the data show",
        **flags(meanings),
        "comment": "; ".join(f"{name}: {words}" for name, words in meanings.items()),
    }
    return xr.Variable((), np.int8(code), attributes)


def usable_errors(found: Errors, index: int, bound: float, fitted: bool) -> np.ndarray:
    """Standard errors, NaN of a parameter whose interval begins on its bound.

    Near such a bound the data see the square of the distance from it: its likelihood is no normal curve, and
    only the interval is meaningful.
    """
    result = found.standard_error.copy()
    if fitted and found.lower[index] <= bound:
        result[index] = np.nan
    return result


def _parameter_variable(values: np.ndarray, words: str) -> xr.Variable:
    return xr.Variable("parameter", values, {"long_name": words, "comment": "each in its own unit"})


def _parameter_variables(
    units: Sequence[str], solution: Solution, errors: Errors, free: np.ndarray
) -> dict[str, xr.Variable]:
    """Variables on the parameters."""
    held, bound = (~free).astype(np.int8), solution.at_bound.astype(np.int8)
    of_errors = {"long_name": "correlation of errors", "units": "1"}
    return {
        "estimate": _parameter_variable(solution.values, "estimate"),
        "standard_error": _parameter_variable(
            errors.standard_error,
            "standard error; 0 for held parameters, NaN where only the interval can be used",
        ),
        "lower": _parameter_variable(errors.lower, "lower end of the 95 % interval"),
        "upper": _parameter_variable(errors.upper, "upper end of the 95 % interval"),
        "unit": xr.Variable("parameter", np.array(units), {"long_name": "unit"}),
        "known": xr.Variable("parameter", held, {"long_name": "1 if held, not fitted"}),
        "at_bound": xr.Variable("parameter", bound, {"long_name": "1 if on a bound of what is possible"}),
        "correlation": xr.Variable(("parameter", "parameter2"), errors.correlation, of_errors),
    }


def estimates(
    meanings: Mapping[str, str],
    units: Sequence[str],
    solution: Solution,
    errors: Errors,
    free: np.ndarray,
    data: np.ndarray,
    data_unit: str,
    sigma: float | np.ndarray | None = None,
) -> xr.Dataset:
    """The dataset of a fit.

    meanings : the parameters and what they are, in order
    units : theirs
    free : shape (parameters,), bool: whether a parameter was fitted; the others have no error
    data : shape (samples,), in `data_unit`; residuals are model less data
    sigma : the error of a sample, or of all, in `data_unit`; by default it is that of the residuals
    """
    of_one = np.sqrt(errors.variance) if sigma is None else sigma
    source = "from the residuals" if sigma is None else "as given"

    def of_samples(values: np.ndarray, words: str) -> xr.Variable:
        return xr.Variable("sample", values, {"long_name": words, "units": data_unit})

    names = np.array(list(meanings))
    words = {"long_name": "parameter", "comment": "; ".join(f"{k}: {v}" for k, v in meanings.items())}
    variables = _parameter_variables(units, solution, errors, free) | {
        "data": of_samples(data, "measured"),
        "model": of_samples(data + solution.residual, "fitted"),
        "residual": of_samples(solution.residual, "fitted less measured"),
        "sigma": of_samples(
            np.broadcast_to(of_one, data.shape).copy(), f"standard error of a sample, {source}"
        ),
        "reduced_chi_square": number(
            errors.variance,
            "reduced chi square: squares of residuals, over given errors if any, per degree of freedom",
            _squared(data_unit),
        ),
        "residual_rms": number(
            np.sqrt(np.mean(solution.residual**2)), "root mean square of residuals", data_unit
        ),
        "residual_correlation": number(errors.lag_correlation, "lag-1 correlation of residuals"),
        "error_inflation": number(errors.inflation, "what errors were multiplied by for that"),
    }
    coords = {
        "parameter": xr.Variable("parameter", names, words),
        "parameter2": xr.Variable("parameter2", names, words),
        "sample": xr.Variable("sample", np.arange(data.size), {"long_name": "sample fitted", "units": "1"}),
    }
    attributes = {
        "Conventions": "CF-1.11",
        "source": f"frictionmap {__version__}",
        "history": f"{now()} frictionmap.identify",
        "references": REFERENCES,
    }
    return xr.Dataset(variables, coords, attributes)

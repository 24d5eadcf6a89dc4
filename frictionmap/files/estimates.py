"""Checks, standard form and summaries of datasets of estimates."""

from collections.abc import Hashable

import numpy as np
import xarray as xr

from ..datasets.estimate_labels import ESTIMATES, OF_PARAMETERS
from ..datasets.schema import checked_values, placed
from ..errors import InputError

#: What a line of the table says itself.
_SHOWN_ELSEWHERE = ("verdict", "residual_correlation", "error_inflation", "reduced_chi_square")

#: Digits behind the point that can be read.
_DECIMALS = 7


def estimates_form(ds: xr.Dataset) -> xr.Dataset:
    """Estimates, or a slice of them, in the form that they were made in; the structure has been checked.

    A parameter that was chosen is a list of one again.  What is neither a number nor text is left out.

    Raises
    ------
    InputError
        A required variable is missing, or a value is invalid; the message names the variable.
    """
    variables = {}
    for name, label in ESTIMATES.items():
        if name in ds.variables:
            given = placed(ds, name, label.dims)
            variables[name] = xr.Variable(
                label.dims, checked_values(name, given, "estimates"), ds[name].attrs
            )
    for name in ("parameter", *OF_PARAMETERS):
        if name not in variables:
            raise InputError(
                f"cannot use the estimates: variable {name!r} is missing; give a file of frictionmap identify"
            )
    _check_parameters(variables["parameter"].values)
    kept = {name: ds.variables[name] for name in ds.variables if _is_further(ds, name)}
    coords = {
        name: variables.pop(name) for name in ("parameter", "parameter2", "sample") if name in variables
    }
    return xr.Dataset({**variables, **kept}, coords, ds.attrs)


def _is_further(ds: xr.Dataset, name: Hashable) -> bool:
    """Whether a variable may be what a kind of data adds: numbers or texts, of samples or alone."""
    variable = ds.variables[name]
    plain = variable.dtype.kind in "iufOU" and set(variable.dims).isdisjoint(("parameter", "parameter2"))
    return name not in ESTIMATES and plain and len(set(variable.dims)) == variable.ndim


def _check_parameters(names: np.ndarray) -> None:
    if not names.size or np.unique(names).size < names.size:
        words = ", ".join(names.tolist()) or "none"
        raise InputError(f"parameter must be a list of different names; got {words}")


def describe_estimates(ds: xr.Dataset) -> list[str]:
    """Describe the estimates as a table with standard errors and intervals, then other results."""
    rows = [("", "estimate", "std. error", "95 % interval", "unit")]
    rows += [_row(ds.sel(parameter=name)) for name in ds["parameter"].values]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "  ".join(f"{text:<{width}}" for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    shown = {*_SHOWN_ELSEWHERE, *ds["parameter"].values.tolist()}
    singles = [name for name in ds.data_vars if name not in shown and _is_number(ds[name])]
    lines += [
        f"{name}  {float(ds[name]):.5g} {unit_in_words(ds[name].attrs.get('units', '1'))}".rstrip()
        for name in singles
    ]
    lines += filter(None, [verdict_in_words(ds)])
    return lines + [f"warning: {words}" for words in warnings_of(ds)]


def _row(one: xr.Dataset) -> tuple[str, str, str, str, str]:
    """A line of the table."""
    name, unit = str(one["parameter"].values), unit_in_words(str(one["unit"].values))
    if one["known"]:
        return name, f"{float(one['estimate']):.6g}", "", "held", unit
    interval = f"{float(one['lower']):.6g} to {float(one['upper']):.6g}"
    interval += " (on a bound)" if one["at_bound"] else ""
    error = float(one["standard_error"])
    shown = "see interval" if np.isnan(error) else f"{error:.2g}"
    return name, f"{float(one['estimate']):.6g}", shown, interval, unit


def _is_number(variable: xr.DataArray) -> bool:
    return variable.ndim == 0 and variable.dtype.kind in "iuf"


def unit_in_words(unit: object) -> str:
    """Unit as text; empty for a pure number."""
    return "" if unit == "1" else str(unit)


def estimates_in_short(ds: xr.Dataset) -> str:
    """List the fitted parameters with standard errors on one line that breaks only between them."""
    words = []
    for name in ds["parameter"].values:
        one = ds.sel(parameter=name)
        if not one["known"]:
            words.append(f"{name} {_short_estimate(one)} {unit_in_words(str(one['unit'].values))}".rstrip())
    return ", ".join(part.replace(" ", "\u00a0") for part in words)


def _short_estimate(one: xr.Dataset) -> str:
    """An estimate with its standard error, or with its interval where only that can be used."""
    value, error, lower, upper = (float(one[key]) for key in ("estimate", "standard_error", "lower", "upper"))
    return f"{value:.4g} ({lower:.4g} to {upper:.4g})" if np.isnan(error) else _format_to_error(value, error)


def _format_to_error(value: float, error: float) -> str:
    """Format a value to the second digit of its standard error."""
    if error == 0.0:
        return f"{value:.6g}"
    decimals = max(1 - int(np.floor(np.log10(error))), 0)
    return (
        f"{value:.{decimals}f} ± {error:.{decimals}f}"
        if decimals <= _DECIMALS
        else f"{value:.6g} ± {error:.2g}"
    )


def verdict_in_words(ds: xr.Dataset) -> str:
    """Verdict of a fit in words; empty if the file has none."""
    if "verdict" not in ds:
        return ""
    meanings = [part.partition(": ")[2] for part in str(ds["verdict"].attrs.get("comment", "")).split("; ")]
    code = int(ds["verdict"])
    return meanings[code] if code < len(meanings) else ""


def warnings_of(ds: xr.Dataset) -> list[str]:
    """Warnings about a fit."""
    return [words for words in str(ds.attrs.get("warnings", "")).split("; ") if words]


def source_of_data(ds: xr.Dataset) -> str:
    """Name of the data file and number of samples fitted."""
    file, form = (str(ds.attrs.get(name, "")) for name in ("data_file", "data_form"))
    samples = f"{ds.sizes['sample']:,} samples fitted" if "sample" in ds.sizes else ""
    return ", ".join(filter(None, (f"{file} ({form})" if file and form else file or form, samples)))

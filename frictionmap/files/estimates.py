"""Checks, standard form and summaries of datasets of estimates."""

import re
from collections.abc import Hashable, Iterator

import numpy as np
import xarray as xr

from ..datasets.estimate_labels import ESTIMATES, OF_PARAMETERS
from ..datasets.schema import checked_values, placed
from ..errors import InputError

#: What a line of the table says itself.
_SHOWN_ELSEWHERE = ("verdict", "residual_correlation", "error_inflation", "reduced_chi_square")

#: Verdicts with which no estimate can be relied on.
_FAILED = ("not_identified", "explained_otherwise", "not_explained")

#: Parameters that a result begins with, the first kind that there is, and their symbols; none: their names.
_HEADLINES = (
    ("friction", "F"),
    ("x_F(_.+)?", ""),
    ("beta(_.+)?", ""),
    ("f[1-9]", ""),
    ("f_n|f_k1m1", ""),
)

#: Friction forces beside the parameters, without their errors.
_FORCES = r"friction_force(_(?!standard_error)\w+?)??(?<!_standard_error)"

#: The same of lengths F/k.
_LENGTHS = _FORCES.replace("friction_force", "x_F")

#: Beginnings of the names of results that are listed in any case.
_ALWAYS = ("x_F", "spring_stiffness")

#: End of the name of a standard error.
_ERROR = "_standard_error"

#: Quantile of a normal deviate for 95 %.
_NORMAL = 1.96

#: Difference of both halves of an interval, over the larger one, up to which it is written as one number.
_EVEN = 0.05

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


def describe_estimates(ds: xr.Dataset, verbose: bool = False) -> list[str]:
    """Describe the result, warnings, and the estimates as a table; with `verbose` also other results."""
    lines = [result_in_words(ds), *(f"warning: {words}" for words in warnings_of(ds)), *_missing(ds)]
    lines = [*filter(None, lines), *_table(ds)]
    return [*lines, *_further(ds, verbose)]


def _table(ds: xr.Dataset) -> list[str]:
    """The estimates with standard errors and intervals."""
    rows = [("", "estimate", "std. error", "95 % interval", "unit")]
    rows += [_row(ds.sel(parameter=name)) for name in ds["parameter"].values]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return [
        "  ".join(f"{text:<{width}}" for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _further(ds: xr.Dataset, verbose: bool) -> list[str]:
    """Results beside the parameters: all, or lengths F/k and stiffnesses that the result does not state.

    Standard errors stand beside their values.
    """
    shown = {*_SHOWN_ELSEWHERE, *ds["parameter"].values.tolist()}
    singles = [name for name in _numbers(ds) if name not in shown]
    if not verbose:
        stated = _lengths_in_result(ds)
        singles = [name for name in singles if name.startswith(_ALWAYS) and name not in stated]
    return [_beside_parameters(ds, name) for name in singles if not _is_error(ds, name)]


def _is_error(ds: xr.Dataset, name: str) -> bool:
    """Whether a number is the standard error of another one."""
    return name.endswith(_ERROR) and name.removesuffix(_ERROR) in ds


def _beside_parameters(ds: xr.Dataset, name: str) -> str:
    """A number beside the parameters, with its standard error if that is known."""
    text = f"{name}  {float(ds[name]):.5g} {_unit_of(ds, name)}".rstrip()
    error = _error_of(ds, name)
    return text if np.isnan(error) else f"{text} (std. error {error:.2g})"


def result_in_words(ds: xr.Dataset) -> str:
    """The friction with its 95 % interval, and the verdict; of a fit that fails the verdict alone."""
    verdict = verdict_in_words(ds)
    found = [] if _verdict_name(ds) in _FAILED else list(_friction(ds))
    words = "; ".join(filter(None, (", ".join(found), verdict)))
    return words[:1].upper() + words[1:] + "." * (not words.endswith(".")) if verdict and not found else words


def _verdict_name(ds: xr.Dataset) -> str:
    """The name of the verdict; empty if the file has none."""
    names = str(ds["verdict"].attrs.get("flag_meanings", "")).split() if "verdict" in ds else []
    return names[int(ds["verdict"])] if names and int(ds["verdict"]) < len(names) else ""


def _friction(ds: xr.Dataset) -> Iterator[str]:
    """The friction forces, or in their place F/k, or friction ratios, with 95 % intervals.

    Without any of them it is the frequencies.
    """
    names = [str(name) for name in ds["parameter"].values]
    forces = _forces(ds)
    for name in forces:
        label = name.removeprefix("friction_force")
        length = f"x_F{label}"
        if length in names and float(ds["estimate"].sel(parameter=length)) > 0.0:
            factor = float(ds[name]) / float(ds["estimate"].sel(parameter=length))
            yield _with_interval(f"F{label}", ds.sel(parameter=length), _unit_of(ds, name), factor)
        else:
            yield _with_error(ds, name, f"F{label}")
    lengths = _lengths_in_result(ds)
    for name in lengths:
        yield _with_error(ds, name, name)
    if forces or lengths:
        return
    for pattern, symbol in _HEADLINES:
        chosen = [name for name in names if re.fullmatch(pattern, name)]
        for name in chosen:
            yield _with_interval(symbol or name, ds.sel(parameter=name), _unit_of(ds, name))
        if chosen:
            return


def _forces(ds: xr.Dataset) -> list[str]:
    """Names of the friction forces beside the parameters."""
    return [name for name in _numbers(ds) if re.fullmatch(_FORCES, name)]


def _lengths_in_result(ds: xr.Dataset) -> list[str]:
    """Names of the lengths F/k beside the parameters that stand in the result, in the place of forces."""
    if _forces(ds) or "x_F" in ds["parameter"].values:
        return []
    return [name for name in _numbers(ds) if re.fullmatch(_LENGTHS, name)]


def _with_error(ds: xr.Dataset, name: str, symbol: str) -> str:
    """A number beside the parameters, with its 95 % interval if its standard error is known."""
    value, unit, error = float(ds[name]), _unit_of(ds, name), _error_of(ds, name)
    if np.isnan(error):
        return f"{symbol} = {value:.4g} {unit}".rstrip()
    return f"{symbol} = {_rounded_to(value, _NORMAL * error)} {unit}".rstrip() + " (95 %)"


def _with_interval(name: str, one: xr.Dataset, unit: str, factor: float = 1.0) -> str:
    """A parameter times a factor, with its 95 % interval: half its width if it is even."""
    value, lower, upper = (factor * float(one[key]) for key in ("estimate", "lower", "upper"))
    if one["known"]:
        return f"{name} = {value:.6g} {unit}".rstrip() + " (held)"
    if np.isinf(upper):
        return f"{name} >= {lower:.4g} {unit}".rstrip() + " (95 %)"
    below, above = value - lower, upper - value
    if not one["at_bound"] and abs(above - below) <= _EVEN * max(above, below):
        return f"{name} = {_rounded_to(value, 0.5 * (above + below))} {unit}".rstrip() + " (95 %)"
    return f"{name} = {value:.4g} {unit}".rstrip() + f" (95 %: {lower:.4g} to {upper:.4g})"


def _rounded_to(value: float, half: float) -> str:
    """A value with half the width of its interval, both to the second digit of that."""
    if not np.isfinite(half):
        return f"{value:.4g} +- {half:g}"
    return _format_to_error(value, half).replace("\u00b1", "+-")


def _missing(ds: xr.Dataset) -> list[str]:
    """Name the key that would give the friction in newtons."""
    names = {*(str(name) for name in ds["parameter"].values), *(str(name) for name in ds.data_vars)}
    lengths = [name for name in names if re.fullmatch(r"x_F(_(?!standard)\w+)?", name)]
    if not lengths or any(name.startswith("friction_force") for name in names) or "stiffness" in names:
        return []
    if not all(_unit_of(ds, name) == "mm" for name in lengths if not name.endswith(_ERROR)):
        return []
    return ["known.stiffness (N/m) is missing: with it the friction force F = k x_F is stated in newtons"]


def _unit_of(ds: xr.Dataset, name: str) -> str:
    """Unit of a parameter, or of a number beside them; empty for a pure number."""
    own = ds[name].attrs.get("units", "1") if name in ds.data_vars else ds["unit"].sel(parameter=name).values
    return unit_in_words(str(own))


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


def _numbers(ds: xr.Dataset) -> list[str]:
    """Names of the single numbers beside the parameters."""
    return [str(name) for name, one in ds.data_vars.items() if one.ndim == 0 and one.dtype.kind in "iuf"]


def _error_of(ds: xr.Dataset, name: str) -> float:
    """Standard error of a number beside the parameters; NaN if it is not known."""
    return float(ds[f"{name}{_ERROR}"]) if f"{name}{_ERROR}" in _numbers(ds) else np.nan


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

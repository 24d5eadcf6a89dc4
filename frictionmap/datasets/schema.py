"""Schema of datasets: every variable is checked against its label before it is used."""

from collections.abc import Callable, Iterable

import numpy as np
import xarray as xr

from .. import checks
from ..errors import InputError
from .belt_labels import BELTS
from .design_labels import answer_labels
from .estimate_labels import ESTIMATE_TEXTS, ESTIMATES
from .labels import (
    BESIDE,
    CELL,
    COORDINATES,
    CURVES,
    CYCLE_VARIABLES,
    HISTORY_VARIABLES,
    LABELS,
    LIMIT,
    OLDER_NAMES,
    SCALES,
    SHARES,
    Label,
    attributes,
    labels_of,
)
from .motion_labels import TIMES, motion_labels

#: Global attributes that are text, if present.
TEXTS = (
    "title", "system", "excitation", "source", "history", "references", "config", "reduction",
    "reduction_check", "decoupling", "modes", "comment",
)  # fmt: skip


#: Labels of the kinds of datasets with variables of their own.
_OWN: dict[str, Callable[[], dict[str, Label]]] = {
    "estimates": lambda: ESTIMATES, "design": answer_labels, "history": motion_labels,
    "spectrum": motion_labels, "belt": lambda: BELTS,
}  # fmt: skip


def is_own(what: str) -> bool:
    """Whether a kind of dataset has variables of its own; it is small, and read whole."""
    return what in _OWN


def labels_by_name(what: str) -> dict[str, Label]:
    """Labels of axes and variables of a kind of dataset."""
    return _OWN[what]() if what in _OWN else {**COORDINATES, **BESIDE, **labels_of(what)}


def _is_history(ds: xr.Dataset, name: object) -> bool:
    """Whether a variable belongs to a motion in time; the older name `phase` is an angle in curves."""
    if name in OLDER_NAMES["response"]:
        return ds.variables[name].attrs.get("units") != "radian"
    return name in HISTORY_VARIABLES


def _is_curve(name: object) -> bool:
    """Whether only response curves have a variable with this name."""
    return name in CYCLE_VARIABLES or name in OLDER_NAMES["curves"] or _on_limit(name)


def _on_limit(name: object) -> bool:
    return name in CURVES and CURVES[str(name)].dims == LIMIT


def kind(ds: xr.Dataset) -> str:
    """Kind of a dataset, or of a slice of one.

    "map", "curves", "response", "boundaries", "estimates", "shares", "design", "history", "spectrum" or
    "belt".
    """
    of_belts = ("growth", "beta_sliding_lim", "cycle_speed_lim")
    if "question" in ds.variables:
        return "design"
    if "wall_speed" in ds.variables and any(name in ds.variables for name in of_belts):
        return "belt"
    if "estimate" in ds.variables:
        return "estimates"
    if "record" in ds.variables and "scale" in ds.variables:
        return "spectrum" if "period" in ds.variables else "history"
    if any(name in SHARES for name in ds.variables):
        return "shares"
    if any(_is_history(ds, name) for name in ds.variables):
        return "response"
    if any(_is_curve(name) for name in ds.variables):
        return "curves"
    cells = "beta" in ds.dims or any("beta" in LABELS[name].dims for name in LABELS if name in ds.variables)
    return "map" if cells else "boundaries"


def with_current_names(ds: xr.Dataset) -> xr.Dataset:
    """Add the variables that a dataset has only under their older names; the values are not copied."""
    what = kind(ds)
    added = {}
    for old, new in OLDER_NAMES.get(what, {}).items():
        if old in ds.variables and new not in ds.variables:
            added[new] = ds.variables[old].copy(deep=False)
            added[new].attrs = attributes(labels_of(what)[new])
    return ds.assign(added)


def in_brackets(dims: Iterable[object]) -> str:
    """Format dimensions in brackets."""
    return f"({', '.join(map(str, dims))})"


def standard_dims(name: str, what: str) -> tuple[str, ...]:
    """Dimensions of a variable in a kind of dataset; a response has no dimensions of cells."""
    dims = (BESIDE[name] if name in BESIDE else labels_of(what)[name]).dims
    return tuple(dim for dim in dims if dim not in CELL) if what == "response" else dims


def _check_dimensions(ds: xr.Dataset) -> None:
    """Check that no dimension has a single number of its name, and that contacts are numbered."""
    for dim in ds.dims:
        if dim in ds.variables and ds.variables[dim].ndim == 0:
            raise InputError(f"{dim} must be an axis, as others have this dimension; got a single number")
    for name in ("contact", "contact_name"):
        if name in ds.variables and ds.variables[name].dims not in ((), ("contact",)):
            raise InputError(
                f"{name} must have the dimensions (contact); got {in_brackets(ds.variables[name].dims)}"
            )
    if "contact" in ds.dims:
        numbers = ds.variables["contact"].values if "contact" in ds.variables else np.zeros(0)
        if not numbers.size or np.unique(numbers).size < numbers.size:
            raise InputError(
                f"contact must be a coordinate with one number per contact; got {numbers.tolist() or 'none'}"
            )


def check_structure(ds: xr.Dataset, in_parts: bool = False) -> None:
    """Check names, types, sizes, units and codes; only values of axes are read.

    in_parts : the values will be read part by part, so that a variable may exceed the memory

    Raises
    ------
    InputError
        A variable does not match its label; the message is one line that names it.
    """
    what = kind(ds)
    for key in (*TEXTS, *ESTIMATE_TEXTS) if what == "estimates" else TEXTS:
        text = ds.attrs.get(key, "")
        if not isinstance(text, str):
            raise InputError(f"the attribute {key} must be text; got {checks.one_line(text)}")
    for key in SCALES.values():
        if key in ds.attrs:
            checks.number(ds.attrs[key], f"the attribute {key}", above=0.0)
    _check_dimensions(ds)
    known = labels_by_name(what)
    if not is_own(what) and not any(name in LABELS for name in ds.variables):
        names = ", ".join(map(str, ds.variables)) or "none"
        raise InputError(
            f"cannot use the dataset: no frictionmap variable found, such as regime or beta_lim; got {names}"
        )
    for name, variable in ds.variables.items():
        if name in known:
            _check_type(str(name), variable, known[str(name)])
            if not in_parts:
                _check_size(str(name), variable)
            if what not in ("estimates", "spectrum"):  # they have the units of the data
                _check_attributes(str(name), variable, known[str(name)])


def _check_type(name: str, variable: xr.Variable, label: Label) -> None:
    # text, complex numbers, booleans and times are not real numbers
    if label.dtype is not np.str_ and variable.dtype.kind not in "iuf":
        raise InputError(f"{name} must be numbers; got type {variable.dtype.name}")
    if len(set(variable.dims)) < len(variable.dims):
        raise InputError(f"{name} must have every dimension once; got {in_brackets(variable.dims)}")
    if label.dtype is np.str_:
        _check_texts(name, variable, label)


def _check_size(name: str, variable: xr.Variable) -> None:
    if variable.size > checks.MOST_CELLS:
        raise InputError(
            f"{name} must have at most {checks.MOST_CELLS:.0e} values in memory; got {variable.size:.3g}"
        )


def _check_texts(name: str, variable: xr.Variable, label: Label) -> None:
    given = np.atleast_1d(variable.values).ravel()
    if not all(isinstance(text, str) for text in given.tolist()):
        raise InputError(f"{name} must be text; got {checks.one_line(given.tolist())}")
    if label.texts and any(text not in label.texts for text in given.tolist()):
        raise InputError(f"{name} must be of {', '.join(label.texts)}; got {checks.one_line(given.tolist())}")


def _check_attributes(name: str, variable: xr.Variable, label: Label) -> None:
    """Check units and codes, where present, against those that the values are read with."""
    if not label.codes:
        units = variable.attrs.get("units", label.units)
        in_seconds = name in TIMES and units == "s"
        if not isinstance(units, str) or (units != label.units and not in_seconds):
            raise InputError(f"{name} must have the units {label.units!r}; got {checks.one_line(units)}")
    elif label.flags in variable.attrs and "flag_meanings" in variable.attrs:
        values: list = np.atleast_1d(variable.attrs[label.flags]).tolist()
        meanings = str(variable.attrs["flag_meanings"]).split()
        valid = {code.value: code.name for code in (*label.codes, *label.also)}
        if len(values) != len(meanings) or any(
            valid.get(value) != meaning for value, meaning in zip(values, meanings, strict=False)
        ):
            words = ", ".join(f"{value} {meaning}" for value, meaning in valid.items())
            raise InputError(f"{name} must have the codes {words}; got {values} {' '.join(meanings)}")


def checked_values(name: str, given: np.ndarray, what: str = "") -> np.ndarray:
    """Convert the values of a variable or an axis to its type, after checking that all are valid.

    Integers may be stored as floats, as other programs do for the sake of a fill value.
    what : kind of the dataset
    """
    label = labels_by_name(what)[name]
    if label.dtype is np.str_:
        return given.astype(label.dtype)
    with np.errstate(invalid="ignore", over="ignore"):
        values: np.ndarray = given.astype(label.dtype, copy=False)
    wrong = _wrong(values, label)
    if np.issubdtype(label.dtype, np.integer) and given.dtype != values.dtype:
        wrong |= values != given
    if wrong.any():
        index = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
        at = f" at [{', '.join(map(str, index))}]" if index else ""
        raise InputError(f"{name} must be {_describe_allowed(label)}; got {given[index]}{at}")
    return values


def placed(ds: xr.Dataset, name: str, dims: tuple[str, ...]) -> np.ndarray:
    """Values of a variable over exactly these dimensions, in this order."""
    variable = ds.variables[name]
    if not set(variable.dims) <= set(dims):
        valid = (
            f"have the dimensions {in_brackets(dims)}, or fewer" if dims else "be one number in a response"
        )
        raise InputError(f"{name} must {valid}; got {in_brackets(variable.dims)}")
    missing = [dim for dim in dims if dim not in variable.dims]
    for dim in missing:
        given = ds[dim].size if dim in ds.coords else ds.sizes.get(dim, int(dim not in COORDINATES))
        if given != 1:
            raise InputError(
                f"{name} has no dimension {dim}: one value of {dim} must be there; got {given or 'none'}"
            )
    values = variable.values[(..., *[np.newaxis] * len(missing))]
    return xr.Variable((*variable.dims, *missing), values).transpose(*dims).values


def _range(label: Label) -> tuple[float, float]:
    if not label.codes:
        return label.least, label.most
    values = [code.value for code in (*label.codes, *label.also)]
    return (0, sum(values)) if label.flags == "flag_masks" else (min(values), max(values))


def _wrong(values: np.ndarray, label: Label) -> np.ndarray:
    """Where values are invalid."""
    least, most = _range(label)
    wrong = (values < least) | (values > most)
    valid = [code.value for code in (*label.codes, *label.also)]
    if label.flags == "flag_masks":
        wrong |= (values.astype(np.int64) & ~sum(valid)) != 0
    elif len(valid) < most - least + 1 and valid:  # the codes have gaps
        wrong |= ~np.isin(values, valid)
    if values.dtype.kind == "f":
        if not label.nan:
            wrong |= np.isnan(values)
        if not label.inf:
            wrong |= np.isinf(values)
    return wrong


def _describe_allowed(label: Label) -> str:
    """Describe the valid values."""
    if label.codes:
        how = "a sum of" if label.flags == "flag_masks" else "one of"
        return f"{how} {', '.join(str(code.value) for code in (*label.codes, *label.also))}"
    words = ["whole" if np.issubdtype(label.dtype, np.integer) else "a number" if label.inf else "finite"]
    words += [f">= {label.least:g}"] if label.least > -np.inf else []
    words += [f"<= {label.most:g}"] if label.most < np.inf else []
    return ", ".join(words) + (" or NaN" if label.nan else "")

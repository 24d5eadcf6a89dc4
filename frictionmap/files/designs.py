"""Standard form and summaries of answers to design questions."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from ..datasets.amounts import amounts_of
from ..datasets.design_labels import answer_axes, answer_labels
from ..datasets.questions import record
from ..datasets.schema import checked_values, placed
from ..errors import InputError
from .estimates import warnings_of

#: Width of the first column of a summary.
_WIDTH = 34

#: Values that a message lists.
_SHOWN = 6


#: Boundaries over the band, in words.
_OF_BAND = {
    "beta_no_stop": "no stops in the band up to",
    "beta_no_stop_some_starts": "can be without stops up to",
    "beta_stuck": "sticks over the whole band from",
    "beta_stuck_some_starts": "can stay stuck from",
    "beta_unique": "one steady state, proved, up to",
}


def design_form(ds: xr.Dataset) -> xr.Dataset:
    """An answer in the form that it was made in; its structure has been checked.

    Raises
    ------
    InputError
        A value is invalid; the message names the variable.
    """
    variables = {}
    for name, label in answer_labels().items():
        if name in ds.variables:
            values = checked_values(name, placed(ds, name, label.dims), "design")
            variables[name] = xr.Variable(label.dims, values, ds[name].attrs)
    for axis in ("peak", "beta_search"):
        if axis in variables and variables[axis].size == 0:
            raise InputError(f"{axis} must have at least one value; got none")
    for axis in [name for name in variables if name.endswith("_search")]:
        if (np.diff(variables[axis].values) <= 0.0).any():
            raise InputError(
                f"{axis} must be strictly increasing; got {variables[axis].values.tolist()[:_SHOWN]}"
            )
    coords = {name: variables.pop(name) for name in answer_axes() if name in variables}
    return xr.Dataset(variables, coords, ds.attrs)


def describe_design(ds: xr.Dataset) -> list[str]:
    """Describe an answer: in sentences, then as a table of two columns."""
    sentences = [text for part in record(str(ds["question"].values)).sentences for text in part(ds)]
    warnings = [f"warning: {words}" for words in warnings_of(ds)]
    return [*sentences, *warnings, *(f"{name:<{_WIDTH}} {text}".rstrip() for name, text in _rows(ds))]


def _rows(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    for rows in record(str(ds["question"].values)).rows:
        yield from rows(ds)
    words = amounts_of(ds)
    for name, meaning in _OF_BAND.items():
        if name in ds and np.isfinite(float(ds[name])):
            yield meaning, words.friction_and_ratio(float(ds[name]))

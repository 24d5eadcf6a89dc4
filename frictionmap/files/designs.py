"""Standard form and summaries of answers to design questions."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.design_labels import DESIGN, DESIGN_AXES
from ..datasets.schema import checked_values, placed
from ..errors import InputError
from .estimates import warnings_of

#: Width of the first column of a summary.
_WIDTH = 34

#: Peaks and ranges that a summary lists.
_SHOWN = 6


#: Boundaries over the band, in words.
_OF_BAND = {
    "beta_no_stop": "no stops in the band up to beta",
    "beta_no_stop_some_starts": "can be without stops up to beta",
    "beta_stuck": "sticks over the whole band from beta",
    "beta_stuck_some_starts": "can stay stuck from beta",
}


def design_form(ds: xr.Dataset) -> xr.Dataset:
    """An answer in the form that it was made in; its structure has been checked.

    Raises
    ------
    InputError
        A value is invalid; the message names the variable.
    """
    variables = {}
    for name, label in DESIGN.items():
        if name in ds.variables:
            values = checked_values(name, placed(ds, name, label.dims), "design")
            variables[name] = xr.Variable(label.dims, values, ds[name].attrs)
    for axis in ("peak", "beta_search"):
        if axis in variables and variables[axis].size == 0:
            raise InputError(f"{axis} must have at least one value; got none")
    for axis in ("beta_search", "r_search", "ratio_search"):
        if axis in variables and (np.diff(variables[axis].values) <= 0.0).any():
            raise InputError(
                f"{axis} must be strictly increasing; got {variables[axis].values.tolist()[:_SHOWN]}"
            )
    coords = {name: variables.pop(name) for name in DESIGN_AXES if name in variables}
    return xr.Dataset(variables, coords, ds.attrs)


def describe_design(ds: xr.Dataset) -> list[str]:
    """Describe an answer as a table of two columns."""
    return [f"{name:<{_WIDTH}} {text}".rstrip() for name, text in _rows(ds)]


def _rows(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    question = str(ds["question"].values) if "question" in ds else ""
    if "beta" in ds:
        name = "working point: beta" if question == "margin" else "friction ratio beta"
        yield name, _friction(ds, "beta", "friction_force")
    if "at_r" in ds:
        yield ("working point: r" if question == "margin" else "decided at r"), f"{float(ds['at_r']):.9g}"
    if {"second", "second_ratio"} <= set(ds.variables):
        yield f"ratio of contact {int(ds['second'])}", _second_force(ds)
    yield from _peak_rows(ds)
    yield from _range_rows(ds)
    yield from _margin_rows(ds)
    for name, words in _OF_BAND.items():
        if name in ds and (np.isfinite(float(ds[name])) or name == "beta_stuck"):
            yield words, f"{float(ds[name]):.6g}"
    for words in warnings_of(ds):
        yield "warning", words


def _friction(ds: xr.Dataset, name: str, beside: str) -> str:
    force = f" ({float(ds[beside]):.6g} N)" if beside in ds else ""
    return f"{float(ds[name]):.9g}{force}"


def _second_force(ds: xr.Dataset) -> str:
    """The ratio of the second contact, and its force where that of beta is known."""
    ratio = float(ds["second_ratio"])
    force = f" ({ratio * float(ds['friction_force']):.6g} N)" if "friction_force" in ds else ""
    return f"{ratio:.6g}{force}"


def _peak_rows(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    if "peak" not in ds.coords:
        return
    response = str(ds.attrs.get("response", "response"))
    kind = f", {ds['kind'].values}" if "kind" in ds else ""
    length = f" ({1e3 * float(ds['peak_m'][0]):.6g} mm)" if "peak_m" in ds else ""
    yield f"least peak, {response}", f"{float(ds['peak'][0]):.10g}{length}{kind}"
    if "kind" in ds and str(ds["kind"].values) == "threshold":
        yield "", "with this friction or more it does not move, at any frequency of the band"
    for k in range(min(ds.sizes["peak"], _SHOWN) if "peak_r" in ds else 0):
        yield ("peaks" if k == 0 else ""), _peak(ds, k)
    if {"quantile", "peak_of_sample"} <= set(ds.variables):
        sizes = ds["peak_of_sample"].values
        share = f"{100.0 * float(ds['quantile']):g} %"
        yield "samples", f"{sizes.size}; {share} of them stay below the peak, all below {sizes.max():.6g}"
    for one, value in zip(_offsets(ds), _changes(ds), strict=True):
        yield f"with {abs(one):.0%} {'less' if one < 0.0 else 'more'} friction".replace("%", " %"), value
    if "second_beta" in ds and np.isfinite(float(ds["second_beta"])):
        yield "second best: beta", f"{float(ds['second_beta']):.6g} ({float(ds['second_peak']):.6g})"


def _peak(ds: xr.Dataset, k: int) -> str:
    words = [f"{float(ds['peak'][k]):.6g}"]
    if "peak_r" in ds:
        hertz = f" ({float(ds['peak_frequency'][k]):.6g} Hz)" if "peak_frequency" in ds else ""
        words.append(f"at r = {float(ds['peak_r'][k]):.6g}{hertz}")
    if "peak_regime" in ds:
        names = {code.value: code.name for code in regimes.BELT_REGIMES}
        words.append(names[int(ds["peak_regime"][k])].replace("stick_slip", "stick-slip").replace("_", " "))
    if "peak_stops" in ds and float(ds["peak_stops"][k]) > 0.0:
        words.append(f"{float(ds['peak_stops'][k]):.4g} stops per cycle")
    return ", ".join(words)


def _offsets(ds: xr.Dataset) -> list[float]:
    return ds["offset"].values.tolist() if "peak_at_offset" in ds and "offset" in ds.coords else []


def _changes(ds: xr.Dataset) -> list[str]:
    """The largest response with other friction, as a change in per cent unless the least one is 0."""
    least = float(ds["peak"][0])
    values = ds["peak_at_offset"].values.tolist() if _offsets(ds) else []
    return [f"{100.0 * (value / least - 1.0):+.2f} %" if least > 0.0 else f"{value:.6g}" for value in values]


def _range_rows(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    if not {"interval_begin", "interval_end"} <= set(ds):
        return
    begins, ends = ds["interval_begin"].values, ds["interval_end"].values
    for k, (begin, end) in enumerate(zip(begins[:_SHOWN], ends[:_SHOWN], strict=True)):
        words = f"{begin:.9g} to {end:.9g}" if np.isfinite(end) else f"{begin:.9g} or more"
        if {"interval_begin_N", "interval_end_N"} <= set(ds):
            words += f" ({ds['interval_begin_N'].values[k]:.6g} to {ds['interval_end_N'].values[k]:.6g} N)"
        limit = f" for at most {float(ds['limit']):.6g}" if "limit" in ds else ""
        yield (f"friction ratio beta{limit}" if k == 0 else ""), words


def _margin_rows(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    for name, words in (("beta_lim", "to stops (beta_lim)"), ("beta_stick", "to sticking (beta_stick)")):
        if f"margin_{name}" in ds and np.isfinite(float(ds[f"margin_{name}"])):
            yield f"friction {words}", f"{100.0 * float(ds[f'margin_{name}']):+.6g} %"
    for name, words in (("margin_r", "to stops"), ("margin_r_stick", "to sticking")):
        if name in ds and np.isfinite(float(ds[name])):
            yield f"frequency {words}", f"{100.0 * float(ds[name]):+.6g} %"

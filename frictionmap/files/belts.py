"""Standard form, tables and summaries of motions without a load."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.amounts import Amounts, amounts_of, per_cycle
from ..datasets.belt_labels import AXES, BELTS, CELL, MEASURES
from ..datasets.labels import attributes, in_si
from ..datasets.schema import checked_values
from ..errors import InputError

#: Significant digits of displacements and speeds.
_DIGITS = 6


def belts_form(ds: xr.Dataset) -> xr.Dataset:
    """Motions without a load in the form that they were made in; their structure has been checked.

    Raises
    ------
    InputError
        A value is invalid, or an axis has a wrong order; the message names the variable.
    """
    ds = ds.set_coords([name for name in AXES if name in ds.data_vars])
    axes = () if "time" in ds.coords else (*CELL, "dof")
    ds = ds.expand_dims([dim for dim in axes if dim in ds.coords and dim not in ds.dims])
    variables = {}
    for name, label in BELTS.items():
        if name not in ds.variables:
            continue
        dims = tuple(dim for dim in label.dims if dim in ds[name].dims)
        extra = [
            dim for dim in ds[name].dims if dim not in label.dims and dim not in ("contact", *CELL, "dof")
        ]
        if extra:
            raise InputError(f"{name} must have the dimensions {', '.join(dims)}; got also {extra[0]}")
        values = ds[name].variable.transpose(..., *dims)
        variables[name] = xr.Variable(
            values.dims, checked_values(name, values.values, "belt"), ds[name].attrs or attributes(label)
        )
    for name in CELL:
        if name in variables and variables[name].ndim and (np.diff(variables[name].values) <= 0.0).any():
            raise InputError(f"{name} must be strictly increasing; got {variables[name].values.tolist()[:6]}")
    coords = {name: variables.pop(name) for name in AXES if name in variables}
    return xr.Dataset(variables, coords, ds.attrs)


def is_in_si(name: str) -> bool:
    """Whether a variable is one in SI units beside its ratio."""
    return any(name == in_si(ratio, kind) for kind, names in MEASURES.items() for ratio in names)


def describe_belts(ds: xr.Dataset) -> list[str]:
    """Describe motions without a load: cells by regime, several motions, and the limits, in lines."""
    return list(_lines(ds))


def _lines(ds: xr.Dataset) -> Iterator[str]:
    if "time" in ds.coords:
        yield _describe_motion(ds)
        return
    if "regime" in ds:
        codes = regimes.NO_LOAD_REGIMES
        counts = [(code.name.replace("_", " "), int((ds["regime"] == code.value).sum())) for code in codes]
        words = ", ".join(f"{count:,} {name}" for name, count in counts if count)
        yield f"{ds['regime'].size:,} cells ({words})"
    if "also_reachable" in ds:
        flags = ds["also_reachable"].values
        several = int(((flags & (flags - 1)) != 0).sum())
        if several:
            yield f"{several:,} cells have several stable motions: the initial state decides"
    if "status" in ds:
        for code in regimes.BELT_STATUSES[1:]:
            count = int((ds["status"] == code.value).sum())
            if count:
                yield f"{count:,} cell{'s' * (count != 1)} {code.name}: {code.advice}"
    for name, words in (
        ("cycle_speed_lim", "belt speed above which there is no stick-slip cycle"),
        ("sliding_speed_lim", "belt speed above which steady sliding is stable"),
        ("beta_slope_lim", "beta times slope of the fall at which it loses stability"),
    ):
        if name in ds:
            yield f"{words}: {_range(ds, name)}"


def _describe_motion(ds: xr.Dataset) -> str:
    """One motion in a line."""
    regime = next(one for one in regimes.NO_LOAD_REGIMES if one.value == int(ds["regime"]))
    words = [regime.name.replace("_", " ")]
    if np.isfinite(ds["cycle_period"]):
        period = f"{float(ds['cycle_period_s']):.6g} s" if "cycle_period_s" in ds else ""
        words.append(f"period {period or format(float(ds['cycle_period']), '.6g')}")
        words.append(per_cycle(np.ravel(ds["stops_per_cycle"]), "stops"))
        words.append(f"stuck {_each(100.0 * ds['stuck_fraction'])} % of the time")
    lowest, highest = (_places(ds, name) for name in ("x_min", "x_max"))
    words.append(f"x from {lowest} to {highest}")
    words += [f"growth of small vibrations about steady sliding {float(ds['growth']):.4g}"]
    status = next(one for one in regimes.BELT_STATUSES if one.value == int(ds["status"]))
    return ", ".join([*words, *([f"{status.name}: {status.advice}"] if status.value else [])])


def _each(values: xr.DataArray) -> str:
    return ", ".join(f"{value:.5g}" for value in np.atleast_1d(values.values))


def _places(ds: xr.Dataset, name: str) -> str:
    """Displacements of all masses, with their unit."""
    words = amounts_of(ds)
    return ", ".join(words.response(value, digits=_DIGITS) for value in np.ravel(ds[name]).tolist())


def _range(ds: xr.Dataset, name: str) -> str:
    """The value of a limit, or its range, in units where they are there."""
    words = amounts_of(ds) if f"{name}_m_s" in ds else None
    low, high = (float(f(ds[name].values)) for f in (np.min, np.max))
    begin, end = (_limit(value, words) for value in (low, high))
    unit = end.partition(" ")[2]
    return end if low == high else f"{begin.removesuffix(f' {unit}' if unit else '')} to {end}"


def _limit(value: float, words: Amounts | None) -> str:
    """A limit: a number, or a belt speed with its unit."""
    if np.isinf(value):
        return "infinite"
    return f"{value:.6g}" if words is None else words.speed(value, digits=_DIGITS)

"""Standard form, tables and summaries of motions in time."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..datasets.amounts import amounts_of
from ..datasets.labels import SCALES, attributes
from ..datasets.motion_labels import (
    AVERAGED,
    CELL,
    NOT_COMPUTED,
    OF_CONTACTS,
    STATUSES,
    axes_of_motions,
    motion_labels,
    si_name,
)
from ..datasets.schema import checked_values
from ..errors import InputError
from ..units.table import UNITS, handy_unit

#: Width of the first column of a summary.
_WIDTH = 34

#: Coordinates that are not axes of the same name.
_BESIDE = ("contact_name", "record_name", "point_name")

#: Motions of a summary at most.
_MOST_LINES = 8


def _dims(name: str, variable: xr.Variable) -> tuple[str, ...]:
    dims = motion_labels()[name].dims
    own = next((old for old in OF_CONTACTS if name == old or name.startswith(f"{old}_")), None)
    if own is not None and "contact" in variable.dims:
        return (*dims[:4], "contact", *dims[4:])
    return dims


def motions_form(ds: xr.Dataset) -> xr.Dataset:
    """Motions in the form that they were made in; their structure has been checked.

    Raises
    ------
    InputError
        A value is invalid; the message names the variable.
    """
    ds = ds.expand_dims([dim for dim in (*CELL, "dof", "period") if dim in ds.coords and dim not in ds.dims])
    variables, further = {}, axes_of_motions(ds)
    for name in motion_labels():
        if name not in ds.variables:
            continue
        own = ds[name].variable
        dims = tuple(dim for dim in _dims(name, own) if dim in own.dims)
        extra = [dim for dim in own.dims if dim not in (*dims, "period", *further)]
        wrong = [dim for dim in extra if own.sizes[dim] > 1]
        if wrong:
            raise InputError(f"{name} must have the dimensions {', '.join(dims)}; got also {wrong[0]}")
        values = own.squeeze(extra).transpose(..., *dims)
        label = motion_labels()[name]
        attrs = ds[name].attrs or attributes(label)
        variables[name] = xr.Variable(values.dims, checked_values(name, values.values, "history"), attrs)
    coords = {name: variables.pop(name) for name in (*ds.coords, *_BESIDE) if name in variables}
    coords |= {name: one.variable for name, one in ds.coords.items() if one.dims and one.dims[0] in further}
    return xr.Dataset(variables, coords, ds.attrs)


def describe_motions(ds: xr.Dataset) -> list[str]:
    """Describe motions: one in a few lines, several in one line each, a spectrum by ranges."""
    if "period" in ds.dims:
        return list(_ranges(ds))
    dims = (*axes_of_motions(ds), *CELL)
    cells = list(np.ndindex(*(ds.sizes[dim] for dim in dims)))
    motions = [ds.isel(dict(zip(dims, cell, strict=True))) for cell in cells[:_MOST_LINES]]
    if len(cells) == 1:
        return [f"{name:<{_WIDTH}} {text}" for name, text in (*rows_of_motion(motions[0]), *_remarks(ds))]
    most = float(ds["beta"].max())
    lines = [f"{_heading(one, dims[: -len(CELL)], most):<{_WIDTH}} {_summary(one)}" for one in motions]
    if len(cells) > _MOST_LINES:
        lines.append(f"... and {len(cells) - _MOST_LINES} further motions")
    return [*lines, *(f"{name}: {text}" for name, text in _remarks(ds))]


def _remarks(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    """What to look out for, of a dataset that says so."""
    if "interpolation_bound" in ds.attrs:
        most = _in_handy_unit(
            np.array(ds.attrs["interpolation_bound"]), "length" if "amplitude_m" in ds else ""
        )
        yield "straight lines or a spline change", f"no displacement by more than {most}"
    if "remark" in ds.attrs:
        yield "remark", str(ds.attrs["remark"])


def _heading(one: xr.Dataset, further: Sequence[str], most: float) -> str:
    """The record, its factor, the friction and the place on further axes of one of several motions.

    most : largest friction ratio, whose unit all have
    """
    words = [str(one["record_name"].values)]
    words += [f"{name} {float(one[name]):.4g}" for name in further]
    for name, unusual in (("scale", 1.0), ("mu", 1.0)):
        if float(one[name]) != unusual:
            words.append(f"{name} {float(one[name]):g}")
    beta = float(one["beta"])
    in_units = SCALES["force"] in one.attrs
    friction = amounts_of(one).friction(beta, like=most) if in_units else f"beta {beta:.4g}"
    return f"{', '.join(words)}, {friction}"


def _summary(one: xr.Dataset) -> str:
    words = [f"largest displacement {_measured(one, 'amplitude', 'length', 'm')}"]
    words += [f"{name} {_listed(one[name].values)}" for name in ("stops", "slips") if name in one]
    if np.isfinite(one["residual"].values).any():
        words.append(f"rests at {_measured(one, 'residual', 'length', 'm')}")
    code = STATUSES[int(one["status"])]
    return "; ".join([*words, *([code.name] if code.value else [])])


def _ranges(ds: xr.Dataset) -> Iterator[str]:
    """Least, median and largest value of every variable, where it is computed."""
    done = ds["status"] != NOT_COMPUTED
    rows: list[tuple[str, str]] = []
    for name, variable in ds.data_vars.items():
        values = variable.values[np.isfinite(variable.values) & done.transpose(*variable.dims).values]
        if name == "status" or not values.size:
            continue
        unit = str(variable.attrs.get("units", "1")).replace(" s-2", "/s2")
        quantiles = np.quantile(values, [0.0, 0.5, 1.0])
        if unit == "m":
            text = _in_handy_unit(quantiles, "length", " ... ")
        else:
            text = _listed(quantiles, "" if unit == "1" else unit, " ... ")
        rows.append((str(variable.attrs.get("long_name", name)), text))
    width = max((len(meaning) for meaning, _ in rows), default=0) + 1
    yield from (f"{meaning:<{width}} {text}" for meaning, text in rows)
    for code in STATUSES[1:]:
        count = int((ds["status"].values == code.value).sum())
        if count:
            yield f"{count:,} motions {code.name}: {code.meaning}"


def _listed(values: Any, unit: str = "", between: str = ", ") -> str:
    text = between.join(f"{value + 0.0:.4g}" for value in np.atleast_1d(values).ravel().tolist())  # no -0
    return f"{text} {unit}".rstrip()


def _in_handy_unit(values: np.ndarray, measure: str, between: str = ", ") -> str:
    """Values in SI units in the unit that is handy for the largest one; plain numbers without a measure."""
    sizes = np.abs(values[np.isfinite(values)])
    if not measure or not sizes.size:
        return _listed(values, between=between)
    unit = handy_unit(float(sizes.max()) or 1.0, measure)
    return _listed(values / float(UNITS[unit].size), unit, between)


def _measured(one: xr.Dataset, name: str, measure: str, unit: str) -> str:
    """Values with a unit where they are there, of lengths, forces and works a handy one, else the ratios."""
    beside = si_name(name, measure)
    if beside not in one:
        return _listed(one[name].values)
    values = one[beside].values
    if measure in ("length", "force", "work") and np.isfinite(values).any():
        return _in_handy_unit(values, measure)
    return _listed(values, unit)


_ROWS = (
    ("largest displacement", "amplitude", "length", "m"),
    ("largest absolute acceleration", "acceleration_amplitude", "acceleration", "m/s2"),
    ("largest force on the base", "base_force", "force", "N"),
    ("place of rest", "residual", "length", "m"),
    ("sliding distance", "sliding_distance", "length", "m"),
    ("work lost in the contact", "work_friction", "work", "J"),
)


#: What is counted of a motion.
_COUNTED = (
    ("stops", "stops"),
    ("slips", "slips"),
    ("turns", "turns"),
    ("separations", "separations"),
    ("spring_crossings", "knots passed"),
)


def rows_of_motion(one: xr.Dataset) -> Iterator[tuple[str, str]]:
    """What is listed of one motion: names, and values in words."""
    code = STATUSES[int(one["status"])]
    yield "status", code.name if code.value == 0 else f"{code.name}: {code.meaning}"
    for name, words in _COUNTED:
        if name in one and np.isfinite(one[name].values).any():
            yield words, _listed(one[name].values)
    for words, name, measure, unit in _ROWS:
        if name in one and np.isfinite(one[name].values).any():
            yield words, _measured(one, name, measure, unit)
    if "beta_hold" in one and np.isfinite(one["beta_hold"].values).any():
        yield "friction that holds everything", _measured(one, "beta_hold", "force", "N")
    for name, words in (("x", "displacement"), ("acceleration", "absolute acceleration")):
        if f"{name}_mean" in one:
            yield from _averages(one, name, words)
    if np.isfinite(one["asleep_time"]):
        unit = "s" if one["asleep_time"].attrs.get("units") == "s" else ""
        yield "at rest permanently after", _listed(one["asleep_time"].values, unit)


def _averages(one: xr.Dataset, name: str, words: str) -> Iterator[tuple[str, str]]:
    """Mean, variance and peak of a quantity of every mass, with their errors."""
    measure = AVERAGED[name]
    for end, kind in (("mean", measure), ("variance", f"squared {measure}"), ("peak", measure)):
        own, error = f"{name}_{end}", f"{name}_{end}_error"
        if si_name(own, kind) in one:
            own, error = si_name(own, kind), si_name(error, kind)
        pairs = zip(np.atleast_1d(one[own].values), np.atleast_1d(one[error].values), strict=True)
        values = ", ".join(f"{value:.4g} +- {wrong:.2g}" for value, wrong in pairs)
        unit = str(one[own].attrs.get("units", "1"))
        yield f"{end} of the {words}", f"{values} {'' if unit == '1' else unit}".rstrip()
    likeness = float(one[f"{name}_batch_correlation"].max())
    batches = int(str(one.attrs["statistics"]).split(" batches")[0].rsplit(" ", 1)[1])
    if likeness > 2.0 / np.sqrt(batches):
        yield "too short", f"means of neighbouring batches are alike ({likeness:.2f}): errors are too small"

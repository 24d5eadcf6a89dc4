"""Short tables: a row per instant of a motion, per frequency of response curves, or per cell.

Columns are named as measured files name theirs: the quantity, the number of the mass or contact, and the
unit, such as x_1_m.  Lengths, forces and times are in SI units where the reference values are known.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.amounts import DIGITS, amounts_of
from ..datasets.labels import MEASURES, SCALES, in_si
from ..datasets.motion_labels import AVERAGED, AVERAGES, CELL, SI_UNITS, axes_of_motions
from ..datasets.physical import ones_of
from ..datasets.schema import kind, labels_by_name
from .slices import further_axes

#: Columns of motions.
_OF_MOTIONS = ("x", "acceleration", "z", "friction", "normal_force", "spring_force")

#: Columns of motions side by side; averages of stationary motions besides.
_OF_SEVERAL = (
    *("amplitude", "acceleration_amplitude", "contact_amplitude", "friction_amplitude", "base_force"),
    *("residual", "stops", "slips", "sliding_distance", "work_friction", "asleep_time", "beta_hold"),
    "status",
)

#: Columns of response curves; those of first harmonics, forces and work where there are no amplitudes.
_OF_CURVES = (
    *("regime", "contact_regime", "stops_per_cycle", "slips_per_cycle"),
    *("amplitude", "phase", "contact_amplitude", "contact_phase"),
)
_OTHERWISE = (
    *("first_harmonic_amplitude", "first_harmonic_phase", "contact_first_harmonic_amplitude"),
    *("transmitted_force", "sliding_distance", "work_friction", "work_input", "work_damping"),
)

#: Axes that design questions search, what they measure, and their names in units.
_SEARCHED = {
    "beta_search": ("force", "friction_force"),
    "r_search": ("frequency", "frequency"),
    "speed_search": ("velocity", "wall_speed"),
}

#: Responses along these axes.
_OF_RESPONSE = ("peak_of_beta", "response_of_sample")

#: Units behind a name that has none, as measured files write them.
_ENDINGS = {"radian": "rad", **dict(SI_UNITS.values())}

#: Dimensions whose values are columns side by side.
_PARTS = ("dof", "contact", "spring")

#: Axes of cells, in the order of rows; further axes come before them.
_AXES = ("record", "scale", "mu", "wall_speed", "r", "beta", "period")

#: Names of axes along which there are several values of one cell: each is a column.
_SPLIT = ("outcome", "quantile")


def short_table(ds: xr.Dataset) -> Any:
    """Data frame with a row per instant, per frequency of curves, or else per cell; None of other results."""
    what = kind(ds)
    if what == "response" and "tau" in ds.dims:
        return _motion_table(ds, "tau")
    if what == "belt" and "time" in ds.dims:
        return _motion_table(ds, "time")
    if what == "history" and "time" in ds.dims and is_single(ds):
        return _motion_table(ds.squeeze([dim for dim in CELL if dim in ds.dims], drop=True), "time")
    if what == "curves" and {"mu", "r", "beta"} <= set(ds.dims):
        return _curve_table(ds)
    if what == "history":
        averages = [f"{name}_{end}" for name in AVERAGED for end in AVERAGES]
        names = [own for name in (*_OF_SEVERAL, *averages) for own in (name, _with_si(ds, name))]
        ds = ds[[name for name in dict.fromkeys(names) if name in ds]]
    return cell_table(ds) if what in ("map", "boundaries", "shares", "belt", "history", "spectrum") else None


def cell_table(ds: xr.Dataset, everything: bool = False) -> Any:
    """Data frame with a row per cell, or per motion; masses, contacts and springs are columns.

    everything : ratios also where there are values in SI units; of one motion a row per instant
    """
    in_time = everything and "time" in ds.dims and is_single(ds)
    if in_time:
        ds = ds.squeeze([dim for dim in CELL if dim in ds.dims], drop=True)
    ds = _with_quantiles_in_si(ds)
    for dim in _SPLIT:
        ds = _split_dimension(ds, dim)
    axes = [dim for dim in further_axes(ds) if dim not in (*_AXES, *_PARTS)]
    axes = ["time"] if in_time else [*axes, *(dim for dim in _AXES if dim in ds.dims)]
    table: dict[str, xr.Variable] = {}
    if SCALES["force"] in ds.attrs and "beta" in axes and "friction_force" not in ds.coords:
        force = ds["beta"] * float(ds.attrs[SCALES["force"]])
        ds = ds.assign_coords(friction_force=force.assign_attrs(units="N"))
    beside = [name for name in ds.coords if name not in axes and set(ds[name].dims) <= set(axes)]
    for name in map(str, (*beside, *ds.data_vars)):
        if (everything or not _ending(ds, name) or name in beside) and not (
            in_time and "time" not in ds[name].dims
        ):
            table |= dict(_columns(ds, name, axes, everything or name in beside))
    wide = xr.Dataset(table, {dim: ds[dim].variable for dim in axes if dim in ds.coords})
    checks.cells(1, 1, math.prod(wide.sizes.values()), name="a table")
    rows = wide.to_dataframe(dim_order=[dim for dim in axes if dim in wide.dims])
    return rows.rename_axis(index=lambda axis: f"{axis}_s" if ds[axis].attrs.get("units") == "s" else axis)


def design_table(ds: xr.Dataset, everything: bool = False) -> Any:
    """Data frame of the curve that a design question searched: a row per friction, frequency or belt speed.

    everything : ratios also where there are values in SI units
    """
    over = next((axis for axis in _SEARCHED if axis in ds.coords), None)
    if over is None:
        return ds.to_dataframe()
    ones, response = ones_of(ds), amounts_of(ds).measure
    measure, name = _SEARCHED[over]
    values = ds[over].values
    columns = {in_si(name, measure): values * ones[measure]} if measure in ones else {}
    columns[over] = values
    for own in (str(own) for own in ds.data_vars if ds[own].dims == (over,)):
        measure = "force" if own.startswith("beta_") else response if own in _OF_RESPONSE else ""
        if measure in ones:
            columns[in_si(own, measure)] = ds[own].values * ones[measure]
        if measure not in ones or everything:
            columns[own] = ds[own].values
    return _frame(columns)


def _with_quantiles_in_si(ds: xr.Dataset) -> xr.Dataset:
    """Shares have quantiles of ratios, and what 1 is of them."""
    for measure, scale in SCALES.items():
        for name in MEASURES[measure] if scale in ds.attrs else ():
            if (own := f"{name}_quantile") in ds:
                ds = ds.assign({in_si(own, measure): ds[own] * float(ds.attrs[scale])})
    return ds


def _split_dimension(ds: xr.Dataset, dim: str) -> xr.Dataset:
    """Replace variables along a dimension by one variable per value."""
    if dim not in ds.dims:
        return ds
    columns: dict[str, xr.DataArray] = {}
    for name, variable in ds.data_vars.items():
        if dim not in variable.dims:
            columns[str(name)] = variable
            continue
        unit = _ending(ds, str(name))
        base = str(name).removesuffix(f"_{unit}")
        for k, value in enumerate(ds[dim].values):
            column = "_".join(filter(None, (base, str(value), unit)))
            columns[column] = variable.isel({dim: k}, drop=True)
    return xr.Dataset(columns, attrs=ds.attrs)


def is_single(ds: xr.Dataset) -> bool:
    """Whether motions in time are one motion."""
    return all(ds.sizes.get(dim, 1) == 1 for dim in (*CELL, *axes_of_motions(ds)))


def _with_si(ds: xr.Dataset, name: str) -> str:
    """The variable in its SI unit, if there is one."""
    return next((own for end in _ENDINGS.values() if (own := f"{name}_{end}") in ds.variables), name)


def _ending(ds: xr.Dataset, name: str) -> str:
    """The unit at the end of a name, if the ratio is there under the name without it."""
    ends = (end for end in _ENDINGS.values() if name.endswith(f"_{end}"))
    return next((end for end in ends if name.removesuffix(f"_{end}") in ds.variables), "")


def _columns(
    ds: xr.Dataset, name: str, dims: Sequence[str], as_named: bool = False
) -> Iterator[tuple[str, xr.Variable]]:
    """A variable as columns along some dimensions, one for each mass or contact: names and values.

    as_named : the variable itself, also where there is one in its SI unit
    """
    own = name if as_named else _with_si(ds, name)
    variable = decode_flags(ds[own], kind(ds))
    known = _ending(ds, own)
    unit = known or _ENDINGS.get(str(variable.attrs.get("units", "1")), "")
    base = own.removesuffix(f"_{known}")
    parts = [dim for dim in _PARTS if dim in variable.dims]
    if set(variable.dims) - {*dims, *parts} or len(parts) > 1:
        return
    for k in range(variable.sizes[parts[0]]) if parts else (None,):
        part = variable if k is None else variable.isel({parts[0]: k})
        column = "_".join(filter(None, (base, "" if k is None else _number(ds, parts[0], k), unit)))
        yield column, part.transpose(*(dim for dim in dims if dim in part.dims)).variable


def _number(ds: xr.Dataset, dim: str, k: int) -> str:
    """The number of a mass or contact, or the name of a point."""
    if dim == "dof" and "point_name" in ds.coords:
        dim = "point_name"
    return str(ds[dim].values[k]) if dim in ds.coords else str(k + 1)


def _motion_table(ds: xr.Dataset, over: str) -> Any:
    """Displacements, displacements in contacts and friction forces over time."""
    own = next((name for name in ("time_s", "time") if name in ds.coords), over)
    in_seconds = own == "time_s" or (own == "time" and ds["time"].attrs.get("units") == "s")
    time = ds[own if in_seconds else over].values
    columns = {"time_s" if in_seconds else over: time}
    for name in _OF_MOTIONS:
        if name in ds and over in ds[name].dims:
            columns |= {column: values.values for column, values in _columns(ds, name, [over])}
    return _frame(columns)


def _curve_table(ds: xr.Dataset) -> Any:
    """Regime, stops, amplitudes and phases over frequency; several values of mu and beta side by side."""
    names = [name for name in _OF_CURVES if name in ds]
    if not any("amplitude" in name for name in names):
        names += [name for name in _OTHERWISE if name in ds]
    columns = {"frequency_Hz": ds["frequency"].values} if "frequency" in ds.coords else {}
    columns["r"] = ds["r"].values
    words, several = amounts_of(ds), ds.sizes["mu"] * ds.sizes["beta"] > 1
    for m, mu in enumerate(ds["mu"].values.tolist()):
        for b, beta in enumerate(ds["beta"].values.tolist()):
            place = words.friction(beta, digits=DIGITS) + (f", mu = {mu:g}" if ds.sizes["mu"] > 1 else "")
            one = ds.isel(mu=m, beta=b)
            for name in names:
                columns |= {
                    f"{column} ({place})" if several else column: values.values
                    for column, values in _columns(one, name, ["r"])
                }
    return _frame(columns)


def _frame(columns: Mapping[str, np.ndarray]) -> Any:
    """Data frame of columns, the first of which is its index."""
    index, *names = columns
    variables = {name: (index, columns[name]) for name in names}
    return xr.Dataset(variables, {index: columns[index]}).to_dataframe()[names]


def decode_flags(variable: xr.DataArray, what: str) -> xr.DataArray:
    """Replace codes by their names.

    what : kind of the file
    """
    label = labels_by_name(what).get(str(variable.name))
    if label is None or not label.codes:
        return variable
    names = {code.value: code.name for code in (*label.codes, *label.also)}
    if label.flags == "flag_masks":
        several = np.unique(variable.values)
        names = {k: " | ".join(name for code, name in names.items() if code & k) for k in several.tolist()}
    words = variable.astype(object)
    for value, name in names.items():
        words = words.where(variable != value, name)
    return words

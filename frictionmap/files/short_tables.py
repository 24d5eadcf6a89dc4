"""Short tables: one row per instant of a motion, one row per frequency of response curves.

Columns are named as measured files name theirs: the quantity, the number of the mass or contact, and the
unit, such as x_1_m.  Lengths, forces and times are in SI units where the reference values are known.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..datasets.amounts import DIGITS, amounts_of
from ..datasets.labels import LABELS, SI
from ..datasets.motion_labels import CELL, axes_of_motions
from ..datasets.schema import kind

#: Columns of motions.
_OF_MOTIONS = ("x", "acceleration", "z", "friction")

#: Columns of response curves; those of first harmonics, forces and work where there are no amplitudes.
_OF_CURVES = (
    *("regime", "contact_regime", "stops_per_cycle", "slips_per_cycle"),
    *("amplitude", "phase", "contact_amplitude", "contact_phase"),
)
_OTHERWISE = (
    *("first_harmonic_amplitude", "first_harmonic_phase", "contact_first_harmonic_amplitude"),
    *("transmitted_force", "sliding_distance", "work_friction", "work_input", "work_damping"),
)

#: Units behind a name that has none, as measured files write them.
_ENDINGS = {"radian": "rad", "s": "s", "m": "m", "N": "N", "Hz": "Hz", "m s-2": "m_s2"}


def short_table(ds: xr.Dataset) -> Any:
    """Data frame of a motion or of response curves; None of anything else, which has no short table."""
    what = kind(ds)
    if what == "response" and "tau" in ds.dims:
        return _motion_table(ds, "tau")
    if what == "history" and "time" in ds.dims and _is_single(ds):
        return _motion_table(ds.squeeze([dim for dim in CELL if dim in ds.dims], drop=True), "time")
    if what == "curves" and {"mu", "r", "beta"} <= set(ds.dims):
        return _curve_table(ds)
    return None


def _is_single(ds: xr.Dataset) -> bool:
    """Whether motions in time are one motion."""
    return all(ds.sizes.get(dim, 1) == 1 for dim in (*CELL, *axes_of_motions(ds)))


def _with_si(ds: xr.Dataset, name: str) -> str:
    """The variable in its SI unit, if there is one."""
    for _, ending in SI.values():
        if f"{name}_{ending}" in ds:
            return f"{name}_{ending}"
    return name


def _columns(ds: xr.Dataset, name: str, dims: Sequence[str]) -> Iterator[tuple[str, np.ndarray]]:
    """A variable as columns along some dimensions, one for each mass or contact: names and values."""
    own = _with_si(ds, name)
    variable = ds[own]
    unit = own.removeprefix(name).lstrip("_") or _ENDINGS.get(str(variable.attrs.get("units", "1")), "")
    parts = [dim for dim in ("dof", "contact") if dim in variable.dims]
    if set(variable.dims) - {*dims, *parts} or len(parts) > 1:
        return
    for k in range(variable.sizes[parts[0]]) if parts else (None,):
        part = variable if k is None else variable.isel({parts[0]: k})
        column = "_".join(filter(None, (name, "" if k is None else _number(ds, parts[0], k), unit)))
        yield column, part.transpose(*dims).values


def _number(ds: xr.Dataset, dim: str, k: int) -> str:
    """The number of a mass or contact."""
    return str(ds[dim].values[k]) if dim in ds.coords else str(k + 1)


def _motion_table(ds: xr.Dataset, over: str) -> Any:
    """Displacements, displacements in contacts and friction forces over time."""
    in_seconds = "time" in ds.coords and (over == "tau" or ds["time"].attrs.get("units") == "s")
    time = ds["time"].values if in_seconds else ds[over].values
    columns = {"time_s" if in_seconds else over: time}
    for name in _OF_MOTIONS:
        if name in ds and over in ds[name].dims:
            columns |= dict(_columns(ds, name, [over]))
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
                one[name] = decode_flags(one[name])
                columns |= {
                    f"{column} ({place})" if several else column: values
                    for column, values in _columns(one, name, ["r"])
                }
    return _frame(columns)


def _frame(columns: Mapping[str, np.ndarray]) -> Any:
    """Data frame of columns, the first of which is its index."""
    index, *names = columns
    variables = {name: (index, columns[name]) for name in names}
    return xr.Dataset(variables, {index: columns[index]}).to_dataframe()[names]


def decode_flags(variable: xr.DataArray) -> xr.DataArray:
    """Replace codes by their names."""
    label = LABELS.get(str(variable.name))
    if label is None or not label.codes or label.flags == "flag_masks":
        return variable
    names = {code.value: code.name for code in (*label.codes, *label.also)}
    words = variable.astype(object)
    for value, name in names.items():
        words = words.where(variable != value, name)
    return words

"""Datasets in hertz, newtons and metres in addition to ratios, where the reference values are known."""

import math
from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..units.axes import KINDS, typed
from ..units.scales import NO_SCALES, Scales
from ..units.table import UNITS, handy_unit
from .labels import MEASURES, SCALES, attributes, in_si, labels_of
from .schema import kind
from .variables import coordinate

#: Coordinate that holds an axis in its SI unit.
BESIDE_OF = {"r": "frequency", "beta": "friction_force"}

#: Coordinate that holds friction coefficients, where the normal force is known.
COEFFICIENT = "friction_coefficient"


def with_units(ds: xr.Dataset, scales: Scales) -> xr.Dataset:
    """Add `frequency(r)`, `friction_force(beta)`, and amplitudes, forces and work in SI units to a dataset.

    The ratios are unchanged; the names of the added variables end in their unit.
    """
    if scales == NO_SCALES:
        return ds  # a copy would take a third of the time of a small map
    own = ds.variables  # ds[name] would build an array with coordinates
    axes = physical_axes({name: own[name].values for name in KINDS if name in own}, scales)
    return in_si_too(ds.assign_attrs(scale_attributes(scales)).assign_coords(axes))


def scale_attributes(scales: Scales) -> dict[str, float]:
    """Global attributes with the reference values that convert ratios."""
    found = {name: scales.of(measure) for measure, name in SCALES.items()}
    return {name: value for name, value in found.items() if value is not None}


def physical_axes(axes: Mapping[str, np.ndarray], scales: Scales) -> dict[str, xr.Variable]:
    """Coordinates in hertz and newtons for the axes r and beta, with the digits of a typed value."""
    found = {}
    for name, kind_of_axis in KINDS.items():
        one = getattr(scales, kind_of_axis)
        if name in axes and one is not None:
            found[BESIDE_OF[name]] = coordinate(BESIDE_OF[name], typed(axes[name], one))
    if "beta" in axes and scales.coefficient is not None:
        found[COEFFICIENT] = coordinate(COEFFICIENT, typed(axes["beta"], scales.coefficient))
    return found


def in_si_too(ds: xr.Dataset) -> xr.Dataset:
    """Add the missing variables in SI units to a dataset, from its attributes."""
    ones = ones_of(ds)
    labels = labels_of(kind(ds))
    added = {}
    for measure, names in MEASURES.items():
        for name in names if measure in ones else ():
            own = in_si(name, measure)
            if name in ds.data_vars and own not in ds and ds[name].attrs.get("units", "1") == "1":
                ratio = ds[name].variable
                values = ratio.values * ratio.dtype.type(ones[measure])
                added[own] = xr.Variable(ratio.dims, values, attributes(labels[own]))
    if "tau" in ds.coords and "time" in ones:
        ds = ds.assign_coords(time=coordinate("time", ds["tau"].values * ones["time"]))
    return ds.assign(added)


def ones_of(ds: xr.Dataset) -> dict[str, float]:
    """SI values of a ratio of 1 for every measure that a dataset has; times and velocities at a single r
    only.
    """
    ones = {measure: float(ds.attrs[name]) for measure, name in SCALES.items() if name in ds.attrs}
    if "force" in ones and "length" in ones:
        ones["work"] = ones["force"] * ones["length"]
    if "frequency" in ones and "length" in ones:
        ones["acceleration"] = ones["length"] * (2.0 * math.pi * ones["frequency"]) ** 2
    if "frequency" in ones and "r" in ds.coords and ds["r"].ndim == 0:
        omega = 2.0 * math.pi * float(ds.coords["frequency"])
        ones["time"] = 1.0 / omega
        if "length" in ones:
            ones["velocity"] = ones["length"] * omega
    if "frequency" in ones and "length" in ones and {"wall_speed", "speed_search"} & set(ds.coords):
        ones["velocity"] = ones["length"] * 2.0 * math.pi * ones["frequency"]
    return ones


#: What 1 is of each ratio, over frequency, and of motions in time or without a load, which have no r.
_ONES = {"frequency": "r = 1 is", "force": "beta = 1 is", "length": "an amplitude of 1 is"}
_ONES_WITHOUT_R = _ONES | {"frequency": "omega_1/(2 pi) is", "length": "a displacement of 1 is"}


def describe_scales(ds: xr.Dataset) -> str:
    """Describe the reference values of a dataset; empty if it has no units."""
    over_r = kind(ds) not in ("history", "spectrum", "belt") and ds.attrs.get("excitation") != "none"
    said, parts = _ONES if over_r else _ONES_WITHOUT_R, []
    for measure, name in SCALES.items():
        if name in ds.attrs:
            unit = handy_unit(float(ds.attrs[name]), measure)
            parts.append(f"{said[measure]} {float(ds.attrs[name]) / float(UNITS[unit].size):.6g} {unit}")
    return ", ".join(parts)

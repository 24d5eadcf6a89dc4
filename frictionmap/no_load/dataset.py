"""Motions without a load as datasets: labels, units, provenance."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..datasets.belt_labels import AXES, BELTS, CELL, MEASURES, OF_CONTACTS
from ..datasets.labels import attributes, in_si
from ..datasets.physical import COEFFICIENT, scale_attributes
from ..datasets.variables import stamp
from ..model.system import System
from ..phases.dataset import spring_coordinates
from ..units.axes import typed
from ..units.scales import NO_SCALES, Scales, Units

#: Axes in SI units with the digits of a typed value.
_TYPED = {"wall_speed_m_s": ("wall_speed", "velocity"), "friction_force": ("beta", "force"),
          COEFFICIENT: ("beta", "coefficient")}  # fmt: skip


def belt_dataset(
    function: str, title: str, system: System, axes: Mapping[str, np.ndarray],
    values: Mapping[str, np.ndarray], units: Units | None, scales: Scales,
) -> xr.Dataset:  # fmt: skip
    """A dataset of motions without a load.

    Parameters
    ----------
    function, title : the function of the package, and the title
    system : System
    axes : mu, wall_speed and beta
    values : variables by name
    units, scales : the reference values that were given, and what follows of them
    """
    own = dict(values)
    if "x_max" in values:
        own["dof"] = np.array(system.dofs.numbers)
    if "x_max" in values and system.by_modes:
        own["point_name"] = np.array(system.dofs.written_labels)
    if any(name.startswith("spring_") for name in values):
        own |= {name: one.values for name, one in spring_coordinates(system).items()}
    groups = system.contact_system.groups
    if len(groups) > 1:
        own |= {"contact": np.arange(1, len(groups) + 1), "contact_name": np.array([g.name for g in groups])}
    every = {**axes, **own, **_in_si(axes, own, scales)}
    variables = {name: variable(name, one) for name, one in every.items()}
    coords = {name: variables.pop(name) for name in AXES if name in variables}
    ds = stamp(xr.Dataset(variables, coords), function, title, system, axes, units=units)
    ds.attrs |= {"system": system.describe_unloaded(), "excitation": "none"}
    return ds.assign_attrs(scale_attributes(scales))


def variable(name: str, values: np.ndarray | float) -> xr.Variable:
    """A labelled variable, or one number of an axis."""
    label = BELTS[name]
    dims = label.dims
    if np.ndim(values) < len(dims):  # of one cell
        dims = tuple(dim for dim in dims if dim not in CELL)
    if name in OF_CONTACTS and np.ndim(values) > len(dims):
        dims = (*dims, "contact") if "time" not in dims else ("contact", *dims)
    attrs = attributes(label)
    if label.dtype is np.str_:
        attrs.pop("units")
    return xr.Variable(dims, values, attrs)


def _in_si(
    axes: Mapping[str, np.ndarray], values: Mapping[str, np.ndarray], scales: Scales
) -> dict[str, np.ndarray]:
    """Axes and variables in SI units, as far as the reference values are known."""
    if scales is NO_SCALES:
        return {}
    found: dict[str, np.ndarray] = {}
    for name, (axis, kind) in _TYPED.items():
        one = getattr(scales, kind)
        if one is not None and axis in axes:
            found[name] = typed(axes[axis], one)
    ones = {kind: scales.of(kind) for kind in ("length", "velocity", "force", "frequency")}
    frequency = ones["frequency"]
    ones["time"] = None if frequency is None else 1.0 / (2.0 * np.pi * frequency)
    for kind, names in MEASURES.items():
        for name in names:
            if name in values and ones[kind] is not None:
                found[in_si(name, kind)] = values[name] * ones[kind]
    return found

"""Arrays as labelled variables, and datasets with their global attributes."""

from collections.abc import Hashable, Mapping
from functools import lru_cache

import numpy as np
import xarray as xr
from xarray.indexes import PandasIndex

from ..model.settings import Solver
from ..model.system import System
from ..units.scales import OF_MODEL, Units
from ..version import __version__
from .labels import BESIDE, COORDINATES, REFERENCES, attributes, labels_of
from .provenance import excitation_of, made_by

#: Coordinates that are kept, and the most values on their axes together.
_KEPT_COORDINATES, _LONGEST_KEPT = 16, 4096


def coordinate(name: str, values: np.ndarray | float) -> xr.Variable:
    """Build a labelled axis, or a labelled scalar."""
    label = COORDINATES[name] if name in COORDINATES else BESIDE[name]
    dims = label.dims if np.ndim(values) else ()
    units = {} if label.texts else {"units": label.units}
    return xr.Variable(dims, values, {"long_name": label.long_name, **units})


def mass_coordinates(system: System) -> dict[str, xr.Variable]:
    """Coordinates along the masses, or along points with their names."""
    found = {"dof": coordinate("dof", np.array(system.dofs.numbers))}
    if system.by_modes:
        found["point_name"] = coordinate("point_name", np.array(system.dofs.written_labels))
    return found


def indexed(axes: Mapping[str, np.ndarray]) -> xr.Coordinates:
    """Labelled coordinates of axes, one dimension each.

    Those of short axes are kept between calls: they take an eighth of a call with four cells of one mass.
    """
    if sum(axis.size for axis in axes.values()) > _LONGEST_KEPT:
        return _coordinates(axes)
    return _kept_coordinates(tuple((name, axis.dtype.str, axis.tobytes()) for name, axis in axes.items()))


@lru_cache(maxsize=_KEPT_COORDINATES)
def _kept_coordinates(axes: tuple[tuple[str, str, bytes], ...]) -> xr.Coordinates:
    """Coordinates of axes with these names, types and values; a dataset takes copies of them."""
    return _coordinates({name: np.frombuffer(values, dtype) for name, dtype, values in axes})


def _coordinates(axes: Mapping[str, np.ndarray]) -> xr.Coordinates:
    indexes: dict[str, PandasIndex] = {}
    variables: dict[Hashable, xr.Variable] = {}
    for name, values in axes.items():
        indexes[name] = PandasIndex(values, name)
        variables |= indexes[name].create_variables({name: coordinate(name, values)})
    return xr.Coordinates(variables, indexes=indexes)


def coordinate_of_study(dim: str, meaning: str, values: np.ndarray) -> xr.Variable:
    """Build an axis of a study, or a coordinate along it: values of a parameter, or points counted from 0."""
    return xr.Variable((dim,), values, {"long_name": meaning, "units": "1"})


def label_variable(name: str, values: np.ndarray | float, what: str = "") -> xr.Variable:
    """Build a labelled variable; for a single cell without the dimensions of cells.  The values are not
    copied.

    what : kind of its dataset, see `labels_of`
    """
    label = labels_of(what)[name]
    codes = [code.value for code in label.codes]
    most = sum(codes) if label.flags == "flag_masks" else codes[-1] if codes else np.inf
    if label.also and np.size(values) and np.max(values) > most:
        label = label._replace(codes=(*label.codes, *label.also))
    attrs = attributes(label)
    if label.dtype is np.str_:
        attrs.pop("units")
    return xr.Variable(label.dims[len(label.dims) - np.ndim(values) :], values, attrs)


def stamp(
    ds: xr.Dataset,
    function: str,
    title: str,
    system: System,
    axes: Mapping[str, np.ndarray | float],
    solver: Solver | None = None,
    curves: Mapping[str, object] | None = None,
    study: Mapping[str, object] | None = None,
    units: Units | None = None,
) -> xr.Dataset:
    """Add the global attributes of a dataset that a function of the package computed on these axes."""
    hertz = units is not None and units.natural_frequency == OF_MODEL
    ds.attrs = {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"frictionmap {__version__}",
        "references": REFERENCES,
        "system": system.describe(),
        "excitation": excitation_of(system),
        **(system.costs(np.atleast_1d(axes["r"]), hertz) if "r" in axes else {}),
        **made_by(function, title, system, axes, solver, curves, study, units),
    }
    return ds

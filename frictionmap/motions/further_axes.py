"""Motions and spectra along further axes: those at all points in one dataset."""

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import SCALES
from ..datasets.motion_labels import motion_labels
from ..datasets.variables import coordinate_of_study
from ..errors import InputError
from ..jobs import Progress
from ..model.variations import Variations

#: Values of variables beyond the end of shorter motions; else NaN, or 0 of codes and numbers of contacts.
_BEYOND = {"event_kind": -1}

#: Axes of spectra: the argument of each, what it is, and its least value.
OF_SPECTRA = {
    "damping_ratios": ("damping", "damping ratio"),
    "contact_stiffness": ("contact_stiffness", "stiffness of the contact, over that of the mass's spring"),
}


def axis_coordinates(variations: Variations) -> dict[str, xr.Variable]:
    """Coordinates of the axes: a parameter that varies alone, or a counter with its parameters."""
    coords: dict[str, xr.Variable] = {}
    for axis in variations.axes:
        if axis.name in motion_labels():
            raise InputError(
                f"cannot name a further axis {axis.name}: motions have this name already; use another one"
            )
        if axis.zipped:
            coords[axis.name] = coordinate_of_study(
                axis.name, "points of several numbers", np.arange(axis.size)
            )
        for number, values in zip(axis.numbers, axis.values, strict=True):
            coords[number.dimension] = coordinate_of_study(axis.name, number.meaning, values)
    return coords


def part_of_progress(progress: Progress | None, done: int, count: int) -> Progress | None:
    """Progress of one point of `count`, of which `done` are done."""
    if progress is None:
        return None
    return lambda spent, total: progress(done * total + spent, count * total)


def stacked(found: Sequence[xr.Dataset], sizes: Mapping[str, int]) -> xr.Dataset:
    """Datasets of all points as one, the last axis fastest; shorter motions are padded at their end.

    The times of the samples are those of the records, and go on in equal steps after them.

    sizes : of the axes
    """
    longest = max(found, key=lambda ds: ds.sizes.get("time", 0))
    lengths = {dim: max(ds.sizes[dim] for ds in found) for dim in ("time", "event") if dim in longest.dims}
    variables = {}
    for name, one in found[0].data_vars.items():
        values = np.array([_padded(ds[name].variable, str(name), lengths) for ds in found])
        values = values.reshape(*sizes.values(), *values.shape[1:])
        variables[name] = xr.Variable((*sizes, *one.dims), values, one.attrs)
    first = found[0].attrs
    differ = [
        name for name in SCALES.values() if any(one.attrs.get(name) != first.get(name) for one in found)
    ]
    attrs = {name: value for name, value in first.items() if name not in differ}
    return xr.Dataset(variables, longest.coords, attrs)


def _padded(one: xr.Variable, name: str, lengths: Mapping[str, int]) -> np.ndarray:
    widths = [(0, lengths.get(str(dim), size) - size) for dim, size in one.sizes.items()]
    fill = _BEYOND.get(name, np.nan if one.dtype.kind == "f" else 0)
    return np.pad(one.values, widths, constant_values=fill)


def spectra_along(axes: Any, ask: Callable[..., xr.Dataset], progress: Progress | None = None) -> xr.Dataset:
    """Spectra at all points of axes; `ask` takes the arguments of a point, and its progress.

    Raises
    ------
    InputError
        An axis is none of spectra, or its values are invalid.
    """
    if not isinstance(axes, Mapping) or not axes:
        raise InputError("axes", f"must be a mapping with at least one axis; got {checks.one_line(axes)}")
    for name in axes:
        checks.choice(name, "axes", tuple(OF_SPECTRA))
    values = {name: checks.axis(given, f"axes.{name}", least=0.0) for name, given in axes.items()}
    points = list(product(*values.values()))
    found = [
        ask(
            **{OF_SPECTRA[name][0]: float(one) for name, one in zip(values, point, strict=True)},
            progress=part_of_progress(progress, done, len(points)),
        )
        for done, point in enumerate(points)
    ]
    ds = stacked(found, {name: one.size for name, one in values.items()})
    if "damping_ratios" in values:
        del ds.attrs["damping"]
    coords = {name: coordinate_of_study(name, OF_SPECTRA[name][1], one) for name, one in values.items()}
    return ds.assign_coords(coords)

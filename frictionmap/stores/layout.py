"""The arrays of a store: dimensions, types, chunks; a batch of blocks is one chunk of every variable."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..datasets.labels import LABELS, MARKS
from ..datasets.physical import physical_axes
from ..datasets.variables import coordinate
from .study import Batch, Study


class Array(NamedTuple):
    """Layout of an array of a store."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    chunks: tuple[int, ...]
    dtype: np.dtype
    fill: Any
    attributes: Mapping[str, Any]


def arrays_of(study: Study, sample: xr.Dataset) -> dict[str, Array]:
    """The variables of a store, by one cell of it."""
    dims = tuple(axis.name for axis in study.variations.axes)
    sizes = dict(zip(dims, study.variations.shape, strict=True))
    sizes |= {"mu": study.mu.size, "r": study.r.size, "beta": study.beta.size, "dof": study.system.n}
    sizes |= {str(dim): size for dim, size in sample.sizes.items() if dim not in sizes}
    further = {name: variable.dims for name, variable in study.coordinates().items() if name not in dims}
    further |= {name: variable.dims for name, variable in _physical(study).items()}
    arrays = {}
    for name, variable in sample.data_vars.items():
        own = (*dims, *map(str, variable.dims))
        with_axes = [name for name, dims_of_it in further.items() if set(dims_of_it) <= set(own)]
        beside = {"coordinates": " ".join(with_axes)} if with_axes else {}  # CF: what goes with an axis
        chunk = dict(zip((*dims, "mu"), study.together, strict=False)) | {"r": study.rows}
        fill = LABELS[str(name)].unresolved if "beta" in LABELS[str(name)].dims else np.nan
        if variable.dtype.kind in "iu" and np.isnan(fill):
            fill = 0
        arrays[str(name)] = Array(
            own, tuple(sizes[dim] for dim in own), tuple(chunk.get(dim, sizes[dim]) for dim in own),
            variable.dtype, variable.dtype.type(fill), plain(variable.attrs) | beside,
        )  # fmt: skip
    marks = {"long_name": "1 if the block of rows is computed; the others hold no results yet"}
    arrays[MARKS] = Array(
        (*dims, "mu", "row_block"),
        study.shape,
        study.together,
        np.dtype(np.uint8),
        np.uint8(0),
        marks,
    )
    return arrays


def coordinates_of(study: Study, sample: xr.Dataset) -> dict[str, xr.Variable]:
    """The axes of a store."""
    grid = {name: coordinate(name, getattr(study, name)) for name in ("mu", "r", "beta")}
    own = ("dof", "contact", "contact_name")
    further = {name: sample[name].variable for name in own if name in sample.coords}
    return study.coordinates() | grid | _physical(study) | further


def _physical(study: Study) -> dict[str, xr.Variable]:
    """The axes r and beta in hertz and newtons."""
    return physical_axes({"r": study.r, "beta": study.beta}, study.scales)


def plain(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Convert attributes to types of JSON."""
    return {
        str(name): value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
        for name, value in attributes.items()
    }


def region(study: Study, batch: Batch, array: Array) -> tuple[slice, ...]:
    """Slices of an array that a batch fills."""
    axes = (*(axis.name for axis in study.variations.axes), "mu", "row_block")
    where = dict(zip(axes, batch.places, strict=True)) | {"r": study.frequencies(batch)}
    return tuple(where.get(dim, slice(None)) for dim in array.dims)


def chunk(where: tuple[slice, ...], array: Array) -> tuple[int, ...]:
    """Index of the chunk of an array at some slices."""
    return tuple((part.start or 0) // size for part, size in zip(where, array.chunks, strict=True))

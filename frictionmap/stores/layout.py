"""The arrays of a store: dimensions, types, chunks; a batch of blocks is one chunk of every variable."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..datasets.labels import MARKS
from .contents import Batch, Contents


class Array(NamedTuple):
    """Layout of an array of a store."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    chunks: tuple[int, ...]
    dtype: np.dtype
    fill: Any
    attributes: Mapping[str, Any]


def arrays_of(contents: Contents) -> dict[str, Array]:
    """The variables of a store, and its marks."""
    sample, outer = contents.sample, tuple(contents.outer)
    sizes = {str(dim): size for dim, size in sample.sizes.items()} | contents.sizes
    chunk = dict(zip(outer, contents.together, strict=False)) | {contents.row_axis: contents.rows}
    beside = contents.companions()
    arrays = {}
    for name, variable in sample.data_vars.items():
        own = (*contents.added, *map(str, variable.dims))
        with_axes = [name for name, dims in beside.items() if set(dims) <= set(own)]
        related = {"coordinates": " ".join(with_axes)} if with_axes else {}  # CF: what goes with an axis
        fill = contents.fill_value(str(name))
        if variable.dtype.kind in "iu" and np.isnan(fill):
            fill = 0
        arrays[str(name)] = Array(
            own, tuple(sizes[dim] for dim in own), tuple(chunk.get(dim, sizes[dim]) for dim in own),
            variable.dtype, variable.dtype.type(fill), plain(variable.attrs) | related,
        )  # fmt: skip
    marks = {"long_name": "1 if the block of rows is computed; the others hold no results yet"}
    arrays[MARKS] = Array(
        (*outer, "row_block"), contents.shape, contents.together, np.dtype(np.uint8), np.uint8(0), marks
    )
    return arrays


def plain(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Convert attributes to types of JSON."""
    return {
        str(name): value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
        for name, value in attributes.items()
    }


def region(contents: Contents, batch: Batch, array: Array) -> tuple[slice, ...]:
    """Slices of an array that a batch fills."""
    where = dict(zip((*contents.outer, "row_block"), batch.places, strict=True))
    where[contents.row_axis] = contents.rows_of(batch)
    return tuple(where.get(dim, slice(None)) for dim in array.dims)


def chunk(where: tuple[slice, ...], array: Array) -> tuple[int, ...]:
    """Index of the chunk of an array at some slices."""
    return tuple((part.start or 0) // size for part, size in zip(where, array.chunks, strict=True))

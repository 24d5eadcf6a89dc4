"""Malformed files: a NetCDF file as a tree in memory, changed at random and written again."""

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from frictionmap import InputError
from frictionmap.files.reading import read
from frictionmap.files.summary import describe_file


@dataclass
class Variable:
    """One variable as netCDF4 knows it."""

    dims: list[str]
    values: np.ndarray
    attrs: dict[str, Any]


@dataclass
class File:
    """All of a file."""

    sizes: dict[str, int]
    variables: dict[str, Variable]
    attrs: dict[str, Any]


def load(path: Path) -> File:
    """A file as a tree."""
    with netCDF4.Dataset(path) as raw:
        raw.set_auto_maskandscale(False)
        return File(
            {name: dim.size for name, dim in raw.dimensions.items()},
            {
                name: Variable(
                    list(v.dimensions), np.asarray(v[...]), {a: v.getncattr(a) for a in v.ncattrs()}
                )
                for name, v in raw.variables.items()
            },
            {name: raw.getncattr(name) for name in raw.ncattrs()},
        )


def save(file: File, path: Path) -> None:
    """Write a tree as far as the library lets it; sizes are those that the first variable needs."""
    path.unlink(missing_ok=True)
    with netCDF4.Dataset(path, "w") as raw:
        for name, size in file.sizes.items():
            raw.createDimension(name, size)
        for name, variable in file.variables.items():
            fill = variable.attrs.pop("_FillValue", None)
            fill = fill if np.isscalar(fill) and variable.values.dtype.kind in "iuf" else None
            made = raw.createVariable(name, _type(raw, variable.values), variable.dims, fill_value=fill)
            made.set_auto_maskandscale(False)
            if variable.values.size:
                made[...] = variable.values
            made.setncatts(variable.attrs)
        raw.setncatts(file.attrs)


def _type(raw: netCDF4.Dataset, values: np.ndarray) -> Any:
    if values.dtype.kind in "OU":
        return str
    if values.dtype.kind == "V" and values.dtype.names:
        return raw.createCompoundType(values.dtype, f"pair{len(raw.cmptypes)}")
    return values.dtype


Mutation = Callable[[np.random.Generator, File], None]

#: What an attribute or a fill value may be changed into.
_ODD: list[Any] = [
    0, -1, 2.5, float("nan"), "", "x", "days since never", "seconds", "\x1b[2J", "é" * 300, "0 1 2",
    np.int8(3), np.float32(0.5), [1.0, 2.0], [7], np.array([1, 2, 3], "i1"), ["text", "list"],
]  # fmt: skip
_NAMES = [
    "units", "flag_values", "flag_masks", "flag_meanings", "long_name", "scale_factor", "add_offset",
    "_FillValue", "missing_value", "calendar", "coordinates", "dtype", "_Unsigned", "valid_range", "bounds",
    "_Encoding", "cell_methods",
]  # fmt: skip
_VALUES = [np.nan, np.inf, -np.inf, -1, 7, 127, 1e300, -1e-9, 0.5, 1e9]
_TYPES = ["i1", "u1", "i2", "i4", "u8", "f4", "f8", ">f8", "S1", "U", "pair", "f4"]


def _pick(rng: np.random.Generator, items: Any) -> Any:
    listed = list(items)
    return listed[rng.integers(len(listed))]


def _variable(rng: np.random.Generator, file: File) -> Variable:
    return file.variables[_pick(rng, file.variables)]


def _drop_variable(rng: np.random.Generator, file: File) -> None:
    del file.variables[_pick(rng, file.variables)]


def _rename_variable(rng: np.random.Generator, file: File) -> None:
    name = _pick(rng, file.variables)
    file.variables[_pick(rng, [*file.variables, "R", "beta", "tau", "regime", "x", "status"])] = (
        file.variables.pop(name)
    )


def _rename_dimension(rng: np.random.Generator, file: File) -> None:
    old, new = _pick(rng, file.sizes), _pick(rng, ["q", "tau", "mu", "dof", "event"])
    if new not in file.sizes:
        file.sizes[new] = file.sizes.pop(old)
        for variable in file.variables.values():
            variable.dims = [new if dim == old else dim for dim in variable.dims]


def _resize(rng: np.random.Generator, file: File) -> None:
    dim, size = _pick(rng, file.sizes), int(_pick(rng, [0, 1, 2, 17]))
    file.sizes[dim] = size
    for variable in file.variables.values():
        if dim in variable.dims and (variable.values.size or not size):
            indices = np.arange(size) % max(1, variable.values.shape[variable.dims.index(dim)])
            variable.values = np.take(variable.values, indices, axis=variable.dims.index(dim))


def _swap_dimensions(rng: np.random.Generator, file: File) -> None:
    variable = _variable(rng, file)
    order = rng.permutation(len(variable.dims))
    variable.values = variable.values.transpose(order)
    if rng.random() < 0.5:
        variable.dims = [variable.dims[k] for k in order]
    else:
        _fit(variable, file)


def _fit(variable: Variable, file: File) -> None:
    """The values in the shape of the dimensions, whatever they then are."""
    variable.values = np.resize(variable.values, [file.sizes[dim] for dim in variable.dims])


def _other_dimensions(rng: np.random.Generator, file: File) -> None:
    variable = _variable(rng, file)
    count = int(rng.integers(0, 4))
    variable.dims = [_pick(rng, file.sizes) for _ in range(count)]
    _fit(variable, file)


def _retype(rng: np.random.Generator, file: File) -> None:
    variable, kind = _variable(rng, file), _pick(rng, _TYPES)
    if variable.values.dtype.kind not in "iuf":
        return
    with np.errstate(all="ignore"):
        if kind == "U":
            variable.values = variable.values.astype(str).astype(object)
        elif kind == "pair":
            values = np.zeros(variable.values.shape, [("real", "f8"), ("imag", "f8")])
            values["real"] = variable.values
            variable.values = values
        else:
            variable.values = variable.values.astype(kind)


def _set_value(rng: np.random.Generator, file: File) -> None:
    variable = _variable(rng, file)
    if variable.values.size and variable.values.dtype.kind in "iuf":
        with np.errstate(all="ignore"):
            value = np.asarray(_pick(rng, _VALUES)).astype(variable.values.dtype)
        variable.values = variable.values.copy()
        variable.values.flat[rng.integers(variable.values.size)] = value


def _shuffle(rng: np.random.Generator, file: File) -> None:
    variable = _variable(rng, file)
    variable.values = rng.permutation(variable.values.ravel()).reshape(variable.values.shape)


def _change_attribute(rng: np.random.Generator, file: File) -> None:
    attrs = file.attrs if rng.random() < 0.3 else _variable(rng, file).attrs
    attrs[_pick(rng, [*attrs, *_NAMES])] = _pick(rng, _ODD)


def _drop_attribute(rng: np.random.Generator, file: File) -> None:
    attrs = file.attrs if rng.random() < 0.3 else _variable(rng, file).attrs
    if attrs:
        del attrs[_pick(rng, attrs)]


MUTATIONS: tuple[Mutation, ...] = (
    _drop_variable, _rename_variable, _rename_dimension, _resize, _swap_dimensions, _other_dimensions,
    _retype, _set_value, _shuffle, _change_attribute, _drop_attribute,
)  # fmt: skip


def write_mutant(rng: np.random.Generator, source: Path, target: Path) -> str:
    """Write a copy of a file with one to three things changed; their names, or "" if it cannot be written."""
    file = load(source)
    chosen = [_pick(rng, MUTATIONS) for _ in range(int(rng.integers(1, 4)))]
    try:
        for mutation in chosen:
            mutation(rng, file)
        save(file, target)
    except (RuntimeError, ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError):
        return ""  # the library refuses to write such a thing
    return ", ".join(mutation.__name__.strip("_") for mutation in chosen)


def flip_bytes(rng: np.random.Generator, content: bytes) -> bytes:
    """A file with one to four bytes changed."""
    changed = bytearray(content)
    for _ in range(int(rng.integers(1, 5))):
        changed[rng.integers(len(changed))] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def refused(source: Path, path: Path, seed: int) -> int:
    """How many of 30 mutants of a file are refused, each in one line that names the file."""
    rng = np.random.default_rng(seed)
    count = 0
    for index in range(30):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            what = write_mutant(rng, source, path)
        message = _complaint(path) if what else ""
        count += bool(message)
        assert not message or re.fullmatch(rf"(file|cannot read) {re.escape(str(path))}\b.*", message), (
            index,
            what,
        )
    return count


def _complaint(path: Path) -> str:
    """What is wrong with a file; "" if nothing is."""
    try:
        describe_file(read(path))
    except InputError as error:
        return str(error)
    return ""

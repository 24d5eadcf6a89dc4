"""Content of a NetCDF file in memory, to be changed and written again."""

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import netCDF4
import numpy as np

#: What numpy, xarray and netCDF4 raise where a change cannot be made, or a file not be written.
CANNOT = (ValueError, TypeError, RuntimeError, LookupError, AttributeError, OverflowError, OSError)


@dataclass
class Variable:
    """One variable of a file, in memory."""

    dims: tuple[str, ...]
    data: np.ndarray
    attrs: dict = field(default_factory=dict)


@dataclass
class Content:
    """A complete file, in memory."""

    variables: dict[str, Variable]
    attrs: dict

    @classmethod
    def of(cls, path: Path) -> "Content":
        """Read a file as it is, without masks and scales."""
        with netCDF4.Dataset(path) as file:
            file.set_auto_maskandscale(False)
            variables = {
                name: Variable(
                    v.dimensions, np.asarray(v[...]), {key: v.getncattr(key) for key in v.ncattrs()}
                )
                for name, v in file.variables.items()
            }
            return cls(variables, {key: file.getncattr(key) for key in file.ncattrs()})

    def write(self, path: Path, kind: str = "NETCDF4") -> None:
        """Write the variables that the library accepts; a dimension with two sizes gets two names."""
        with netCDF4.Dataset(path, "w", format=kind) as file:
            for name, variable in self.variables.items():
                _write_variable(file, name, variable)
            for key, value in self.attrs.items():
                file.setncattr(key, value)


def _write_variable(file: netCDF4.Dataset, name: str, variable: Variable) -> None:
    data = np.asarray(variable.data)
    dims = []
    for dim, size in zip(variable.dims, data.shape, strict=True):
        named = dim
        while (named in file.dimensions and len(file.dimensions[named]) != size) or named in dims:
            named += "_"
        if named not in file.dimensions:
            file.createDimension(named, size)
        dims.append(named)
    kind = str if data.dtype.kind in "UO" else data.dtype
    attrs = dict(variable.attrs)
    made = file.createVariable(name, kind, dims, fill_value=attrs.pop("_FillValue", None))
    made.set_auto_maskandscale(False)
    made[...] = data.astype(object) if kind is str else data
    for key, value in attrs.items():
        made.setncattr(key, value)


#: Changes a content, and says how in words.
Mutation = Callable[[Content, random.Random], str]


def pick(content: Content, rng: random.Random, least_dims: int = 0) -> str:
    """Name of a random variable."""
    return rng.choice([name for name, v in content.variables.items() if len(v.dims) >= least_dims])

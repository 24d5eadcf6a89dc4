"""Reading of files: checks against the schema, standard form."""

import contextlib
import importlib.util
import os
import stat
import traceback
import warnings
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import (
    BESIDE,
    CELL,
    CONTACT_TRACES,
    COORDINATES,
    CURVES,
    LABELS,
    MARKS,
    MEASURE_OF,
    OLDER_NAMES,
    PER_CONTACT,
    in_si,
    labels_of,
    with_contact,
)
from ..datasets.physical import in_si_too
from ..datasets.schema import (
    check_structure,
    checked_values,
    in_brackets,
    is_own,
    kind,
    placed,
    standard_dims,
    with_current_names,
)
from ..datasets.variables import coordinate, label_variable
from ..errors import InputError, naming
from .belts import belts_form
from .checksums import RECORD, attributes_of, changed_description, damaged_chunk
from .config import command_for, parse
from .designs import design_form
from .estimates import estimates_form
from .motions import motions_form
from .slices import choose, further_axes

__all__ = ["kind", "opened", "read", "standard_form"]

_RATIOS_OF_CONTACTS = {
    *PER_CONTACT,
    *CONTACT_TRACES,
    *(old for old, new in OLDER_NAMES["response"].items() if new in CONTACT_TRACES),
}
#: Variables that have one value per contact where there are several.
_OF_CONTACTS = _RATIOS_OF_CONTACTS | {
    in_si(name, measure) for name, measure in MEASURE_OF.items() if name in _RATIOS_OF_CONTACTS
}


def read(
    path: Path,
    only: Mapping[str, Collection[str]] | None = None,
    at: Mapping[str, float] | None = None,
    *,
    contacts: bool = False,
) -> xr.Dataset:
    """Read a file or a store that this package wrote, or a slice that xarray wrote (nothing is kept open).

    Of our variables those that `only` names for the file's kind, if they are there; by default all.  Of a
    file with further axes the point `at` these values.  Of a file with several contacts, none of which `at`
    names, what all contacts share; with `contacts` also the values of each contact.

    Returns
    -------
    xarray.Dataset
        In `standard_form`.

    Raises
    ------
    InputError
        The file cannot be read, is not ours, or holds what it must not; one line that names the file.
    """
    with opened(path) as ds:
        ds = _load(path, ds, only, at or {}, contacts)
    with naming(f"file {path}"):
        return standard_form(ds)


@contextlib.contextmanager
def opened(path: Path) -> Iterator[xr.Dataset]:
    """Open a file or store for the length of the context; values are read when used.

    Raises
    ------
    InputError
        There is none, it is protected or not ours, zarr is wanted and missing; or the file is damaged where
        it is read.
        Other exceptions of the body of the context are passed on.
    """
    store = _is_file(path / "zarr.json")
    if not store and not _is_file(path):
        wrong = "is not a file" if path.exists() else "does not exist"
        raise InputError(f"cannot read {path}: it {wrong}; give a file written by frictionmap")
    if path.suffix == ".toml":
        raise InputError(
            f"cannot read results from {path}: it is a configuration; compute it first, "
            f"e.g. frictionmap {_command_of(path)} {path}"
        )
    # no variable of the package is a time, even with such units
    options: dict = {"engine": "netcdf4"}
    if store:
        if importlib.util.find_spec("zarr") is None:
            raise InputError(
                f"cannot read {path}: zarr is not installed; run pip install 'frictionmap[zarr]'"
            )
        options = {"engine": "zarr", "consolidated": False, "chunks": None}
    damaged = _damaged_store if store else _damaged
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a malformed file; its error is reported below
        if store:
            _check_described(path)
        try:
            ds = xr.open_dataset(path, decode_times=False, **options)
        except Exception as error:  # the libraries raise anything over a file that is not what they expect
            raise damaged(path, error) from None
        with ds:
            _check_ours(path, ds)
            ds.attrs.pop(RECORD, None)
            try:
                yield ds
            except Exception as error:
                if not _from_the_file(error):
                    raise
                raise damaged(path, error) from None


def _command_of(path: Path) -> str:
    """The command that computes from a configuration; map where it cannot be read."""
    try:
        return command_for(parse(path.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return "map"


def _is_file(path: Path) -> bool:
    try:
        return stat.S_ISREG(os.stat(path).st_mode)
    except PermissionError:
        raise _protected(path) from None
    except OSError:
        return False


def _protected(path: Path) -> InputError:
    return InputError(f"cannot read {path}: it is read-protected; change its permissions")


def _damaged(path: Path, error: Exception) -> InputError:
    """Return the error for a file that a library could not read."""
    if isinstance(error, PermissionError):
        return _protected(Path(error.filename or path))
    return InputError(
        f"cannot read {path}: it is damaged or not NetCDF "
        f"({checks.one_line(error) if not str(error) else error}); give a file written by frictionmap"
    )


def _check_described(path: Path) -> None:
    """Refuse a store of which a file that describes it has changed since it was written."""
    try:
        changed = changed_description(path, attributes_of(path))
    except OSError as error:
        raise _damaged(path, error) from None
    if changed is not None:
        raise InputError(f"cannot read {path}: {changed} is damaged; compute the store again")


def _damaged_store(path: Path, error: Exception) -> InputError:
    """Return the error for a store that the library could not read, with the file that is damaged."""
    if isinstance(error, PermissionError) or (file := damaged_chunk(path)) is None:
        return _damaged(path, error)
    return InputError(
        f"cannot read {path}: {file} is damaged; repeat the command that made the store, which computes its "
        f"block again"
    )


def _from_the_file(error: Exception) -> bool:
    """Whether it was raised where values are read from a file, of which xarray reads no more than is used."""
    if isinstance(error, MemoryError):  # says nothing of the file
        return False
    modules = (str(frame.f_globals.get("__name__")) for frame, _ in traceback.walk_tb(error.__traceback__))
    return any(name.startswith(("xarray.backends.", "xarray.coding.")) for name in modules)


def _check_ours(path: Path, ds: xr.Dataset) -> None:
    source = ds.attrs.get("source", "not given")
    ours = LABELS.keys() & ds.variables.keys() or is_own(kind(ds))
    if not str(source).startswith("frictionmap") or not ours:
        raise InputError(f"cannot read {path}: its source is {source!r}; give a file written by frictionmap")


def _load(
    path: Path,
    ds: xr.Dataset,
    only: Mapping[str, Collection[str]] | None,
    at: Mapping[str, float],
    contacts: bool,
) -> xr.Dataset:
    """Load the wanted variables of a file, after all other checks."""
    in_store = MARKS in ds
    with naming(f"file {path}"):
        several = "contact" not in at and ds.sizes.get("contact", 0) > 1
        if several and not contacts and not is_own(kind(ds)):
            ds, several = ds.drop_dims("contact"), False
        if at or (further_axes(ds) and not is_own(kind(ds))):
            ds = choose(ds, at, "contact" if several and not is_own(kind(ds)) else None)
        if MARKS in ds and not ds[MARKS].values.all():  # boundaries of blocks to come are not known
            ds = ds.drop_vars([name for name in CURVES if name in ds])
        check_structure(ds)
    if is_own(kind(ds)):  # small, and drawn of all that is there
        return ds.load()
    wanted = LABELS if only is None else only[kind(ds)]
    part = with_current_names(_ours(ds))
    part = part.drop_vars([name for name in part.variables if name in LABELS and name not in wanted]).load()
    return in_si_too(part) if in_store and only is None else part  # a store has ratios only


def _ours(ds: xr.Dataset) -> xr.Dataset:
    """Select the variables that have a label."""
    known = {*LABELS, *COORDINATES, *BESIDE}
    return ds.drop_vars([name for name in ds.variables if name not in known])


def standard_form(ds: xr.Dataset) -> xr.Dataset:
    """A dataset of any kind (`schema.kind`), or any slice of one, in the form that it was computed in.

    Works by names.  A value of mu, r, beta or of a mass that was chosen (`isel`, `sel`) becomes an axis of
    one value again; dimensions come in their order (mu, r, beta, dof, harmonic, part), axes increase, types
    and attributes are those of `labels`.  A response is of one cell: its mu, r and beta are numbers.
    Variables may be missing; those that are not ours are left out; those under an older name only have the
    current one, too.  Variables with one value per contact have the dimension `contact`; a single contact
    that was chosen is a number.  Values are not copied where they are well as they are.

    Parameters
    ----------
    ds : xarray.Dataset

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError
        The dataset is inconsistent, or a value is invalid; the message names the variable.
    """
    if not isinstance(ds, xr.Dataset):
        raise InputError(f"ds must be an xarray.Dataset; got {type(ds).__name__}")
    check_structure(ds)
    what = kind(ds)
    if what == "estimates":
        return estimates_form(ds)
    if what == "design":
        return design_form(ds)
    if what in ("history", "spectrum"):
        return motions_form(ds)
    if what == "belt":
        return belts_form(ds)
    ds = with_current_names(_ours(ds))
    ds = ds.set_coords([name for name in (*COORDINATES, *BESIDE) if name in ds.data_vars])
    if what == "response":
        ds = ds.squeeze([dim for dim in CELL if ds.sizes.get(dim) == 1])
    if ds.sizes.get("contact") == 1:
        ds = ds.squeeze("contact")
    ds = _increasing(ds)
    variables: dict[str, xr.Variable] = {}
    used: set[str] = set()
    for name in labels_of(what):
        if name in ds.variables:
            dims = _dims_here(ds, name, what)
            values = checked_values(name, placed(ds, name, dims), what)
            variables[name] = _labelled(name, values, dims, what)
            used.update(dims)
    if what in ("map", "curves"):
        used.update(CELL)  # also if what there is depends on frequency only
    return xr.Dataset(
        variables, coords=_axes(ds, what, used) | _companion_axes(ds, what, used), attrs=ds.attrs
    )


def _dims_here(ds: xr.Dataset, name: str, what: str) -> tuple[str, ...]:
    """Dimensions of a variable in a dataset; `contact` is one of them if it has one value per contact."""
    dims = standard_dims(name, what)
    return with_contact(dims) if name in _OF_CONTACTS and "contact" in ds[name].dims else dims


def _labelled(name: str, values: np.ndarray, dims: tuple[str, ...], what: str) -> xr.Variable:
    """Label values over dimensions that may contain `contact`, which no label has."""
    if "contact" not in dims:
        return label_variable(name, values, what)
    return xr.Variable(dims, values, label_variable(name, values.max(axis=dims.index("contact")), what).attrs)


def _increasing(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with every axis increasing; one that decreases is turned round."""
    turned = {}
    for name in COORDINATES:
        if name not in ds.coords or ds[name].ndim == 0:
            continue
        if ds[name].dims != (name,):
            raise InputError(f"{name} must have the dimensions ({name}); got {in_brackets(ds[name].dims)}")
        values = checked_values(name, ds[name].values)
        if values.size == 0:
            raise InputError(f"{name} must have at least one value; got none")
        if COORDINATES[name].texts:
            continue
        if values[0] > values[-1]:
            turned[name] = slice(None, None, -1)
            values = values[::-1]
        _check_increasing(name, values)
    return ds.isel(turned)


def _check_increasing(name: str, values: np.ndarray) -> None:
    wrong = np.flatnonzero(np.diff(values) <= 0)
    if wrong.size:
        first, second = values[wrong[0]], values[wrong[0] + 1]
        raise InputError(f"{name} must be strictly increasing; got {second} after {first}")


def _companion_axes(ds: xr.Dataset, what: str, used: set[str]) -> dict[str, xr.Variable]:
    """Axes in SI units that accompany the axes in use; contacts and their names."""
    beside = {}
    for name in BESIDE:
        dims = standard_dims(name, what)
        if dims == ("contact",) and name in ds.variables and ds[name].ndim == 0:
            beside[name] = coordinate(name, checked_values(name, ds[name].values))
        elif name in ds.variables and (set(dims) <= used or not dims):
            beside[name] = coordinate(name, checked_values(name, placed(ds, name, dims), what))
    return beside


def _axes(ds: xr.Dataset, what: str, used: set[str]) -> dict[str, xr.Variable]:
    """The axes: those that are used, and what else there is."""
    axes = {}
    for name in COORDINATES:
        of_the_cell = what == "response" and name in CELL
        if name in ds.coords:
            values = checked_values(name, ds[name].values)
            if of_the_cell and values.ndim:
                raise InputError(f"a response must have one {name}; got {values.size}")
            axes[name] = coordinate(name, np.atleast_1d(values) if name in used else values)
        elif name in used or of_the_cell:
            raise InputError(f"{name} must be a coordinate; got no such coordinate")
    return axes

"""Selection of one point of the further axes of a dataset."""

import string
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import COORDINATES, labels_of
from ..datasets.motion_labels import axes_of_motions
from ..datasets.provenance import configuration
from ..datasets.schema import is_own, kind
from ..errors import InputError
from ..model.variations import Axis, Variations
from .config import Config, config_of

#: A number that was typed is that of an axis if they differ by no more than this share.
_SAME = 1e-9

#: Axes of every map, of motions and of spectra, in the order of messages.
_OWN_AXES = ("mu", "r", "beta", "record", "scale", "period")

#: Values of an axis that a message lists.
_LISTED = 8


def parse_choices(texts: Sequence[str]) -> dict[str, float]:
    """Parse selections of the command line, such as ``damping_ratios=0.01``."""
    choices: dict[str, float] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.strip()
        try:
            number = float(value)
        except ValueError:
            number = np.nan
        if not equals or not name or not np.isfinite(number):
            raise InputError(f"--at must be NAME=VALUE, such as damping_ratios=0.01; got {text!r}")
        if name in choices:
            raise InputError(f"--at {name} must be given once; got {choices[name]:g} and {number:g}")
        choices[name] = number
    return choices


def further_axes(ds: xr.Dataset) -> list[str]:
    """Dimensions of known variables beyond those of their labels; none for estimates and designs."""
    if kind(ds) in ("history", "spectrum"):
        return axes_of_motions(ds)
    if is_own(kind(ds)):
        return []
    labels = labels_of(kind(ds))
    dims = (
        str(dim)
        for name, variable in ds.variables.items()
        if name in labels
        for dim in variable.dims
        if dim not in labels[str(name)].dims and dim not in COORDINATES
    )
    return list(dict.fromkeys(dims))


def choose(
    ds: xr.Dataset, choices: Mapping[str, float], over: str | None = None, *, contacts: bool = False,
    option: str = "--over",
) -> xr.Dataset:  # fmt: skip
    """The part of a dataset with these values of its axes; further axes of one value are taken as they are.

    Title, system and configuration are those of the system there; the axis `over` of an `option` is left, and
    with `contacts` the values of all contacts unless one is chosen.

    Raises
    ------
    InputError
        There is no such axis or value, or more than one point.
    """
    further = further_axes(ds)
    valid = [*further, *(str(n) for n in ds.coords if n not in further and _further(ds, str(n), further))]
    valid += [name for name in _OWN_AXES if ds.sizes.get(name, 0) > 0]
    places: dict[str, np.ndarray] = {}
    for name, value in choices.items():
        if name not in valid:
            raise InputError(
                f"unknown axis of --at {name!r}{checks.nearest(name, valid)}; "
                f"valid: {', '.join(valid) or 'none'}"
            )
        dim, found = _found(ds, name, value)
        places[dim] = np.intersect1d(found, places[dim]) if dim in places else found
    if over is not None and over not in further:
        raise InputError(f"unknown further axis of {option} {over!r}; valid: {', '.join(further) or 'none'}")
    if over in places:
        raise InputError(
            f"cannot use --at {over} with {option} {over}: {option} takes all its points; "
            f"use --at for other axes"
        )
    point: dict[str, int] = {}
    rows: dict[str, list[int]] = {}
    left = {over, "contact"} if contacts and "contact" not in places else {over}
    chosen = [dim for dim in further if dim not in left]
    if is_own(kind(ds)):  # read whole, except for what is chosen
        chosen = [dim for dim in further if dim in places]
    for dim in (*chosen, *(dim for dim in places if dim not in further)):
        found = places.get(dim, np.arange(ds.sizes[dim]))
        if found.size != 1:
            raise InputError(
                f"cannot choose a point along {dim}: the file has {_values(ds, dim)}; give --at {dim}=VALUE, "
                f"or draw the shares of regimes over it with plot --over {dim}"
            )
        if dim in further:
            point[dim] = int(found[0])
        else:
            rows[dim] = [int(found[0])]  # an axis yet
    part = ds.isel({**point, **rows})
    parameters = {dim: place for dim, place in point.items() if dim != "contact"}  # it is one system still
    return part.assign_attrs(_point_attributes(ds, parameters)) if parameters else part


def _further(ds: xr.Dataset, name: str, further: Sequence[str]) -> bool:
    """Whether a coordinate holds numbers along one further axis."""
    return ds[name].ndim == 1 and ds[name].dims[0] in further and ds[name].dtype.kind in "iuf"


def _found(ds: xr.Dataset, name: str, value: float) -> tuple[str, np.ndarray]:
    """The dimension of an axis, and the places where it has a value."""
    values = _numbers(ds, name)
    dim = str(ds[name].dims[0]) if name in ds.coords else name
    places = np.flatnonzero(np.abs(values - value) <= _SAME * np.abs(value))
    if not places.size and values.dtype.kind in "iuf":  # as messages and summaries write it, if that is one
        alike = [k for k, own in enumerate(values) if f"{own:g}" == f"{value:g}"]
        places = np.array(alike if len(alike) == 1 else [], dtype=int)
    if not places.size:
        raise InputError(f"--at {name} must be one of {_values(ds, name)}; got {value:g}")
    return dim, places


def _numbers(ds: xr.Dataset, name: str) -> np.ndarray:
    """The values of an axis; its places where it has none."""
    return ds[name].values if name in ds.coords else np.arange(ds.sizes[name])


def _values(ds: xr.Dataset, name: str) -> str:
    """Describe the values of an axis."""
    values = _numbers(ds, name)
    if values.size > _LISTED and values.dtype.kind != "U":
        return f"{name} = {values.min():g} to {values.max():g} ({values.size} values)"
    words = [_word(value) for value in values[:_LISTED]]
    return f"{name} = {', '.join(words)}{', ...' * (values.size > _LISTED)}"


def _word(value: object) -> str:
    """Format a value of an axis; foreign files may have string axes."""
    return checks.one_line(value) if isinstance(value, str) else f"{value:g}"


def _point_attributes(ds: xr.Dataset, point: Mapping[str, int]) -> dict[str, str]:
    """Title, system and configuration of a point; the latter two are empty if unknown."""
    words = ", ".join(f"{name} = {_word(_numbers(ds, name)[place])}" for name, place in point.items())
    title = f"{ds.attrs.get('title', '')}, {words}".removeprefix(", ")
    system = text = ""
    config = _config(ds)
    if config is not None and config.variations is not None:
        left = _variations_in_file(config.variations, ds)
        if left is not None:
            left = left.chosen(point)
            axes = {"r": config.r, "beta": config.beta, "mu": config.mu}
            system = left.describe()
            text = configuration(
                title, left.system, axes, config.solver, study=left.described or None, units=config.units
            )
    return {"title": title, "system": system, "config": text}


def _variations_in_file(variations: Variations, ds: xr.Dataset) -> Variations | None:
    """The variations that a dataset has: a slice of a file has fewer values, or only one."""
    if any(number.dimension not in ds.coords for axis in variations.axes for number in axis.numbers):
        return None
    axes = [
        Axis(axis.name, axis.numbers, tuple(np.atleast_1d(ds[n.dimension].values) for n in axis.numbers))
        for axis in variations.axes
    ]
    gone = {axis.name: 0 for axis in axes if axis.name not in ds.dims}
    return Variations(variations.system, tuple(axes)).chosen(gone)


def natural(name: str) -> tuple[str, int, str]:
    """A key to sort names by: ratios_2 before ratios_10."""
    return name.rstrip(string.digits), len(name), name


def _config(ds: xr.Dataset) -> Config | None:
    try:
        return config_of(str(ds.attrs.get("config", "")), {})
    except InputError:  # matrices in a file of their own, or no configuration
        return None

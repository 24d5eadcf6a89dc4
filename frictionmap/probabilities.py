"""Probabilities over samples of an uncertain structure: shares of each regime, quantiles of boundaries."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from . import checks, regimes
from .datasets.labels import BESIDE, CELL, LABELS, MARKS, REFERENCES, SCALES, regime_of_choice
from .datasets.schema import check_structure, kind
from .datasets.variables import coordinate, label_variable
from .errors import InputError
from .files.reading import opened
from .files.slices import choose, further_axes
from .version import __version__

#: Cells of all samples that are held at a time.
_AT_ONCE = 1 << 22

#: Variables with quantiles; a contact that was chosen has a beta_stick of its own.
_OF_QUANTILES = ("beta_lim", "beta_stick", "contact_amplitude")

#: Coordinates of a contact that was chosen.
_OF_CONTACT = ("contact", "contact_name")


def shares(ds: xr.Dataset, over: str, quantiles: Sequence[float] = (0.05, 0.5, 0.95)) -> xr.Dataset:
    """Shares of each regime, and quantiles of boundaries and amplitude, over a further axis of maps.

    Parameters
    ----------
    ds : xarray.Dataset
        Maps along one further axis, as ``sweep(..., axes=...)`` returns them or a store holds them (other
        axes chosen before, with `isel` or `sel`); read part by part.  Of a store that is not finished only
        the samples that are.  Of several contacts the regimes are those of all together, or those of the
        contact that was chosen before.
    over : str
        That axis, such as ``sample``; its points count alike.
    quantiles : sequence of float
        Between 0 and 1, increasing.

    Returns
    -------
    xarray.Dataset
        `regime_share` (outcome, mu, r, beta): unresolved, permanent_sticking, stick_slip, continuous, and
        one_way_sliding where it occurs, adding up to 1; `beta_lim_quantile`, `beta_stick_quantile` (quantile,
        mu, r) and, if the maps have it for one contact, `contact_amplitude_quantile` (quantile, mu, r, beta),
        over the samples that have one (NaN: none).  Quantiles are interpolated between neighbours of the
        ordered samples.

    Raises
    ------
    InputError
        There is no such axis, there is another one, no regime, or no sample that is finished.

    Examples
    --------
    With more damping the contact begins to stop:

    >>> import frictionmap as fm
    >>> maps = fm.sweep(fm.System(), [0.8], [0.7], axes={"damping_ratios": [0.0, 0.05, 0.1, 0.5]})
    >>> found = fm.shares(maps, over="damping_ratios").regime_share.squeeze()
    >>> dict(zip(found.outcome.values.tolist(), found.values.tolist()))
    {'unresolved': 0.0, 'permanent_sticking': 0.0, 'stick_slip': 0.5, 'continuous': 0.5}
    """
    if not isinstance(ds, xr.Dataset):
        raise InputError(f"ds must be an xarray.Dataset; got {type(ds).__name__}")
    further = [name for name in further_axes(ds) if name != "contact"]
    if kind(ds) != "map" or over not in further:
        raise InputError(
            f"unknown further axis of maps {checks.one_line(over)}; valid: {', '.join(further) or 'none'}"
        )
    if len(further) > 1:
        others = ", ".join(name for name in further if name != over)
        raise InputError(
            f"cannot compute shares over {over}: ds has the further axis {others}; choose one point of it"
        )
    if regime_of_choice(ds) not in ds:
        raise InputError("cannot compute shares: ds has no variable regime; compute the map with it")
    for name in CELL:
        if name not in ds.coords:
            raise InputError(f"cannot compute shares: ds has no coordinate {name}; keep it when slicing")
    if MARKS in ds:
        ds = _finished(ds, over)
    levels = checks.axis(quantiles, "quantiles", least=0.0, most=1.0)
    names = [name for name in _OF_QUANTILES if _has(ds, name)]
    found = {f"{name}_quantile": _quantiles(ds, name, over, levels) for name in names}
    outcomes, share = _shares(ds, over)
    axes = {
        "outcome": outcomes,
        "quantile": levels,
        **{name: np.atleast_1d(ds[name].values) for name in CELL},
    }
    coords = {name: coordinate(name, values) for name, values in axes.items()}
    coords |= {name: coordinate(name, np.atleast_1d(ds[name].values)) for name in BESIDE if name in ds.coords}
    coords |= {name: ds[name].variable for name in _OF_CONTACT if name in ds.coords and not ds[name].ndim}
    kept = ("title", "system", "excitation", "config", *SCALES.values())
    attributes = {
        **{name: ds.attrs[name] for name in kept if name in ds.attrs},
        "Conventions": "CF-1.11", "source": f"frictionmap {__version__}", "references": REFERENCES,
        "samples": int(ds.sizes[over]),
    }  # fmt: skip
    return xr.Dataset({"regime_share": share, **found}, coords, attributes)


def read_shares(path: Path, over: str, choices: Mapping[str, float]) -> xr.Dataset:
    """Compute `shares` of a file or store over one axis, with `choices` on the others."""
    with opened(path) as ds:
        check_structure(ds, in_parts=True)
        return shares(choose(ds, choices, over, contacts=True), over)


def _finished(ds: xr.Dataset, over: str) -> xr.Dataset:
    """Select the samples of a store whose blocks are all computed."""
    others = [dim for dim in ds[MARKS].dims if dim != over]
    done = np.flatnonzero((ds[MARKS] != 0).all(others).values)
    if not done.size:
        raise InputError(
            f"cannot compute shares over {over}: no point of it is finished; resume the map first"
        )
    return ds.isel({over: done})


def _has(ds: xr.Dataset, name: str) -> bool:
    """Whether a dataset has a variable, for one contact or for all together."""
    return name in ds and "contact" not in ds[name].dims


def _shares(ds: xr.Dataset, over: str) -> tuple[np.ndarray, xr.Variable]:
    """Names of the regimes, that of belts only where it occurs, and the share of each."""
    counts = np.zeros((len(regimes.BELT_REGIMES), *(ds[name].size for name in CELL)), dtype=np.int64)
    for k in range(ds.sizes[over]):
        values = _along(ds[regime_of_choice(ds)].variable.isel({over: k}), CELL)
        for count, code in zip(counts, regimes.BELT_REGIMES, strict=True):
            count += values == code.value
    kept = [j for j, code in enumerate(regimes.BELT_REGIMES) if code in regimes.REGIMES or counts[j].any()]
    names = np.array([regimes.BELT_REGIMES[j].name for j in kept])
    return names, label_variable("regime_share", counts[kept] / ds.sizes[over])


def _quantiles(ds: xr.Dataset, name: str, over: str, levels: np.ndarray) -> xr.Variable:
    dims = LABELS[name].dims
    values = np.full((levels.size, *(ds[dim].size for dim in dims)), np.nan)
    of_contact = "beta_stick_contact" if name == "beta_stick" and _has(ds, "beta_stick_contact") else name
    variable = ds[of_contact].variable
    for m, rows in _parts(ds, variable.size):
        part = variable.isel(mu=slice(m, m + 1), r=rows, missing_dims="ignore")
        values[:, m : m + 1, rows] = _ordered(_along(part, (over, *dims)), levels)
    return label_variable(f"{name}_quantile", values)


def _along(variable: xr.Variable, dims: tuple[str, ...]) -> np.ndarray:
    """Values along some dimensions, of size 1 where one value was selected."""
    missing = [dim for dim in dims if dim not in variable.dims]
    return variable.set_dims([*missing, *map(str, variable.dims)]).transpose(*dims).values


def _parts(ds: xr.Dataset, size: int) -> Iterator[tuple[int, slice]]:
    """Iterate over values of mu and rows in r, so few that all their samples fit in memory."""
    step = max(1, _AT_ONCE * ds["mu"].size * ds["r"].size // max(1, size))
    for m in range(ds["mu"].size):
        for first in range(0, ds["r"].size, step):
            yield m, slice(first, first + step)


def _ordered(samples: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Quantiles along the first axis; NaN are left out, infinite ones are the largest."""
    ordered = np.sort(samples, axis=0)  # NaN last
    last = np.count_nonzero(~np.isnan(samples), axis=0) - 1
    place = levels.reshape(-1, *(1,) * last.ndim) * np.maximum(last, 0)
    low = np.floor(place).astype(np.intp)
    below = np.take_along_axis(ordered, low, axis=0)
    above = np.take_along_axis(ordered, np.minimum(low + 1, np.maximum(last, 0)), axis=0)
    share = place - low
    with np.errstate(invalid="ignore"):  # between two infinite samples
        between = np.where(share > 0.0, below + share * (above - below), below)
    return np.where(below == above, below, between)

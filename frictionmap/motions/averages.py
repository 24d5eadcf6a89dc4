"""Statistics of stationary motions beside their histories: means, variances and peaks with their errors."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import attributes
from ..datasets.motion_labels import AVERAGED, AVERAGES, CELL, MOTIONS
from ..errors import InputError
from .quantities import time_in
from .record import Record
from .statistics import stationary

_KEYS = ("start", "window", "batches")

#: Batches where none are given, as of `stationary`.
_BATCHES = 20


class Averages(NamedTuple):
    """How statistics are taken; times are in the unit of the record."""

    start: float
    window: float | None
    batches: int


def asked_averages(given: Any, unit: str | None) -> Averages | None:
    """The table `statistics`, checked; `unit` is that of the records.

    Raises
    ------
    InputError
        A key is unknown, or a value of the wrong type or out of range.
    """
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise InputError("statistics", f"must be a table of {', '.join(_KEYS)}; got {checks.one_line(given)}")
    for key in given:
        if key not in _KEYS:
            raise InputError(f"unknown key {f'statistics.{key}'!r}; valid: {', '.join(_KEYS)}")
    start = time_in(given.get("start", 0.0), "statistics.start", unit, least=0.0, above=-np.inf)
    window = given.get("window")
    return Averages(
        start, None if window is None else time_in(window, "statistics.window", unit),
        checks.whole(given.get("batches", _BATCHES), "statistics.batches", least=4),
    )  # fmt: skip


def averages_of(
    ds: xr.Dataset, asked: Averages, records: Sequence[Record], factors: Sequence[float]
) -> dict[str, xr.Variable]:
    """The statistics of all motions, from `start` to the end of the record of each.

    ds : with histories, its time in 1/omega_1
    factors : what makes the times of the records dimensionless
    """
    found: dict[str, list[np.ndarray]] = {}
    shape = tuple(ds.sizes[dim] for dim in CELL)
    for cell in np.ndindex(shape):
        record, factor = records[cell[0]], factors[cell[0]]
        one = ds.isel(dict(zip(CELL, cell, strict=True)))
        one = one.assign_coords(time=one["time"] / factor)
        inside = one["time"].values <= record.duration * (1.0 + 1e-12)  # the last sample, rounded
        one = one.isel(time=inside & np.isfinite(one["drive"].values))
        for of in (name for name in AVERAGED if name in one):
            for end, values in _statistics_of(one[of], asked).items():
                found.setdefault(f"{of}_{end}", []).append(values)
    added = {}
    for name, each in found.items():
        of = next(of for of in AVERAGED if name.startswith(f"{of}_"))
        dims = [dim for dim in ds[of].dims if dim != "time"]
        values = np.array(each).reshape(*shape, *each[0].shape)
        added[name] = xr.Variable(dims, values, attributes(MOTIONS[name]))
    return added


def _statistics_of(values: xr.DataArray, asked: Averages) -> dict[str, np.ndarray]:
    """Statistics of one quantity of one motion."""
    try:
        found = stationary(values, start=asked.start, window=asked.window, batches=asked.batches)
    except InputError as error:
        raise (error.renamed(f"statistics.{error.where}") if error.where in _KEYS else error) from None
    return {end: found[end].values for end in AVERAGES}


def describe_averages(asked: Averages) -> str:
    """How statistics are taken, for a dataset."""
    window = "of a batch" if asked.window is None else f"{asked.window:g}"
    return f"from time {asked.start:g} to the end of the record, {asked.batches} batches, window {window}"

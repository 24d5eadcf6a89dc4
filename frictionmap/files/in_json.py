"""Summary of a file as JSON, for scripts."""

import json
from typing import Any

import numpy as np
import xarray as xr

from ..datasets.labels import LABELS, regime_of_choice
from ..datasets.schema import kind
from ..regimes import NO_LOAD_REGIMES

#: Attributes of a file that the summary repeats.
_ATTRIBUTES = ("title", "system", "source", "history")


def summary_json(ds: xr.Dataset) -> str:
    """Return the kind of a file, its sizes, axes, variables and numbers of cells per regime, as JSON.

    An axis has its number of values, first and last value, and unit; a variable has its dimensions, type,
    meaning and unit.
    """
    found = {
        "kind": kind(ds),
        **{name: str(ds.attrs[name]) for name in _ATTRIBUTES if name in ds.attrs},
        "sizes": {str(name): int(size) for name, size in ds.sizes.items()},
        "axes": {str(name): _axis(ds[name]) for name in ds.dims if name in ds.coords},
        "variables": {str(name): _variable(variable) for name, variable in ds.data_vars.items()},
    }
    if (name := regime_of_choice(ds)) in ds:
        found["cells"] = _cells(ds[name])
    return json.dumps(found, indent=2, ensure_ascii=False)


def record_json(record: Any) -> str:
    """Return what a `Record` is, as JSON: samples, steps, duration, the largest sample and its time."""
    sizes = np.abs(record.values)
    steps = np.diff(record.times) if record.dt is None else np.array([record.dt])
    found = {
        "kind": "record",
        **{name: getattr(record, name) for name in ("name", "quantity", "unit", "interpolation", "source")},
        "note": record.note,
        "samples": int(sizes.size),
        "steps": {"least": float(steps.min()), "most": float(steps.max())},
        "duration": record.duration,
        "peak": float(sizes.max()) * abs(record.scale),
        "peak_time": float(record.times[sizes.argmax()]),
    }
    return json.dumps(found, indent=2, ensure_ascii=False)


def _axis(values: xr.DataArray) -> dict[str, object]:
    first, last = (values.values[index].item() for index in (0, -1))
    return {"size": int(values.size), "first": first, "last": last, "units": values.attrs.get("units", "1")}


def _variable(variable: xr.DataArray) -> dict[str, object]:
    return {
        "dimensions": [str(dim) for dim in variable.dims],
        "type": str(variable.dtype),
        "meaning": str(variable.attrs.get("long_name", "")),
        "units": str(variable.attrs.get("units", "1")),
    }


def _cells(regime: xr.DataArray) -> dict[str, int]:
    """Number of cells of every regime that occurs."""
    codes = (*LABELS["regime"].codes, *LABELS["regime"].also, *NO_LOAD_REGIMES[1:])
    counts = dict.fromkeys((code.name for code in codes), 0)
    for part in regime if regime.ndim else [regime]:  # a store may be larger than the memory
        values = part.values
        for code in codes:
            counts[code.name] += int(np.count_nonzero(values == code.value))
    return {name: count for name, count in counts.items() if count}

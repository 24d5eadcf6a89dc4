"""Free decays from the file of a rig."""

from typing import Any

import xarray as xr

from ...errors import InputError
from ...units.table import conversion
from ..decay.free_decay import free_decay
from ..decay.motion import PARAMETERS
from ..tables.columns import check_increasing, pick_columns
from ..tables.files import Table
from .rig import Kind, Rig, check_columns, with_remarks

#: Keys given in mm, for any unit of the data.
_LENGTHS = ("x_F", "X0", "centre", "base_mm")


def _free_decay(rig: Rig, table: Table) -> xr.Dataset:
    check_columns(rig, ("time", "x"))
    picked = pick_columns(table, {"time": "time", "x": "length"}, rig.columns, rig.missing)
    time, x = picked.columns["time"], picked.columns["x"]
    check_increasing(table, time, picked.rows)
    known = {
        key: value * conversion("mm", x.unit) if key in _LENGTHS else value
        for key, value in rig.known.items()
    }
    options: dict[str, Any] = dict(rig.fit)
    base, stiffness = known.pop("base_mm", None), known.pop("stiffness", None)
    try:
        ds = free_decay(
            time.values * conversion(time.unit, "s"), x.values, unit=x.unit, known=known, base=base,
            stiffness=stiffness, window=rig.data.get("window"), **options,
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"file {rig.file}, columns {time.name} and {x.name}: {error}") from None
    return with_remarks(ds, table, picked)


FREE_DECAY = Kind(
    _free_decay, PARAMETERS, known=("base_mm", "stiffness"), data=("window",), fit=("drift", "loss")
)

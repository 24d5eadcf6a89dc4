"""Free decays from the file of a rig."""

from typing import Any

import xarray as xr

from ...errors import naming
from ...files.key import Key
from ...units.table import conversion
from ..decay.free_decay import free_decay
from ..decay.motion import PARAMETERS
from ..tables.columns import check_increasing, pick_columns
from ..tables.files import Table
from .rig import (
    BASE_AMPLITUDE,
    LOSS,
    STIFFNESS,
    WINDOW,
    Kind,
    Rig,
    check_columns,
    in_unit,
    named,
    with_remarks,
)


def _free_decay(rig: Rig, table: Table) -> xr.Dataset:
    check_columns(rig, ("time", "x"))
    picked = pick_columns(table, {"time": "time", "x": "length"}, rig.columns, rig.missing)
    time, x = picked.columns["time"], picked.columns["x"]
    check_increasing(table, time, picked.rows)
    known = in_unit(rig.known, x.unit)
    options: dict[str, Any] = dict(rig.fit)
    base, stiffness = known.pop("base_mm", None), known.pop("stiffness", None)
    with naming(f"file {rig.file}, columns {time.name} and {x.name}"):
        ds = free_decay(
            time.values * conversion(time.unit, "s"), x.values, unit=x.unit, known=known, base=base,
            stiffness=stiffness, window=rig.data.get("window"), **options,
        )  # fmt: skip
    return with_remarks(ds, table, picked)


_DRIFT = Key("drift", "whether to fit a linear drift of the zero", {"type": "boolean"}, False,
             words="true or false")  # fmt: skip

FREE_DECAY = Kind(
    _free_decay, named(*PARAMETERS), known=BASE_AMPLITUDE | STIFFNESS, data=(WINDOW,), fit=(_DRIFT, LOSS)
)

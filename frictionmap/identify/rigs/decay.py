"""Free decays from the file of a rig."""

from typing import Any

import xarray as xr

from ... import checks
from ...errors import InputError, naming
from ...files.key import Key, number, several, table, word
from ...units.table import COLUMN_NAMES, UNITS, conversion
from ..decay.electronics import ELECTRONICS
from ..decay.free_decay import free_decay
from ..decay.motion import PARAMETERS
from ..decay.problem import OFFSET
from ..tables.columns import check_increasing, columns_like, pick_columns
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
    picked = pick_columns(table, {"time": "time", "x": _measured(rig, table)}, rig.columns, rig.missing)
    time, x = picked.columns["time"], picked.columns["x"]
    check_increasing(table, time, picked.rows)
    options: dict[str, Any] = {**rig.fit, **{key: rig.data[key] for key in ELECTRONICS if key in rig.data}}
    known = _known(rig, COLUMN_NAMES[x.unit])
    base, stiffness = known.pop("base_mm", None), known.pop("stiffness", None)
    with naming(f"file {rig.file}, columns {time.name} and {x.name}"):
        ds = free_decay(
            time.values * conversion(time.unit, "s"), x.values, unit=COLUMN_NAMES[x.unit], known=known,
            base=base, stiffness=stiffness, window=rig.data.get("window"), **options,
        )  # fmt: skip
        for name in rig.free or ():
            checks.choice(name, "fit.free", tuple(ds["parameter"].values.tolist()))
    return with_remarks(ds, table, picked)


def _measured(rig: Rig, table: Table) -> str:
    """What the column x measures: a length if there is one, else anything that shows a decay."""
    lengths = columns_like(table, "x", "length", rig.columns, sure=True)
    return "length" if lengths and "x" not in rig.columns else "swing"


def _known(rig: Rig, unit: str) -> dict[str, float]:
    """Numbers of [known] for data in a unit: of angles x_F and X0 are angles, as they are given."""
    measures = UNITS[unit].measures
    if measures != "angle":
        return in_unit(rig.known, unit if measures == "length" else "mm")
    if "base_mm" in rig.known:
        raise InputError("cannot use known.base_mm with angles: x_F is an angle; omit base_mm")
    return dict(rig.known)


_POSITIVE = number(above=0.0)
_LOW_PASS = table(
    {"kind": word("low-pass"), "order": {"enum": [1, 2]}, "frequency_Hz": _POSITIVE},
    ("kind", "order", "frequency_Hz"),
)

#: Keys of [data]: the filters that the signal passed.
_FILTERS = (
    Key("filter", "low-pass filter that the signal passed, of order 1, or 2 (Butterworth); default: none",
        _LOW_PASS, example='{ kind = "low-pass", order = 2, frequency_Hz = 80.0 }',
        words='{ kind = "low-pass", order = 1 or 2, frequency_Hz = a number }'),
    Key("ac_coupling_Hz", "corner frequency of the AC coupling that the signal passed, Hz; default: none",
        _POSITIVE, example="0.5"),
    Key("mask_s", "times before and after every turning point that are left out, s: half the length of an "
        "unknown filter of linear phase (FIR)", several(number(least=0.0), 2, maxItems=2),
        example="[0.012, 0.012]", words="[before, after]"),
)  # fmt: skip
_DRIFT = Key("drift", "whether to fit a linear drift of the zero", {"type": "boolean"}, False,
             words="true or false")  # fmt: skip

FREE_DECAY = Kind(
    _free_decay,
    named(*PARAMETERS, OFFSET),
    known=BASE_AMPLITUDE | STIFFNESS,
    data=(WINDOW, *_FILTERS),
    fit=(_DRIFT, LOSS),
)

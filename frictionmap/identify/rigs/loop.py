"""Damper tests from the file of a rig."""

from typing import Any

import xarray as xr

from ...errors import naming
from ...files.key import Key, number, several
from ...units.table import conversion
from ..loop.loop import FACTORS, FITTABLE, MEANINGS, loop
from ..parameters import Parameter
from ..tables.columns import check_increasing, columns_like, pick_columns
from ..tables.files import Table
from .rig import WINDOW, Kind, Rig, check_columns, with_remarks

_MOTIONS = {"displacement": ("length", "mm"), "velocity": ("velocity", "mm_s")}

_EXAMPLES = {
    "friction": "120.0", "contact_stiffness": "400.0", "mu": "1.0", "backlash": "0.3", "asymmetry": "0.0",
    "parallel_stiffness": "5.0", "slope": "0.5", "mass": "2.5", "delay": "0.003", "offset": "0.0",
    "drift": "0.0",
} | dict.fromkeys(FACTORS, "0.8")  # fmt: skip

#: Units of [known] in which a text may be.
_UNITS = ("N", "N/mm", "mm", "kg", "s")

SPEEDS = "law_speeds_mm_s"


def _parameter(name: str) -> Parameter:
    meaning, unit = MEANINGS[name]
    words = meaning if unit == "1" else f"{meaning}, {unit}"
    return Parameter(words, _EXAMPLES[name], unit if unit in _UNITS else "")


def _loop(rig: Rig, table: Table) -> xr.Dataset:
    check_columns(rig, ("time", *_MOTIONS, "force"))
    velocity = "velocity" in rig.columns or (
        not ("displacement" in rig.columns or columns_like(table, "displacement", "length", rig.columns))
        and bool(columns_like(table, "velocity", "velocity", rig.columns))
    )
    role = "velocity" if velocity else "displacement"
    measures, unit = _MOTIONS[role]
    wanted = {"time": "time", role: measures, "force": "force"}
    picked = pick_columns(table, wanted, rig.columns, rig.missing)
    time, moved, force = (picked.columns[one] for one in wanted)
    check_increasing(table, time, picked.rows)
    given: dict[str, Any] = {
        role: moved.values * conversion(moved.unit, unit),
        "law_speeds": rig.data.get(SPEEDS),
    }
    with naming(f"file {rig.file}, columns {time.name}, {moved.name} and {force.name}"):
        ds = loop(
            time.values * conversion(time.unit, "s"), force.values * conversion(force.unit, "N"),
            known=rig.known, free=rig.free, window=rig.data.get("window"),
            **given,
        )  # fmt: skip
    return with_remarks(ds, table, picked)


LOOP = Kind(
    _loop,
    {name: _parameter(name) for name in FITTABLE},
    data=(WINDOW,),
    examples={
        "columns": '{ time = "time_s", displacement = "displacement_mm", force = "force_N" }',
        "free": '["friction", "contact_stiffness", "offset"]',
    },
    lists=(
        Key(
            SPEEDS, "knots of the speed law, increasing from 0, mm/s", several(number()),
            example="[0.0, 15.0, 60.0]", words="a list of numbers",
        ),
    ),
    optional=FITTABLE,
)  # fmt: skip

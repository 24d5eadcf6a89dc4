"""Records of any shape from the file of a rig."""

from typing import Any

import xarray as xr

from ... import checks
from ...errors import naming
from ...files.config import unknown_key
from ...files.key import Key, number, word
from ...model.system import DAMPING_REFERENCES
from ...units.table import COLUMN_NAMES, conversion
from ..history.history import history
from ..tables.columns import check_increasing, pick_columns
from ..tables.files import Table
from ..time_series.motion import CONTACTS
from .rig import Rig, check_columns, with_remarks

#: How a record is fitted.
METHODS = ("steady", "history")

_EXCITATIONS = ("base", "force")

#: Keys of [system] of a record of any shape.
_SYSTEM = ("contact", "damping_reference", "excitation", "contact_masses")

#: Keys of [fit] of records of any shape only.
OPTIONS = (
    Key("sigma_x", "history: noise of x, in the unit of its column; default: from the residuals",
        number(above=0.0), example="0.02"),
    Key("sigma_drive", "history: noise of the base or force, in the unit of its column; 0: none; "
        "default: from the spectrum above the band", number(least=0.0), example="0.004"),
    Key("gate_N", "history: the force is 0 where it is below this", number(above=0.0), example="2.0"),
    Key("mask_samples", "history: samples left out on either side of events; default: 2 of accelerations, "
        "else 0", {"type": "integer", "minimum": 0}, example="2"),
)  # fmt: skip

#: Arguments of `history` that have other names than their keys, which state a unit.
_ARGUMENTS = {"gate_N": "gate"}

METHOD = Key(
    "method", "steady motion, or the motion under a base or force of any shape from its initial state",
    word(*METHODS), METHODS[0],
)  # fmt: skip

EXCITATION = Key(
    "excitation", "kind of excitation; force only with fit.method = 'history'", word(*_EXCITATIONS), "base"
)


def record_by_history(rig: Rig, table: Table) -> xr.Dataset:
    """Fit a record of any shape."""
    for key in rig.system:
        if key not in _SYSTEM:
            raise unknown_key(key, "system", _SYSTEM)
    excitation = checks.choice(rig.system.get("excitation", "base"), "system.excitation", _EXCITATIONS)
    wanted = {"time": "time", excitation: "force" if excitation == "force" else "motion", "x": "motion"}
    check_columns(rig, tuple(wanted))
    picked = pick_columns(table, wanted, rig.columns, rig.missing)
    time, drive, x = (picked.columns[role] for role in wanted)
    check_increasing(table, time, picked.rows)
    reference = rig.system.get("damping_reference")
    if reference is not None:
        checks.choice(reference, "system.damping_reference", DAMPING_REFERENCES)
    known = dict(rig.known)
    if "stiffness" in known:
        known["stiffness"] *= 1e-3  # N/m in N/mm
    options: dict[str, Any] = {excitation: drive.values, "window": rig.data.get("window")}
    options |= {
        _ARGUMENTS.get(key.name, key.name): rig.fit[key.name] for key in OPTIONS if key.name in rig.fit
    }
    with naming(f"file {rig.file}, columns {time.name}, {drive.name} and {x.name}"):
        ds = history(
            time.values * conversion(time.unit, "s"), x.values,
            units=(COLUMN_NAMES[drive.unit], COLUMN_NAMES[x.unit]),
            contact=checks.choice(rig.system.get("contact", CONTACTS[0]), "system.contact", CONTACTS),
            damping_reference=None if reference is None else str(reference),
            known=known, free=rig.free, **options,
        )  # fmt: skip
    return with_remarks(ds, table, picked)

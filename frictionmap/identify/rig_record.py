"""Records of steady motion from the file of a rig."""

from typing import Any

import xarray as xr

from .. import checks
from ..errors import InputError
from ..files.config import unknown_key
from ..units.table import conversion
from .columns import check_increasing, pick_columns
from .record import record
from .record_motion import CONTACTS, DAMPING_REFERENCES, PARAMETERS
from .rig import Kind, Rig, check_columns, dropped_rows
from .tables import Table

_WANTED = {"time": "time", "base": "length", "x": "length"}

#: What is given in mm, whatever the unit of the data.
_LENGTHS = ("x_F", "offset_x")

SYSTEM_KEYS = ("contact", "damping_reference", "excitation", "contact_masses")


def _record(rig: Rig, table: Table) -> xr.Dataset:
    contact, reference = one_mass_on_base(rig)
    check_columns(rig, tuple(_WANTED))
    picked = pick_columns(table, _WANTED, rig.columns, rig.missing)
    time, base, x = (picked.columns[role] for role in _WANTED)
    check_increasing(table, time, picked.rows)
    known = {
        key: value * conversion("mm", x.unit) if key in _LENGTHS else value
        for key, value in rig.known.items()
    }
    stiffness = known.pop("stiffness", None)
    options: dict[str, Any] = dict(rig.fit)
    try:
        ds = record(
            time.values * conversion(time.unit, "s"), base.values * conversion(base.unit, x.unit), x.values,
            unit=x.unit, contact=contact, damping_reference=reference, known=known, stiffness=stiffness,
            window=rig.data.get("window"), **options,
        )  # fmt: skip
    except InputError as error:
        names = f"columns {time.name}, {base.name} and {x.name}"
        raise InputError(f"file {rig.file}, {names}: {error}") from None
    ds.attrs["warnings"] = "; ".join(filter(None, (dropped_rows(table, picked), ds.attrs["warnings"])))
    return ds


def one_mass_on_base(rig: Rig) -> tuple[str, str]:
    """Contact and damping reference of one mass on a shaken base."""
    for key in rig.system:
        if key not in SYSTEM_KEYS:
            raise unknown_key(key, "system", SYSTEM_KEYS)
    if rig.system.get("contact_masses", [1]) != [1]:
        masses = checks.one_line(rig.system["contact_masses"])
        raise InputError(f"system.contact_masses must be [1], a record is of one mass; got {masses}")
    checks.choice(rig.system.get("excitation", "base"), "system.excitation", ("base",))
    return (
        checks.choice(rig.system.get("contact", CONTACTS[0]), "system.contact", CONTACTS),
        checks.choice(
            rig.system.get("damping_reference", DAMPING_REFERENCES[0]),
            "system.damping_reference",
            DAMPING_REFERENCES,
        ),
    )


RECORD = Kind(_record, PARAMETERS, known=("stiffness",), data=("window",), fit=("loss",), system=True)

"""Records of steady motion from the file of a rig."""

from typing import Any

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError, naming
from ...files.config import unknown_key
from ...files.key import several, word
from ...files.keys import KEYS
from ...model.system import DAMPING_REFERENCES
from ...units.table import COLUMN_NAMES, conversion
from ..parameters import Parameter
from ..signals.integration import Displacements, derivative_order, displacements
from ..signals.samples import within
from ..tables.columns import Column, check_increasing, pick_columns
from ..tables.files import Table
from ..time_series.motion import CONTACTS
from ..time_series.record import FITTABLE, record
from .history import EXCITATION, METHOD, METHODS, OPTIONS, record_by_history
from .rig import (
    LOSS,
    REFERENCE,
    STIFFNESS,
    WINDOW,
    Kind,
    Rig,
    check_columns,
    in_unit,
    named,
    with_remarks,
)

_WANTED = {"time": "time", "base": "motion", "x": "motion"}

#: Noise of displacements beyond this share of the motion is much.
_NOISY = 0.05

SYSTEM_KEYS = ("contact", "damping_reference", "excitation", "contact_masses")


def _record(rig: Rig, table: Table) -> xr.Dataset:
    method = checks.choice(rig.fit.get(METHOD.name, METHODS[0]), "fit.method", METHODS)
    return _steady(rig, table) if method == METHODS[0] else record_by_history(rig, table)


def _steady(rig: Rig, table: Table) -> xr.Dataset:
    for key in OPTIONS:
        if key.name in rig.fit:
            raise InputError(
                f"cannot use fit.{key.name} with steady motions: it is of another method; "
                "add fit.method = 'history', or remove it"
            )
    contact, reference = one_mass_on_base(rig)
    check_columns(rig, tuple(_WANTED))
    picked = pick_columns(table, _WANTED, rig.columns, rig.missing)
    time, base, x = (picked.columns[role] for role in _WANTED)
    check_increasing(table, time, picked.rows)
    unit = "mm" if derivative_order(COLUMN_NAMES[x.unit]) else x.unit
    known = in_unit(rig.known, unit)
    stiffness = known.pop("stiffness", None)
    options: dict[str, Any] = {key: value for key, value in rig.fit.items() if key != METHOD.name}
    with naming(f"file {rig.file}, columns {time.name}, {base.name} and {x.name}"):
        times, found = _displaced(time, base, x, unit, rig.data.get("window"))
        ds = record(
            times, found.base, found.x, unit=unit, contact=contact, damping_reference=reference, known=known,
            stiffness=stiffness, window=rig.data.get("window"), free=rig.free, **options,
        )  # fmt: skip
    remarks = _integration_warnings((base, x), found)
    ds.attrs["warnings"] = "; ".join(filter(None, (*remarks, ds.attrs["warnings"])))
    return with_remarks(ds, table, picked)


def _displaced(
    time: Column, base: Column, x: Column, unit: str, window: object
) -> tuple[np.ndarray, Displacements]:
    """Times [s] within the window, and displacements of base and mass."""
    times = time.values * conversion(time.unit, "s")
    inside = within(window, times)
    return times[inside], displacements(
        times[inside], base.values[inside], x.values[inside], base_unit=COLUMN_NAMES[base.unit],
        x_unit=COLUMN_NAMES[x.unit], unit=unit,
    )  # fmt: skip


def _integration_warnings(columns: tuple[Column, Column], found: Displacements) -> list[str]:
    """Warnings about displacements obtained by integration."""
    words = []
    for column, noise in zip(columns, found.noise, strict=True):
        if noise > _NOISY:
            words.append(
                f"{column.name} as a displacement has noise of {noise:.0%} of its motion: integration "
                "amplifies low frequencies"
            )
    if any(derivative_order(COLUMN_NAMES[column.unit]) for column in columns):
        words.append("offset_x has no meaning: velocities and accelerations do not show where the mass rests")
    return words


def one_mass_on_base(rig: Rig) -> tuple[str, str]:
    """Contact and damping reference of one mass on a shaken base."""
    for key in rig.system:
        if key not in SYSTEM_KEYS:
            raise unknown_key(key, "system", SYSTEM_KEYS)
    if rig.system.get("contact_masses", [1]) != [1]:
        masses = checks.one_line(rig.system["contact_masses"])
        raise InputError(f"system.contact_masses must be [1] for a record of one mass; got {masses}")
    checks.choice(rig.system.get("excitation", "base"), "system.excitation", ("base",))
    return (
        checks.choice(rig.system.get("contact", CONTACTS[0]), "system.contact", CONTACTS),
        checks.choice(
            rig.system.get("damping_reference", DAMPING_REFERENCES[0]),
            "system.damping_reference",
            DAMPING_REFERENCES,
        ),
    )


_CONTACT, _MASSES, *_ = KEYS["system"]

#: A parameter of records under a force, which is reported in N/mm.
_STIFFNESS = {"stiffness": Parameter("spring stiffness; fitted of records under a force", "12.0", "N/m")}

RECORD = Kind(
    _record,
    named(*FITTABLE) | _STIFFNESS,
    known=STIFFNESS,
    data=(WINDOW,),
    fit=(LOSS, METHOD, *OPTIONS),
    system=(
        _CONTACT._replace(valid=word(*CONTACTS)),
        _MASSES._replace(meaning="the mass in contact", valid=several({"const": 1}, maxItems=1), words="[1]"),
        EXCITATION,
        REFERENCE,
    ),
    optional=("offset_x", "stiffness"),
    examples={
        "columns": '{ time = "time_s", base = "base_mm", x = "x_mm" }',
        "free": '["f_n", "zeta", "x_F", "mu", "offset_x"]',
    },
)

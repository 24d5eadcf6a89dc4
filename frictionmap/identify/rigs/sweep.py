"""Sweeps without friction from the file of a rig."""

from collections.abc import Mapping
from typing import Any

import xarray as xr

from ... import checks
from ...errors import InputError, naming
from ...files.config import unknown_key
from ...files.key import Key, whole, word
from ...units.table import conversion
from ..chain.data import MOST_MASSES
from ..chain.sweep import COSTS, DAMPINGS, sweep
from ..parameters import Parameter
from ..statistics.robust import LOSSES
from ..tables.columns import Column, Columns, check_positive, columns_like, pick_columns
from ..tables.files import Table
from .rig import BASE, LOSS, REFERENCE, SIGMA_AMPLITUDE, SIGMA_PHASE, Kind, Rig, check_columns, with_remarks

SYSTEM_KEYS = ("masses", "excitation", "damping_reference")
_MEASURES = {"amplitude_ratio": "ratio", "phase_lag": "angle"}


def _sweep(rig: Rig, table: Table) -> xr.Dataset:
    masses = _checked_system(rig)
    picked = pick_columns(table, _used_quantities(rig, table, masses), rig.columns, rig.missing)
    for role, column in picked.columns.items():
        if not role.startswith("phase_lag"):
            check_positive(table, column, picked.rows)
    ratios, lags = (_by_mass(picked, role, masses) for role in _MEASURES)
    frequency = picked.columns["frequency"]
    names = ", ".join(column.name for column in picked.columns.values())
    with naming(f"file {rig.file}, columns {names}"):
        ds = sweep(
            frequency.values * conversion(frequency.unit, "Hz"),
            {mass: column.values for mass, column in ratios.items()},
            {mass: column.values * conversion(column.unit, "deg") for mass, column in lags.items()} or None,
            masses=masses, known=rig.known, **_options(rig),
        )  # fmt: skip
    return with_remarks(ds, table, picked)


def _used_quantities(rig: Rig, table: Table, masses: int) -> dict[str, str]:
    """Quantities of the columns in the file; amplitudes of one mass are required."""
    measures = {
        f"{role}_{mass}": what for mass in range(1, MOST_MASSES + 1) for role, what in _MEASURES.items()
    }
    check_columns(rig, ("frequency", *measures))
    there = {role: what for role, what in measures.items() if columns_like(table, role, what, rig.columns)}
    for role in there:
        if int(role[-1]) > masses:
            raise InputError(f"system.masses must be at least {role[-1]}, as there is {role}; got {masses}")
    if not any(role.startswith("amplitude_ratio") for role in there):
        there["amplitude_ratio_1"] = "ratio"  # the search for columns reports that it is missing
    return {"frequency": "frequency", **there}


def _options(rig: Rig) -> dict[str, Any]:
    """Errors, damping and cost of the configuration as arguments of `sweep`."""
    keys = {"sigma_amplitude": "sigma_amplitude", "sigma_phase_deg": "sigma_phase"}
    options: dict[str, Any] = {
        name: checks.number(rig.data[key], f"data.{key}", above=0.0)
        for key, name in keys.items()
        if key in rig.data
    }
    if "damping_reference" in rig.system:
        options["damping"] = checks.choice(
            rig.system["damping_reference"], "system.damping_reference", DAMPINGS
        )
    if "cost" in rig.fit:
        options["cost"] = checks.choice(rig.fit["cost"], "fit.cost", COSTS)
    if "loss" in rig.fit:
        options["loss"] = checks.choice(rig.fit["loss"], "fit.loss", LOSSES)
    return options


def _by_mass(picked: Columns, role: str, masses: int) -> Mapping[int, Column]:
    names = {mass: f"{role}_{mass}" for mass in range(1, masses + 1)}
    return {mass: picked.columns[name] for mass, name in names.items() if name in picked.columns}


def _checked_system(rig: Rig) -> int:
    """Number of masses on the shaken base."""
    for key in rig.system:
        if key not in SYSTEM_KEYS:
            raise unknown_key(key, "system", SYSTEM_KEYS)
    if "masses" not in rig.system:
        raise InputError(f"system.masses must be a whole number from 1 to {MOST_MASSES}; got nothing")
    checks.choice(rig.system.get("excitation", "base"), "system.excitation", ("base",))
    return checks.whole(rig.system["masses"], "system.masses", least=1, most=MOST_MASSES)


_MASSES = range(1, MOST_MASSES + 1)
_NUMBERS = {
    "f_k1m1": Parameter("natural frequency of mass 1 on its spring alone, Hz", "3.0", "Hz"),
    "gamma": Parameter("mass ratio m_2/m_1, of two masses", "1.0"),
    "kappa": Parameter("stiffness ratio k_2/k_1, of two masses", "1.0"),
}
_NUMBERS |= {f"mass_ratio_{k}": Parameter(f"mass ratio m_{k}/m_1", "1.0") for k in _MASSES[1:]}
_NUMBERS |= {f"stiffness_ratio_{k}": Parameter(f"stiffness ratio k_{k}/k_1", "1.0") for k in _MASSES[1:]}
_NUMBERS |= {f"zeta_{k}": Parameter(f"damping ratio of mode {k}", "0.01") for k in _MASSES}

_COST = Key("cost", "residuals of amplitudes: logarithmic or relative differences", word(*COSTS), COSTS[0])

SWEEP = Kind(
    _sweep,
    {},
    known=_NUMBERS,
    data=(SIGMA_AMPLITUDE, SIGMA_PHASE),
    fit=(_COST, LOSS),
    system=(
        Key("masses", "number of masses of the chain", whole(least=1, most=MOST_MASSES), example="2"),
        BASE,
        REFERENCE._replace(default=None, example='"ground"'),
    ),
    needs_system=True,
    examples={"columns": '{ frequency = "frequency_Hz", amplitude_ratio_1 = "amplitude_ratio_1" }'},
)

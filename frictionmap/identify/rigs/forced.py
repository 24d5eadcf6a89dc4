"""Forced responses from the file of a rig."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError, naming
from ...files.config import read_system
from ...files.key import Key, number, several, word
from ...files.keys import GENERAL_KEYS, KEYS
from ...model.system import System
from ...units.table import COLUMN_NAMES, conversion
from ..parameters import is_elastic
from ..response.data import check_lag
from ..response.forced import PARAMETERS, forced
from ..signals.integration import amplitude_factors, derivative_order
from ..statistics.robust import LOSSES
from ..tables.columns import Column, Columns, check_positive, columns_like, pick_columns
from ..tables.files import Table
from .rig import LOSS, SIGMA_AMPLITUDE, SIGMA_PHASE, STIFFNESS, Kind, Rig, check_columns, named, with_remarks

#: What may be fitted: the columns, and what they measure.
_USE = {"phase": ("phase_lag", "angle"), "amplitude": ("amplitude_ratio", "ratio")}

#: Amplitudes of masses, where the table has no ratios of them.
_MOTION = ("x", "motion")

_LOADS = {"base": ("base", "motion"), "force": ("force", "force")}

#: Columns of errors, and what they measure.
_ERRORS = {"sigma_phase": "angle", "sigma_amplitude": "ratio"}


def _fit_forced(rig: Rig, table: Table) -> xr.Dataset:
    if not rig.system:
        raise InputError("the configuration must have a table [system] for forced responses; got none")
    system = read_system(rig.system, rig.files[0].parent)
    _check_load(system, rig, table)
    wanted = _used_quantities(system, rig, table)
    names = {role: name for role, name in rig.columns.items() if role != "set"}
    picked = pick_columns(table, wanted, names, rig.missing)
    for role, column in picked.columns.items():
        if not role.startswith("phase_lag"):
            check_positive(table, column, picked.rows)
    lags = _by_mass(system, picked, "phase_lag", "deg")
    sigmas = _errors(rig, picked)
    elastic = is_elastic(rig.free, rig.known) or system.contact_stiffness is not None
    for mass, lag in lags.items():
        name = picked.columns[_role(system, "phase_lag", mass)].name
        places = [table.place(name, int(row)) for row in picked.rows]
        check_lag(system, mass - 1, lag, sigmas[0], places, elastic)
    frequency = _frequency(rig, picked)
    load, unit = _load(picked, frequency)
    ratios = _ratios(rig, system, picked, frequency, load)
    known = dict(rig.known)
    stiffness = known.pop("stiffness", None)
    with naming(f"file {rig.file}"):
        ds = forced(
            frequency, lags or None, ratios or None, system=system, load=load, unit=unit, stiffness=stiffness,
            sets=_sets(rig, table, picked.rows), known=known, sigma_phase=sigmas[0],
            sigma_amplitude=sigmas[1], unreachable=rig.data.get("unreachable", "refuse"),
            loss=checks.choice(rig.fit.get("loss", LOSSES[0]), "fit.loss", LOSSES), free=rig.free,
        )  # fmt: skip
    return with_remarks(ds, table, picked, _left_out(system, rig, table))


def _check_load(system: System, rig: Rig, table: Table) -> None:
    """Refuse a table of a shaken base for a system under a force, and the other way round."""
    own, own_measures = _LOADS[system.excitation or "force"]
    if columns_like(table, own, own_measures, rig.columns, sure=True):
        return
    for excitation, (role, measures) in _LOADS.items():
        if system.excitation != excitation and columns_like(table, role, measures, rig.columns, sure=True):
            raise InputError(
                f"system.excitation must be {excitation} for a file with a column {role}; "
                f"got {system.excitation}"
            )


def _used_quantities(system: System, rig: Rig, table: Table) -> dict[str, str]:
    """Quantities of the columns that are used."""
    roles = _roles_by_use(system)
    load = _LOADS[system.excitation or "force"]
    motions = _roles(system, *_MOTION)
    check_columns(
        rig,
        (
            "frequency",
            "frequency_ratio",
            *roles["phase"],
            *roles["amplitude"],
            *motions,
            load[0],
            *_ERRORS,
            "set",
        ),
    )

    def there(wanted: Mapping[str, str], sure: bool = False) -> dict[str, str]:
        return {
            role: what for role, what in wanted.items() if columns_like(table, role, what, rig.columns, sure)
        }

    if not there(roles["amplitude"]) and there(motions, sure=True):
        roles["amplitude"] = motions
    measured, ratio = {"frequency": "frequency"}, there({"frequency_ratio": "ratio"})
    wanted = ratio if "frequency_ratio" in rig.columns or not there(measured, sure=True) else measured
    wanted = wanted or measured
    for use in _checked_use(rig, [name for name in _USE if there(roles[name])]):
        wanted |= there(roles[use]) or dict([next(iter(roles[use].items()))])
    return wanted | there(dict([load]), sure=True) | there(_ERRORS, sure=True)


def _roles_by_use(system: System) -> dict[str, dict[str, str]]:
    """Roles of the columns that may be fitted, and what they measure."""
    return {use: _roles(system, role, measures) for use, (role, measures) in _USE.items()}


def _roles(system: System, role: str, measures: str) -> dict[str, str]:
    return {_role(system, role, mass): measures for mass in range(1, system.n + 1)}


def _left_out(system: System, rig: Rig, table: Table) -> list[str]:
    """The column of sets, and columns that `data.use` leaves out."""
    names = [rig.columns.get("set", "set")]
    use = _checked_use(rig, list(_USE))
    for roles in (roles for name, roles in _roles_by_use(system).items() if name not in use):
        names += [
            name for role, what in roles.items() for name in columns_like(table, role, what, rig.columns)
        ]
    return names


def _role(system: System, role: str, mass: int) -> str:
    """The name of a mass's column without its unit; the only mass needs no number."""
    return role if system.n == 1 else f"{role}_{mass}"


def _checked_use(rig: Rig, there: list[str]) -> list[str]:
    """Quantities to be fitted: as configured, or all available."""
    use = rig.data.get("use", there or list(_USE))
    if not isinstance(use, list) or not use:
        raise InputError(f"data.use must be a list of {', '.join(_USE)}; got {checks.one_line(use)}")
    return [checks.choice(one, f"data.use[{index}]", tuple(_USE)) for index, one in enumerate(use)]


def _by_mass(system: System, picked: Columns, role: str, unit: str) -> dict[int, np.ndarray]:
    found = {}
    for mass in range(1, system.n + 1):
        column = picked.columns.get(_role(system, role, mass))
        if column is not None:
            scale = 1.0 if column.unit == unit else conversion(column.unit, unit)
            found[mass] = column.values * scale
    return found


def _load(picked: Columns, frequency: np.ndarray) -> tuple[np.ndarray | None, str]:
    """Loads row by row, those of a base as displacements, and their unit."""
    if "force" in picked.columns:
        force = picked.columns["force"]
        return force.values, force.unit
    if "base" not in picked.columns:
        return None, "mm"
    base = picked.columns["base"]
    unit = "mm" if derivative_order(COLUMN_NAMES[base.unit]) else base.unit
    return _displaced(base, unit, frequency), unit


def _displaced(column: Column, unit: str, frequency: np.ndarray) -> np.ndarray:
    """Amplitudes of a displacement, velocity or acceleration as displacements in a unit."""
    return column.values * amplitude_factors(COLUMN_NAMES[column.unit], unit, frequency)


def _ratios(
    rig: Rig, system: System, picked: Columns, frequency: np.ndarray, load: np.ndarray | None
) -> dict[int, np.ndarray]:
    """Amplitude ratios by mass, as given or of the amplitudes of masses over the load."""
    ratios = _by_mass(system, picked, "amplitude_ratio", "1")
    for mass in range(1, system.n + 1):
        column = picked.columns.get(_role(system, _MOTION[0], mass))
        if column is not None:
            amplitude = _displaced(column, "m", frequency)
            ratios[mass] = amplitude / _unit_response(rig, picked, frequency, column.name)
    return ratios


def _unit_response(rig: Rig, picked: Columns, frequency: np.ndarray, name: str) -> np.ndarray:
    """Amplitudes that make the ratio one [m]: of the base, or force over stiffness."""
    if "base" in picked.columns:
        return _displaced(picked.columns["base"], "m", frequency)
    if "force" not in picked.columns:
        raise InputError(
            f"cannot normalise the amplitudes {name}: file {rig.file} has no column base_mm or force_N; "
            "add one, or give amplitude_ratio"
        )
    if "stiffness" not in rig.known:
        raise InputError(
            f"cannot normalise the amplitudes {name} by a force: the stiffness is missing; "
            "give known.stiffness"
        )
    force = picked.columns["force"]
    return force.values * conversion(force.unit, "N") / rig.known["stiffness"]


def _errors(rig: Rig, picked: Columns) -> list[np.ndarray | None]:
    """Errors of lags [deg] and amplitudes, by row or for all, as a column or as the configuration says."""
    found: list[np.ndarray | None] = []
    for role, key in (("sigma_phase", "sigma_phase_deg"), ("sigma_amplitude", "sigma_amplitude")):
        column = picked.columns.get(role)
        if column is not None and key in rig.data:
            raise InputError(
                f"cannot use data.{key}: the file has the column {column.name}; omit one of the two"
            )
        if column is not None:
            scale = conversion(column.unit, "deg") if column.unit != "1" else 1.0
            found.append(column.values * scale)
        elif key in rig.data:
            sigma = checks.number(rig.data[key], f"data.{key}", above=0.0)
            found.append(np.full(picked.rows.size, sigma))
        else:
            found.append(None)
    return found


def _frequency(rig: Rig, picked: Columns) -> np.ndarray:
    """Frequencies [Hz]."""
    if "frequency_ratio" in picked.columns:
        if "f_n" not in rig.known:
            raise InputError("cannot convert the column frequency_ratio: f_n is missing; give known.f_n")
        return picked.columns["frequency_ratio"].values * rig.known["f_n"]
    column = picked.columns["frequency"]
    return column.values * conversion(column.unit, "Hz")


def _sets(rig: Rig, table: Table, rows: np.ndarray) -> list[object] | None:
    """Labels of the rows that are made use of, if there is a column of them."""
    name = rig.columns.get("set", "set")
    if name not in table.columns:
        if "set" in rig.columns:
            raise InputError(
                f"cannot assign rows to sets: there is no column {name!r}; correct data.columns.set"
            )
        return None
    labels = table.texts[name] if name in table.texts else table.columns[name].tolist()
    return [labels[row] for row in rows]


_SPRING = Key(
    "contact_stiffness", "stiffness of a spring in the contact over k1, if it is known; default: rigid",
    number(above=0.0), example="3.0",
)  # fmt: skip

_USED = Key("use", "quantities to fit; default: all available", several(word(*_USE)),
            example='["phase", "amplitude"]')  # fmt: skip
_UNREACHABLE = Key("unreachable", "lags that no friction ratio gives: refuse or ignore them",
                   word("refuse", "drop"), "refuse")  # fmt: skip

FORCED = Kind(
    _fit_forced,
    named(*PARAMETERS),
    known=STIFFNESS,
    data=(_USED, SIGMA_PHASE, SIGMA_AMPLITUDE, _UNREACHABLE),
    fit=(LOSS,),
    system=(*(key for key in KEYS["system"] if key not in GENERAL_KEYS), _SPRING),
    needs_system=True,
    examples={
        "columns": '{ frequency = "frequency_Hz", phase_lag = "phase_lag_deg" }',
        "free": '["beta", "f_n", "zeta"]',
    },
)

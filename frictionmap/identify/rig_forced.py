"""Forced responses from the file of a rig."""

import numpy as np
import xarray as xr

from .. import checks
from ..errors import InputError
from ..files.config import read_system
from ..model.system import System
from ..units.table import conversion
from .columns import Columns, check_positive, has_column, pick_columns
from .forced import forced
from .forced_data import check_lag
from .rig import Kind, Rig, check_columns, dropped_rows
from .tables import Table

#: What may be fitted: the columns, and what they measure.
_USE = {"phase": ("phase_lag", "angle"), "amplitude": ("amplitude_ratio", "ratio")}

_LOADS = {"base": ("base", "length"), "force": ("force", "force")}

#: Columns of errors, and what they measure.
_ERRORS = {"sigma_phase": "angle", "sigma_amplitude": "ratio"}


def _forced(rig: Rig, table: Table) -> xr.Dataset:
    if not rig.system:
        raise InputError("the configuration must have a table [system] for forced responses; it has none")
    system = read_system(rig.system, rig.files[0].parent)
    _check_load(system, rig, table)
    wanted = _wanted(system, rig, table)
    names = {role: name for role, name in rig.columns.items() if role != "set"}
    picked = pick_columns(table, wanted, names, rig.missing)
    for role, column in picked.columns.items():
        if not role.startswith("phase_lag"):
            check_positive(table, column, picked.rows)
    lags = _by_mass(system, picked, "phase_lag", "deg")
    ratios = _by_mass(system, picked, "amplitude_ratio", "1")
    sigmas = _errors(rig, picked)
    for mass, lag in lags.items():
        name = picked.columns[_role(system, "phase_lag", mass)].name
        places = [table.place(name, int(row)) for row in picked.rows]
        check_lag(system, mass - 1, lag, sigmas[0], places)
    load = next((picked.columns[role] for role in _LOADS if role in picked.columns), None)
    try:
        ds = forced(
            _frequency(rig, picked), lags or None, ratios or None, system=system,
            load=None if load is None else load.values, unit="" if load is None else load.unit,
            sets=_sets(rig, table, picked.rows), known=rig.known, sigma_phase=sigmas[0],
            sigma_amplitude=sigmas[1], unreachable=rig.data.get("unreachable", "refuse"),
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"file {rig.file}: {error}") from None
    ds.attrs["warnings"] = "; ".join(filter(None, (dropped_rows(table, picked), ds.attrs["warnings"])))
    return ds


def _check_load(system: System, rig: Rig, table: Table) -> None:
    """Refuse a table of a shaken base for a system under a force, and the other way round."""
    for excitation, (role, measures) in _LOADS.items():
        if system.excitation != excitation and has_column(table, role, measures, rig.columns):
            raise InputError(
                f"system.excitation must be {excitation} for a file with a column {role}; "
                f"got {system.excitation}"
            )


def _wanted(system: System, rig: Rig, table: Table) -> dict[str, str]:
    """What every column that is made use of measures."""
    roles = {
        use: {_role(system, role, mass): measures for mass in range(1, system.n + 1)}
        for use, (role, measures) in _USE.items()
    }
    load = _LOADS[system.excitation or "force"]
    check_columns(
        rig, ("frequency", "frequency_ratio", *roles["phase"], *roles["amplitude"], load[0], *_ERRORS, "set")
    )

    def there(wanted: dict[str, str]) -> dict[str, str]:
        return {role: what for role, what in wanted.items() if has_column(table, role, what, rig.columns)}

    ratio = there({"frequency_ratio": "ratio"})
    wanted = ratio or {"frequency": "frequency"}
    for use in _checked_use(rig, [name for name in _USE if there(roles[name])]):
        wanted |= there(roles[use]) or dict([next(iter(roles[use].items()))])
    return wanted | there(dict([load])) | there(_ERRORS)


def _role(system: System, role: str, mass: int) -> str:
    """The name of a mass's column without its unit; the only mass needs no number."""
    return role if system.n == 1 else f"{role}_{mass}"


def _checked_use(rig: Rig, there: list[str]) -> list[str]:
    """What is fitted: what the configuration says, or all that is there."""
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


def _errors(rig: Rig, picked: Columns) -> list[np.ndarray | None]:
    """Errors of lags [deg] and amplitudes, by row or for all, as a column or as the configuration says."""
    found: list[np.ndarray | None] = []
    for role, key in (("sigma_phase", "sigma_phase_deg"), ("sigma_amplitude", "sigma_amplitude")):
        column = picked.columns.get(role)
        if column is not None and key in rig.data:
            raise InputError(f"data.{key} must be left out for a file with a column {column.name}")
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
    """In Hz."""
    if "frequency_ratio" in picked.columns:
        if "f_n" not in rig.known:
            raise InputError("known.f_n must be given for a file with a column frequency_ratio")
        return picked.columns["frequency_ratio"].values * rig.known["f_n"]
    column = picked.columns["frequency"]
    return column.values * conversion(column.unit, "Hz")


def _sets(rig: Rig, table: Table, rows: np.ndarray) -> list[object] | None:
    """Labels of the rows that are made use of, if there is a column of them."""
    name = rig.columns.get("set", "set")
    if name not in table.columns:
        if "set" in rig.columns:
            raise InputError(f"file {rig.file} must have a column {name}, named by data.columns.set")
        return None
    labels = table.texts[name] if name in table.texts else table.columns[name].tolist()
    return [labels[row] for row in rows]


FORCED = Kind(
    _forced,
    ("beta", "f_n", "zeta", "mu"),
    data=("use", "sigma_phase_deg", "sigma_amplitude", "unreachable"),
    system=True,
)

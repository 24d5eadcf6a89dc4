"""Sweeps without friction from the file of a rig."""

import xarray as xr

from .. import checks
from ..errors import InputError
from ..files.config import unknown_key
from .columns import check_increasing, check_positive, pick_columns
from .rig import Kind, Rig, check_columns, dropped_rows
from .sweep import sweep
from .tables import Table
from .units import conversion

_SYSTEM_KEYS = ("masses", "excitation")


def _sweep(rig: Rig, table: Table) -> xr.Dataset:
    _check_system(rig)
    wanted = {"frequency": "frequency", "amplitude_ratio_1": "ratio"}
    check_columns(rig, tuple(wanted))
    picked = pick_columns(table, wanted, rig.columns, rig.missing)
    for column in picked.columns.values():
        check_positive(table, column, picked.rows)
    frequency, amplitude = (picked.columns[role] for role in wanted)
    check_increasing(table, frequency, picked.rows, "higher")
    sigma = rig.data.get("sigma_amplitude")
    if sigma is not None:
        sigma = checks.number(sigma, "data.sigma_amplitude", above=0.0)
    hertz = frequency.values * conversion(frequency.unit, "Hz")
    try:
        ds = sweep(hertz, amplitude.values, sigma_amplitude=sigma)
    except InputError as error:
        raise InputError(f"file {rig.file}, columns {frequency.name} and {amplitude.name}: {error}") from None
    ds.attrs["warnings"] = "; ".join(filter(None, (dropped_rows(table, picked), ds.attrs["warnings"])))
    return ds


def _check_system(rig: Rig) -> None:
    """Two masses on a shaken base."""
    for key in rig.system:
        if key not in _SYSTEM_KEYS:
            raise unknown_key(key, "system", _SYSTEM_KEYS)
    if "masses" not in rig.system:
        raise InputError("system.masses must be given for a sweep: 2; got none")
    checks.whole(rig.system["masses"], "system.masses", least=2, most=2)
    checks.choice(rig.system.get("excitation", "base"), "system.excitation", ("base",))


SWEEP = Kind(_sweep, (), data=("sigma_amplitude",), system=True)

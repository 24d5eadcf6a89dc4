"""`borders`: borders between numbers of stops per cycle as a dataset."""

from typing import Any

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.physical import with_units
from ..datasets.variables import label_variable, stamp
from ..errors import InputError
from ..model.system import System
from ..units.axes import KINDS, ratios
from ..units.scales import Units, scales_of
from .curves import Border, find_borders

#: Below this part of the smallest natural frequency borders are dense: they grow in number like 1/r^2.
_LOWEST = 1.0 / 16.0


def borders(system: System, r: Any, beta: Any, *, mu: float = 1.0, units: Units | None = None) -> xr.Dataset:
    """Find the borders between numbers of stops per cycle for mu = 1 as exact curves, theory.md 12.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    r : array_like, shape (2,)
        Range of frequency ratios, > 0; with units also frequencies.  The number of borders grows like 1/r^2.
    beta : array_like, shape (2,)
        Range of friction ratios, > 0; with units also forces.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`.

    Returns
    -------
    xarray.Dataset
        On (border, point) `border_r` and `border_beta`, exact points about 2 % apart over increasing r,
        padded with NaN; on border `border_kind`: "graze" (a slide touches zero velocity, a stop is born),
        "slip-in-stop" (a stop is split by a slide), "turn/stop" (a stop becomes a turn), and `stops_below`
        and `stops_above`, stops per cycle on both sides.  `beta_lim` and `beta_stick` are not among them.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or there are several contacts, springs or
        harmonics.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.borders(fm.System(contact="joined-base-wall"), r=[0.35, 0.6], beta=[0.01, 1.0])
    >>> ds.sizes["border"]
    0
    """
    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    ends = {}
    for name, given in (("r", r), ("beta", beta)):
        axis = checks.axis(ratios(given, name, KINDS[name], scales), name, least=0.0)
        if axis.size != 2 or axis[0] <= 0.0:
            raise InputError(f"{name} must be two numbers > 0; got {checks.one_line(given)}")
        ends[name] = axis
    system.costs(ends["r"])
    found = find_borders(system, tuple(ends["r"]), tuple(ends["beta"]), mu)
    ds = stamp(
        xr.Dataset(_variables(found)),
        "borders",
        "Borders between numbers of stops",
        system,
        ends,
        units=units,
    )
    return with_units(ds, scales)


def _variables(found: list[Border]) -> dict[str, xr.Variable]:
    longest = max((border.r.size for border in found), default=0)
    points = np.full((2, len(found), longest), np.nan)
    for k, border in enumerate(found):
        points[:, k, : border.r.size] = border.r, border.beta
    values = {
        "border_r": points[0],
        "border_beta": points[1],
        "border_kind": np.array([border.kind for border in found], dtype=np.str_),
        "stops_below": np.array([border.below for border in found], dtype=np.float32),
        "stops_above": np.array([border.above for border in found], dtype=np.float32),
    }
    return {name: label_variable(name, value) for name, value in values.items()}


def with_borders(ds: xr.Dataset, system: System, beta: np.ndarray, units: Units | None) -> xr.Dataset:
    """Add the borders in the window of an axis beta to the boundaries of a system.

    Raises
    ------
    InputError
        mu = 1 is not among those of the boundaries, or the axes hold no window.
    """
    if not (ds["mu"].values == 1.0).any():
        mu = ", ".join(f"{value:g}" for value in ds["mu"].values)
        raise InputError(f"mu must contain 1 for borders between numbers of stops; got {mu}")
    r = ds["r"].values
    lowest = _LOWEST * float(system.modes.w.min())
    inside, positive = r[r >= lowest], beta[beta > 0.0]
    if inside.size < 2 or positive.size < 2:
        raise InputError(
            f"grid.r must have two values >= {lowest:.3g}, and grid.beta two > 0, for borders between "
            f"numbers of stops; got {inside.size} and {positive.size}"
        )
    found = borders(system, inside[[0, -1]], positive[[0, -1]], units=units)
    if not found.sizes["border"]:
        return ds
    return ds.assign(found.data_vars)

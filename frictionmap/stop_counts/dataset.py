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


def borders(system: System, r: Any, beta: Any, mu: Any = 1.0, *, units: Units | None = None) -> xr.Dataset:
    """Find the borders between numbers of stops per cycle as exact curves, theory.md 12.

    For mu = 1 the steady state is unique, and every change of its number of stops within the ranges lies on
    a border, `beta_lim` or `beta_stick`.  For mu > 1 the borders are those of existence: where a periodic
    motion with some number of stops ends.  The motion from a given initial state may leave it before, at the
    border of its basin, which is no such curve.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    r : array_like, shape (2,)
        Range of frequency ratios, > 0; with units also frequencies.  The number of borders grows like 1/r^2.
    beta : array_like, shape (2,)
        Range of friction ratios, > 0; with units also forces.
    mu : float or array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing.  For mu > 1 the search takes several times
        as long; it begins at motions from rest and from a large sliding motion that repeat within two
        excitation periods.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`.

    Returns
    -------
    xarray.Dataset
        On (border, point) `border_r` and `border_beta`, exact points at most 2 % apart over increasing r,
        padded with NaN.  On border: `border_mu`; `border_kind`: "graze" (a slide touches zero velocity),
        "slip-in-stop" (the force in a stop touches its limit), "turn/stop" (a stop becomes a turn), and for
        mu > 1 "graze-of-slide-end" (a slide ends where its deceleration vanishes), "fold" (two motions meet
        and end) and "doubling" (a motion loses its stability to one of twice its period, or its symmetry);
        `stops_below` and `stops_above`, stops per cycle on both sides: for mu > 1 those of the motion that
        ends, NaN where it does not exist.  `beta_lim` and `beta_stick` are not among the borders.

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
            raise InputError(name, f"must be two numbers > 0; got {checks.one_line(given)}")
        ends[name] = axis
    each = checks.axis(mu, "mu", least=1.0)
    system.costs(ends["r"])
    found = [
        (float(one), border)
        for one in each
        for border in find_borders(system, tuple(ends["r"]), tuple(ends["beta"]), float(one))
    ]
    ds = stamp(
        xr.Dataset(_variables(found)),
        "borders",
        "Borders between numbers of stops",
        system,
        ends | {"mu": each},
        units=units,
    )
    return with_units(ds, scales)


def _variables(found: list[tuple[float, Border]]) -> dict[str, xr.Variable]:
    """Variables of borders, each with its mu."""
    longest = max((border.r.size for _, border in found), default=0)
    points = np.full((2, len(found), longest), np.nan)
    for k, (_, border) in enumerate(found):
        points[:, k, : border.r.size] = border.r, border.beta
    values = {
        "border_r": points[0],
        "border_beta": points[1],
        "border_kind": np.array([border.kind for _, border in found], dtype=np.str_),
        "border_mu": np.array([mu for mu, _ in found]),
        "stops_below": np.array([border.below for _, border in found], dtype=np.float32),
        "stops_above": np.array([border.above for _, border in found], dtype=np.float32),
    }
    return {name: label_variable(name, value) for name, value in values.items()}


def with_borders(ds: xr.Dataset, system: System, beta: np.ndarray, units: Units | None) -> xr.Dataset:
    """Add the borders in the window of an axis beta to the boundaries of a system.

    Raises
    ------
    InputError
        The axes hold no window.
    """
    r = ds["r"].values
    lowest = _LOWEST * float(system.modes.w.min())
    inside, positive = r[r >= lowest], beta[beta > 0.0]
    if inside.size < 2 or positive.size < 2:
        raise InputError(
            "grid.r",
            f"must have two values >= {lowest:.3g}, and grid.beta two > 0, for borders between "
            f"numbers of stops; got {inside.size} and {positive.size}",
        )
    found = borders(system, inside[[0, -1]], positive[[0, -1]], ds["mu"].values, units=units)
    if not found.sizes["border"]:
        return ds
    return ds.assign(found.data_vars)

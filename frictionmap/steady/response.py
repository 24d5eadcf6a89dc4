"""`response`: one steady state in time, as a dataset."""

from typing import Any, SupportsFloat, Unpack

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.physical import with_units
from ..datasets.variables import stamp
from ..errors import InputError
from ..model.settings import Solver, SolverSettings, merged
from ..model.system import System
from ..solvers.choose import engine_of
from ..units.axes import KINDS, ratios, require
from ..units.scales import Scales, Units, scales_of
from .configured import belt_speeds
from .refinement import boundary_check

#: Samples of a time history per excitation period.
POINTS = 2000
_MOST_POINTS = 10**6

_TITLE = "Steady state in time"


def _commented(ds: xr.Dataset, comment: str) -> xr.Dataset:
    """Add the comment on a motion, if there is one; of an irregular one the title says that it is a part."""
    if comment:
        ds.attrs["comment"] = comment
        if not int(ds["period"]):
            ds.attrs["title"] = "Motion in time, a part of it"
    return ds


def _ratio(given: object, name: str, scales: Scales) -> object:
    """Convert a ratio that may be given as a frequency or a force."""
    found = ratios(given, name, KINDS[name], scales)
    return found[0] if isinstance(found, list) and len(found) == 1 and not isinstance(given, list) else found


def _checked_cell(r: object, beta: object, mu: object, scales: Scales) -> tuple[float, float, float]:
    require(scales, r=(KINDS["r"], r), beta=(KINDS["beta"], beta))
    r = checks.number(_ratio(r, "r", scales), "r", least=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(_ratio(beta, "beta", scales), "beta", least=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    if r == 0.0:
        raise InputError("r", "must be > 0: at r = 0 there is no motion in time; got 0")
    return r, beta, mu


def _belt_motion(
    system: System, cell: tuple[Any, Any, Any], points: int, units: Units | None, settings: dict[str, Any]
) -> xr.Dataset:
    """One motion without a load in time."""
    from ..no_load.response import belt_response, refuse_settings

    refuse_settings(settings)
    points = checks.whole(points, "points", least=2, most=_MOST_POINTS)
    return belt_response(system, *cell, points, units, settings.get("start"))


def response(
    system: System,
    r: SupportsFloat | str | None = None,
    beta: SupportsFloat | str | None = None,
    mu: SupportsFloat = 1.0,
    *,
    solver: Solver | None = None,
    points: int = POINTS,
    units: Units | None = None,
    wall_speed: SupportsFloat | str | None = None,
    **settings: Unpack[SolverSettings],
) -> xr.Dataset:
    """Compute one steady state in time.

    Parameters
    ----------
    system : System
    r, beta, mu : float
        Frequency ratio (> 0), friction ratio (>= 0), ratio of static to kinetic friction (>= 1) [-].
    solver : Solver, optional
        Settings, or single settings as keywords, which override those of the solver.
    points : int
        Samples per excitation period, up to 10^6.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`; r and beta may then be a frequency
        and a force.
    wall_speed : float
        In the place of r, without a load: speed of the belt over omega_1 P/k1 [-], > 0.  Of the settings only
        `start` has a meaning: "release" (default) begins where the belt releases the mass, "moving" with a
        large vibration.  With contacts that open or piecewise linear springs they are "rest" (default) and
        "moving".

    Returns
    -------
    xarray.Dataset
        Over `tau` (0 to 2 pi times the period): `x(dof, tau)`, `v(dof, tau)`, `z`, `friction` (over P) and
        `direction` (-1, 0, 1: sliding down, sticking, sliding up).  Over `event`: `event_tau`,
        `event_direction` (of the slide or stop that starts) and `event_z`.  `phase` and `event_phase` are
        older names of `direction` and `event_direction`.  Scalars: `regime`, `stops_per_cycle`,
        `contact_amplitude`, `stuck_fraction`, `period`, `status`, the boundaries, further requested
        `outputs`, and those of `frictionmap.curves`; harmonics 0 to 7 over (`harmonic`, `part`).

        tau = 0 is a maximum of the load (of the base displacement).  Where the contact sticks away from
        z = 0, `x` and `z` contain this static offset, and `amplitude` does not.

        For irregular stick-slip (`status` irregular, `period` 0) tau covers the last 8 of the periods
        followed, and the scalars are the averages of the map.

        With units also `time` [s] along tau, and every quantity in m, N, J or m/s in addition to its ratio,
        such as `x_m`, `friction_N` and `v_m_s`.

        With wall_speed, over `time` (one cycle, over 1/omega_1): `x`, `v`, `z`, `friction`, `direction`, and
        the numbers of the cell as in `sweep`.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.
    NoSteadyState
        None exists, or none was found.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.response(fm.System(), r=0.3, beta=0.5)
    >>> int((ds.event_direction == 0).sum())
    2
    """
    checks.instance(system, "system", System)
    if beta is None:
        raise InputError("beta", "must be given, such as 0.5; got nothing")
    if belt_speeds(system, wall_speed, r) is not None:
        return _belt_motion(system, (wall_speed, beta, mu), points, units, {"solver": solver, **settings})
    if r is None:
        raise InputError("r", "must be given, such as 0.5, or wall_speed without a load; got nothing")
    solver = merged(solver, settings)
    scales = scales_of(units, system)
    r, beta, mu = _checked_cell(r, beta, mu, scales)
    points = checks.whole(points, "points", least=2, most=_MOST_POINTS)
    cell = {"r": r, "beta": beta, "mu": mu}
    ds = engine_of(system).motion(r, beta, mu, solver, points)
    comment = ds.attrs.get("comment", "")
    ds = stamp(ds, "response", _TITLE, system, cell, solver, units=units)
    ds.attrs |= boundary_check(system, np.array([r]), np.array([mu]))
    ds = with_units(ds, scales)
    return _commented(ds, comment)

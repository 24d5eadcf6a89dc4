"""`response`: one steady state in time, as a dataset."""

from dataclasses import replace
from typing import SupportsFloat, Unpack

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import CELL_VARIABLES, OLDER_NAMES
from ..datasets.physical import with_units
from ..datasets.variables import coordinate, label_variable, stamp
from ..errors import InputError
from ..general.response import general_response
from ..model.settings import HARMONICS, Output, Solver, SolverSettings, merged
from ..model.system import System
from ..theory.boundaries import boundary_variables
from ..theory.refinement import boundary_check
from ..units.axes import KINDS, ratios
from ..units.scales import Scales, Units, scales_of
from .motion import MotionRequest, find_motion
from .quantity_data import PARTS
from .sweep import sweep

#: Samples of a time history per excitation period.
POINTS = 2000
_MOST_POINTS = 10**6

_TITLE = "Steady state in time"


def _commented(ds: xr.Dataset, comment: str) -> xr.Dataset:
    """Add the comment on an irregular motion, if there is one."""
    if comment:
        ds.attrs |= {"title": "Motion in time, a part of it", "comment": comment}
    return ds


def _further(request: MotionRequest, names: list[Output]) -> dict[str, xr.Variable]:
    """Compute outputs of the cell of a map that do not follow from the motion in time."""
    if not names:
        return {}
    solver = replace(request.solver, outputs=names)
    ds = sweep(request.system, request.r, request.beta, request.mu, solver=solver, threads=1)
    cell = ds.isel(mu=0, r=0, beta=0, missing_dims="ignore")
    return {name: cell[name].variable for name in names}


def _ratio(given: object, name: str, scales: Scales) -> object:
    """Convert a ratio that may be given as a frequency or a force."""
    found = ratios(given, name, KINDS[name], scales)
    return found[0] if isinstance(found, list) and len(found) == 1 and not isinstance(given, list) else found


def _checked_cell(r: object, beta: object, mu: object, scales: Scales) -> tuple[float, float, float]:
    r = checks.number(_ratio(r, "r", scales), "r", least=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(_ratio(beta, "beta", scales), "beta", least=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    if r == 0.0:
        raise InputError("r must be > 0: at r = 0 there is no motion in time; got 0")
    return r, beta, mu


def response(
    system: System,
    r: SupportsFloat | str,
    beta: SupportsFloat | str,
    mu: SupportsFloat = 1.0,
    *,
    solver: Solver | None = None,
    points: int = POINTS,
    units: Units | None = None,
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
    solver = merged(solver, settings)
    scales = scales_of(units, system)
    r, beta, mu = _checked_cell(r, beta, mu, scales)
    points = checks.whole(points, "points", least=2, most=_MOST_POINTS)
    cell = {"r": r, "beta": beta, "mu": mu}
    if system.general is not None:
        ds = general_response(system, r, beta, mu, solver, points)
        comment = ds.attrs.get("comment", "")
        ds = with_units(stamp(ds, "response", _TITLE, system, cell, solver, units=units), scales)
        return _commented(ds, comment)
    request = MotionRequest(system, r, beta, mu, solver, points)
    found = find_motion(request)
    history, cycle = found.history, found.cycle
    times, begins, places = history.events
    variables = {
        "x": history.x,
        "v": history.v,
        "z": history.z,
        "friction": history.friction,
        "direction": history.direction,
        "event_tau": times,
        "event_direction": begins.astype(np.int8),
        "event_z": places,
    }
    variables |= {old: variables[new] for old, new in OLDER_NAMES["response"].items()}
    # what a map is asked for comes from its kernels below, to the bit
    variables |= {name: value for name, value in cycle.items() if name not in solver.outputs}
    own: dict[str, np.ndarray | float] = {
        "tau": history.tau,
        "dof": np.array(system.dofs.numbers),
        "harmonic": np.arange(HARMONICS + 1),
        "part": PARTS,
    }
    labelled = {name: label_variable(name, values) for name, values in variables.items()}
    labelled |= {name: v[0, 0] for name, v in boundary_variables(found.curves).items()}
    labelled |= {
        name: label_variable(name, CELL_VARIABLES[name].dtype(value)) for name, value in found.summary.items()
    }
    labelled |= _further(request, [name for name in solver.outputs if name not in labelled])  # type: ignore[misc]
    coords = {name: coordinate(name, values) for name, values in {**own, **cell}.items()}
    ds = xr.Dataset(labelled, coords=coords)  # all at once: piece by piece took a third of the time
    ds = stamp(ds, "response", _TITLE, system, cell, solver, units=units)
    ds.attrs |= boundary_check(system, np.array([r]), np.array([mu]))
    ds = with_units(ds, scales)
    return _commented(ds, found.comment)

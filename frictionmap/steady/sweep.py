"""`sweep`: regime maps of one system, or of many systems along further axes."""

from collections.abc import Mapping
from typing import Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..datasets.labels import NAMES
from ..datasets.physical import with_units
from ..datasets.variables import coordinate_of_study, stamp
from ..errors import InputError
from ..jobs import Progress, Watch
from ..model.settings import Solver, SolverSettings, merged
from ..model.system import System
from ..model.variations import Variations, checked_variations
from ..single.maps import checked_axes
from ..solvers.choose import engine_of
from ..units.dimensions import axes_in_ratios
from ..units.scales import Units, scales_of
from .configured import Configured, belt_speeds, system_and_axes
from .refinement import reduction_check


def sweep(
    system: System | Configured,
    r: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    mu: ArrayLike | None = None,
    *,
    solver: Solver | None = None,
    axes: Mapping[str, Any] | Variations | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    units: Units | None = None,
    wall_speed: ArrayLike | None = None,
    **settings: Unpack[SolverSettings],
) -> xr.Dataset:
    """Compute the regime of the steady state, and its stops per cycle, on a mu-r-beta grid.

    Parameters
    ----------
    system : System or Config
        A configuration of `load_config` brings its axes, settings and units; arguments replace them.
    r : array_like, shape (n_r,)
        Frequency ratios omega/omega_1 [-], >= 0, increasing.
    beta : array_like, shape (n_beta,)
        Ratios of kinetic friction force to load amplitude F/P (F/(k1 Y)) [-], >= 0, increasing.
    mu : array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing; default: 1.
    solver : Solver, optional
        Settings.  Single settings may also be given as keywords: start, cycles, tolerance, steps, skip,
        steady, outputs (see `Solver`); a keyword overrides the setting of `solver`.
    axes : mapping, optional
        Further axes: parameters of the system and their values, such as ``{"damping_ratios": [0, 0.01],
        "stiffness_ratios[2]": [0.5, 1, 2]}``; entries of a list are counted from 1.  Every axis is a
        dimension before mu (``stiffness_ratios_2``).  Parameters that vary together are a mapping under a
        name of their own: ``{"sample": {"mass_ratios[2]": [...], "stiffness_ratios[2]": [...]}}``.
    threads : int, optional
        Number of threads; default: all processors of the process.  The result is equal to the bit for any
        number.
    progress : callable, optional
        Called as progress(done, total); the quotient is the share of the work that is done.
    units : Units, optional
        Reference values that convert ratios to Hz and N.  Then r may be frequencies and beta friction forces:
        texts such as "4.2 Hz", or quantities of pint, astropy or unyt; numbers remain ratios.
    wall_speed : array_like, shape (n_v,)
        In the place of r, for one mass on a belt without a load: belt speeds over omega_1 P/k1 [-], > 0,
        increasing.  All motions of a cell are found, and no settings apply.

    Returns
    -------
    xarray.Dataset
        On (mu, r, beta): the requested outputs, and `status` if any cell is unresolved or averaged; with
        several contacts, springs, belts or loads of several harmonics always.  On (mu, r): `beta_lim`,
        `beta_stick`.  Unresolved cells have regime -1; `status` gives the reason.

        With units also `frequency(r)` [Hz], `friction_force(beta)` [N], and every quantity in m, N or J in
        addition to its ratio, such as `contact_amplitude_m` and `beta_lim_N`.  For a reduced structure the
        attribute `reduction` gives its errors, and `reduction_check` what all modes, or many more, change.

        With wall_speed on (mu, wall_speed, beta): `regime`, `also_reachable`, `growth`, `growth_frequency`,
        `cycle_period`, `stops_per_cycle`, `stuck_fraction`, `x_max`, `x_min`; of contacts that open and
        piecewise linear springs also `open_fraction`, `separations_per_cycle`, `normal_force_min`,
        `normal_force_max`, `spring_crossings`, `spring_force_max`; otherwise on (mu, beta)
        `cycle_speed_lim`; `beta_slope_lim`, `beta_slope_certificate`.

    Raises
    ------
    InputError
        An argument or a setting has the wrong type or is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.sweep(fm.System(), r=[0.3], beta=[0.01, 0.5, 1.0])
    >>> ds.stops_per_cycle.values
    array([[[ 0.,  2., nan]]], dtype=float32)
    """
    if (speeds := belt_speeds(system, wall_speed, r)) is not None:
        from ..no_load.sweep import belt_map

        _refuse_of_loads({"solver": solver, "axes": axes, **settings})
        given = system_and_axes(system, None, beta, mu, units, needs=("beta",))
        return belt_map(given.system, speeds, given.beta, given.mu, given.units, threads, progress)
    given = system_and_axes(system, r, beta, mu, units)
    if given.config is not None:
        solver = solver or given.config.solver
        axes = given.config.variations if axes is None else axes
    grid = (given.r, given.beta, given.mu)
    return swept(given.system, grid, merged(solver, settings), axes, threads, progress, given.units)


def _refuse_of_loads(given: Mapping[str, Any]) -> None:
    """Refuse arguments that have no meaning without a load."""
    for name, value in given.items():
        if value is not None:
            raise InputError("cannot use", name, "with wall_speed: there is no load; omit one of them")


def swept(
    system: System, given: tuple[ArrayLike, ArrayLike, ArrayLike], solver: Solver,
    axes: Mapping[str, Any] | Variations | None, threads: int | None, progress: Progress | None,
    units: Units | None, watch: Watch | None = None,
) -> xr.Dataset:  # fmt: skip
    """Compute the dataset of `sweep` over r, beta and mu; `watch` may end the computation."""
    own = axes_in_ratios(axes, scales_of(units, system))
    variations = None if own is None else checked_variations(system, own)
    scales = scales_of(units, system, variations)
    grid = checked_axes(*given, system.n if "amplitude" in solver.outputs else 1, scales)
    (variations or system).costs(grid["r"])
    if variations is None:
        engine = engine_of(system)
        ds = engine.map(grid, solver, threads, progress, watch)
    else:
        checks.cells(grid["mu"].size, grid["r"].size, grid["beta"].size, points=variations.count)
        ds = _study(variations, grid, solver, threads, progress, watch)
        engine = engine_of(variations.at(next(variations.points())))
    comment = ds.attrs.get("comment")
    asked = "status" in solver.outputs or engine.states_status
    if not asked and not ds.variables["status"].values.any():
        del ds["status"]  # kept where any cell is unresolved or averaged; a copy would take longer
    title = "Motion regimes and stops per cycle"
    ds = stamp(
        ds,
        "sweep",
        title,
        system,
        {name: grid[name] for name in ("r", "beta", "mu")},
        solver,
        study=None if variations is None else variations.described,
        units=units,
    )
    ds.attrs |= reduction_check(system, grid, solver, threads, watch)
    if comment:
        ds.attrs["comment"] = comment
    ds = ds if variations is None else ds.assign_attrs(system=variations.describe())
    return with_units(ds, scales)


def regime_map(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None,
    progress: Progress | None, watch: Watch | None = None,
) -> xr.Dataset:  # fmt: skip
    """Compute outputs, `status` and boundaries of one system over the axes mu, r and beta."""
    return engine_of(system).map(axes, solver, threads, progress, watch)


def _study(
    variations: Variations, grid: Mapping[str, np.ndarray], solver: Solver, threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Compute the maps of all points along further axes, in one dataset."""
    count = variations.count
    dims = [axis.name for axis in variations.axes]
    variables: dict[str, xr.Variable] = {}
    coords = study_coordinates(variations)
    comments: dict[str, None] = {}
    for done, point in enumerate(variations.points()):
        ds = regime_map(
            variations.at(point), grid, solver, threads, _progress_of_one(progress, done, count), watch
        )
        if not variables:
            coords |= {str(name): ds[name].variable for name in ds.coords}
            variables = {
                str(name): _allocate(variable.variable, dims, variations.shape)
                for name, variable in ds.data_vars.items()
            }
        for name, variable in ds.data_vars.items():
            variables[str(name)].values[point] = variable.values
        comments |= dict.fromkeys(filter(None, [ds.attrs.get("comment")]))
    found = xr.Dataset(variables, coords)
    return found.assign_attrs(comment=_joined(list(comments))) if comments else found


def _joined(comments: list[str]) -> str:
    """The comments on several maps in one: the first, and how many others there are."""
    others = len(comments) - 1
    more = "" if not others else f" (and {others} more comment{'s' * (others > 1)} along the further axes)"
    return comments[0] + more


def _allocate(one: xr.Variable, dims: list[str], shape: tuple[int, ...]) -> xr.Variable:
    """Allocate a variable like that of one map for many maps."""
    values = np.empty((*shape, *one.shape), one.dtype)
    return xr.Variable((*dims, *one.dims), values, one.attrs)


def _progress_of_one(progress: Progress | None, done: int, count: int) -> Progress | None:
    """Progress function for one map of many."""
    if progress is None or not callable(progress):
        return progress
    return lambda spent, total: progress(done * total + spent, count * total)


def study_coordinates(variations: Variations) -> dict[str, xr.Variable]:
    """Coordinates of the further axes: a parameter that varies alone, or a counter with its parameters as
    companions.

    An axis with the name of a variable of the map is refused.
    """
    coords = {}
    for axis in variations.axes:
        if axis.name in NAMES:
            raise InputError(
                f"cannot name a further axis {axis.name}: a map has this name already; use another one"
            )
        if axis.zipped:
            counted = np.arange(axis.size)
            coords[axis.name] = coordinate_of_study(axis.name, "points of several numbers", counted)
        for number, values in zip(axis.numbers, axis.values, strict=True):
            coords[number.dimension] = coordinate_of_study(axis.name, number.meaning, values)
    return coords

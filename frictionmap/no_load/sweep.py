"""Motions on a belt without a load over mu, belt speed and beta, and their boundaries, as datasets."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..errors import InputError
from ..jobs import Progress, Watch
from ..model.system import System
from ..units.axes import ratios, require
from ..units.scales import Scales, Units, scales_of
from .belts import Belts, belts_of, is_one_mass, is_phases
from .dataset import belt_dataset
from .limits import sliding_limits, slope_limits_of, speed_limits
from .one_mass import Law, cycle_speed_limits, empty_portraits, portrait_jobs, run, with_formula
from .opening import described, given_of, opening_values
from .structure_map import structure_values

#: Variables of the dataset and the fields of `Portraits` that they show.
_FIELDS = {
    "regime": "regime", "also_reachable": "reachable", "status": "status", "growth": "growth",
    "growth_frequency": "frequency", "cycle_period": "period", "stops_per_cycle": "stops",
    "stuck_fraction": "stuck", "x_max": "highest", "x_min": "lowest", "multiplier": "multiplier",
    "segment_crossings": "knots", "unstable_maximum": "threshold",
}  # fmt: skip


class Given(NamedTuple):
    """A system on a belt with checked axes."""

    system: System
    belts: Belts
    axes: dict[str, np.ndarray]  # mu, wall_speed, beta
    units: Units | None
    scales: Scales


def checked(
    system: System, wall_speed: ArrayLike, beta: ArrayLike, mu: ArrayLike, units: Units | None
) -> Given:
    """Check a system and axes of motions without a load.

    Raises
    ------
    InputError
        An axis is invalid, or motions without a load are not offered for the system.
    """
    belts = belts_of(system)
    if is_phases(system):
        given_of(system, belts)
    scales = scales_of(units, system)
    require(scales, wall_speed=("velocity", wall_speed), beta=("force", beta))
    speed = checks.axis(ratios(wall_speed, "wall_speed", "velocity", scales), "wall_speed", least=0.0)
    if speed[0] == 0.0:
        raise InputError("wall_speed", "must be > 0 without a load: a mass on a belt at rest stops; got 0")
    beta = checks.axis(ratios(beta, "beta", "force", scales), "beta", least=0.0)
    mu = checks.axis(mu, "mu", least=1.0)
    checks.cells(mu.size, speed.size, beta.size)
    return Given(system, belts, {"mu": mu, "wall_speed": speed, "beta": beta}, units, scales)


def belt_map(
    system: System, wall_speed: ArrayLike, beta: ArrayLike, mu: ArrayLike = 1.0, units: Units | None = None,
    threads: int | None = None, progress: Progress | None = None,
) -> xr.Dataset:  # fmt: skip
    """All motions on a belt without a load.

    Parameters
    ----------
    system : System
        Its loads are left out; see `belts_of`.
    wall_speed : array_like, shape (n_v,)
        Speeds of the belt over omega_1 P/k1 [-], > 0, increasing.
    beta : array_like, shape (n_beta,)
        Kinetic friction force just above speed 0 over P [-], >= 0, increasing.
    mu : array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing.
    units : Units, optional
        Reference values; then speeds may be texts such as "0.2 m/s", and beta forces.
    threads, progress : see `sweep`

    Raises
    ------
    InputError
        An axis is invalid, or the system is another one.
    """
    given = checked(system, wall_speed, beta, mu, units)
    if progress is not None and not callable(progress):
        raise InputError("progress", f"must be a function of two numbers; got {checks.one_line(progress)}")
    values = values_of_cells(given, threads, progress)
    if len(given.belts.groups) == 1 and not is_phases(system):
        values |= limits_of_motions(given)
    title = "Motions on a belt without a load"
    ds = belt_dataset("sweep", title, system, given.axes, values, units, given.scales)
    return described(ds, system) if is_phases(system) else ds


def values_of_cells(
    given: Given, threads: int | None, progress: Progress | None, watch: Watch | None = None
) -> dict[str, np.ndarray]:
    """Variables of all cells, without limits."""
    arguments = (given.system, given.belts, given.axes, threads, progress, watch)
    if is_phases(given.system):
        return opening_values(*arguments)
    if not is_one_mass(given.system):
        return structure_values(*arguments)
    return _one_mass_values(given, threads, progress, watch)


def belt_boundaries(
    system: System, wall_speed: ArrayLike, beta: ArrayLike, mu: ArrayLike = 1.0, units: Units | None = None
) -> xr.Dataset:
    """The limits of `belt_map` alone."""
    given = checked(system, wall_speed, beta, mu, units)
    title = "Limits of motions on a belt without a load"
    values = limits_of_motions(given)
    return belt_dataset("boundaries", title, system, given.axes, values, units, given.scales)


def limits_of_motions(given: Given) -> dict[str, np.ndarray]:
    """Limits over mu, belt speed and beta; those of one contact or one mass only where there is one."""
    belts, axes = given.belts, given.axes
    if is_phases(given.system):
        raise InputError(
            "cannot compute limits of motions without a load with contacts that open or piecewise linear "
            "springs: they are those of constant normal forces; compute the map"
        )
    if len(belts.groups) > 1:
        raise InputError(
            "cannot compute limits of motions without a load of several contacts: they are those of one; "
            "compute the map"
        )
    slope = slope_limits_of(given.system, belts)
    kinetic, ratio = friction_of(belts, axes["beta"], axes["mu"])
    values = {
        "beta_slope_lim": np.array(slope.limit),
        "beta_slope_certificate": np.array(slope.certificate),
        "beta_sliding_lim": sliding_limits(belts, slope.limit, axes["wall_speed"], is_one_mass(given.system)),
        "sliding_speed_lim": speed_limits(belts, slope.limit, kinetic),
    }
    if is_one_mass(given.system):
        limits = cycle_speed_limits(law_of(belts), given.system.zeta, ratio, kinetic)
        values["cycle_speed_lim"] = limits
    return values


def _one_mass_values(
    given: Given, threads: int | None, progress: Progress | None, watch: Watch | None
) -> dict[str, np.ndarray]:
    """Variables of all cells of one mass."""
    axes, belts = given.axes, given.belts
    found = empty_portraits((axes["mu"].size, axes["wall_speed"].size, axes["beta"].size))
    kinetic, ratio = friction_of(belts, axes["beta"], axes["mu"])
    axes_of_cells = (ratio, axes["wall_speed"], kinetic)
    run(portrait_jobs(law_of(belts), given.system.zeta, axes_of_cells, found), threads, progress, watch)
    if belts.share[0] < 0.0:  # the mirror image
        found = found._replace(highest=-found.lowest, lowest=-found.highest)
    if belts.laws[0].curve is not None:
        found = with_formula(found, belts.laws[0].curve, given.system.zeta, axes["wall_speed"], kinetic)
    values = {name: getattr(found, field) for name, field in _FIELDS.items()}
    values |= {"z_max": values["x_max"], "z_min": values["x_min"]}
    return values | {name: values[name][..., np.newaxis] for name in ("x_max", "x_min")}


def friction_of(belts: Belts, beta: np.ndarray, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Kinetic friction (n_beta,) and static over kinetic friction (n_mu,) of the only contact.

    Raises
    ------
    InputError
        Parallel contacts have different ratios.
    """
    group = belts.groups[0]
    ratios_of = [np.broadcast_to(one.static_ratio(mu), mu.shape) for one in group.members]
    if any((one != ratios_of[0]).any() for one in ratios_of):
        raise InputError(
            "contacts", "must have one mu where they are parallel, without a load; got different ones"
        )
    kinetic = np.broadcast_to(group.friction(beta, 1.0)[0], beta.shape)
    return np.ascontiguousarray(kinetic, float), np.ascontiguousarray(ratios_of[0], float)


def law_of(belts: Belts) -> Law:
    """Segments of the law of the only contact."""
    law = belts.laws[0]
    return np.array(law.speed), np.array(law.factor), np.array(law.slopes)

"""Motions of one mass on a belt without a load as a dataset over mu, belt speed and beta."""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..datasets.belt_labels import BELTS
from ..datasets.labels import attributes
from ..errors import InputError
from ..model.friction_law import FrictionLaw
from ..model.system import System
from ..units.axes import ratios, require
from ..units.scales import Units, scales_of
from .one_mass import Law, cycle_speed_limits, portraits

#: Variables of the dataset and the fields of `Portraits` that they show.
_FIELDS = {
    "regime": "regime", "also_reachable": "reachable", "status": "status", "growth": "growth",
    "growth_frequency": "frequency", "cycle_period": "period", "stops_per_cycle": "stops",
    "stuck_fraction": "stuck", "x_max": "highest", "x_min": "lowest", "multiplier": "multiplier",
    "segment_crossings": "knots", "unstable_maximum": "threshold",
}  # fmt: skip


def belt_map(
    system: System, wall_speed: ArrayLike, beta: ArrayLike, mu: ArrayLike = 1.0, units: Units | None = None
) -> xr.Dataset:
    """All motions of one mass on a belt, without a load.

    Parameters
    ----------
    system : System
        One mass with one rigid contact with the ground; the load is left out.
    wall_speed : array_like, shape (n_v,)
        Speeds of the belt over omega_1 P/k1 [-], > 0, increasing.
    beta : array_like, shape (n_beta,)
        Kinetic friction force just above speed 0 over P [-], >= 0, increasing.
    mu : array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing.
    units : Units, optional
        Reference values; then speeds may be texts such as "0.2 m/s", and beta forces.

    Raises
    ------
    InputError
        An axis is invalid, or the system is another one.
    """
    law = _law_of(system)
    scales = scales_of(units, system)
    require(scales, wall_speed=("velocity", wall_speed), beta=("force", beta))
    speed = checks.axis(ratios(wall_speed, "wall_speed", "velocity", scales), "wall_speed", least=0.0)
    if speed[0] == 0.0:
        raise InputError("wall_speed", "must be > 0 without a load: a mass on a belt at rest stops; got 0")
    beta = checks.axis(ratios(beta, "beta", "force", scales), "beta", least=0.0)
    mu = checks.axis(mu, "mu", least=1.0)
    checks.cells(mu.size, speed.size, beta.size)
    found = portraits(law, system.zeta, mu, speed, beta)
    values = {name: getattr(found, field) for name, field in _FIELDS.items()}
    values["cycle_speed_lim"] = cycle_speed_limits(law, system.zeta, mu, beta)
    # one mass: steady sliding is stable where 2 zeta + beta g' > 0, and then (Q) holds too
    values |= dict.fromkeys(("beta_slope_lim", "beta_slope_certificate"), np.float64(2.0 * system.zeta))
    axes = {"mu": mu, "wall_speed": speed, "beta": beta}
    return xr.Dataset(
        {name: _variable(name, one) for name, one in values.items()},
        {name: _variable(name, one) for name, one in axes.items()},
        {"title": "Motions on a belt without a load", "system": system.describe()},
    )


def _variable(name: str, values: np.ndarray) -> xr.Variable:
    return xr.Variable(BELTS[name].dims, values, attributes(BELTS[name]))


def _law_of(system: System) -> Law:
    """Segments of the law of the only contact.

    Raises
    ------
    InputError
        The system is not one mass with one rigid contact with the ground and nothing else.
    """
    if system.n != 1:
        raise InputError(
            f"cannot compute motions without a load of {system.n} masses: only of one; "
            f"for growth about steady sliding see beta_slope_lim of boundaries"
        )
    groups = system.contact_system.groups
    one = groups[0].first
    excluded = {
        "matrices": system.matrices is not None,
        "excitation": system.excitation != "force",
        "load_offset": bool(np.any(system.contact_system.offset)),
        "more than one contact": len(groups) > 1 or len(groups[0].members) > 1,
        f"kind = {one.kind}": one.kind != "fixed-wall",
        "stiffness": one.stiffness is not None,
        "normal_load": bool(one.nu) or one.normal_record is not None,
        "a wall_speed or wall_velocity of the contact": bool(one.wall_speed or one.wall_velocity),
        "force": one.force is not None,
        "mu of the contact": one.mu is not None,
        "ratio": one.ratio not in (None, 1.0),
    }
    for name, given in excluded.items():
        if given:
            raise InputError(f"cannot compute motions without a load with {name}; omit it")
    law = one.law or FrictionLaw()
    return np.array(law.speed), np.array(law.factor), np.array(law.slopes)

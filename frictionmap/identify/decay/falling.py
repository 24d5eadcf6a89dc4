"""Friction that falls with the speed in a decay: what it looks like there, and a warning of it.

Friction F (1 + a V) over the speed V is Coulomb friction F beside a damper F a: with F = m omega_n^2 x_F it
adds x_F omega_n a/2 to the damping ratio, and no decay tells one from the other.  A sum below 0 can only be
friction that falls, by -a >= 2 abs(sum)/(x_F omega_n).
"""

import numpy as np

from ..signals.turning_points import TurningPoints
from ..statistics.levels import FOUND
from .fit import fit_decay, noise_variance
from .motion import Decay
from .problem import ZETA, Record


def falling_friction(record: Record, points: TurningPoints, at_bound: bool, unit: str) -> list[str]:
    """Warn where friction that falls with the speed explains a record better than any damping.

    Parameters
    ----------
    record : Record
    points : turning points of the record
    at_bound : whether its damping ratio is 0, the least one
    unit : of displacements
    """
    if not at_bound or "zeta" in record.known:
        return []
    steady = record._replace(wander=None)
    without = fit_decay(steady, points)[0]
    fit = fit_decay(steady._replace(may_fall=True), points)[0]
    growth = (without.solution.sum - fit.solution.sum) / noise_variance(steady, fit)
    if fit.solution.values[ZETA] >= 0.0 or growth <= FOUND**2:
        return []
    return [describe_fall(fit.decay, unit)]


def describe_fall(decay: Decay, unit: str) -> str:
    """The slope of the fall, as far as a decay shows it."""
    omega = 2.0 * np.pi * decay.f_n
    slope = (
        f", by at least {200.0 * -decay.zeta / (decay.x_F * omega):.2g} % per {unit}/s" if decay.x_F else ""
    )
    return (
        f"friction falls with the speed{slope}: the sum of damping and the slope of friction is that of "
        f"zeta = {decay.zeta:.2g}, and zeta, x_F and their intervals do not hold (a loop shows the slope)"
    )

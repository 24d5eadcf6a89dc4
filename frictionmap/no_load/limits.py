"""Limits of steady sliding on a belt: friction and belt speeds at which it loses stability."""

import numpy as np

from ..general.slopes import SlopeLimits, limits_of
from ..model.system import System
from .belts import Belts, is_one_mass


def slope_limits_of(system: System, belts: Belts) -> SlopeLimits:
    """Limits of beta times the slope of a fall of friction; NaN with several contacts."""
    if len(belts.groups) > 1:
        return SlopeLimits(np.nan, np.nan, np.nan)
    modes = system.modes
    if is_one_mass(system):  # stable where 2 zeta + beta g' > 0, and then every motion ends there
        limit = 2.0 * system.zeta
        return SlopeLimits(limit, limit, 1.0)
    return limits_of(modes.mass, modes.damping, modes.stiffness, belts.groups[0].vector)


def sliding_limits(belts: Belts, limit: float, speed: np.ndarray, one_mass: bool) -> np.ndarray:
    """Friction ratio of the grid at which steady sliding loses stability, (n_v,).

    Infinite where the friction does not fall.  On a break point one mass spends half a turn in either
    segment, and delta_1/sqrt(1 - delta_1^2) + delta_2/sqrt(1 - delta_2^2) is zero where delta_1 = -delta_2:
    the mean of both slopes counts, unless the motion already leaves along delta = -1.  A structure is
    unstable there if it is in one of them.
    """
    below, above = belts.laws[0].slopes_at(speed)
    steepest = np.maximum(-np.minimum(above, below), 0.0)
    fall = np.maximum(-0.5 * (above + below), 0.0) if one_mass else steepest
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.where(fall > 0.0, limit / fall, np.inf)
        if one_mass:
            found = np.where(above != below, np.fmin(found, (2.0 + limit) / steepest), found)
    return _in_grid(belts, found)


def _in_grid(belts: Belts, friction: np.ndarray) -> np.ndarray:
    """The beta of the grid at which the contact has a friction; 0 or infinity where it never changes."""
    at_zero, at_one = (belts.groups[0].friction(beta, 1.0)[0] for beta in (0.0, 1.0))
    above = friction - at_zero
    if at_one == at_zero:
        return np.where(above > 0.0, np.inf, 0.0)
    return np.maximum(above / (at_one - at_zero), 0.0)


def speed_limits(belts: Belts, limit: float, friction: np.ndarray) -> np.ndarray:
    """Belt speed above which steady sliding is stable at all speeds, by the friction of the contact; 0 if it
    is stable at every speed.
    """
    falls = np.where(friction > 0.0, limit / np.where(friction > 0.0, friction, 1.0), np.inf)
    return np.array([belts.laws[0].last_fall(fall) for fall in falls.tolist()])

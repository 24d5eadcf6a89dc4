"""Belt speeds without squeal: from which steady sliding is stable, and from which nothing else exists.

The deviation d of a motion from steady sliding at the belt speed v loses energy as

    E' <= -d'.C1 d' + beta (g(v) - g(V)) (V - v),   V: speed in the contact; where it sticks, mu for g(0).

With C1 >= s c c^T it falls unless G(V) = beta g(V) + s V is above G(v) at a lower speed, or below it at a
higher one.  From the speed on where G rises and is above all that it was before, every motion ends in steady
sliding.
"""

from typing import NamedTuple

import numpy as np

from .. import regimes
from ..model.friction_law import FrictionLaw
from .belts import is_one_mass
from .limits import slope_limits_of, speed_limits
from .one_mass import cycle_speed_limits, portraits
from .structure_map import sliding_of
from .sweep import Given, friction_of, law_of

#: Belt speeds at which one mass is looked at, between the largest one with a known squeal and the one from
#: which none is possible; the least of them over the latter.
_SPEEDS, _LEAST = 400, 1e-4

#: Bits of the cycles.
_CYCLES = 1 << regimes.STICK_SLIP_CYCLE | 1 << regimes.CYCLE_WITHOUT_STOPS


class QuietSpeeds(NamedTuple):
    """Belt speeds over omega_1 P/k1; infinite where there is none."""

    quiet: float  # from which steady sliding is the only end of a motion; of a structure, as far as is proved
    sliding: float  # above which steady sliding is stable
    cycle: float  # above which there is no stick-slip cycle; NaN of a structure
    proved: float  # from which every motion is proved to end in steady sliding
    frequency: float  # of the vibration that grows first, over omega_1


def proved_speed(law: FrictionLaw, friction: float, ratio: float, slope: float) -> float:
    """Belt speed from which every motion ends in steady sliding, whatever it begins with; 0: at any.

    Parameters
    ----------
    law : FrictionLaw
    friction, ratio : kinetic friction just above speed 0, and static friction over it
    slope : s, of a fall of friction over speed that the damping outweighs
    """
    if friction == 0.0:
        return 0.0
    found, most = np.inf, friction * ratio  # most: the largest G up to the speed that is looked at
    ends = np.append(law.speed[1:], np.inf)
    for v, end, factor, fall in zip(law.speed, ends, law.factor, law.slopes, strict=True):
        level, rise = friction * factor + slope * v, friction * fall + slope
        if rise < 0.0 or (rise == 0.0 and (slope == 0.0 or most > level)):
            found = np.inf
        elif most > level:
            reached = v + (most - level) / rise
            found = reached if reached <= end else np.inf
        elif np.isinf(found):
            found = v
        most = max(most, level, level + rise * (end - v) if end < np.inf else most)
    return float(found)


def quiet_speeds(given: Given) -> QuietSpeeds:
    """Belt speeds for the first friction ratio and mu of the axes; their belt speeds do not matter."""
    kinetic, ratio = friction_of(given.belts, given.axes["beta"][:1], given.axes["mu"][:1])
    limits = slope_limits_of(given.system, given.belts)
    sliding = float(speed_limits(given.belts, limits.limit, kinetic)[0])
    proved = proved_speed(given.belts.laws[0], float(kinetic[0]), float(ratio[0]), limits.certificate)
    if not is_one_mass(given.system):
        return QuietSpeeds(max(proved, sliding), sliding, np.nan, proved, limits.frequency)
    cycle = float(cycle_speed_limits(law_of(given.belts), given.system.zeta, ratio, kinetic)[0, 0])
    quiet = max(sliding, cycle)
    if np.isinf(proved):  # nothing damps the vibrations at high speeds
        quiet = np.inf
    elif quiet < proved:
        quiet = _last_squeal(given, quiet, proved)
    return QuietSpeeds(quiet, sliding, cycle, proved, limits.frequency)


def _squeals(given: Given, speed: np.ndarray) -> np.ndarray:
    """Whether one mass has a cycle, at belt speeds (n,)."""
    kinetic, ratio = friction_of(given.belts, given.axes["beta"][:1], given.axes["mu"][:1])
    found = portraits(law_of(given.belts), given.system.zeta, ratio, speed, kinetic)
    squeals = (found.reachable & _CYCLES != 0) | (found.regime == regimes.UNRESOLVED)
    return np.asarray(squeals[0, :, 0])


def _last_squeal(given: Given, low: float, high: float) -> float:
    """The largest belt speed between two with a cycle; the lower one without any."""
    speed = np.geomspace(max(low, _LEAST * high), high, _SPEEDS)[1:]
    found = np.flatnonzero(_squeals(given, speed))
    if not found.size:
        return low
    low, high = float(speed[found[-1]]), float(speed[min(found[-1] + 1, speed.size - 1)])
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if _squeals(given, np.array([middle]))[0] else (low, middle)
    return low


def growths(given: Given, speed: np.ndarray) -> np.ndarray:
    """Growth of small vibrations about steady sliding at belt speeds (n,), over omega_1."""
    beta, mu = float(given.axes["beta"][0]), float(given.axes["mu"][0])
    return np.array([sliding_of(given.system, given.belts, v, beta, mu).growth for v in speed.tolist()])

"""All steady motions of one mass over mu, belt speed and beta."""

import numpy as np

from .. import checks
from .._kernels.no_load.fill import fill_cycle_speeds, fill_portraits
from .._kernels.no_load.portrait import Portraits

_TYPES = {"regime": np.int8, "reachable": np.uint8, "status": np.int8}

Law = tuple[np.ndarray, np.ndarray, np.ndarray]  # speeds, factors and slopes of its segments, (K,)


def _segments(law: Law) -> Law:
    speeds, factors, slopes = (np.ascontiguousarray(one, float) for one in law)
    return speeds, factors, slopes


def portraits(law: Law, zeta: float, mu: np.ndarray, wall_speed: np.ndarray, beta: np.ndarray) -> Portraits:
    """Steady sliding, the stick-slip cycle and all cycles without stops, over (mu, wall_speed, beta).

    Parameters
    ----------
    law : segments of friction over speed; speeds over omega_1 P/k1, from 0 on, factor 1 there, last slope
        >= 0
    zeta : damping ratio, >= 0
    mu, wall_speed, beta : increasing axes; mu >= 1, wall_speed > 0, beta >= 0

    Raises
    ------
    InputError
        An axis is empty, not increasing or out of range.
    """
    mu = checks.axis(mu, "mu", least=1.0)
    beta = checks.axis(beta, "beta", least=0.0)
    wall_speed = checks.axis(wall_speed, "wall_speed", least=np.nextafter(0.0, 1.0))
    shape = mu.size, wall_speed.size, beta.size
    found = Portraits(*(np.empty(shape, _TYPES.get(name, np.float64)) for name in Portraits._fields))
    fill_portraits(*_segments(law), float(zeta), mu, wall_speed, beta, found)
    return found


def cycle_speed_limits(law: Law, zeta: float, mu: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Largest belt speed with a stick-slip cycle, (n_mu, n_beta): 0 if none has one, infinite if any has."""
    found = np.empty((mu.size, beta.size))
    fill_cycle_speeds(*_segments(law), float(zeta), mu, beta, found)
    return found

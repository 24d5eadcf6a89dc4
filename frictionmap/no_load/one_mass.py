"""All steady motions of one mass over mu, belt speed and beta."""

import numpy as np

from .. import checks, regimes
from .._kernels.no_load.fill import fill_cycle_speeds, fill_portraits
from .._kernels.no_load.portrait import Portraits
from ..jobs import Job, Progress, Watch, run_counted
from ..model.friction_law import Formula

_TYPES = {"regime": np.int8, "reachable": np.uint8, "status": np.int8}

Law = tuple[np.ndarray, np.ndarray, np.ndarray]  # speeds, factors and slopes of its segments, (K,)

#: Belt speeds that differ from a break point by this share of it are on it: the break point would be passed
#: by vibrations as small as the rounding errors of the speed.
_ON_BREAK = 1e-14

#: Cells per job, some milliseconds of work.
_TILE = 64


def _segments(law: Law) -> Law:
    speeds, factors, slopes = (np.ascontiguousarray(one, float) for one in law)
    return speeds, factors, slopes


def _on_breaks(speed: np.ndarray, breaks: np.ndarray) -> np.ndarray:
    """Belt speeds, those next to a break point on it."""
    nearest = breaks[np.argmin(np.abs(speed[:, np.newaxis] - breaks), axis=1)]
    return np.where(np.abs(speed - nearest) <= _ON_BREAK * nearest, nearest, speed)


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
    found = empty_portraits((mu.size, wall_speed.size, beta.size))
    run_counted(portrait_jobs(law, zeta, (mu, wall_speed, beta), found), 1, None, None)
    return found


def empty_portraits(shape: tuple[int, int, int]) -> Portraits:
    """Arrays for the portraits of cells."""
    return Portraits(*(np.empty(shape, _TYPES.get(name, np.float64)) for name in Portraits._fields))


def portrait_jobs(
    law: Law, zeta: float, axes: tuple[np.ndarray, np.ndarray, np.ndarray], found: Portraits
) -> list[Job]:
    """Jobs that fill the portraits of all cells over (mu, wall_speed, beta)."""
    mu, beta = axes[0], axes[2]
    speed = _on_breaks(axes[1], np.asarray(law[0], float))
    rows = max(1, _TILE // max(1, beta.size))
    jobs: list[Job] = []
    for m in range(mu.size):
        for i in range(0, speed.size, rows):
            part = Portraits(*(one[m : m + 1, i : i + rows] for one in found))
            jobs.append(
                (
                    fill_portraits,
                    (*_segments(law), float(zeta), mu[m : m + 1], speed[i : i + rows], beta, part),
                )
            )
    return jobs


def with_formula(
    found: Portraits, curve: Formula, zeta: float, speed: np.ndarray, friction: np.ndarray
) -> Portraits:
    """Portraits with the growth by the slope of a formula, over (mu, wall_speed, beta).

    Stability of steady sliding follows the slope, which segments have to first order only.
    """
    delta = np.broadcast_to(zeta + 0.5 * friction * curve.slope(speed)[:, np.newaxis], found.growth.shape)
    root = np.sqrt(np.abs(1.0 - delta * delta))
    aperiodic = np.where(delta < 0.0, root - delta, -1.0 / (np.abs(delta) + root))
    growth = np.where(np.abs(delta) < 1.0, -delta, aperiodic)
    stable = growth < 0.0
    bit = np.uint8(1 << regimes.STEADY_SLIDING)
    differs = stable != (found.reachable & bit != 0)
    status = np.where(differs & (found.status == regimes.RESOLVED), regimes.BREAK_POINTS, found.status)
    reachable = np.where(stable, found.reachable | bit, found.reachable & ~bit)
    return found._replace(
        growth=growth, frequency=np.where(np.abs(delta) < 1.0, root, 0.0), status=status.astype(np.int8),
        reachable=reachable.astype(np.uint8),
    )  # fmt: skip


def cycle_speed_limits(law: Law, zeta: float, mu: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Largest belt speed with a stick-slip cycle, (n_mu, n_beta): 0 if none has one, infinite if any has."""
    found = np.empty((mu.size, beta.size))
    fill_cycle_speeds(*_segments(law), float(zeta), mu, beta, found)
    return found


def run(jobs: list[Job], threads: int | None, progress: Progress | None, watch: Watch | None = None) -> None:
    """Run jobs on the threads asked for."""
    run_counted(jobs, checks.threads(threads), progress, watch)

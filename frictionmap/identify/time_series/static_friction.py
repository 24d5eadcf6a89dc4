"""Static over kinetic friction of a steady motion: fitted where the data ask for it, else 1 with an interval.

What the data see is (mu - 1)^2, see `motion.inner`.
"""

import numpy as np

from ..statistics.cautions import interval_warnings
from ..statistics.least_squares import (
    Noise,
    Problem,
    Solution,
    growth,
    one_sided,
    profile_end,
    two_sided,
    unscaled_covariance,
)

#: Status of mu: known, 1 as the data do not require more, fitted, or without effect as the mass never sticks.
KNOWN, ONE, FITTED, IDLE = range(4)

#: Growth of the sum, over the variance of a sample, that one more unknown makes up for in 95 of 100 cases.
_CHANCE = 3.84


def is_asked_for(gain: float, problem: Problem, best: Solution, noise: Noise, index: int) -> bool:
    """Whether the sum falls by more than chance makes when mu is free.

    problem, best : with mu free
    """
    return gain > _CHANCE * noise.variance * float(growth(problem, best, noise)[index]) ** 2


def highest(problem: Problem, solution: Solution, noise: Noise, index: int) -> tuple[float, np.ndarray]:
    """The upper end of the interval of (mu - 1)^2, from the profile of the sum, and how the others move.

    problem : with mu free
    solution : with mu = 1
    """
    best = solution._replace(slopes=problem.residuals(solution.values)[1])
    if not best.slopes[:, index].any():
        return np.inf, np.zeros(solution.values.size)
    variance = noise.variance * float(growth(problem, best, noise)[index]) ** 2
    scale = float(np.sqrt(unscaled_covariance(problem, best)[index, index] * variance))
    allowed = one_sided(noise.freedom) ** 2 * variance
    square, end = profile_end(problem, best, index, allowed, scale)
    moved = end.values - best.values
    moved[index] = 0.0
    return square, moved


def mu_interval(
    static: int, with_law: Problem, solution: Solution, noise: Noise, index: int, error: float,
    idle: float = np.inf,
) -> tuple[float, float, np.ndarray]:  # fmt: skip
    """The interval of mu, and how the other values move up to its upper end if mu is 1 in the fit.

    static : KNOWN, ONE, FITTED or IDLE
    with_law : the problem with mu free, if it is not known
    error : standard error of (mu - 1)^2
    idle : the largest mu without an effect, if the mass never sticks
    """
    square, still = float(solution.values[index]), np.zeros(solution.values.size)
    if static == ONE:
        most, moved = highest(with_law, solution, noise, index)
        return 1.0, 1.0 + float(np.sqrt(most)), moved
    if static == IDLE:
        return 1.0, idle, still
    if static == FITTED:
        return *interval(square, two_sided(noise.freedom) * error), still
    mu = 1.0 + float(np.sqrt(max(square, 0.0)))
    return mu, mu, still


def mu_warnings(static: int, usable: bool) -> list[str]:
    """Warn of an interval of mu that begins at 1.

    usable : whether the standard error of mu has a meaning
    """
    words = [
        "mu = 1 explains the data as well as a larger mu does: the other estimates are those for mu = 1, "
        "and their intervals allow for the whole interval of mu"
    ]
    return (words if static == ONE else []) + interval_warnings("mu", 1.0, usable)


def interval(square: float, reach: float) -> tuple[float, float]:
    """Interval of mu from that of (mu - 1)^2."""
    return 1.0 + float(np.sqrt(max(square - reach, 0.0))), 1.0 + float(np.sqrt(square + reach))


def per_square(mu: float, error: float) -> float:
    """Change of mu with (mu - 1)^2, whose standard error is given.

    Where (mu - 1)^2 is below its error, mu - 1 is known no better than to the root of that.
    """
    spread = max(2.0 * (mu - 1.0), float(np.sqrt(error)))
    return 1.0 / spread if spread > 0.0 else 0.0

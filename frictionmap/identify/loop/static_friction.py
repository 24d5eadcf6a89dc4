"""Static over kinetic friction: an interval, from the samples between which the contact breaks away.

The force drops by (mu - 1) F between two samples of a branch, the last that is held and the first that
slips.  mu is between the forces, over F, that the spring of the contact has at these two.  The sum of squares
does not change with mu between them, and has no derivative by it.
"""

from typing import NamedTuple

import numpy as np

from ..statistics.least_squares import unscaled_covariance
from .branches import motion
from .fit import LoopFit
from .play import factor, forces
from .problem import DELAY, FRICTION, beside_contact, element_of, places_of

#: Growth of the sum, over the variance of a sample, within which a break-away may be elsewhere, and the same
#: in standard errors: chance makes more in 5 of 100 cases.
_CHANCE, _REACH = 3.84, 1.96


class Static(NamedTuple):
    """Static over kinetic friction."""

    lower: float
    upper: float
    constant: bool  # whether one value explains all break-aways; else the interval holds those of each


class _Branch(NamedTuple):
    """Spring's force of one branch, over F, before and after it breaks away."""

    last_held: float
    first_slipping: float


def static_friction(fit: LoopFit) -> Static:
    """The interval of mu that all break-aways leave."""
    found = _branches(fit)
    lower = max((one.last_held for one in found), default=1.0)
    upper = min((one.first_slipping for one in found), default=np.inf)
    if lower <= upper:
        return Static(max(lower, 1.0), max(upper, 1.0), True)
    return Static(max(upper, 1.0), max(lower, 1.0), False)


def _branches(fit: LoopFit) -> list[_Branch]:
    """The limits of mu in every branch, with the errors of the fit."""
    test, values = fit.test, fit.solution.values
    places, element = places_of(test), element_of(test, values)
    at = motion(fit.layout, values[places.displacement :], test.time - values[DELAY])
    measured = test.force - beside_contact(test, values, at)
    held = forces(element, places, fit.layout, values, at, measured, hold=True)
    senses = np.sign(np.diff(values[places.displacement :][: fit.layout.branches + 1]))
    covariance = unscaled_covariance(fit.problem, fit.solution)
    g = factor(element, np.abs(at.derivatives[1]))[0]
    result = []
    for j in np.unique(at.branch):
        here, sense = np.flatnonzero(at.branch == j), senses[j]
        strength = element.friction * (1.0 + sense * element.asymmetry)
        gain = (measured[here] - held.force[here]) ** 2 - (measured[here] - sense * strength * g[here]) ** 2
        gain = np.append(np.cumsum(gain[::-1])[::-1], 0.0) / test.sigma_force**2
        possible = np.flatnonzero(gain >= gain.max() - _CHANCE)
        first, last = int(possible[0]), int(possible[-1])

        def limit(k: int, way: float, sense: float = sense, strength: float = strength) -> float:
            """The spring's force at a sample over the friction, and beyond it what its error allows."""
            share = sense * held.force[k] / strength
            slopes = sense * held.slopes[k] / strength
            slopes[FRICTION] -= share / element.friction
            return float(share + way * _REACH * np.sqrt(max(slopes @ covariance @ slopes, 0.0)))

        before = limit(here[first - 1], -1.0) if first else -np.inf
        after = limit(here[last], 1.0) if last < here.size else np.inf
        # where g(V) is larger than mu, it is g(V) that the spring's force reaches
        reached = float(g[here[min(first, here.size - 1)]])
        result.append(_Branch(before if before > reached else -np.inf, after if after > reached else np.inf))
    return result

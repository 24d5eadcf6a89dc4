"""Residuals of the measured motion and of the force, in the joint least squares of a loop."""

from typing import NamedTuple

import numpy as np

from ..statistics.least_squares import Problem
from .branches import Layout, Motion, motion
from .play import Element, Forces, Places, factor, forces

#: Parameters in the order of the fit; factors of the speed law follow, then the state at the beginning.
FRICTION, STIFFNESS, MU, BACKLASH, ASYMMETRY, SPRING, SLOPE, MASS, DELAY, OFFSET, DRIFT = range(11)
NAMES = (
    "friction", "contact_stiffness", "mu", "backlash", "asymmetry", "parallel_stiffness", "slope", "mass",
    "delay", "offset", "drift",
)  # fmt: skip

#: Of u, u' and u'': kg mm/s^2 are millinewtons.
_SCALES = (1.0, 1.0, 1e-3)


class DamperTest(NamedTuple):
    """A damper test."""

    time: np.ndarray  # s
    moved: np.ndarray  # mm, or mm/s
    force: np.ndarray  # N
    order: int  # 0: `moved` is a displacement, 1: a velocity
    speeds: np.ndarray  # mm/s, knots of the speed law, beginning with 0
    sigma_moved: float = 1.0
    sigma_force: float = 1.0
    break_seen: bool = (
        False  # whether the contact slips from where the force shows it, not from where (L1) says
    )

    @property
    def named(self) -> int:
        """How many parameters have names: all but the state and the displacement."""
        return len(NAMES) + self.factors

    @property
    def factors(self) -> int:
        """Unknown factors of the speed law."""
        return max(self.speeds.size - 1, 0)

    @property
    def names(self) -> tuple[str, ...]:
        """The named parameters."""
        return (*NAMES, *(f"factor_{k + 1}" for k in range(self.factors)))


def places_of(test: DamperTest) -> Places:
    """Where the numbers of the contact are among the unknowns."""
    first = len(NAMES)
    return Places(
        FRICTION, STIFFNESS, BACKLASH, ASYMMETRY, tuple(range(first, first + test.factors)), test.named,
        test.named + 1,
    )  # fmt: skip


def element_of(test: DamperTest, values: np.ndarray) -> Element:
    """The contact that some values of the unknowns describe."""
    factors = np.concatenate(([1.0], values[len(NAMES) : test.named]))
    return Element(
        values[FRICTION], values[STIFFNESS], values[BACKLASH], values[MU], values[ASYMMETRY], test.speeds,
        factors, values[test.named],
    )  # fmt: skip


def modelled_force(test: DamperTest, layout: Layout, values: np.ndarray) -> Forces:
    """The force at the times of the samples, and its derivatives by all unknowns (L1)."""
    places = places_of(test)
    at = motion(layout, values[places.displacement :], test.time - values[DELAY])
    beside = beside_contact(test, values, at)
    measured = test.force - beside if test.break_seen else None
    found = forces(element_of(test, values), places, layout, values, at, measured)
    force, slopes = found.force + beside, found.slopes
    by_delay = np.zeros(force.size)
    for n, place in enumerate((SPRING, SLOPE, MASS)):
        slopes[:, place] += _SCALES[n] * at.derivatives[n]
        slopes[:, places.displacement :] += values[place] * _SCALES[n] * at.slopes[n]
        by_delay -= values[place] * _SCALES[n] * at.derivatives[n + 1]
    slopes[:, OFFSET] += 1.0
    slopes[:, DRIFT] += test.time - values[DELAY]
    slopes[:, DELAY] += by_delay - values[DRIFT] + _contact_by_delay(test, values, found, at)
    return found._replace(force=force, slopes=slopes)


def beside_contact(test: DamperTest, values: np.ndarray, at: Motion) -> np.ndarray:
    """The force that does not go through the contact."""
    force = values[OFFSET] + values[DRIFT] * (test.time - values[DELAY])
    for n, place in enumerate((SPRING, SLOPE, MASS)):
        force += values[place] * _SCALES[n] * at.derivatives[n]
    return force


def _contact_by_delay(test: DamperTest, values: np.ndarray, found: Forces, at: Motion) -> np.ndarray:
    """Derivative of the force of the contact by the delay: all of it depends on u(t - d) and u'(t - d)."""
    element = element_of(test, values)
    stretched = np.abs(found.force) > 0.0
    g_slope = factor(element, np.abs(at.derivatives[1]))[1]
    sense = np.sign(found.force)
    strength = element.friction * (1.0 + sense * element.asymmetry)
    slipping = -sense * strength * g_slope * np.sign(at.derivatives[1]) * at.derivatives[2]
    return np.where(found.slips, slipping, np.where(stretched, -element.stiffness * at.derivatives[1], 0.0))


def problem(test: DamperTest, layout: Layout, free: np.ndarray, fixed_motion: bool = False) -> Problem:
    """The least squares of both channels; `free`: (named,) bool."""
    first = places_of(test).displacement

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = modelled_force(test, layout, values)
        of_force = (found.force - test.force) / test.sigma_force
        by_force = found.slopes / test.sigma_force
        if fixed_motion:
            return of_force, by_force
        at = motion(layout, values[first:], test.time)
        of_motion = (at.derivatives[test.order] - test.moved) / test.sigma_moved
        by_motion = np.zeros((test.time.size, values.size))
        by_motion[:, first:] = at.slopes[test.order] / test.sigma_moved
        return np.concatenate((of_motion, of_force)), np.concatenate((by_motion, by_force))

    size = first + layout.size
    wanted = np.ones(size, dtype=bool)
    wanted[: test.named] = free
    wanted[first:] = not fixed_motion
    if test.order == 1:  # a velocity does not show where the motion begins
        wanted[first] = False
    lowest = np.full(size, -np.inf)
    lowest[[FRICTION, STIFFNESS]] = 0.0
    return Problem(residuals, wanted, np.full(size, -np.inf), lowest, np.full(size, np.inf))

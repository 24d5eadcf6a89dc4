"""What a damper test shows, by likelihood ratios, and what no parameter of the fit explains."""

from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from ..statistics.least_squares import Problem
from ..statistics.levels import CHANCE
from .descent import descend
from .fit import LoopFit
from .problem import BACKLASH, MU, NAMES, modelled_force, problem
from .static_friction import static_friction

VERDICTS = {
    "friction": "friction in a contact with a spring",
    "no_slip": "nothing slips: only the sum of the stiffnesses and a lower bound of the friction are known",
    "rigid": "the contact slips at once: of its stiffness only a lower bound is known",
    "backlash": "friction in a contact with play",
    "speed_dependent": "friction that depends on the speed",
    "peak": "static friction exceeds kinetic friction",
}

#: Evaluations of a fit without something.
_STEPS = 30

#: Slopes by one parameter more have a direction of their own if this share of them is left beside the others.
_OWN = 1e-3


class Step(NamedTuple):
    """What residuals say of a column beside those of the fit, to first order."""

    size: float
    error: float  # its standard deviation; infinite if it is not seen

    @property
    def ratio(self) -> float:
        """The size over its standard deviation: a normal deviate if the column is not needed."""
        return self.size / self.error


def features(fit: LoopFit, held: np.ndarray, peak: bool) -> str:
    """The most significant one of what was fitted beside friction: growth of chi square without it.

    peak : whether the interval of mu excludes 1
    """
    law = np.flatnonzero(np.isnan(held[len(NAMES) :])) + len(NAMES)
    absent = {
        "backlash": (np.flatnonzero(np.isnan(held[[BACKLASH]])) + BACKLASH, 0.0),
        "speed_dependent": (law, 1.0),
        "peak": (np.array([MU] if peak else [], dtype=int), 1.0),
    }
    found = {"friction": 1.0}
    for name, (places, value) in absent.items():
        if places.size:
            limit = float(chdtri(places.size, CHANCE))
            found[name] = (_without(fit, places, value) - fit.solution.sum) / limit
    return max(found, key=lambda name: found[name])


def _without(fit: LoopFit, places: np.ndarray, value: float) -> float:
    """The least sum by (L1) with some parameters at a value at which they do nothing."""
    free, values = fit.problem.free.copy(), fit.solution.values.copy()
    free[places], values[places] = False, value
    task = _task(fit, False)
    return descend(task._replace(free=task.free & free), values, _STEPS).sum


def _task(fit: LoopFit, break_seen: bool) -> Problem:
    """The problem of a fit, in which the contact breaks away where the force shows it, or by (L1)."""
    test = fit.test._replace(break_seen=break_seen)
    return problem(test, fit.layout, fit.problem.free[: test.named])


def step(fit: LoopFit, column: np.ndarray) -> Step:
    """The step along a column that the residuals ask for, beside what is fitted (Rao's score test).

    column : (samples,) of the force, over its noise
    """
    seen = fit.problem.free & (np.linalg.norm(fit.solution.slopes, axis=0) > 0.0)
    own = fit.solution.slopes[:, seen]
    own = own / np.linalg.norm(own, axis=0)
    whole = np.concatenate((np.zeros(fit.test.time.size), column))
    beside = whole - own @ np.linalg.lstsq(own, whole)[0]
    square = float(beside @ beside)
    if square <= _OWN**2 * float(whole @ whole):
        return Step(0.0, np.inf)
    return Step(-float(beside @ fit.solution.residual) / square, 1.0 / float(np.sqrt(square)))


def missing(fit: LoopFit, named: list[str]) -> str:
    """The parameter that the force asks for most, beyond chance, though it is neither fitted nor known."""
    slopes = modelled_force(fit.test, fit.layout, fit.solution.values).slopes / fit.test.sigma_force
    absent = [k for k, name in enumerate(fit.test.names) if name not in named]
    falls = {"": 1.0}
    for k in absent:
        if k == MU:
            falls["mu"] = _break_elsewhere(fit)
        elif not (k == BACKLASH and step(fit, slopes[:, k]).size <= 0.0):  # a play is not negative
            falls[fit.test.names[k]] = step(fit, slopes[:, k]).ratio ** 2 / float(
                chdtri(1, CHANCE / len(absent))
            )
    return max(falls, key=lambda name: falls[name])


def _break_elsewhere(fit: LoopFit) -> float:
    """Fall of the sum, over chance, if each branch slips from where its force shows it, and not at mu."""
    shown = static_friction(fit)
    if fit.test.break_seen and shown.lower <= max(fit.solution.values[MU], 1.0) <= shown.upper:
        return 0.0
    by_law, seen = (descend(_task(fit, way), fit.solution.values, _STEPS).sum for way in (False, True))
    return (by_law - seen) / float(chdtri(fit.layout.branches, CHANCE))

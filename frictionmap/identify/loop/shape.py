"""The branches of a measured displacement or velocity, from its own noise: a start for the joint fit."""

import numpy as np

from ..signals.turning_points import noise_level, turns
from ..statistics.least_squares import Problem, Solution
from .branches import Layout, motion
from .descent import descend

#: Turning points are where the motion turns back by this many standard deviations of its noise, and by this
#: share of its range.
_NOISES, _SHARE = 12.0, 0.002

#: The same for the fitted motion, which the noise moves by a part of its standard deviation.
_FITTED_NOISES = 3.0

#: Terms of a branch that are tried.  Four at least: the force sees less than the noise of the displacement.
_TERMS = (4, 6, 8, 10, 14, 20)

#: Evaluations, of a fit that is only a start.
_STEPS = 30

#: Samples of a branch for each of its terms, at least.
_FEW = 3


def displacement_of(time: np.ndarray, moved: np.ndarray, order: int) -> np.ndarray:
    """The displacement, from zero if it is the integral of a velocity."""
    if order == 0:
        return moved
    steps = 0.5 * (moved[1:] + moved[:-1]) * np.diff(time)
    return np.concatenate(([0.0], np.cumsum(steps)))


def reversals(time: np.ndarray, moved: np.ndarray, order: int) -> np.ndarray:
    """Samples at which the displacement turns back."""
    u = displacement_of(time, moved, order)
    return _turned(u, max(_NOISES * noise_level(u), _SHARE * float(np.ptp(u))))


def _turned(u: np.ndarray, swing: float) -> np.ndarray:
    """Samples at which a displacement turns back by more than `swing`."""
    found = np.array(turns(u, swing), dtype=int)
    # the first one is where the record begins unless the motion came from farther than that
    return found[1:] if found.size and np.ptp(u[: found[0] + 1]) <= swing else found


def shape_fit(time: np.ndarray, moved: np.ndarray, order: int) -> tuple[Layout, Solution]:
    """Branches, straight or as smooth as the information of the samples (BIC) asks for."""
    turned = reversals(time, moved, order)
    while True:
        layout, solution = _smooth(time, moved, order, turned)
        noise = float(np.sqrt(solution.sum / (time.size - layout.size)))
        more = _turned(motion(layout, solution.values, time).derivatives[0], _FITTED_NOISES * noise)
        # a velocity is known by the sum of its noise: there the samples alone show turning points
        if order or more.size <= turned.size:
            return layout, solution
        turned = more


def _smooth(time: np.ndarray, moved: np.ndarray, order: int, turned: np.ndarray) -> tuple[Layout, Solution]:
    """Branches between given turning points."""
    found = []
    for terms in (-1, *_TERMS):
        layout = _layout(time, turned, terms)
        if layout.size >= time.size:
            continue
        solution = _fit(layout, time, moved, order, turned)
        found.append((time.size * np.log(solution.sum) + layout.size * np.log(time.size), layout, solution))
    best = min(found, key=lambda one: one[0])
    return best[1], best[2]


def _layout(time: np.ndarray, turned: np.ndarray, terms: int) -> Layout:
    edges = np.concatenate(([0], turned, [time.size]))
    most = np.maximum(np.diff(edges) // _FEW, 0)
    counts = tuple(int(min(terms, one)) for one in most)
    return Layout(float(time[0]), float(time[-1]), counts)


def _fit(layout: Layout, time: np.ndarray, moved: np.ndarray, order: int, turned: np.ndarray) -> Solution:
    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        at = motion(layout, values, time)
        return at.derivatives[order] - moved, at.slopes[order]

    free = np.ones(layout.size, dtype=bool)
    free[0] = order == 0
    unbounded = np.full(layout.size, np.inf)
    u = displacement_of(time, moved, order)
    start = np.zeros(layout.size)
    start[: layout.branches + 1] = u[np.concatenate(([0], turned, [time.size - 1]))]
    start[layout.times] = time[turned]
    return descend(Problem(residuals, free, -unbounded, -unbounded, unbounded), start, _STEPS)

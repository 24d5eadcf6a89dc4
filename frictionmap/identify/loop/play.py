"""Force of a spring with play in series with friction, along the branches of a displacement (L1).

w_j + s |u - U_j| is how far the end of the spring has been carried from the middle of the play.  Where it
reaches max(mu, g(V)) F/k_t + b/2 the contact slips, to the end of the branch, with the force s F g(V).
"""

from typing import NamedTuple

import numpy as np

from .branches import Layout, Motion


class Element(NamedTuple):
    """What a contact is: F in both directions, k_t, b, mu, and the knots of g."""

    friction: float
    stiffness: float
    backlash: float
    mu: float
    asymmetry: float
    speeds: np.ndarray  # knots, beginning with 0
    factors: np.ndarray  # g there, beginning with 1
    state: float  # w at the beginning


class Places(NamedTuple):
    """Where the numbers of an element are among all unknowns."""

    friction: int
    stiffness: int
    backlash: int
    asymmetry: int
    factors: tuple[int, ...]  # of the second knot, and of further ones
    state: int
    displacement: int  # the first unknown of the displacement


class Forces(NamedTuple):
    """Force at the samples, its derivatives by all unknowns, and what slips."""

    force: np.ndarray
    slopes: np.ndarray
    slips: np.ndarray  # bool (samples,)
    broke: np.ndarray  # bool (branches,)


def factor(element: Element, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """g at some speeds, its derivative by the speed, and those by its values at the knots."""
    knots = element.speeds
    if knots.size < 2:
        return np.ones(speed.size), np.zeros(speed.size), np.zeros((speed.size, 1))
    k = np.clip(np.searchsorted(knots, speed, side="right") - 1, 0, knots.size - 2)
    width = knots[k + 1] - knots[k]
    share = np.minimum((speed - knots[k]) / width, 1.0)  # the last value holds beyond the last knot
    slope = np.where(share < 1.0, (element.factors[k + 1] - element.factors[k]) / width, 0.0)
    by_knot = np.zeros((speed.size, knots.size))
    rows = np.arange(speed.size)
    by_knot[rows, k], by_knot[rows, k + 1] = 1.0 - share, share
    return by_knot @ element.factors, slope, by_knot


def forces(
    element: Element, places: Places, layout: Layout, values: np.ndarray, at: Motion,
    measured: np.ndarray | None = None, hold: bool = False,
) -> Forces:  # fmt: skip
    """The force of the element at the samples of a motion.

    values : all unknowns
    measured : forces (samples,) by which the first sample that slips is found, instead of by the law
    hold : the force of the spring up to the end of each branch, as if it slipped after that only
    """
    of_u = slice(places.displacement, values.size)
    ends = values[of_u][: layout.branches + 1]
    n = at.branch.size
    force, slips, broke = np.empty(n), np.zeros(n, dtype=bool), np.zeros(layout.branches, dtype=bool)
    slopes = np.zeros((n, values.size))
    carried, by = element.state, np.zeros(values.size)
    by[places.state] = 1.0
    for j in range(layout.branches):
        here = np.flatnonzero(at.branch == j)
        sense = 1.0 if ends[j + 1] > ends[j] else -1.0
        w = carried + at.derivatives[0, here] - ends[j]
        own = np.tile(by, (here.size, 1))
        own[:, of_u] += at.slopes[0][here]
        own[:, places.displacement + j] -= 1.0
        slipping, broke[j] = _slips(
            element, sense, w, np.abs(at.derivatives[1, here]), carried + ends[j + 1] - ends[j]
        )
        force[here], slopes[here] = _held(element, places, w, own)
        if measured is not None:
            g = factor(element, np.abs(at.derivatives[1, here]))[0]
            slipping = _seen(measured[here], force[here], sense * _strength(element, sense) * g)
            broke[j] = bool(slipping.any())
        slipping = slipping & (not hold)
        slips[here] = slipping
        late = here[slipping]
        if late.size:
            force[late], slopes[late] = _slipping(
                element, places, sense, at.derivatives[1, late], at.slopes[1][late], of_u
            )
        carried, by = _after(element, places, sense, bool(broke[j]), carried, by, ends, j)
    return Forces(force, slopes, slips, broke)


def _strength(element: Element, sense: float) -> float:
    """Friction in one direction."""
    return element.friction * (1.0 + sense * element.asymmetry)


def _slips(
    element: Element, sense: float, w: np.ndarray, speed: np.ndarray, last: float
) -> tuple[np.ndarray, bool]:
    """Which samples of a branch slip, and whether it slips before its end."""
    reach = _strength(element, sense) / element.stiffness
    limit = np.maximum(element.mu, factor(element, speed)[0]) * reach + 0.5 * element.backlash
    slipping = np.logical_or.accumulate(sense * w >= limit)
    at_end = sense * last >= max(element.mu, 1.0) * reach + 0.5 * element.backlash
    return slipping, bool(at_end or slipping.any())


def _seen(measured: np.ndarray, held: np.ndarray, slipping: np.ndarray) -> np.ndarray:
    """Which samples of a branch slip, so that the sum of squares is the least; bool (samples,)."""
    gain = (measured - held) ** 2 - (measured - slipping) ** 2
    from_here = np.append(np.cumsum(gain[::-1])[::-1], 0.0)
    return np.arange(measured.size) >= np.argmax(from_here)


def _held(element: Element, places: Places, w: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """k_t sgn(w) max(|w| - b/2, 0) and its derivatives."""
    stretched = np.maximum(np.abs(w) - 0.5 * element.backlash, 0.0)
    side = np.sign(w)
    touching = stretched > 0.0
    slopes = np.where(touching[:, np.newaxis], element.stiffness * own, 0.0)
    slopes[:, places.stiffness] += side * stretched
    slopes[:, places.backlash] -= np.where(touching, 0.5 * element.stiffness * side, 0.0)
    return element.stiffness * side * stretched, slopes


def _slipping(
    element: Element, places: Places, sense: float, velocity: np.ndarray, by: np.ndarray, of_u: slice
) -> tuple[np.ndarray, np.ndarray]:
    """S F g(V) and its derivatives."""
    g, slope, by_knot = factor(element, np.abs(velocity))
    strength = _strength(element, sense)
    slopes = np.zeros((velocity.size, of_u.stop))
    slopes[:, of_u] = (sense * strength * slope * np.sign(velocity))[:, np.newaxis] * by
    slopes[:, places.friction] += sense * (1.0 + sense * element.asymmetry) * g
    slopes[:, places.asymmetry] += element.friction * g
    for k, place in enumerate(places.factors, 1):
        slopes[:, place] += sense * strength * by_knot[:, k]
    return sense * strength * g, slopes


def _after(
    element: Element, places: Places, sense: float, slipped: bool, carried: float, by: np.ndarray,
    ends: np.ndarray, j: int,
) -> tuple[float, np.ndarray]:  # fmt: skip
    """w_{j+1} and its derivatives."""
    if not slipped:
        by = by.copy()
        by[places.displacement + j + 1] += 1.0
        by[places.displacement + j] -= 1.0
        return carried + ends[j + 1] - ends[j], by
    strength = _strength(element, sense)
    by = np.zeros(by.size)
    by[places.friction] = sense * (1.0 + sense * element.asymmetry) / element.stiffness
    by[places.asymmetry] = element.friction / element.stiffness
    by[places.stiffness] = -sense * strength / element.stiffness**2
    by[places.backlash] = 0.5 * sense
    return sense * (strength / element.stiffness + 0.5 * element.backlash), by

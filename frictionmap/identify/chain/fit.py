"""The chain of masses nearest to measured amplitudes and phases over frequency.

Without damping the model is infinite at every natural frequency, and a fit cannot pass one across a sample.
Damping ratios open a way around: a search begins with damped chains and ends with the requested ones.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ...model.modes import wrapped
from ..signals.turning_points import turns
from ..statistics.least_squares import Problem, Solution, minimise
from ..statistics.robust import soften
from .inverse import chain_of, other_sides
from .response import modes, response_and_slopes

#: Mass and stiffness ratios are within this factor of one, as are frequencies relative to the peaks.
_RATIO_RANGE = 1e3

#: Damping ratios with which a search begins, that it may reach, and at which the model ends.
_FIRST_DAMPING, _SMALL_DAMPING, _MOST_DAMPING, _LEAST_DAMPING = 0.1, 0.02, 0.9, -0.5

#: A search gives less weight to relative errors beyond this.
_OUTLIER = 0.1

#: Ratios with which a search begins are within this factor of one, by its logarithm.
_SPREAD = 1.2

#: Evaluations of one search.
_MOST_STEPS = 60

#: Maximum number of searches; fewer once the least sum has been found this often with plausible errors.
SEARCHES, _FOUND_AGAIN = 24, 3

#: Sums of squares that differ by less than this share are the same minimum.
_SAME_SUM = 1e-4

#: Relative errors that no measurement has: sums of smaller ones are zero.
_ROUNDING = 1e-8

#: Solutions, and searches with more unknowns free, whose sums exceed the least one by this factor are not
#: followed.
HOPELESS = 3.0

#: A peak stands out by this factor, by its logarithm: more than noise makes.
_PEAK = 0.3


class Measured(NamedTuple):
    """Measured data of a chain, s numbers: lags [rad] and natural logarithms of amplitude ratios."""

    frequency: np.ndarray  # (s,) Hz
    mass: np.ndarray  # (s,) from 0
    is_phase: np.ndarray  # (s,) bool
    value: np.ndarray  # (s,)
    sigma: np.ndarray  # (s,) its error
    n: int  # masses of the chain
    base_damping: bool = False  # whether dampers see the base
    relative: bool = False  # whether errors of amplitudes are relative ones, T(6.16), not logarithms

    def amplitudes(self, mass: int) -> tuple[np.ndarray, np.ndarray]:
        """Increasing frequencies and mean logarithms of the amplitudes of a mass."""
        chosen = (self.mass == mass) & ~self.is_phase
        at, row, count = np.unique(self.frequency[chosen], return_inverse=True, return_counts=True)
        return at, np.bincount(row, weights=self.value[chosen]) / count


def differences(data: Measured, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Model less data, shape (s,), and its derivatives by the unknowns, shape (s, 3 n - 1)."""
    at, row = np.unique(data.frequency, return_inverse=True)
    response, slopes = response_and_slopes(values, at, data.base_damping)
    one = response[row, data.mass]
    logarithm = slopes[row, data.mass] / one[:, np.newaxis]
    amplitude, by_amplitude = np.log(np.abs(one)) - data.value, logarithm.real
    if data.relative:
        by_amplitude = np.exp(amplitude)[:, np.newaxis] * by_amplitude
        amplitude = np.expm1(amplitude)
    lag = wrapped(-np.angle(one) - data.value)
    phase = data.is_phase
    return np.where(phase, lag, amplitude), np.where(phase[:, np.newaxis], -logarithm.imag, by_amplitude)


def problem(data: Measured, known: np.ndarray) -> Problem:
    """Least squares of all samples; `known`, shape (3 n - 1,), holds what is held, NaN of what is fitted."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found, slopes = differences(data, values)
        return found / data.sigma, slopes / data.sigma[:, np.newaxis]

    ratios = 2 * data.n - 1
    floor = np.full(known.size, -np.inf)
    floor[ratios:] = 0.0
    lowest, highest = np.full(known.size, _LEAST_DAMPING), np.full(known.size, _MOST_DAMPING)
    lowest[:ratios], highest[:ratios] = -np.log(_RATIO_RANGE), np.log(_RATIO_RANGE)
    centre = np.log(np.median(data.frequency))
    lowest[0], highest[0] = lowest[0] + centre, highest[0] + centre
    return Problem(residuals, np.isnan(known), floor, lowest, highest)


class Found(NamedTuple):
    """The least sum, all other minima that were found on the way, and how often the least one was."""

    best: Solution
    others: list[Solution]
    times: int
    nothing: float  # sums below this are zero
    outliers: float | None = None  # residuals beyond this, over their errors, have little weight


def fit_chain(data: Measured, known: np.ndarray, outliers: float | None = None) -> tuple[Found, Problem]:
    """The least sum over searches from many starts, always the same ones; the problem is the plain one."""
    plain = problem(data, known)
    task = plain if outliers is None else soften(plain, outliers)
    minima: list[Solution] = []
    times, nothing = 0, no_sum(data)
    for start in _starts(data, known):
        least = max(minima[0].sum, nothing) if minima else np.inf
        end = _search(data, known, task, start)
        if np.sum(task.residuals(end)[0] ** 2) > HOPELESS * least:
            continue
        found = minimise(task, np.where(task.free, end, known))
        sum_found = max(found.sum, nothing)
        if sum_found < least * (1.0 - _SAME_SUM):
            times = 1
        elif sum_found < least * (1.0 + _SAME_SUM):
            times += 1
        minima = sorted([*minima, found], key=lambda one: one.sum)
        # the first mass has one answer only; others may have several, which are looked for
        if times >= _FOUND_AGAIN and 0 in data.mass and _usual_error(data, minima[0]) < _OUTLIER:
            break
    if 0 in data.mass and not task.free[2 * data.n - 1 :].any() and not known[2 * data.n - 1 :].any():
        sides = other_sides(task, minima[0], data.amplitudes(0)[0], data.n)
        times = times if sides[0].sum >= minima[0].sum * (1.0 - _SAME_SUM) else 1
        minima = sorted([*sides, *minima[1:]], key=lambda one: one.sum)
    return Found(minima[0], minima[1:], times, nothing, outliers), plain


def no_sum(data: Measured) -> float:
    """Sums of squares that are no larger are zero."""
    return float(np.sum((_ROUNDING / data.sigma) ** 2))


def _usual_error(data: Measured, found: Solution) -> float:
    return float(np.median(np.abs(found.residual * data.sigma)))


def _search(data: Measured, known: np.ndarray, task: Problem, start: np.ndarray) -> np.ndarray:
    """Result of a fit with all damping ratios free, first with little weight of outliers."""
    data = data._replace(relative=False)
    free = np.isnan(known)
    free[2 * data.n - 1 :] = True
    lowest = np.where(np.isinf(task.floor), task.lowest, task.floor)[free]
    highest = task.highest[free]
    values = np.where(free, start, known)

    def at(part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values[free] = part
        return differences(data, values)

    for loss in ("soft_l1", "linear"):
        found = least_squares(
            lambda part: at(part)[0], np.clip(values[free], lowest, highest),
            jac=lambda part: at(part)[1][:, free], bounds=(lowest, highest), x_scale="jac", loss=loss,
            f_scale=_OUTLIER, max_nfev=_MOST_STEPS, xtol=1e-6, ftol=1e-6,
        )  # fmt: skip
        values[free] = found.x
    return values


def _starts(data: Measured, known: np.ndarray) -> Iterator[np.ndarray]:
    """Chains to begin with: from peaks and dips of the first mass, and from ratios by chance."""
    random = np.random.default_rng(0)
    ratios = 2 * data.n - 1
    alternating = _alternating(data)
    first_peak = min((float(f[p[0]]) for f, p, _ in _extremes(data) if p.size), default=None)
    for k in range(SEARCHES):
        values = np.concatenate((np.zeros(ratios), np.full(data.n, _FIRST_DAMPING)))
        if alternating and k % 2 == 0:
            low, high = alternating[min(k, 1)]
            places = np.sort(random.uniform(low, high))  # never two in one place
            values[:ratios] = chain_of(places[::2], places[1::2])
            values[ratios:] = _SMALL_DAMPING
        else:
            values[1:ratios] = random.uniform(-_SPREAD, _SPREAD, ratios - 1) if k > 1 else 0.0
            if first_peak is not None:
                values[0] = np.log(first_peak / modes(values).frequencies[0])
        yield np.where(np.isnan(known), values, known)


def peaks(data: Measured) -> int:
    """Largest number of peaks of any mass."""
    return max((p.size for _, p, _ in _extremes(data)), default=0)


def _extremes(data: Measured) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Frequencies, samples of peaks and samples of dips of every mass measured."""
    found = []
    for mass in np.unique(data.mass):
        f, amplitude = data.amplitudes(mass)
        turned = np.array(turns(amplitude, _PEAK), dtype=int)
        is_peak = np.array([amplitude[k] > amplitude[k + 1] for k in turned], dtype=bool)
        found.append((f, turned[is_peak], turned[~is_peak]))
    return found


def _alternating(data: Measured) -> list[tuple[np.ndarray, np.ndarray]]:
    """Likely and certain bounds of f_1, z_1, f_2, ... of the first mass, if all are seen."""
    if 0 not in data.mass:
        return []
    f, peak, dip = _extremes(data)[0]
    if peak.size != data.n or dip.size != data.n - 1:
        return []
    _, amplitude = data.amplitudes(0)
    steep = np.abs(np.diff(amplitude))
    places = np.sort(np.concatenate((peak, dip)))
    # a peak or a dip is on the side where the neighbour is less far off
    beyond = np.where(steep[places] < steep[places - 1], places + 1, places - 1)
    return [
        (f[np.minimum(places, beyond)], f[np.maximum(places, beyond)]),
        (f[places - 1], f[places + 1]),
    ]

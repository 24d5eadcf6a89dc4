"""Amplitudes and lags of forced responses by the exact steady states, and their derivatives.

A row of the data is one frequency of one set; a set has one friction force.  Parameters are the friction
ratio beta of every set, at the mean of its loads, then f_n, zeta, one of the contact and two of the channels:
`F_N`, `ZETA`, `LAW`, `DELAY`, `GAIN` from the end.  The one of a rigid contact is mu; of a contact with a
spring, for which mu = 1, it is the compliance of the spring, k1/kt; 0 is the rigid contact.  Masses may be
measured later than the load, by a delay, and with another gain: lags are larger by 2 pi f times the delay,
amplitudes by the gain.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...model.modes import wrapped
from ...model.system import System
from ...steady.points import States, steady_states
from ..parameters import CONTACT_STIFFNESS, STIFFEST

F_N, ZETA, LAW, DELAY, GAIN = -5, -4, -3, -2, -1

#: Places of the parameters by their names; mu and the spring of a contact have one place.
PLACES = {"f_n": F_N, "zeta": ZETA, "mu": LAW, CONTACT_STIFFNESS: LAW, "delay": DELAY, "gain": GAIN}

#: Steps of differences, relative or absolute: steady states are exact to some 1e-12.
_STEP = 1e-6

#: A steady state that ends within a step leaves another one, far away: its difference is larger by this.
_JUMP = 10.0


class Rows(NamedTuple):
    """Frequencies that were measured, k of them."""

    frequency: np.ndarray  # (k,) Hz
    share: np.ndarray  # (k,) load over the mean of those of its set
    member: np.ndarray  # (k,) the set, from 0


class Samples(NamedTuple):
    """Measured lags and amplitudes, s numbers."""

    row: np.ndarray  # (s,)
    mass: np.ndarray  # (s,) from 0
    is_phase: np.ndarray  # (s,) bool
    value: np.ndarray  # (s,) lag [rad], or natural logarithm of the amplitude ratio
    sigma: np.ndarray  # (s,) its error


class ForcedModel(NamedTuple):
    """A structure and what was measured of it."""

    system: System
    own_damping: bool  # the system's damping is known: zeta is not looked at
    rows: Rows
    samples: Samples
    elastic: bool = False  # whether the contact has a spring, which the system is given without

    @property
    def sets(self) -> int:
        """Number of friction forces."""
        return int(self.rows.member.max()) + 1

    @property
    def least_law(self) -> float:
        """Least value of the parameter of the contact: mu = 1, or the stiffest spring."""
        return STIFFEST if self.elastic else 1.0

    def with_zeta(self, zeta: float) -> System:
        """The system with this damping ratio of every mode, its contact rigid."""
        return self.system if self.own_damping else replace(self.system, damping_ratios=zeta)

    def system_at(self, values: np.ndarray) -> System:
        """The system with the damping and the spring of some values."""
        system, law = self.with_zeta(float(values[ZETA])), float(values[LAW])
        return replace(system, contact_stiffness=1.0 / law) if self.elastic and law > 0.0 else system

    def mu_at(self, values: np.ndarray) -> float:
        """Static over kinetic friction at some values."""
        return 1.0 if self.elastic else float(values[LAW])


class Fitted(NamedTuple):
    """The model at some values."""

    residual: np.ndarray  # (s,) lags [rad] and logarithms of amplitudes, model less data, over their errors
    slopes: np.ndarray  # (s, parameters)
    regime: np.ndarray  # (k,) of the motion nearest to the data
    phasors: np.ndarray  # (k, n) its first harmonics
    states: list[States]  # all that were found


def evaluate(model: ForcedModel, values: np.ndarray, free: np.ndarray) -> Fitted:
    """Residuals, and their slopes by the free parameters; where there are several motions, of the nearest.

    Not finite where the model has no motion, or one at rest.
    """
    model = corrected(model, float(values[DELAY]), float(values[GAIN]))
    r, beta = points_of(model.rows, values)
    step = _STEP * (1.0 + beta)
    low, high = np.maximum(beta - step, 0.0), beta + step
    slow, fast = r * (1.0 - _STEP), r * (1.0 + _STEP)
    pairs = [(r, beta), (slow, beta), (fast, beta), (r, low), (r, high)]
    here, *beside = _together(model.system_at(values), model.mu_at(values), pairs)
    residual, chosen = nearest(model, here)
    phasors = np.array([states.phasors for states in here])[chosen, np.arange(r.size)]
    regime = np.array([states.regime for states in here])[chosen, np.arange(r.size)]
    change = np.zeros((values.size, *phasors.shape), dtype=complex)
    by_beta = _slope(phasors, (beside[2], low - beta), (beside[3], high - beta))
    for one in range(model.sets):
        change[one] = by_beta * np.where(model.rows.member == one, 1.0 / model.rows.share, 0.0)[:, np.newaxis]
    by_r = _slope(phasors, (beside[0], slow - r), (beside[1], fast - r))
    change[F_N] = by_r * (-r / values[F_N])[:, np.newaxis]
    for index, least in ((ZETA, 0.0), (LAW, model.least_law)):
        if free[index] and values[index] >= least:
            change[index] = _slope(phasors, *_neighbours(model, values, index, least))
    slopes = _sample_slopes(model.samples, phasors, change)
    slopes[:, DELAY] = np.where(model.samples.is_phase, _turns(model), 0.0) / model.samples.sigma
    slopes[:, GAIN] = np.where(model.samples.is_phase, 0.0, 1.0 / values[GAIN]) / model.samples.sigma
    return Fitted(residual, np.where(free, slopes, 0.0), regime, phasors, here)


def corrected(model: ForcedModel, delay: float, gain: float) -> ForcedModel:
    """What channels that agree would have measured."""
    samples = model.samples
    off = np.where(samples.is_phase, _turns(model) * delay, np.log(gain))
    return model._replace(samples=samples._replace(value=samples.value - off))


def _turns(model: ForcedModel) -> np.ndarray:
    """2 pi f [rad/s] of every sample."""
    return 2.0 * np.pi * model.rows.frequency[model.samples.row]


def points_of(rows: Rows, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequency and friction ratio of every row: friction over its own load."""
    return rows.frequency / values[F_N], values[:F_N][rows.member] / rows.share


def residuals(samples: Samples, phasors: np.ndarray) -> np.ndarray:
    """Model less data over their errors, (..., s), of phasors (..., k, n); not finite of masses at rest."""
    found = phasors[..., samples.row, samples.mass]
    with np.errstate(divide="ignore", invalid="ignore"):
        lag = np.where(found == 0.0, np.inf, wrapped(-np.angle(found) - samples.value))
        return np.where(samples.is_phase, lag, np.log(np.abs(found)) - samples.value) / samples.sigma


def nearest(model: ForcedModel, states: list[States]) -> tuple[np.ndarray, np.ndarray]:
    """Residuals of the motions nearest to the data, row by row, and which of the states they are (k,)."""
    found = residuals(model.samples, np.array([state.phasors for state in states]))
    squares = np.zeros((len(states), model.rows.frequency.size))
    for one, sums in zip(np.where(np.isnan(found), np.inf, found) ** 2, squares, strict=True):
        np.add.at(sums, model.samples.row, one)
    chosen = squares.argmin(axis=0)
    return found[chosen[model.samples.row], np.arange(model.samples.row.size)], chosen


def _together(system: System, mu: float, pairs: list[tuple[np.ndarray, np.ndarray]]) -> list[list[States]]:
    """The states at several lists of points."""
    r, beta = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    found = steady_states(system, r, beta, mu)
    split = [zip(*(np.split(part, len(pairs)) for part in states), strict=True) for states in found]
    return [[States(*parts) for parts in one] for one in zip(*split, strict=True)]


def _neighbours(
    model: ForcedModel, values: np.ndarray, index: int, least: float
) -> list[tuple[list[States], np.ndarray]]:
    """States, and how far they are off, below and above the value of zeta or of the contact's parameter."""
    r, beta = points_of(model.rows, values)
    step = _STEP * values[index] if model.elastic and index == LAW else _STEP
    result = []
    for value in (max(values[index] - step, least), values[index] + step):
        other = values.copy()
        other[index] = value
        states = steady_states(model.system_at(other), r, beta, model.mu_at(other))
        result.append((states, np.full(r.size, value - values[index])))
    return result


def _slope(
    phasors: np.ndarray, below: tuple[list[States], np.ndarray], above: tuple[list[States], np.ndarray]
) -> np.ndarray:
    """Derivative of the phasors (k, n) by the difference to the same motion below and above.

    One-sided where the motion ends on the other side: that motion is far away.
    """
    lower, upper = (
        (_same_motion(states, phasors) - phasors, off[:, np.newaxis]) for states, off in (below, above)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        central = (upper[0] - lower[0]) / (upper[1] - lower[1])
        back, ahead = lower[0] / lower[1], upper[0] / upper[1]
        ends_above = ~np.isfinite(ahead) | (np.abs(ahead) > _JUMP * np.abs(back))
        ends_below = ~np.isfinite(back) | (np.abs(back) > _JUMP * np.abs(ahead))
    found = np.where(ends_below, ahead, np.where(ends_above, back, central))
    return np.where(np.isfinite(found), found, 0.0)  # a motion at these very values only


def _same_motion(states: list[States], phasors: np.ndarray) -> np.ndarray:
    """Select the motion nearest to given phasors at every point, (k, n)."""
    found = np.array([state.phasors for state in states])
    off = np.abs(found - phasors).sum(axis=2)
    chosen = np.where(np.isnan(off), np.inf, off).argmin(axis=0)
    return found[chosen, np.arange(phasors.shape[0])]


def _sample_slopes(samples: Samples, phasors: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Slopes of the residuals, (s, parameters), from those of the phasors, (parameters, k, n)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = change[:, samples.row, samples.mass] / phasors[samples.row, samples.mass]
        return (np.where(samples.is_phase, -relative.imag, relative.real) / samples.sigma).T

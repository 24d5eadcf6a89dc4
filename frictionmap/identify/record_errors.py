"""Errors of what a record tells, and of what follows from it.

What is fitted, p, has the covariance s^2 (J^T V^-1 J)^-1, with V as in `record_fit`.  Errors b of the base's
harmonics move it by -(J^T V^-1 J)^-1 J^T V^-1 J_b b, and the noise of the mass moves p and X_1 together.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from .least_squares import Errors, errors
from .phasors import Phasors, first_harmonics
from .record_fit import Fit, base_errors
from .record_motion import F_N, MU, PARAMETERS, X_F, ZETA

#: What follows from the parameters and the phasors.
DERIVED = ("beta", "lag_deg", "amplitude_ratio", "stops_per_cycle")

_TWO_SIDED = 0.975

#: Of the parameters and of `DERIVED`, those that cannot be negative.
_POSITIVE = [F_N, ZETA, X_F, len(PARAMETERS)]


class _Linear(NamedTuple):
    """Estimates to first order in what is fitted, in X_1 and in the base's harmonics, in real numbers."""

    transfer: np.ndarray  # shape (estimates, sources)
    covariance: np.ndarray  # shape (sources, sources)

    @property
    def of_estimates(self) -> np.ndarray:
        """Their covariance."""
        return self.transfer @ self.covariance @ self.transfer.T


def derived_values(fit: Fit, phasors: Phasors) -> np.ndarray:
    """beta, lag [deg], amplitude ratio and stops a cycle."""
    base, mass = phasors.values[0, 1], phasors.values[1, 1]
    lag = -np.degrees(np.angle(mass / base))
    return np.array([fit.values[X_F] / abs(base), lag, abs(mass / base), float(fit.motion.stops)])


def record_errors(fit: Fit, phasors: Phasors, time: np.ndarray, used: np.ndarray) -> Errors:
    """Errors of the parameters and of `DERIVED`, in this order.

    used : shape (samples,), bool: whether a sample is part of the fit, which takes the place of the others
    """
    found = errors(fit.problem, fit.solution)
    linear = _in_what_is_fitted(fit, phasors, time, used, found)
    of_fitted = found.standard_error
    # (mu - 1)^2 is told; where it is below its error, mu - 1 is known no better than to the root of that
    spread = max(2.0 * (float(fit.values[MU]) - 1.0), float(np.sqrt(of_fitted[MU])))
    linear.transfer[MU] *= 1.0 / spread if spread > 0.0 else 0.0
    covariance = linear.of_estimates
    deviation = np.sqrt(np.diag(covariance))
    scale = np.where(deviation > 0.0, deviation, 1.0)
    correlation = np.where(np.eye(deviation.size, dtype=bool), 1.0, covariance / np.outer(scale, scale))
    reach = float(stdtrit(int(used.sum()) - int(fit.problem.free.sum()), _TWO_SIDED))
    values = np.concatenate((fit.values, derived_values(fit, phasors)))
    lower, upper = values - reach * deviation, values + reach * deviation
    lower[_POSITIVE] = np.maximum(lower[_POSITIVE], 0.0)
    _end_at_bounds(fit, found, lower, upper)
    lower[MU], upper[MU] = _interval_of_mu(fit, reach * of_fitted[MU], upper[MU])
    return found._replace(standard_error=deviation, lower=lower, upper=upper, correlation=correlation)


def _end_at_bounds(fit: Fit, found: Errors, lower: np.ndarray, upper: np.ndarray) -> None:
    """One-sided intervals, from the profile of the sum."""
    for index in np.flatnonzero(fit.solution.at_bound):
        lower[index], upper[index] = 0.0, found.upper[index]


def _interval_of_mu(fit: Fit, reach: float, at_bound: float) -> tuple[float, float]:
    """Of mu, from that of (mu - 1)^2; where the mass never sticks, up to where it would."""
    if not fit.mu_told:
        friction = float(fit.values[X_F])
        return 1.0, max(fit.motion.turn_load / friction, 1.0) if friction > 0.0 else np.inf
    if fit.solution.at_bound[MU]:
        return 1.0, 1.0 + float(np.sqrt(at_bound))
    square = float(fit.values[MU] - 1.0) ** 2
    return 1.0 + float(np.sqrt(max(square - reach, 0.0))), 1.0 + float(np.sqrt(square + reach))


def _in_what_is_fitted(
    fit: Fit, phasors: Phasors, time: np.ndarray, used: np.ndarray, found: Errors
) -> _Linear:
    """What is fitted and `DERIVED`."""
    size, own = len(PARAMETERS), found.standard_error
    of_fit = found.correlation * np.outer(own, own)
    slopes = fit.whitening(fit.solution.slopes)
    at_all = np.zeros((time.size, size))
    at_all[used] = slopes
    first = first_harmonics(time, at_all, phasors)
    of_base = base_errors(fit.mass, phasors) ** 2
    variance = found.variance * found.inflation**2
    by_base = -of_fit @ (slopes.T @ fit.by_base) * (of_base / variance if variance > 0.0 else 0.0)
    others = np.concatenate((np.full(2, phasors.errors[1, 1] ** 2), of_base))
    in_common = np.column_stack((of_fit @ first.real, of_fit @ first.imag, by_base))
    covariance = np.block([[of_fit, in_common], [in_common.T, np.diag(others)]])
    transfer = np.zeros((size + len(DERIVED), covariance.shape[0]))
    transfer[:size, :size] = np.eye(size)
    _add_derived(transfer, fit, phasors)
    return _Linear(transfer, covariance)


def _add_derived(transfer: np.ndarray, fit: Fit, phasors: Phasors) -> None:
    """Rows of beta, the lag and the amplitude ratio."""
    size = len(PARAMETERS)
    base, mass = phasors.values[0, 1], phasors.values[1, 1]
    of_mass = [size, size + 1]  # Re X_1, Im X_1
    of_base = [size + 3, size + 3 + fit.mass.base.size]  # Re Y_1, Im Y_1, after the means
    beta, lag, ratio, _ = range(size, size + len(DERIVED))
    along = np.array([base.real, base.imag]) / abs(base) ** 2
    transfer[beta] = transfer[X_F] / abs(base)
    transfer[beta, of_base] -= fit.values[X_F] / abs(base) * along
    transfer[lag, of_base] = np.degrees(np.array([-base.imag, base.real]) / abs(base) ** 2)
    transfer[lag, of_mass] = -np.degrees(np.array([-mass.imag, mass.real]) / abs(mass) ** 2)
    transfer[ratio, of_mass] = np.array([mass.real, mass.imag]) / (abs(mass) * abs(base))
    transfer[ratio, of_base] = -abs(mass / base) * along

"""Standard errors of the estimates from a record, and of derived quantities.

What is fitted, p, has the covariance s^2 (J^T V^-1 J)^-1, with V as in `fit`.  Errors b of the base's
harmonics move it by -(J^T V^-1 J)^-1 J^T V^-1 J_b b, and the noise of the mass moves p and X_1 together.

Where the gain of x over the base is fitted, lengths are in the unit of x; their intervals also hold those in
the unit of the base, which are smaller by the gain.

Where the data do not ask for mu > 1, estimates are those with mu = 1; their intervals reach as far as they
would move if mu were at the upper end of its own.  So where a spring in the contact is as stiff as can be:
estimates are those with a rigid contact.
"""

from typing import NamedTuple

import numpy as np

from ..signals.phasors import Phasors, first_harmonics
from ..statistics.least_squares import Errors, correlation_of, errors, growth, two_sided
from .fit import RecordFit, base_errors
from .motion import F_N, GAIN, LAW, MU, OFFSET, PARAMETERS, X_F, ZETA
from .static_friction import IDLE, ONE, highest, mu_interval, per_square

#: What follows from the parameters and the phasors.
DERIVED = ("beta", "lag_deg", "amplitude_ratio", "stops_per_cycle")

#: Of the parameters and of `DERIVED`, those that cannot be negative.
_POSITIVE = [F_N, ZETA, X_F, len(PARAMETERS)]


class _Linear(NamedTuple):
    """Estimates to first order in what is fitted, in X_1 and in the base's harmonics, in real numbers."""

    transfer: np.ndarray  # shape (estimates, sources)
    covariance: np.ndarray  # shape (sources, sources)

    @property
    def estimate_covariance(self) -> np.ndarray:
        """Their covariance."""
        return self.transfer @ self.covariance @ self.transfer.T


def derived_values(fit: RecordFit, phasors: Phasors) -> np.ndarray:
    """beta, lag [deg], amplitude ratio and stops per cycle."""
    base, mass = phasors.values[0, 1], phasors.values[1, 1]
    lag = -np.degrees(np.angle(mass / base))
    return np.array(
        [fit.values[X_F] / (fit.values[GAIN] * abs(base)), lag, abs(mass / base), float(fit.motion.stops)]
    )


def record_errors(fit: RecordFit, phasors: Phasors, time: np.ndarray, used: np.ndarray) -> Errors:
    """Errors of the parameters and of `DERIVED`, in this order.

    used : shape (samples,), bool: whether a sample is part of the fit, which takes the place of the others
    """
    size = len(PARAMETERS)
    on_bound = fit.solution.at_bound & fit.problem.free
    found = errors(fit.problem, fit.solution._replace(at_bound=on_bound), noise=fit.noise)
    linear = _linear_in_fit(fit, phasors, time, used, found)
    of_law, elastic = float(found.standard_error[LAW]), fit.mass.elastic
    if not elastic:
        linear.transfer[MU] *= per_square(float(fit.values[MU]), of_law)
    covariance = linear.estimate_covariance
    deviation = np.sqrt(np.diag(covariance))
    reach = two_sided(fit.noise.freedom)
    values = np.concatenate((fit.values, derived_values(fit, phasors)))
    lower, upper = values - reach * deviation, values + reach * deviation
    for index in np.flatnonzero(on_bound[:size]):  # one-sided, from the profile of the sum
        lower[index], upper[index] = 0.0, found.upper[index]
    moved = np.zeros(fit.solution.values.size)
    if not elastic:
        idle = _mu_of_first_stop(fit) if fit.static == IDLE else np.inf
        lower[LAW], upper[LAW], moved = mu_interval(
            fit.static, fit.with_law, fit.solution, fit.noise, LAW, of_law, idle
        )
    elif fit.static == ONE:
        lower[LAW] = 0.0
        upper[LAW], moved = highest(fit.with_law, fit.solution, fit.noise, LAW)
    if fit.static == ONE:
        moves = np.concatenate((moved[:size], np.zeros(len(DERIVED))))
        moves[size] = moved[X_F] / (fit.values[GAIN] * abs(phasors.values[0, 1]))  # beta
        lower, upper = lower + np.minimum(moves, 0.0), upper + np.maximum(moves, 0.0)
    if fit.free[GAIN]:
        _allow_for_both_units(lower, upper, values, abs(phasors.values[0, 1]))
    lower[_POSITIVE] = np.maximum(lower[_POSITIVE], 0.0)
    return found._replace(
        standard_error=deviation, lower=lower, upper=upper, correlation=correlation_of(covariance),
        inflation=float(growth(fit.problem, fit.solution, fit.noise)[:OFFSET].max()),
    )  # fmt: skip


def _allow_for_both_units(lower: np.ndarray, upper: np.ndarray, values: np.ndarray, base: float) -> None:
    """Lengths in the unit of x or of the base: the record does not show which of the channels is wrong.

    base : amplitude of the first harmonic
    """
    beta = len(PARAMETERS)
    lower[X_F] = min(lower[X_F], lower[beta] * base)  # x_F/G
    upper[X_F] = max(upper[X_F], upper[beta] * base)
    ends = np.outer([lower[OFFSET], upper[OFFSET]], 1.0 / np.array([1.0, values[GAIN]]))
    lower[OFFSET], upper[OFFSET] = ends.min(), ends.max()


def _mu_of_first_stop(fit: RecordFit) -> float:
    """Largest mu without an effect, as the mass does not stick."""
    friction = float(fit.values[X_F])
    return max(fit.motion.turn_load / friction, 1.0) if friction > 0.0 else np.inf


def _linear_in_fit(
    fit: RecordFit, phasors: Phasors, time: np.ndarray, used: np.ndarray, found: Errors
) -> _Linear:
    """Linear dependence of the parameters and of `DERIVED`, and the covariance of its sources."""
    size, own = len(PARAMETERS), found.standard_error
    of_all = found.correlation * np.outer(own, own)  # the parts of slow waves among them
    of_fit = of_all[:size]
    slopes = fit.whitening(fit.solution.slopes)
    at_all = np.zeros((time.size, slopes.shape[1]))
    at_all[used] = slopes
    first = first_harmonics(time, at_all, phasors)
    of_base = base_errors(fit.mass, phasors) ** 2
    variance = fit.noise.variance * found.inflation**2
    by_base = -of_fit @ (slopes.T @ fit.by_base) * (of_base / variance if variance > 0.0 else 0.0)
    others = np.concatenate((np.full(2, phasors.errors[1, 1] ** 2), of_base))
    in_common = np.column_stack((of_fit @ first.real, of_fit @ first.imag, by_base))
    covariance = np.block([[of_fit[:, :size], in_common], [in_common.T, np.diag(others)]])
    transfer = np.zeros((size + len(DERIVED), covariance.shape[0]))
    transfer[:size, :size] = np.eye(size)
    _add_derived(transfer, fit, phasors)
    return _Linear(transfer, covariance)


def _add_derived(transfer: np.ndarray, fit: RecordFit, phasors: Phasors) -> None:
    """Rows of beta, the lag and the amplitude ratio."""
    size = len(PARAMETERS)
    base, mass = phasors.values[0, 1], phasors.values[1, 1]
    of_mass = [size, size + 1]  # Re X_1, Im X_1
    of_base = [size + 3, size + 3 + fit.mass.base.size]  # Re Y_1, Im Y_1, after the means
    beta, lag, ratio, _ = range(size, size + len(DERIVED))
    along = np.array([base.real, base.imag]) / abs(base) ** 2
    friction, gain = fit.values[X_F], fit.values[GAIN]
    transfer[beta] = (transfer[X_F] - friction / gain * transfer[GAIN]) / (gain * abs(base))
    transfer[beta, of_base] -= friction / (gain * abs(base)) * along
    transfer[lag, of_base] = np.degrees(np.array([-base.imag, base.real]) / abs(base) ** 2)
    transfer[lag, of_mass] = -np.degrees(np.array([-mass.imag, mass.real]) / abs(mass) ** 2)
    transfer[ratio, of_mass] = np.array([mass.real, mass.imag]) / (abs(mass) * abs(base))
    transfer[ratio, of_base] = -abs(mass / base) * along

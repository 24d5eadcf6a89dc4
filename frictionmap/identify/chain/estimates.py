"""Estimates of a chain as a dataset: frequencies and ratios instead of their logarithms."""

import numpy as np
import xarray as xr

from ..statistics.estimates import QUANTITIES, estimates, flags
from ..statistics.least_squares import Errors, Solution, correlation_of, half_widths
from .fit import Measured
from .two_masses import frequencies, ratio_slopes

_FREQUENCIES = {
    "f0": "natural frequency of the second mass on its spring alone",
    "f1": "first natural frequency",
    "f2": "second natural frequency",
}


def chain_names(n: int) -> tuple[str, ...]:
    """Names of the 3 n - 1 unknowns."""
    ratios = [f"mass_ratio_{k}" for k in range(2, n + 1)] + [f"stiffness_ratio_{k}" for k in range(2, n + 1)]
    return ("f_k1m1", *(("gamma", "kappa") if n == 2 else ratios), *(f"zeta_{k}" for k in range(1, n + 1)))


def _meanings(n: int) -> dict[str, str]:
    masses = [f"mass ratio m{k}/m1" for k in range(2, n + 1)]
    springs = [f"stiffness ratio k{k}/k1" for k in range(2, n + 1)]
    damping = [f"damping ratio of mode {k}" for k in range(1, n + 1)]
    words = ["natural frequency of the first mass on its spring alone", *masses, *springs, *damping]
    return dict(zip(chain_names(n), words, strict=True))


def chain_estimates(
    data: Measured, best: Solution, found: Errors, free: np.ndarray, given: bool, damped: bool
) -> xr.Dataset:
    """Dataset of a fit without its verdict; for two masses the natural frequencies come first."""
    shown = 3 * data.n - 1 if damped else 2 * data.n - 1
    meanings = dict(list(_meanings(data.n).items())[:shown])
    rows = np.eye(best.values.size)[:shown]
    logarithmic = np.arange(shown) < 2 * data.n - 1
    natural = np.where(logarithmic, np.exp(best.values[:shown]), best.values[:shown])
    if data.n == 2:
        three = np.array(frequencies(*natural[:3]))
        # ratios are known functions of the three frequencies: these are the inverse
        slopes = np.linalg.inv(ratio_slopes(*three)) / three[:, np.newaxis]
        rows = np.vstack((np.hstack((slopes, np.zeros((3, best.values.size - 3)))), rows))
        natural = np.concatenate((three, natural))
        logarithmic = np.concatenate((np.ones(3, dtype=bool), logarithmic))
        meanings = _FREQUENCIES | meanings
    natural_solution, wider = _transformed(best, found, rows, natural, logarithmic)
    units = tuple("Hz" if name.startswith("f") else "1" for name in meanings)
    residual = data.sigma * best.residual
    sigma = data.sigma if given else data.sigma * np.sqrt(found.variance)
    fitted = (rows[:, free] != 0.0).any(axis=1)
    ds = estimates(
        meanings, units, natural_solution._replace(residual=residual), wider, fitted, data.value, "1", sigma
    )
    return ds.assign(_sample_variables(data))


def _transformed(
    best: Solution,
    found: Errors,
    rows: np.ndarray,
    natural: np.ndarray,
    logarithmic: np.ndarray,
) -> tuple[Solution, Errors]:
    """Estimates and errors of numbers whose derivatives, of some by logarithms, are `rows`.

    Intervals of what is positive are those of its logarithm.
    """
    covariance = rows @ (found.correlation * np.outer(found.standard_error, found.standard_error)) @ rows.T
    deviation = np.sqrt(np.diag(covariance))
    own = (rows == 1.0) & (np.count_nonzero(rows, axis=1) == 1)[:, np.newaxis]
    place, is_own = own.argmax(axis=1), own.any(axis=1)
    # of what several decide, the least known
    freedom = np.where(rows != 0.0, found.freedom, np.inf).min(axis=1)
    reach = half_widths(freedom) * deviation
    centre = np.where(logarithmic, np.log(np.where(logarithmic, natural, 1.0)), natural)
    lower = np.where(is_own, found.lower[place], centre - reach)
    upper = np.where(is_own, found.upper[place], centre + reach)
    lower, upper = (np.where(logarithmic, np.exp(ends), ends) for ends in (lower, upper))
    natural_solution = best._replace(values=natural, at_bound=is_own & best.at_bound[place])
    deviation = np.where(logarithmic, natural, 1.0) * deviation
    return natural_solution, found._replace(
        standard_error=deviation, lower=lower, upper=upper, correlation=correlation_of(covariance)
    )


def _sample_variables(data: Measured) -> dict[str, xr.Variable]:
    quantity = {"long_name": "what was measured", **flags(QUANTITIES)}
    mass = {"long_name": "mass, counted from 1", "units": "1"}
    return {
        "frequency": xr.Variable(
            "sample", data.frequency, {"long_name": "frequency of the base", "units": "Hz"}
        ),
        "mass": xr.Variable("sample", (data.mass + 1).astype(np.int16), mass),
        "quantity": xr.Variable("sample", data.is_phase.astype(np.int8), quantity),
    }

"""Masses, springs and damping of a chain from amplitudes over frequency, base shaken, without friction."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.special import gammaincc

from ... import checks
from ...errors import InputError
from ..statistics.cautions import autocorrelation_warnings, bound_warnings, correlation_warnings
from ..statistics.estimates import verdict
from ..statistics.least_squares import Errors, Problem, Solution, undetermined
from ..statistics.levels import CHANCE
from ..statistics.robust import LOSSES, soften
from ..statistics.weights import table_errors
from .data import MOST_MASSES, WORDS, Values, check_enough, checked_sweep
from .errors import fit_by_residuals, fit_robust_by_residuals
from .estimates import chain_estimates, chain_names
from .fit import SEARCHES, Found, Measured, fit_chain

DAMPINGS = ("ground", "base")
COSTS = ("logarithmic", "relative")

#: Solutions whose sums of squares differ by fewer variances of a sample fit as well.
_AS_GOOD = 4.0

#: Standard errors of a parameter from which solutions differ.
_ELSEWHERE = 3.0

#: Residuals beyond this many given errors have little weight in a robust fit.
_GIVEN = 1.0

#: Chains that differ by less are one, as far as a search goes.
_SAME = 1e-6


class _Fit(NamedTuple):
    data: Measured
    found: Found
    problem: Problem
    errors: Errors
    names: tuple[str, ...]  # of all unknowns
    given: bool  # whether errors of the data are


def sweep(
    frequency: Sequence[float] | np.ndarray,
    amplitude_ratio: Values,
    phase_lag: Values | None = None,
    *,
    masses: int = 2,
    damping: str | None = None,
    known: Mapping[str, float] | None = None,
    sigma_amplitude: float | None = None,
    sigma_phase: float | None = None,
    cost: str = "logarithmic",
    loss: str = "linear",
) -> xr.Dataset:
    """Fit a chain of masses on a shaken base, without friction, to amplitudes and lags over frequency.

    The first three arguments are the data; the others state known parameters and options.

    Parameters
    ----------
    frequency : array, shape (samples,)
        Of the base [Hz], > 0, in any order.
    amplitude_ratio : array, shape (samples,), or mapping of such
        X_k/Y > 0 of mass 1, or by mass, counted from 1, such as {1: ..., 3: ...}.
    phase_lag : array, shape (samples,), or mapping of such
        Lags [deg] behind the base, in the same form; they determine the damping.
    masses : int
        Of the chain, 1 to 5.
    damping : "ground" or "base"
        Where the dampers are that give every mode its damping ratio; by default there is no damping, with
        lags it is "ground".
    known : mapping
        Parameters to be held.  Others are fitted.
    sigma_amplitude, sigma_phase : float
        Relative error of the amplitudes, and error of the lags [deg], > 0; by default both are taken from the
        residuals, those of amplitudes and of lags apart.
    cost : "logarithmic" or "relative"
        What is least: the squares of ln(X/measured), or of X/measured - 1, as T(6.16) has it.
    loss : "linear" or "soft_l1"
        What residuals cost: their squares, or less beyond their errors, for outliers.

    Returns
    -------
    xarray.Dataset
        As of `free_decay`.  Parameters of two masses: f1 and f2, the natural frequencies [Hz], f0, that of
        mass 2 on its spring alone, f_k1m1, that of mass 1 on its own, gamma = m_2/m_1, kappa = k_2/k_1; of
        others f_k1m1, mass_ratio_2.., stiffness_ratio_2..; with damping zeta_1.., one per mode.  On sample:
        frequency, mass, `quantity`; data, model and residual are natural logarithms of amplitudes, lags
        [rad].

    Raises
    ------
    InputError
        An argument is invalid, data or peaks are fewer than unknowns, or unknowns are not identifiable
        separately: they are named.

    Notes
    -----
    T(6.15) to (6.19) and Appendix A for two masses; theory.md 10.

    Examples
    --------
    One mass with a natural frequency of 3 Hz:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> f = np.array([1.0, 2.0, 2.5, 4.0, 5.0])
    >>> fit = fm.identify.sweep(f, 1 / np.abs(1 - (f / 3.0) ** 2), masses=1)
    >>> round(fit.estimate.sel(parameter="f_k1m1").item(), 6)
    3.0
    """
    n = checks.whole(masses, "masses", least=1, most=MOST_MASSES)
    data = checked_sweep(frequency, (amplitude_ratio, phase_lag), (sigma_amplitude, sigma_phase), n)
    damped = damping is not None or phase_lag is not None
    if damping is not None:
        data = data._replace(base_damping=checks.choice(damping, "damping", DAMPINGS) == "base")
    data = data._replace(relative=checks.choice(cost, "cost", COSTS) == "relative")
    names = chain_names(n)
    held = _held(known or {}, names, n, damped)
    check_enough(data, held)
    robust = checks.choice(loss, "loss", LOSSES) == "soft_l1"
    fit = _fit(data, held, names, sigma_amplitude is not None, robust)
    ds = chain_estimates(fit.data, fit.found.best, fit.errors, fit.problem.free, fit.given, damped)
    ds["verdict"] = _verdict(fit)
    ds.attrs |= {"damping": DAMPINGS[data.base_damping] if damped else "none", "cost": cost}
    ds.attrs["title"] = f"Sweep of {WORDS[n - 1]} mass{'es' * (n > 1)}"
    ds.attrs["warnings"] = "; ".join(_warnings(fit))
    return ds


def _held(known: Mapping[str, float], names: tuple[str, ...], n: int, damped: bool) -> np.ndarray:
    """Unknowns that are held, shape (3 n - 1,), NaN of the others."""
    valid = names if damped else names[: 2 * n - 1]
    held = np.full(len(names), np.nan)
    for name, value in known.items():
        place = names.index(checks.choice(name, "known", valid))
        if place < 2 * n - 1:
            held[place] = np.log(checks.number(value, f"known.{name}", above=0.0))
        else:
            held[place] = checks.number(value, f"known.{name}", least=0.0)
    if not damped:
        held[2 * n - 1 :] = 0.0
    if not np.isnan(held).any():
        raise InputError(f"known must leave at least one parameter free; got all of {', '.join(valid)}")
    return held


def _fit(data: Measured, held: np.ndarray, names: tuple[str, ...], given: bool, robust: bool) -> _Fit:
    if given:
        found, problem = fit_chain(data, held, _GIVEN if robust else None)
    else:
        found, problem, data = (fit_robust_by_residuals if robust else fit_by_residuals)(data, held)
    unseen, too_many = undetermined(problem, found.best)
    if too_many:
        unknown = ", ".join(names[index] for index in unseen)
        measured = ", ".join(str(mass + 1) for mass in np.unique(data.mass))
        raise InputError(
            f"cannot identify {unknown} separately: mass {measured} does not determine them; "
            f"fix {too_many} of them in [known], or measure another mass"
        )
    outliers, best = found.outliers, found.best
    task = problem if outliers is None else soften(problem, outliers)
    kind = data.is_phase.astype(int)
    of_estimates, *_ = table_errors(problem, task, best, kind, np.full(2, given), outliers)
    if outliers is not None:
        plain = best._replace(residual=problem.residuals(best.values)[0])
        freedom = plain.residual.size - int(problem.free.sum())
        of_estimates = of_estimates._replace(variance=plain.sum / freedom)
        found = found._replace(best=plain, others=[])
    return _Fit(data, found, problem, of_estimates, names, given)


def _verdict(fit: _Fit) -> xr.Variable:
    n = fit.data.n
    chain = f"a chain of {WORDS[n - 1]} masses" if n > 1 else "one mass on a spring"
    within = "to within their errors" if fit.given else "with errors from the residuals"
    meanings = {
        f"{WORDS[n - 1]}_frequenc{'ies' if n > 1 else 'y'}_found": f"{chain} explains the data, {within}",
        "scatter_beyond_errors": f"{chain} fits, but residuals exceed the errors given",
    }
    best = fit.found.best
    freedom = best.residual.size - int(fit.problem.free.sum())
    beyond = fit.given and gammaincc(0.5 * freedom, 0.5 * best.sum) < CHANCE
    return verdict(int(beyond), meanings)


def _warnings(fit: _Fit) -> list[str]:
    """Warnings about a fit."""
    words = autocorrelation_warnings(fit.errors) + correlation_warnings(fit.names, fit.errors.correlation)
    words += bound_warnings(fit.names, fit.problem.floor, fit.found.best.at_bound)
    if fit.found.times == 1:
        words.append(f"the least sum of squares was found in only one of {SEARCHES} searches")
    return words + _other_answers(fit)


def _other_answers(fit: _Fit) -> list[str]:
    """Warn of other chains that fit the data as well."""
    best, ratios = fit.found.best, 2 * fit.data.n - 1
    variance = 1.0 if fit.given else fit.errors.variance
    words: list[str] = []
    seen = [best]
    for other in fit.found.others:
        if other.sum > max(best.sum, fit.found.nothing) + _AS_GOOD * variance:
            break
        if all(_elsewhere(other, one, fit.errors) for one in seen):
            seen.append(other)
            values = ", ".join(
                f"{fit.names[k]} {np.exp(other.values[k]):.5g}" for k in range(ratios) if fit.problem.free[k]
            )
            words.append(f"the data fit {values} as well")
    return words


def _elsewhere(other: Solution, one: Solution, found: Errors) -> bool:
    least = np.maximum(_ELSEWHERE * found.standard_error, _SAME)
    return bool((np.abs(other.values - one.values) > least).any())

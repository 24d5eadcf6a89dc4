"""Natural frequency, viscous damping and friction force from the free decay of one mass."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError
from ...units.table import checked_unit, conversion
from ..parameters import checked_known, unit_of
from ..signals.plateaus import unclipped
from ..signals.samples import checked_record, largest_gap, within
from ..signals.turning_points import (
    TurningPoints,
    linear_decrement,
    noise_level,
    resolution,
    without_spikes,
)
from ..statistics.cautions import autocorrelation_warnings, bound_warnings, correlation_warnings
from ..statistics.estimates import estimates, number, verdict, with_error
from ..statistics.least_squares import Errors
from ..statistics.levels import FOUND
from ..statistics.robust import LOSSES
from .checks import check_misfit, checked_turning_points
from .errors import decay_errors, decay_solution
from .fit import DecayFit, fit_decay, noise_variance
from .motion import PARAMETERS
from .problem import DRIFT, X_F, ZETA, Record
from .rounding import rounding_weights
from .wander import Search, search

#: Codes of what was found, in order.
_VERDICTS = {
    "neither_found": "neither friction nor viscous damping found",
    "friction_found": "friction found, viscous damping not",
    "viscous_damping_found": "viscous damping found, friction not",
    "both_found": "friction and viscous damping found",
}

_LOSS = "growth of the sum of squares without {}, over the variance of a sample"

_IMPOSSIBLE = (
    "in the best fit the mass leaves a turning point at which friction would hold it, so mu has no bounds: "
    "friction is not constant, or the record is not a free decay"
)

_MEANINGS = {
    "f_n": "natural frequency without friction and damping",
    "zeta": "viscous damping ratio",
    "x_F": "kinetic friction force over stiffness",
    "X0": "turning point at t0, from the centre",
    "t0": "time of a turning point at the beginning",
    "centre": "place of the unloaded mass",
    DRIFT: "of the measured place of the unloaded mass",
}


def free_decay(
    time: Sequence[float] | np.ndarray,
    x: Sequence[float] | np.ndarray,
    *,
    unit: str = "mm",
    known: Mapping[str, float] | None = None,
    base: float | None = None,
    stiffness: float | None = None,
    window: object = None,
    drift: bool = False,
    loss: str = "linear",
) -> xr.Dataset:
    """Fit the exact decay with Coulomb and viscous friction to all samples of a record.

    Parameters
    ----------
    time : array, shape (samples,)
        Times [s], increasing; equal steps are not needed.
    x : array, shape (samples,)
        Displacements of the mass, in `unit`.
    unit : "mm", "m" or "um"
        Of `x`, and of every length that is given or returned.
    known : mapping
        Parameters to be held: f_n [Hz] > 0, zeta in [0, 1), x_F >= 0, X0, t0 [s], centre.  Others are fitted.
    base : float
        Amplitude Y > 0 of a base motion; gives the friction ratio beta = x_F/Y.
    stiffness : float
        k [N/m] > 0; gives the friction force F = k x_F [N].
    window : [begin, end]
        Times [s] of the part to be fitted; default: all.
    drift : bool
        Whether the zero of the measurement drifts: a parameter drift [`unit`/s], so that the centre is
        centre + drift t.
    loss : "linear" or "soft_l1"
        What residuals cost: their squares, or less beyond the level of the noise, for outliers.

    Returns
    -------
    xarray.Dataset
        On parameter (f_n, zeta, x_F, X0, t0, centre, perhaps drift): estimate, standard_error, lower and
        upper (95 %, one-sided where `at_bound`), `known`, unit; `correlation`; on sample: time, data,
        model, residual; scalars `reduced_chi_square` (the variance of a sample, as no error of the data is
        given), `residual_rms`, `verdict`, `half_cycles` before rest or the end, `at_rest`, and
        `mu_lower` <= mu < `mu_upper` from where it came to rest and where it did not.  Attribute `warnings`.
        Intervals and bounds of mu also hold for other numbers of half cycles that fit as well within the
        noise; `standard_error` is that of the best one.  They allow for noise that is correlated in time, and
        for rounding errors of a coarse converter, which samples at one place have in common.  Where the zero
        wanders slowly, a polynomial of time is fitted beside the decay (`wander_terms`, `wander_rms`); model
        and residual are of the decay alone.

    Raises
    ------
    InputError
        An argument is invalid, or the record is no free decay: no motion, fewer than 3 extrema, an amplitude
        that grows, fewer than 8 samples per cycle, residuals far above the noise between samples.

    Notes
    -----
    Distances of the extrema from the centre follow A_{j+1} = q A_j - (1 + q) x_F with
    q = exp(-pi zeta/sqrt(1 - zeta^2)), T(4.2) without viscous damping; the mass rests from the first
    A_j <= mu x_F.  The number of half cycles before rest is an unknown of the fit.
    """
    checked_unit(unit, "length", "unit")
    if not isinstance(drift, bool):
        raise InputError(f"drift must be true or false; got {checks.one_line(drift)}")
    checks.choice(loss, "loss", LOSSES)
    names = (*PARAMETERS, DRIFT) if drift else PARAMETERS
    held = _held(known or {}, names)
    times, places = checked_record(time, x)
    inside = within(window, times)
    times, places = times[inside], places[inside]
    good = unclipped(times, places)
    t, data = times[good], places[good]
    points = checked_turning_points(t, without_spikes(data) if loss == "soft_l1" else data)
    outliers = noise_level(data) if loss == "soft_l1" else 0.0
    searched = _searched(Record(t, data, held, names, outliers or None), points)  # exact data have none
    record, fits = searched.record, searched.fits
    fit = fits[0]
    if not held:  # a value that is held may be wrong on purpose
        check_misfit(data, float(np.sqrt(fit.solution.sum / data.size)))
    found, solution = decay_errors(searched), decay_solution(record, fit)
    losses = _losses(record, points, fit)
    meanings = {name: _MEANINGS[name] for name in names}
    units = [unit_of(name, unit) for name in names]
    ds = estimates(meanings, units, solution, found, record.free[: len(names)], data, unit)
    ds["time"] = xr.Variable("sample", t, {"long_name": "time", "units": "s"})
    ds["verdict"] = verdict(_verdict(fit, found, losses), _VERDICTS)
    ds["likelihood_ratio_friction"] = number(losses["x_F"], _LOSS.format("friction"))
    ds["likelihood_ratio_viscous"] = number(losses["zeta"], _LOSS.format("viscous damping"))
    decrement = linear_decrement(points)
    if decrement is not None:
        ds["linear_decrement"] = number(
            decrement, "x_F by the linear decrement T(4.3), true if zeta = 0", unit
        )
    ds = (
        ds.assign(_motion(fits, unit))
        .assign(_wander(record, fit, unit))
        .assign(_scaled(fit, found, unit, base, stiffness))
    )
    ds.attrs["title"] = "Free decay"
    ds.attrs["warnings"] = "; ".join(_warnings(times, good, searched, found))
    return ds


def _searched(record: Record, points: TurningPoints) -> Search:
    """Fits of a record, once more with other weights if rounding errors are alike where the mass rests."""
    found = search(record, points)
    fit = found.fits[0]
    places = record.x + fit.plain.residuals(fit.solution.values)[0]
    weights = rounding_weights(record.x, places)
    return found if weights is None else search(record._replace(weights=weights), points)


def _held(known: Mapping[str, float], names: tuple[str, ...]) -> dict[str, float]:
    """Parameters to be held, if they are known by name and in range, one at least free."""
    result = checked_known(known, names)
    if result.get("zeta", 0.0) >= 1.0:
        raise InputError(f"known.zeta must be < 1 for a decay with turning points; got {known['zeta']}")
    if len(result) == len(names):
        raise InputError(f"known must leave at least one parameter free; got all of {', '.join(names)}")
    return result


def _losses(record: Record, points: TurningPoints, fit: DecayFit) -> dict[str, float]:
    """Growth of the sum of squares without friction, and without damping, over the variance of a sample."""
    losses, variance = {}, noise_variance(record, fit)
    for name in ("x_F", "zeta"):
        if name in record.known:
            losses[name] = 0.0
            continue
        without = fit_decay(record._replace(known={**record.known, name: 0.0}), points)[0].solution.sum
        # another number of half cycles may fit a little better where the least sum lies on the bound
        losses[name] = max(without - fit.solution.sum, 0.0) / variance
    return losses


def _verdict(fit: DecayFit, found: Errors, losses: Mapping[str, float]) -> int:
    """Verdict: friction and damping beyond three standard errors, by estimate and by likelihood ratio."""
    friction, damping = (
        losses[PARAMETERS[index]] > FOUND**2
        and fit.solution.values[index] > FOUND * found.standard_error[index]
        for index in (X_F, ZETA)
    )
    return int(friction) + 2 * int(damping)


def _motion(fits: list[DecayFit], unit: str) -> dict[str, xr.Variable]:
    """Number of half cycles, place of rest, and the bounds of mu that follow."""
    fit = fits[0]
    bounds = np.array([_bounds_of_mu(one) for one in fits])
    lower, upper = bounds[:, 0].min(), bounds[:, 1].max()
    result = {
        "half_cycles": xr.Variable(
            (), np.int32(fit.half_cycles), {"long_name": "half cycles before rest, or begun in the record"}
        ),
        "at_rest": xr.Variable((), np.int8(fit.at_rest), {"long_name": "1 if it came to rest in the record"}),
        "mu_lower": number(lower, "static over kinetic friction is at least this, as it rests where it does"),
        "mu_upper": number(
            upper, "static over kinetic friction is below this, as it left the turning point before"
        ),
    }
    if fit.at_rest:
        heights = fit.heights
        side = np.sign(fit.decay.X0) * (-1.0) ** fit.half_cycles
        result["rest"] = number(fit.decay.centre + side * float(heights[-1]), "place of rest", unit)
    return result


def _bounds_of_mu(fit: DecayFit) -> tuple[float, float]:
    """Least and largest mu, from where the mass came to rest and which turning point it left last."""
    heights, friction = fit.heights, fit.decay.x_F
    if friction == 0.0 or not fit.possible:
        return 0.0, np.inf
    passed = heights[:-1] if fit.at_rest else heights
    return abs(float(heights[-1])) / friction if fit.at_rest else 0.0, float(passed[-1]) / friction


def _wander(record: Record, fit: DecayFit, unit: str) -> dict[str, xr.Variable]:
    """The wander of the zero that was fitted, if there is one."""
    if record.wander is None or not record.terms:
        return {}
    slow = record.wander @ fit.solution.values[len(record.names) :]
    return {
        "wander_terms": xr.Variable(
            (), np.int32(record.terms), {"long_name": "terms of the polynomial that the zero follows"}
        ),
        "wander_rms": number(float(np.std(slow)), "slow wander of the zero, root mean square", unit),
    }


def _scaled(
    fit: DecayFit, found: Errors, unit: str, base: float | None, stiffness: float | None
) -> dict[str, xr.Variable]:
    """x_F as a friction ratio and as a force, with its error."""
    scales: list[tuple[str, str, str, float]] = []
    if base is not None:
        scales.append(("beta", "friction ratio x_F/Y", "1", 1.0 / checks.number(base, "base", above=0.0)))
    if stiffness is not None:
        newtons = checks.number(stiffness, "stiffness", above=0.0) * conversion(unit, "m")
        scales.append(("friction_force", "kinetic friction force k x_F", "N", newtons))
    x_F, error = fit.decay.x_F, float(found.standard_error[X_F])  # noqa: N806
    result: dict[str, xr.Variable] = {}
    for name, words, units, scale in scales:
        result |= with_error(name, scale * x_F, scale * error, words, units, f"standard error of {name}")
    return result


def _warnings(time: np.ndarray, good: np.ndarray, searched: Search, found: Errors) -> list[str]:
    """Warnings about a fit."""
    words = []
    if not good.all():
        words.append(f"clipped: {1.0 - good.mean():.1%} of the samples are at the extremes and were left out")
    if gap := largest_gap(time):
        words.append(f"a gap of {gap:.4g} s in the times, which are used as given")
    pair = np.ix_((ZETA, X_F), (ZETA, X_F))
    record = searched.record
    words += autocorrelation_warnings(found) if record.weights is None else _rounding(record, found)
    words += correlation_warnings(("zeta", "x_F"), found.correlation[pair])
    words += _wandering(searched) + _other_counts(searched.fits)
    names = record.names
    at_bound = searched.fits[0].solution.at_bound[: len(names)]
    return words + bound_warnings(names, np.zeros(len(names)), at_bound)


def _rounding(record: Record, found: Errors) -> list[str]:
    """Warn of errors that samples have in common."""
    return [
        f"the steps of the converter ({resolution(record.x):.3g}) exceed the noise: samples at rest count as "
        f"one, and standard errors were multiplied by up to {found.inflation:.3g}"
    ]


def _wandering(searched: Search) -> list[str]:
    """Warn of a slow part of the residuals."""
    if searched.doubted is not None:
        return [
            "the residuals may have a low-frequency part, as if the zero of the measurement wandered: "
            "intervals allow for both cases, standard errors only for a steady zero"
        ]
    if searched.record.terms == 0:
        return []
    return [
        "the residuals have a low-frequency part, as if the zero of the measurement wandered: "
        f"a polynomial of time with {searched.record.terms} terms is fitted beside the decay"
    ]


def _other_counts(fits: list[DecayFit]) -> list[str]:
    """Warn of other numbers of half cycles before rest that fit as well."""
    words = [] if fits[0].possible else [_IMPOSSIBLE]
    others = sorted({_count(fit) for fit in fits[1:]} - {_count(fits[0])})
    if others:
        words.append(
            f"the noise hides the number of half cycles ({_count(fits[0])} fit best, {', '.join(others)} "
            "equally well): intervals and bounds of mu hold for all, standard errors for the best fit only"
        )
    return words


def _count(fit: DecayFit) -> str:
    return str(fit.half_cycles) if fit.at_rest else "no rest in the record"

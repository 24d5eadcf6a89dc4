"""Natural frequency, viscous damping and friction force from the free decay of one mass."""

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError
from ..parameters import checked_known, unit_of
from ..signals.plateaus import unclipped
from ..signals.samples import checked_record, largest_gap, within
from ..signals.turning_points import (
    TurningPoints,
    noise_level,
    resolution,
    without_spikes,
)
from ..statistics.cautions import autocorrelation_warnings, bound_warnings, correlation_warnings
from ..statistics.estimates import estimates, number, verdict
from ..statistics.least_squares import Errors
from ..statistics.levels import FOUND
from ..statistics.robust import LOSSES
from .checks import check_identifiable, check_misfit, checked_turning_points
from .electronics import Electronics, Signal, kept_samples, points_of_motion, signal_of
from .errors import decay_errors, decay_solution
from .falling import falling_friction
from .fit import DecayFit, fit_decay, noise_variance
from .motion import PARAMETERS
from .problem import DRIFT, OFFSET, X_F, ZETA, Record
from .results import results, scaled
from .rounding import rounding_weights
from .starts import usual_half
from .wander import Search, search

#: Codes of what was found, in order.
_VERDICTS = {
    "neither_found": "neither friction nor viscous damping found",
    "friction_found": "friction found, viscous damping not",
    "viscous_damping_found": "viscous damping found, friction not",
    "both_found": "friction and viscous damping found",
}

#: Fits of samples beside which others are left out: the first shows where, further ones move that a little.
_MASKINGS = 3

_LOSS = "growth of the sum of squares without {}, over the variance of a sample"

_NO_REST = "{} shows neither the centre nor the final position: offset is the zero of the signal"

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
    OFFSET: "what is measured of a mass at rest",
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
    **electronics: Unpack[Electronics],
) -> xr.Dataset:
    """Fit the exact decay with Coulomb and viscous friction to all samples of a record.

    Parameters
    ----------
    time : array, shape (samples,)
        Times [s], increasing; equal steps are not needed.
    x : array, shape (samples,)
        Motion of the mass, in `unit`.
    unit : str
        Of `x`: a length ("mm", "m", "um"), an angle ("deg", "rad"), a velocity ("mm/s", "m/s") or an
        acceleration ("m/s^2", "g"), or another unit of these.  Lengths that are given or returned are in the
        unit of the length or angle, in mm for velocities and accelerations.
    known : mapping
        Parameters to be held: f_n [Hz] > 0, zeta in [0, 1), x_F >= 0, X0, t0 [s], centre or offset [`unit`].
        Others are fitted.
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
    filter : mapping
        A low-pass filter that the signal passed: kind "low-pass", order 1 or 2 (Butterworth), frequency_Hz.
    ac_coupling_Hz : float
        Corner frequency of an AC coupling of first order that it passed.
    mask_s : [before, after]
        Times [s] before and after each turning point that are left out, for a filter of linear phase (FIR)
        that is not known: half its length.

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
        Other signals than displacements have an `offset` [`unit`] in place of the centre.  Velocities and
        accelerations also give `friction_over_mass`, but no `rest`.  Samples beside jumps of an acceleration
        that passed no low-pass filter are left out.

    Raises
    ------
    InputError
        An argument is invalid, or the record is no free decay: no motion, fewer than 3 extrema, an amplitude
        that grows, fewer than 8 samples per cycle, residuals far above the noise between samples, or
        parameters that it does not determine separately.

    Notes
    -----
    Distances of the extrema from the centre follow A_{j+1} = q A_j - (1 + q) x_F with
    q = exp(-pi zeta/sqrt(1 - zeta^2)), T(4.2) without viscous damping; the mass rests from the first
    A_j <= mu x_F.  The number of half cycles before rest is an unknown of the fit.  The velocity or the
    acceleration of the exact motion is fitted to what was measured, which is not integrated; the states of
    filters at the first sample are further unknowns.

    A slope of friction over the speed is damping in a decay: F (1 + a V) adds x_F omega_n a/2 to zeta.  Where
    zeta is 0 and a negative sum fits the record better, a warning says by how much friction falls at least.

    Examples
    --------
    A decay at 1 Hz that loses 4 x_F = 2 mm per cycle, in closed form and with noise:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> n = np.floor(2 * t)  # half cycles
    >>> x = (9.5 - (2 * n + 1) * 0.5) * np.cos(2 * np.pi * t) + (-1) ** n * 0.5
    >>> x += np.random.default_rng(1).normal(0.0, 0.02, t.size)
    >>> fit = fm.identify.free_decay(t, x, known={"zeta": 0.0})
    >>> fit.estimate.sel(parameter=["f_n", "x_F"]).values.round(2)
    array([1. , 0.5])
    """
    signal = signal_of(unit, electronics)
    if not isinstance(drift, bool):
        raise InputError(f"drift must be true or false; got {checks.one_line(drift)}")
    checks.choice(loss, "loss", LOSSES)
    names = _names(signal, drift)
    held = _held(known or {}, names)
    times, places = checked_record(time, x)
    inside = within(window, times)
    times, places = times[inside], places[inside]
    good = unclipped(times, places)
    t, data = times[good], places[good]
    points = checked_turning_points(t, without_spikes(data) if loss == "soft_l1" else data)
    outliers = noise_level(data) if loss == "soft_l1" else 0.0
    record = Record(t, data, held, names, outliers or None)  # exact data have none
    if signal.sensor is not None:
        points = points_of_motion(points, signal.sensor, usual_half(points))
    searched = _masked(record._replace(sensor=signal.sensor), points, signal)
    record, fits = searched.record, searched.fits
    fit = fits[0]
    t, data = record.time, record.x
    if not held:  # a value that is held may be wrong on purpose
        check_misfit(data, float(np.sqrt(fit.solution.sum / data.size)))
    check_identifiable(record, fit)
    found, solution = decay_errors(searched), decay_solution(record, fit)
    losses = _losses(record, points, fit)
    meanings = {name: _MEANINGS[name] for name in names}
    units = [unit_of(name, signal.length, signal.unit) for name in names]
    ds = estimates(meanings, units, solution, found, record.free[: len(names)], data, signal.unit)
    ds["time"] = xr.Variable("sample", t, {"long_name": "time", "units": "s"})
    ds["verdict"] = verdict(_verdict(fit, found, losses), _VERDICTS)
    ds["likelihood_ratio_friction"] = number(losses["x_F"], _LOSS.format("friction"))
    ds["likelihood_ratio_viscous"] = number(losses["zeta"], _LOSS.format("viscous damping"))
    ds = ds.assign(results(record, fits, found, signal, points))
    ds = ds.assign(scaled(fit, found, signal, base, stiffness))
    if signal.leaves_out:
        words = {"long_name": "samples left out beside turning points"}
        ds["samples_left_out"] = xr.Variable((), np.int32(good.sum() - t.size), words)
    ds.attrs["title"] = "Free decay"
    falls = falling_friction(record, points, bool(fit.solution.at_bound[ZETA]), signal.length)
    ds.attrs["warnings"] = "; ".join([*falls, *_warnings(times, good, searched, found, signal)])
    ds.attrs |= signal.attributes
    return ds


def _names(signal: Signal, drift: bool) -> tuple[str, ...]:
    """Parameters: of a signal that does not show the centre its offset."""
    last = PARAMETERS[-1] if signal.shows_centre else OFFSET
    return (*PARAMETERS[:-1], last, *((DRIFT,) if drift else ()))


def _masked(record: Record, points: TurningPoints, signal: Signal) -> Search:
    """Fits without the samples beside jumps, which the fit of all samples shows first."""
    kept = np.ones(record.time.size, dtype=bool)
    for _ in range(_MASKINGS):
        some = record._replace(time=record.time[kept], x=record.x[kept])
        if record.sensor is not None:
            some = some._replace(transients=record.sensor.transients(some.time))
        found, before = _searched(some, points), kept
        kept = kept_samples(
            signal, found.fits[0].decay, max(one.half_cycles for one in found.fits), record.time
        )
        if (kept == before).all():
            break
    return found


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


def _warnings(
    time: np.ndarray, good: np.ndarray, searched: Search, found: Errors, signal: Signal
) -> list[str]:
    """Warnings about a fit."""
    words = [] if signal.shows_rest else [_NO_REST.format(signal.description)]
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

"""The design questions, as functions that return datasets."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.design_labels import DESIGN
from ..errors import InputError
from ..model.system import System
from ..units.axes import KINDS, ratios
from ..units.scales import Scales, Units, scales_of
from .answers import answer
from .at_most import find_ranges
from .band import Band, checked_band, peak_samples
from .force_plane import checked_plane, find_in_plane
from .least_peak import (
    THRESHOLD,
    TWO_PEAKS,
    Minimum,
    Optimum,
    find_optimum,
    find_robust,
    irregular_cells,
    largest,
)
from .limits import (
    boundary_samples,
    has_no_stop_limit,
    largest_stick,
    no_stop_limit,
    starts_matter,
    stick_limit,
)
from .minimum import Points
from .nearest import around, nearest, no_stop_at, stick_at
from .performance import PerformanceCurve
from .responses import Responses
from .samples import SampledPerformance, Samples, sample_values, sampled
from .stops import least_with_stops
from .task import Task, checked_task

#: Relative changes of the friction at which the response is given beside the answer.
_OFFSETS = np.array([-0.2, -0.02, 0.02, 0.2])

#: Response curves of an answer, at these multiples of its friction; also without friction, and stuck.
_CURVES = np.array([0.5, 1.0, 2.0])

#: Peaks of an answer that are listed: those above this share of the largest one.
_LISTED = 0.8


def least_peak(
    system: System,
    band: Any,
    mass: int = 1,
    mu: float = 1.0,
    spread: float | Samples = 0.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> xr.Dataset:
    """Find the friction with the smallest peak response over a band of frequencies.

    Parameters
    ----------
    system : System
    band : array_like, shape (2,)
        Frequency ratios from which and up to which the load acts, > 0; with units also frequencies.
    mass : int
        Mass whose response is made small, counted from 1.
    mu : float
        Ratio of static to kinetic friction [-], >= 1.  Above 1 the larger of the steady states that are
        reached from rest and from a large sliding motion counts.
    spread : float or design.Samples
        Relative spread of the friction, 0 to below 1.  Above 0 the largest response between (1 - spread) and
        (1 + spread) times the friction is made small, as `robust` does.  With samples of an uncertain
        structure their quantile of the largest response is made small.
    quantity : str
        "amplitude" or "first_harmonic" of the mass, "contact": the displacement in a contact, or
        "transmitted_force", the force on the ground.
    contact : int
        Contact of quantity "contact", counted from 1.
    beta : array_like, shape (2,), optional
        Range of friction ratios F/P to search; default: from 0 to 1.25 times the friction that holds over the
        band, further with a spread.  Without damping it begins where all peaks in the band are finite.
    threads : int, optional
        Number of threads; default: all processors of the process.  The result does not depend on it.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`.

    Returns
    -------
    xarray.Dataset
        `beta`, the friction ratio; on `peak` the largest responses over frequency there, from the highest
        down (equal ones by frequency), with `peak_r`, `peak_regime` and `peak_stops`; `kind` of the optimum;
        of a "threshold", at or above which nothing moves, the peak is 0, and `at_r`, the frequency that
        decides, takes the place of these;
        `second_beta` and
        `second_peak` of another minimum within 5 %; `peak_at_offset`, the response with 2 % and 20 % more and
        less friction; `peak_of_beta` on `beta_search`, the performance curve; `beta_no_stop` and
        `beta_stuck` of the band, with mu > 1 also `beta_no_stop_some_starts` and `beta_stuck_some_starts`;
        `response_of_r` (curve, r_search), response curves.  With units also `friction_force` [N],
        `peak_frequency` [Hz] and `peak_m` [m].  Attribute `warnings`: irregular motions that were left out.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or nothing moves in the band.
    NoSteadyState
        Cells of the band have no periodic steady state, and the largest response may be among them: an
        irregular motion of which three quarters of the peak or more were seen, or none that was found.

    Examples
    --------
    >>> import frictionmap as fm
    >>> chain = fm.System(
    ...     contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.01
    ... )
    >>> ds = fm.design.least_peak(chain, band=[0.3, 2.2])
    >>> round(ds.beta.item(), 4), round(ds.peak.values[0], 9), str(ds.kind.values)
    (1.4019, 2.727102937, 'smooth')
    """
    if not isinstance(spread, Samples):
        spread = _checked_spread(spread)
    wide = 0.0 if isinstance(spread, Samples) else spread
    task = checked_task(system, band, (quantity, mass, contact), mu, beta, threads, units, wide)
    if isinstance(spread, Samples):
        return _answer_for_samples(task, spread, widen=beta is None)
    curve = task.performance()
    if spread > 0.0:
        return _answer("robust", task, curve, find_robust(task, curve, spread), {"spread": spread})
    return _answer("least-peak", task, curve, find_optimum(task, curve), {})


def two_forces(
    system: System,
    band: Any,
    second: int = 2,
    ratio: Any = (0.0, 2.0),
    mass: int = 1,
    mu: float = 1.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> xr.Dataset:
    """Find the two friction forces with the least largest response over a band of frequencies.

    The friction of all contacts is scaled by beta, as in `least_peak`, and the ratio of one contact is varied
    as well.  It takes tens of seconds, because each ratio is a question of its own.

    Parameters
    ----------
    system : System
        With a list of contacts.
    band, mass, mu, quantity, contact, beta, threads, units : as in `least_peak`
        Without `beta` the friction is searched in the range of the given ratio.
    second : int
        Contact whose ratio is varied, counted from 1.
    ratio : array_like, shape (2,)
        Range of its ratio [-], >= 0, in place of the one that it has.

    Returns
    -------
    xarray.Dataset
        As of `least_peak`, for the best ratio; `second_ratio`, that ratio, to 1e-4 of its range; on
        `ratio_search` the least peak of other ratios, `peak_of_ratio`, and its friction, `beta_of_ratio`.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or the contact has a force of its own.
    NoSteadyState
        Cells of the band have no periodic steady state: the largest response may be among them.
    """
    task = checked_task(system, band, (quantity, mass, contact), mu, beta, threads, units)
    plane = checked_plane(task.system, second, ratio)
    task, curve, optimum, ridge = find_in_plane(task, plane)
    k = int(np.argmin(ridge.peak))
    further = {
        "ratio_search": ridge.ratio, "peak_of_ratio": ridge.peak, "beta_of_ratio": ridge.beta,
        "second_ratio": ridge.ratio[k],
    }  # fmt: skip
    asked = {"second": plane.contact, "ratio": [plane.low, plane.high]}
    return _answer("two-forces", task, curve, optimum, asked, further)


def robust(
    system: System,
    band: Any,
    spread: float | Samples = 0.2,
    mass: int = 1,
    mu: float = 1.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> xr.Dataset:
    """Find the friction whose worst response within its relative spread, or over samples, is least.

    Parameters and results are those of `least_peak`; the peaks are those at the worse end of the spread.
    With `design.Samples` they are those of the sample at the quantile; `peak_of_sample` on `sample` is the
    largest response of each, `beta_no_stop` and `beta_stuck` hold for all samples, and the response curves
    are those of the nominal structure.
    """
    if not isinstance(spread, Samples) and _checked_spread(spread) == 0.0:
        raise InputError("spread", "must be > 0; got 0")
    return least_peak(
        system, band, mass, mu, spread, quantity=quantity, contact=contact, beta=beta, threads=threads,
        units=units,
    )  # fmt: skip


def at_most(
    system: System,
    band: Any,
    limit: Any,
    mass: int = 1,
    mu: float = 1.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> xr.Dataset:
    """Find all friction with which a response stays within a limit over a band of frequencies.

    Parameters
    ----------
    limit : float or str
        Largest response that is allowed, over P/k1 (Y), or of a force over P; with units also a length or a
        force, such as "3 mm".
    others
        As in `least_peak`.

    Returns
    -------
    xarray.Dataset
        That of `least_peak`, with `interval_begin` and `interval_end` (interval): ranges of the friction
        ratio.  A range may have no end: from `beta_stuck` on nothing changes.

    Raises
    ------
    InputError
        As `least_peak`; or the limit is below the least peak, which the message gives.
    NoSteadyState
        As `least_peak`.
    """
    checks.instance(system, "system", System)
    kind = "force" if quantity == "transmitted_force" else "length"
    value = checks.number(_single(limit, "limit", kind, scales_of(units, system)), "limit", above=0.0)
    task = checked_task(system, band, (quantity, mass, contact), mu, beta, threads, units)
    curve = task.performance()
    optimum, begins, ends = find_ranges(task, curve, value)
    ranges = {"interval": np.arange(1, begins.size + 1), "interval_begin": begins, "interval_end": ends}
    return _answer("at-most", task, curve, optimum, {"limit": value}, ranges)


def no_stop(system: System, band: Any, mu: float = 1.0, *, units: Units | None = None) -> xr.Dataset:
    """Find the most friction without a stop anywhere in a band: with mu = 1 the least beta_lim, theory.md 3.

    With mu > 1 motions are followed from many initial states, in which a contact is about to slip at any
    phase of the load: none of them goes on stopping.  That is no proof that no other one does.

    Parameters
    ----------
    system, band, mu, units
        As in `least_peak`.

    Returns
    -------
    xarray.Dataset
        `beta`, and `at_r`, the frequency that decides; `beta_lim_of_r` and `beta_stick_of_r` on `r_search`.
        With mu > 1 also `beta_no_stop_some_starts`, the least beta_lim: up to there motions without stops
        exist.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or a contact has a spring.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.design.no_stop(fm.System(damping_ratios=0.01), band=[0.3, 0.6])
    >>> round(ds.beta.item(), 9), round(ds.at_r.item(), 9)
    (0.005620882, 0.333310347)
    """
    checked, scales = _checked(system, band, mu, units)
    every, some, points = least_with_stops(system, checked, mu)
    found = {"beta": every.beta, "at_r": every.r, "mu": mu, **_boundaries(system, mu, points)}
    if starts_matter(system, mu):
        found["beta_no_stop_some_starts"] = some.beta
    return answer("no-stop", system, checked, found, {"mu": mu}, units, scales)


def stuck(system: System, band: Any, mu: float = 1.0, *, units: Units | None = None) -> xr.Dataset:
    """Find the least friction that holds over a band: the largest beta_stick, or beta_noslip, theory.md 4.

    With mu > 1 it holds whatever the initial state: mu beta_stick, with which kinetic friction is enough and
    every motion comes to rest, theory.md 6.

    Parameters
    ----------
    system, band, mu, units
        As in `least_peak`.

    Returns
    -------
    xarray.Dataset
        `beta`, infinite where a structure that is held resonates without damping, and `at_r`, the frequency
        that decides; `beta_lim_of_r` and `beta_stick_of_r` on `r_search`.  With mu > 1 also
        `beta_stuck_some_starts`, the largest beta_stick, with which contacts that are stuck stay so (one
        mass: from rest), and `beta_stuck_of_r`.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.design.stuck(fm.System(contact="joined-base-wall"), band=[0.5, 1.5]).beta.item()
    2.25
    """
    checked, scales = _checked(system, band, mu, units)
    beta, r = largest_stick(system, checked, None)
    found = {"beta": beta, "at_r": r, "mu": mu, **_boundaries_over(system, checked, mu)}
    if starts_matter(system, mu):
        found["beta_stuck_some_starts"] = largest_stick(system, checked, mu).beta
    return answer("stuck", system, checked, found, {"mu": mu}, units, scales)


def margin(system: System, r: Any, beta: Any, mu: float = 1.0, *, units: Units | None = None) -> xr.Dataset:
    """Find how far a working point is from the boundaries of its regime, in friction and in frequency.

    Parameters
    ----------
    system, mu, units
        As in `least_peak`.
    r : float
        Frequency ratio of the working point, > 0; with units also a frequency.
    beta : float
        Its friction ratio, > 0; with units also a force.

    Returns
    -------
    xarray.Dataset
        `beta_lim` and `beta_stick` at r, `margin_beta_lim` and `margin_beta_stick`: how much they are above
        beta, relative to beta; `nearest_r_on_beta_lim` and `nearest_r_on_beta_stick`, the nearest frequencies
        within a factor of ten at which a boundary is beta (NaN: none), `margin_r` and `margin_r_stick`: how
        far they are, relative to r.  With mu > 1 the boundaries are those of some initial states.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.design.margin(fm.System(damping_ratios=0.01), r=0.75, beta=0.6)
    >>> round(100 * ds.margin_beta_lim.item(), 6), round(100 * ds.margin_r.item(), 6)
    (27.535839, -14.57624)
    """
    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    r = checks.number(_single(r, "r", KINDS["r"], scales), "r", above=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(_single(beta, "beta", KINDS["beta"], scales), "beta", above=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    found: dict[str, Any] = {"at_r": r, "beta": beta, "mu": mu}
    limits: dict[str, tuple] = {"beta_stick": (stick_limit, stick_at, "margin_r_stick")}
    if has_no_stop_limit(system):
        limits["beta_lim"] = no_stop_limit, no_stop_at, "margin_r"
    low = 0.5 * r
    for name, (limit, at, margin_r) in limits.items():
        value, line = float(limit(system, np.array([r]), mu)[0]), at(system, beta, mu)
        place = nearest(line, r)
        low = max(low, around(line, r).low)
        found |= {name: value, f"margin_{name}": value / beta - 1.0}
        found |= {f"nearest_r_on_{name}": place, margin_r: place / r - 1.0}
    shown = Band(low, 2.0 * r)
    found |= _boundaries_over(system, shown, mu)
    return answer("margin", system, shown, found, {"r": r, "beta": beta, "mu": mu}, units, scales)


def _single(given: Any, name: str, kind: str, scales: Scales) -> Any:
    """A number, or one with a unit as a ratio."""
    found = ratios(given, name, kind, scales)
    return found[0] if isinstance(found, list) and not isinstance(given, list) else found


def _checked_spread(spread: Any) -> float:
    value = checks.number(spread, "spread", least=0.0)
    if value >= 1.0:
        raise InputError("spread", f"must be < 1; got {value:g}")
    return value


def _checked(system: Any, band: Any, mu: Any, units: Units | None) -> tuple[Band, Scales]:
    """Check the arguments of questions about boundaries."""
    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    checks.number(mu, "mu", least=1.0)
    return checked_band(band, scales), scales


def _boundaries_over(system: System, band: Band, mu: float) -> dict[str, np.ndarray]:
    """The boundaries over a band, for pictures."""
    r = boundary_samples(system, band)
    if not has_no_stop_limit(system):
        return _boundaries(system, mu, Points(r, np.empty(0)))
    return _boundaries(system, mu, Points(r, no_stop_limit(system, r, mu)))


def _boundaries(system: System, mu: float, no_stop: Points) -> dict[str, np.ndarray]:
    """The boundaries at the frequencies at which beta_lim is known, if the system has one, for pictures."""
    r = no_stop.beta
    found = {"r_search": r, "beta_stick_of_r": stick_limit(system, r, mu)}
    if no_stop.size.size:
        found["beta_lim_of_r"] = no_stop.size
    if starts_matter(system, mu):
        found["beta_stuck_of_r"] = stick_limit(system, r, None)
    return found


def _answer(
    question: str, task: Task, curve: PerformanceCurve, optimum: Optimum,
    asked: Mapping[str, Any], further: Mapping[str, Any] | None = None,
    study: Mapping[str, Any] | None = None,
) -> xr.Dataset:  # fmt: skip
    """Build the dataset of a question about the largest response."""
    best = optimum.best
    second = optimum.second or Minimum(np.nan, np.nan, "")
    points = optimum.points
    unknown = [curve.unknown[beta].number if beta in curve.unknown else 0 for beta in points.beta.tolist()]
    found = {
        "beta": best.beta, "mu": task.mu, "kind": best.kind, **_peaks(curve, optimum, "spread" in asked),
        "second_beta": second.beta, "second_peak": second.size,
        "beta_search": points.beta, "peak_of_beta": points.size,
        "unknown_of_beta": unknown,
        "offset": _OFFSETS, "peak_at_offset": largest(curve.whole(best.beta * (1.0 + _OFFSETS))),
        **({} if study else task.limits()), **(further or {}), **_response_curves(task, best.beta),
        **{name: value for name, value in asked.items() if name in DESIGN},
    }  # fmt: skip
    keys = {"response": task.response.as_config(), "mu": task.mu, "beta": [task.low, task.high], **asked}
    ds = answer(question, task.system, task.band, found, keys, task.units, task.scales, study)
    caution = irregular_cells(curve, best.beta)
    return ds.assign_attrs(warnings=caution) if caution else ds


def _peaks(curve: PerformanceCurve, optimum: Optimum, of_spread: bool) -> dict[str, Any]:
    """The peaks of an answer, the largest one first: with a spread the worst in it.  A threshold has none."""
    best, peaks = optimum.best, optimum.peaks
    if best.kind == THRESHOLD:
        return {"peak": [0.0], "at_r": peaks.r[0]}
    listed = peaks.above(_LISTED * peaks.largest).by_frequency(TWO_PEAKS)
    states = curve.states(listed)
    size = np.concatenate(([best.size], listed.size[1:])) if of_spread else listed.size
    return {"peak": size, "peak_r": listed.r, "peak_regime": states.regime, "peak_stops": states.stops}


def _answer_for_samples(task: Task, samples: Samples, *, widen: bool) -> xr.Dataset:
    """Build the dataset of the friction that is best for a quantile of samples."""
    variations = samples.of(task.system)
    task, tasks = sampled(task, variations, widen=widen)
    curve = SampledPerformance(tasks, samples.quantile)
    optimum = find_optimum(task, curve)
    further = sample_values(tasks, curve, optimum.best.beta)
    asked = {"quantile": samples.quantile}
    return _answer("robust", task, curve, optimum, asked, further, variations.described)


def _response_curves(task: Task, beta: float) -> dict[str, np.ndarray]:
    """Response curves at the answer, at half and twice its friction, without friction, and stuck."""
    responses = Responses(task.system, task.response, task.mu, task.threads)
    r = peak_samples(task.system, task.band)
    levels = np.unique(np.concatenate(([0.0] if task.may_be_without_friction else [], beta * _CURVES)))
    sizes = responses.on_grid(r, levels).size.T
    if np.isfinite(task.stuck.beta):
        sizes = np.vstack((sizes, responses.on_grid(r, np.array([1.01 * task.stuck.beta])).size.T))
        levels = np.append(levels, np.inf)
    return {"curve": levels, "r_search": r, "response_of_r": sizes}

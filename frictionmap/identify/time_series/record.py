"""Natural frequency, damping, friction and mu of one mass from a record of its steady motion."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from ... import checks
from ...datasets.provenance import system_text
from ...errors import InputError
from ...model.system import DAMPING_REFERENCES
from ...units.table import checked_unit
from ..explanations import Outcome
from ..parameters import ALIKE, CONTACT_STIFFNESS, checked_free, checked_known, is_elastic, refuse_mu
from ..spring import spring_in_newtons, spring_warnings
from ..statistics.cautions import bound_warnings, correlation_warnings
from ..statistics.estimates import estimates, friction_force, number, usable_errors, verdict
from ..statistics.least_squares import Errors, undetermined
from ..statistics.levels import MISFIT, MISFIT_SHARE
from ..statistics.robust import LOSSES
from .alternatives import SEEN, Task, Tried, explained
from .data import measured_record
from .errors import DERIVED
from .estimates import model_estimates, tolerances, units, with_others
from .fit import RecordFit
from .labels import data_warnings, one_mass, record_variables
from .motion import CONTACTS, GAIN, LAW, MU, OFFSET, PARAMETERS, X_F, ZETA, outer
from .static_friction import IDLE, mu_warnings
from .verdict import listed, record_verdict

#: What can be fitted or held.
FITTABLE = (*PARAMETERS[:MU], "mu", CONTACT_STIFFNESS, *PARAMETERS[MU + 1 :])

#: Estimates that can take each other's place: all of these dissipate, or hold the mass.
_TRADING = (ZETA, X_F, MU)

_MODEL_ERROR = "residuals at the harmonics of the base, over the noise beside them; 1 if due to chance"

_TOLERANCE = "{} between the channels that moves f_n, zeta or x_F by half its interval"

_MEANINGS = {
    "f_n": "natural frequency without friction and damping",
    "zeta": "viscous damping ratio",
    "x_F": "kinetic friction force over stiffness",
    "mu": "static over kinetic friction force",
    "delay": "time by which x is behind what the base moves, because the channels differ",
    "gain": "gain of x over that of the base; lengths are in the units of one or the other",
    "offset_x": "place of the unloaded mass where the base is at its zero, the mean over the record",
    "beta": "friction ratio, x_F over the first harmonic of the base",
    "lag_deg": "lag of the first harmonic of the mass behind that of the base, as measured",
    "amplitude_ratio": "first harmonic of the mass over that of the base, as measured",
    "stops_per_cycle": "stops that begin in a cycle of the fitted motion",
}

#: With a spring in the contact, in the places of mu and of stops.
_SPRING_MEANINGS = {
    "mu": (
        CONTACT_STIFFNESS,
        "stiffness of the spring in the contact over that of the mass; on its bound: rigid",
    ),
    "stops_per_cycle": ("slips_per_cycle", "slips that begin in a cycle of the fitted motion"),
}


def record(
    time: Sequence[float] | np.ndarray,
    base: Sequence[float] | np.ndarray,
    x: Sequence[float] | np.ndarray,
    *,
    unit: str = "mm",
    contact: str = "fixed-wall",
    damping_reference: str = "ground",
    known: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    window: object = None,
    loss: str = "linear",
    free: Sequence[str] | None = None,
) -> xr.Dataset:
    """Fit the exact steady motion of one mass with friction, under the measured base, to all samples.

    Parameters
    ----------
    time : array, shape (samples,)
        Times [s], increasing; equal steps and whole cycles are not needed.
    base, x : array, shape (samples,)
        Displacements of the base and of the mass in space, in `unit`; in steady motion, 2 cycles or more.
    unit : "mm", "m" or "um"
        Of `base` and `x`, and of every length that is given or returned.
    contact : "fixed-wall" or "joined-base-wall"
        Whether the mass rubs on a wall that stands still, or on one that moves with the base.
    damping_reference : "ground" or "base"
        Whether the damper acts on the velocity of the mass, or on that relative to the base.
    known : mapping
        Parameters to be held: f_n [Hz] > 0, zeta >= 0, x_F >= 0, mu >= 1, offset_x, contact_stiffness > 0
        (kt/k of a spring in the contact), delay [s] of x behind the base and gain > 0 of x over the base, by
        their channels.  Others are fitted, but the contact is rigid, and the channels agree, unless `free`
        or `known` names contact_stiffness, delay or gain, or the record cannot be explained without one.
    stiffness : float
        k [N/m] > 0; gives the friction force F = k x_F [N], and the stiffness of a spring in the contact
        [N/m].
    window : [begin, end]
        Times [s] of the part to be fitted; default: all.
    loss : "linear" or "soft_l1"
        What residuals cost: their squares, or less beyond the level of the noise, for outliers.
    free : sequence of str
        Parameters to be fitted, all that are not known; needed only to name contact_stiffness, delay or
        gain, or so that none of them is added.

    Returns
    -------
    xarray.Dataset
        On parameter (f_n, zeta, x_F, mu, delay and gain if they were named or added, offset_x, and what
        follows: beta = x_F/Y_1, lag_deg and amplitude_ratio of the measured first harmonics, stops_per_cycle
        of the fit): estimate, standard_error, lower and upper (95 %, one-sided where `at_bound`), `known`,
        unit; `correlation`; on sample: time, base, data, model, residual; on channel and harmonic: `phasor`,
        at the middle of the record, and its error; scalars `base_frequency`, `cycles`, `base_distortion`,
        `drift`, `change` (stationarity), `residual_rms`, `verdict`, `delay_tolerance`, `gain_tolerance` and
        others.  Attribute `warnings`.  With a spring in the contact contact_stiffness takes the place of mu,
        and slips_per_cycle that of stops_per_cycle.

    Raises
    ------
    InputError
        An argument is invalid; base or mass do not move; fewer than 2 cycles or 8 samples per cycle; nothing
        is known, and no model comes near to the record.

    Notes
    -----
    The base moves the mass by its harmonics 0 to 5, which are measured with errors: these are part of the
    fit and of the standard errors, as are drift and slow wander of the zero of the mass.

    mu is 1 unless it is known or the data ask for more (likelihood ratio).  It shows in how late the mass
    leaves its stops, as (mu - 1)^2: where its interval begins at 1 its standard error is NaN, and the
    intervals of the others allow for all mu in it.  Where the mass never sticks, mu changes nothing.

    The verdict is `not_identified` where estimates depend so much on each other that this record cannot
    determine them: by correlations beyond 0.95 if friction is not known to 10 %, and beyond 0.5 if the model
    leaves more than noise at the harmonics of the base (`model_error` > 1).  `joint` fits several records.

    Where the model leaves more than noise, it is fitted again with a spring in the contact, a delay or a gain
    between the channels, and without each known value.  If one of the first three alone explains the record
    it is added, and the verdict names it.  Otherwise the verdict is `explained_otherwise` or `not_explained`,
    and the estimates must not be used.

    Of a contact with a spring mu is 1.  Where the record excludes small stiffnesses only, `upper` is
    infinite, the standard error NaN, and a warning says so.  An estimate on its bound is a rigid contact.

    Examples
    --------
    A rig at 3 Hz whose friction is 0.4 times 1.75 mm, and its steady motion with noise:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> rig = fm.System(excitation="base", damping_reference="base", damping_ratios=0.01)
    >>> cycle = fm.response(rig, 0.5, 0.4, points=100).isel(tau=slice(0, -1))
    >>> rng = np.random.default_rng(1)
    >>> t = np.arange(800) / 150.0  # 8 cycles at 1.5 Hz, half of the natural frequency
    >>> base = 1.75 * np.tile(np.cos(cycle.tau.values), 8) + rng.normal(0.0, 0.003, 800)
    >>> x = 1.75 * np.tile(cycle.x.values[0], 8) + rng.normal(0.0, 0.01, 800)
    >>> fit = fm.identify.record(t, base, x)
    >>> fit.estimate.sel(parameter=["f_n", "x_F"]).values.round(2)
    array([3.01, 0.69])
    """
    checked_unit(unit, "length", "unit")
    checks.choice(contact, "contact", CONTACTS)
    checks.choice(damping_reference, "damping_reference", DAMPING_REFERENCES)
    checks.choice(loss, "loss", LOSSES)
    elastic = is_elastic(checked_free(free, known or {}, FITTABLE), known or {})
    held = _held(known or {}, free)
    task = Task(contact, damping_reference, held, elastic)
    spring_or_delay = elastic or "delay" not in held
    given = measured_record(time, base, x, window, loss == "soft_l1", spring_or_delay)
    calibrated = [name for name in ALIKE if name in (known or {})]
    outcome = explained(task, given, calibrated, free is None)
    fit = outcome.chosen.fit
    if elastic:
        _check_identifiable(fit)
    if not known:  # a value that is held may be wrong on purpose
        _check_misfit(outcome)
    own = model_estimates(outcome.chosen)
    given, values, found = own
    covering, causes = with_others(outcome, own, unit)
    shown = _usable(fit, covering)
    hidden = [name for name in ALIKE if name not in (*(known or {}), *(free or ()), outcome.chosen.name)]
    ds = _dataset(fit, values, shown, unit, hidden)
    within = tolerances(outcome.chosen, found)
    for name, (most, _) in within.items():
        ds[f"{name}_tolerance"] = number(most, _TOLERANCE.format(name), "s" if name == "delay" else "1")
    ds["verdict"] = verdict(*record_verdict(outcome, found, causes, within))
    base_used = given.channels[given.good, 0]
    ds["time"] = xr.Variable("sample", given.samples.time, {"long_name": "time", "units": "s"})
    ds["base"] = xr.Variable("sample", base_used, {"long_name": "base, measured", "units": unit})
    ds = ds.assign(record_variables(given, unit)).assign(
        _motion_variables(fit, values, shown, unit, stiffness)
    )
    ds.attrs["title"] = "Record of steady motion"
    ds.attrs["config"] = system_text(one_mass(contact, damping_reference))
    ds.attrs["warnings"] = "; ".join(data_warnings(given, ds) + _fit_warnings(fit, found))
    return ds


def _check_misfit(outcome: Outcome[Tried]) -> None:
    """Refuse a record that no model comes near to, as `free_decay` does.

    Raises
    ------
    InputError
        Residuals at the harmonics are far above the noise, and a large part of the motion.
    """
    fit = outcome.chosen.fit
    rms, noise = float(np.sqrt(np.mean(fit.residual**2))), outcome.chosen.noise
    far = fit.model_error > MISFIT and rms > MISFIT_SHARE * float(np.std(fit.samples.x))
    if outcome.chosen.explains or outcome.alike or not far:
        return
    raise InputError(
        f"cannot fit x as a steady motion of one mass with friction: the residuals ({rms:.4g} rms) are far "
        f"above the noise beside the harmonics ({noise:.4g}), also with a spring in the contact or with "
        "channels that differ; check contact, damping_reference and the columns"
    )


def _check_identifiable(fit: RecordFit) -> None:
    """Refuse a motion that does not depend on some parameters, or not in ways of their own."""
    indices, _ = undetermined(fit.problem, fit.solution, SEEN)
    found = {int(index) for index in indices if index < len(PARAMETERS)}
    if X_F in found and fit.free[OFFSET]:
        found.add(OFFSET)  # a contact that does not slip holds the mass at any place
    names = [fit.mass.names[index] for index in sorted(found)]
    if names:
        raise InputError(
            f"cannot identify {listed(names)}: the contact of the fitted motion does not slip, or hardly; "
            "measure with less friction or more motion, or hold them in known"
        )


def _held(known: Mapping[str, float], free: Sequence[str] | None) -> dict[str, float]:
    """Parameters to be held, those by which channels are alike among them, one at least free.

    free : parameters to be fitted of a contact with a spring
    """
    alike = {name: value for name, value in ALIKE.items() if name not in (free or ())}
    result = alike | checked_known(known, FITTABLE)
    if is_elastic(free, known):
        refuse_mu(free, result)
        result.pop("mu", None)
    if len(result) == len(PARAMETERS):
        raise InputError(f"known must leave at least one parameter free; got all of {', '.join(known)}")
    return result


def _dataset(fit: RecordFit, values: np.ndarray, found: Errors, unit: str, hidden: list[str]) -> xr.Dataset:
    """The estimates, residuals as they are measured.

    hidden : parameters that are not shown
    """
    elastic, bound = fit.mass.elastic, fit.solution.at_bound[: len(PARAMETERS)]
    meanings = dict(
        _SPRING_MEANINGS.get(name, (name, words)) if elastic else (name, words)
        for name, words in _MEANINGS.items()
    )
    solution = fit.solution._replace(
        values=values, residual=fit.residual, at_bound=np.append(bound, [bound[X_F], False, False, False])
    )
    every = np.append(fit.free, np.ones(len(DERIVED), dtype=bool))
    ds = estimates(meanings, units(unit), solution, found, every, fit.samples.x, unit)
    for name in list(meanings)[len(PARAMETERS) :]:
        own = ds.sel(parameter=name)
        ds[name] = number(float(own["estimate"]), meanings[name], str(own["unit"].values))
    ds["model_error"] = number(fit.model_error, _MODEL_ERROR)
    return ds.drop_sel(parameter=hidden, parameter2=hidden)


def _usable(fit: RecordFit, found: Errors) -> Errors:
    """Errors as they are reported: no standard errors where only the interval can be used.

    Of lengths there are two values where the gains of the channels differ.
    """
    errors = found.standard_error
    if not fit.mass.elastic:
        errors = usable_errors(found, MU, 1.0, bool(fit.free[MU]))
    if fit.free[GAIN]:
        errors = np.where(np.isin(np.arange(errors.size), (X_F, OFFSET)), np.nan, errors)
    return found._replace(standard_error=errors)


def _motion_variables(
    fit: RecordFit, values: np.ndarray, found: Errors, unit: str, stiffness: float | None
) -> dict[str, xr.Variable]:
    """Further results of the fitted motion."""
    if fit.mass.elastic:
        share = "elastic_fraction", "share of the cycle in which the contact of the fit does not slip"
    else:
        share = "stuck_fraction", "share of the cycle in which the fit sticks"
    result = {share[0]: number(fit.motion.stuck, share[1])}
    if stiffness is not None:
        force = friction_force(float(fit.values[X_F]), float(found.standard_error[X_F]), stiffness, unit)
        if fit.mass.elastic:
            result |= spring_in_newtons(values, found, LAW, float(stiffness))
        result |= force
    return result


def _fit_warnings(fit: RecordFit, found: Errors) -> list[str]:
    """Warnings about the estimates."""
    words = []
    if not fit.motion.repeats:
        words.append("the fitted motion does not repeat after one cycle of the base")
    if fit.static == IDLE:
        words.append(
            f"mu cannot be determined: the fit never sticks for any mu from 1 to {found.upper[MU]:.4g}"
        )
    names = fit.mass.names
    if fit.mass.elastic:
        words += spring_warnings(float(found.lower[LAW]), float(found.upper[LAW])) if fit.free[LAW] else []
    else:
        words += mu_warnings(fit.static, not fit.free[MU] or bool(found.lower[MU] > 1.0))
    if fit.model_error > 1.0:
        words.append(
            f"the model does not explain the record down to its noise: at the harmonics of the base "
            f"residuals are {fit.model_error:.3g} times the noise, standard errors were multiplied by "
            f"{found.inflation:.3g}"
        )
    elif found.inflation > 1.0:
        words.append(
            f"the noise is larger near the harmonics of the base: standard errors were multiplied by "
            f"{found.inflation:.3g}"
        )
    pairs = found.correlation[np.ix_(_TRADING, _TRADING)]
    words += correlation_warnings([names[index] for index in _TRADING], pairs)
    at_bound = fit.solution.at_bound[: len(PARAMETERS)].copy()
    at_bound[LAW] &= not fit.mass.elastic  # `spring_warnings` has words for it
    return words + bound_warnings(names, outer(fit.mass.floor, fit.mass.elastic), at_bound)

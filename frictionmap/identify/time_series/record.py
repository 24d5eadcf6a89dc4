"""Natural frequency, damping, friction and mu of one mass from a record of its steady motion."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from ... import checks
from ...datasets.provenance import system_text
from ...errors import InputError
from ...model.system import DAMPING_REFERENCES
from ...units.table import checked_unit, conversion
from ..parameters import CONTACT_STIFFNESS, checked_free, is_elastic, refuse_mu
from ..spring import held_compliance, spring_in_newtons, spring_warnings, with_stiffness
from ..statistics.cautions import bound_warnings, correlation_warnings, interval_warnings
from ..statistics.estimates import estimates, number, usable_errors, verdict
from ..statistics.least_squares import Errors, undetermined
from ..statistics.robust import LOSSES
from .data import fit_clipped, measured_record, whole_record
from .errors import DERIVED, derived_values, record_errors
from .fit import RecordFit
from .labels import of_data, of_record, one_mass
from .motion import CONTACTS, LAW, MU, OFFSET, PARAMETERS, X_F, ZETA, outer
from .static_friction import IDLE, ONE
from .verdict import listed, record_verdict

#: What can be fitted or held.
FITTABLE = (*PARAMETERS[:MU], "mu", CONTACT_STIFFNESS, *PARAMETERS[MU + 1 :])

#: Estimates that can take each other's place: all of these dissipate, or hold the mass.
_TRADING = (ZETA, X_F, MU)

_MODEL_ERROR = "residuals at the harmonics of the base, over the noise beside them; 1 if due to chance"

_MEANINGS = {
    "f_n": "natural frequency without friction and damping",
    "zeta": "viscous damping ratio",
    "x_F": "kinetic friction force over stiffness",
    "mu": "static over kinetic friction force",
    "offset_x": "place of the unloaded mass where the base is at its zero, the mean over the record",
    "beta": "friction ratio, x_F over the first harmonic of the base",
    "lag_deg": "lag of the first harmonic of the mass behind that of the base, as measured",
    "amplitude_ratio": "first harmonic of the mass over that of the base, as measured",
    "stops_per_cycle": "stops that begin in a cycle of the fitted motion",
}

#: With a spring in the contact, in the places of mu and of stops.
_OF_SPRING = {
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
        (kt/k of a spring in the contact).  Others are fitted, but the contact is rigid unless `free` or
        `known` names contact_stiffness.
    stiffness : float
        k [N/m] > 0; gives the friction force F = k x_F [N], and the stiffness of a spring in the contact
        [N/m].
    window : [begin, end]
        Times [s] of the part to be fitted; default: all.
    loss : "linear" or "soft_l1"
        What residuals cost: their squares, or less beyond the level of the noise, for outliers.
    free : sequence of str
        Parameters to be fitted, all that are not known; needed only to name contact_stiffness.

    Returns
    -------
    xarray.Dataset
        On parameter (f_n, zeta, x_F, mu, offset_x, and what follows: beta = x_F/Y_1, lag_deg and
        amplitude_ratio of the measured first harmonics, stops_per_cycle of the fit): estimate,
        standard_error, lower and upper (95 %, one-sided where `at_bound`), `known`, unit; `correlation`; on
        sample: time, base, data, model, residual; on channel and harmonic: `phasor`, at the middle of the
        record, and its error; scalars `base_frequency`, `cycles`, `base_distortion`, `drift`, `change`
        (stationarity), `residual_rms`, `verdict` and others.  Attribute `warnings`.  With a spring in the
        contact contact_stiffness takes the place of mu, and slips_per_cycle that of stops_per_cycle.

    Raises
    ------
    InputError
        An argument is invalid; base or mass do not move; fewer than 2 cycles or 8 samples per cycle.

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

    Of a contact with a spring mu is 1.  Where the record excludes small stiffnesses only, `upper` is
    infinite, the standard error NaN, and a warning says so.  An estimate on its bound is a rigid contact.
    """
    checked_unit(unit, "length", "unit")
    checks.choice(contact, "contact", CONTACTS)
    checks.choice(damping_reference, "damping_reference", DAMPING_REFERENCES)
    checks.choice(loss, "loss", LOSSES)
    elastic = is_elastic(checked_free(free, known or {}, FITTABLE), known or {})
    held = checked_known(known or {}, free if elastic else None)
    robust = loss == "soft_l1"
    given = measured_record(time, base, x, window, robust, elastic)
    given, fit = fit_clipped(contact, damping_reference, given, held, robust, elastic)
    given = whole_record(given, fit, robust)
    phasors = given.phasors
    if elastic:
        _check_identifiable(fit)
    found = record_errors(fit, phasors, given.time, given.good)
    values = np.concatenate((fit.values, derived_values(fit, phasors)))
    if elastic:
        values, found = with_stiffness(values, found, LAW, bool(fit.free[LAW]))
    ds = _dataset(fit, values, found, unit)
    base_used = given.channels[given.good, 0]
    ds["time"] = xr.Variable("sample", given.samples.time, {"long_name": "time", "units": "s"})
    ds["base"] = xr.Variable("sample", base_used, {"long_name": "base, measured", "units": unit})
    ds = ds.assign(of_record(given, unit)).assign(_of_motion(fit, values, found, unit, stiffness))
    ds.attrs["title"] = "Record of steady motion"
    ds.attrs["config"] = system_text(one_mass(contact, damping_reference))
    ds.attrs["warnings"] = "; ".join(of_data(given, ds) + _of_fit(fit, found))
    return ds


def _check_identifiable(fit: RecordFit) -> None:
    """Refuse a motion that does not depend on some parameters, or not in ways of their own."""
    indices, _ = undetermined(fit.problem, fit.solution)
    found = {int(index) for index in indices if index < len(PARAMETERS)}
    if X_F in found and fit.free[OFFSET]:
        found.add(OFFSET)  # a contact that does not slip holds the mass at any place
    names = [fit.mass.names[index] for index in sorted(found)]
    if names:
        raise InputError(
            f"cannot identify {listed(names)}: the contact of the fitted motion does not slip, or hardly; "
            "measure with less friction or more motion, or hold them in known"
        )


def checked_known(known: Mapping[str, float], free: Sequence[str] | None) -> dict[str, float]:
    """Parameters to be held, if they are known by name and in range; the compliance of a spring.

    free : parameters to be fitted of a contact with a spring
    """
    ranges: dict[str, dict[str, float]] = {
        "f_n": {"above": 0.0},
        "zeta": {"least": 0.0, "most": checks.LARGEST_DAMPING},
        "x_F": {"least": 0.0},
        "mu": {"least": 1.0},
    }
    result = {}
    for name, value in known.items():
        checks.choice(name, "known", FITTABLE)
        if name == CONTACT_STIFFNESS:
            result[name] = held_compliance(value)
            continue
        result[name] = checks.number(value, f"known.{name}", **ranges.get(name, {}))
    if is_elastic(free, known):
        refuse_mu(free, result)
        result.pop("mu", None)
    if len(result) == len(PARAMETERS):
        raise InputError(f"known must leave at least one parameter free; got all of {', '.join(PARAMETERS)}")
    return result


def _dataset(fit: RecordFit, values: np.ndarray, found: Errors, unit: str) -> xr.Dataset:
    """The estimates, residuals as they are measured."""
    size, elastic = len(PARAMETERS), fit.mass.elastic
    at_bound = fit.solution.at_bound[:size]
    further = np.array([at_bound[X_F], False, False, False])
    solution = fit.solution._replace(
        values=values,
        residual=fit.residual,
        at_bound=np.concatenate((at_bound, further)),
    )
    units = ("Hz", "1", unit, "1", unit, "1", "deg", "1", "1")
    every = np.concatenate((fit.free, np.ones(len(DERIVED), dtype=bool)))
    if not elastic:
        found = found._replace(standard_error=usable_errors(found, MU, 1.0, bool(every[MU])))
    meanings = dict(
        _OF_SPRING.get(name, (name, words)) if elastic else (name, words) for name, words in _MEANINGS.items()
    )
    ds = estimates(meanings, units, solution, found, every, fit.samples.x, unit)
    for name, one_unit in list(zip(meanings, units, strict=True))[size:]:
        ds[name] = number(float(ds["estimate"].sel(parameter=name)), meanings[name], one_unit)
    ds["model_error"] = number(fit.model_error, _MODEL_ERROR)
    code, meanings = record_verdict(fit, found)
    ds["verdict"] = verdict(code, meanings)
    return ds


def _of_motion(
    fit: RecordFit, values: np.ndarray, found: Errors, unit: str, stiffness: float | None
) -> dict[str, xr.Variable]:
    """Further results of the fitted motion."""
    if fit.mass.elastic:
        share = "elastic_fraction", "share of the cycle in which the contact of the fit does not slip"
    else:
        share = "stuck_fraction", "share of the cycle in which the fit sticks"
    result = {share[0]: number(fit.motion.stuck, share[1])}
    if stiffness is not None:
        newtons = checks.number(stiffness, "stiffness", above=0.0) * conversion(unit, "m")
        if fit.mass.elastic:
            result |= spring_in_newtons(values, found, LAW, float(stiffness))
        error = newtons * float(found.standard_error[X_F])
        words = "kinetic friction force k x_F"
        result["friction_force"] = number(newtons * float(fit.values[X_F]), words, "N")
        result["friction_force_standard_error"] = number(error, f"standard error of the {words}", "N")
    return result


def _of_fit(fit: RecordFit, found: Errors) -> list[str]:
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
    elif fit.static == ONE:
        words.append(
            "mu = 1 explains the data as well as a larger mu does: the other estimates are those for mu = 1, "
            "and their intervals allow for the whole interval of mu"
        )
    if not fit.mass.elastic:
        words += interval_warnings("mu", 1.0, not fit.free[MU] or bool(found.lower[MU] > 1.0))
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

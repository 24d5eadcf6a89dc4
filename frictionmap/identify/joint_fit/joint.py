"""Natural frequency, damping, mu and several friction forces from several decays and records at once."""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
import xarray as xr

from ... import checks
from ...datasets.provenance import system_text
from ...errors import InputError, naming
from ...model.system import DAMPING_REFERENCES
from ...units.table import checked_unit
from ..decay.part import decay_part
from ..parameters import ALIKE, checked_known, unit_of
from ..part import SHARED, Part, Settings
from ..statistics.estimates import estimates, friction_force, number, usable_errors, verdict
from ..statistics.least_squares import Errors, Solution, errors, growth
from ..statistics.robust import LOSSES
from ..time_series.labels import one_mass
from ..time_series.motion import CONTACTS
from ..time_series.part import record_part
from ..time_series.static_friction import FITTED, IDLE, mu_interval, mu_warnings, per_square
from ..time_series.verdict import friction_found, limit_of_correlation, listed
from .fit import F_N, MU, ZETA, JointFit, fit_jointly, places_of

_MEANINGS = {
    "f_n": "natural frequency without friction and damping, of all data",
    "zeta": "viscous damping ratio, of all data",
    "mu": "static over kinetic friction force, of all records",
    "x_F": "kinetic friction force over stiffness",
    "offset_x": "place of the unloaded mass where the base is at its zero, the mean over the record",
    "X0": "amplitude of the first turning point, from the centre",
    "t0": "time of the first turning point",
    "centre": "place of the unloaded mass",
}

#: Parts by the number of their arrays.
PARTS = {2: decay_part, 3: record_part}

#: What may be held; x_F is then that of all data.
KNOWN = ("f_n", "zeta", "mu", "x_F")

_REMEDY = "add a free decay, hold f_n and zeta, or hold mu = 1"


def joint(
    data: Sequence[Sequence[object]],
    *,
    labels: Sequence[object] | None = None,
    unit: str = "mm",
    contact: str = "fixed-wall",
    damping_reference: str = "ground",
    known: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    loss: str = "linear",
) -> xr.Dataset:
    """Fit free decays and records of one mass at once, with one f_n, zeta and mu, and a friction for each.

    What one record leaves undetermined, because damping, static and kinetic friction have nearly the same
    effect on it, a free decay or records with other friction determine.

    Parameters
    ----------
    data : sequence of (time, x) or (time, base, x)
        A free decay has two arrays, a record of steady motion three: times [s], and displacements in `unit`;
        see `free_decay` and `record`.
    labels : sequence
        Names of the data in the results; default: 1, 2, ...
    unit : "mm", "m" or "um"
        Of all displacements, and of every length that is given or returned.
    contact : "fixed-wall" or "joined-base-wall"
        What the mass rubs on in the records; see `record`.
    damping_reference : "ground" or "base"
        What the damper acts on in the records; see `record`.
    known : mapping
        Parameters to be held: f_n [Hz] > 0, zeta >= 0, mu >= 1, x_F >= 0 (of all data).  Others are fitted.
    stiffness : float
        k [N/m] > 0; gives the friction forces F = k x_F [N].
    loss : "linear" or "soft_l1"
        What residuals cost: their squares, or less beyond the level of the noise, for outliers.

    Returns
    -------
    xarray.Dataset
        On parameter: f_n, zeta, mu, then x_F_<label> of each, and offset_x_<label> of a record, or
        X0_<label>, t0_<label> and centre_<label> of a decay; variables as of `record`.  On sample: data,
        model, residual,
        `set` (the label), `time_of_sample`.  Of each record also beta_<label>, stops_per_cycle_<label>,
        base_frequency_<label> and residual_rms_<label>.  Attribute `warnings`.

    Raises
    ------
    InputError
        An argument is invalid, there are fewer than two data, or one of them cannot be used; its label is
        named.

    Notes
    -----
    Each part counts by its noise.  A record that the model does not explain down to its noise counts by its
    residual at the harmonics of the base, so that the decay prevails.  mu is 1 unless the records ask for
    more.

    Examples
    --------
    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> n = np.floor(2 * t)
    >>> rng = np.random.default_rng(1)
    >>> def decay(x_F):
    ...     x = (9.5 - (2 * n + 1) * x_F) * np.cos(2 * np.pi * t) + (-1) ** n * x_F
    ...     return t, x + rng.normal(0.0, 0.02, t.size)
    ...
    >>> fit = fm.identify.joint([decay(0.3), decay(0.5)], labels=["dry", "loaded"])
    >>> fit.estimate.sel(parameter=["f_n", "x_F_dry", "x_F_loaded"]).values.round(2)
    array([1. , 0.3, 0.5])
    """
    checked_unit(unit, "length", "unit")
    checks.choice(contact, "contact", CONTACTS)
    checks.choice(damping_reference, "damping_reference", DAMPING_REFERENCES)
    checks.choice(loss, "loss", LOSSES)
    held = checked_known(known or {}, KNOWN)
    names = _checked_labels(data, labels)
    settings = Settings(unit, contact, damping_reference, held, loss)
    parts = [_part(label, arrays, settings) for label, arrays in zip(names, data, strict=True)]
    fit = fit_jointly(parts, held)
    found = _errors(fit)
    ds = _dataset(fit, found, unit).assign(_part_variables(fit, found, unit, stiffness))
    about_data = [f"{part.label}: {one}" for part in fit.parts for one in part.data_warnings(unit)]
    ds.attrs["title"] = "Several measurements"
    ds.attrs["config"] = system_text(one_mass(contact, damping_reference))
    ds.attrs["warnings"] = "; ".join(about_data + _fit_warnings(fit, found))
    return ds


def _checked_labels(data: object, labels: Sequence[object] | None) -> list[str]:
    if not isinstance(data, Sequence) or isinstance(data, str) or len(data) < 2:
        raise InputError(
            "data must be two or more measurements, each (time, x) of a decay or (time, base, x) of a "
            f"record; got {checks.one_line(data)}"
        )
    names = [str(label) for label in (range(1, len(data) + 1) if labels is None else labels)]
    if len(names) != len(data) or len(set(names)) < len(names) or not all(names):
        raise InputError(
            f"labels must be {len(data)} different names, one for each of data; got {checks.one_line(labels)}"
        )
    return names


def _part(label: str, arrays: object, settings: Settings) -> Part:
    if not isinstance(arrays, Sequence) or isinstance(arrays, str) or len(arrays) not in PARTS:
        raise InputError(
            f"data {label} must be (time, x) of a decay or (time, base, x) of a record; "
            f"got {checks.one_line(arrays)}"
        )
    with naming(f"data {label}"):
        return PARTS[len(arrays)](label, arrays, settings)


def _names(fit: JointFit) -> list[str]:
    """Names of all values; empty for drift and wander, and for channels that are alike."""
    names = [*SHARED, *[""] * (fit.solution.values.size - len(SHARED))]
    for part, at in zip(fit.parts, places_of(fit.parts), strict=True):
        for name, place in zip(part.names, at, strict=False):
            if name not in (*SHARED, *ALIKE):
                names[place] = f"{name}_{part.label}"
    return names


def _order(fit: JointFit) -> list[int]:
    """Places of the parameters that are shown: shared ones, frictions, the rest."""
    names = _names(fit)
    shown = [k for k in range(len(SHARED), len(names)) if names[k]]
    frictions = [k for k in shown if names[k].startswith("x_F_")]
    return [*range(len(SHARED)), *frictions, *(k for k in shown if k not in frictions)]


def _errors(fit: JointFit) -> Errors:
    """Errors of all values, mu in place of (mu - 1)^2."""
    on_bound = fit.solution.at_bound & fit.problem.free
    found = errors(fit.problem, fit.solution._replace(at_bound=on_bound), noise=fit.noise)
    lower, upper, error = found.lower.copy(), found.upper.copy(), found.standard_error.copy()
    of_square = float(error[MU])
    lower[MU], upper[MU], moved = mu_interval(fit.static, fit.with_mu, fit.solution, fit.noise, MU, of_square)
    lower, upper = lower + np.minimum(moved, 0.0), upper + np.maximum(moved, 0.0)
    if fit.static == FITTED:
        error[MU] = of_square * per_square(1.0 + float(np.sqrt(fit.solution.values[MU])), of_square)
    lower = np.where(fit.with_mu.free, np.maximum(lower, fit.with_mu.floor), lower)
    grown = float(growth(fit.problem, fit.solution, fit.noise).max())
    return found._replace(standard_error=error, lower=lower, upper=upper, inflation=grown)


def _dataset(fit: JointFit, found: Errors, unit: str) -> xr.Dataset:
    order, names = _order(fit), _names(fit)
    shown = [names[k] for k in order]
    kinds = [
        next(kind for kind in _MEANINGS if name == kind or name.startswith(f"{kind}_")) for name in shown
    ]
    meanings = {
        name: _MEANINGS[kind] if name == kind else f"{_MEANINGS[kind]}, {name.removeprefix(kind + '_')}"
        for name, kind in zip(shown, kinds, strict=True)
    }
    values = fit.solution.values.copy()
    values[MU] = 1.0 + np.sqrt(max(values[MU], 0.0))
    data = np.concatenate([part.data for part in fit.parts])
    residual = np.concatenate([part.residual(values) for part, values in fit.each()])
    error = usable_errors(found, MU, 1.0, bool(fit.with_mu.free[MU]))
    chosen = found._replace(
        standard_error=error[order], lower=found.lower[order], upper=found.upper[order],
        correlation=found.correlation[np.ix_(order, order)],
    )  # fmt: skip
    solution = Solution(values[order], residual, np.zeros((0, 0)), fit.solution.at_bound[order])
    sigma = np.concatenate([np.full(part.data.size, part.sigma) for part in fit.parts])
    ds = estimates(
        meanings, [unit_of(kind, unit) for kind in kinds], solution, chosen, fit.with_mu.free[order], data,
        unit, sigma,
    )  # fmt: skip
    ds["sigma"].attrs["long_name"] = "standard deviation of the noise by which a sample counts"
    sets = np.concatenate([np.full(part.data.size, part.label) for part in fit.parts])
    times = np.concatenate([part.time for part in fit.parts])
    ds["set"] = xr.Variable("sample", sets, {"long_name": "measurement, of one friction force"})
    ds["time_of_sample"] = xr.Variable("sample", times, {"long_name": "time", "units": "s"})
    ds["model_error"] = number(
        fit.model_error, "residuals at the harmonics of a base, over the noise beside them"
    )
    ds["verdict"] = verdict(*_verdict(fit, found, names))
    return ds


def _part_variables(
    fit: JointFit, found: Errors, unit: str, stiffness: float | None
) -> dict[str, xr.Variable]:
    """Further results of each part."""
    result: dict[str, xr.Variable] = {}
    for (part, values), at in zip(fit.each(), places_of(fit.parts), strict=True):
        label, place = part.label, part.names.index("x_F")
        rms = float(np.sqrt(np.mean(part.residual(values) ** 2)))
        result[f"residual_rms_{label}"] = number(rms, f"root mean square of residuals, {label}", unit)
        if stiffness is not None:
            error = float(found.standard_error[at[place]])
            result |= friction_force(float(values[place]), error, stiffness, unit, label)
        result |= {f"{name}_{label}": one for name, one in part.variables(values).items()}
    return result


def _verdict(fit: JointFit, found: Errors, names: list[str]) -> tuple[int, dict[str, str]]:
    """A code and the meanings of all codes."""
    frictions = [k for k, name in enumerate(names) if name.startswith("x_F_")]
    seen = [names[k] for k in frictions if friction_found(fit.solution.values[k], found.standard_error[k])]
    together = _inseparable(fit, found, names)
    meanings = {
        "no_friction_found": "no friction found in any of the data",
        "friction_found": "friction found in all of the data",
        "friction_found_in_some": f"friction found in some of the data: {listed(seen)}",
        "not_identified": f"not identifiable: {listed(together)} cannot be determined together from these "
        f"data, and their estimates must not be used: {_REMEDY}",
    }
    if together:
        return 3, meanings
    return (0 if not seen else 1 if len(seen) == len(frictions) else 2), meanings


def _inseparable(fit: JointFit, found: Errors, names: list[str]) -> list[str]:
    """Shared parameters and frictions of records that are not identifiable separately."""
    frictions = [
        names.index(f"x_F_{part.label}") for part, values in fit.each() if part.stops(values) is not None
    ]
    vague = [
        k
        for k in frictions
        if limit_of_correlation(fit.model_error, fit.solution.values[k], found.lower[k], found.upper[k]) < 1.0
    ]
    if not vague:
        return []
    limit = limit_of_correlation(
        fit.model_error, *(float(one[vague[0]]) for one in (fit.solution.values, found.lower, found.upper))
    )
    pairs = [
        pair for pair in combinations((F_N, ZETA, MU, *vague), 2) if abs(found.correlation[pair]) > limit
    ]
    return [names[k] for k in (F_N, ZETA, MU, *vague) if any(k in pair for pair in pairs)]


def _fit_warnings(fit: JointFit, found: Errors) -> list[str]:
    """Warnings about the estimates."""
    words = [
        f"{part.label}: the model does not explain the record down to its noise: at the harmonics of the "
        f"base residuals are {part.model_error:.3g} times the noise, and the record is weighted accordingly"
        for part in fit.parts
        if part.model_error > 1.0
    ]
    if fit.static == IDLE:
        words.append("mu cannot be determined, as no record sticks: it is held at 1")
    words += mu_warnings(fit.static, not fit.with_mu.free[MU] or bool(found.lower[MU] > 1.0))
    names = _names(fit)
    bound = [names[k] for k in np.flatnonzero(fit.solution.at_bound) if names[k]]
    return words + ([f"{listed(bound)} at the bound: the interval is one-sided"] if bound else [])

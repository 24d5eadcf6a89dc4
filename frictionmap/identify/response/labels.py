"""The dataset of a fit of forced responses."""

import numpy as np
import xarray as xr

from ... import regimes
from ...units.table import checked_unit, conversion
from ..parameters import CONTACT_STIFFNESS
from ..spring import spring_in_newtons
from ..statistics.estimates import QUANTITIES, estimates, flags, usable_errors, with_error
from ..statistics.least_squares import Errors
from .data import ForcedTable
from .fit import TableFit, parameter_names, shown_estimates
from .model import F_N, GAIN, LAW, points_of

#: From where the motion is reached: both starts, or one.
_REACHED = ("from_anywhere", "from_rest_only", "moving_only")

#: Two motions whose first harmonics differ by less of their size are one.
_SAME = 1e-9

#: Units of parameters that have one.
UNITS = {"f_n": "Hz", "delay": "s"}

_WORDS = {
    "beta": "kinetic friction force over the load's amplitude, the mean of the set",
    "f_n": "natural frequency of the first mass on its spring alone, where r = 1",
    "zeta": "viscous damping ratio of every mode; of the first one where the system's own are held",
    "mu": "static over kinetic friction force",
    CONTACT_STIFFNESS: "stiffness of the spring in the contact over k1; on its bound: rigid",
    "delay": "time by which the masses are measured later than the load, because the channels differ",
    "gain": "gain of the masses over that of the load; friction is in units of the load",
}


def labelled(
    table: ForcedTable, fit: TableFit, found: Errors, unit: str | None, hidden: list[str]
) -> xr.Dataset:
    """Dataset of a fit without its verdict.

    found : errors as they are reported, see `shown_estimates`
    unit : of the loads, if they were given
    hidden : parameters that are not shown
    """
    samples = fit.model.samples
    values, _ = shown_estimates(fit)
    solution = fit.solution._replace(values=values)
    names = parameter_names(table, fit.model.elastic)
    meanings = {name: _WORDS.get(name) or f"{_WORDS['beta']} {name[5:]}" for name in names}
    units = tuple(UNITS.get(name, "1") for name in names)
    shown = found
    if not fit.model.elastic:
        errors = usable_errors(found, LAW, 1.0, bool(fit.problem.free[LAW]))
        shown = found._replace(standard_error=errors)
    ds = estimates(meanings, units, solution, shown, fit.problem.free, np.zeros(samples.row.size), "1")
    ds = ds.assign(_sample_variables(table, fit))
    if unit is not None:
        ds = ds.assign(_friction(table, fit, found, unit))
    sources = [
        f"{what} {'as given' if given else 'from the residuals'}"
        for what, given in zip(("of lags", "of amplitudes"), table.given, strict=True)
    ]
    ds.attrs["errors"] = ", ".join(sources)
    return ds.drop_sel(parameter=hidden, parameter2=hidden)


def _sample_variables(table: ForcedTable, fit: TableFit) -> dict[str, xr.Variable]:
    """Variables on the samples: data and model as measured, residuals in degrees or relative."""
    samples, rows = fit.model.samples, table.rows
    phase = samples.is_phase
    residual = fit.here.residual * samples.sigma
    r, beta = points_of(rows, fit.solution.values)

    def put(values: np.ndarray, words: str, **attributes: object) -> xr.Variable:
        return xr.Variable("sample", values, {"long_name": words, **attributes})

    def as_measured(values: np.ndarray) -> np.ndarray:
        return np.where(phase, np.degrees(values), np.exp(np.where(phase, 0.0, values)))

    in_units = {"comment": "degrees of lags, ratios of amplitudes; see quantity"}
    relative = {"comment": "degrees of lags, natural logarithms of ratios of amplitudes; see quantity"}
    sets = np.array(table.labels)[rows.member]
    regime = {
        "flag_values": np.array([code.value for code in regimes.REGIMES], dtype=np.int8),
        "flag_meanings": " ".join(code.name for code in regimes.REGIMES),
    }
    return {
        "data": put(as_measured(samples.value), "measured", **in_units),
        "model": put(as_measured(samples.value + residual), "fitted", **in_units),
        "residual": put(np.where(phase, np.degrees(residual), residual), "fitted less measured", **relative),
        "sigma": put(np.where(phase, np.degrees(samples.sigma), samples.sigma), "standard error", **relative),
        "quantity": put(phase.astype(np.int8), "what was measured", **flags(QUANTITIES)),
        "mass": put((samples.mass + 1).astype(np.int16), "mass, counted from 1", units="1"),
        "set": put(sets[samples.row], "test, of one friction force"),
        "frequency": put(rows.frequency[samples.row], "frequency of the load or base", units="Hz"),
        "frequency_ratio": put(r[samples.row], "frequency over f_n", units="1"),
        "friction_ratio": put(beta[samples.row], "friction force over the load of this row", units="1"),
        "regime": put(fit.here.regime[samples.row], "regime of the motion fitted", **regime),
        "reached": put(_reached(fit)[samples.row], "starts from which it is reached", **flags(_REACHED)),
    }


def _reached(fit: TableFit) -> np.ndarray:
    """Codes of `_REACHED`, row by row."""
    codes = np.zeros(fit.here.phasors.shape[0], dtype=np.int8)
    if len(fit.here.states) == 1:  # mu = 1
        return codes
    rest, moving = (_is_one(fit.here.phasors, states.phasors) for states in fit.here.states[1:])
    codes[rest & ~moving], codes[moving & ~rest] = 1, 2
    return codes


def _is_one(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return (np.abs(other - one) <= _SAME * np.abs(one)).all(axis=1)


def friction_forces(
    table: ForcedTable, fit: TableFit, found: Errors, unit: str, stiffness: float
) -> dict[str, xr.Variable]:
    """Friction force k1 x_F [N] of every set on a shaken base, with its error; `stiffness` k1 [N/m].

    Under a force it is already given in the unit of the force: nothing is added.
    """
    if fit.model.system.excitation != "base":
        return {}
    newtons = stiffness * conversion(checked_unit(unit, "length", "unit"), "m")
    words = "kinetic friction force k1 x_F"
    return _per_set(table, fit, found, ("friction_force", words), newtons, "N")


def spring_stiffness(fit: TableFit, found: Errors, stiffness: float) -> dict[str, xr.Variable]:
    """Stiffness of the spring in the contact [N/m], with its error; `stiffness` k1 [N/m]."""
    if not fit.model.elastic:
        return {}
    return spring_in_newtons(shown_estimates(fit)[0], found, LAW, stiffness)


def _friction(table: ForcedTable, fit: TableFit, found: Errors, unit: str) -> dict[str, xr.Variable]:
    """Friction of every set in the unit of its loads: of a base a length, F/k1; of a force a force."""
    base = fit.model.system.excitation == "base"
    what, words = ("x_F", "F/k1") if base else ("friction_force", "F")
    return _per_set(table, fit, found, (what, f"kinetic friction, {words}"), 1.0, unit)


def _per_set(
    table: ForcedTable, fit: TableFit, found: Errors, named: tuple[str, str], scale: float, unit: str
) -> dict[str, xr.Variable]:
    """beta of every set as friction, times its load and `scale`, with the standard error.

    named : the friction, and in words

    There is no standard error where the gain is fitted: the load or the masses may have the wrong one.
    """
    result: dict[str, xr.Variable] = {}
    known = not fit.problem.free[GAIN]
    for k, name in enumerate(parameter_names(table, fit.model.elastic)[:F_N]):
        own, size = name.replace("beta", named[0]), table.load[k] * scale
        error = found.standard_error[k] * size if known else np.nan
        value, words = fit.solution.values[k] * size, f"standard error of {own}"
        result |= with_error(own, value, error, named[1], unit, words)
    return result

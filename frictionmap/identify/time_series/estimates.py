"""Estimates of the model that is reported, and how far those of other models are from them."""

from typing import NamedTuple

import numpy as np

from ..explanations import Cause, Outcome, allowing_for
from ..parameters import CHANNELS, unit_of
from ..spring import with_stiffness
from ..statistics.least_squares import Errors
from .alternatives import Tried
from .data import MeasuredRecord, whole_record
from .errors import DERIVED, derived_values, record_errors
from .motion import F_N, LAW, PARAMETERS, X_F, ZETA


class Estimates(NamedTuple):
    """Estimates of the parameters and of `DERIVED`, with the stiffness of a spring for its compliance."""

    given: MeasuredRecord  # whole, where it was clipped
    values: np.ndarray
    errors: Errors


def units(unit: str) -> tuple[str, ...]:
    """Units of the parameters and of `DERIVED`; `unit` is that of lengths."""
    return (*(unit_of(name, unit) for name in PARAMETERS), "1", "deg", "1", "1")


def tolerances(one: Tried, found: Errors) -> dict[str, tuple[float, bool]]:
    """Delay [s] and gain that move an estimate by half its interval, and whether the residuals show as much.

    Channels that agree to that leave the intervals nearly as they are.
    """
    k = np.array([F_N, ZETA, X_F])
    reach = 0.5 * (found.upper[k] - found.lower[k])
    result = {}
    for step in one.steps:
        moved = np.abs(step.moved[k])
        if step.name in CHANNELS and moved.any():
            most = float(np.min(reach[moved > 0.0] / moved[moved > 0.0]))
            result[step.name] = most, most >= step.shown
    return result


def model_estimates(one: Tried) -> Estimates:
    """Estimates of a model, and their errors."""
    fit, given = one.fit, whole_record(one.given, one.fit)
    found = record_errors(fit, given.phasors, given.time, given.good)
    values = np.concatenate((fit.values, derived_values(fit, given.phasors)))
    if fit.mass.elastic:
        values, found = with_stiffness(values, found, LAW, bool(fit.free[LAW]))
    return Estimates(given, values, found)


def with_others(outcome: Outcome[Tried], own: Estimates, unit: str) -> tuple[Errors, list[Cause]]:
    """Errors that allow for the other models; what explains the record.

    own : of the model that is reported
    """
    chosen = outcome.chosen
    if chosen.name:
        return own.errors, [_cause(chosen, own, unit)]
    tried = [(one, model_estimates(one)) for one in outcome.others]
    derived = np.ones(len(DERIVED), dtype=bool)
    errors = [(found.errors, np.append(_same(chosen, one), derived)) for one, found in tried]
    causes = [_cause(one, found, unit) for one, found in tried if one.explains]
    return allowing_for(own.errors, errors, np.append(chosen.fit.free, derived)), causes


def _same(one: Tried, other: Tried) -> np.ndarray:
    """Which parameters two models have in common; mu and the spring of a contact have one place."""
    same = np.ones(len(PARAMETERS), dtype=bool)
    same[LAW] = one.fit.mass.elastic == other.fit.mass.elastic
    return same


def _cause(one: Tried, own: Estimates, unit: str) -> Cause:
    """The parameter that a model has in addition."""
    k = one.fit.mass.names.index(one.name)
    value, lower, upper = (float(part[k]) for part in (own.values, own.errors.lower, own.errors.upper))
    return Cause(one.name, units(unit)[k], value, lower, upper)

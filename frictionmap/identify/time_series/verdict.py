"""Verdict on a record: friction, and whether its estimates are identifiable."""

from itertools import combinations

import numpy as np

from ..statistics.least_squares import Errors
from ..statistics.levels import CORRELATED, FOUND
from .fit import RecordFit
from .motion import F_N, LAW, X_F, ZETA

#: Estimates that correlate by more than `CORRELATED` are not identifiable separately if the interval of the
#: friction is wider than this share of it, to either side.
_VAGUE = 0.1

#: The same correlation where the model itself is wrong by more than the noise: a quarter of the variance of
#: either is the other's, and the model's error goes where it costs least, along both.
_CORRELATED_BY_MODEL = 0.5

#: What a motion depends on in a way of its own; the offset only moves it.
_SHAPING = (F_N, ZETA, X_F, LAW)

_VERDICTS = {
    "no_friction_found": "no friction found",
    "continuous": "friction found, the mass never sticks: mu is known only by its interval",
    "stick_slip": "friction found, and the mass sticks and slips",
}

_VERDICTS_WITH_SPRING = {
    "no_friction_found": "no friction found",
    "spring_not_determined": "friction found, the stiffness of the contact is known only by its interval",
    "spring_found": "friction found, in a contact with a spring",
}

#: What makes estimates identifiable that one record leaves together.
REMEDY = (
    "hold f_n and zeta from a free decay, hold mu = 1, or fit several records together (kind = 'joint', "
    "fm.identify.joint)"
)
_REMEDY_WITH_SPRING = "hold f_n and zeta from a free decay, or hold contact_stiffness"


def record_verdict(fit: RecordFit, found: Errors) -> tuple[int, dict[str, str]]:
    """A code and the meanings of all codes.

    found : with the stiffness of a spring in the place of its compliance
    """
    meanings = dict(_VERDICTS_WITH_SPRING if fit.mass.elastic else _VERDICTS)
    sticks = bool(np.isfinite(found.upper[LAW])) if fit.mass.elastic else fit.motion.stops > 0
    friction = friction_found(float(fit.values[X_F]), float(found.standard_error[X_F]))
    together = inseparable(fit, found)
    meanings["not_identified"] = (
        f"not identifiable: {listed(together)} cannot be determined together from this record, "
        f"and their estimates must not be used: {_REMEDY_WITH_SPRING if fit.mass.elastic else REMEDY}"
    )
    if together and (friction or sticks):
        return list(meanings).index("not_identified"), meanings
    return int(friction) * (1 + int(sticks)), meanings


def friction_found(friction: float, error: float) -> bool:
    """Whether friction is beyond what its standard error explains."""
    return friction > FOUND * error


def inseparable(fit: RecordFit, found: Errors) -> list[str]:
    """Fitted parameters that the record does not identify separately: none, or two and more."""
    limit = limit_of_correlation(
        fit.model_error, float(fit.values[X_F]), float(found.lower[X_F]), float(found.upper[X_F])
    )
    pairs = [pair for pair in combinations(_SHAPING, 2) if abs(float(found.correlation[pair])) > limit]
    names = fit.mass.names
    return [names[index] for index in _SHAPING if any(index in pair for pair in pairs)]


def limit_of_correlation(model_error: float, friction: float, lower: float, upper: float) -> float:
    """Correlation above which estimates are not identifiable; 1 where the friction is well known."""
    if model_error > 1.0:
        return _CORRELATED_BY_MODEL
    return CORRELATED if max(friction - lower, upper - friction) > _VAGUE * friction else 1.0


def listed(names: list[str]) -> str:
    """Names in a sentence."""
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1]))) if names else "estimates"

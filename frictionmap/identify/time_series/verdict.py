"""Verdict on a record: friction, whether the model explains it, and whether estimates are identifiable."""

from itertools import combinations

import numpy as np

from ..explanations import Cause, Outcome, added, doubts
from ..statistics.least_squares import Errors
from ..statistics.levels import CORRELATED, FOUND
from .alternatives import Tried
from .fit import RecordFit
from .motion import DELAY, F_N, GAIN, LAW, X_F, ZETA

#: Estimates that correlate by more than `CORRELATED` are not identifiable separately if the interval of the
#: friction is wider than this share of it, to either side.
_VAGUE = 0.1

#: The same correlation where the model itself is wrong by more than the noise: a quarter of the variance of
#: either is the other's, and the model's error goes where it costs least, along both.
_CORRELATED_BY_MODEL = 0.5

#: What a motion depends on in a way of its own; the offset only moves it.
_SHAPING = (F_N, ZETA, X_F, LAW, DELAY, GAIN)

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


def record_verdict(
    outcome: Outcome[Tried], found: Errors, causes: list[Cause], within: dict[str, tuple[float, bool]]
) -> tuple[int, dict[str, str]]:
    """A code and the meanings of all codes.

    found : with the stiffness of a spring in the place of its compliance
    causes : with which the model explains the record: what was added to it, or what could be
    within : see `tolerances`
    """
    chosen, fit = outcome.chosen, outcome.chosen.fit
    plain = _VERDICTS_WITH_SPRING if fit.mass.elastic else _VERDICTS
    more = _if_alike(within) + added(outcome, causes)
    meanings = {name: words + more for name, words in plain.items()}
    sticks = bool(np.isfinite(found.upper[LAW])) if fit.mass.elastic else fit.motion.stops > 0
    friction = friction_found(float(fit.values[X_F]), float(found.standard_error[X_F]))
    together = inseparable(fit, found)
    meanings["not_identified"] = (
        f"not identifiable: {listed(together)} cannot be determined together from this record, "
        f"and their estimates must not be used: {_REMEDY_WITH_SPRING if fit.mass.elastic else REMEDY}"
    )
    meanings |= doubts(outcome, causes)
    codes = list(meanings)
    if outcome.alike:
        return codes.index("explained_otherwise"), meanings
    if together and (friction or sticks):
        return codes.index("not_identified"), meanings
    if not chosen.explains:
        return codes.index("not_explained"), meanings
    return int(friction) * (1 + int(sticks)), meanings


def _if_alike(within: dict[str, tuple[float, bool]]) -> str:
    """How well the channels must agree, where the record would not show that they do not."""
    words = {"delay": ("in time to {:.2g} ms", 1e3), "gain": ("equal in gain to {:.2g} %", 1e2)}
    needed = [
        words[name][0].format(words[name][1] * most) for name, (most, shown) in within.items() if not shown
    ]
    return f" (if the channels are {' and '.join(needed)})" if needed else ""


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

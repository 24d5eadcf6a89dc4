"""What explains data that a model does not: a spring in the contact, unlike channels, other known values.

A model fails if it leaves more than noise does, in all, or along the change that one parameter more would
make: for a right model the fall of chi square by a step in it is the square of a normal deviate (Rao's score
test), which finds a small delay that chi square loses among the other residuals.  Then the model is fitted
again with each of these parameters.  One that explains the data, and better than the others by what chance
makes in one of a thousand, takes its place.  Else no estimate can be relied on.
"""

from collections.abc import Iterable, Mapping
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from scipy.special import fdtri

from .parameters import CONTACT_STIFFNESS
from .statistics.least_squares import Errors
from .statistics.levels import CHANCE

#: What a model may have in addition, although nobody has asked for it, in words.
ADDED = {
    CONTACT_STIFFNESS: "a spring in the contact",
    "delay": "a delay between the channels",
    "gain": "unequal gains of the channels",
}

#: Compliance of the spring that shows how data change with one: with little compliance motions change like
#: its root, in nearly the same way for all of them.
COMPLIANCE = 0.05

#: Explanations whose chi squares differ by less are alike: the likelihood ratio is one in a thousand.
_APART = 2.0 * float(np.log(1.0 / CHANCE))

#: Slopes are differences, exact to some 1e-7: a column has a direction of its own if that is a larger share.
_OWN = 1e-5


class Step(NamedTuple):
    """What residuals say of a parameter that was held, to first order."""

    name: str
    asked_for: bool  # whether they ask for a step in it, beyond chance
    shown: float  # the least step that they show
    moved: np.ndarray  # shape (parameters,), changes of what is fitted by a step of one


class Model(Protocol):
    """A model that was fitted."""

    @property
    def name(self) -> str:
        """The parameter that it has in addition; empty: as it was asked for."""

    @property
    def square(self) -> float:
        """Chi square, or -2 ln of the likelihood."""

    @property
    def determined(self) -> bool:
        """Whether the data determine all its parameters."""

    @property
    def explains(self) -> bool:
        """Whether it leaves no more than noise."""


Tried = TypeVar("Tried", bound=Model)


class Outcome(NamedTuple, Generic[Tried]):
    """The model that is reported, and what else was tried."""

    chosen: Tried
    alike: list[Tried]  # others that explain the data, equally well
    failed: list[Tried]  # others that do not explain them

    @property
    def others(self) -> list[Tried]:
        """Those that its intervals must allow for."""
        return [one for one in self.alike or self.failed if one.determined]


class Cause(NamedTuple):
    """A parameter with which a model explains the data, and its estimate."""

    name: str
    unit: str
    value: float
    lower: float
    upper: float


def best_of(asked: Tried, others: Iterable[Tried], may_add: bool) -> Outcome[Tried]:
    """The model that was asked for, or the one that explains the data with one parameter more.

    others : fitted only if they are needed
    may_add : whether a parameter may be fitted that nobody asked for
    """
    if asked.explains or not asked.determined:
        return Outcome(asked, [], [])
    tried = list(others)
    explaining = sorted((one for one in tried if one.explains), key=lambda one: one.square)
    alike = [one for one in explaining if one.square - explaining[0].square < _APART]
    if may_add and [one.name in ADDED for one in alike] == [True]:
        return Outcome(alike[0], [], [])
    return Outcome(asked, alike, [one for one in tried if not one.explains])


def steps(
    slopes: np.ndarray, free: np.ndarray, residual: np.ndarray, columns: Mapping[str, np.ndarray],
    variance: float | None, freedom: float,
) -> list[Step]:  # fmt: skip
    """Steps in parameters that were held.

    slopes : shape (samples, parameters), of residuals over their errors
    free : shape (parameters,), bool: which of them are fitted
    columns : slopes of the others
    variance : of a residual, known with `freedom` degrees of freedom; None: from the residuals, which have so
        many
    """
    fitted = np.flatnonzero(free & (np.linalg.norm(slopes, axis=0) > 0.0))
    own = slopes[:, fitted]
    scale = np.linalg.norm(own, axis=0)
    chance = CHANCE / max(len(columns), 1)
    found = []
    for name, column in columns.items():
        along = np.linalg.lstsq(own / scale, column, rcond=None)[0] / scale
        beside = column - own @ along
        length = float(np.linalg.norm(beside))
        if not length > _OWN * float(np.linalg.norm(column)):
            continue
        fall, left = (float(beside @ residual) / length) ** 2, freedom - (variance is None)
        size = (float(residual @ residual) - fall) / left if variance is None else variance
        most = float(fdtri(1.0, left, 1.0 - chance))
        moved = np.zeros(free.size)
        moved[fitted] = -along
        found.append(Step(name, fall > most * size, float(np.sqrt(most * size)) / length, moved))
    return found


def allowing_for(own: Errors, others: Iterable[tuple[Errors, np.ndarray]], fitted: np.ndarray) -> Errors:
    """Errors whose intervals hold those of other models; standard errors have no meaning then.

    others : their errors, and which of the estimates are the same, shape (estimates,)
    fitted : shape (estimates,), bool
    """
    lower, upper, found = own.lower, own.upper, False
    for errors, same in others:
        lower = np.where(same & fitted, np.minimum(lower, errors.lower), lower)
        upper = np.where(same & fitted, np.maximum(upper, errors.upper), upper)
        found = True
    if not found:
        return own
    return own._replace(lower=lower, upper=upper, standard_error=np.where(fitted, np.nan, own.standard_error))


def added(outcome: Outcome[Tried], causes: list[Cause]) -> str:
    """Words about what was added to a model, to be put after others; empty if nothing was."""
    if not outcome.chosen.name:
        return ""
    return f": the model explains the data with {_describe(causes[0])}, but not without it"


def doubts(outcome: Outcome[Tried], causes: list[Cause]) -> dict[str, str]:
    """Verdicts on models that do not explain the data.

    causes : of those that explain them, in their order
    """
    return {"explained_otherwise": _otherwise(causes), "not_explained": _unexplained(outcome)}


def _describe(cause: Cause) -> str:
    """What explains the data, with its interval."""
    unit = "" if cause.unit == "1" else f" {cause.unit}"
    what = ADDED.get(cause.name, f"another {cause.name} than the known one")
    interval = f"{cause.lower:.4g} to {cause.upper:.4g}"
    return f"{what} ({cause.name} {cause.value:.4g}{unit}, 95 % interval {interval})"


def _otherwise(causes: list[Cause]) -> str:
    """Words about a model that explains the data with another parameter only."""
    several = ", which the data do not distinguish" if len(causes) > 1 else ""
    with_them = " or ".join(_describe(cause) for cause in causes)
    new = [cause.name for cause in causes if cause.name in ADDED]
    held = [cause.name for cause in causes if cause.name not in ADDED]
    remedies = [f"hold {name} in known or list it in free" for name in new]
    remedies += [f"correct {name} in known or leave it out" for name in held]
    return (
        f"the model explains the data only with {with_them}{several}. The estimates must not be used. Find "
        f"out what is true, and {', or '.join(remedies)}."
    )


def _unexplained(outcome: Outcome[Tried]) -> str:
    """Words about a model that does not explain the data, whatever is added to it."""
    tried = [ADDED[one.name] for one in outcome.failed if one.name in ADDED]
    tried += [f"another {one.name}" for one in outcome.failed if one.name not in ADDED]
    even = f", not even with {' or '.join(tried)}" if tried else ""
    return (
        f"the model does not explain the data{even}. The estimates must not be used. Check the channels, the "
        "contact and what the damper acts on."
    )

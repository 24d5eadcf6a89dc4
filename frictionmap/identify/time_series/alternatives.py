"""Whether a model explains a record, and what else does.

A steady motion repeats: what a model does not explain is left at the harmonics of the base, and the noise is
known from beside them.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ..explanations import COMPLIANCE, Outcome, Step, best_of, steps
from ..parameters import CONTACT_STIFFNESS
from ..signals.noise import AtHarmonics, at_harmonics, is_wrong
from ..signals.phasors import Phasors
from ..statistics.least_squares import undetermined
from .data import MeasuredRecord, fit_clipped
from .fit import RecordFit
from .motion import LAW, OFFSET, PARAMETERS, motion, places_and_slopes

#: Steady states are exact to some 1e-12 of the motion: noise below this share of it cannot judge a model.
_EXACT = 1e-9


class Task(NamedTuple):
    """A model of a record, to be fitted."""

    contact: str
    damping_reference: str
    known: Mapping[str, float]  # parameters that are held
    elastic: bool
    thorough: bool = True  # see `fit_record`

    def fitted(self, given: MeasuredRecord) -> tuple[MeasuredRecord, RecordFit]:
        """The record as it was used, and the fit."""
        return fit_clipped(
            self.contact, self.damping_reference, given, self.known, self.elastic, self.thorough
        )


#: Change of the residuals, over that in other directions, that is no rounding error: the place at which a
#: contact that never slips comes to rest is found by following it, with some 1e-8.
SEEN = 1e-6


class Tried(NamedTuple):
    """A model that was fitted, see `identify.explanations`."""

    name: str
    given: MeasuredRecord
    fit: RecordFit
    noise: float  # standard deviation of a sample beside the harmonics
    square: float  # chi square at the harmonics
    determined: bool
    explains: bool
    steps: list[Step]


def explained(task: Task, given: MeasuredRecord, sure: Collection[str], may_add: bool) -> Outcome[Tried]:
    """Fit a model; if it does not explain the record, look for one that does.

    sure : parameters whose values are not doubted
    may_add : whether a parameter may be fitted that nobody asked for
    """
    others = (_tried(name, more, given) for name, more in _with_one_more(task, sure))
    return best_of(_tried("", task, given), others, may_add)


def _with_one_more(task: Task, sure: Collection[str]) -> Iterator[tuple[str, Task]]:
    """Models with one parameter more: one that was held, or a spring."""
    for name in task.known:
        if name not in sure:
            known = {key: value for key, value in task.known.items() if key != name}
            yield name, task._replace(known=known, thorough=False)
    if not task.elastic and task.known.get("mu", 1.0) == 1.0:
        known = {key: value for key, value in task.known.items() if key != "mu"}
        yield CONTACT_STIFFNESS, task._replace(known=known, elastic=True, thorough=False)


def _tried(name: str, task: Task, given: MeasuredRecord) -> Tried:
    used, fit = task.fitted(given)
    lines = _lines(used.phasors, fit)
    square, noise = lines.square(fit.solution.residual), float(np.sqrt(lines.variance))
    determined = not undetermined(fit.problem, fit.solution, SEEN)[0].size
    found, explains = [], determined
    if determined and noise > _EXACT * float(np.std(used.channels[:, 1])):
        found = _steps(fit, lines)
        explains = not (_is_wrong(fit, lines, square) or any(one.asked_for for one in found))
    if name == CONTACT_STIFFNESS and fit.solution.at_bound[LAW]:
        explains = False  # this is a rigid contact
    return Tried(name, used, fit, noise, square, determined, explains, found)


def _lines(phasors: Phasors, fit: RecordFit) -> AtHarmonics:
    """The harmonics, and the noise beside them."""
    harmonics, waves = phasors.values.shape[1] - 1, fit.samples.slow.shape[1] - 1
    return at_harmonics(fit.samples.time, fit.solution.residual, phasors.frequency, harmonics, waves)


def _is_wrong(fit: RecordFit, lines: AtHarmonics, square: float) -> bool:
    """Whether the fit leaves more than noise at the harmonics, in all."""
    free = fit.problem.free & ~fit.solution.at_bound
    return is_wrong(square, lines.columns.shape[1] - 1 - int(free[:OFFSET].sum()))


def _steps(fit: RecordFit, lines: AtHarmonics) -> list[Step]:
    """Steps in the parameters that are held, and in the compliance of a rigid contact."""
    free = fit.problem.free & ~fit.solution.at_bound
    columns = {name: lines.over_noise(fit.whitening(column)) for name, column in _columns(fit).items()}
    slopes, residual = lines.over_noise(fit.solution.slopes), lines.over_noise(fit.solution.residual)
    return steps(slopes, free, residual, columns, 1.0, lines.levels.freedom or fit.samples.time.size)


def _columns(fit: RecordFit) -> dict[str, np.ndarray]:
    """Changes of the samples with parameters that are held, and with a spring in a rigid contact."""
    held = ~fit.problem.free[: len(PARAMETERS)]
    held[[LAW, OFFSET]] = False  # mu has a test of its own, and the offset moves the constant alone
    slopes = places_and_slopes(fit.mass, fit.solution.values[: held.size], held)[1]
    columns = {PARAMETERS[k]: slopes[:, k] for k in np.flatnonzero(held)}
    if not fit.mass.elastic:
        mass, values = fit.mass._replace(elastic=True), fit.values
        stiff, soft = (np.where(np.arange(values.size) == LAW, law, values) for law in (0.0, COMPLIANCE))
        columns[CONTACT_STIFFNESS] = motion(mass, soft).places - motion(mass, stiff).places
    return columns

"""Whether a model explains a table of forced responses, and what else does.

Where all errors are given, chi square says so; else only the effect of one parameter more can.
"""

from collections.abc import Collection, Iterator
from typing import NamedTuple

import numpy as np
from scipy.special import gammaincc

from ...errors import InputError
from ...model.system import System
from ...steady.points import steady_states
from ..explanations import COMPLIANCE, Cause, Outcome, Step, allowing_for, best_of, steps
from ..parameters import CONTACT_STIFFNESS
from ..statistics.least_squares import Errors
from ..statistics.levels import CHANCE
from ..statistics.robust import effective_variance
from .data import ForcedTable
from .fit import (
    OUTLIER,
    Nearest,
    TableFit,
    nearest_states,
    parameter_names,
    problem,
    shown_estimates,
    with_errors,
)
from .labels import UNITS
from .model import DELAY, F_N, GAIN, LAW, PLACES, ZETA, corrected, nearest, points_of

#: Lags [rad] and logarithms of amplitudes of data without errors are exact to this: no fit is judged by less.
_EXACT = 1e-6


class Task(NamedTuple):
    """A model of a table, to be fitted."""

    table: ForcedTable
    system: System
    known: np.ndarray  # (parameters,) values that are held; NaN of the others
    elastic: bool
    robust: bool

    def near(self, thorough: bool) -> Nearest:
        """The states nearest to the table."""
        return nearest_states(self.table, self.system, self.known, self.elastic, self.robust, thorough)


class Tried(NamedTuple):
    """A model that was fitted, see `identify.explanations`."""

    name: str
    near: Nearest
    errors: TableFit | None  # of what was asked for, and of what explains the table
    square: float
    determined: bool  # what the data do not determine, the fit refuses
    explains: bool

    @property
    def fit(self) -> TableFit:
        """The fit with its errors."""
        assert self.errors is not None
        return self.errors


def explained(task: Task, doubtful: Collection[str], may_add: bool) -> Outcome[Tried]:
    """Fit a model; if it does not explain the table, look for one that does.

    doubtful : parameters that are held and may be wrong
    may_add : whether a parameter may be fitted that nobody asked for
    """
    return best_of(_judged("", task), _others(task, doubtful), may_add)


def is_beyond_chance(table: ForcedTable, sum_of_squares: float, freedom: int) -> bool:
    """Whether residuals are larger than errors that are all given."""
    return all(table.given) and bool(gammaincc(0.5 * freedom, 0.5 * sum_of_squares) < CHANCE)


def with_others(outcome: Outcome[Tried], table: ForcedTable) -> tuple[Errors, list[Cause]]:
    """Errors, as they are reported, that allow for the other models; what explains the table."""
    chosen = outcome.chosen
    own = _errors(chosen)
    if chosen.name:
        return own, [_cause(chosen, table)]
    errors = []
    for one in outcome.alike:
        same = np.ones(own.lower.size, dtype=bool)
        same[LAW] = one.fit.model.elastic == chosen.fit.model.elastic
        errors.append((_errors(one), same))
    causes = [_cause(one, table) for one in outcome.alike]
    return allowing_for(own, errors, chosen.fit.problem.free), causes


def _errors(one: Tried) -> Errors:
    """Errors as they are reported; larger by what residuals are larger than given errors, if they are."""
    values, found = shown_estimates(one.fit)
    if one.explains or found.variance <= 1.0:
        return found
    grown = np.sqrt(found.variance)
    return found._replace(
        standard_error=grown * found.standard_error,
        lower=values - grown * (values - found.lower),
        upper=values + grown * (found.upper - values),
    )


def _cause(one: Tried, table: ForcedTable) -> Cause:
    """The parameter that a model has in addition."""
    values, found = shown_estimates(one.fit)
    k = parameter_names(table, one.fit.model.elastic).index(one.name)
    return Cause(
        one.name, UNITS.get(one.name, "1"), float(values[k]), float(found.lower[k]), float(found.upper[k])
    )


def _others(task: Task, doubtful: Collection[str]) -> Iterator[Tried]:
    """Fits with one parameter more: one that was held, or a spring."""
    phases, samples = task.table.samples.is_phase, task.table.samples.row.size
    seen = {"delay": phases.any(), "gain": not phases.all()}
    tasks = []
    for name in doubtful:
        if seen.get(name, name in PLACES):
            known = task.known.copy()
            known[PLACES[name]] = np.nan
            tasks.append((name, task._replace(known=known)))
    if not task.elastic and not task.known[LAW] > 1.0:
        known = task.known.copy()
        known[LAW] = np.nan
        tasks.append((CONTACT_STIFFNESS, task._replace(known=known, elastic=True)))
    for name, more in tasks:
        if np.isnan(more.known).sum() < samples:
            try:
                yield _judged(name, more)
            except InputError:  # the table does not determine it
                continue


def _judged(name: str, task: Task) -> Tried:
    """A fit, and whether it leaves no more than errors do; outliers make chi square larger than they are."""
    near = task.near(thorough=not name)
    sigma, squares = near.model.samples.sigma, near.solution.sum
    freedom = sigma.size - int(near.problem.free.sum())
    wrong = not task.robust and is_beyond_chance(task.table, squares, freedom)
    rigid = name == CONTACT_STIFFNESS and near.rigid
    exact = float(sigma.max()) < _EXACT
    explains = not wrong and not rigid and (exact or not any(one.asked_for for one in _steps(task, near)))
    fit = with_errors(task.table, near, task.robust) if explains or not name else None
    return Tried(name, near, fit, squares + 2.0 * float(np.sum(np.log(sigma))), True, explains)


def _steps(task: Task, fit: Nearest) -> list[Step]:
    """Steps in f_n, zeta, delay and gain if they are held, and in the compliance of a rigid contact."""
    values, free = fit.solution.values, fit.problem.free
    every = free.copy()
    every[[F_N, ZETA, DELAY, GAIN]] = True
    f_n = float(values[F_N])
    residual, slopes = problem(fit.model, every, f_n, task.robust).residuals(values)
    columns = {str(k): slopes[:, k] for k in np.flatnonzero(every & ~free) if slopes[:, k].any()}
    if not fit.model.elastic and (by_spring := _by_spring(fit)) is not None:
        columns[CONTACT_STIFFNESS] = by_spring
    variance = 1.0 if any(task.table.given) else None
    if task.robust:
        plain = problem(fit.model, free, f_n)
        variance = effective_variance(plain, fit.solution, OUTLIER)
        if CONTACT_STIFFNESS in columns:
            q = np.hypot(1.0, plain.residuals(values)[0] / OUTLIER)
            columns[CONTACT_STIFFNESS] = columns[CONTACT_STIFFNESS] * np.sqrt(0.5 * (1.0 + q)) / q
    fitted = free & ~fit.solution.at_bound
    return steps(slopes, fitted, residual, columns, variance, residual.size - int(free.sum()))


def _by_spring(fit: Nearest) -> np.ndarray | None:
    """Change of the residuals with a spring in a rigid contact; none where a mass rests then."""
    values = fit.solution.values
    model = corrected(fit.model, float(values[DELAY]), float(values[GAIN]))
    r, beta = points_of(model.rows, values)
    found = []
    for law in (0.0, COMPLIANCE):
        one = values.copy()
        one[LAW] = law
        system = model._replace(elastic=True).system_at(one)
        found.append(nearest(model, steady_states(system, r, beta, 1.0))[0])
    change = found[1] - found[0]
    return change if np.isfinite(change).all() else None

"""Fit of the exact steady states to forced responses, with standard errors."""

from typing import NamedTuple

import numpy as np
from scipy.special import gammainccinv

from ... import checks, regimes
from ...errors import InputError
from ...model.system import System
from ..parameters import CHANNELS, CONTACT_STIFFNESS, SOFTEST
from ..spring import with_stiffness
from ..statistics.least_squares import (
    Errors,
    Problem,
    Solution,
    continued_below,
    minimise,
    one_sided,
    profile_end,
    two_sided,
    undetermined,
)
from ..statistics.levels import ROUNDS, SETTLED
from ..statistics.robust import root_mean_square, soften, usual_size
from ..statistics.weights import freedom_by_kind, table_errors
from .data import ForcedTable
from .model import DELAY, F_N, GAIN, LAW, ZETA, Fitted, ForcedModel, Samples, evaluate
from .start import closer, starts

#: The natural frequency is within this share of where the fit begins.
_FREQUENCY_RANGE = 0.2

#: A delay is looked for up to this share of the shortest cycle, and a gain up to this factor.
_DELAY, _GAIN = 0.25, 2.0

#: Sums that chance makes larger this rarely end the search for a better one.
_CHANCE = 1e-2

#: Starts, and evaluations from each, of a search that is not thorough: fits that end near the data take up to
#: 30.
_FEW_STARTS, _FEW_EVALUATIONS = 2, 40

#: Looks around the least sum, where chance does not explain it and motions come and go with friction.
_CLOSER_LOOKS = 2

#: Residuals beyond this many of their errors have little weight in a robust fit.
OUTLIER = 1.0

#: Singular values of slopes below this share of the largest are zero, as are changes of lags [rad] and of
#: logarithms of amplitudes, per unit of a parameter: differences have some such errors.
_RANK = 1e-5


#: Steps in which the end of the interval of mu, or of the compliance of a spring, is looked for where slopes
#: do not say how far it may be.
_STEP_OF_LAW = 0.05


class TableFit(NamedTuple):
    """A fit with its errors."""

    model: ForcedModel  # its samples have the errors that were taken
    problem: Problem
    solution: Solution
    errors: Errors
    here: Fitted
    mu_idle: bool  # mu was to be fitted, but no motion that was found stops


class Nearest(NamedTuple):
    """The steady states nearest to a table, without errors."""

    model: ForcedModel  # its samples have the errors that were taken
    problem: Problem
    solution: Solution
    here: Fitted
    mu_idle: bool
    rigid: bool  # a spring was to be fitted, but none is better


def nearest_states(
    table: ForcedTable, system: System, known: np.ndarray, elastic: bool, robust: bool, thorough: bool = True
) -> Nearest:
    """The steady states nearest to a table.

    known : (parameters,) values that are held; NaN of the others
    elastic : whether the contact has a spring: its compliance takes the place of mu among the parameters
    robust : whether residuals far beyond their errors have little weight
    thorough : whether the search goes on where chance does not explain the residuals
    """
    model = ForcedModel(system, bool(system.modes.zeta.any()), table.rows, table.samples, elastic)
    model, solution, task = _weighted(model, known, table.given, robust, thorough)
    here = evaluate(model, solution.values, task.free)
    idle = not elastic and bool(task.free[LAW]) and not (here.regime == regimes.STICK_SLIP).any()
    rigid = elastic and bool(task.free[LAW] and solution.at_bound[LAW])
    if idle or rigid:
        free = task.free
        held = _hold_contact_parameter(known, 0.0 if rigid else 1.0)
        model, solution, task = _weighted(model, held, table.given, robust, thorough)
        here = evaluate(model, solution.values, task.free)
        if rigid:  # whatever is left of the spring is within the interval
            task = problem(model, free, float(solution.values[F_N]), robust)
    return Nearest(model, task, solution, here, idle, rigid)


def with_errors(table: ForcedTable, near: Nearest, robust: bool) -> TableFit:
    """The standard errors and intervals of a solution.

    Raises
    ------
    InputError
        The table does not determine a parameter.
    """
    model, task, solution = near.model, near.problem, near.solution
    flat = near.rigid or _is_flat(model, solution, task)
    determined = _hold_law(task) if flat else task
    _check_identifiable(table, model, solution, determined)
    plain = problem(model, determined.free if near.rigid else task.free, float(solution.values[F_N]))
    now = solution._replace(at_bound=solution.at_bound & determined.free)
    found, scaling, variance = table_errors(
        plain, determined, now, _kind(model.samples), np.array(table.given), OUTLIER if robust else None
    )
    of_law = (found.variance if variance is None else variance) * (found.inflation * scaling.larger[LAW]) ** 2
    found = (_on_bound if flat else _near_bound)(found, task, solution, of_law)
    if flat:
        solution = solution._replace(at_bound=solution.at_bound | (task.free & ~determined.free))
    if robust:
        solution = solution._replace(residual=plain.residuals(solution.values)[0])
        found = found._replace(variance=solution.sum / _freedom(solution, task))
    return TableFit(model, task, solution, found, near.here, near.mu_idle)


def _is_flat(model: ForcedModel, solution: Solution, task: Problem) -> bool:
    """Check whether mu ended on its bound and nothing changes with it there to first order."""
    return bool(task.free[LAW] and solution.at_bound[LAW]) and float(_effects(model, solution)[LAW]) < _RANK


def _effects(model: ForcedModel, solution: Solution) -> np.ndarray:
    """Return the changes of lags [rad] and logarithms of amplitudes per unit of each parameter.

    f_n and compliances count by their own size.
    """
    unit = np.ones(solution.values.size)
    unit[F_N] = solution.values[F_N]
    if model.elastic:
        unit[LAW] = solution.values[LAW]
    return np.linalg.norm(solution.slopes * model.samples.sigma[:, np.newaxis], axis=0) * unit


def _hold_contact_parameter(known: np.ndarray, value: float) -> np.ndarray:
    """What is held, and the parameter of the contact with it."""
    held = known.copy()
    held[LAW] = value
    return held


def _hold_law(task: Problem) -> Problem:
    """Hold mu, or the spring."""
    free = task.free.copy()
    free[LAW] = False
    return task._replace(free=free)


def _on_bound(found: Errors, task: Problem, solution: Solution, variance: float) -> Errors:
    """Take the interval of mu = 1, or of a rigid contact, from the profile of the sum.

    Those of the others allow for all of it.
    """
    allowed = one_sided(_freedom(solution, task)) ** 2 * variance
    most, end = profile_end(task, solution, LAW, allowed, _STEP_OF_LAW)
    moved = end.values - solution.values
    lower, upper = found.lower + np.minimum(moved, 0.0), found.upper + np.maximum(moved, 0.0)
    lower = np.where(task.free, np.maximum(lower, task.floor), lower)
    upper[LAW] = most
    return found._replace(lower=lower, upper=upper)


def _freedom(solution: Solution, task: Problem) -> int:
    return solution.residual.size - int(task.free.sum())


def _near_bound(found: Errors, task: Problem, solution: Solution, variance: float) -> Errors:
    """Take the interval of mu from the profile of the sum where it begins at 1: there slopes say little.

    So for the compliance of a spring, where the interval holds a rigid contact.
    """
    if not task.free[LAW] or solution.at_bound[LAW] or found.lower[LAW] > task.floor[LAW]:
        return found
    scale = float(found.standard_error[LAW])
    upper = found.upper.copy()
    allowed = two_sided(_freedom(solution, task)) ** 2 * variance
    upper[LAW] = profile_end(task, solution, LAW, allowed, scale)[0]
    return found._replace(upper=upper)


def problem(model: ForcedModel, free: np.ndarray, f_n: float, robust: bool = False) -> Problem:
    """Least squares of all samples; `f_n` is where the fit begins."""
    floor = np.full(free.size, -np.inf)
    floor[:F_N], floor[ZETA] = 0.0, 0.0
    if free[LAW]:
        floor[LAW] = model.least_law

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = evaluate(model, values, free)
        return found.residual, found.slopes

    lowest, highest = np.full(free.size, -np.inf), np.full(free.size, np.inf)
    lowest[F_N], highest[F_N] = f_n * (1.0 - _FREQUENCY_RANGE), f_n * (1.0 + _FREQUENCY_RANGE)
    highest[DELAY] = _DELAY / float(model.rows.frequency.max())
    lowest[DELAY], lowest[GAIN], highest[GAIN] = -highest[DELAY], 1.0 / _GAIN, _GAIN
    highest[ZETA] = checks.LARGEST_DAMPING
    if model.elastic:
        highest[LAW] = SOFTEST
    plain = continued_below(Problem(residuals, free, floor, lowest, highest))
    return soften(plain, OUTLIER) if robust else plain


def _weighted(
    model: ForcedModel, known: np.ndarray, given: tuple[bool, bool], robust: bool, thorough: bool
) -> tuple[ForcedModel, Solution, Problem]:
    """Minimise with given errors, or with errors of lags and amplitudes from their own residuals."""
    free = np.isnan(known)
    solution, task = _best(model, known, all(given), robust, thorough)
    for _ in range(0 if all(given) else ROUNDS):
        samples = _with_scatter(model, solution, free, given, robust)
        change = samples.sigma / model.samples.sigma
        if (np.abs(change - 1.0) < SETTLED).all() or not (samples.sigma > 0.0).all():
            break
        model = model._replace(samples=samples)
        task = problem(model, free, float(solution.values[F_N]), robust)
        solution = minimise(task, solution.values)
    return model, solution, task


def _with_scatter(
    model: ForcedModel, solution: Solution, free: np.ndarray, given: tuple[bool, bool], robust: bool
) -> Samples:
    """Samples with the errors of lags, or amplitudes, from their residuals, if they were not given."""
    samples, residual = model.samples, solution.residual
    if robust:  # those of the solution are drawn in
        residual = problem(model, free, float(solution.values[F_N])).residuals(solution.values)[0]
    size = usual_size if robust else root_mean_square
    kind = _kind(samples)
    sigma = samples.sigma.copy()
    for k, freedom in enumerate(freedom_by_kind(solution, free, kind)):
        if not given[k]:
            sigma[kind == k] *= size(residual[kind == k], freedom)
    return samples._replace(sigma=sigma)


def _kind(samples: Samples) -> np.ndarray:
    """Lags 0, amplitudes 1, as errors of a table are given."""
    return (~samples.is_phase).astype(int)


def _best(
    model: ForcedModel, known: np.ndarray, sure: bool, robust: bool, thorough: bool
) -> tuple[Solution, Problem]:
    """The least sum over all starts, or the first that chance explains if the errors are sure."""
    free = np.isnan(known)
    freedom = model.samples.row.size - int(free.sum())
    enough = 2.0 * float(gammainccinv(0.5 * freedom, _CHANCE)) if sure else 0.0
    begun = starts(model, known)[: None if thorough else _FEW_STARTS]
    looks = _CLOSER_LOOKS if thorough and np.isnan(known[LAW]) and not model.elastic else 0
    best: tuple[Solution, Problem] | None = None
    while begun and (best is None or best[0].sum > enough):
        start = begun.pop(0)
        task = problem(model, free, float(start[F_N]), robust)
        found = minimise(task, start, None if thorough else _FEW_EVALUATIONS)
        if best is None or found.sum < best[0].sum:
            best = found, task
            if looks and found.sum > enough:
                begun = closer(model, found.values, known) + begun
                looks -= 1
    assert best is not None  # there is a start at least
    if not np.isfinite(best[0].sum):
        raise InputError(
            "cannot fit the data: a measured mass never moves in this model, for any friction ratio; "
            "check contact_masses and the columns"
        )
    return best


def _check_identifiable(table: ForcedTable, model: ForcedModel, solution: Solution, task: Problem) -> None:
    """Refuse data that do not identify a parameter, or several of them separately."""
    names = parameter_names(table, model.elastic)
    for index in np.flatnonzero(task.free & (_effects(model, solution) < _RANK)):
        raise InputError(
            f"cannot identify {names[index]}: no measured quantity depends on it; fix it in [known]"
        )
    together, _ = undetermined(task, solution, _RANK)
    if together.size:
        words = " and ".join(names[index] for index in together)
        raise InputError(
            f"cannot identify {words} separately: not determined by the data; fix one in [known] or add data"
        )


def shown_estimates(fit: TableFit) -> tuple[np.ndarray, Errors]:
    """Estimates and errors as they are reported: the stiffness of a spring for its compliance."""
    if not fit.model.elastic:
        return fit.solution.values, fit.errors
    return with_stiffness(fit.solution.values, fit.errors, LAW, bool(fit.problem.free[LAW]))


def parameter_names(table: ForcedTable, elastic: bool) -> tuple[str, ...]:
    """beta, or one of every set; f_n, zeta, mu or the stiffness of a spring, and how the channels differ."""
    betas = [f"beta_{label}" for label in table.labels] if len(table.labels) > 1 else ["beta"]
    return (*betas, "f_n", "zeta", CONTACT_STIFFNESS if elastic else "mu", *CHANNELS)

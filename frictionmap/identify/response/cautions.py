"""Warnings about a fit of forced responses."""

import numpy as np

from ... import regimes
from ..spring import spring_warnings
from ..statistics.cautions import (
    autocorrelation_warnings,
    bound_warnings,
    correlation_warnings,
    interval_warnings,
)
from .alternatives import is_beyond_chance
from .data import ForcedTable
from .fit import TableFit, parameter_names, shown_estimates
from .model import LAW, ZETA, points_of

#: Share of beta_stick above which structures stuck in tests, T 4.4.
_NEAR_STICKING = 0.7


def fit_warnings(table: ForcedTable, fit: TableFit) -> list[str]:
    """Warnings."""
    names = parameter_names(table, fit.model.elastic)
    at_bound = fit.solution.at_bound.copy()
    if fit.model.elastic:
        at_bound[LAW] = False  # `_contact_warnings` has words for it
    return [
        *_scatter(table, fit),
        *autocorrelation_warnings(fit.errors),
        *correlation_warnings(names, shown_estimates(fit)[1].correlation),
        *_contact_warnings(fit),
        *bound_warnings(names, fit.problem.floor, at_bound),
        *_near_sticking(fit),
        *_several(fit),
        *_idle(fit),
    ]


def _contact_warnings(fit: TableFit) -> list[str]:
    """Warnings about mu, or about the spring."""
    if not fit.problem.free[LAW]:
        return []
    if fit.model.elastic:
        found = shown_estimates(fit)[1]
        return spring_warnings(float(found.lower[LAW]), float(found.upper[LAW]))
    return interval_warnings("mu", 1.0, bool(fit.errors.lower[LAW] > 1.0))


def _scatter(table: ForcedTable, fit: TableFit) -> list[str]:
    freedom = fit.solution.residual.size - int(fit.problem.free.sum())
    if not is_beyond_chance(table, fit.solution.sum, freedom):
        return []
    return [
        f"residuals are larger than the errors given (reduced chi square {fit.errors.variance:.3g}): check "
        "sigma_phase_deg and sigma_amplitude, and look at the residuals with frictionmap plot"
    ]


def _near_sticking(fit: TableFit) -> list[str]:
    """Rows whose friction is near that which holds the contact, beta_stick = |F|/mu, theory.md 4."""
    if fit.model.elastic:  # there the contact has its spring
        return []
    values = fit.solution.values
    r, beta = points_of(fit.model.rows, values)
    held = np.abs(fit.model.with_zeta(float(values[ZETA])).contact_load(r))
    near = int((beta * values[LAW] > _NEAR_STICKING * held).sum())
    if not near:
        return []
    return [f"{near} of {r.size} rows have beta above {_NEAR_STICKING:g} beta_stick and may stick in a test"]


def _several(fit: TableFit) -> list[str]:
    """Rows where another steady state exists than the one that is nearest to the data."""
    if len(fit.here.states) == 1:
        return []
    found = np.array([states.regime for states in fit.here.states])
    other = ((found != fit.here.regime) & (found != regimes.UNRESOLVED)).any(axis=0)
    if not other.any():
        return []
    count = f"{int(other.sum())} of {other.size} rows"
    return [f"{count} have several steady states: the nearest ones to the data are fitted"]


def _idle(fit: TableFit) -> list[str]:
    if not fit.mu_idle:
        return []
    return ["no fitted motion sticks: the data do not determine mu, which is held at 1"]

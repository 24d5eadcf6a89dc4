"""Warnings about a fit of forced responses."""

import numpy as np
from scipy.special import gammaincc

from ... import regimes
from ..statistics.cautions import (
    autocorrelation_warnings,
    bound_warnings,
    correlation_warnings,
    interval_warnings,
)
from ..statistics.levels import CHANCE
from .data import ForcedTable
from .fit import TableFit, parameter_names
from .model import MU, ZETA, points_of

#: Share of beta_stick above which structures stuck in tests, T 4.4.
_NEAR_STICKING = 0.7


def fit_warnings(table: ForcedTable, fit: TableFit) -> list[str]:
    """Warnings."""
    names = parameter_names(table)
    return [
        *_scatter(table, fit),
        *autocorrelation_warnings(fit.errors),
        *correlation_warnings(names, fit.errors.correlation),
        *interval_warnings("mu", 1.0, not fit.problem.free[MU] or bool(fit.errors.lower[MU] > 1.0)),
        *bound_warnings(names, fit.problem.floor, fit.solution.at_bound),
        *_near_sticking(fit),
        *_several(fit),
        *_idle(fit),
    ]


def _scatter(table: ForcedTable, fit: TableFit) -> list[str]:
    freedom = fit.solution.residual.size - int(fit.problem.free.sum())
    if not all(table.given) or gammaincc(0.5 * freedom, 0.5 * fit.solution.sum) >= CHANCE:
        return []
    return [f"residuals are larger than the errors given: reduced chi square {fit.errors.variance:.3g}"]


def _near_sticking(fit: TableFit) -> list[str]:
    """Rows whose friction is near that which holds the contact, beta_stick = |F|/mu, theory.md 4."""
    values = fit.solution.values
    r, beta = points_of(fit.model.rows, values)
    held = np.abs(fit.model.with_zeta(float(values[ZETA])).contact_load(r))
    near = int((beta * values[MU] > _NEAR_STICKING * held).sum())
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

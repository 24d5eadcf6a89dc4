"""What to mind of a fit of forced responses, in words."""

import numpy as np
from scipy.special import gammaincc

from .. import regimes
from .forced_data import ForcedTable
from .forced_fit import Fit, parameter_names
from .forced_model import MU, ZETA, points_of

#: Beyond this two estimates cannot well be told apart.
_CORRELATED = 0.95

#: Sums of squares that chance makes larger more rarely are beyond the errors that are given.
_CHANCE = 1e-3

#: From this share of beta_stick on structures got stuck in tests, T 4.4.
_NEAR_STICKING = 0.7


def told(table: ForcedTable, fit: Fit) -> list[str]:
    """Warnings."""
    return [
        words
        for words in (
            _scatter(table, fit), _colour(fit), *_correlations(table, fit), *_bounds(table, fit),
            _near_sticking(fit), _several(fit), _idle(fit),
        )
        if words
    ]  # fmt: skip


def _scatter(table: ForcedTable, fit: Fit) -> str:
    freedom = fit.solution.residual.size - int(fit.problem.free.sum())
    if not all(table.given) or gammaincc(0.5 * freedom, 0.5 * fit.solution.sum) >= _CHANCE:
        return ""
    return f"residuals are larger than the errors given: reduced chi square {fit.errors.variance:.3g}"


def _colour(fit: Fit) -> str:
    if fit.errors.inflation == 1.0:
        return ""
    return (
        f"residuals are not white (lag-1 correlation {fit.errors.lag_correlation:.2f}): "
        f"errors are taken {fit.errors.inflation:.2f} times as large"
    )


def _correlations(table: ForcedTable, fit: Fit) -> list[str]:
    names, found = parameter_names(table), fit.errors.correlation
    rows, columns = np.nonzero(np.triu(np.abs(found) > _CORRELATED, 1))
    return [
        f"{names[i]} and {names[j]} trade: correlation {found[i, j]:.2f}"
        for i, j in zip(rows, columns, strict=True)
    ]


def _bounds(table: ForcedTable, fit: Fit) -> list[str]:
    names, floor = parameter_names(table), fit.problem.floor
    return [
        f"{names[index]} on the bound {floor[index]:g}: the interval is one-sided"
        for index in np.flatnonzero(fit.solution.at_bound)
    ]


def _near_sticking(fit: Fit) -> str:
    """Rows whose friction is near that which holds the contact, beta_stick = |F|/mu, theory.md 4."""
    values = fit.solution.values
    r, beta = points_of(fit.model.rows, values)
    held = np.abs(fit.model.with_zeta(float(values[ZETA])).modes.held_load(r))
    near = int((beta * values[MU] > _NEAR_STICKING * held).sum())
    if not near:
        return ""
    return f"{near} of {r.size} rows have beta above {_NEAR_STICKING:g} beta_stick, where tests got stuck"


def _several(fit: Fit) -> str:
    """Rows where another steady state exists than the one that is nearest to the data."""
    if len(fit.here.states) == 1:
        return ""
    found = np.array([states.regime for states in fit.here.states])
    other = ((found != fit.here.regime) & (found != regimes.UNRESOLVED)).any(axis=0)
    if not other.any():
        return ""
    return (
        f"{int(other.sum())} of {other.size} rows have several steady states; those nearest to the data count"
    )


def _idle(fit: Fit) -> str:
    if not fit.mu_idle:
        return ""
    return "no motion that was fitted stops: the data do not tell mu, which is held at 1"

"""Boundaries of a reduced structure against those with all modes or many more: what its reduction changes.

What a reduction promises (`structures.accuracy`) holds in the range of the load's frequency.  Harmonics of
the friction force lie above it, and beta_lim follows them.  With all modes the change is the error.  Where
these are too many, what modes beyond those compared with would change is not seen, and may be more.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..model.matrices import reduced_matrices
from ..model.system import System
from .boundary_curves import find_curves

#: Frequencies of an axis at which boundaries are compared, at most.
_MOST_FREQUENCIES = 500

#: Changes from here on are given in whole per cent: two digits would be a power of ten.
_WHOLE = 0.995

#: Changes are given in per cent within these bounds; what lies beyond them is said in words.
_LEAST_CHANGE, _MOST_CHANGE = 1e-4, 10.0


class Change(NamedTuple):
    """Largest relative change of a boundary, and the frequency ratio where it is."""

    share: float
    r: float

    def describe(self) -> str:
        """State the change in per cent, and where it is."""
        if self.share < _LEAST_CHANGE:
            return f"by less than {100.0 * _LEAST_CHANGE:g} %"
        per_cent = 100.0 * self.share
        size = f"up to {per_cent:.2g} %" if self.share < _WHOLE else f"up to {per_cent:.0f} %"
        if self.share > _MOST_CHANGE:
            size = f"more than {100.0 * _MOST_CHANGE:.0f} %"
        return f"by {size} (at r = {self.r:.4g})"


class BoundaryChanges(NamedTuple):
    """Changes of the boundaries by more modes, at one mu."""

    modes: int
    all_modes: int  # of the whole structure
    beta_lim: Change
    beta_stick: Change

    def describe(self) -> str:
        """State how much the boundaries change."""
        among = f"all {self.modes}" if self.modes == self.all_modes else f"{self.modes} of {self.all_modes}"
        return (
            f"against {among} modes beta_lim changes {self.beta_lim.describe()}, beta_stick "
            f"{self.beta_stick.describe()}"
        )


def with_more_modes(system: System) -> System | None:
    """The same system with all modes or many more; None without a reduction, or without more modes.

    Of damping ratios that are given mode by mode further modes have the last one.
    """
    finer = None if system.reduction is None else system.reduction.refined
    if finer is None:
        return None
    matrices, ratios = reduced_matrices(finer), system.damping_ratios
    if ratios is not None:
        ratios = [*ratios, *[ratios[-1]] * (matrices.n - system.n)]  # type: ignore[index, misc]
    return replace(
        system, matrices=matrices, reduce=finer.asked, damping_ratios=ratios, frequency_scale=system.omega_1
    )


def thinned(axis: np.ndarray, most: int) -> np.ndarray:
    """At most `most` values of an axis, evenly from its first to its last."""
    return axis[np.unique(np.linspace(0, axis.size - 1, min(most, axis.size)).round().astype(int))]


def boundary_changes(system: System, finer: System, r: np.ndarray, mu: float) -> BoundaryChanges:
    """Changes of the boundaries of a reduced structure over an axis r, by a finer reduction."""
    assert finer.reduction is not None
    some = thinned(r, _MOST_FREQUENCIES)
    own, other = (find_curves(one, some, np.array([mu])) for one in (system, finer))
    return BoundaryChanges(
        finer.reduction.asked.modes,
        finer.reduction.most_modes,
        _largest(own.beta_lim[0], other.beta_lim[0], some),
        _largest(own.beta_stick[0], other.beta_stick[0], some),
    )


def _largest(own: np.ndarray, finer: np.ndarray, r: np.ndarray) -> Change:
    """The largest change relative to the finer values; where both are 0 or infinite there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(own == finer, 0.0, np.abs(own / finer - 1.0))
    worst = int(np.nanargmax(share))
    return Change(float(share[worst]), float(r[worst]))


def one_mu(mu: np.ndarray) -> float:
    """The mu of an axis at which reductions are compared: 1 if it is there, else the first."""
    return 1.0 if (mu == 1.0).any() else float(mu[0])


def boundary_check(system: System, r: np.ndarray, mu: np.ndarray) -> dict[str, str]:
    """Attribute `reduction_check` of boundaries over r and mu; empty for a structure that is not reduced."""
    try:
        finer = with_more_modes(system)
        if finer is None:
            return {}
        return {"reduction_check": boundary_changes(system, finer, r, one_mu(mu)).describe()}
    except InputError as error:
        return {"reduction_check": not_compared(error)}


def not_compared(error: InputError) -> str:
    """Why a reduction is not compared with one of more modes, in words."""
    return f"not compared with more modes: {error}"

"""A reduced structure against the same with all modes or many more: what its reduction changes.

What a reduction promises (`structures.accuracy`) holds in the range of the load's frequency.  Harmonics of
the friction forces lie above it, and beta_lim follows them.  With all modes the change is the error.  Where
these are too many, what modes beyond those compared with would change is not seen, and may be more.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..jobs import Watch
from ..model.matrices import reduced_matrices
from ..model.settings import Solver
from ..model.system import System
from ..regimes import UNRESOLVED
from ..solvers.choose import engine_of, has_closed_forms

#: Frequencies of an axis at which boundaries are compared, at most: in closed form, and else.
_MOST_FREQUENCIES, _FOLLOWED = 500, 20

#: Frequencies and friction ratios of the coarse map; above mu = 1 no cell is decided by proof, and fewer do.
#: With several contacts or springs motions of all modes are followed, a thousand times as long.
_COARSE, _COARSE_ABOVE_ONE, _COARSE_FOLLOWED = (20, 15), (8, 6), (4, 3)

#: Boundaries that are compared where a system has them.
_BOUNDARIES = ("beta_lim", "beta_noslip", "beta_stick")

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
    of: dict[str, Change]  # by the names of the boundaries

    def describe(self) -> str:
        """State how much the boundaries change."""
        among = f"all {self.modes}" if self.modes == self.all_modes else f"{self.modes} of {self.all_modes}"
        (name, first), *others = self.of.items()
        more = "".join(f", {other} {change.describe()}" for other, change in others)
        return f"against {among} modes {name} changes {first.describe()}{more}"


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
    some = thinned(r, _MOST_FREQUENCIES if has_closed_forms(system) else _FOLLOWED)
    own, other = (_boundaries(one, some, np.array([mu])) for one in (system, finer))
    return BoundaryChanges(
        finer.reduction.asked.modes,
        finer.reduction.most_modes,
        {name: _largest(own[name], other[name], some) for name in own},
    )


def _boundaries(system: System, r: np.ndarray, mu: np.ndarray) -> dict[str, np.ndarray]:
    """The boundaries (n_r,) that a system has, at one mu."""
    engine = engine_of(system)
    if engine.has_closed_limits:
        found = engine.limits(r, mu)
        return {"beta_lim": found.beta_lim[0], "beta_stick": found.beta_stick[0]}
    ds = engine.boundaries(r, mu)
    return {name: np.atleast_2d(ds[name].values)[0] for name in _BOUNDARIES if name in ds}


def _largest(own: np.ndarray, finer: np.ndarray, r: np.ndarray) -> Change:
    """The largest change over the finer values; where both are 0, infinite or missing there is none."""
    same = (own == finer) | (np.isnan(own) & np.isnan(finer))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(same, 0.0, np.abs(own / finer - 1.0))
    share = np.where(np.isnan(share), np.inf, share)  # only one of them has a boundary
    worst = int(np.argmax(share))
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


def reduction_check(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None = None,
    watch: Watch | None = None,
) -> dict[str, str]:  # fmt: skip
    """The attribute `reduction_check` of cells on axes mu, r and beta; none without a reduction."""
    try:
        finer = with_more_modes(system)
        if finer is None:
            return {}
        mu = one_mu(axes["mu"])
        changes = boundary_changes(system, finer, axes["r"], mu).describe()
        changed, cells = regime_changes(system, finer, axes, mu, solver, threads, watch)
    except InputError as error:
        return {"reduction_check": not_compared(error)}
    where = f"{changed:,} of {cells:,} cells of a coarse map (mu = {mu:g}) change regime"
    return {"reduction_check": f"{changes}; {where}"}


def regime_changes(
    system: System, finer: System, axes: Mapping[str, np.ndarray], mu: float, solver: Solver,
    threads: int | None = None, watch: Watch | None = None,
) -> tuple[int, int]:  # fmt: skip
    """Number of cells of a coarse map whose regime a finer reduction changes, and number of its cells.

    Cells that either leaves unresolved do not count as changed.
    """
    counts = _COARSE if mu == 1.0 else _COARSE_ABOVE_ONE
    counts = counts if has_closed_forms(system) else _COARSE_FOLLOWED
    r, beta = (thinned(axes[name], count) for name, count in zip(("r", "beta"), counts, strict=True))
    coarse = {"mu": np.array([mu]), "r": r, "beta": beta}
    settings = replace(solver, outputs=("regime",))
    own, other = (
        engine_of(one).cells(coarse, ("regime",), settings, threads, None, watch, searched=False)[0]["regime"]
        for one in (system, finer)
    )
    changed = (own != other) & (own != UNRESOLVED) & (other != UNRESOLVED)
    return int(np.count_nonzero(changed)), own.size

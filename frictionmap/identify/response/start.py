"""Starting values for forced responses: a coarse search over friction ratios and natural frequencies.

Sums of squares have many least values over f_n, and some over beta: the look takes residuals with errors
so large that it cannot pass between its samples.
"""

from itertools import product

import numpy as np

from ...steady.points import steady_states
from ..parameters import ALIKE
from .balance import balanced_phasors, stick_friction
from .model import DELAY, F_N, LAW, ZETA, ForcedModel, Samples, corrected, residuals

#: Errors with which it looks, radian and relative, and the most that one number counts.
_LOOK_PHASE, _LOOK_AMPLITUDE = 0.15, 0.2
_MOST = 5.0

#: What a mass at rest, or no steady state, counts: as much as no motion does.
_AT_REST = 1e3

#: Friction ratios: number of values below the one at which everything sticks, down to a share of it.
_BETAS, _LEAST_SHARE = 16, 0.02

#: Natural frequencies: from this share of the lowest frequency to this multiple of the highest, by this step.
_F_BELOW, _F_ABOVE, _F_STEP = 0.5, 3.0, 1.06

_DAMPINGS = (0.003, 0.03)

#: Starts that are tried, no two with natural frequencies as near to each other as this.
_TRIED, _APART = 3, 0.06
_MU = (1.05, 1.4)

#: Compliances of springs that are tried, and the factor by which those of two starts differ if f_n does not.
_COMPLIANCES = (3.0, 1.0, 0.3, 0.1, 0.03)
_SPRINGS_APART = 2.0

#: A closer search: factor of the errors, and values near those that were found.
_CLOSER = 3.0
_F_BESIDE = np.array([0.97, 0.985, 1.0, 1.015, 1.03])
_MU_BESIDE = np.arange(-0.2, 0.25, 0.05)
_BETA_BESIDE = np.linspace(0.8, 1.25, 19)


def starts(model: ForcedModel, known: np.ndarray) -> list[np.ndarray]:
    """Values to begin with, the most promising first.

    known : (parameters,) values that are held; NaN of the others
    """
    channels = np.where(np.isnan(known[DELAY:]), list(ALIKE.values()), known[DELAY:])
    model = corrected(model, *channels.tolist())
    tempered = model._replace(samples=_inflate_errors(model))
    frequencies = _candidates(model) if np.isnan(known[F_N]) else [known[F_N]]
    dampings = _DAMPINGS if np.isnan(known[ZETA]) else [known[ZETA]]
    first_laws = _COMPLIANCES if model.elastic else (1.0,)
    looked = []
    for zeta, law in product(dampings, first_laws if np.isnan(known[LAW]) else (known[LAW],)):
        several = [np.append(known[:F_N], [f_n, zeta, law, *channels]) for f_n in frequencies]
        looked += _best_frictions(tempered, several, [_everywhere(model, one, known) for one in several])
    looked.sort(key=lambda one: one[0])
    chosen: list[np.ndarray] = []
    for _, values in looked:
        if all(_differ(model, values, other) for other in chosen):
            chosen.append(values)
    chosen = chosen[:_TRIED]
    if model.elastic or not np.isnan(known[LAW]):
        return chosen
    looked = []
    for values, mu in product(chosen, _MU):
        other = values.copy()
        other[LAW] = mu
        looked += _best_frictions(tempered, [other], [_everywhere(model, other, known)])
    return [values for _, values in sorted(looked, key=lambda one: one[0])]


def _differ(model: ForcedModel, one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two starts have other natural frequencies, or other springs."""
    stiff, soft = sorted((float(one[LAW]), float(other[LAW])))
    other_spring = model.elastic and soft > _SPRINGS_APART * stiff
    return other_spring or bool(abs(np.log(one[F_N] / other[F_N])) > _APART)


def _inflate_errors(model: ForcedModel) -> Samples:
    """The samples with larger errors."""
    samples = model.samples
    least = np.where(samples.is_phase, _LOOK_PHASE, _LOOK_AMPLITUDE)
    return samples._replace(sigma=np.maximum(samples.sigma, least))


def _candidates(model: ForcedModel) -> np.ndarray:
    low, high = model.rows.frequency.min() * _F_BELOW, model.rows.frequency.max() * _F_ABOVE
    count = int(np.ceil(np.log(high / low) / np.log(_F_STEP)))
    return np.geomspace(low, high, count + 1)


def closer(model: ForcedModel, near: np.ndarray, known: np.ndarray) -> list[np.ndarray]:
    """Starting values around a solution, the most promising first.

    Motions appear and disappear with friction where mu > 1, and the sum has steps that slopes do not show.
    """
    model = corrected(model, *near[DELAY:].tolist())
    samples = model.samples._replace(sigma=_CLOSER * model.samples.sigma)
    frequencies = near[F_N] * _F_BESIDE if np.isnan(known[F_N]) else known[F_N:ZETA]
    looked = []
    for mu in near[LAW] + _MU_BESIDE:
        if mu >= 1.0:
            rest = [near[ZETA], mu, *near[DELAY:]]
            several = [np.append(near[:F_N], [f_n, *rest]) for f_n in frequencies]
            tried = [_around(values, known) for values in several]
            looked += _best_frictions(model._replace(samples=samples), several, tried)
    looked.sort(key=lambda one: one[0])
    return [values for _, values in looked[:_TRIED]]


def _around(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Friction ratios of every set beside its own, (tried, sets)."""
    return np.where(np.isnan(known[:F_N]), values[:F_N] * _BETA_BESIDE[:, np.newaxis], values[:F_N])


def _everywhere(model: ForcedModel, values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Friction ratios of every set up to where all sticks, (tried, sets)."""
    system, r = model.with_zeta(float(values[ZETA])), np.unique(model.rows.frequency / values[F_N])
    if model.elastic and values[LAW] > 0.0:
        stick = stick_friction(system, r, 1.0 / float(values[LAW]))
    else:
        stick = np.abs(system.contact_load(r))
    top = float(stick[np.isfinite(stick)].max(initial=1.0))
    grid = np.append(np.geomspace(_LEAST_SHARE * top, top, _BETAS), 0.0)[:, np.newaxis]
    return np.where(np.isnan(known[:F_N]), grid, known[:F_N])


def _best_frictions(
    model: ForcedModel, several: list[np.ndarray], tried: list[np.ndarray]
) -> list[tuple[float, np.ndarray]]:
    """Find the best friction ratio of every set for several values of one zeta and law; return their sums.

    tried : (tried, sets) for each of the values
    """
    rows = model.rows
    r = np.concatenate(
        [np.tile(rows.frequency / one[F_N], grid.shape[0]) for one, grid in zip(several, tried, strict=True)]
    )
    beta = np.concatenate([(grid[:, rows.member] / rows.share).ravel() for grid in tried])
    phasors = _phasors(model, several[0], r, beta)
    ends = np.cumsum([grid.shape[0] * rows.frequency.size for grid in tried])[:-1]
    found = []
    for one, grid, part in zip(several, tried, np.split(phasors, ends, axis=1), strict=True):
        sums = _sums(model, part.reshape(len(phasors), grid.shape[0], rows.frequency.size, -1))
        best = grid[sums.argmin(axis=0), np.arange(model.sets)]
        found.append((float(sums.min(axis=0).sum()), np.append(best, one[F_N:])))
    return found


def _phasors(model: ForcedModel, values: np.ndarray, r: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Phasors (motions, points, n): exact, or of a contact with a spring by harmonic balance."""
    if model.elastic and values[LAW] > 0.0:
        system = model.with_zeta(float(values[ZETA]))
        return balanced_phasors(system, r, beta, 1.0 / float(values[LAW]))[np.newaxis]
    states = steady_states(model.system_at(values), r, beta, model.mu_at(values))
    return np.array([state.phasors for state in states])


def _sums(model: ForcedModel, phasors: np.ndarray) -> np.ndarray:
    """Sums of squares (tried, sets) of the nearest of several motions, (motions, tried, rows, n)."""
    found = np.abs(residuals(model.samples, phasors))
    squares = np.where(np.isfinite(found), np.minimum(found, _MOST) ** 2, _AT_REST)
    rows = np.arange(model.rows.frequency.size)
    nearest = (squares @ (model.samples.row[:, np.newaxis] == rows).astype(float)).min(axis=0)
    return nearest @ (model.rows.member[:, np.newaxis] == np.arange(model.sets)).astype(float)

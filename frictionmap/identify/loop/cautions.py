"""Warnings about a fitted damper test."""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from ..signals.turning_points import noise_level
from ..statistics.cautions import correlation_warnings
from ..statistics.least_squares import Errors, inflation
from ..statistics.levels import CHANCE
from .branches import motion
from .fit import LoopFit
from .play import factor
from .problem import FRICTION, STIFFNESS, element_of, modelled_force, places_of
from .verdict import missing, step

#: Samples of a branch, below which a warning is due.
_FEW = 20

#: Share of the speed by which that of the slider may differ from that of the actuator.
_OTHER_SPEED = 0.03

#: Reduced chi square beyond the error of the noise from sample to sample, a median of some hundred numbers.
_MISFIT = 1.5

_CHANNELS = ("motion", "force")


class Channels(NamedTuple):
    """Residuals of the motion and of the force."""

    correlation: tuple[float, float]  # from sample to sample
    chi_square: tuple[float, float]  # reduced, over the noise from sample to sample
    inflation: tuple[float, float]  # of errors, as residuals are correlated


def channels(fit: LoopFit) -> Channels:
    """How far the residuals of both channels are white noise."""
    parts = np.split(fit.solution.residual, 2)
    lags, larger = zip(*(inflation(one) for one in parts), strict=True)
    noise = [noise_level(one) for one in parts]
    squares = [
        float(np.mean(one**2)) / level**2 if level > 0.0 else 1.0
        for one, level in zip(parts, noise, strict=True)
    ]
    return Channels(lags, (squares[0], squares[1]), larger)


def cautions(fit: LoopFit, found: Errors, seen: Channels, named: list[str]) -> list[str]:
    """Warnings about a fit.

    named : parameters that are fitted or known
    """
    shown = np.flatnonzero(fit.problem.free[: fit.test.named])
    asked = missing(fit, named)
    words = _misfits(seen)
    if asked:
        words.append(f"{asked} would explain more of the force: add {asked} to free")
    words += correlation_warnings([fit.test.names[k] for k in shown], found.correlation[np.ix_(shown, shown)])
    # a missing parameter may look like a change
    return words + ([] if asked else _changes(fit)) + _few_samples(fit) + _other_speeds(fit)


def _misfits(seen: Channels) -> list[str]:
    """What the model leaves of either channel."""
    words = []
    for name, lag, square, larger in zip(_CHANNELS, *seen, strict=True):
        if larger > 1.0 or square > _MISFIT:
            words.append(
                f"the model does not explain the {name} down to the noise (correlation of residuals "
                f"{lag:.2f}, {square:.2f} times the variance from sample to sample)"
            )
    if max(seen.inflation) > 1.0:
        words.append(f"standard errors were multiplied by {max(seen.inflation):.3g}")
    return words


def _changes(fit: LoopFit) -> list[str]:
    """Friction and stiffness of the first third of the time against those of the last third."""
    time = fit.test.time
    share = (time - time[0]) / (time[-1] - time[0])
    weight = np.where(share > 2.0 / 3.0, 0.5, 0.0) - np.where(share < 1.0 / 3.0, 0.5, 0.0)
    slopes = modelled_force(fit.test, fit.layout, fit.solution.values).slopes / fit.test.sigma_force
    words = []
    for place in (FRICTION, STIFFNESS):
        change = step(fit, slopes[:, place] * weight * fit.solution.values[place])
        # two-sided, of two parameters
        if fit.problem.free[place] and abs(change.ratio) > -ndtri(0.25 * CHANCE):
            words.append(
                f"{fit.test.names[place]} is not constant: in the last third of the test it differs by "
                f"{100.0 * change.size:+.2g} % from the first third, choose a window"
            )
    return words


def _few_samples(fit: LoopFit) -> list[str]:
    branch = motion(fit.layout, fit.solution.values[places_of(fit.test).displacement :], fit.test.time).branch
    few = float(np.median(np.bincount(branch, minlength=fit.layout.branches)))
    if few >= _FEW:
        return []
    return [f"{few:g} samples between two turning points: at least {_FEW} are needed"]


def _other_speeds(fit: LoopFit) -> list[str]:
    """Where the spring of the contact moves: f' = F g' u'', of which f'/k_t is missing in the speed."""
    values, test = fit.solution.values, fit.test
    at = motion(fit.layout, values[places_of(test).displacement :], test.time)
    slips = modelled_force(test, fit.layout, values).slips
    if not test.factors or not slips.any():
        return []
    speed, acceleration = at.derivatives[1, slips], at.derivatives[2, slips]
    change = values[FRICTION] * factor(element_of(test, values), np.abs(speed))[1] * acceleration
    # at turning points the speed is zero: the usual sample counts
    other = float(np.median(np.abs(change) / (values[STIFFNESS] * np.abs(speed))))
    if other <= _OTHER_SPEED:
        return []
    return [
        f"the contact slips at a speed that differs by {100.0 * other:.2g} % from that of the actuator: "
        "factors belong to the latter"
    ]

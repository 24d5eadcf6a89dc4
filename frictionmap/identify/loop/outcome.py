"""Estimates and errors of a damper test in which the contact slips, or never does."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from ...errors import InputError
from ..statistics.estimates import number, with_error
from ..statistics.least_squares import Errors, Problem, errors, inflation, undetermined
from ..statistics.weights import estimated_weights
from .branches import motion
from .cautions import Channels, cautions, channels
from .fit import Begun, LoopFit, fit_loop, settled
from .held import is_rigid, is_stuck, least_stiffness, stuck_fit
from .problem import (
    ASYMMETRY,
    BACKLASH,
    FRICTION,
    MASS,
    MU,
    NAMES,
    OFFSET,
    SPRING,
    STIFFNESS,
    modelled_force,
    places_of,
)  # fmt: skip
from .static_friction import Static, static_friction
from .verdict import features

#: Singular values of scaled slopes below this share of the largest: not identifiable.
_CONDITION = 1e-6

#: Correlation of mass and parallel stiffness beyond which the error of each is twenty times that with the
#: other one known: acceleration and displacement differ by their noise.
_ALIKE = 0.99875

#: Branches in which the contact must slip.
_SLIPS = 3


class Outcome(NamedTuple):
    """A fit, what is hidden of it, and the intervals that slopes do not give."""

    fit: LoopFit
    errors: Errors
    code: str
    more: dict[str, xr.Variable]
    warnings: list[str]
    values: np.ndarray  # NaN of what the test does not determine


def without_slip(begin: Begun, held: np.ndarray) -> Outcome:
    """The sum of the stiffnesses, and the least friction: half the range of what the contact carries."""
    fit = stuck_fit(begin, held)
    found = _errors(fit, channels(fit))
    values = np.where(np.isnan(held), fit.solution.values[: fit.test.named], held)
    total, error = float(values[STIFFNESS]), float(found.standard_error[STIFFNESS])
    u = motion(fit.layout, fit.solution.values[places_of(fit.test).displacement :], fit.test.time)
    beside = 0.0 if np.isnan(held[SPRING]) else float(held[SPRING])
    half = 0.5 * (total - beside) * float(np.ptp(u.derivatives[0]))
    sure = not np.isnan(held[SPRING])
    unknown = [k for k in (FRICTION, SPRING, BACKLASH, MU, ASYMMETRY, OFFSET) if np.isnan(held[k])]
    unknown += [k for k in range(len(NAMES), fit.test.named) if np.isnan(held[k])]
    if sure and np.isnan(held[STIFFNESS]):
        values[STIFFNESS] = total - beside
        found = _moved(found, STIFFNESS, -beside)
    elif np.isnan(held[STIFFNESS]):
        unknown.append(STIFFNESS)
    for k in unknown:
        lower = half if k == FRICTION and sure else 0.0
        values, found = _bounded(values, found, k, -np.inf if k in (ASYMMETRY, OFFSET) else lower, np.inf)
    more = with_error("stiffness_sum", total, error, "contact_stiffness + parallel_stiffness", "N/mm")
    more["friction_lower"] = number(
        half,
        "half the range of the force in the contact" + ("" if sure else ", if parallel_stiffness is 0"),
        "N",
    )
    words = "the contact never slips" + ("" if sure else ", beside a spring of unknown stiffness")
    return Outcome(fit, found, "no_slip", more | _seen(fit, channels(fit)), [
        f"{words}: friction cannot be determined, contact_stiffness + parallel_stiffness is {total:.5g} "
        f"+- {error:.2g} N/mm (increase the amplitude)"
    ], values)  # fmt: skip


def slipping(begin: Begun, held: np.ndarray, named: list[str]) -> Outcome:
    """The estimates of a test in which the contact slips."""
    fit = fit_loop(begin, held)
    fit = settled(fit.test, fit.layout, fit.problem.free[: fit.test.named], fit.solution)
    if is_stuck(fit, begin, held):
        return without_slip(begin, held)
    static = static_friction(fit) if np.isnan(held[MU]) else None
    _check_slips(fit, held)
    rigid = bool(np.isnan(held[STIFFNESS])) and is_rigid(fit)
    least = least_stiffness(fit) if rigid else None
    if rigid:
        fit = fit._replace(problem=_without(fit, STIFFNESS))
    _check_identifiable(fit, held)
    seen = channels(fit)
    found = _errors(fit, seen)
    _check_frequencies(fit, found)
    values = fit.solution.values[: fit.test.named].copy()
    words = cautions(fit, found, seen, named)
    if least is not None:
        values, found = _bounded(values, found, STIFFNESS, least, np.inf)
        words.append(
            f"the data do not determine contact_stiffness: any value above {least:.3g} N/mm explains them"
        )
    if static is not None:
        values, found = _with_mu(values, found, static)
        if not static.constant:
            words.append("static friction is not the same in all slips: the interval of mu holds all of them")
    code = "rigid" if rigid else features(fit, held, static is not None and static.lower > 1.0)
    return Outcome(fit, found, code, _seen(fit, seen), words, values)


def _with_mu(values: np.ndarray, found: Errors, static: Static) -> tuple[np.ndarray, Errors]:
    return _bounded(values, found, MU, static.lower, static.upper, 0.5 * (static.lower + static.upper))


def _without(fit: LoopFit, index: int) -> Problem:
    free = fit.problem.free.copy()
    free[index] = False
    return fit.problem._replace(free=free)


def _bounded(
    values: np.ndarray, found: Errors, index: int, lower: float, upper: float, value: float = np.nan
) -> tuple[np.ndarray, Errors]:
    """Estimates with an interval, and no standard error, of one of them."""
    parts = [part.copy() for part in (values, found.standard_error, found.lower, found.upper)]
    for part, one in zip(parts, (value, np.nan, lower, upper), strict=True):
        part[index] = one
    return parts[0], found._replace(standard_error=parts[1], lower=parts[2], upper=parts[3])


def _moved(found: Errors, index: int, by: float) -> Errors:
    """Errors with the interval of one parameter moved."""
    lower, upper = found.lower.copy(), found.upper.copy()
    lower[index] += by
    upper[index] += by
    return found._replace(lower=lower, upper=upper)


def _check_slips(fit: LoopFit, held: np.ndarray) -> None:
    """Refuse friction from one or two slips: one in either direction could be the beginning and a drift."""
    slips = int(modelled_force(fit.test, fit.layout, fit.solution.values).broke.sum())
    if np.isnan(held[FRICTION]) and slips < _SLIPS:
        raise InputError(
            f"cannot fit friction: the contact slips in {slips} branches of the motion, {_SLIPS} needed; "
            "measure more cycles, with a larger amplitude"
        )


def _check_identifiable(fit: LoopFit, held: np.ndarray) -> None:
    """Refuse parameters on which no sample depends, or several that all samples depend on alike."""
    unseen = np.isnan(held) & (np.abs(fit.solution.slopes[:, : held.size]).max(axis=0) == 0.0)
    unseen[MU] = False
    for k in np.flatnonzero(unseen):
        raise InputError(
            f"cannot identify {fit.test.names[k]}: not identifiable, no sample depends on it; "
            "remove it from free"
        )
    together, deficient = undetermined(fit.problem, fit.solution, _CONDITION)
    names = [fit.test.names[k] for k in together if k < fit.test.named]
    if deficient and names:
        raise InputError(
            f"cannot identify {' and '.join(names)} together: not identifiable, as the force of this test "
            f"depends on them alike; hold one of them, known.{names[-1]}"
        )


def _check_frequencies(fit: LoopFit, found: Errors) -> None:
    """Refuse mass beside a spring at one frequency: there the acceleration is -w^2 u and noise."""
    alike = float(np.abs(found.correlation[MASS, SPRING]))
    if fit.problem.free[[MASS, SPRING]].all() and alike > _ALIKE:
        raise InputError(
            "cannot identify parallel_stiffness and mass together: not identifiable at one frequency w, "
            "which shows only k_p - m w^2; hold known.mass, or move the damper at a second frequency, too"
        )


def _condition(fit: LoopFit) -> float:
    """Least over largest singular value of the slopes, each over its length."""
    slopes = fit.solution.slopes[:, fit.problem.free]
    sizes = np.linalg.svd(slopes / np.linalg.norm(slopes, axis=0), compute_uv=False)
    return float(sizes[-1] / sizes[0])


def _errors(fit: LoopFit, seen: Channels) -> Errors:
    """Errors of the named parameters; the noise of both channels is estimated."""
    kind = np.repeat((0, 1), fit.test.time.size)
    scaling = estimated_weights(fit.problem, fit.solution, kind, np.ones(2, dtype=bool))
    # of the channel whose residuals are correlated most, in place of that of both in a row
    larger = scaling.larger * max(seen.inflation) / inflation(fit.solution.residual)[1]
    found = errors(fit.problem, fit.solution, 1.0, scaling=scaling._replace(larger=larger))
    named = slice(fit.test.named)
    return found._replace(
        standard_error=found.standard_error[named], lower=found.lower[named], upper=found.upper[named],
        freedom=found.freedom[named], correlation=found.correlation[named, named],
        inflation=max(seen.inflation),
    )  # fmt: skip


def _seen(fit: LoopFit, seen: Channels) -> dict[str, xr.Variable]:
    """Numbers by which the fit can be judged."""
    result = {
        "condition": number(_condition(fit), "least over largest singular value of the scaled slopes"),
        "slips": number(
            float(modelled_force(fit.test, fit.layout, fit.solution.values).broke.sum()),
            "branches of the motion in which the contact slips",
        ),
    }
    for name, lag, square in zip(("motion", "force"), seen.correlation, seen.chi_square, strict=True):
        result[f"residual_correlation_{name}"] = number(lag, f"lag-1 correlation of residuals of the {name}")
        result[f"reduced_chi_square_{name}"] = number(
            square, f"mean square of residuals of the {name} over the variance from sample to sample"
        )
    return result

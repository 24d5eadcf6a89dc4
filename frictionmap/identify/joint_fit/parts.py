"""Decays and records as parts of one fit: each a problem of its own, some of whose parameters are shared.

All parts have f_n, zeta and mu in common; a decay does not depend on mu.  Residuals of a part are divided by
the standard deviation of its noise, which for a record counts the noise near the harmonics of the base, and
the model's own error there, as `signals.noise` has it.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from ..decay.free_decay import free_decay
from ..decay.motion import PARAMETERS as DECAY
from ..decay.motion import Decay, displacement_and_slopes
from ..decay.problem import half_cycles_of, weighted
from ..decay.rounding import rounding_weights
from ..decay.wander import polynomials
from ..parameters import ALIKE
from ..signals.turning_points import noise_level
from ..statistics.least_squares import Problem, Solution
from ..statistics.robust import effective_variance, softened
from ..time_series.data import MeasuredRecord, fit_clipped, measured_record, whole_record
from ..time_series.fit import RecordFit, noise_of_record, problem_of
from ..time_series.motion import PARAMETERS

#: What all parts share, in this order; (mu - 1)^2 stands for mu in the fit.
SHARED = ("f_n", "zeta", "mu")

#: The natural frequency lies within this factor of that of a decay alone.
_RANGE = 1.5


class Part(NamedTuple):
    """A decay or a record, as a part of a joint fit."""

    label: str
    names: tuple[str, ...]  # of its parameters; further ones belong to drift and wander
    problem: Problem  # in its own parameters
    start: np.ndarray
    sigma: float  # standard deviation of the noise by which its residuals are divided
    freedom: int  # degrees of freedom by which that is known
    model_error: float
    record: MeasuredRecord | None  # None: a decay
    fit: RecordFit | None  # of the record alone, with what all share held
    time: np.ndarray  # s, of the samples
    data: np.ndarray
    decay: xr.Dataset | None
    plain: Callable[[np.ndarray], np.ndarray] | None = None  # of a decay: fitted less measured

    @property
    def own(self) -> list[int]:
        """Places of the parameters that are not shared."""
        return [k for k in range(self.start.size) if k >= len(self.names) or self.names[k] not in SHARED]


def decay_part(label: str, time: object, x: object, unit: str, known: Mapping[str, float], loss: str) -> Part:
    """A decay, fitted alone to begin with."""
    held = {name: value for name, value in known.items() if name != "mu"}
    ds = free_decay(time, x, unit=unit, known=held, loss=loss)  # type: ignore[arg-type]
    times, data = ds["time"].values, ds["data"].values
    start = ds["estimate"].values[: len(DECAY)].astype(float)
    rest = half_cycles_of(ds)
    terms = int(ds["wander_terms"]) if "wander_terms" in ds else 0
    slow = polynomials(times, DECAY, terms)
    waves = np.full(terms, np.inf)

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        inside = values[: len(DECAY)].copy()
        inside[1:3] = np.maximum(inside[1:3], 0.0)  # below zero the places go on as a straight line
        places, slopes = displacement_and_slopes(Decay(*inside), rest, times)
        places = places + slopes @ (values[: len(DECAY)] - inside) + slow @ values[len(DECAY) :]
        return places - data, np.hstack((slopes, slow))

    free = np.array([name not in held for name in DECAY] + [True] * terms)
    floor = np.concatenate(([-np.inf, 0.0, 0.0, -np.inf, -np.inf, -np.inf], -waves))
    lowest = np.concatenate(([start[0] / _RANGE, -0.5, -np.inf, -np.inf, -np.inf, -np.inf], -waves))
    highest = np.concatenate(([start[0] * _RANGE, 0.99, np.inf, np.inf, np.inf, np.inf], waves))
    weights = rounding_weights(data, ds["model"].values)
    problem = weighted(Problem(residuals, free, floor, lowest, highest), weights)
    sigma, level = float(ds["sigma"].values[0]), noise_level(data)
    values = np.concatenate((start, np.zeros(terms)))
    if loss == "soft_l1" and level > 0.0:
        at = Solution(values, *problem.residuals(values), np.zeros(values.size, dtype=bool))
        sigma = float(np.sqrt(effective_variance(problem, at, level)))
        problem = softened(problem, level)
    return Part(
        label, DECAY, problem, values, sigma * float(ds["error_inflation"]), times.size - values.size, 1.0,
        None, None, times, data, ds, lambda values: residuals(values)[0],
    )  # fmt: skip


def record_part(
    label: str, arrays: Sequence[object], contact: str, reference: str, known: Mapping[str, float], loss: str
) -> Part:
    """A record, first fitted alone with the known parameters held and mu = 1."""
    robust = loss == "soft_l1"
    time, base, x = arrays
    given = measured_record(time, base, x, None, robust)
    return _of_record(label, given, contact, reference, known, known)


def with_shared(part: Part, shared: Mapping[str, float], known: Mapping[str, float]) -> Part:
    """Fit a record again with other values of f_n and zeta; return a decay unchanged."""
    if part.record is None or part.fit is None:
        return part
    mass = part.fit.mass
    return _of_record(
        part.label, part.record, mass.contact, mass.damping_reference, known, {**known, **shared}
    )


def _of_record(
    label: str,
    given: MeasuredRecord,
    contact: str,
    reference: str,
    known: Mapping[str, float],
    held: Mapping[str, float],
) -> Part:
    robust = given.samples.scale is not None
    given, fit = fit_clipped(contact, reference, given, {"mu": 1.0, **ALIKE, **held}, robust)
    problem = problem_of(fit, {**ALIKE, **known})
    part = Part(
        label, PARAMETERS, problem, fit.solution.values, 1.0, 1, 1.0, given, fit, given.samples.time,
        given.samples.x, None,
    )  # fmt: skip
    return measured_again(part, fit.solution.values)


def measured_again(part: Part, values: np.ndarray) -> Part:
    """The part with the noise that its residuals show at some values of its parameters."""
    residual, slopes = part.problem.residuals(values)
    if part.record is None or part.fit is None:
        return part
    at = part.fit.solution._replace(values=values, residual=residual, slopes=slopes)
    noise, model_error = noise_of_record(part.record.phasors, part.fit.samples, part.problem, at)
    levels = np.sqrt(1.0 + np.sum(noise.excess**2, axis=0))
    sigma = np.sqrt(noise.variance) * float(levels.max(initial=1.0))
    return part._replace(sigma=float(sigma), freedom=noise.freedom, model_error=model_error)


def whole_of(part: Part, loss: str) -> MeasuredRecord:
    """The record of a part, its clipped samples filled."""
    assert part.record is not None
    assert part.fit is not None
    return whole_record(part.record, part.fit, loss == "soft_l1")

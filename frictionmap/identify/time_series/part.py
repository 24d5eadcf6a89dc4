"""A record of steady motion as a part of a joint fit.

Its noise counts that near the harmonics of the base, and the model's own error there, as `signals.noise` has
it: a record that the model does not explain counts by its residual at the harmonics.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from ..parameters import ALIKE
from ..part import Part, Settings
from ..statistics.estimates import number
from .data import MeasuredRecord, fit_clipped, measured_record, whole_record
from .fit import RecordFit, noise_of_record, problem_of
from .labels import data_warnings, record_variables
from .motion import PARAMETERS, X_F, Motion, motion, outer


@dataclass(frozen=True, kw_only=True)
class RecordPart(Part):
    """A record, fitted alone with what all parts share held."""

    given: MeasuredRecord
    fit: RecordFit

    @property
    def leads(self) -> bool:
        """A record alone determines f_n and zeta less well than a decay."""
        return False

    def with_shared(self, shared: Mapping[str, float], known: Mapping[str, float]) -> Part:
        """The record, fitted alone again with other values of f_n and zeta."""
        mass = self.fit.mass
        return _fitted(
            self.label, self.given, (mass.contact, mass.damping_reference), known, {**known, **shared}
        )

    def measured_again(self, values: np.ndarray) -> Part:
        """The part with the noise that its residuals show at some values."""
        residual, slopes = self.problem.residuals(values)
        at = self.fit.solution._replace(values=values, residual=residual, slopes=slopes)
        noise, model_error = noise_of_record(self.given.phasors, self.fit.samples, self.problem, at)
        levels = np.sqrt(1.0 + np.sum(noise.excess**2, axis=0))
        sigma = np.sqrt(noise.variance) * float(levels.max(initial=1.0))
        return replace(self, sigma=float(sigma), freedom=noise.freedom, model_error=model_error)

    def _motion(self, values: np.ndarray) -> Motion:
        return motion(self.fit.mass, outer(values[: len(PARAMETERS)]))

    def residual(self, values: np.ndarray) -> np.ndarray:
        """Fitted less measured: those of the problem are whitened."""
        return self._motion(values).places + self.fit.samples.slow @ values[len(PARAMETERS) :] - self.data

    def stops(self, values: np.ndarray) -> int:
        """Stops per cycle."""
        return self._motion(values).stops

    def data_warnings(self, unit: str) -> list[str]:
        """Warnings about the record, its clipped samples filled."""
        given = whole_record(self.given, self.fit)
        return data_warnings(given, xr.Dataset(record_variables(given, unit)))

    def variables(self, values: np.ndarray) -> dict[str, xr.Variable]:
        """Friction ratio, stops, and the frequency of the base."""
        phasors = whole_record(self.given, self.fit).phasors
        base = float(abs(phasors.values[0, 1]))
        return {
            "beta": number(float(values[X_F]) / base, f"friction ratio, {self.label}"),
            "stops_per_cycle": number(self.stops(values), f"stops per cycle, {self.label}"),
            "base_frequency": number(phasors.frequency, f"frequency of the base, {self.label}", "Hz"),
        }


def record_part(label: str, arrays: Sequence[object], settings: Settings) -> Part:
    """A record, first fitted alone with the known parameters held and mu = 1."""
    time, base, x = arrays
    given = measured_record(time, base, x, None, settings.loss == "soft_l1")
    rig = settings.contact, settings.damping_reference
    return _fitted(label, given, rig, settings.known, settings.known)


def _fitted(
    label: str,
    given: MeasuredRecord,
    rig: tuple[str, str],
    known: Mapping[str, float],
    held: Mapping[str, float],
) -> Part:
    given, fit = fit_clipped(*rig, given, {"mu": 1.0, **ALIKE, **held})
    problem = problem_of(fit, {**ALIKE, **known})
    part = RecordPart(
        label, PARAMETERS, problem, fit.solution.values, 1.0, 1, given.samples.time, given.samples.x,
        problem.residuals, given=given, fit=fit,
    )  # fmt: skip
    return part.measured_again(fit.solution.values)

"""Least squares of a measured record on the exact decay, perhaps with a drifting or wandering zero."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.polynomial import legendre

from ..statistics.least_squares import Problem
from ..statistics.robust import soften
from .electronics import sensor_in
from .measured import measured_and_slopes
from .motion import PARAMETERS, Decay, displacement_and_slopes
from .sensor import Sensor

#: The measured place of the centre may change by so much a second.
DRIFT = "drift"

#: What a sensor shows of a mass at rest takes the place of the centre, which such a sensor does not show.
OFFSET = "offset"

#: In these the motion is linear.
_LINEAR = ("x_F", "X0", "centre", OFFSET, DRIFT)

F_N, ZETA, X_F = (PARAMETERS.index(name) for name in ("f_n", "zeta", "x_F"))

#: Half cycles of a decay that does not come to rest within any record.
_NO_REST = 2

#: The natural frequency is within this share of where a fit starts, which is what the turning points give.
_FREQUENCY_RANGE = 0.2

#: Ranges in which the model holds; beyond 1 there are no turning points.
_ZETA_RANGE = (-0.5, 0.99)


class Record(NamedTuple):
    """Measured decay, and the parameters to be fitted."""

    time: np.ndarray  # s
    x: np.ndarray
    known: Mapping[str, float]  # parameters that are held
    names: tuple[str, ...]  # of all parameters: those of a decay, and perhaps the drift
    outliers: float | None = None  # residuals beyond this have little weight
    wander: np.ndarray | None = (
        None  # shape (samples, terms): slow functions of time that the zero may follow
    )
    weights: np.ndarray | None = None  # (samples,) of the residuals, below 1 where rounding errors are alike
    sensor: Sensor | None = None  # None: displacements as they are
    transients: np.ndarray | None = None  # shape (samples, states): of the filters of the sensor
    may_fall: bool = False  # whether zeta may be negative: friction that falls with the speed takes from it

    def thinned(self, most: int) -> "Record":
        """The record with no more samples than `most`, or a few."""
        every = max(1, self.time.size // most)
        wander = None if self.wander is None else self.wander[::every]
        weights = None if self.weights is None else self.weights[::every]
        transients = None if self.transients is None else self.transients[::every]
        return self._replace(
            time=self.time[::every], x=self.x[::every], wander=wander, weights=weights, transients=transients
        )

    @property
    def counted(self) -> float:
        """Number of samples, each by the square of its weight."""
        return float(self.time.size if self.weights is None else self.weights @ self.weights)

    @property
    def unweighted(self) -> np.ndarray:
        """Samples that have their full weight, bool (samples,)."""
        return np.ones(self.time.size, dtype=bool) if self.weights is None else self.weights == 1.0

    @property
    def steady(self) -> int:
        """Unknowns without a wander: the named ones, and states of filters at the first sample."""
        return len(self.names) + (0 if self.transients is None else self.transients.shape[1])

    @property
    def terms(self) -> int:
        """Unknowns after these: the terms of the wander."""
        return 0 if self.wander is None else self.wander.shape[1]

    @property
    def free(self) -> np.ndarray:
        """Unknowns that are fitted, bool (unknowns,)."""
        named = [name not in self.known for name in self.names]
        return np.array(named + [True] * (self.steady - len(named) + self.terms))

    @property
    def linear(self) -> np.ndarray:
        """Unknowns in which the motion is linear, bool (unknowns,)."""
        further = np.ones(self.steady - len(self.names) + self.terms, dtype=bool)
        return np.concatenate((np.isin(self.names, _LINEAR), further))


def record_of(ds: xr.Dataset, names: tuple[str, ...]) -> tuple[Record, int, np.ndarray]:
    """The record of a decay that was fitted, the turning point with which it ends, and all unknowns.

    A record that does not show the place of rest ends with a turning point beyond it.
    """
    named = ds.sel(parameter=list(names))
    values, held = named["estimate"].values.astype(float), named["known"].values == 1
    known = {name: float(value) for name, value, is_held in zip(names, values, held, strict=True) if is_held}
    terms = int(ds["wander_terms"]) if "wander_terms" in ds else 0
    wander = polynomials(ds["time"].values, names, terms) if terms else None
    time = ds["time"].values
    sensor = sensor_in(ds)
    transients = None if sensor is None else sensor.transients(time)
    record = Record(
        time, ds["data"].values, known, names, wander=wander, sensor=sensor, transients=transients
    )
    n = int(ds["half_cycles"]) + (0 if int(ds["at_rest"]) else _NO_REST)
    return record, n, np.concatenate((values, np.zeros(record.free.size - values.size)))


def polynomials(time: np.ndarray, names: Sequence[str], terms: int) -> np.ndarray:
    """Legendre polynomials over a record, shape (samples, terms), above the degree of the named unknowns."""
    lowest = 2 if DRIFT in names else 1
    scaled = 2.0 * (time - time[0]) / np.ptp(time) - 1.0
    return legendre.legvander(scaled, lowest + terms - 1)[:, lowest:]


def model(record: Record, n: int, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What is measured of a decay that ends at turning point `n`, and its slopes by all unknowns."""
    decay, sensor = Decay(*values[: len(PARAMETERS)]), record.sensor
    if sensor is None:
        place, slopes = displacement_and_slopes(decay, n, record.time)
    else:
        place, slopes = measured_and_slopes(sensor, decay, n, record.time)
    further = [slopes]
    if len(record.names) > len(PARAMETERS):
        further.append(record.time[:, np.newaxis])
    if record.transients is not None:
        further.append(record.transients)
    if record.wander is not None:
        further.append(record.wander)
    slopes = np.concatenate(further, axis=1) if len(further) > 1 else slopes
    return place + slopes[:, len(PARAMETERS) :] @ values[len(PARAMETERS) :], slopes


def problem(record: Record, n: int, start: np.ndarray) -> Problem:
    """Least squares of all samples on a decay that ends at turning point `n`; outliers have little weight."""
    full = weighted_problem(record, n, start)
    return full if record.outliers is None else soften(full, record.outliers)


def weighted_problem(record: Record, n: int, start: np.ndarray) -> Problem:
    """The same with the full weight of outliers."""
    return weighted(plain_problem(record, n, start), record.weights)


def weighted(plain: Problem, weights: np.ndarray | None) -> Problem:
    """A problem with these weights of its residuals."""
    if weights is None:
        return plain

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, slopes = plain.residuals(values)
        return weights * residual, weights[:, np.newaxis] * slopes

    return plain._replace(residuals=residuals)


def plain_problem(record: Record, n: int, start: np.ndarray) -> Problem:
    """Least squares of all samples on a decay that ends at turning point `n`, each with its full weight."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place, slopes = model(record, n, values)
        return place - record.x, slopes

    lowest, highest = np.full(start.size, -np.inf), np.full(start.size, np.inf)
    lowest[0], highest[0] = start[0] * (1.0 - _FREQUENCY_RANGE), start[0] * (1.0 + _FREQUENCY_RANGE)
    lowest[ZETA], highest[ZETA] = _ZETA_RANGE
    floor = np.full(start.size, -np.inf)
    floor[[ZETA, X_F]] = _ZETA_RANGE[0] if record.may_fall else 0.0, 0.0
    return Problem(residuals, record.free, floor, lowest, highest)

"""Noise of a record near its harmonics: slow wander of the zero, and levels by which errors grow.

A steady motion repeats, so all information about it is at multiples of the base's frequency.  The errors
depend on the noise near these lines, not on its correlation from one sample to the next.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from ...errors import InputError
from ..statistics.least_squares import Noise
from ..statistics.levels import CHANCE

#: What a right model leaves at the harmonics exceeds the noise beside them this rarely.
_CHANCE_OF_MODEL = 1e-5

#: Slow waves that a wandering zero is made of, at most; half a period of the first is the record's length.
_MOST_WAVES = 40

#: Lines nearer to a harmonic than this share of 1/length were taken out with it.
_TAKEN_OUT = 0.9


class Levels(NamedTuple):
    """Standard deviations near each harmonic, over that of a sample; all 1 of white noise."""

    of_harmonic: np.ndarray  # shape (H + 1,), >= 1
    freedom: int  # degrees of freedom of the least well known of them; 0: of all samples


class AtHarmonics(NamedTuple):
    """Directions of the harmonics among samples, and the noise beside them."""

    columns: np.ndarray  # shape (samples, 1 + 2 H), orthonormal: a constant, then two parts of each harmonic
    variance: float  # of a sample
    levels: Levels

    def over_noise(self, values: np.ndarray) -> np.ndarray:
        """Parts of residuals or slopes along the columns, over the noise there, shape (1 + 2 H, ...)."""
        level = self.levels.of_harmonic
        sizes = np.sqrt(self.variance) * np.concatenate((level[:1], np.repeat(level[1:], 2)))
        return ((self.columns.T @ values).T / sizes).T

    def square(self, residual: np.ndarray) -> float:
        """Chi square of residuals at the harmonics, without the constant; 0 if there is no noise."""
        return float(np.sum(self.over_noise(residual)[1:] ** 2)) if self.variance > 0.0 else 0.0


def orthonormal(columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Q and the inverse of R: twice by Cholesky's decomposition, exact to rounding while columns differ.

    Three products of matrices; LAPACK's decomposition of tall matrices waits for its threads at every column.
    """
    orthogonal, inverse = columns, np.eye(columns.shape[1])
    for _ in range(2):
        try:
            triangle = np.linalg.cholesky(orthogonal.T @ orthogonal).T
        except np.linalg.LinAlgError:
            raise InputError(
                "cannot determine harmonics of the base: a gap in time makes some of them "
                "indistinguishable; choose a window without it"
            ) from None
        step = np.linalg.inv(triangle)
        orthogonal, inverse = orthogonal @ step, inverse @ step
    return orthogonal, inverse


def slow_waves(time: np.ndarray, frequency: float) -> np.ndarray:
    """Orthonormal waves below half the base's frequency without mean and drift, shape (samples, waves).

    They have nearly no part in a motion that repeats with the base: a parabola, a cubic, and cosines of whole
    half periods, which then leave little of a smooth wander that does not end where it began.  Gaps are
    shorter than half a period of any.
    """
    length = float(time[-1] - time[0])
    bridged = int(length / float(np.diff(time).max()))  # half periods as long as the longest gap
    count = max(min(int(np.ceil(length * frequency)) - 1, _MOST_WAVES, bridged), 0)
    angle = np.pi * (time - time[0]) / length
    waves = np.cos(np.multiply.outer(angle, np.arange(1, count + 1)))
    powers = (2.0 * angle[:, None] / np.pi - 1.0) ** np.arange(min(4, 2 + count))
    return orthonormal(np.hstack((powers, waves)))[0][:, 2:]


def wanders(residual: np.ndarray, waves: np.ndarray) -> bool:
    """Whether there is more in the slow waves than in white noise; a linear drift has been taken out."""
    parts = waves.T @ residual
    if not parts.size:
        return False
    rest = float(residual @ residual - parts @ parts) / (residual.size - parts.size)
    return rest > 0.0 and bool(chdtrc(parts.size, float(parts @ parts) / rest) < CHANCE)


def noise_levels(time: np.ndarray, residual: np.ndarray, frequency: float, harmonics: int) -> Levels:
    """Levels of the residual after harmonics, drift and wander are removed."""
    level = np.ones(harmonics + 1)
    white = float(residual @ residual) / residual.size
    if white == 0.0:
        return Levels(level, 0)
    freedom = 0
    lines, power = _spectrum(time, residual)
    cycles = lines / frequency
    nearest = np.abs(cycles - np.round(cycles)) * frequency * float(time[-1] - time[0])
    counts = (cycles > 0.5) & (cycles < harmonics + 0.5) & (nearest > _TAKEN_OUT)
    cycles, power = cycles[counts], power[counts] / white
    if power.size and chdtrc(2 * power.size, 2.0 * float(power.sum())) < CHANCE:
        around = [power[np.abs(cycles - n) < 1.0] for n in range(1, harmonics + 1)]
        level[1:] = [np.sqrt(max(_typical(one), 1.0)) if one.size else 1.0 for one in around]
        freedom = 2 * min(one.size for one in around if one.size)
        level[0] = level[1]
    return Levels(level, freedom)


def _typical(power: np.ndarray) -> float:
    """Mean of a spectrum that may be steep: the geometric one, in which chance is low by Euler's constant."""
    return float(np.exp(np.mean(np.log(power)) + np.euler_gamma))


def at_harmonics(
    time: np.ndarray, residual: np.ndarray, frequency: float, harmonics: int, waves: int
) -> AtHarmonics:
    """Residuals at the harmonics, and the noise near them.

    residual : shape (samples,), of the fit, drift and wander taken out
    waves : how many slow waves were fitted beside the drift
    """
    columns = harmonic_columns(time, frequency, harmonics)
    rest = residual - columns @ (columns.T @ residual)
    variance = float(rest @ rest) / (rest.size - columns.shape[1] - waves - 1)
    return AtHarmonics(columns, variance, noise_levels(time, rest, frequency, harmonics))


def noise_of_fit(
    time: np.ndarray,
    residual: np.ndarray,
    frequency: float,
    harmonics: int,
    unknowns: int,
    waves: int,
) -> tuple[Noise, float]:
    """The noise by which a steady motion was fitted, larger near some harmonics, and the model's error in it.

    What a fit leaves at the harmonics beyond the noise beside them is the model's own error: then the noise
    counts as so much larger.

    residual : shape (samples,), of the fit, drift and wander taken out
    unknowns : fitted parameters, without a constant, drift and wander
    waves : how many slow waves were fitted beside the drift
    """
    lines = at_harmonics(time, residual, frequency, harmonics, waves)
    columns, variance, levels = lines
    freedom = 2 * harmonics - unknowns
    square = lines.square(residual)
    wrong = is_wrong(square, freedom)
    model_error = float(np.sqrt(square / freedom)) if wrong else 1.0
    growth = levels.of_harmonic * model_error
    few = [count for count in (levels.freedom, freedom if wrong else 0) if count]
    if (growth == 1.0).all():  # white: all samples determine its variance
        freedom = residual.size - unknowns - 2 - waves
        return Noise(float(residual @ residual) / freedom, columns[:, :0], freedom), 1.0
    excess = np.sqrt(growth**2 - 1.0)
    by_column = np.concatenate((excess[:1], np.repeat(excess[1:], 2)))
    return Noise(variance, columns * by_column, min(few, default=residual.size - unknowns)), model_error


def is_wrong(square: float, freedom: int) -> bool:
    """Whether a model leaves more at the harmonics than noise does.

    square : of all parts of the harmonics, over the noise
    """
    return freedom > 0 and bool(chdtrc(freedom, square) < _CHANCE_OF_MODEL)


def harmonic_columns(time: np.ndarray, frequency: float, harmonics: int) -> np.ndarray:
    """A constant and the two parts of each harmonic, orthonormal, shape (samples, 1 + 2 H)."""
    turn = np.multiply.outer(2.0 * np.pi * frequency * (time - time[0]), np.arange(1, harmonics + 1))
    pairs = np.stack((np.cos(turn), np.sin(turn)), axis=-1).reshape(time.size, -1)
    return orthonormal(np.column_stack((np.ones(time.size), pairs)))[0]


def _spectrum(time: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz], and mean squares of the two parts of residuals along each, over waves of norm 1.

    Residuals are put on equal steps, gaps with zeros.
    """
    step = float(np.median(np.diff(time)))
    places = np.round((time - time[0]) / step).astype(int)
    even = np.zeros(places[-1] + 1)
    np.add.at(even, places, residual)
    return np.fft.rfftfreq(even.size, step), np.abs(np.fft.rfft(even)) ** 2 / residual.size

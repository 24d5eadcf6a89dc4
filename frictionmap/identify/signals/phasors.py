"""Phasors of a record: all channels on harmonics of one frequency, by least squares.

    channel k:   a_k + b_k (t - t_m) + Re sum_n X_kn e^{i n omega (t - t_m)},   n = 1 .. H

Where the zero of a channel wanders, slow waves below omega/2 are fitted with them.

The frequency is the one unknown that is not linear, and all channels share it.  No window is needed, nor
whole cycles.  t_m is the middle of the record.
"""

from typing import NamedTuple

import numpy as np

from ...errors import InputError
from .noise import noise_levels, orthonormal, slow_waves, wanders

#: Harmonics, fewer where the highest one would have fewer samples per cycle than this.
_HARMONICS = 9
SAMPLES_OF_HIGHEST = 2.5

#: Cycles that a record must have.
_LEAST_CYCLES = 2.0

#: Least number of samples per cycle.
_LEAST_SAMPLES = 8

#: Number of values over the main lobe by which the spectrum is refined.
_REFINED = 17

#: Samples that the search uses, in total and per cycle.
_SAMPLES = 4000
_SAMPLES_PER_CYCLE = 16

#: Standard deviations beyond which a sample is an outlier; number of fits in which outliers are limited.
_OUTLIER, _ROUNDS = 3.0, 5

#: Median of the modulus of a normal deviate, in standard deviations.
_MEDIAN = 0.6744897501960817

#: The frequency is found where it moves by less than this share of 1/length.
_SETTLED = 1e-10
_MAX_STEPS = 50


class Phasors(NamedTuple):
    """Harmonics of several channels."""

    frequency: float  # Hz
    frequency_error: float  # standard errors, here and below
    middle: float  # s, where phases count from
    values: np.ndarray  # shape (channels, H + 1), complex; harmonic 0 is the mean at `middle`
    errors: np.ndarray  # shape (channels, H + 1), of the real and of the imaginary part at this frequency
    drift: np.ndarray  # shape (channels,), a second
    drift_errors: np.ndarray
    slopes: np.ndarray  # shape (channels, H + 1), derivatives of the values by the frequency
    residual: np.ndarray  # shape (samples, channels): data less harmonics, drift and wander
    inflation: np.ndarray  # shape (channels, H + 1), of the errors, as the noise is not white
    waves: np.ndarray  # shape (samples, waves), by which zeros wander; none where they do not
    wander: np.ndarray  # shape (samples, channels), what they make

    @property
    def rms(self) -> np.ndarray:
        """Root mean squares of the residuals, shape (channels,)."""
        return np.sqrt(np.mean(self.residual**2, axis=0))


class _Linear(NamedTuple):
    """The least squares at one frequency."""

    coefficients: np.ndarray  # shape (columns, channels)
    residual: np.ndarray  # shape (samples, channels)
    inverse: np.ndarray  # of the triangle R of the columns, Q R
    turned: np.ndarray  # shape (columns, channels): derivatives of the coefficients by the frequency
    curve: np.ndarray  # shape (samples, channels): derivatives of the residual, the coefficients following


def phasors_of(time: np.ndarray, channels: np.ndarray) -> Phasors:
    """Fit harmonics of one frequency to all channels; the first channel gives the initial frequency.

    Zeros that wander are fitted with slow waves, if there is more in the residuals than white noise has.

    time : shape (samples,), s, increasing
    channels : shape (samples, channels)

    Raises
    ------
    InputError
        There are too few samples per cycle, too few cycles, or too few samples in all.
    """
    middle = 0.5 * (time[0] + time[-1])
    t = time - middle
    start = _coarse_frequency(t, channels[:, 0])
    harmonics = _checked_harmonics(t, start)
    few = slice(None, None, _stride(t, start))
    near = _refine(t[few], channels[few], start, 1)[0] if few.step > 1 else start
    f, fit = _refine(t, channels, near, harmonics)
    waves = slow_waves(t, f)
    if any(wanders(residual, waves) for residual in fit.residual.T):
        f, fit = _refine(t, channels, f, harmonics, waves)
    else:
        waves = waves[:, :0]
    return _with_errors(t, f, fit, harmonics, waves)._replace(middle=float(middle))


def robust_phasors(time: np.ndarray, channels: np.ndarray) -> tuple[Phasors, np.ndarray]:
    """Fit harmonics to channels with outliers; also return the channels with outliers limited.

    A sample farther from the harmonics than three standard deviations is moved to that distance.
    """
    winsorised = channels
    for _ in range(_ROUNDS):
        found = phasors_of(time, winsorised)
        model = winsorised - found.residual
        residual = channels - model
        limit = _OUTLIER * scatter_of(residual)
        winsorised = model + np.clip(residual, -limit, limit)
    return phasors_of(time, winsorised), winsorised


def harmonics_of(time: np.ndarray, channels: np.ndarray, robust: bool) -> tuple[Phasors, np.ndarray]:
    """Harmonics of channels that may have outliers, and the channels without."""
    return robust_phasors(time, channels) if robust else (phasors_of(time, channels), channels)


def scatter_of(residual: np.ndarray) -> np.ndarray:
    """Standard deviations regardless of outliers, shape (channels,): from medians of distances."""
    return np.median(np.abs(residual), axis=0) / _MEDIAN


def harmonics_at(values: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Re sum_n X_n e^{i n angle} of one channel, harmonic 0 included."""
    turn = np.exp(1j * angle)
    total = np.zeros(np.shape(angle), dtype=complex)
    for value in values[::-1]:
        total = total * turn + value
    return total.real


def amplitude_and_lag(phasors: Phasors, n: int = 1) -> tuple[float, float]:
    """|X_n/Y_n| and the lag -arg(X_n/Y_n) [rad] of the second channel behind the first."""
    ratio = phasors.values[1, n] / phasors.values[0, n]
    return float(abs(ratio)), float(-np.angle(ratio))


def ratio_error(phasors: Phasors) -> float:
    """Standard error of X_1/Y_1, relative: of its logarithm's real part, and of its angle [rad]."""
    own = phasors.errors[:, 1] / np.abs(phasors.values[:, 1])
    turn = phasors.slopes[:, 1] / phasors.values[:, 1]
    shared = abs(turn[1] - turn[0]) * phasors.frequency_error
    return float(np.sqrt(np.sum(own**2) + shared**2))


def changes(time: np.ndarray, channels: np.ndarray, whole: Phasors) -> np.ndarray:
    """Squared change of X_1 from the first to the last third of the record, over its variance, by channel.

    It is 2 on average for a steady motion.  Empty if a third is shorter than a cycle.
    """
    third = (time[-1] - time[0]) / 3.0
    if third * whole.frequency < 1.0:
        return np.zeros(0)
    parts = (time <= time[0] + third, time >= time[-1] - third)
    if min(int(part.sum()) for part in parts) <= 2 * whole.values.shape[1] + 1:
        return np.zeros(0)  # a gap has taken one of them
    harmonics = whole.values.shape[1] - 1
    settled = channels - whole.wander
    fits = [_linear(time[part] - whole.middle, settled[part], whole.frequency, harmonics) for part in parts]
    first = [_complex(fit.coefficients, harmonics)[:, 1] for fit in fits]
    variance = sum((_first_error(fit) * whole.inflation[:, 1]) ** 2 for fit in fits)
    return np.abs(first[0] - first[1]) ** 2 / variance


def first_harmonics(time: np.ndarray, channels: np.ndarray, whole: Phasors) -> np.ndarray:
    """X_1 of other channels at the same frequency, shape (channels,)."""
    harmonics = whole.values.shape[1] - 1
    fit = _linear(time - whole.middle, channels, whole.frequency, harmonics)
    return _complex(fit.coefficients, harmonics)[:, 1]


def _first_error(fit: _Linear) -> np.ndarray:
    """Standard errors of the real part of X_1."""
    rows, columns = fit.residual.shape[0], fit.coefficients.shape[0]
    scatter = np.sqrt(np.sum(fit.residual**2, axis=0) / (rows - columns))
    return scatter * float(np.linalg.norm(fit.inverse[2]))


def _coarse_frequency(t: np.ndarray, base: np.ndarray) -> float:
    """The frequency with the largest line: from the spectrum, refined by least squares of one harmonic."""
    length = float(t[-1] - t[0])
    even = np.linspace(t[0], t[-1], t.size)
    values = np.interp(even, t, base)
    values = values - np.polynomial.Polynomial.fit(even, values, 1)(even)
    size = 4 * t.size
    spectrum = np.abs(np.fft.rfft(values * np.hanning(t.size), size))
    step = (t.size - 1) / (length * size)
    peak = step * max(int(np.argmax(spectrum[1:])) + 1, 1)
    near = peak + np.linspace(-1.0, 1.0, _REFINED) / length
    near = near[near > 0.5 / length]
    if not near.size:
        return peak
    few = slice(None, None, _stride(t, peak))
    sums = [float(np.sum(_linear(t[few], base[few, None], float(f), 1).residual ** 2)) for f in near]
    return float(near[int(np.argmin(sums))])


def _checked_harmonics(t: np.ndarray, frequency: float) -> int:
    """Number of harmonics that the samples resolve."""
    length = float(t[-1] - t[0])
    cycles = length * frequency
    if cycles < _LEAST_CYCLES:
        raise InputError(
            f"time must span at least {_LEAST_CYCLES:g} cycles of the base; "
            f"got {cycles:.2g} ({length:.4g} s at {frequency:.4g} Hz)"
        )
    samples = 1.0 / (float(np.median(np.diff(t))) * frequency)
    if samples < _LEAST_SAMPLES:
        raise InputError(
            f"cannot fit harmonics: sampling rate too low, {samples:.2g} samples per cycle, "
            f"{_LEAST_SAMPLES} needed; sample faster"
        )
    harmonics = min(_HARMONICS, int(samples / SAMPLES_OF_HIGHEST))
    unknowns = 2 * harmonics + 3
    if t.size <= unknowns:
        raise InputError(f"time must have more samples than unknowns, {unknowns}; got {t.size}")
    return harmonics


def _stride(t: np.ndarray, frequency: float) -> int:
    """Stride of samples sufficient for initial values: enough per cycle, and enough in all."""
    per_cycle = 1.0 / (float(np.median(np.diff(t))) * frequency)
    return max(1, min(t.size // _SAMPLES, int(per_cycle / _SAMPLES_PER_CYCLE)))


def _refine(
    t: np.ndarray, channels: np.ndarray, start: float, harmonics: int, waves: np.ndarray | None = None
) -> tuple[float, _Linear]:
    """Gauss-Newton for the frequency, channels weighted by their own residuals."""
    length = float(t[-1] - t[0])
    f = start
    fit = _linear(t, channels, f, harmonics, waves)
    for _ in range(_MAX_STEPS):
        scatter = _scatter(fit)
        weighted, curve = fit.residual / scatter, fit.curve / scatter
        step = -float(np.sum(curve * weighted)) / float(np.sum(curve**2))
        f += step
        fit = _linear(t, channels, f, harmonics, waves)
        if abs(step) * length < _SETTLED:
            break
    return f, fit


def _with_errors(t: np.ndarray, f: float, fit: _Linear, harmonics: int, waves: np.ndarray) -> Phasors:
    scatter, rows = _scatter(fit), slice(2, 2 + 2 * harmonics)
    parts = fit.coefficients[rows.stop :]
    grown = np.array([noise_levels(t, residual, f, harmonics).of_harmonic for residual in fit.residual.T])
    information = np.sum((fit.curve / (scatter * grown[:, 1])) ** 2)
    own = np.linalg.norm(fit.inverse, axis=1)[:, None] * scatter
    of_parts = own[rows].reshape(harmonics, 2, -1)
    errors = np.vstack((own[:1], np.sqrt(0.5 * np.sum(of_parts**2, axis=1)))).T * grown
    frequency_error = float(1.0 / np.sqrt(information))
    drift_errors = np.hypot(own[1] * grown[:, 0], fit.turned[1] * frequency_error)
    return Phasors(
        float(f), frequency_error, 0.0, _complex(fit.coefficients, harmonics), errors, fit.coefficients[1],
        drift_errors, _complex(fit.turned, harmonics), fit.residual, grown, waves, waves @ parts,
    )  # fmt: skip


def _scatter(fit: _Linear) -> np.ndarray:
    """Standard deviations of the residuals; of exact data their rounding, or weights were infinite."""
    rows, columns = fit.residual.shape[0], fit.coefficients.shape[0]
    found = np.sqrt(np.sum(fit.residual**2, axis=0) / (rows - columns - 1))
    return np.maximum(found, np.finfo(float).eps * np.abs(fit.coefficients).max(axis=0))


def _complex(coefficients: np.ndarray, harmonics: int) -> np.ndarray:
    """Rows a, b, Re X_1, -Im X_1, ... as complex harmonics 0 .. H, shape (channels, H + 1)."""
    end = 2 + 2 * harmonics
    return np.vstack((coefficients[:1], coefficients[2:end:2] - 1j * coefficients[3:end:2])).T


def _linear(
    t: np.ndarray, channels: np.ndarray, f: float, harmonics: int, waves: np.ndarray | None = None
) -> _Linear:
    """Least squares at a frequency, and how it changes with the frequency."""
    order = np.arange(1, harmonics + 1)
    angle = 2.0 * np.pi * f * t[:, None] * order
    rate = 2.0 * np.pi * t[:, None] * order
    end = 2 + 2 * harmonics
    columns = np.empty((t.size, end + (0 if waves is None else waves.shape[1])))
    slopes = np.zeros_like(columns)
    columns[:, 0], columns[:, 1] = 1.0, t
    columns[:, 2:end:2], columns[:, 3:end:2] = np.cos(angle), np.sin(angle)
    slopes[:, 2:end:2], slopes[:, 3:end:2] = -rate * columns[:, 3:end:2], rate * columns[:, 2:end:2]
    if waves is not None:
        columns[:, end:] = waves
    orthogonal, inverse = orthonormal(columns)
    along = orthogonal.T @ channels
    coefficients = inverse @ along
    moved = slopes @ coefficients
    moved_along = orthogonal.T @ moved
    return _Linear(
        coefficients, channels - orthogonal @ along, inverse, -inverse @ moved_along,
        -(moved - orthogonal @ moved_along),
    )  # fmt: skip

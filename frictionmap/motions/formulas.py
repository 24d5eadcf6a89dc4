"""Pulses and sweeps: polynomials over short intervals that are exact to rounding, by their Taylor series.

A sine of the phase phi is the imaginary part of y = exp(i phi), and y' = i phi' y gives term by term what
follows from those before, for any phi' that is a series itself; a bell exp(-a^2) is found in the same way.
Rectangles and triangles are straight lines between their corners.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from .._kernels.general.problem import TERMS
from ..errors import InputError
from .pieces import Pieces, padded, shifted

PULSES = ("rectangle", "triangle", "half-sine", "ricker")
LAWS = ("linear", "log")

#: Phase of a sine from one sample to the next, at most: pictures of histories are smooth, and few terms do.
_ANGLE = 2.0 * math.pi / 32.0

#: Samples of one record at most.
_MOST = 2 * 10**6

#: Terms of a series may be left out where all of them together are less than this share of the amplitude.
_NEGLIGIBLE = 2.0**-56

#: Terms kept beyond these: those of the acceleration of a displacement.
_DERIVATIVES = 2

#: Terms of a bound that show where the rest is negligible.
_LONG = 48

#: Half the length of a Ricker pulse over 1/(pi f): (1 - 2 a^2) exp(-a^2) is below 1e-16 there.
_RICKER = 6.5

#: Samples of a Ricker pulse, d = 2 _RICKER/_RICKER_SAMPLES in a apart, and terms of each: term n of exp(-a^2)
#: is at most 1.09 (2^n/n!)^(1/2) d^n (Cramer), and 2e-19 for n = 18.
_RICKER_SAMPLES, _RICKER_TERMS = 128, 18

#: Amplitude over a rise and over a fall, by powers of the share of its time: 3 s^2 - 2 s^3, and 1 less that.
_RISE, _LEVEL, _FALL = (0.0, 0.0, 3.0, -2.0), (1.0,), (1.0, 0.0, -3.0, 2.0)


class Corners(NamedTuple):
    """Samples of a function of time of amplitude 1, and how they are joined."""

    times: np.ndarray
    values: np.ndarray
    interpolation: str


class _Sweep(NamedTuple):
    """Angular frequency over time."""

    start: float
    growth: float  # per time: of the frequency, or of its logarithm
    law: str

    def phase(self, time: np.ndarray) -> np.ndarray:
        """Phase at times of extended precision: it may be many turns."""
        start, growth = np.longdouble(self.start), np.longdouble(self.growth)
        if self.law == "log" and self.growth != 0.0:
            return start / growth * np.expm1(growth * time)
        return (start + 0.5 * growth * time) * time

    def frequency(self, time: np.ndarray) -> np.ndarray:
        if self.law == "log":
            return self.start * np.exp(self.growth * time)
        return self.start + self.growth * time

    def rates(self, frequency: np.ndarray, step: float, growth: float) -> np.ndarray:
        """Series (K, R) of the derivative of the phase in x over steps that begin with these frequencies."""
        if self.law == "linear":
            return np.stack((step * frequency, np.full(frequency.size, growth * step * step)), axis=1)
        order = np.arange(TERMS)
        factors = np.cumprod(np.concatenate(([step], growth * step / order[1:])))
        return frequency[:, np.newaxis] * factors


def _exponentials(start: np.ndarray, rates: np.ndarray, count: int) -> np.ndarray:
    """Series (K, count) of y with y' = rate y in x; start : (K,) y at 0; rates : (K, R) series."""
    terms = np.zeros((start.size, count), dtype=start.dtype)
    terms[:, 0] = start
    for n in range(count - 1):
        for i in range(min(n + 1, rates.shape[1])):
            terms[:, n + 1] += rates[:, i] * terms[:, n - i]
        terms[:, n + 1] /= n + 1.0
    return terms


def _product(factors: np.ndarray, terms: np.ndarray) -> np.ndarray:
    """Series of the product, with as many terms as the second factor."""
    found = np.zeros_like(terms)
    for i in range(factors.shape[1]):
        found[:, i:] += factors[:, i : i + 1] * terms[:, : terms.shape[1] - i]
    return found


def _terms_needed(rates: np.ndarray, amplitude: np.ndarray) -> int:
    """Terms of a series, from bounds (1, R), (1, S) on the terms of phi' and of the amplitude."""
    bound = _product(amplitude, _exponentials(np.ones(1), rates, _LONG))[0]
    rest = np.cumsum(bound[::-1])[::-1]
    return int(np.argmax(rest <= _NEGLIGIBLE)) + _DERIVATIVES if rest[-1] <= _NEGLIGIBLE else _LONG


def _amplitudes(shape: tuple[float, ...], count: int) -> np.ndarray:
    """Series (count, S) of a polynomial of the share of a span that is divided by `count`."""
    order = np.arange(len(shape))
    begins = np.arange(count) / count
    return shifted(np.tile(shape, (count, 1)), begins) / float(count) ** order


def _span(sweep: _Sweep, begin: np.longdouble, length: float, shape: tuple[float, ...]) -> Pieces:
    """The sine over a span of time with one polynomial amplitude; its times begin at `begin`."""
    ends = sweep.frequency(np.array([float(begin), float(begin) + length]))
    fastest = float(ends.max())
    count, terms = max(1, math.ceil(fastest * length / _ANGLE)), _LONG
    while count < _MOST:
        step, amplitudes = length / count, _amplitudes(shape, count)
        bounds = sweep.rates(np.array([fastest]), step, abs(sweep.growth))
        terms = _terms_needed(bounds, np.abs(amplitudes).max(axis=0, keepdims=True))
        if terms <= TERMS:
            break
        count *= 2
    else:
        raise InputError(
            "duration", f"must need at most {_MOST:.0e} samples; got {count:.3g}; shorten the record"
        )
    times = begin + np.longdouble(step) * np.arange(count)
    waves = _exponentials(
        np.exp(1j * sweep.phase(times)).astype(complex),
        1j * sweep.rates(sweep.frequency(times.astype(float)), step, sweep.growth), terms,
    ).imag  # fmt: skip
    edges = np.append(times, begin + np.longdouble(step) * count).astype(float)
    return Pieces(edges, np.full(count, step), _product(amplitudes, waves))


def sweep(
    start: float, stop: float, duration: float, law: str, rise: float = 0.0, fall: float = 0.0
) -> Pieces:
    """A sine of changing angular frequency and amplitude 1 that begins at phase 0.

    Parameters
    ----------
    start, stop : angular frequencies at the beginning and at the end
    duration : between them
    law : "linear", at a constant rate, or "log", by the same factor in equal times
    rise, fall : times in which the amplitude grows from 0 at the beginning, and falls to 0 at the end
    """
    growth = math.log(stop / start) / duration if law == "log" else (stop - start) / duration
    given = _Sweep(start, growth, law)
    found: list[Pieces] = []
    begin = np.longdouble(0.0)
    level = duration - rise - fall
    for length, shape in ((rise, _RISE), (level, _LEVEL), (fall, _FALL)):
        if length > 0.0:
            found.append(_span(given, begin, length, shape))
            begin = begin + np.longdouble(found[-1].steps[0]) * found[-1].steps.size
    most = max(one.terms.shape[1] for one in found)
    return Pieces(
        np.concatenate([one.times[:-1] for one in found] + [found[-1].times[-1:]]),
        np.concatenate([one.steps for one in found]),
        np.concatenate([padded(one.terms, most) for one in found]),
    )


def _ricker(duration: float) -> Pieces:
    step, d = duration / _RICKER_SAMPLES, 2.0 * _RICKER / _RICKER_SAMPLES
    a = d * (np.arange(_RICKER_SAMPLES) - 0.5 * _RICKER_SAMPLES)
    one = np.ones(a.size)
    bell = _exponentials(np.exp(-a * a), np.stack((-2.0 * d * a, -2.0 * d * d * one), axis=1), _RICKER_TERMS)
    shape = np.stack((1.0 - 2.0 * a * a, -4.0 * d * a, -2.0 * d * d * one), axis=1)
    return Pieces(step * np.arange(a.size + 1), np.full(a.size, step), _product(shape, bell))


def pulse(kind: str, duration: float, rise: float) -> Corners | Pieces:
    """A pulse of amplitude 1 that begins at time 0.

    Parameters
    ----------
    kind : one of `PULSES`; a Ricker pulse of this length has its spectrum's peak at 13/(pi duration)
    duration : of the pulse
    rise : share of it in which a triangle rises, 0 to 1
    """
    if kind == "rectangle":  # the last value holds for a step more
        return Corners(np.array([0.0, duration]), np.array([1.0, 0.0]), "hold")
    if kind == "triangle":
        times = np.unique([0.0, rise * duration, duration])
        return Corners(times, np.where(times == rise * duration, 1.0, 0.0), "linear")
    if kind == "half-sine":
        rate = math.pi / duration
        return sweep(rate, rate, duration, "linear")
    return _ricker(duration)


def checked_pulse(kind: Any, quantity: str) -> str:
    """A kind of pulse that the quantity may have."""
    kind = checks.choice(kind, "kind", PULSES)
    if quantity == "displacement" or (quantity == "velocity" and kind == "rectangle"):
        raise InputError(
            "cannot use",
            f"a {kind} pulse",
            f"of {quantity}: its jumps would need an infinite force; give the acceleration of the base",
        )
    return kind

"""Random records of a spectral density, by sums of harmonics with random complex amplitudes.

Line k at the frequency k/T has the amplitude sqrt(G df) (g_1 + i g_2), g_1 and g_2 Gaussian, so that any
number of lines is a Gaussian process; random phases alone are none.  The period T is at least twice the
record: its end does not know its beginning.  Line 0 is left out.  Interpolation between samples lowers the
amplitudes, by sinc^2(f dt) where it is linear; the lines are divided by this, and end at f dt = 1/4.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from .densities import Density
from .quantities import time_in

#: The highest line, times dt.
_CUT = 0.25

#: Samples of one record at most.
_MOST = 10**8

#: Seeds lie below this, so that every record of every seed has a key of its own.
_KEYS = 2**64

ENVELOPES = ("trapezoid", "jennings")

#: Shares of the duration where an envelope has no times of its own: rise and fall of a trapezoid; of
#: Jennings, Housner and Tsai's type B (50 s): rise 4 s, end of the level 15 s, decay 0.0992/s.
_SHARES = {
    "trapezoid": {"rise": 0.1, "fall": 0.2},
    "jennings": {"rise": 4.0 / 50.0, "end": 15.0 / 50.0, "decay": 0.0992 * 50.0},
}


class Noise(NamedTuple):
    """Stationary random records."""

    density: Density  # one-sided; over the frequency `turn`/(2 pi) of one period of time
    turn: float  # angular frequency of a frequency of 1
    dt: float
    size: int  # samples
    interpolation: str


def samples_in(duration: float, dt: float) -> int:
    """Number of samples over a duration, to the nearest whole step.

    Raises
    ------
    InputError
        There are fewer than 2, or too many.
    """
    steps = duration / dt
    if not 0.5 <= steps < _MOST:
        raise InputError("duration", f"must be 1 to {_MOST:.0e} times dt ({dt:g}); got {duration:g}")
    return round(steps) + 1


def kept_share(x: np.ndarray, interpolation: str) -> np.ndarray:
    """Share of the amplitude of a harmonic that interpolation of its samples keeps; x is f dt.

    The transform of the hat is sinc^2, that of the step sinc.  A spline through samples is a sum of bells
    sinc^4, whose coefficients are the samples over (2 + cos 2 pi x)/3.
    """
    one = np.sinc(x)
    if interpolation == "hold":
        return one
    if interpolation == "linear":
        return one**2
    return one**4 * 3.0 / (2.0 + np.cos(2.0 * np.pi * x))


def _lines(noise: Noise) -> tuple[int, np.ndarray, float]:
    """Samples of a period, frequencies of the lines, and their distance."""
    from scipy.fft import next_fast_len

    period = next_fast_len(2 * noise.size, real=True)
    step = 2.0 * np.pi / (noise.turn * period * noise.dt)
    return period, step * np.arange(1, int(_CUT * period) + 1), step


def variance(noise: Noise) -> float:
    """Variance of the process that the lines make: the integral of the density."""
    _, frequencies, step = _lines(noise)
    return float(noise.density(frequencies).sum() * step)


def random_samples(noise: Noise, seed: int, record: int) -> np.ndarray:
    """Samples of one record; record k of a seed is the same, to the bit, however many are made."""
    period, frequencies, step = _lines(noise)
    draws = np.random.Generator(np.random.Philox(key=seed + record * _KEYS))
    gaussian = draws.standard_normal((frequencies.size, 2))
    kept = kept_share(noise.turn * frequencies * noise.dt / (2.0 * np.pi), noise.interpolation)
    sizes = np.sqrt(noise.density(frequencies) * step) / kept
    spectrum = np.zeros(period // 2 + 1, dtype=complex)
    spectrum[1 : frequencies.size + 1] = 0.5 * period * sizes * (gaussian[:, 0] + 1j * gaussian[:, 1])
    return np.fft.irfft(spectrum, period)[: noise.size]


def envelope(given: Any, duration: float, unit: str | None) -> Callable[[np.ndarray], np.ndarray]:
    """A factor over time of a word of `ENVELOPES`, or of a table with `kind` and its times.

    A trapezoid rises linearly, is 1, and falls linearly to 0 at the end.  Jennings's rises as (t/rise)^2, is
    1 until `end`, and decays as exp(-decay (t - end)).

    Raises
    ------
    InputError
        A key is unknown, or times are out of order.
    """
    table = {"kind": given} if isinstance(given, str) else given
    if not isinstance(table, Mapping):
        raise InputError("envelope", f"must be one of {', '.join(ENVELOPES)} or a table; got {given!r}")
    kind = checks.choice(table.get("kind"), "envelope.kind", ENVELOPES)
    shares = _SHARES[kind]
    for key in table:
        if key != "kind" and key not in shares:
            raise InputError(f"unknown key 'envelope.{key}' of {kind}; valid: kind, {', '.join(shares)}")
    sizes = {key: _time(table, key, share, duration, unit) for key, share in shares.items()}
    rise, level = sizes["rise"], duration - sizes["fall"] if kind == "trapezoid" else sizes["end"]
    if not 0.0 < rise <= level <= duration:
        raise InputError(
            "envelope",
            f"must rise and end its level within the record, of {duration:g}; got {rise:g} and {level:g}",
        )
    if kind == "trapezoid":
        places, heights = [0.0, rise, level, duration], [0.0, 1.0, 1.0, 0.0 if level < duration else 1.0]
        return lambda t: np.interp(t, places, heights)
    decay = sizes["decay"]
    return lambda t: np.minimum(1.0, (t / rise) ** 2) * np.exp(-decay * np.maximum(0.0, t - level))


def _time(table: Mapping[str, Any], key: str, share: float, duration: float, unit: str | None) -> float:
    """A time of an envelope, or its decay, which is one over a time."""
    if key not in table:
        return share / duration if key == "decay" else share * duration
    if key == "decay":
        return checks.number(table[key], "envelope.decay", least=0.0)
    return time_in(table[key], f"envelope.{key}", unit, least=0.0, above=-1.0)

"""Pulses and sweeps: samples with slopes, dense enough for 1e-9 of the amplitude between them.

Cubics with exact values and slopes at both ends of an interval h are at most h^4/384 times the largest fourth
derivative away from a function.  Rectangles and triangles are straight lines between their corners, without
any error.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError

PULSES = ("rectangle", "triangle", "half-sine", "ricker")
LAWS = ("linear", "log")

#: Error between samples over the amplitude.
_ERROR = 1e-9

#: Samples of one record at most.
_MOST = 10**7

#: Half the length of a Ricker pulse over 1/(pi f): (1 - 2 a^2) exp(-a^2) is below 1e-16 there.
_RICKER = 6.5

#: Largest fourth derivative of (1 - 2 a^2) exp(-a^2), -1/2 times the sixth of exp(-a^2): 60 at a = 0.
_RICKER_FOURTH = 60.0


class Formula(NamedTuple):
    """Samples of a function of time of amplitude 1."""

    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray | None  # None: straight lines, or constant values
    interpolation: str


def _count(duration: float, fourth: float, name: str) -> int:
    """Intervals that leave the error, of a function with this fourth derivative."""
    step = (384.0 * _ERROR / fourth) ** 0.25
    count = math.ceil(duration / step)
    if count >= _MOST:
        raise InputError(name, f"must need at most {_MOST:.0e} samples; got {count:.3g}; shorten the record")
    return count


def pulse(kind: str, duration: float, rise: float) -> Formula:
    """A pulse that begins at time 0.

    Parameters
    ----------
    kind : one of `PULSES`; a Ricker pulse of this length has its spectrum's peak at 13/(pi duration)
    duration : of the pulse
    rise : share of it in which a triangle rises, 0 to 1
    """
    if kind == "rectangle":  # the last value holds for a step more
        return Formula(np.array([0.0, duration]), np.array([1.0, 0.0]), None, "hold")
    if kind == "triangle":
        times = np.unique([0.0, rise * duration, duration])
        return Formula(times, np.where(times == rise * duration, 1.0, 0.0), None, "linear")
    if kind == "half-sine":
        rate = math.pi / duration
        times = np.linspace(0.0, duration, _count(duration, rate**4, "duration") + 1)
        values, slopes = np.sin(rate * times), rate * np.cos(rate * times)
        values[-1] = 0.0  # sin(pi) is not
        return Formula(times, values, slopes, "cubic")
    rate = 2.0 * _RICKER / duration
    times = np.linspace(0.0, duration, _count(duration, _RICKER_FOURTH * rate**4, "duration") + 1)
    a = rate * (times - 0.5 * duration)
    bell = np.exp(-a * a)
    return Formula(times, (1.0 - 2.0 * a * a) * bell, rate * a * (4.0 * a * a - 6.0) * bell, "cubic")


def sweep(start: float, stop: float, duration: float, law: str) -> Formula:
    """A sine of changing angular frequency that begins at phase 0.

    Parameters
    ----------
    start, stop : angular frequencies at the beginning and at the end
    duration : between them
    law : "linear", at a constant rate, or "log", by the same factor in equal times
    """
    if law == "log":
        growth = math.log(stop / start) / duration
        bounds = [abs(growth) ** k * max(start, stop) for k in range(4)]
    else:
        growth = (stop - start) / duration
        bounds = [max(start, stop), abs(growth), 0.0, 0.0]
    one, two, three, four = bounds  # on the derivatives of the phase
    fourth = one**4 + 6.0 * one**2 * two + 3.0 * two**2 + 4.0 * one * three + four
    times = np.linspace(0.0, duration, max(1, _count(duration, fourth, "duration")) + 1)
    if law == "log" and growth != 0.0:
        phase, rate = start / growth * np.expm1(growth * times), start * np.exp(growth * times)
    elif law == "log":
        phase, rate = start * times, np.full(times.size, start)
    else:
        phase, rate = (start + 0.5 * growth * times) * times, start + growth * times
    return Formula(times, np.sin(phase), rate * np.cos(phase), "cubic")


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

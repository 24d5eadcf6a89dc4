"""Displacements from velocities and accelerations, harmonic by harmonic: X = V/(i omega) = -A/omega^2.

Harmonics of a record are divided by (i n omega)^k, and the noise beside them line by line of its spectrum.
Lines below half the frequency of the base are left out: no motion is in them, and their noise would grow
beyond bounds.  A mean and a drift, which contain no information about a displacement, are
removed with them.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ... import checks
from ...errors import InputError
from ...units.table import MOTIONS, UNITS, units_of
from .phasors import SAMPLES_OF_HIGHEST, harmonics_at, phasors_of
from .plateaus import unclipped
from .samples import checked_record

#: Largest number of harmonics of a record.  An acceleration jumps where friction changes sign: without whole
#: cycles, harmonics that are left out would leak into the others.
_HARMONICS = 40

#: Lines below this share of the base's frequency are left out.
_LOWEST = 0.5


class Displacements(NamedTuple):
    """Displacements of base and mass, and the noise in them, of each the root mean square over the signal's.

    The noise of what was measured as a displacement is 0: it is not looked at.
    """

    base: np.ndarray  # shape (samples,)
    x: np.ndarray
    noise: tuple[float, float]


def displacements(
    time: Sequence[float] | np.ndarray,
    base: Sequence[float] | np.ndarray,
    x: Sequence[float] | np.ndarray,
    *,
    base_unit: str = "mm",
    x_unit: str = "mm",
    unit: str = "mm",
) -> Displacements:
    """Displacements of a record of steady motion, for `record`, from velocities or accelerations.

    Parameters
    ----------
    time : array, shape (samples,)
        Times [s], increasing; 2 cycles or more.
    base, x : array, shape (samples,)
        Motions of the base and of the mass in space.
    base_unit, x_unit : str
        Their units: of a length, such as "mm", a velocity, "m/s", "mm/s", or an acceleration, "m/s^2",
        "mm/s^2", "g".
    unit : "mm", "m" or "um"
        Of the displacements.

    Returns
    -------
    Displacements
        What was measured as a displacement is only put in `unit`; others are without mean.

    Raises
    ------
    InputError
        An argument is invalid, a velocity or acceleration is clipped; fewer than 2 cycles or 8 samples per
        cycle.

    Examples
    --------
    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(0.0, 4.0, 0.001)
    >>> sine = np.sin(2 * np.pi * t)
    >>> found = fm.identify.displacements(t, sine, -((2 * np.pi) ** 2) * sine, x_unit="mm/s^2")
    >>> bool(np.allclose(found.x, sine, atol=1e-3))
    True
    """
    times, places = checked_record(time, x)
    channels = [checked_record(times, base, "base")[1], places]
    _check_unit(unit, "unit", "length")
    units = (base_unit, x_unit)
    for one, name in zip(units, ("base_unit", "x_unit"), strict=True):
        _check_unit(one, name, *MOTIONS)
    sizes = [float(UNITS[one].size / UNITS[unit].size) for one in units]
    scaled = np.column_stack([channel * size for channel, size in zip(channels, sizes, strict=True)])
    orders = [derivative_order(one) for one in units]
    for name, channel, order in zip(("base", "x"), channels, orders, strict=True):
        if order:
            _check_unclipped(name, times, channel)
    if not any(orders):
        return Displacements(scaled[:, 0], scaled[:, 1], (0.0, 0.0))
    found = phasors_of(times, scaled)
    t = times - found.middle
    columns = [
        (scaled[:, k], 0.0) if order == 0 else _integrated(t, scaled[:, k], found.frequency, order)
        for k, order in enumerate(orders)
    ]
    return Displacements(columns[0][0], columns[1][0], (columns[0][1], columns[1][1]))


def amplitude_factors(unit: str, into: str, frequency: np.ndarray) -> np.ndarray:
    """Factors that convert amplitudes of one harmonic to amplitudes of its displacement, (k,).

    unit : of a displacement, velocity or acceleration
    into : a unit of length
    frequency : (k,) of the harmonic [Hz]
    """
    size = float(UNITS[unit].size / UNITS[into].size)
    return size / (2.0 * np.pi * np.asarray(frequency, dtype=float)) ** derivative_order(unit)


def derivative_order(unit: str) -> int:
    """Order of the derivative of a displacement that has this unit: 0, 1 or 2."""
    return MOTIONS.index(UNITS[unit].measures)


def _check_unit(unit: str, name: str, *kinds: str) -> None:
    """Refuse a unit that is of none of the kinds."""
    valid = tuple(one for kind in kinds for one in units_of(kind))
    if unit not in valid:
        raise InputError(f"{name} must be one of {', '.join(valid)}; got {checks.one_line(unit)}")


def _check_unclipped(name: str, time: np.ndarray, values: np.ndarray) -> None:
    """Refuse clipped data: integration spreads the error over all samples."""
    clipped = 1.0 - np.mean(unclipped(time, values))
    if clipped > 0.0:
        raise InputError(
            f"cannot integrate {name}: it is clipped, {clipped:.1%} of the samples are at the extremes; "
            "choose a window without them, or measure with a larger range"
        )


def _integrated(t: np.ndarray, values: np.ndarray, frequency: float, order: int) -> tuple[np.ndarray, float]:
    """The displacement of a channel, and the root mean square of its noise over that of its harmonics."""
    samples = 1.0 / (float(np.median(np.diff(t))) * frequency)
    harmonics = max(1, min(_HARMONICS, int(samples / SAMPLES_OF_HIGHEST), (t.size - 3) // 4))
    phasors, rest = _harmonics(t, values, frequency, harmonics)
    turn = 2j * np.pi * frequency * np.arange(harmonics + 1)
    phasors[0], turn[0] = 0.0, 1.0
    motion = harmonics_at(phasors / turn**order, 2.0 * np.pi * frequency * t)
    noise = _integrated_noise(t, rest, _LOWEST * frequency, order)
    size = float(np.sqrt(np.mean(motion**2)))
    return motion + noise, float(np.sqrt(np.mean(noise**2))) / size if size > 0.0 else np.inf


def _harmonics(
    t: np.ndarray, values: np.ndarray, frequency: float, harmonics: int
) -> tuple[np.ndarray, np.ndarray]:
    """Complex harmonics 0 to H by least squares, with a drift, and the residual."""
    angle = np.multiply.outer(2.0 * np.pi * frequency * t, np.arange(1, harmonics + 1))
    columns = np.column_stack((np.ones_like(t), t / np.ptp(t), np.cos(angle), np.sin(angle)))
    # squares of the columns suffice: harmonics of one frequency are nearly orthogonal
    found = np.linalg.lstsq(columns.T @ columns, columns.T @ values, rcond=None)[0]
    phasors = np.concatenate((found[:1], found[2 : 2 + harmonics] - 1j * found[2 + harmonics :]))
    return phasors, values - columns @ found


def _integrated_noise(t: np.ndarray, rest: np.ndarray, lowest: float, order: int) -> np.ndarray:
    """Integrate the residual beside the harmonics line by line, at or above `lowest` [Hz]."""
    even = np.linspace(t[0], t[-1], t.size)
    step = float(even[1] - even[0])
    lines = np.fft.rfft(np.interp(even, t, rest))
    at = np.fft.rfftfreq(t.size, step)
    kept = at >= lowest
    lines[kept] /= (2j * np.pi * at[kept]) ** order
    lines[~kept] = 0.0
    return np.interp(t, even, np.fft.irfft(lines, t.size))

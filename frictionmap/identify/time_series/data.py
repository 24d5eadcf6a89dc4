"""A record as it was measured: checked, its clipped samples found, its harmonics."""

from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ..signals.phasors import Phasors, amplitude_and_lag, harmonics_of, ratio_error
from ..signals.plateaus import unclipped_mass
from ..signals.samples import checked_record, unclipped, within
from ..signals.turning_points import resolution
from ..statistics.levels import FOUND
from .fit import Fit, Samples, places_at, samples_of

#: Errors of the base's first harmonic so many times those of samples at all phases.
_WORSE = 4.0

#: A lead of so many degrees may come from higher harmonics of the base.
_LEAD = 1.0

#: A first harmonic of the mass below so many standard errors is no motion.
_MOVES = 5.0


class MeasuredRecord(NamedTuple):
    """Base and mass over time."""

    every_time: np.ndarray  # s, those of clipped samples among them
    time: np.ndarray  # s, where the base is not clipped
    channels: np.ndarray  # shape (samples, 2), base and mass at `time`
    good: np.ndarray  # shape (samples,), bool: where the mass is not clipped
    phasors: Phasors
    samples: Samples  # of the mass, where it is good


def measured_record(time: object, base: object, x: object, window: object, robust: bool) -> MeasuredRecord:
    """Check a record and find its harmonics; see `record`."""
    times, places = checked_record(time, x)
    shakes = checked_record(times, base, "base")[1]
    inside = within(window, times)
    times, channels = times[inside], np.column_stack((shakes, places))[inside]
    whole = unclipped(channels[:, 0])
    t, data = times[whole], channels[whole]
    good = unclipped_mass(t, data[:, 1])
    phasors, tamed = _checked_phasors(t, data, robust)
    return MeasuredRecord(
        times, t, data, good, phasors, samples_of(phasors, t, data[:, 1], tamed[:, 1], good, robust)
    )


def whole_record(given: MeasuredRecord, fit: Fit, robust: bool) -> MeasuredRecord:
    """The record with the fitted motion where it is clipped, and the harmonics of that."""
    if given.good.all():
        return given
    fitted = places_at(fit, given.phasors, given.time) + fit.slow_at(given.samples.everywhere)
    x = np.where(given.good, given.channels[:, 1], fitted)
    channels = np.column_stack((given.channels[:, 0], x))
    return given._replace(channels=channels, phasors=harmonics_of(given.time, channels, robust)[0])


def _checked_phasors(time: np.ndarray, channels: np.ndarray, robust: bool) -> tuple[Phasors, np.ndarray]:
    """Harmonics of a base and of a mass that move, and the channels without outliers."""
    for name, places in zip(("base", "x"), channels.T, strict=True):
        if float(np.ptp(places)) <= 2.0 * resolution(places):
            raise InputError(
                f"{name} must move; there is no motion above its own resolution ({resolution(places):g})"
            )
    phasors, tamed = harmonics_of(time, channels, robust)
    ideal = phasors.inflation[0, 1] * phasors.rms[0] * np.sqrt(2.0 / time.size)
    if phasors.errors[0, 1] > _WORSE * ideal:
        raise InputError(
            "time must reach all phases of the cycle: harmonics of the base cannot be told where there are "
            "no samples, as in a long gap or where the base is clipped"
        )
    for k, name in enumerate(("base", "x")):
        first, error = abs(phasors.values[k, 1]), float(phasors.errors[k, 1])
        if first <= _MOVES * error:
            raise InputError(
                f"{name} must move with the base, at {phasors.frequency:.4g} Hz; its first harmonic there is "
                f"{first:.3g}, of the size of its error, {error:.2g} (a mass that sticks for good tells "
                "nothing of its motion)"
            )
    _check_lag(phasors)
    return phasors, tamed


def _check_lag(phasors: Phasors) -> None:
    """Energy flows from the base to the mass: its first harmonic lags by 0 to 180 degrees."""
    lag = np.degrees(amplitude_and_lag(phasors)[1])
    if lag < -(_LEAD + FOUND * np.degrees(ratio_error(phasors))):
        raise InputError(
            "x must lag behind the base by 0 to 180 degrees, as energy comes from it; "
            f"it leads by {-lag:.4g} (are the columns exchanged, or is one of opposite sign?)"
        )

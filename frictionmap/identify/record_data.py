"""A record as it was measured: checked, its clipped samples found, its harmonics."""

from typing import NamedTuple

import numpy as np

from ..errors import InputError
from .decay_checks import checked_record, unclipped, within
from .phasors import Phasors, amplitude_and_lag, harmonics_of, ratio_error
from .plateaus import unclipped_mass
from .record_fit import Fit, Samples, places_at, samples_of
from .turning_points import resolution

#: Standard errors from which a lead is significant.
_FOUND = 3.0

#: Largest error of the base's first harmonic, over that of samples at all phases.
_WORSE = 4.0

#: Lead [deg] that higher harmonics of the base may cause.
_LEAD = 1.0

#: Standard errors of the first harmonic below which the mass does not move.
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
                f"cannot fit {name}: it does not move by more than its resolution ({resolution(places):g}); "
                "check the data"
            )
    phasors, tamed = harmonics_of(time, channels, robust)
    ideal = phasors.inflation[0, 1] * phasors.rms[0] * np.sqrt(2.0 / time.size)
    if phasors.errors[0, 1] > _WORSE * ideal:
        raise InputError(
            "cannot determine harmonics of the base: a part of the cycle has no samples, by a long gap or a "
            "clipped base; choose another window"
        )
    for k, name in enumerate(("base", "x")):
        first, error = abs(phasors.values[k, 1]), float(phasors.errors[k, 1])
        if first <= _MOVES * error:
            raise InputError(
                f"cannot fit {name}: its first harmonic at {phasors.frequency:.4g} Hz, the frequency of the "
                f"base, is {first:.3g}, about its error, {error:.2g}; use a record in which the mass moves"
            )
    _check_lag(phasors)
    return phasors, tamed


def _check_lag(phasors: Phasors) -> None:
    """Energy flows from the base to the mass: its first harmonic lags by 0 to 180 degrees."""
    lag = np.degrees(amplitude_and_lag(phasors)[1])
    if lag < -(_LEAD + _FOUND * np.degrees(ratio_error(phasors))):
        raise InputError(
            "x must lag behind the base by 0 to 180 degrees; "
            f"got a lead of {-lag:.4g} (are the columns exchanged, or is one of opposite sign?)"
        )

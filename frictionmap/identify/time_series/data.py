"""A record as it was measured: checked, its clipped samples found, its harmonics."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from .. import spring
from ..signals.phasors import Phasors, amplitude_and_lag, harmonics_of, ratio_error
from ..signals.plateaus import unclipped
from ..signals.samples import checked_record, within
from ..signals.turning_points import resolution
from ..statistics.levels import FOUND
from .fit import RecordFit, Samples, fit_record, places_at, samples_of

#: Largest error of the base's first harmonic, over that of samples at all phases.
_WORSE = 4.0

#: Largest lead [degrees] that higher harmonics of the base can cause.
_LEAD = 1.0

#: Noise brings a motion to the ends of the range that is nearer to them than this many standard deviations.
_MARGIN = 3.0

#: Fits after which the samples that are left out are settled, and samples that a fit needs.
_REFITS, _FEWEST = 4, 40

#: A first harmonic of the mass below this many standard errors is no motion.
_MOVES = 5.0


class MeasuredRecord(NamedTuple):
    """Base and mass over time."""

    every_time: np.ndarray  # s, those of clipped samples among them
    time: np.ndarray  # s, where the base is not clipped
    channels: np.ndarray  # shape (samples, 2), base and mass at `time`
    clipped: np.ndarray  # shape (samples,), bool: where the mass is cut off
    limits: tuple[float, float]  # where the range ends that cuts it off; infinite where none does
    good: np.ndarray  # shape (samples,), bool: samples of the mass that are part of the fit
    phasors: Phasors
    samples: Samples  # of the mass, where it is good
    robust: bool  # whether there may be outliers


def measured_record(
    time: object, base: object, x: object, window: object, robust: bool, elastic: bool = False
) -> MeasuredRecord:
    """Check a record and find its harmonics; see `record`."""
    times, places = checked_record(time, x)
    shakes = checked_record(times, base, "base")[1]
    inside = within(window, times)
    times, channels = times[inside], np.column_stack((shakes, places))[inside]
    whole = unclipped(times, channels[:, 0])
    t, data = times[whole], channels[whole]
    good = unclipped(t, data[:, 1])
    phasors, winsorised = _checked_phasors(t, data, robust, spring.LEAD if elastic else _LEAD)
    samples = samples_of(phasors, t, data[:, 1], winsorised[:, 1], good, robust)
    return MeasuredRecord(times, t, data, ~good, _limits(data[:, 1], good), good, phasors, samples, robust)


def _limits(x: np.ndarray, good: np.ndarray) -> tuple[float, float]:
    """Ends of the range by which samples that are not good are cut off."""
    lowest = -np.inf if good[np.argmin(x)] else float(x.min())
    return lowest, np.inf if good[np.argmax(x)] else float(x.max())


def fit_clipped(
    contact: str, damping_reference: str, given: MeasuredRecord, known: Mapping[str, float],
    elastic: bool = False, thorough: bool = True,
) -> tuple[MeasuredRecord, RecordFit]:  # fmt: skip
    """Fit a steady motion as by `fit_record`, without what happens beside the ends of a measuring range.

    There noise decides which samples are cut off: those that are left lie too far inside, and would draw the
    motion with them.  So samples are left out by the fitted motion, which has no noise, and the motion is
    fitted anew.  Its harmonics then take the place of the clipped ones, where the search begins.
    """

    def fitted(to: MeasuredRecord) -> RecordFit:
        return fit_record(contact, damping_reference, to.phasors, to.samples, known, elastic, thorough)

    fit = fitted(given)
    if not given.clipped.any():
        return given, fit
    for _ in range(_REFITS):
        inside = _inside(given, fit)
        if inside.sum() < _FEWEST or (inside == given.good).all():
            break
        given = _filled(given, fit, inside)
        fit = fitted(given)
    return given, fit


def _inside(given: MeasuredRecord, fit: RecordFit) -> np.ndarray:
    """Samples that are not clipped, where the fitted motion is farther from the ends than noise reaches."""
    fitted, (lowest, highest) = _fitted(given, fit), given.limits
    margin = _MARGIN * float(np.std(fit.residual))
    return ~given.clipped & (fitted > lowest + margin) & (fitted < highest - margin)


def whole_record(given: MeasuredRecord, fit: RecordFit) -> MeasuredRecord:
    """The record with the fitted motion where it is clipped, and the harmonics of that."""
    return given if not given.clipped.any() else _filled(given, fit, given.good)


def _filled(given: MeasuredRecord, fit: RecordFit, used: np.ndarray) -> MeasuredRecord:
    """The record with the fitted motion where it is clipped, its harmonics, and the samples to be used."""
    x = np.where(given.clipped, _fitted(given, fit), given.channels[:, 1])
    channels = np.column_stack((given.channels[:, 0], x))
    phasors, winsorised = harmonics_of(given.time, channels, given.robust)
    samples = samples_of(phasors, given.time, x, winsorised[:, 1], used, given.robust)
    return given._replace(channels=channels, good=used, phasors=phasors, samples=samples)


def _fitted(given: MeasuredRecord, fit: RecordFit) -> np.ndarray:
    """The fitted motion, drift and wander of the zero included, at all times."""
    return places_at(fit, given.phasors, given.time) + fit.slow_at(given.samples.everywhere)


def _checked_phasors(
    time: np.ndarray, channels: np.ndarray, robust: bool, lead: float
) -> tuple[Phasors, np.ndarray]:
    """Harmonics of a base and of a mass that move, and the channels without outliers."""
    for name, places in zip(("base", "x"), channels.T, strict=True):
        if float(np.ptp(places)) <= 2.0 * resolution(places):
            raise InputError(
                f"cannot fit {name}: it does not move by more than its resolution ({resolution(places):g}); "
                "check the data"
            )
    phasors, winsorised = harmonics_of(time, channels, robust)
    ideal = phasors.inflation[0, 1] * phasors.rms[0] * np.sqrt(2.0 / time.size)
    if phasors.errors[0, 1] > _WORSE * ideal:
        raise InputError(
            "cannot determine harmonics of the base: a part of the cycle has no samples because of a long "
            "gap or a clipped base; choose another window"
        )
    for k, name in enumerate(("base", "x")):
        first, error = abs(phasors.values[k, 1]), float(phasors.errors[k, 1])
        if first <= _MOVES * error:
            raise InputError(
                f"cannot fit {name}: its first harmonic at {phasors.frequency:.4g} Hz, the frequency of the "
                f"base, is {first:.3g} with an error of {error:.2g}; use a record in which the mass moves"
            )
    _check_lag(phasors, lead)
    return phasors, winsorised


def _check_lag(phasors: Phasors, lead: float) -> None:
    """Energy flows from the base to the mass: its first harmonic lags by 0 to 180 degrees."""
    lag = np.degrees(amplitude_and_lag(phasors)[1])
    if lag < -(lead + FOUND * np.degrees(ratio_error(phasors))):
        raise InputError(
            "x must lag behind the base by 0 to 180 degrees; "
            f"got a lead of {-lag:.4g} (are the columns exchanged, or is one of opposite sign?)"
        )

"""What a record of a decay is: its unit, the filters that it passed, samples that they spoil."""

import json
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypedDict

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError
from ...units.table import COLUMN_NAMES, MOTIONS, UNITS, known_unit, units_of
from ..signals.samples import finite_numbers
from ..signals.turning_points import TurningPoints
from .motion import Decay, half_period
from .sensor import Filter, Sensor, sensor_of

#: Unit of lengths in the results of velocities and accelerations.
_LENGTH = "mm"

#: Attribute of a dataset that holds the keys of the sensor's filters, as JSON.
SENSOR, _OF_SENSOR = "sensor", ("filter", "ac_coupling_Hz")

#: Keys of a low-pass filter, its kind and its orders; an AC coupling must be below it by this factor.
_FILTER, _KIND, _ORDERS, _BAND = ("kind", "order", "frequency_Hz"), "low-pass", (1, 2), 2.0


class Electronics(TypedDict, total=False):
    """What stands between the motion and the samples."""

    filter: Mapping[str, object]
    ac_coupling_Hz: float
    mask_s: Sequence[float]


#: Their names.
ELECTRONICS = tuple(Electronics.__annotations__)


class Signal(NamedTuple):
    """A measured quantity."""

    unit: str  # of the samples
    length: str  # unit of x_F and X0
    sensor: Sensor | None  # None: displacements or angles as they are
    order: int  # of the derivative of the motion: 0, 1 or 2
    shows_centre: bool  # that a displacement has
    shows_rest: bool  # the place where the mass comes to rest
    mask: tuple[float, float] | None  # times [s] before and after each turning point that are left out
    electronics: dict[str, object]  # as given

    @property
    def description(self) -> str:
        """What is measured, in words."""
        return ("an AC-coupled signal", "a velocity", "an acceleration")[self.order]

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle: then x_F is one, too."""
        return UNITS[self.unit].measures == "angle"

    @property
    def leaves_out(self) -> bool:
        """Whether samples beside turning points are left out."""
        return self.mask is not None or (self.sensor is not None and self.sensor.jumps)

    @property
    def attributes(self) -> dict[str, object]:
        """What a dataset needs to hold of a sensor to make it again, but the unit of its data."""
        return {} if self.sensor is None else {SENSOR: json.dumps(self.electronics)}

    def gain_at(self, frequency: float) -> float:
        """Amplitude of the signal over that of the motion at a frequency [Hz]."""
        if self.sensor is None:
            return 1.0
        turn = 2j * np.pi * frequency
        return float(self.sensor.scale * abs(turn**self.order * self.sensor.gain(turn)))


def signal_of(unit: str, electronics: Electronics) -> Signal:
    """A signal in a unit of length, velocity, acceleration or angle.

    Raises
    ------
    InputError
        The unit is unknown, or a filter or a number is out of range.
    """
    for key in electronics:
        if key not in ELECTRONICS:
            raise TypeError(f"free_decay() got an unexpected keyword argument {key!r}")
    name = checked_signal_unit(unit)
    measures = UNITS[name].measures
    low_pass = _low_pass(electronics.get("filter"))
    coupling = electronics.get("ac_coupling_Hz")
    if coupling is not None:
        coupling = checks.number(coupling, "ac_coupling_Hz", above=0.0)
        if low_pass is not None and low_pass.frequency < _BAND * coupling:
            raise InputError(
                f"ac_coupling_Hz must be at most half of filter.frequency_Hz, {low_pass.frequency:g}; "
                f"got {coupling:g}"
            )
    order = MOTIONS.index(measures) if measures in MOTIONS else 0
    length = name if order == 0 else _LENGTH
    sensor = None
    if order or low_pass is not None or coupling is not None:
        scale = float(UNITS[length].size / UNITS[name].size)
        sensor = sensor_of(order, scale, low_pass, coupling)
    rests = order == 0 and coupling is None
    return Signal(
        name, length, sensor, order, rests and measures == "length", rests, _mask(electronics.get("mask_s")),
        {key: value for key, value in electronics.items() if key in _OF_SENSOR},
    )  # fmt: skip


def sensor_in(ds: xr.Dataset) -> Sensor | None:
    """The sensor of a dataset of estimates; None of displacements or angles as they are."""
    if SENSOR not in ds.attrs:
        return None
    return signal_of(str(ds["data"].attrs["units"]), json.loads(ds.attrs[SENSOR])).sensor


def checked_signal_unit(unit: str) -> str:
    """A unit of length, velocity, acceleration or angle as the table writes it; also as columns end in it."""
    name = known_unit(unit) or COLUMN_NAMES.get(unit) if isinstance(unit, str) else None
    valid = tuple(one for kind in (*MOTIONS, "angle") for one in units_of(kind))
    return checks.choice(name or unit, "unit", valid)


def _low_pass(given: object) -> Filter | None:
    if given is None:
        return None
    if not isinstance(given, Mapping) or set(given) != set(_FILTER):
        raise InputError(
            'filter must be { kind = "low-pass", order = 1 or 2, frequency_Hz = a number }; '
            f"got {checks.one_line(given)}"
        )
    checks.choice(given["kind"], "filter.kind", (_KIND,))
    order = given["order"]
    if isinstance(order, bool) or order not in _ORDERS:
        raise InputError(f"filter.order must be 1, or 2 (Butterworth); got {checks.one_line(order)}")
    return Filter(int(order), checks.number(given["frequency_Hz"], "filter.frequency_Hz", above=0.0))


def _mask(given: object) -> tuple[float, float] | None:
    if given is None:
        return None
    times = finite_numbers(given, "mask_s", 2, "side of a turning point")
    before, after = (checks.number(float(one), "mask_s", least=0.0) for one in times)
    return before, after


def points_of_motion(points: TurningPoints, sensor: Sensor, half: float) -> TurningPoints:
    """Turning points of the motion, from those of what a sensor shows of it; places stay as they are.

    Nearly a sine of half period `half`: a velocity is at its extremes a quarter of a cycle after the motion,
    an acceleration is opposite to it, and a filter delays by its phase.
    """
    turn = 1j * np.pi / half
    delay = -np.angle(sensor.gain(turn)) / turn.imag + (0.5 * half if sensor.order == 1 else 0.0)
    upper = points.upper if sensor.order == 0 else ~points.upper
    return points._replace(time=points.time - delay, upper=upper)


def kept_samples(signal: Signal, decay: Decay, last: int, time: np.ndarray) -> np.ndarray:
    """Samples that are not beside one of turning points 0 to `last`, bool (samples,).

    A jump of the acceleration can be on either side of the sample next to it, and a sum of squares jumps
    with it: without a low-pass filter one sample is left out on each side.
    """
    mask, half = signal.mask, half_period(decay)
    if not signal.leaves_out:
        return np.ones(time.size, dtype=bool)
    step = float(np.median(np.diff(time)))
    least = step if signal.sensor is not None and signal.sensor.jumps else 0.0
    before, after = (max(one, least) for one in mask or (0.0, 0.0))
    if before + after >= half:
        raise InputError(
            f"mask_s must leave samples between turning points, which are {half:.4g} s apart; "
            f"got {before:g} and {after:g}"
        )
    at = decay.t0 + half * np.clip(np.rint((time - decay.t0) / half), 0, last)
    return (time <= at - before) | (time >= at + after)

"""Pictures of free decays: turning points between their envelopes, and where the mass came to rest."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ...errors import InputError
from ...identify.decay.electronics import SENSOR
from ...identify.decay.motion import PARAMETERS, Decay, amplitudes, displacement, envelope, half_period
from ...units.table import UNITS
from ..palette import CLASSES, STUCK
from ..panels import Handle
from .data import FITTED, Samples, draw_data, draw_residuals, in_brackets, samples_of
from .picture import FitPicture
from .samples import RESIDUALS, VALUES

#: Samples of a half cycle of the fitted curve; half cycles that a picture can show.
_SAMPLES, _MOST_HALVES = 40, 400

#: Parameters that are the centre: of a displacement, of an angle.
_ZEROS = (PARAMETERS[-1], "offset")

_ENVELOPE_COLOUR = "#bd7f50"


class _Motion(NamedTuple):
    """A fitted decay within the span of its data."""

    decay: Decay
    halves: int  # half cycles before rest, or begun in the record
    at_rest: bool
    begin: float  # s
    end: float


def is_decay(ds: xr.Dataset) -> bool:
    """Whether all is there that a fitted decay needs, and the displacement or angle itself was measured."""
    names = set(ds["parameter"].values.tolist())
    measured_as_it_is = SENSOR not in ds.attrs and not names.isdisjoint(_ZEROS)
    return set(PARAMETERS[:-1]) <= names and {"time", "half_cycles"} <= set(ds) and measured_as_it_is


def decay_picture(ds: xr.Dataset) -> FitPicture:
    """The record over the fitted decay: envelope, turning points, place of rest; residuals below."""
    samples, motion = samples_of(ds), _motion_of(ds)

    def values(ax: Axes) -> list[Handle]:
        unit = UNITS.get(samples.unit)
        what = "angle" if unit is not None and unit.measures == "angle" else "displacement"
        ax.set_ylabel(f"{what}{in_brackets(samples.unit)}")
        return [*_draw_friction(ax, motion), *_draw_record(ax, samples, motion), *_draw_rest(ax, motion)]

    def residuals(ax: Axes) -> list[Handle]:
        return draw_residuals(ax, samples, f"residual{in_brackets(samples.unit)}")

    return FitPicture([(VALUES, values), (RESIDUALS, residuals)], [], [])


def _motion_of(ds: xr.Dataset) -> _Motion:
    values = dict(zip(ds["parameter"].values.tolist(), ds["estimate"].values.tolist(), strict=True))
    zero = next(values[name] for name in _ZEROS if name in values)
    decay = Decay(*[values[name] for name in PARAMETERS[:-1]] + [zero])
    if decay.f_n <= 0.0 or abs(decay.zeta) >= 1.0:
        raise InputError(
            f"a decay must have f_n > 0 and zeta < 1 to be drawn; got {decay.f_n:g}, {decay.zeta:g}"
        )
    time = ds["time"].values
    halves = int(ds["half_cycles"])
    shown = (float(time.max()) - min(decay.t0, float(time.min()))) / half_period(decay)
    if not 0 <= halves <= _MOST_HALVES or shown > _MOST_HALVES:
        raise InputError(
            f"a decay must have at most {_MOST_HALVES} half cycles to be drawn; got {max(halves, shown):g}"
        )
    at_rest = bool(ds["at_rest"]) if "at_rest" in ds else False
    return _Motion(decay, halves, at_rest, float(time.min()), float(time.max()))


def _draw_record(ax: Axes, samples: Samples, motion: _Motion) -> list[Handle]:
    """Samples, the fitted motion, and its turning points."""
    decay = motion.decay
    ends = samples.data - samples.sigma, samples.data + samples.sigma
    handles = draw_data(ax, samples, ends)
    number = int(_SAMPLES * (motion.end - motion.begin) / half_period(decay)) + 2
    time = np.linspace(motion.begin, motion.end, number)
    place = displacement(decay, motion.halves, time)
    handles += ax.plot(time, place, color=FITTED, linewidth=1.0, zorder=2.6, label="fitted")
    return handles + _draw_turning_points(ax, motion)


def _draw_turning_points(ax: Axes, motion: _Motion) -> list[Handle]:
    """Turning points within the record, the one at which the mass rests among them."""
    decay = motion.decay
    j = np.arange(motion.halves + motion.at_rest)
    time = decay.t0 + j * half_period(decay)
    side = np.where(j % 2 == 0, 1.0, -1.0) * (1.0 if decay.X0 >= 0.0 else -1.0)
    place = decay.centre + side * amplitudes(decay, motion.halves)[: j.size]
    inside = (time >= motion.begin) & (time <= motion.end)
    points = ax.plot(
        time[inside], place[inside], "o", markersize=5.0, markerfacecolor="white", markeredgecolor=FITTED,
        zorder=2.7, label="turning point",
    )  # fmt: skip
    return [*points]


def _draw_friction(ax: Axes, motion: _Motion) -> list[Handle]:
    """The centre, what friction holds around it, and the envelope through the turning points."""
    decay = motion.decay
    band = ax.axhspan(
        decay.centre - decay.x_F, decay.centre + decay.x_F, color=CLASSES[STUCK].colour, alpha=0.6,
        linewidth=0.0, zorder=0.5, label="within $x_F$ of the centre",
    )  # fmt: skip
    ax.axhline(decay.centre, color=CLASSES[STUCK].colour, linewidth=1.0, zorder=0.6)
    last = decay.t0 + motion.halves * half_period(decay)
    time = np.linspace(max(motion.begin, decay.t0), max(min(motion.end, last), decay.t0), 400)
    reach = np.maximum(envelope(decay, time), 0.0)
    for side in (1.0, -1.0):
        lines = ax.plot(
            time, decay.centre + side * reach, color=_ENVELOPE_COLOUR, linewidth=1.4,
            linestyle=(0, (4, 2)), zorder=2.3, label=f"envelope: {_shape(decay)}",
        )  # fmt: skip
    return [band, *lines] if decay.x_F > 0.0 else [*lines]


def _shape(decay: Decay) -> str:
    """Describe the shape of the envelope."""
    if decay.zeta == 0.0:
        return "straight, as under friction alone"
    return (
        "exponential, as under viscous damping alone" if decay.x_F == 0.0 else "friction and viscous damping"
    )


def _draw_rest(ax: Axes, motion: _Motion) -> list[Handle]:
    """The span in which the mass is at rest."""
    if not motion.at_rest:
        return []
    begin = motion.decay.t0 + motion.halves * half_period(motion.decay)
    line = ax.axvline(begin, color=FITTED, linewidth=1.0, linestyle=":", zorder=0.7, label="comes to rest")
    return [line]

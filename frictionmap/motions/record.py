"""`Record`: a load or a base motion over time."""

import math
import os
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.shown import Shown
from ..units.table import UNITS, known_unit, units_of
from .baseline import BASELINES, corrected
from .densities import density_of
from .formats.series import Series
from .formulas import LAWS, Corners, checked_pulse
from .formulas import pulse as pulse_samples
from .formulas import sweep as sweep_series
from .generators import Noise, random_samples, samples_in, variance
from .generators import envelope as over_time
from .pieces import INTERPOLATIONS, Pieces, even_step, extremes, interpolated, levelled, scaled
from .quantities import angular, frequency_in, number_in, time_in

QUANTITIES = ("force", "acceleration", "velocity", "displacement")

#: Kinds of units of the quantities.
KINDS = {"force": "force", "acceleration": "acceleration", "velocity": "velocity", "displacement": "length"}


@dataclass(frozen=True, repr=False, eq=False)
class Record(Shown):
    """A load on the masses, or a motion of the base, over time.

    Parameters
    ----------
    values : sequence of float
        Samples, at least two.
    dt : float, optional
        Time between two samples; or
    time : sequence of float, optional
        increasing times of the samples.
    quantity : {"acceleration", "velocity", "displacement", "force"}
        Of the base, in coordinates relative to which the masses then move; or a force.
    unit : str, optional
        Unit of the values, such as "g", "m/s^2", "cm/s", "mm", "N".  Times are then in seconds.  Without it
        everything is dimensionless: time in 1/omega_1, force over P, displacement over P/k_1, acceleration
        over omega_1^2 P/k_1.
    interpolation : {"linear", "cubic", "hold"}, optional
        Between samples: straight lines (default), a spline, or the last value.  A displacement needs
        "cubic", its default: the spline is clamped, at rest at both ends.  Else it is natural.
    mass : int or str, optional
        The mass that a force acts on; default: the first.
    vector : sequence of float, optional
        Instead of `mass`: shares of the force on all masses.
    scale : float
        Factor of the values.
    name : str, optional
        Name in datasets and pictures.
    series : Pieces, optional
        Polynomials between the samples of a record by a formula, in place of an interpolation.
    source : str
        What it comes from, such as a file with its checksum and what it says of event and station.
    note : str
        What was made of the samples, such as their mean that was taken off.

    Raises
    ------
    InputError
        A value is not finite or out of range, or two exclude each other.

    Notes
    -----
    theory.md, Motions in time.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.Record([0.0, 0.3, 0.0], dt=0.1, unit="g")
    <Record: acceleration, 3 samples over 0.2 s, peak 0.3 g>
    """

    values: Any
    dt: float | None = None
    time: Any = None
    quantity: str = "acceleration"
    unit: str | None = None
    interpolation: str | None = None
    mass: int | str | None = None
    vector: Any = None
    scale: float = 1.0
    name: str | None = None
    series: Pieces | None = None
    source: str = field(default="", compare=False)
    note: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        checks.choice(self.quantity, "quantity", QUANTITIES)
        values = _samples(self.values, "values")
        self._set("values", values)
        if (self.dt is None) == (self.time is None):
            got = "neither" if self.dt is None else "both"
            raise InputError("dt", f"must be given, or else time, but not both; got {got}")
        if self.dt is not None:
            self._set("dt", checks.number(self.dt, "dt", above=0.0))
        else:
            self._set("time", _times(self.time, values.size))
        how = self.interpolation
        if how is None:
            how = "cubic" if self.quantity == "displacement" else "linear"
        checks.choice(how, "interpolation", INTERPOLATIONS)
        if self.quantity == "displacement" and how != "cubic":
            raise InputError(
                "interpolation",
                'must be "cubic" for a displacement: a base whose velocity jumps would need an infinite '
                f"force; got {how!r}",
            )
        if self.quantity == "velocity" and how == "hold":
            raise InputError(
                "interpolation",
                'must be "linear" or "cubic" for a velocity: a base whose velocity jumps would need an '
                "infinite force; got 'hold'",
            )
        self._set("interpolation", how)
        self._set("scale", checks.number(self.scale, "scale"))
        if self.unit is not None:
            self._set("unit", _unit(self.unit, self.quantity))
        self._check_shape()

    def _check_shape(self) -> None:
        if self.quantity != "force":
            for key in ("mass", "vector"):
                if getattr(self, key) is not None:
                    raise InputError(
                        "cannot use", key, f"with a base {self.quantity}: it loads all masses; omit it"
                    )
        if self.mass is not None and self.vector is not None:
            raise InputError("cannot use", "vector", "with mass: both say where the force acts; omit one")
        if self.vector is not None:
            vector = _samples(self.vector, "vector", least=1)
            self._set("vector", tuple(vector.tolist()))

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    @classmethod
    def read(
        cls,
        path: str | os.PathLike,
        *,
        quantity: str | None = None,
        unit: str | None = None,
        dt: float | None = None,
        baseline: str | None = None,
        decimal: str | None = None,
        columns: Mapping[str, Any] | None = None,
        **more: Any,
    ) -> "Record":
        """Read a record from a file.

        By its ending it is PEER (.AT2, .VT2, .DT2), K-NET or KiK-net (.EW, .NS, .UD, also with a number), ESM
        or ITACA (.ASC), COSMOS (.V1, .V2), miniSEED or SAC (through the extra `seismic`), or a table: text,
        .npz, .mat, .json, .uff, .tdms.  A table has a column of its quantity with a unit, such as
        acceleration_g, velocity_m_s, displacement_mm or force_N, beside time_s; without units `time` and the
        quantity alone.

        Parameters
        ----------
        path : str or path
            Of the file.
        quantity, unit : str, optional
            Where the file does not state them; and the column of several.
        dt : float, optional
            Time step [s] of a table without times.
        baseline : {"none", "mean", "linear"}, optional
            What is taken off the samples.  Default: the mean of K-NET files, else nothing.  `note` says
            how much it was.
        decimal : {".", ","}, optional
            Decimal sign of a file of text; default: as its numbers show it.
        columns : dict, optional
            Columns of a table by `time` and the quantities: a name, or a table with `name`, `unit`, `scale`
            and `offset`.
        more
            Further arguments of `Record`: interpolation, mass, vector, scale, name.

        Raises
        ------
        InputError
            The file cannot be read, is damaged or truncated, or an argument does not fit it.
        """
        if not isinstance(path, (str, os.PathLike)):
            raise InputError(f"path must be the path of a file; got {checks.one_line(path)}")
        file = Path(path)
        from .formats.files import Given, read_series  # with `identify`: not before a file is read

        series = read_series(file, Given(quantity, unit, dt, decimal, columns))
        if series.values.size < 2:
            raise InputError(f"cannot read {file}: a record has at least 2 samples; got {series.values.size}")
        times = series.time
        if times is None:
            times = np.arange(series.values.size) * float(series.dt or 0.0)
        how = series.baseline if baseline is None else checks.choice(baseline, "baseline", BASELINES)
        values, taken = corrected(series.values, times, how, series.unit)
        return cls(
            values, series.dt, series.time, series.quantity, series.unit,
            **{"name": file.stem, **more, "source": _source(file, series),
               "note": "; ".join(filter(None, (series.remark, taken)))},
        )  # fmt: skip

    @classmethod
    def pulse(
        cls,
        kind: str,
        amplitude: float | str,
        duration: float | str,
        *,
        rise: float = 0.5,
        quantity: str = "acceleration",
        unit: str | None = None,
        **more: Any,
    ) -> "Record":
        """A single pulse, exact to rounding.

        Parameters
        ----------
        kind : {"rectangle", "triangle", "half-sine", "ricker"}
            Shape.  The spectrum of a Ricker pulse (1 - 2 a^2) exp(-a^2) has its peak at 13/(pi duration).
        amplitude : float or str
            Largest value, in `unit` or with a unit, such as "0.4 g"; its sign is that of the pulse.
        duration : float or str
            Time from the beginning to the end, > 0: in seconds, of a record without a unit in 1/omega_1.
        rise : float
            Share of the duration in which a triangle rises, 0 to 1; at 0 and 1 it jumps.
        quantity, unit
            As of `Record`; no displacement.
        more
            Further arguments of `Record`: mass, vector, scale, name.

        Raises
        ------
        InputError
            A value is out of range.
        """
        _checked(quantity, unit)
        kind = checked_pulse(kind, quantity)
        share = checks.number(rise, "rise", least=0.0, most=1.0)
        if quantity == "velocity" and kind == "triangle" and share in (0.0, 1.0):
            raise InputError("rise", f"must be > 0 and < 1 for a velocity, which must not jump; got {rise}")
        made = pulse_samples(kind, time_in(duration, "duration", unit), share)
        return cls._formula_record(made, amplitude, quantity, unit, {"name": kind, **more})

    @classmethod
    def sweep(
        cls,
        start: float | str,
        stop: float | str,
        duration: float | str,
        *,
        law: str = "linear",
        amplitude: float | str = 1.0,
        quantity: str = "acceleration",
        unit: str | None = None,
        **more: Any,
    ) -> "Record":
        """A sine of constant or changing frequency, such as a run-up, exact to rounding.

        Parameters
        ----------
        start, stop : float or str
            Frequencies at the beginning and at the end, > 0: in Hz, of a record without a unit over omega_1.
        duration : float or str
            Time between them, > 0.
        law : {"linear", "log"}
            Frequency over time: a straight line, or an exponential.
        amplitude, quantity, unit
            As of `pulse`.
        more
            `rise` and `fall`: times in which the amplitude grows from 0 at the beginning, and falls to 0 at
            the end, as 3 s^2 - 2 s^3 over the share s of the time; a displacement needs both, as the velocity
            of the base must not jump.  And mass, vector, scale, name of `Record`.

        Raises
        ------
        InputError
            A value is out of range, or the sweep needs more than 2 10^6 samples, 32 per cycle of the highest
            frequency.
        """
        _checked(quantity, unit)
        checks.choice(law, "law", LAWS)
        turn = angular(unit)
        first, last = (
            turn * frequency_in(value, name, unit) for name, value in (("start", start), ("stop", stop))
        )
        time = time_in(duration, "duration", unit)
        rising = _ramp(more.pop("rise", 0.0), "rise", unit, quantity, time)
        falling = _ramp(more.pop("fall", 0.0), "fall", unit, quantity, time - rising)
        made = sweep_series(first, last, time, law, rising, falling)
        return cls._formula_record(made, amplitude, quantity, unit, {"name": "sweep", **more})

    @classmethod
    def generate(
        cls,
        kind: str,
        duration: float | str,
        dt: float | str,
        *,
        seed: int = 0,
        count: int = 1,
        quantity: str = "acceleration",
        unit: str | None = None,
        interpolation: str | None = None,
        **more: Any,
    ) -> list["Record"]:
        """Random records of a spectral density; theory.md, Motions in time.

        Exactly one of `level`, `rms` and `peak` gives their size; a table needs none.

        Parameters
        ----------
        kind : {"white", "kanai-tajimi", "clough-penzien", "davenport", "table"}
            Spectral density.
        duration : float or str
            Of a record, to the nearest whole step: in seconds, without a unit in 1/omega_1.
        dt : float or str
            Time step.  The highest frequency is 1/(4 dt).
        seed : int
            0 to 2^64 - 1.  Record k of a seed is the same for any `count`.
        count : int
            Number of records.
        quantity, unit, interpolation : str, optional
            As of `Record`.
        level : float
            Factor of the density, which is one-sided, in the squared unit over Hz, without a unit over
            omega_1: of white noise the density itself, of "kanai-tajimi" and "clough-penzien" that of the
            bedrock, of "davenport" the square of the friction velocity.
        rms : float or str
            Standard deviation of the stationary process, without the envelope.
        peak : float or str
            Largest absolute sample of every record.
        envelope : str or dict, optional
            "trapezoid" or "jennings"; or a table with `kind` and times: `rise` and `fall` of a trapezoid;
            `rise`, `end` of the level, and `decay` (1 over time) of Jennings's.
        baseline : {"none", "mean", "linear"}, optional
            What is taken off the samples, as of `read`.
        more
            Keys of the kind: frequency and damping of the soil of "kanai-tajimi"; besides filter_frequency
            and filter_damping of "clough-penzien"; wind_speed in 10 m height [m/s] of "davenport"; frequency
            and density of "table", two or more values each, straight lines between them, 0 beyond them.
            And mass, vector, scale of `Record`.

        Raises
        ------
        InputError
            A key is unknown or missing, or a value out of range.
        """
        _checked(quantity, unit)
        how = interpolation or ("cubic" if quantity == "displacement" else "linear")
        checks.choice(how, "interpolation", INTERPOLATIONS)
        step = time_in(dt, "dt", unit)
        length = time_in(duration, "duration", unit)
        size = {key: more.pop(key, None) for key in ("level", "rms", "peak")}
        shape = more.pop("envelope", None)
        baseline = checks.choice(more.pop("baseline", "none"), "baseline", BASELINES)
        others = {key: more.pop(key) for key in ("mass", "vector", "scale") if key in more}
        noise = Noise(density_of(kind, more, unit), angular(unit), step, samples_in(length, step), how)
        checks.whole(seed, "seed", least=0, most=2**64 - 1)
        checks.whole(count, "count", least=1, most=2**63)
        times = step * np.arange(noise.size)
        factor = np.full(noise.size, _size(noise, size, kind, quantity, unit))
        if shape is not None:
            factor *= over_time(shape, length, unit)(times)
        found = []
        for k in range(count):
            values, note = corrected(factor * random_samples(noise, seed, k), times, baseline, unit)
            record = cls(
                values, step, quantity=quantity, unit=unit, interpolation=how, name=f"{kind} {k + 1}",
                source=f"{kind}, seed {seed}, record {k}", note=note, **others,
            )  # fmt: skip
            found.append(record)
        return found if size["peak"] is None else [record.scaled_to(size["peak"]) for record in found]

    @classmethod
    def _formula_record(
        cls,
        made: Corners | Pieces,
        amplitude: float | str,
        quantity: str,
        unit: str | None,
        more: Mapping[str, Any],
    ) -> "Record":
        size = number_in(amplitude, "amplitude", KINDS[quantity], unit and _unit(unit, quantity))
        given: dict[str, Any] = {"time": made.times, "quantity": quantity, "unit": unit, **more}
        if isinstance(made, Corners):
            return cls(size * made.values, interpolation=made.interpolation, **given)
        series = scaled(made, 1.0, size)
        return cls(np.append(series.terms[:, 0], series.ends[-1]), series=series, **given)

    def scaled_to(self, peak: float | str) -> "Record":
        """The record times a positive factor, so that its largest absolute sample is `peak`.

        Of a formula it is the largest absolute value.

        peak : in the unit of the record, or with a unit, > 0

        Raises
        ------
        InputError
            It is not above 0, or all samples are 0.
        """
        size = number_in(peak, "peak", KINDS[self.quantity], self.unit, above=0.0)
        largest = self._largest
        if largest == 0.0:
            raise InputError(f"cannot scale a record to peak {peak}: all its samples are 0; give another one")
        return replace(self, scale=math.copysign(size / largest, self.scale))

    def summary(self) -> str:
        """What the record is, line by line: samples, time step, duration, peak and its time, source.

        Values are those of the samples times `scale`.

        Examples
        --------
        >>> import frictionmap as fm
        >>> print(fm.Record([0.0, 0.3, -0.1], dt=0.01, unit="g", name="shock").summary())
        shock [record]
          quantity              base acceleration
          samples               3
          time step             0.01 s
          duration              0.02 s
          peak                  0.3 g at 0.01 s
          interpolation         linear
        """
        return "\n".join((f"{self.name or 'no name'} [record]", *self._rows()))

    def _rows(self) -> Iterator[str]:
        at, steps = float(self.times[np.argmax(np.abs(self.values))]), np.diff(self.times)
        second, unit = ("", "") if self.unit is None else (" s", f" {self.unit}")
        step = f"{steps[0]:.6g}{second}" if self.dt else f"{steps.min():.6g} to {steps.max():.6g}{second}"
        for name, text in (
            ("quantity", self.quantity if self.quantity == "force" else f"base {self.quantity}"),
            ("samples", f"{self.values.size:,}"),
            ("time step", step),
            ("duration", f"{self.duration:.6g}{second}"),
            ("peak", f"{self._largest * abs(self.scale):.4g}{unit} at {at:.6g}{second}"),
            ("interpolation", self.interpolation),
            ("source", self.source),
            ("note", self.note),
        ):
            if text:
                yield f"  {name:<21} {text}"

    def _repr_html_(self) -> str:
        return f"<pre>{self!r}</pre>"

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        second = " s" if self.unit else ""
        peak = self._largest * abs(self.scale)
        return (
            (
                f"<Record {self.name or ''}: {self.quantity}, {self.values.size:,} samples over "
                f"{self.duration:.6g}{second}, peak {peak:.4g}{unit}>"
            )
            .replace("  ", " ")
            .replace(" :", ":")
        )

    @property
    def _largest(self) -> float:
        """Largest absolute sample; of a formula also between the samples."""
        if self.series is not None:
            return float(np.abs(extremes(self.series)).max())
        return float(np.abs(self.values).max())

    @property
    def times(self) -> np.ndarray:
        """Times of the samples, (n,), the first one 0."""
        if self.dt is not None:
            return np.arange(self.values.size) * float(self.dt)
        return self.time - self.time[0]

    @property
    def duration(self) -> float:
        """Time from the first sample to the last."""
        return float(self.times[-1])

    @property
    def pieces(self) -> Pieces:
        """The record as polynomials between its samples, in its own units."""
        if self.series is not None:
            return scaled(self.series, 1.0, self.scale)
        times = self.times
        step = self.dt if self.dt is not None else even_step(times)
        if step is None:
            steps = levelled(np.diff(times), float(times[-1]))
        else:
            steps = np.full(times.size - 1, step)
            times = np.arange(times.size) * step
        ends = "clamped" if self.quantity == "displacement" else "natural"
        return interpolated(times, steps, self.values * self.scale, str(self.interpolation), ends)


def _ramp(given: float | str, name: str, unit: str | None, quantity: str, most: float) -> float:
    """Time in which the amplitude of a sweep rises or falls, within the time that is left."""
    found = time_in(given, name, unit, least=0.0, above=-math.inf)
    if found == 0.0 and quantity == "displacement":
        raise InputError(
            name, "must be > 0 for a displacement: the velocity of the base must not jump; got 0"
        )
    if found > most:
        less = "" if name == "rise" else " - rise"
        raise InputError(name, f"must be <= duration{less}, {most:g}; got {found:g}")
    return found


def _checked(quantity: str, unit: object) -> None:
    checks.choice(quantity, "quantity", QUANTITIES)
    if unit is not None:
        _unit(unit, quantity)


def _size(noise: Noise, sizes: Mapping[str, Any], kind: str, quantity: str, unit: str | None) -> float:
    """Factor of random samples, of the only size that is given."""
    given = [key for key, size in sizes.items() if size is not None]
    if len(given) > 1:
        raise InputError(
            "cannot use", given[1], f"with {given[0]}: both are the size of the record; omit one"
        )
    if not given and kind != "table":
        raise InputError("level", "must be given, or rms, or peak; got none of them")
    if given == ["level"]:
        return math.sqrt(checks.number(sizes["level"], "level", above=0.0))
    if given == ["rms"]:
        return number_in(sizes["rms"], "rms", KINDS[quantity], unit, above=0.0) / math.sqrt(variance(noise))
    return 1.0


def _unit(given: object, quantity: str) -> str:
    """A unit of the quantity as the table of units writes it."""
    unit = known_unit(given) if isinstance(given, str) else None
    if unit is None or UNITS[unit].measures != KINDS[quantity]:
        valid = units_of(KINDS[quantity])
        measures = UNITS[unit].measures if unit else ""
        meant = next((name for name, kind in KINDS.items() if kind == measures), "")
        hint = f": it is a unit of {measures}" if unit else ""
        hint += f'; give quantity = "{meant}"' if meant else ""
        raise InputError(
            "unit",
            f"must be one of {', '.join(valid)} for this quantity, {quantity}; got "
            f"{checks.one_line(given)}{hint}",
        )
    return unit


def _source(file: Path, series: Series) -> str:
    """Name and checksum of a file, and what it says."""
    said = f": {series.header}" if series.header else ""
    return f"{file.name} (crc32 {zlib.crc32(file.read_bytes()):08x}){said}"


def _samples(given: object, name: str, least: int = 2) -> np.ndarray:
    values = checks.array(given, name).astype(float)
    if values.ndim != 1 or values.size < least:
        raise InputError(name, f"must be a list of at least {least} numbers; got shape {values.shape}")
    if not np.isfinite(values).all():
        k = int(np.argmin(np.isfinite(values)))
        raise InputError(f"{name}[{k}]", f"must be finite; got {values[k]}")
    return values


def _times(given: object, count: int) -> np.ndarray:
    times = _samples(given, "time")
    if times.size != count:
        raise InputError("time", f"must have as many values as the record ({count}); got {times.size}")
    falls = np.diff(times) <= 0.0
    if falls.any():
        k = int(np.argmax(falls)) + 1
        raise InputError(f"time[{k}]", f"must be above the one before it, {times[k - 1]:g}; got {times[k]:g}")
    return times


def checked_records(given: Any, name: str) -> tuple[Record, ...]:
    """One record or several of them, checked; `name` is the argument."""
    if isinstance(given, (str, os.PathLike)):
        read = f"fm.Record.read({os.fspath(given)!r})"
        raise InputError(name, f"must be a Record; got {os.fspath(given)!r}: read it with {read}")
    several = isinstance(given, Sequence)
    listed = tuple(given) if several else (given,)
    if not listed:
        raise InputError(name, "must be a Record or a list of them; got none")
    for k, one in enumerate(listed):
        checks.instance(one, f"{name}[{k}]" if several else name, Record)
    return listed

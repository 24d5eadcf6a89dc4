"""`Record`: a load or a base motion over time."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.shown import Shown
from .pieces import INTERPOLATIONS, Pieces, even_step, interpolated

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

    Raises
    ------
    InputError
        A value is not finite or out of range, or two exclude each other.

    Notes
    -----
    theory.md, Motions in time.
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
    source: str = field(default="", compare=False)

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
        self._check_shape()

    def _check_shape(self) -> None:
        if self.quantity != "force":
            for key in ("mass", "vector"):
                if getattr(self, key) is not None:
                    raise InputError(
                        "cannot use", key, f"with a base {self.quantity}, which loads all masses; omit it"
                    )
        if self.mass is not None and self.vector is not None:
            raise InputError("cannot use", "vector", "with mass: both say where the force acts; omit one")
        if self.vector is not None:
            vector = _samples(self.vector, "vector", least=1)
            self._set("vector", tuple(vector.tolist()))

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _repr_html_(self) -> str:
        return f"<pre>{self!r}</pre>"

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        peak = float(np.abs(self.values).max() * abs(self.scale))
        return (
            (
                f"<Record {self.name or ''}: {self.quantity}, {self.values.size} samples over "
                f"{self.duration:.6g}, peak {peak:.4g}{unit}>"
            )
            .replace("  ", " ")
            .replace(" :", ":")
        )

    @property
    def times(self) -> np.ndarray:
        """Times of the samples, (n,), the first one 0."""
        if self.dt is not None:
            return np.arange(self.values.size) * self.dt
        return self.time - self.time[0]

    @property
    def duration(self) -> float:
        """Time from the first sample to the last."""
        return float(self.times[-1])

    @property
    def pieces(self) -> Pieces:
        """The record as polynomials between its samples, in its own units."""
        times = self.times
        step = self.dt if self.dt is not None else even_step(times)
        if step is None:
            steps = np.diff(times)
        else:
            steps = np.full(times.size - 1, step)
            times = np.arange(times.size) * step
        ends = "clamped" if self.quantity == "displacement" else "natural"
        return interpolated(times, steps, self.values * self.scale, str(self.interpolation), ends)


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

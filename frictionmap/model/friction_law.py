"""Friction over the sliding speed: a continuous law of straight segments, or a formula brought to that form.

    f = beta g(V) sgn w,   V = r |w|,   g = g_k + a_k (V - V_k) for V_k <= V < V_k+1,   g(0) = 1

Speeds V are over omega_1 P/k_1.
"""

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from .periodic_load import number_rows
from .shown import Shown

#: Break points of a law at most.
MOST_POINTS = 24

#: Deviation of the segments from a formula, over the friction at speed 0, where none is given.
ERROR = 0.01

#: Points over the range of a formula for the integral that the segments share.  Its error is below 1e-6 of
#: it: it moves the break points along the curve, on which they stay.
_SAMPLES = 20001

#: Points in a segment among which its largest deviation is looked for, within 1e-4 of it.
_INSIDE = 129

KEYS = ("speed", "factor", "slope")
FORMULA_KEYS = ("formula", "kinetic", "speed", "viscous", "error")


class _Shape(NamedTuple):
    """A function that falls from 1 to 0."""

    value: Callable[[np.ndarray], np.ndarray]
    slope: Callable[[np.ndarray], np.ndarray]  # its derivative
    bend: Callable[[np.ndarray], np.ndarray]  # its second derivative
    steepest: float  # where it falls most: beyond, it falls ever less
    range: float  # up to which it is followed: beyond, the viscous part alone is left


#: How the friction falls from its value at rest to the kinetic one, over the speed in units of its own.
SHAPES = {
    "exponential": _Shape(lambda y: np.exp(-y), lambda y: -np.exp(-y), lambda y: np.exp(-y), 0.0, 9.0),
    "gauss": _Shape(
        lambda y: np.exp(-y * y),
        lambda y: -2.0 * y * np.exp(-y * y),
        lambda y: (4.0 * y * y - 2.0) * np.exp(-y * y),
        math.sqrt(0.5),
        3.2,
    ),
    "hyperbolic": _Shape(
        lambda y: 1.0 / (1.0 + y), lambda y: -1.0 / (1.0 + y) ** 2, lambda y: 2.0 / (1.0 + y) ** 3, 0.0, 20.0
    ),
    "lorentz": _Shape(
        lambda y: 1.0 / (1.0 + y * y),
        lambda y: -2.0 * y / (1.0 + y * y) ** 2,
        lambda y: (6.0 * y * y - 2.0) / (1.0 + y * y) ** 3,
        math.sqrt(1.0 / 3.0),
        10.0,
    ),
}


class Formula(NamedTuple):
    """g = q + (1 - q) s(V/V_s) + k V."""

    formula: str
    kinetic: float
    speed: float
    viscous: float
    error: float  # that its segments may have

    def slope(self, speed: np.ndarray) -> np.ndarray:
        """g' at speeds."""
        falls = SHAPES[self.formula].slope(speed / self.speed) / self.speed
        return (1.0 - self.kinetic) * falls + self.viscous

    def last_fall(self, fall: float) -> float:
        """Largest speed at which g falls at least as steeply as `fall`; 0 if it does nowhere."""
        if fall == 0.0 and self.viscous == 0.0 and self.kinetic < 1.0:
            return math.inf
        steepest = SHAPES[self.formula].steepest
        low, high = steepest * self.speed, 2.0 * max(steepest, 1.0) * self.speed
        if -self.slope(np.array(low)) < fall:
            return 0.0
        while -self.slope(np.array(high)) >= fall:
            high *= 2.0
        while True:
            middle = 0.5 * (low + high)
            if middle in (low, high):
                return low
            low, high = (middle, high) if -self.slope(np.array(middle)) >= fall else (low, middle)


@dataclass(frozen=True, repr=False)
class FrictionLaw(Shown):
    """Friction that depends on the sliding speed.

    Parameters
    ----------
    speed : sequence of float
        Break points, over omega_1 P/k_1 [-]: 0 first, increasing, at most 24.
    factor : sequence of float
        Friction there over that just above speed 0 [-], >= 0: 1 first.
    slope : float
        Slope of `factor` over `speed` beyond the last break point [-], >= 0.
    error : float
        Largest deviation from the formula that the law was made of [-]; 0 without one.
    curve : Formula, optional
        That formula.

    Raises
    ------
    InputError
        A value has the wrong type or is out of range.

    Examples
    --------
    Friction that falls by 40 % up to the speed omega_1 P/k_1, and is constant beyond it:

    >>> import frictionmap as fm
    >>> law = fm.FrictionLaw(speed=[0.0, 1.0], factor=[1.0, 0.6])
    >>> system = fm.System(contacts=[fm.Contact(law=law)], damping_ratios=0.05)
    >>> fm.sweep(system, r=[0.6], beta=[0.1]).frictionmap.labels.item()
    'continuous'
    """

    speed: Sequence[float] = (0.0,)
    factor: Sequence[float] = (1.0,)
    slope: float = 0.0
    error: float = 0.0
    curve: Formula | None = None

    def __post_init__(self) -> None:
        for name in ("speed", "factor"):
            object.__setattr__(self, name, checks.number_list(getattr(self, name), name))
        for name in ("slope", "error"):
            object.__setattr__(self, name, checks.number(getattr(self, name), name))
        self._check_points()
        self._check_factors()

    def _check_points(self) -> None:
        speed = self.speed
        if len(speed) != len(self.factor):
            raise InputError(
                "factor", f"must have as many values as speed ({len(speed)}); got {len(self.factor)}"
            )
        if len(speed) > MOST_POINTS:
            raise InputError("speed", f"must have at most {MOST_POINTS} break points; got {len(speed)}")
        if speed[0] != 0.0:
            raise InputError("speed", f"must begin with 0; got {speed[0]:g}")
        for k in range(1, len(speed)):
            if speed[k] <= speed[k - 1]:
                raise InputError("speed", f"must increase; got {speed[k]:g} after {speed[k - 1]:g}")

    def _check_factors(self) -> None:
        if self.factor[0] != 1.0:
            raise InputError(
                "factor",
                f"must begin with 1, the friction just above speed 0; got {self.factor[0]:g}; divide all by "
                f"it, and give static friction as mu",
            )
        if min(self.factor) < 0.0:
            raise InputError("factor", f"must be >= 0; got {min(self.factor):g}")
        if self.slope < 0.0:
            raise InputError(
                "slope",
                f"must be >= 0, as friction that falls for ever becomes negative; got {self.slope:g}; give "
                f"a further break point where it ends",
            )

    @property
    def slopes(self) -> tuple[float, ...]:
        """Slope of every segment."""
        inner = np.diff(self.factor) / np.diff(self.speed)
        return (*map(float, inner), self.slope)

    def slopes_at(self, speed: np.ndarray, segments: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Slopes just below and just above speeds > 0: those of the formula, if there is one.

        segments : those of the segments in any case
        """
        if self.curve is not None and not segments:
            found = self.curve.slope(speed)
            return found, found
        breaks, slopes = np.array(self.speed), np.array(self.slopes)
        below = slopes[np.searchsorted(breaks, speed, side="left") - 1]
        return below, slopes[np.searchsorted(breaks, speed, side="right") - 1]

    def last_fall(self, fall: float) -> float:
        """Largest speed at which the friction falls, at least as steeply as `fall`; 0 if nowhere."""
        if self.curve is not None:
            return self.curve.last_fall(fall)
        ends = [*self.speed[1:], math.inf]
        falls = (v for v, slope in zip(ends, self.slopes, strict=True) if slope < 0.0 and -slope >= fall)
        return max(falls, default=0.0)

    @property
    def least_slope(self) -> float:
        """The slope of the steepest fall; 0 if the friction falls nowhere."""
        return min(0.0, *self.slopes)

    def as_keys(self) -> dict[str, Any]:
        """The law as the table `law` of a configuration."""
        if self.curve is not None:
            return self.curve._asdict()
        return {"speed": list(self.speed), "factor": list(self.factor), "slope": self.slope}

    @property
    def is_flat(self) -> bool:
        """Whether the friction does not depend on the speed."""
        return not any(self.slopes)

    def __call__(self, speed: Any) -> np.ndarray:
        """Friction over that just above speed 0 at speeds >= 0."""
        v = np.asarray(speed, dtype=float)
        return np.interp(v, self.speed, self.factor) + self.slope * np.maximum(v - self.speed[-1], 0.0)


def formula_law(
    formula: str, kinetic: Any = None, speed: Any = None, viscous: Any = 0.0, error: Any = ERROR
) -> FrictionLaw:
    """Segments for g = q + (1 - q) s(V/V_s) + k V, with break points on the curve.

    Each segment has an equal share of the integral of sqrt |g''|: the deviation is then nearly the same in
    all of them, and least for their number.  The number is the least that keeps it within `error`.

    Parameters
    ----------
    formula : {"exponential", "gauss", "hyperbolic", "lorentz"}
        s(y) = e^-y, e^-y^2, 1/(1 + y), 1/(1 + y^2).
    kinetic : float
        q, friction at high speed over that just above speed 0, >= 0.
    speed : float
        V_s over omega_1 P/k_1, > 0.
    viscous : float
        k, slope that is added, >= 0.
    error : float
        Largest deviation of the segments, up to 9, 3.2, 20 and 10 V_s; beyond, s stays as it is there.
    """
    shape = SHAPES[checks.choice(formula, "formula", tuple(SHAPES))]
    q, unit = checks.number(kinetic, "kinetic", least=0.0), checks.number(speed, "speed", above=0.0)
    k, limit = checks.number(viscous, "viscous", least=0.0), checks.number(error, "error", above=0.0)
    found = math.inf
    for segments in range(1, MOST_POINTS):
        y = _shared(shape, segments)
        found = abs(1.0 - q) * _deviation(shape, y)
        if found <= limit:
            factor = q + (1.0 - q) * shape.value(y) + k * unit * y
            factor[0] = 1.0
            curve = Formula(formula, q, unit, k, limit)
            return FrictionLaw(tuple((unit * y).tolist()), tuple(factor.tolist()), k, found, curve)
    raise InputError(
        "error",
        f"must be >= {found:.2g}, which {MOST_POINTS} break points reach for {formula}; got {limit:g}",
    )


def _shared(shape: _Shape, segments: int) -> np.ndarray:
    """Break points over the range with equal shares of the integral of sqrt |s''|."""
    y = np.linspace(0.0, shape.range, _SAMPLES)
    rate = np.sqrt(np.abs(shape.bend(y)))
    whole = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(y))))
    return np.interp(np.linspace(0.0, whole[-1], segments + 1), whole, y)


def _deviation(shape: _Shape, y: np.ndarray) -> float:
    """Largest deviation of the chords between break points from the curve."""
    share = np.linspace(0.0, 1.0, _INSIDE)[:, np.newaxis]
    value = shape.value(y)
    chord = value[:-1] + share * np.diff(value)
    return float(np.abs(shape.value(y[:-1] + share * np.diff(y)) - chord).max())


def law_table(path: str | os.PathLike) -> FrictionLaw:
    """Read a CSV file with the columns speed, factor; the friction is constant beyond the last row."""
    rows = number_rows(Path(path), ("speed", "factor"), "law_file")
    try:
        return FrictionLaw([row["speed"] for row in rows], [row["factor"] for row in rows])
    except InputError as error:
        raise InputError("law_file", f": {error} in {path}") from None


def friction_law(given: Any) -> FrictionLaw:
    """The law of a key `law`: { speed, factor, slope }, { formula, ... } or a `FrictionLaw`."""
    if isinstance(given, FrictionLaw):
        return given
    if not isinstance(given, Mapping):
        raise InputError(
            "law",
            f"must be {{ {', '.join(KEYS)} }}, {{ {', '.join(FORMULA_KEYS)} }} or a FrictionLaw; "
            f"got {checks.one_line(given)}",
        )
    valid, needed = (FORMULA_KEYS, FORMULA_KEYS[:3]) if "formula" in given else (KEYS, KEYS[:2])
    for key in given:
        if key not in valid:
            raise InputError(
                f"unknown key {f'law.{key}'!r}{checks.nearest(str(key), valid)}; valid: {', '.join(valid)}"
            )
    for key in needed:
        if key not in given:
            raise InputError(f"law.{key}", f"must be given in a law {{ {', '.join(valid)} }}; got none")
    try:
        return formula_law(**given) if "formula" in given else FrictionLaw(**given)
    except InputError as error:
        raise error.renamed(f"law.{error.where}") from None

"""Conversion of values and ranges with units to ratios, and back to short decimal numbers."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from .quantities import is_foreign, is_plain_number, quantities, quantity, unit_of_array
from .scales import NO_SCALES, Scales, Wanted, rounded

#: Quantities that the ratios of a grid refer to.
KINDS = {"r": "frequency", "beta": "force"}


@dataclass(frozen=True)
class Ladder:
    """A range in exact numbers: `count` values from the first on, the last one as it was given."""

    first: Fraction
    step: Fraction
    last: Fraction
    count: int

    def values(self) -> np.ndarray:
        """All values, each rounded once."""
        below = math.lcm(self.first.denominator, self.step.denominator)
        first, step = int(self.first * below), int(self.step * below)
        values = np.array([(first + k * step) / below for k in range(self.count)])
        values[-1] = float(self.last)
        return values


#: Text that begins as a number does, and is no number alone.
_BEGINS = re.compile(r"[+-]?\.?[0-9]")


def has_units(values: Any) -> bool:
    """Whether a number, a list or a range has a unit somewhere, right or wrong."""
    if isinstance(values, str):
        return _BEGINS.match(values) is not None and not is_plain_number(values)
    if isinstance(values, (list, tuple)):
        return any(has_units(value) for value in values)
    if isinstance(values, Mapping):
        return any(has_units(value) for value in values.values())
    return is_foreign(values) or unit_of_array(values) is not None


def needs(values: Any, name: str, kind: str) -> list[Wanted]:
    """What a value, a list or a range needs to become ratios; units of another kind are refused elsewhere."""
    return [Wanted(kind, name, values)] if _has_valid(values, kind) else []


def _has_valid(values: Any, kind: str) -> bool:
    """Whether a number with a unit of this kind is somewhere in a value, a list or a range."""
    if isinstance(values, Mapping):
        return any(_has_valid(value, kind) for value in values.values())
    if isinstance(values, (list, tuple)):
        return any(_has_valid(value, kind) for value in values)
    try:
        return quantities(values, "", kind) is not None
    except InputError:
        return False


def require(scales: Scales, **given: tuple[str, Any]) -> None:
    """Refuse arguments with units of which a reference value is missing, all of them in one message.

    given : kind and value of every argument
    """
    scales.require([one for name, (kind, values) in given.items() for one in needs(values, name, kind)])


def ratios(values: Any, name: str, kind: str, scales: Scales) -> Any:
    """Convert values of an axis to ratios, each rounded once; numbers without units are returned unchanged.

    Raises
    ------
    InputError
        A value is no number with a unit of its kind, some have units and others none, or `scales` lack what
        they are over.
    """
    try:
        found = quantities(values, name, kind)
    except InputError:
        if scales is NO_SCALES and isinstance(values, (str, list, tuple)):
            return values  # for the checks of numbers without units, which report the error
        raise
    if found is None:
        return values
    one = scales.needed(kind, name, values)
    return [rounded(value / one) for value in found]


def grid_ratios(axis: Any, name: str, kind: str, scales: Scales) -> Any:
    """Convert a valid axis of a configuration to ratios; see `ratios`.

    A range with units becomes a `Ladder`.
    """
    if not isinstance(axis, Mapping):
        return ratios(axis, name, kind, scales)
    if "values" in axis:
        listed = isinstance(axis["values"], list)
        return {"values": ratios(axis["values"], f"{name}.values", kind, scales)} if listed else axis
    ends = [axis[key] for key in ("start", "stop", "step") if key in axis]
    if not any(isinstance(end, str) for end in ends):
        return axis
    try:
        return _ladder(axis, name, kind, scales)
    except InputError:
        if scales is NO_SCALES and not _has_valid(axis, kind):
            return axis
        raise


def _ladder(axis: Mapping[str, Any], name: str, kind: str, scales: Scales) -> Ladder:
    given = {
        key: quantity(axis[key], f"{name}.{key}", kind) for key in ("start", "stop", "step") if key in axis
    }
    one = scales.needed(kind, name, axis)
    start, stop = (given[key].value / one for key in ("start", "stop"))
    if stop < start:
        raise InputError(f"{name}.stop", f"must be >= start ({axis['start']}); got {axis['stop']!r}")
    if math.isinf(rounded(stop)) or math.isinf(rounded(start)):
        raise InputError(name, f"must be finite; got {checks.one_line(axis)}")
    if "num" in axis:
        return _spaced_by_number(start, stop, axis, name)
    if given["step"].value <= 0:
        raise InputError(f"{name}.step", f"must be > 0; got {axis['step']!r}")
    step = given["step"].value / one
    steps = math.ceil((stop - start) / step)
    if steps >= checks.MOST_CELLS:
        raise InputError(
            f"{name}.step",
            f"must leave at most {checks.MOST_CELLS:.0e} values; got {axis['step']!r}, which "
            f"makes {rounded(Fraction(steps + 1)):.3g}",
        )
    return Ladder(start, step, stop, steps + 1)


def _spaced_by_number(start: Fraction, stop: Fraction, axis: Mapping[str, Any], name: str) -> Ladder:
    """Make a range with a given number of values."""
    num = checks.whole(axis["num"], f"{name}.num", least=1, most=checks.MOST_CELLS)
    if num == 1 and stop > start:
        raise InputError(
            f"{name}.num", f"must be >= 2 to hold both {axis['start']} and {axis['stop']}; got 1"
        )
    return Ladder(start, (stop - start) / max(1, num - 1), stop, num)


def typed(ratios: np.ndarray, one: Fraction) -> np.ndarray:
    """Frequencies or forces of ratios, with the fewest digits that distinguish them.

    So 1.05 Hz over 4.2 Hz, a ratio that was rounded, is 1.05 Hz again.
    """
    flat = [_fewest_digits(float(ratio), one) for ratio in np.ravel(ratios)]
    return np.array(flat).reshape(np.shape(ratios))


def _fewest_digits(ratio: float, one: Fraction) -> float:
    value = rounded(Fraction(ratio) * one)
    for digits in (15, 16):
        short = f"{value:.{digits}g}"
        if math.isfinite(value) and rounded(Fraction(Decimal(short)) / one) == ratio:
            return float(short)
    return value

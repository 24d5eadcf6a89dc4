"""Units that names of columns end in."""

import math
from typing import NamedTuple

from .. import checks
from ..errors import InputError


class Unit(NamedTuple):
    """What a unit measures, and its size in the SI unit of that, Hz for frequencies."""

    measures: str
    size: float


UNITS = {
    "s": Unit("time", 1.0),
    "ms": Unit("time", 1e-3),
    "mm": Unit("length", 1e-3),
    "m": Unit("length", 1.0),
    "um": Unit("length", 1e-6),
    "Hz": Unit("frequency", 1.0),
    "rad_s": Unit("frequency", 0.5 / math.pi),
    "deg": Unit("angle", math.pi / 180.0),
    "rad": Unit("angle", 1.0),
    "N": Unit("force", 1.0),
}


def suffixes(measures: str) -> tuple[str, ...]:
    """Suffixes of the units of time, length, frequency, angle or force; a ratio has none."""
    return tuple(f"_{name}" for name, unit in UNITS.items() if unit.measures == measures)


def ending(name: str) -> str:
    """The unit that a name ends in, or what stands in its place after the last underscore."""
    known = [unit for unit in UNITS if name.endswith(f"_{unit}")]
    return max(known, key=len) if known else name.rpartition("_")[2] if "_" in name else ""


def conversion(unit: str, into: str) -> float:
    """What a number in one unit is multiplied by to be in another."""
    return UNITS[unit].size / UNITS[into].size


def checked_unit(unit: str, measures: str, name: str) -> str:
    """`unit`, if it is one of those of time, length or frequency."""
    legal = tuple(suffix[1:] for suffix in suffixes(measures))
    if unit not in legal:
        raise InputError(f"{name} must be one of {', '.join(legal)}; got {checks.one_line(unit)}")
    return unit

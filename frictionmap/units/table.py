"""Table of known units with their exact sizes.

Sizes are exact fractions of the SI unit, Hz for frequencies; only pi is rounded, to 50 digits, and cancels
where a ratio is of two angular frequencies.  1 in = 0.0254 m, 1 lb = 0.45359237 kg (1959); standard gravity
g = 9.80665 m/s^2 (1901), so 1 lbf = 4.4482216152605 N.
"""

import re
import textwrap
from fractions import Fraction
from typing import Any, NamedTuple

from .. import checks
from ..errors import InputError

#: 50 digits: an error of 1e-50 is no part of any double.
PI = Fraction("3.14159265358979323846264338327950288419716939937510")

_INCH, _FOOT, _POUND, _GRAVITY = (
    Fraction("0.0254"),
    Fraction("0.3048"),
    Fraction("0.45359237"),
    Fraction("9.80665"),
)
_POUND_FORCE = _POUND * _GRAVITY


class Unit(NamedTuple):
    """A unit: quantity, size in SI units, suffix of measured columns."""

    measures: str
    size: Fraction
    column: str = ""  # nothing: columns of measured data are not in it


#: Units by their spelling; the first of its kind is used to report values of that kind.
UNITS = {
    "Hz": Unit("frequency", Fraction(1), "Hz"),
    "kHz": Unit("frequency", Fraction(1000), "kHz"),
    "rad/s": Unit("frequency", 1 / (2 * PI), "rad_s"),
    "rpm": Unit("frequency", Fraction(1, 60), "rpm"),
    "N": Unit("force", Fraction(1), "N"),
    "mN": Unit("force", Fraction(1, 1000), "mN"),
    "kN": Unit("force", Fraction(1000), "kN"),
    "lbf": Unit("force", _POUND_FORCE, "lbf"),
    "mm": Unit("length", Fraction(1, 1000), "mm"),
    "m": Unit("length", Fraction(1), "m"),
    "um": Unit("length", Fraction(1, 10**6), "um"),
    "in": Unit("length", _INCH, "in"),
    "cm": Unit("length", Fraction(1, 100), "cm"),
    "ft": Unit("length", _FOOT, "ft"),
    "kg": Unit("mass", Fraction(1)),
    "lb": Unit("mass", _POUND),
    "N/m": Unit("stiffness", Fraction(1)),
    "N/mm": Unit("stiffness", Fraction(1000)),
    "kN/m": Unit("stiffness", Fraction(1000)),
    "kN/mm": Unit("stiffness", Fraction(10**6)),
    "lbf/in": Unit("stiffness", _POUND_FORCE / _INCH),
    "N s/m": Unit("viscosity", Fraction(1)),
    "N s/mm": Unit("viscosity", Fraction(1000)),
    "kN s/m": Unit("viscosity", Fraction(1000)),
    "lbf s/in": Unit("viscosity", _POUND_FORCE / _INCH),
    "m/s": Unit("velocity", Fraction(1), "m_s"),
    "mm/s": Unit("velocity", Fraction(1, 1000), "mm_s"),
    "cm/s": Unit("velocity", Fraction(1, 100), "cm_s"),
    "in/s": Unit("velocity", _INCH, "in_s"),
    "m/s^2": Unit("acceleration", Fraction(1), "m_s2"),
    "mm/s^2": Unit("acceleration", Fraction(1, 1000), "mm_s2"),
    "g": Unit("acceleration", _GRAVITY, "g"),
    "cm/s^2": Unit("acceleration", Fraction(1, 100), "cm_s2"),
    "in/s^2": Unit("acceleration", _INCH, "in_s2"),
    "J": Unit("work", Fraction(1)),
    "mJ": Unit("work", Fraction(1, 1000)),
    "kJ": Unit("work", Fraction(1000)),
    "s": Unit("time", Fraction(1), "s"),
    "ms": Unit("time", Fraction(1, 1000), "ms"),
    "us": Unit("time", Fraction(1, 10**6), "us"),
    "min": Unit("time", Fraction(60), "min"),
    "1/s": Unit("rate", Fraction(1)),
    "N m^2": Unit("bending stiffness", Fraction(1)),
    "N mm^2": Unit("bending stiffness", Fraction(1, 10**6)),
    "kN m^2": Unit("bending stiffness", Fraction(1000)),
    "N m": Unit("plate stiffness", Fraction(1)),
    "N mm": Unit("plate stiffness", Fraction(1, 1000)),
    "kN m": Unit("plate stiffness", Fraction(1000)),
    "GPa": Unit("modulus", Fraction(10**9)),
    "MPa": Unit("modulus", Fraction(10**6)),
    "Pa": Unit("modulus", Fraction(1)),
    "N/mm^2": Unit("modulus", Fraction(10**6)),
    "psi": Unit("modulus", _POUND_FORCE / _INCH**2),
    "kg/m^3": Unit("density", Fraction(1)),
    "g/cm^3": Unit("density", Fraction(1000)),
    "t/m^3": Unit("density", Fraction(1000)),
    "lb/in^3": Unit("density", _POUND / _INCH**3),
    "kg/m": Unit("mass per length", Fraction(1)),
    "g/m": Unit("mass per length", Fraction(1, 1000)),
    "lb/ft": Unit("mass per length", _POUND / _FOOT),
    "kg/m^2": Unit("mass per area", Fraction(1)),
    "g/m^2": Unit("mass per area", Fraction(1, 1000)),
    "lb/ft^2": Unit("mass per area", _POUND / _FOOT**2),
    "deg": Unit("angle", PI / 180, "deg"),
    "rad": Unit("angle", Fraction(1), "rad"),
    "mrad": Unit("angle", Fraction(1, 1000), "mrad"),
}

#: Other ways to write one: the two signs for micro, the gal of seismology, the second, the degree.
_ALIASES = {
    "\u00b5m": "um", "\u03bcm": "um", "\u00b5s": "us", "\u03bcs": "us", "Gal": "cm/s^2", "gal": "cm/s^2",
    "sec": "s", "\u00b0": "deg",
}  # fmt: skip

#: Accelerations may be written with a raised two, with a bare one, or by powers.
_ALIASES |= {
    name.replace("/s^2", power): name
    for name in UNITS
    if name.endswith("/s^2")
    for power in ("/s\u00b2", "/s2", "/s**2", "/s/s", "/sec^2", "/sec2")
}
_ALIASES |= {name.replace("/s", "/sec"): name for name in UNITS if name.endswith("/s")}

#: Units of dashpots may be written without the space in them.
_ALIASES |= {
    name.replace(" s", joined): name
    for name, unit in UNITS.items()
    if unit.measures == "viscosity"
    for joined in ("s", "*s", "\u00b7s")
}

#: Units that names of columns may end in, by how they do.
COLUMN_UNITS = {unit.column: unit for unit in UNITS.values() if unit.column}

#: How the table writes the units that names of columns end in.
COLUMN_NAMES = {unit.column: name for name, unit in UNITS.items() if unit.column}

#: What motion is measured as, in the order of its derivatives.
MOTIONS = ("length", "velocity", "acceleration")

#: What columns may measure that take more than one quantity.
_SEVERAL = {"motion": MOTIONS, "swing": (*MOTIONS, "angle")}


def units_of(measures: str) -> tuple[str, ...]:
    """Units of a kind: frequency, force, length, mass, stiffness, viscosity, velocity, time, angle, ..."""
    return tuple(name for name, unit in UNITS.items() if unit.measures == measures)


def spellings(measures: str) -> tuple[str, ...]:
    """All ways to write the units of a kind."""
    valid = units_of(measures)
    return (*valid, *(other for other, name in _ALIASES.items() if name in valid))


def known_unit(text: str) -> str | None:
    """A unit as the table writes it; None if there is none."""
    name = _ALIASES.get(text, text)
    return name if name in UNITS else None


def suffixes(measures: str) -> tuple[str, ...]:
    """Suffixes of columns of time, length, frequency, angle or force; none for a ratio.

    A column of "motion" is one of `MOTIONS`, one of "swing" also an angle.
    """
    kinds = _SEVERAL.get(measures, (measures,))
    return tuple(f"_{name}" for kind in kinds for name, unit in COLUMN_UNITS.items() if unit.measures == kind)


def ending(name: str) -> str:
    """The unit that a name ends in, or what stands in its place after the last underscore."""
    known = [unit for unit in COLUMN_UNITS if name.endswith(f"_{unit}")]
    return max(known, key=len) if known else name.rpartition("_")[2] if "_" in name else ""


def conversion(unit: str, into: str) -> float:
    """Conversion factor from one unit of columns to another."""
    return float(COLUMN_UNITS[unit].size / COLUMN_UNITS[into].size)


def checked_unit(unit: str, measures: str, name: str) -> str:
    """`unit`, if columns of time, length or frequency may have it."""
    valid = tuple(suffix[1:] for suffix in suffixes(measures))
    if unit not in valid:
        raise InputError(name, f"must be one of {', '.join(valid)}; got {checks.one_line(unit)}")
    return unit


#: A number and the unit or per cent behind it; of units that begin alike the longest one.
_WITH_UNIT = re.compile(
    rf"(?<=\d) ({'|'.join(map(re.escape, sorted((*UNITS, *_ALIASES, '%'), key=len, reverse=True)))})(?![\w^])"
)

_NO_BREAK = "\N{NO-BREAK SPACE}"


def wrapped(text: str, width: int, **options: Any) -> list[str]:
    """Wrap text; no line ends between a number and its unit, or beside an equals sign.

    options : those of `textwrap.wrap`
    """
    joined = _WITH_UNIT.sub(lambda found: found[0].replace(" ", _NO_BREAK), text)
    joined = joined.replace(" = ", f"{_NO_BREAK}={_NO_BREAK}")
    lines = textwrap.wrap(joined, width, break_on_hyphens=False, **options)
    return [line.replace(_NO_BREAK, " ") for line in lines]


#: Units that pictures and words choose from, and the size in the SI unit from which each is handy.
_HANDY = {
    "frequency": {"Hz": 0.0, "kHz": 1e4},
    "force": {"mN": 0.0, "N": 0.1, "kN": 1e4},
    "length": {"um": 0.0, "mm": 1e-4, "m": 1.0},
    "time": {"ms": 0.0, "s": 1.0},
    "work": {"mJ": 0.0, "J": 0.1, "kJ": 1e4},
    "velocity": {"mm/s": 0.0, "m/s": 1.0},
}


def handy_unit(size: float, measure: str) -> str:
    """The unit of frequency, force, length, time, work or velocity in which a size in SI units is handy."""
    return [unit for unit, least in _HANDY[measure].items() if size >= least][-1]

"""A number with its unit as an exact number: text such as "4.2 Hz", or a quantity of pint, astropy or unyt.

Text is neither guessed nor repaired.  Quantities of other packages are converted by their own
`to` and `to_value`, into a unit that is chosen here: pint takes 1 Hz for 1 rad/s.
"""

import math
import re
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from .table import UNITS, known_unit, units_of

#: A number with a decimal point, then its unit, with one space between them or none.  A unit begins with a
#: letter, or is 1/s; those of dashpots and of bending stiffness have a space in them.
NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_TEXT = re.compile(
    rf"({NUMBER})(?: ?([A-Za-z\u00b5\u03bc]\S*(?: s/m{{1,2}}| s/in| m{{1,2}}\^2| m{{1,2}})?)| (1/s))"
)
_NO_NUMBER = re.compile(r"[+-]?(nan|inf|infinity)\b", re.IGNORECASE)
_COMMA = re.compile(r"[+-]?[0-9.]*,[0-9]")

#: What a message shows of a kind.
EXAMPLES = {
    "frequency": "4.2 Hz",
    "force": "12.5 N",
    "length": "0.5 mm",
    "mass": "2 kg",
    "stiffness": "3 N/mm",
    "acceleration": "0.5 g",
    "velocity": "0.2 m/s",
    "viscosity": "3 N s/m",
    "rate": "0.1 1/s",
    "time": "0.5 s",
    "bending stiffness": "21 N m^2",
    "plate stiffness": "150 N m",
    "modulus": "210 GPa",
    "density": "7850 kg/m^3",
    "mass per length": "0.78 kg/m",
    "mass per area": "16 kg/m^2",
}

#: The units that other packages are asked to convert into; all of them know these.
_ASKED = {
    "force": "N", "length": "m", "mass": "kg", "stiffness": "N/m", "acceleration": "m/s**2",
    "velocity": "m/s", "viscosity": "N*s/m", "rate": "1/s", "time": "s",
    "bending stiffness": "N*m**2", "plate stiffness": "N*m", "modulus": "Pa", "density": "kg/m**3",
    "mass per length": "kg/m", "mass per area": "kg/m**2",
}  # fmt: skip

#: Frequencies in other packages, by how they write their own unit: cycles, or angles, over time.  A plain
#: 1/s is neither.
_CYCLES = re.compile(r"[a-z]*hertz|[a-zA-Zµ]?Hz")
_TURNS = re.compile(r"rpm|revolution|turn|cycle")
_ANGLES = re.compile(r"rad|deg")


#: What of the units of axes CF writes in another way.
_CF = {"rad s-1": "rad/s"}


class Quantity(NamedTuple):
    """An exact number in SI units (Hz for a frequency), and its text."""

    value: Fraction
    text: str


def is_foreign(value: object) -> bool:
    """Whether a value is a quantity of pint, astropy or unyt, and has a unit."""
    if isinstance(value, type):
        return False
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return not getattr(value, "unitless", False)
    return hasattr(value, "to_value") and _own_unit(value) not in ("", "dimensionless")


def quantity(value: object, name: str, kind: str) -> Quantity:
    """Convert a number with a unit of the given kind.

    Raises
    ------
    InputError
        It has no unit, an unknown one or one of another kind, or is no finite number; one line that names it.
    """
    if isinstance(value, str):
        return _from_text(value, name, kind)
    if not is_foreign(value):
        raise _refusal(name, kind, value, "it has no unit" if _is_number(value) else "")
    found, unit = _converted(value, name, kind)
    if found.ndim:
        raise _refusal(name, kind, value, "expected one number")
    return _from_text(f"{float(found)!r} {unit}", name, kind)


def quantities(values: Any, name: str, kind: str) -> list[Fraction] | None:
    """Values with units, one or a list of them, in the SI unit; None if they are plain numbers.

    Raises
    ------
    InputError
        As of `quantity`; or some have a unit and others none.
    """
    if isinstance(values, str):
        return [_from_text(values, name, kind).value]
    if is_foreign(values):
        found, unit = _converted(values, name, kind)
        texts = [f"{float(number)!r} {unit}" for number in np.atleast_1d(found).ravel()]
        return [_from_text(text, f"{name}[{k}]", kind).value for k, text in enumerate(texts)]
    said = _known_unit_of_array(values, name, kind)
    if said is not None:
        texts = [f"{float(number)!r} {said}" for number in np.atleast_1d(values).ravel()]
        return [_from_text(text, f"{name}[{k}]", kind).value for k, text in enumerate(texts)]
    if not isinstance(values, (list, tuple)):
        return None
    with_unit = [isinstance(value, str) or is_foreign(value) for value in values]
    if not any(with_unit):
        return None
    return [quantity(value, f"{name}[{k}]", kind).value for k, value in enumerate(values)]


def _from_text(text: str, name: str, kind: str) -> Quantity:
    matched = None if is_plain_number(text) else _TEXT.fullmatch(text)
    if matched is None:
        raise _refusal(name, kind, text, _slip(text))
    written = matched[2] or matched[3]
    unit = known_unit(written)
    if unit is None:
        raise _refusal(name, kind, text, _meant(written, kind))
    if UNITS[unit].measures != kind:
        raise _refusal(name, kind, text, f"{unit} is a unit of {UNITS[unit].measures}")
    size = float(matched[1])  # beyond all doubles no exact number is made: it could fill the memory
    if math.isinf(size) or (size == 0.0 and re.search("[1-9]", re.split("[eE]", matched[1])[0])):
        raise _refusal(name, kind, text, "it exceeds the range of double precision")
    return Quantity(Fraction(Decimal(matched[1])) * UNITS[unit].size, text)


def _slip(text: str) -> str:
    """Describe the error in text that is not a number with a unit."""
    if _COMMA.match(text):
        return "use a decimal point, not a comma"
    if _NO_NUMBER.match(text):
        return "it is not finite"
    return "it has no unit" if is_plain_number(text) else "expected one number, one space and one unit"


def is_plain_number(text: str) -> bool:
    """Whether it is a number alone, such as 1e5."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _meant(unit: str, kind: str) -> str:
    """Suggest a unit for an unknown one."""
    valid = [*units_of(kind), *(name for name, known in UNITS.items() if known.measures != kind)]
    same = [name for name in valid if name.lower() == unit.lower()]
    hint = f" (did you mean {same[0]}?)" if same else checks.nearest(unit, valid)
    return f"unknown unit {unit}{hint}"


def _refusal(name: str, kind: str, value: object, why: str) -> InputError:
    valid = ", ".join(units_of(kind))
    got = (
        repr(value) if isinstance(value, str) and len(value) < 80 else checks.one_line(value)
    )  # spaces count
    return InputError(
        name,
        f"must be a number with a unit of {kind} ({valid}), such as '{EXAMPLES[kind]}'; "
        f"got {got}{why and f': {why}'}",
    )


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool)


def _own_unit(value: Any) -> str:
    """Unit of a quantity as its package writes it."""
    return str(getattr(value, "units", None) if hasattr(value, "units") else getattr(value, "unit", ""))


def unit_of_array(values: Any) -> object:
    """The unit that an array of xarray says its numbers have; None of ratios, which say 1 or nothing."""
    said = getattr(values, "attrs", {}).get("units") if checks.is_array(values) else None
    return None if said in (None, "", "1") else said


def _known_unit_of_array(values: Any, name: str, kind: str) -> str | None:
    """The unit of an array of xarray; None of ratios."""
    said = unit_of_array(values)
    if said is None:
        return None
    unit = known_unit(_CF.get(str(said), str(said)))
    if unit is None:
        valid = ", ".join(units_of(kind))
        raise InputError(
            name,
            f"must have a unit of {kind} ({valid}), or 1 for ratios; got {checks.one_line(said)}: "
            f"{_meant(str(said), kind)}",
        )
    return unit


def _converted(value: Any, name: str, kind: str) -> tuple[np.ndarray, str]:
    """Numbers of a quantity of another package, by its own conversion, and our unit that they are in."""
    own = _own_unit(value)
    unit, asked = _foreign_unit(own, kind)
    try:
        if not asked:
            raise ValueError
        found = value.to(asked).magnitude if hasattr(value, "magnitude") else value.to_value(asked)
    except Exception:  # each package has its own errors for what it cannot convert
        why = "1/s is neither Hz nor rad/s" if own in ("1 / second", "1 / s", "1/s") else ""
        raise _refusal(name, kind, value, why or f"{own} is not one of them") from None
    return np.asarray(found, dtype=float), unit


def _foreign_unit(own: str, kind: str) -> tuple[str, str]:
    """Unit, and its spelling for the other package; empty if it is no frequency."""
    if kind != "frequency":
        return units_in_si(kind), _ASKED[kind]
    if _CYCLES.fullmatch(own):
        return "Hz", "Hz"
    if own in ("rpm", "revolutions_per_minute"):
        return "rpm", "rpm"
    return ("rad/s", "rad/s") if _TURNS.search(own) or _ANGLES.search(own) else ("", "")


def units_in_si(kind: str) -> str:
    """The unit of a kind that has the size 1."""
    return next(name for name in units_of(kind) if UNITS[name].size == 1)

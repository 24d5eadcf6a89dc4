"""What makes a record dimensionless, and friction in newtons or as an acceleration.

Time is in 1/omega_1, a force over P, a displacement over P/k_1, a velocity over omega_1 P/k_1 and an
acceleration over omega_1^2 P/k_1, which is P/m_1, as k_1 = m_1 omega_1^2.  So friction over m_1 is an
acceleration, too, and beta is this over P/m_1.  Where nothing states P it is free: then P/m_1 = 1 m/s^2.
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.system import System
from ..units.axes import rounded
from ..units.quantities import is_foreign, quantity
from ..units.scales import NO_SCALES, Scales, Units, scales_of
from ..units.table import PI, UNITS, units_of
from .channels import Scale
from .record import Record

#: Acceleration P/m_1 where nothing states it [m/s^2].
_FREE = Fraction(1)

#: Powers of omega_1 in the unit of each quantity of the base.
_POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}


def motion_scales(units: Units | None, system: System) -> Scales:
    """Reference values of motions in time: those of the units, with P/m_1 = 1 m/s^2 where P is not given.

    Raises
    ------
    InputError
        The units do not go with the system.
    """
    scales = scales_of(units, system)
    if units is None or scales.frequency is None or scales.force is not None or scales.length is not None:
        return scales
    length = _FREE / _omega(scales, "") ** 2
    force = None if scales.stiffness is None else length * scales.stiffness
    return replace(scales, force=force, length=length)


def _omega(scales: Scales, of: str) -> Fraction:
    if scales.frequency is None:
        raise InputError(
            f"cannot convert {of} to ratios: a reference value is missing; give units.natural_frequency"
        )
    return 2 * PI * scales.frequency


def _acceleration(scales: Scales, of: str) -> Fraction:
    """P/m_1 [m/s^2]."""
    omega = _omega(scales, of)
    if scales.length is None:
        raise InputError(
            f"cannot convert {of} without P/k_1: units.load alone does not state it; give units.stiffness or "
            "units.mass"
        )
    return scales.length * omega**2


def scale_of(record: Record, scales: Scales) -> Scale:
    """Factors of the times and the values of a record that make it dimensionless.

    Raises
    ------
    InputError
        The record has a unit, and a reference value is missing; the message names the key that gives it.
    """
    if record.unit is None:
        return Scale(1.0, 1.0)
    omega = _omega(scales, "seconds")
    size = UNITS[record.unit].size
    if record.quantity == "force":
        one = scales.needed("force", "record.unit", record.unit)
    else:
        one = _acceleration(scales, f"a record in {record.unit}") / omega ** (2 - _POWERS[record.quantity])
    return Scale(rounded(omega), rounded(size / one))


def friction_ratio(value: Any, name: str, scales: Scales = NO_SCALES) -> float:
    """beta of a number, of a force such as "5 N", or of an acceleration such as "0.05 g": friction over m_1.

    Raises
    ------
    InputError
        It is none of them, below 0, or a reference value is missing.
    """
    if not isinstance(value, str) and not is_foreign(value):
        return checks.number(value, name, least=0.0)
    try:
        kind, found = _force_or_acceleration(value, name)
    except InputError as error:
        raise _without_force(error, value, name) from None
    one = (
        scales.needed("force", name, value) if kind == "force" else _acceleration(scales, f"{name} = {value}")
    )
    if found < 0:
        raise InputError(name, f"must be >= 0; got {checks.one_line(value)}")
    return rounded(found / one)


def _force_or_acceleration(value: Any, name: str) -> tuple[str, Fraction]:
    try:
        return "acceleration", quantity(value, name, "acceleration").value
    except InputError:
        return "force", quantity(value, name, "force").value


def _without_force(error: InputError, value: Any, name: str) -> InputError:
    """The error about a value that is neither, with the units of both."""
    _, _, why = error.problem.rpartition("; got ")
    valid = ", ".join((*units_of("force"), *units_of("acceleration")))
    return InputError(
        name,
        f"must be a number, or one with a unit of force or, over m_1, of acceleration ({valid}), such as "
        f"'5 N' or '0.05 g'; got {why}",
    )


def friction_ratios(values: Any, name: str, scales: Scales = NO_SCALES) -> np.ndarray:
    """beta of one value or of several, see `friction_ratio`."""
    several = isinstance(values, Sequence) and not isinstance(values, str)
    if not several and not (checks.is_array(values) and np.ndim(values)):
        return np.array([friction_ratio(values, name, scales)])
    return np.array([friction_ratio(one, f"{name}[{k}]", scales) for k, one in enumerate(values)])

"""Numbers of records that may have units: "20 s", "2.5 Hz", "0.4 g"."""

import math
from typing import Any

from .. import checks
from ..errors import InputError
from ..units.axes import rounded
from ..units.quantities import is_foreign, quantity
from ..units.table import UNITS

#: What times and frequencies of a record with a unit are in.
SECONDS, HERTZ = "s", "Hz"


def number_in(
    value: Any, name: str, kind: str, unit: str | None, *, least: float = -math.inf, above: float = -math.inf
) -> float:
    """A number as it stands, or one with a unit of the kind, in `unit`.

    Parameters
    ----------
    value, name : the number, and the argument that it is
    kind : what its unit measures
    unit : that the result is in; None: the record is dimensionless
    least, above : bounds, as of `checks.number`

    Raises
    ------
    InputError
        It is no such number or out of range, or it has a unit and the record has none.
    """
    if isinstance(value, str) or is_foreign(value):
        if unit is None:
            raise InputError(
                name,
                f"must be a number in a record without a unit, which is dimensionless; got "
                f"{checks.one_line(value)}; give the unit of the record, too",
            )
        value = rounded(quantity(value, name, kind).value / UNITS[unit].size)
    return checks.number(value, name, least=least, above=above)


def time_in(
    value: Any, name: str, unit: str | None, *, least: float = -math.inf, above: float = 0.0
) -> float:
    """A time in seconds, of a record without a unit in 1/omega_1."""
    return number_in(value, name, "time", unit and SECONDS, least=least, above=above)


def frequency_in(value: Any, name: str, unit: str | None, *, above: float = 0.0) -> float:
    """A frequency in Hz, of a record without a unit over omega_1."""
    return number_in(value, name, "frequency", unit and HERTZ, above=above)


def angular(unit: str | None) -> float:
    """Angular frequency of a frequency of 1: Hz, or omega_1 for a record without a unit."""
    return 2.0 * math.pi if unit else 1.0

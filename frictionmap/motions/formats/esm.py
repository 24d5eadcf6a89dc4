"""Files `.ASC` of the strong-motion databases ESM and ITACA: lines `KEY: value`, then values.

The header has 64 lines.  It states SAMPLING_INTERVAL_S, NDATA, UNITS and DATA_TYPE.
"""

import re
from pathlib import Path

from ...errors import InputError
from ...units.table import UNITS, known_unit
from .series import Series, check_count, lines_of, numbers, shortened, stated, unit_of

_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*):\s?(.*)")
_NEEDED = "SAMPLING_INTERVAL_S"
_SHOWN = ("EVENT_NAME", "EVENT_DATE_YYYYMMDD", "STATION_CODE", "STREAM")

#: Quantities by what their units measure.
_QUANTITIES = {"acceleration": "acceleration", "velocity": "velocity", "length": "displacement"}


def is_esm(path: Path) -> bool:
    """Whether a file begins with such a header; others of this ending are tables."""
    with path.open("rb") as file:
        return _NEEDED.encode() in file.read(8192)


def read_esm(path: Path) -> Series:
    """Read one."""
    lines = lines_of(path)
    first = next((k for k, line in enumerate(lines) if line.strip() and not _KEY.match(line)), len(lines))
    head = {found[1]: found[2].strip() for line in lines[:first] if (found := _KEY.match(line))}
    dt = stated(path, head.get(_NEEDED, ""), r"([\d.eE+-]+)", _NEEDED)
    count = stated(path, head.get("NDATA", ""), r"(\d+)", "NDATA")
    said = head.get("UNITS", "")
    unit = unit_of(said) or known_unit(said)
    if unit is None or UNITS[unit].measures not in _QUANTITIES:
        raise InputError(
            f"cannot read {path}: UNITS must be one of acceleration, velocity or length, such as cm/s^2; got "
            f"{said!r}; it may hold a spectrum: download the time history"
        )
    quantity = _QUANTITIES[UNITS[unit].measures]
    kind = head.get("DATA_TYPE", quantity).lower()
    if kind and kind != quantity:
        raise InputError(
            f"cannot read {path}: DATA_TYPE must agree with UNITS {said}, {quantity}; got {kind!r}; download "
            "the time history"
        )
    values = check_count(path, numbers(path, lines[first:], first + 1), int(count), "NDATA")
    return Series(values, dt, None, quantity, unit, shortened([head.get(key, "") for key in _SHOWN]))

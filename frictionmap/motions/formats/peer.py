"""PEER strong-motion files `.AT2`, `.VT2`, `.DT2`: four lines of header, then values along the lines.

The second line names event, date, station and direction; the third the quantity and its unit; the fourth the
number of values and their distance: `NPTS=  5372, DT=   .0100 SEC`, or `5372 0.0100 NPTS, DT` in old files.
"""

import re
from pathlib import Path

from ...errors import InputError
from .series import Series, check_count, lines_of, numbers, shortened, stated, unit_of

#: Quantity and unit of each ending.
QUANTITIES = {
    ".at2": ("acceleration", "g"),
    ".vt2": ("velocity", "cm/s"),
    ".dt2": ("displacement", "cm"),
}

_HEADER = 4
_UNITS = re.compile(r"IN UNITS? OF\s+(\S+)", re.IGNORECASE)


def read_peer(path: Path) -> Series:
    """Read one."""
    lines = lines_of(path)
    if len(lines) <= _HEADER:
        raise InputError(
            f"cannot read {path}: a PEER file has {_HEADER} lines of header and then values; got "
            f"{len(lines)} lines; download it again"
        )
    quantity, unit = QUANTITIES[path.suffix.lower()]
    said = _UNITS.search(lines[2])
    if said and unit_of(said[1]) != unit:
        raise InputError(
            f"cannot read {path}: a file {path.suffix} is in {unit}, but its header says {said[1]!r}; rename "
            "it after what it holds"
        )
    last = lines[3]
    old = re.match(r"\s*(\d+)\s+([\d.eE+-]+)\s+NPTS", last, re.IGNORECASE)
    if old:
        last = f"NPTS={old[1]}, DT={old[2]}"
    count = stated(path, last, r"NPTS\s*=\s*(\d+)", "NPTS")
    dt = stated(path, last, r"DT\s*=\s*([\d.eE+-]+)", "DT")
    values = check_count(path, numbers(path, lines[_HEADER:], _HEADER + 1), int(count), "NPTS")
    return Series(values, dt, None, quantity, unit, shortened(lines[1:2]))

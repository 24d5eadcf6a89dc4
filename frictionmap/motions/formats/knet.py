"""K-NET and KiK-net files `.EW .NS .UD` (KiK-net: `.EW1`, `.EW2`, ..): 17 lines of header, then counts.

An acceleration in gal is a count times `Scale Factor`, such as 3920(gal)/6182761.  Counts have an offset that
differs from sensor to sensor, so the mean is taken off.
"""

import re
from pathlib import Path

from ...errors import InputError
from .series import Series, lines_of, numbers, shortened, stated

ENDINGS = tuple(f".{way}{place}" for way in ("ew", "ns", "ud") for place in ("", "1", "2"))

_HEADER = 17
_SCALE = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)", re.IGNORECASE)
_TITLES = ("Origin Time", "Mag.", "Station Code", "Dir.")


def read_knet(path: Path) -> Series:
    """Read one."""
    lines = lines_of(path)
    if len(lines) <= _HEADER or not lines[0].startswith("Origin Time"):
        raise InputError(
            f"cannot read {path}: a K-NET file has {_HEADER} lines of header, the first one 'Origin Time'; "
            f"got {lines[0][:30] if lines else ''!r} and {len(lines)} lines; download it again"
        )
    head = lines[:_HEADER]
    rate = stated(path, _line(head, "Sampling Freq"), r"Sampling Freq\S*\s+([\d.]+)", "Sampling Freq(Hz)")
    seconds = stated(path, _line(head, "Duration"), r"Duration\s*Time\S*\s+([\d.]+)", "Duration Time(s)")
    scale = _SCALE.search(_line(head, "Scale Factor"))
    if scale is None or float(scale[2]) == 0.0:
        raise InputError(
            f"cannot read {path}: its header must state Scale Factor as 3920(gal)/6182761; got "
            f"{_line(head, 'Scale Factor')!r}; download it again"
        )
    counts = numbers(path, lines[_HEADER:], _HEADER + 1)
    if counts.size < round((seconds - 1.0) * rate):  # the duration is written in whole seconds
        raise InputError(
            f"cannot read {path}: Duration Time says {seconds:g} s, {seconds * rate:g} values; got "
            f"{counts.size}: it is truncated; download it again"
        )
    values = counts * (float(scale[1]) / float(scale[2]))
    said = shortened([_line(head, title) for title in _TITLES])
    return Series(values, 1.0 / rate, None, "acceleration", "cm/s^2", said, baseline="mean")


def _line(head: list[str], title: str) -> str:
    return next((line for line in head if line.startswith(title)), "")

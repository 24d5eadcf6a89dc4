"""COSMOS strong-motion files `.V1`, `.V2`, `.V1c`, `.V2c`: headers of text and numbers, comments, values.

Each part begins with a line that counts its values and states their format, such as
`100 Real-header values follow on 17 lines, Format= (6F13.6)`.  Integer 2 says what the series is, integer 3
its unit; real 62 is the distance of samples in milliseconds.  A file may hold several channels or quantities,
each with headers of its own, up to the line `End-of-data`.
"""

import re
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from .series import Series, check_count, lines_of, numbers, shortened

#: Endings of uncorrected and corrected records, also of one channel.
ENDINGS = (".v1", ".v2", ".v1c", ".v2c")

_FIRST = re.compile(r"\(Format v[\d.]+ with\s+(\d+)\s+text lines\)", re.IGNORECASE)
_COUNT = re.compile(r"\s*(\d+)\s")
_WIDTH = re.compile(r"Format\s*=\s*\(\s*\d*[IFEG](\d+)", re.IGNORECASE)
_ON_LINES = re.compile(r"on\s+(\d+)\s+lines", re.IGNORECASE)

#: Numbers of header values, from 0.
_TYPE, _UNIT, _INTERVAL = 1, 2, 61

#: Quantities by their code in the header.
_QUANTITIES = {1: "acceleration", 2: "velocity", 3: "displacement"}

#: Units of each quantity by their code in the header.
_UNITS = {2: "g", 4: "cm/s^2", 5: "cm/s", 6: "cm", 7: "in/s^2", 8: "in/s", 9: "in", 10: "cm/s^2"}

_MILLISECOND = 1e-3


class _Part(NamedTuple):
    """Values, and where they end."""

    values: np.ndarray
    next: int  # the line behind it


def read_cosmos(path: Path, quantity: str | None) -> Series:
    """Read the series of the quantity, or the only one of the file."""
    lines = lines_of(path)
    found, at = [], 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        series, at = _series(path, lines, at)
        found.append(series)
    if not found:
        raise InputError(f"cannot read {path}: it is empty; download it again")
    chosen = [one for one in found if quantity in (None, one.quantity)]
    if len(chosen) == 1:
        return chosen[0]
    kinds = ", ".join(one.quantity for one in found)
    if len({one.quantity for one in found}) == len(found):
        raise InputError(f"cannot choose a series of {path}: it has {kinds}; give one of them as quantity")
    raise InputError(
        f"cannot choose a series of {path}: it must have one {quantity or 'series'}; got {kinds}; save its "
        "channels in files of their own"
    )


def _series(path: Path, lines: list[str], at: int) -> tuple[Series, int]:
    """One series, and the line behind it."""
    first = _FIRST.search(lines[at])
    if first is None:
        raise InputError(
            f"cannot read {path}, line {at + 1}: a COSMOS file begins with '(Format v01.20 with 13 text "
            f"lines)'; got {lines[at][:40]!r}; download it in the COSMOS format"
        )
    begin = at + int(first[1])  # the first line is one of them
    whole = _part(path, lines, begin)
    real = _part(path, lines, whole.next)
    comments = _counted(path, lines, real.next)
    data = _part(path, lines, real.next + 1 + comments)
    if whole.values.size <= _UNIT or real.values.size <= _INTERVAL:
        raise InputError(f"cannot read {path}: its headers are too short; download it again")
    kind, code = int(whole.values[_TYPE]), int(whole.values[_UNIT])
    if kind not in _QUANTITIES or code not in _UNITS:
        raise InputError(
            f"cannot read {path}: it must hold accelerations, velocities or displacements; got "
            f"type {kind} and unit {code} of the COSMOS tables; download the processed record (.V2)"
        )
    dt = float(real.values[_INTERVAL]) * _MILLISECOND
    if dt <= 0.0:
        raise InputError(
            f"cannot read {path}: real-header value 62, the sample interval, must be > 0; got {dt / 1e-3:g}; "
            "download it again"
        )
    text = shortened(lines[at + 1 : at + 5])
    end = data.next
    if end < len(lines) and _is_end(lines[end]):
        end += 1
    return Series(data.values, dt, None, _QUANTITIES[kind], _UNITS[code], text), end


def _is_end(line: str) -> bool:
    """Whether data end: `End-of-data for ..`, or in older files `/&  ---- End of data for channel 1 ----`."""
    return "end of data" in line.lower().replace("-", " ")


def _counted(path: Path, lines: list[str], at: int) -> int:
    """The number that a line begins with."""
    found = _COUNT.match(lines[at]) if at < len(lines) else None
    if found is None:
        got = repr(lines[at][:40]) if at < len(lines) else "its end"
        raise InputError(
            f"cannot read {path}, line {at + 1}: expected a line that begins with a number of values; got "
            f"{got}: it is truncated or damaged; download it again"
        )
    return int(found[1])


def _part(path: Path, lines: list[str], at: int) -> _Part:
    """Values in the format that their first line states."""
    count, title = _counted(path, lines, at), lines[at]
    width = _WIDTH.search(title)
    if width is None:
        raise InputError(
            f"cannot read {path}, line {at + 1}: it must state a format such as (8F10.3); got "
            f"{title[:40]!r}; download it again"
        )
    per_line = int(re.search(r"\(\s*(\d*)", title[width.start() :])[1] or 1)  # type: ignore[index]
    stated = _ON_LINES.search(title)
    rows = int(stated[1]) if stated else -(-count // per_line)
    there = lines[at + 1 : at + 1 + rows]
    there = list(takewhile(lambda line: not _is_end(line), there))
    values = numbers(path, there, at + 2, int(width[1]))
    return _Part(check_count(path, values, count, f"line {at + 1}"), at + 1 + rows)

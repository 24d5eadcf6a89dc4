"""Times of day and dates in a column of text, as seconds from the first."""

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from ...errors import InputError

_CLOCK = r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,]\d+)?))?"
_DATE = r"(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})"
_STAMP = re.compile(rf"^(?:{_DATE}[T ]\s*)?{_CLOCK}(?:Z|[+-]\d{{2}}:?\d{{2}})?$")
_ISO = re.compile(r"^\d{4}-\d{2}-\d{2}$")
_DAY = 86400.0


def is_stamp(text: str) -> bool:
    """Whether it is a time of day, with a date or without."""
    return _STAMP.match(text.strip()) is not None


def seconds(texts: Sequence[str], column: str) -> np.ndarray:
    """Seconds from the first stamp; NaN where there is none.

    The whole seconds are counted apart from their decimals, so that no digit of these is lost.

    Raises
    ------
    InputError
        Dates change and are not written year first: which number is the day cannot be known.
    """
    found = [_STAMP.match(text.strip()) for text in texts]
    dates = {one["date"] for one in found if one and one["date"]}
    days = {None: 0.0} | {date: 0.0 for date in dates}
    if len(dates) > 1:
        wrong = next((date for date in sorted(dates) if not _ISO.match(date)), None)
        if wrong is not None:
            raise InputError(
                f"cannot read the dates of column {column}: which number of {wrong} is the day is not known; "
                "write dates as 2024-05-31, or leave them out"
            )
        days |= {date: float(datetime.fromisoformat(date).toordinal()) for date in dates}
    first = next((k for k, one in enumerate(found) if one), None)
    if first is None:
        return np.full(len(texts), np.nan)
    whole = np.array([np.nan if one is None else days[one["date"]] * _DAY + _whole(one) for one in found])
    parts = np.array([0.0 if one is None else float("0" + _decimals(one)) for one in found])
    if not dates:  # a clock without a date begins anew at midnight
        whole += _DAY * np.cumsum(np.r_[False, np.diff(whole) < -_DAY / 2.0])
    return (whole - whole[first]) + (parts - parts[first])


def _whole(stamp: re.Match[str]) -> float:
    second = (stamp["second"] or "0").replace(",", ".").partition(".")[0]
    return int(stamp["hour"]) * 3600.0 + int(stamp["minute"]) * 60.0 + int(second)


def _decimals(stamp: re.Match[str]) -> str:
    _, point, decimals = (stamp["second"] or "0").replace(",", ".").partition(".")
    return point + decimals if decimals else ".0"

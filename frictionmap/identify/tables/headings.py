"""Headings of columns, as measuring programs write them: a name with its unit.

`x_mm`, `Weg [mm]`, `Disp (mm)`, `a [m/s²]`, `Zeit/s`, `Base_m/s2`: what stands behind the name is its unit.
"""

import re
from typing import NamedTuple

from ...units.table import COLUMN_UNITS, UNITS, ending, known_unit, spellings

#: A unit in brackets or parentheses at the end.
_IN_BRACKETS = re.compile(r"^(?P<stem>.*?)[\s_,:]*[\[({]\s*(?P<unit>[^\[\](){}]*?)\s*[\])}]$")

#: Words that stand for a time.
TIMES = ("time", "t", "zeit", "temps", "tiempo", "tempo")

#: Volts and their like: what a sensor gives before it is calibrated.
ELECTRICAL = ("V", "mV", "uV", "mA", "A", "counts", "pC")


class Heading(NamedTuple):
    """What a heading says."""

    stem: str  # the name without its unit
    unit: str  # as names of columns end in it, such as m_s2; another text if it is unknown; "" without


def heading(text: str) -> Heading:
    """Split a heading into its name and its unit."""
    text = text.strip()
    found = _IN_BRACKETS.match(text)
    if found and found["stem"]:
        return Heading(found["stem"], column_unit(found["unit"]) or found["unit"])
    unit = ending(text)
    if unit in COLUMN_UNITS:
        return Heading(text[: -len(unit) - 1], unit)
    for spelling in _SPELLINGS:
        stem = text.removesuffix(spelling)
        if stem != text and stem[-1:] in ("/", "_", " ", ",", "-") and stem[:-1].strip(" _,/"):
            return Heading(stem[:-1].strip(" _,/"), column_unit(spelling))
    return Heading(text.removesuffix(f"_{unit}") if unit else text, unit)


def words_of(role: str) -> tuple[str, ...]:
    """What a column of a role is called, in small letters."""
    return TIMES if role == "time" else (role,)


def column_unit(text: str) -> str:
    """A unit in the form that names of columns end in; empty if no column may be in it."""
    if text in COLUMN_UNITS:
        return text
    name = known_unit(text)
    return UNITS[name].column if name else ""


def is_units(fields: list[str]) -> bool:
    """Whether a line below the names holds their units, at least one that is known and nothing else."""
    inner = [field.strip().strip("[](){}").strip() for field in fields]
    known = [bool(column_unit(text)) for text in inner]
    return any(known) and all(
        there or text in ("", "-", "1", *ELECTRICAL) for there, text in zip(known, inner, strict=True)
    )


#: All ways to write a unit of a column, the longest first.
_SPELLINGS = sorted(
    {
        text
        for kind in {unit.measures for unit in COLUMN_UNITS.values()}
        for text in spellings(kind)
        if column_unit(text)
    },
    key=len,
    reverse=True,
)

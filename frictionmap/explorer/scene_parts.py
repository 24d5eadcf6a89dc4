"""Sliders, contacts and boundaries that a page offers."""

from typing import NamedTuple


class Slider(NamedTuple):
    """A number that can be changed; its key is that of a further axis of a configuration, or mu."""

    key: str
    label: str
    least: float
    most: float
    value: float
    #: how the slider runs from least to most: "linear", "even" (in digits), "square" (fine near least), "log"
    scale: str
    unit: str = ""  # words after the number: what it is relative to
    measure: str = ""  # of the scale that converts it to units, such as "force"


class Contact(NamedTuple):
    """A contact that can be chosen."""

    key: str
    label: str
    kind: str
    masses: tuple[int | str, ...]


class Line(NamedTuple):
    """Curves of one meaning over a map."""

    names: tuple[str, ...]  # of their values
    lower: str  # what stands below beta in their symbol; "" if they have none
    dashes: tuple[int, ...]
    meaning: str

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
    symbol: str = "β"
    upright: bool = False  # whether its values are over beta, and lie along the axis across


class Across(NamedTuple):
    """The axis of a map that goes across."""

    key: str  # of a query
    symbol: str
    name: str
    measure: str  # of its units
    words: str


FREQUENCY = Across("r", "r", "frequency ratio r = ω/ω₁", "frequency", "frequency")
BELT_SPEED = Across("wall_speed", "v", "belt speed v / (ω₁P/k₁)", "velocity", "belt speed")


class CellQuantity(NamedTuple):
    """A quantity that colours the cells of a map."""

    key: str
    label: str
    output: str  # of a map; "" for the classes of regimes and stops
    scale: str  # of the colours: "classes", "linear" or "log"
    row: int | None = None  # of the mass that is meant, counted from 0

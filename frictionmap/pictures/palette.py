"""One colour for each class of cells in all pictures, and one style for each curve.

Any two classes differ in lightness, so that they are distinct in grey printing; from continuous motion on,
lightness falls with the number of stops.  They are also distinct for readers who do not see red or green.
"""

from typing import Literal, NamedTuple, TypedDict

import numpy as np

from .. import regimes


class Look(NamedTuple):
    """Label and colour of a class."""

    label: str
    colour: str


class LineStyle(TypedDict, total=False):
    """Style of a curve for matplotlib."""

    color: str
    linewidth: float
    linestyle: Literal[":"] | tuple[int, tuple[float, float]]
    label: str


class Shade(TypedDict):
    """Style of a filled span for matplotlib."""

    color: str
    alpha: float
    linewidth: float


CLASSES = (
    Look("unresolved", "#cc1f03"),
    Look("permanent sticking", "#c4c4c4"),
    Look("continuous", "#ffffff"),
    Look("1 stop", "#ffdd7c"),
    Look("2 stops", "#48b2d1"),
    Look("3 stops", "#2880b8"),
    Look("4 stops", "#2b4fa6"),
    Look("more stops", "#00162c"),
    Look("non-integer stops per cycle", "#55285e"),
    Look("stick-slip, stops not counted", "#bd7f50"),
    Look("stuck or unresolved", "#c4c4c4"),  # never together with permanent sticking, hence the same colour
)
UNRESOLVED, STUCK, CONTINUOUS, ONE, MORE, NON_INTEGER, UNCOUNTED, NO_STOPS = 0, 1, 2, 3, 7, 8, 9, 10

#: Cells of blocks that are not yet in a store: not painted; the background is dotted.
NOT_YET = len(CLASSES)
NOT_YET_LABEL, NOT_YET_HATCH = "not computed yet", "..."
#: Cells of systems with a belt: white like continuous motion, and hatched.
ONE_WAY = NOT_YET + 1
ONE_WAY_LABEL, ONE_WAY_HATCH = "one-way sliding", "---"
#: Number of classes, including cells not yet computed and one-way sliding.
COUNT = ONE_WAY + 1

#: Motions on a belt without a load, by regime.
NO_LOAD = {
    regimes.UNRESOLVED: CLASSES[UNRESOLVED],
    regimes.STEADY_SLIDING: Look("steady sliding", CLASSES[CONTINUOUS].colour),
    regimes.STICK_SLIP_CYCLE: Look("stick-slip cycle", CLASSES[ONE].colour),
    regimes.CYCLE_WITHOUT_STOPS: Look("cycle without stops", "#8c9f5a"),  # no colour of a number of stops
}

#: Hatching marks several possible regimes in all pictures.
HATCH = "////"
HATCH_COLOUR = "#404040"

LIM: LineStyle = {"color": "black", "linewidth": 1.3, "label": r"$\beta_\mathrm{lim}$"}
STICK: LineStyle = {
    "color": "black",
    "linewidth": 1.3,
    "linestyle": (0, (4, 2)),
    "label": r"$\beta_\mathrm{stick}$",
}
NO_SLIP: LineStyle = {**STICK, "label": r"$\beta_\mathrm{no\,slip}$"}
STICK_CONTACT: LineStyle = {**STICK, "label": r"$\beta_\mathrm{stick}$ of the contact, others held"}
LIM_CONTACT: LineStyle = {**LIM, "label": r"$\beta_\mathrm{lim}$ of all contacts"}
FURTHER: LineStyle = {
    "color": "black",
    "linewidth": 1.1,
    "linestyle": (0, (1.5, 1.2)),
    "label": "ends of further ranges without stops",
}
MODAL: LineStyle = {
    "color": "#cc1f03",
    "linewidth": 1.2,
    "linestyle": ":",
    "label": r"lower bound of $\beta_\mathrm{lim}$, sum of modal maxima",
}

BORDER: LineStyle = {
    "color": "#00162c",
    "linewidth": 0.8,
    "label": "borders between numbers of stops",
}
BORDER_OF_EXISTENCE: LineStyle = {
    "color": "#00162c",
    "linewidth": 0.8,
    "linestyle": (0, (5, 1.5)),
    "label": "ends of periodic motions (not of the basins of a start)",
}

CYCLE_SPEED: LineStyle = {
    "color": "black",
    "linewidth": 1.3,
    "label": "largest belt speed with a stick-slip cycle",
}
SLIDING_LIMIT: LineStyle = {
    "color": "black",
    "linewidth": 1.3,
    "linestyle": (0, (4, 2)),
    "label": "friction at which steady sliding loses stability",
}

#: Colours of two contacts, 3 times the state of the first plus that of the second: it sticks, sticks and
#: slips, slides.  Both alike: grey, black, white; bluish where the first one moves less, else brownish.
PAIRS = (
    "#c4c4c4", "#3a9cc2", "#c9e6f7",
    "#a8743a", "#00121f", "#23509e",
    "#e0a032", "#4f230a", "#ffffff",
)  # fmt: skip
UNRESOLVED_PAIR = "#cc1f03"
PARTIAL: LineStyle = {
    "color": "black",
    "linewidth": 1.3,
    "linestyle": (0, (1.5, 1.2)),
    "label": "one contact sticks, the other moves",
}

#: Colours of the lines of masses, used in turn; the lines are numbered.
LINES = ("#2b4fa6", "#bd7f50", "#00162c", "#48b2d1", "#cc1f03", "#2880b8")

#: Colours of several contacts, used in turn: none is that of a mass, and they differ in lightness.
CONTACTS = ("#8a2d86", "#6c9a3b", "#1d4a2a", "#d98fc9", "#4c1246", "#b3cc6a")

#: Measured samples: no class of cells and no line has this colour.
MEASURED = "#cc4777"

#: Line styles of response curves, by regime.
REGIME_LINES: dict[int, Literal["-"] | tuple[int, tuple[float, ...]]] = {
    regimes.CONTINUOUS: "-",
    regimes.STICK_SLIP: (0, (3.5, 1.5)),
    regimes.PERMANENT_STICKING: (0, (1, 1.5)),
    regimes.ONE_WAY_SLIDING: (0, (7, 1.5, 1, 1.5)),
}
LIMIT: LineStyle = {
    "color": "black",
    "linewidth": 1.1,
    "linestyle": (0, (7, 2)),
    "label": r"continuous motion at $\beta_\mathrm{lim}$",
}
HELD: LineStyle = {"color": "black", "linewidth": 1.3, "linestyle": ":", "label": "contact held"}

#: Ends of the part of the colour map in use, which is neither white nor black on paper, light and dark.
_LIGHT, _DARK = 0.88, 0.0


def in_turn(colours: tuple[str, ...], number: int) -> list[str]:
    """Colours of a number of lines; they begin again where there are more lines than colours."""
    return [colours[k % len(colours)] for k in range(number)]


def sequence(number: int) -> list[str]:
    """Colours of an ordered family of lines, from light to dark."""
    from matplotlib import colormaps  # imported here: the explorer uses the palette without matplotlib
    from matplotlib.colors import to_hex

    return [to_hex(colormaps["viridis"](share)) for share in np.linspace(_DARK, _LIGHT, number)[::-1]]


def colour_table() -> np.ndarray:
    """Red, green, blue and opacity of the classes, 0 to 255; transparent what is hatched, or no cell."""
    table = np.zeros((COUNT + 1, 4), dtype=np.uint8)
    for row, look in zip(table, CLASSES, strict=False):
        row[:] = [int(look.colour[k : k + 2], 16) for k in (1, 3, 5)] + [255]
    return table


#: Times at which a contact is open, in pictures of motions.
OPEN_LABEL, OPEN_COLOUR, OPEN_HATCH = "open", "#bcd9f2", "////"

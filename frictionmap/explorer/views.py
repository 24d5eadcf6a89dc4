"""One view: the changed system, ranges of r and beta, mu; its map, computed in pieces."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol, cast

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.settings import Output, Solver
from ..model.system import System
from ..pictures.classes import of_cells, stops_range
from ..pictures.palette import MORE, NON_INTEGER
from ..steady.maps import solve_map
from ..theory.boundary_curves import find_curves

#: Pixels of a picture each way, and together: those of the largest screens.
MOST_PIXELS, MOST_CELLS = 8192, 2**25

#: Frequencies of a kind that are marked.
_MOST_MARKS = 200

#: Masses whose amplitudes are offered one by one.
_OFFERED_MASSES = 12


class CellQuantity(NamedTuple):
    """A quantity that colours the cells of a map."""

    key: str
    label: str
    output: str  # of a map; "" for the classes of regimes and stops
    scale: str  # of the colours: "classes", "linear" or "log"
    row: int | None = None  # of the mass that is meant, counted from 0


_QUANTITIES = (
    CellQuantity("regime", "regime and stops", "", "classes"),
    CellQuantity("contact_amplitude", "amplitude in the contact", "contact_amplitude", "log"),
    CellQuantity("multiplier", "Floquet multiplier", "multiplier", "linear"),
    CellQuantity("stuck_fraction", "share of time stuck", "stuck_fraction", "linear"),
    CellQuantity("work_friction", "energy dissipated by friction", "work_friction", "log"),
)


def quantities(system: System) -> tuple[CellQuantity, ...]:
    """Quantities that can colour the cells of maps of a system."""
    amplitudes = tuple(
        CellQuantity(
            f"amplitude_{number}", f"amplitude of {name_of_mass(system, number)}", "amplitude", "log", row
        )
        for row, number in enumerate(system.dofs.numbers[:_OFFERED_MASSES])
    )
    return (*_QUANTITIES[:2], *amplitudes, *_QUANTITIES[2:])


def name_of_mass(system: System, number: int) -> str:
    """Name of a mass: its number and label; without a number if it is the only one."""
    return f"mass {system.dofs.word(number)}" if system.n > 1 else "the mass"


@dataclass(frozen=True)
class View:
    """Ranges and system shown on a page."""

    system: System
    r: tuple[float, float]
    beta: tuple[float, float]
    mu: float
    solver: Solver

    def check(self, r: float | None = None) -> None:
        """Refuse a range, or a frequency, at which the error of a reduced structure exceeds its limit."""
        inside = r is None or self.r[0] <= r <= self.r[1]
        self.system.costs(np.array(self.r if inside else (r, r)))

    def axes(self, columns: int, rows: int) -> dict[str, np.ndarray]:
        """Axes of a map at the centres of the pixels."""
        return {
            "mu": np.array([self.mu]),
            "r": middles(self.r, columns, "columns"),
            "beta": middles(self.beta, rows, "rows"),
        }


def middles(ends: tuple[float, float], count: int, name: str) -> np.ndarray:
    """Centres of equal parts of a range, as `start`, `stop` and `num` of an axis give them."""
    half = 0.5 * (ends[1] - ends[0]) / count
    found = np.linspace(ends[0] + half, ends[1] - half, count)
    if count > 1 and not (np.diff(found) > 0.0).all():
        raise InputError(
            f"cannot place distinct {name} between {ends[0]!r} and {ends[1]!r}: range too narrow; widen it"
        )
    return found


class Piece(NamedTuple):
    """Columns of a map of a view."""

    columns: int
    rows: int
    first: int
    last: int  # the one after the last

    def check(self) -> None:
        """Refuse an invalid piece of a map."""
        checks.whole(self.columns, "columns", least=1, most=MOST_PIXELS)
        checks.whole(self.rows, "rows", least=1, most=MOST_PIXELS)
        checks.whole(self.first, "first", least=0, most=self.columns - 1)
        checks.whole(self.last, "last", least=self.first + 1, most=self.columns)
        cells = (self.last - self.first) * self.rows
        if cells > MOST_CELLS:
            raise InputError(f"columns times rows must be <= {MOST_CELLS}; got {cells}")


class Follower(Protocol):
    """Receiver of a map; `watch` raises if it no longer waits."""

    def watch(self) -> None: ...

    def progress(self, done: float, total: float) -> None: ...


def solve_piece(
    view: View, wanted: Sequence[CellQuantity], piece: Piece, follower: Follower
) -> dict[str, np.ndarray]:
    """The cells of a piece as `sweep` gives them, (columns, rows): regime, stops per cycle, the quantities.

    And over its columns `beta_lim` and `beta_stick`.
    """
    piece.check()
    view.check()
    asked = (quantity.output for quantity in wanted if quantity.output)
    outputs = tuple(dict.fromkeys(("regime", "stops_per_cycle", *asked)))
    solver = replace(view.solver, outputs=cast(tuple[Output, ...], outputs))
    axes = view.axes(piece.columns, piece.rows)
    axes["r"] = axes["r"][piece.first : piece.last]
    found, curves = solve_map(view.system, axes, solver, None, follower.progress, follower.watch)
    found |= {"beta_lim": curves.beta_lim, "beta_stick": curves.beta_stick}
    return {name: values[0] for name, values in found.items()}  # of the only mu


def classes_of(found: Mapping[str, np.ndarray]) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Classes of the cells of a piece and the boundaries over it, for the page.

    `stops` are the smallest and largest numbers of stops of classes that comprise several.  Arrays: `classes`
    (columns, rows), indices into the palette; `beta_lim` and `beta_stick` (columns,).
    """
    stops = found["stops_per_cycle"]
    classes = of_cells(found["regime"], stops)
    limits = {name: found[name] for name in ("beta_lim", "beta_stick")}
    ranges = {index: stops_range(classes, stops, index) for index in (MORE, NON_INTEGER)}
    counted = {str(index): ends for index, ends in ranges.items() if ends[0] <= ends[1]}
    return {"stops": counted}, {"classes": classes, **limits}


def values_of(found: Mapping[str, np.ndarray], quantity: CellQuantity) -> np.ndarray:
    """A quantity of the cells of a piece, float32 (columns, rows)."""
    values = found[quantity.output]
    return (values if quantity.row is None else values[..., quantity.row]).astype(np.float32)


def piece_of_map(
    view: View, quantity: CellQuantity, piece: Piece, follower: Follower, lines: int = 0
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """A piece of a picture for the page: `classes_of`, and `values` of the quantity if it has some.

    The header contains the `seconds` of the computation, from which the page estimates that of finer maps.

    lines : points of the boundaries over the whole view, finer than coarse cells: `line_lim`, `line_stick`
    """
    began = time.perf_counter()
    found = solve_piece(view, [quantity], piece, follower)
    seconds = time.perf_counter() - began
    header, arrays = classes_of(found)
    if quantity.output:
        arrays["values"] = values_of(found, quantity)
    if lines:
        curves = find_curves(view.system, middles(view.r, lines, "lines"), np.array([view.mu]))
        arrays |= {"line_lim": curves.beta_lim[0], "line_stick": curves.beta_stick[0]}
    return {"first": piece.first, "last": piece.last, "seconds": seconds, **header}, arrays


def marks(system: System) -> dict[str, list[float]]:
    """Marked frequencies of a system."""
    modes = system.modes
    known = {"natural frequency": modes.w}
    if system.n > 1:
        known["natural frequency, contact held"] = modes.held_frequencies()
    return {name: places[:_MOST_MARKS].tolist() for name, places in known.items()}

"""Pieces of a map for the page: classes and quantities of their cells, and the boundaries over them."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..model.held_structure import frequencies_with_held
from ..model.system import System
from ..pictures.classes import of_cells, stops_range
from ..pictures.palette import MORE, NON_INTEGER
from ..solvers.interface import OF_CONTACTS
from .lines import line_names, line_values, values_of_lines
from .quantities import CellQuantity, counted_of
from .views import Follower, Piece, View, middles

#: Frequencies of a kind that are marked.
_MOST_MARKS = 200


def solve_piece(
    view: View, wanted: Sequence[CellQuantity], piece: Piece, follower: Follower, searched: bool = True
) -> dict[str, np.ndarray]:
    """The cells of a piece, (columns, rows), as `sweep` gives them, and over its columns the boundaries.

    `regime`, `stops_per_cycle`, in its place slips, and the quantities are those of the contact that is
    shown; all contacts together have no number of stops.

    searched : whether boundaries that take a search are wanted
    """
    piece.check()
    view.check()
    axes = view.axes(piece.columns, piece.rows)
    axes["r"] = axes["r"][piece.first : piece.last]
    by, k = counted_of(view).variable, view.shown
    asked = (quantity.output for quantity in wanted if quantity.output)
    names = tuple(dict.fromkeys((*filter(None, (by,)), *asked)))
    solved, limits = view.engine.cells(
        axes, names, view.solver, None, follower.progress, follower.watch, searched
    )
    found = {name: _shown_values(name, solved[name][0], k) for name in names}  # of the only mu
    found["regime"] = solved["regime"][0] if k is None else solved["contact_regime"][0, ..., k]
    if by:
        found["stops_per_cycle"] = found[by]
    return found | values_of_lines(view, limits)


def _shown_values(name: str, values: np.ndarray, k: int | None) -> np.ndarray:
    """Values of contact k, or the sum of all; those that are not of contacts as they are."""
    if name not in OF_CONTACTS:
        return values
    return values.sum(axis=-1) if k is None else values[..., k]


def classes_of(
    found: Mapping[str, np.ndarray], names: Sequence[str]
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Classes of the cells of a piece and the boundaries over it, for the page.

    `stops` are the smallest and largest numbers of stops of classes that comprise several.  Arrays: `classes`
    (columns, rows), indices into the palette; the boundaries of these names (columns,).
    """
    stops = found.get("stops_per_cycle")
    classes = of_cells(found["regime"], stops)
    counts = () if stops is None else (MORE, NON_INTEGER)
    ranges = {index: stops_range(classes, found["stops_per_cycle"], index) for index in counts}
    counted = {str(index): ends for index, ends in ranges.items() if ends[0] <= ends[1]}
    return {"stops": counted}, {"classes": classes, **{name: found[name] for name in names}}


def values_of(found: Mapping[str, np.ndarray], quantity: CellQuantity) -> np.ndarray:
    """A quantity of the cells of a piece, float32 (columns, rows)."""
    values = found[quantity.output]
    return (values if quantity.row is None else values[..., quantity.row]).astype(np.float32)


def piece_of_map(
    view: View, quantity: CellQuantity, piece: Piece, follower: Follower, lines: int = 0
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """A piece of a picture for the page: `classes_of`, and `values` of the quantity if it has some.

    The header contains the `seconds` of the computation, from which the page estimates that of finer maps.

    lines : points of the boundaries over the whole view, finer than coarse cells: `line_lim` ...
    """
    if view.unloaded:
        from . import unloaded

        return unloaded.piece_of_map(view, quantity, piece, follower, lines)
    began = time.perf_counter()
    found = solve_piece(view, [quantity], piece, follower)
    seconds = time.perf_counter() - began
    header, arrays = classes_of(found, line_names(view))
    if quantity.output:
        arrays["values"] = values_of(found, quantity)
    if lines:
        arrays |= packet_of_lines(view, lines)
    return {"first": piece.first, "last": piece.last, "seconds": seconds, **header}, arrays


def packet_of_lines(view: View, count: int, *, known: bool = False) -> dict[str, np.ndarray]:
    """The boundaries over the complete view at this number of points: `line_lim` ...; see `line_values`."""
    if view.unloaded:
        from . import unloaded

        return unloaded.packet_of_lines(view, count)
    values = line_values(view, middles(view.r, count, "lines"), known=known)
    return {f"line_{name.removeprefix('beta_')}": line for name, line in values.items()}


def marks(system: System) -> dict[str, list[float]]:
    """Marked frequencies of a system."""
    known = {"natural frequency": system.modes.w}
    contacts = system.contact_system
    if system.n > contacts.count or contacts.elastic.any():  # else nothing moves with them held
        name = f"natural frequency, contact{'s' * (contacts.count > 1)} held"
        known[name] = frequencies_with_held(system, range(contacts.count))
    return {name: places[:_MOST_MARKS].tolist() for name, places in known.items()}

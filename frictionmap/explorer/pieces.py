"""Pieces of a map for the page: classes and quantities of their cells, and the boundaries over them."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from ..model.settings import Output
from ..model.system import System
from ..pictures.classes import of_cells, stops_range
from ..pictures.palette import MORE, NON_INTEGER
from ..single.maps import solve_map
from .lines import line_names, line_values
from .views import CellQuantity, Follower, Piece, View, middles, quantities

#: Frequencies of a kind that are marked.
_MOST_MARKS = 200


def quantities_of(view: View) -> tuple[CellQuantity, ...]:
    """Quantities that can colour the cells of a view."""
    if view.system.general is None:
        return quantities(view.system)
    from .general_views import general_quantities  # these modules are needed for few systems

    return general_quantities(view)


def solve_piece(
    view: View, wanted: Sequence[CellQuantity], piece: Piece, follower: Follower
) -> dict[str, np.ndarray]:
    """The cells of a piece as `sweep` gives them, (columns, rows): regime, stops per cycle, the quantities.

    And over its columns the boundaries.
    """
    piece.check()
    view.check()
    axes = view.axes(piece.columns, piece.rows)
    axes["r"] = axes["r"][piece.first : piece.last]
    if view.system.general is not None:
        from .general_views import solve_general

        return {name: values[0] for name, values in solve_general(view, wanted, axes, follower).items()}
    asked = (quantity.output for quantity in wanted if quantity.output)
    outputs = tuple(dict.fromkeys(("regime", "stops_per_cycle", *asked)))
    solver = replace(view.solver, outputs=cast(tuple[Output, ...], outputs))
    found, curves = solve_map(view.system, axes, solver, None, follower.progress, follower.watch)
    found |= {"beta_lim": curves.beta_lim, "beta_stick": curves.beta_stick}
    return {name: values[0] for name, values in found.items()}  # of the only mu


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
    began = time.perf_counter()
    found = solve_piece(view, [quantity], piece, follower)
    seconds = time.perf_counter() - began
    header, arrays = classes_of(found, line_names(view))
    if quantity.output:
        arrays["values"] = values_of(found, quantity)
    if lines:
        arrays |= packet_of_lines(view, lines)
    return {"first": piece.first, "last": piece.last, "seconds": seconds, **header}, arrays


def packet_of_lines(view: View, count: int) -> dict[str, np.ndarray]:
    """The boundaries over the complete view at this number of points: `line_lim` ..."""
    values = line_values(view, middles(view.r, count, "lines"))
    return {f"line_{name.removeprefix('beta_')}": line for name, line in values.items()}


def marks(system: System) -> dict[str, list[float]]:
    """Marked frequencies of a system."""
    modes = system.modes
    known = {"natural frequency": modes.w}
    if system.general is not None:
        from .general_views import held_frequencies

        known["natural frequency, contacts held"] = held_frequencies(system)
    elif system.n > 1:
        known["natural frequency, contact held"] = modes.held_frequencies()
    return {name: places[:_MOST_MARKS].tolist() for name, places in known.items()}

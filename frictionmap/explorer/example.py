"""Cell whose motion the page opens with: the middle of the largest area of one kind of stick-slip motion."""

import numpy as np

from ..pictures.palette import CONTINUOUS, MORE, ONE, ONE_WAY, UNCOUNTED
from .belt_classes import EXAMPLES
from .pieces import classes_of, solve_piece
from .quantities import quantities_of
from .views import Follower, Piece, View

#: Cells of the map in which it is looked for, by whether they take long.
_CELLS = {False: (48, 36), True: (24, 18)}

#: Digits of its frequency and friction ratio.
_DIGITS = 4


def example_cell(view: View, follower: Follower) -> tuple[float, float] | None:
    """Find a cell of stick-slip motion, else one of sliding; None if no cell of the view moves.

    Motions with an integer number of stops per cycle come first: they repeat.
    """
    columns, rows = _CELLS[not view.is_quick]
    piece = Piece(columns, rows, 0, columns)
    if view.unloaded:
        from . import unloaded

        classes = unloaded.solve(view, piece, follower)["classes"]
    else:
        found = solve_piece(view, quantities_of(view)[:1], piece, follower, searched=False)
        classes = classes_of(found, ())[1]["classes"]
    axes = view.axes(columns, rows)
    own = (range(ONE, MORE + 1), (UNCOUNTED,), (CONTINUOUS, ONE_WAY))
    for kind in EXAMPLES if view.unloaded else own:
        place = largest_square(classes, kind)
        if place is not None:
            r, beta = (
                float(f"{axes[name][k]:.{_DIGITS}g}") for name, k in zip(("r", "beta"), place, strict=True)
            )
            return r, beta
    return None


def largest_square(classes: np.ndarray, kind: range | tuple[int, ...]) -> tuple[int, int] | None:
    """Middle (column, row) of the largest square of cells of one class of a kind; None without such cells."""
    side = np.zeros(classes.shape, dtype=int)
    for column, row in np.argwhere(np.isin(classes, list(kind))):
        before = classes[max(column - 1, 0) : column + 1, max(row - 1, 0) : row + 1]
        alike = column > 0 and row > 0 and (before == classes[column, row]).all()
        inner = side[column - 1, row], side[column, row - 1], side[column - 1, row - 1]
        side[column, row] = 1 + min(inner) if alike else 1
    if not side.any():
        return None
    column, row = np.unravel_index(np.argmax(side), side.shape)
    half = (side[column, row] - 1) // 2
    return int(column - half), int(row - half)

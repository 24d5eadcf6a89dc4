"""Small computations of every kind, so that kernels are compiled or loaded before the page needs them.

The order is that in which an opened page needs them: boundaries, map, motion, other initial states, curves.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..theory.boundary_curves import find_curves
from . import cell, cut, lines, pieces
from .views import Follower, Piece, View

#: Position in the range of r at which motions are rehearsed; rounder ones, like the middle, often resonate.
_ASIDE = 0.382


def _place(view: View) -> float:
    return view.r[0] + _ASIDE * (view.r[1] - view.r[0])


def _lines(view: View, follower: Follower) -> None:
    lines.line_values(view, np.array([_place(view)]))


def _between(view: View) -> tuple[float, float]:
    """beta_lim, and beta_stick, at the frequency of the rehearsal with mu = 1."""
    limits = find_curves(view.system, np.array([_place(view)]), np.array([1.0]))
    lim, stick = limits.beta_lim.item(), limits.beta_stick.item()
    return lim, stick if math.isfinite(stick) else 2.0 * lim + 1.0  # held, it resonates: nothing sticks there


def _map(view: View, follower: Follower) -> None:
    """Cells over the whole map, and some between the boundaries, which closed forms do not decide."""
    regimes = pieces.quantities_of(view)[0]
    pieces.piece_of_map(view, regimes, Piece(2, 2, 0, 2), follower)
    if view.system.general is None:
        r, beta = _place(view), 0.5 * sum(_between(view))
        narrow = replace(view, r=(r, 1.001 * r), beta=(beta, 1.001 * beta))
        pieces.piece_of_map(narrow, regimes, Piece(2, 2, 0, 2), follower)


def _motion(view: View, follower: Follower) -> None:
    """A motion of each regime, with mu = 1, where every motion is found at once."""
    view, r = replace(view, mu=1.0), _place(view)
    if view.system.general is not None:
        cell.motion(view, r, 0.5 * sum(view.beta), follower)
        return
    lim, stick = _between(view)
    for beta in (0.5 * (lim + stick), 0.5 * lim, 1.5 * stick):
        cell.motion(view, r, beta, follower)


def _others(view: View, follower: Follower) -> None:
    if view.system.general is None:
        cell.others(replace(view, mu=1.0), _place(view), 0.5 * sum(_between(view)), follower)


def _cut(view: View, follower: Follower) -> None:
    """Response curves of two points; along r they need kernels that curves along beta do not need."""
    r = _place(view)
    narrow = replace(view, mu=1.0, r=(r, 1.01 * r))
    cut.cut(narrow, "r", 0.5 * sum(view.beta), 2, follower)


def _quantity(view: View, follower: Follower) -> None:
    outputs = {quantity.output: quantity for quantity in pieces.quantities_of(view)[1:]}
    for quantity in outputs.values():
        pieces.piece_of_map(replace(view, mu=1.0), quantity, Piece(2, 2, 0, 2), follower)


#: Kinds of work with what rehearses them: what an opened page shows, and what follows a complete map.
Stages = dict[str, Callable[[View, Follower], None]]
FIRST: Stages = {"lines": _lines, "map": _map, "motion": _motion, "others": _others}
LATER: Stages = {"cut": _cut, "quantity": _quantity}

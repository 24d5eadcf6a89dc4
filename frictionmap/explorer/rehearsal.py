"""Small computations of every kind, so that kernels are compiled or loaded before the page needs them.

The order is that in which an opened page needs them: boundaries, map, motion, other initial states, curves.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from . import cell, cut, lines, pieces
from .quantities import quantities_of
from .views import Follower, Piece, View

#: Position in the range of r at which motions are rehearsed; rounder ones, like the middle, often resonate.
_ASIDE = 0.382


def _place(view: View) -> float:
    return view.r[0] + _ASIDE * (view.r[1] - view.r[0])


def _frictions(view: View) -> tuple[float, ...]:
    """Friction ratios at the frequency of the rehearsal, with mu = 1, whose motions need all kernels.

    Where closed forms say so, one of each regime, that between the boundaries first.
    """
    if view.unloaded or not view.engine.has_closed_limits:
        return (0.5 * sum(view.beta),)
    limits = lines.line_values(replace(view, mu=1.0), np.array([_place(view)]))
    lim, stick = limits["beta_lim"].item(), limits["beta_stick"].item()
    if math.isinf(stick):  # held, it resonates: nothing sticks there
        stick = 2.0 * lim + 1.0
    return 0.5 * (lim + stick), 0.5 * lim, 1.5 * stick


def _lines(view: View, follower: Follower) -> None:
    pieces.packet_of_lines(view, 2)


def _map(view: View, follower: Follower) -> None:
    """Cells over the whole map, and some that closed forms do not decide."""
    regimes = quantities_of(view)[0]
    pieces.piece_of_map(view, regimes, Piece(2, 2, 0, 2), follower)
    if not view.unloaded and view.engine.has_closed_limits:
        r, beta = _place(view), _frictions(view)[0]
        narrow = replace(view, r=(r, 1.001 * r), beta=(beta, 1.001 * beta))
        pieces.piece_of_map(narrow, regimes, Piece(2, 2, 0, 2), follower)


def _motion(view: View, follower: Follower) -> None:
    """Motions with mu = 1, where every one is found at once."""
    for beta in _frictions(view):
        cell.motion(replace(view, mu=1.0), _place(view), beta, follower)


def _others(view: View, follower: Follower) -> None:
    if not view.unloaded and view.engine.compares_starts:
        cell.others(replace(view, mu=1.0), _place(view), _frictions(view)[0], follower)


def _cut(view: View, follower: Follower) -> None:
    """Response curves of two points; along r they need kernels that curves along beta do not need."""
    if view.unloaded:
        return
    r = _place(view)
    narrow = replace(view, mu=1.0, r=(r, 1.01 * r))
    cut.cut(narrow, "r", 0.5 * sum(view.beta), 2, follower)


def _quantity(view: View, follower: Follower) -> None:
    if view.unloaded:  # one computation finds all of them
        return
    outputs = {quantity.output: quantity for quantity in quantities_of(view)[1:]}
    for quantity in outputs.values():
        pieces.piece_of_map(replace(view, mu=1.0), quantity, Piece(2, 2, 0, 2), follower)


#: Kinds of work with what rehearses them: what an opened page shows, and what follows a complete map.
Stages = dict[str, Callable[[View, Follower], None]]
FIRST: Stages = {"lines": _lines, "map": _map, "motion": _motion, "others": _others}
LATER: Stages = {"cut": _cut, "quantity": _quantity}

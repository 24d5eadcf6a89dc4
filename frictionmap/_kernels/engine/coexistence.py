"""Regimes that a cell can reach from different initial states, and the largest beta at which sliding
persists.

Proven regimes are listed without a computation (theory.md 6): continuous motion below beta_lim, permanent
sticking at or above beta_stick; no other regime persists above mu beta_stick.  The others are searched for
from a fixed set of initial states: rest, a large sliding motion, and the steady states on two ladders of
nodes in beta, which are followed upwards and downwards like a slow sweep of the friction, one ladder around
beta_lim and one from beta_stick upwards.  The ladders belong to (mu, r): no cell depends on the other cells
of the map.  A regime counts where a motion from one of these states settles in it, so every regime found is
stable.
"""

import math
from typing import NamedTuple

import numpy as np

from ...regimes import CONTINUOUS, NOT_REACHED, PERMANENT_STICKING, STICK_SLIP
from ..compiler import entry, kernel
from ..compiler.packed import packed
from .march import steady_state
from .motion import (
    at_frequency,
    contact_at,
    forget_neighbour,
    on_continuous,
    restore_state,
    save_state,
    start,
)
from .policies import ABOVE, AROUND, EIGHTHS, NO_FRICTION, RUNGS
from .records import ContactState, Limits, unresolved

#: Halvings of the ladder step within which sliding ends.
_HALVINGS = 22

#: Largest number of scan steps, relative to that of one motion, of all motions along the ladders of a row
#: (with the search for the end of sliding), and of all motions of a cell: at low frequency each may take all
#: of its own.
_ROW_SHARE, _CELL_SHARE = 4.0, 2.0

#: Relative rounding error of beta and of mu beta_stick.
_ROUNDING = 1e-12

#: Flags of regimes.
_STICKS, _STICK_SLIP, _SLIDES = 1, 2, 4

#: Directions along a ladder.
_UP, _DOWN = 0, 1


class Row(NamedTuple):
    """A row of cells: one mu and one frequency."""

    m: int
    i: int
    mu: float
    lim: float
    stick: float
    left: np.ndarray  # (1,) scan steps that its motions may still take


class Ladder(NamedTuple):
    """Nodes in beta, and the sliding steady states found there in either direction, (2, k, ...)."""

    beta: np.ndarray  # (k,)
    slides: np.ndarray  # (2, k) bool, whether a periodic sliding motion was found
    moves: np.ndarray  # (k,) bool, whether any motion slides there, periodic or not
    at: np.ndarray  # (2, k, 5) its contact state; the modal state is saved in the slots from `slot` on
    slot: int


@entry
def _make_ladder(count, slot):
    return Ladder(
        np.zeros(count), np.zeros((2, count), dtype=np.bool_), np.zeros(count, dtype=np.bool_),
        np.zeros((2, count, 5)), slot,
    )  # fmt: skip


@kernel
def _bit(regime):
    """Flag of a regime; 0 for an unresolved one."""
    if regime == PERMANENT_STICKING:
        return _STICKS
    if regime == STICK_SLIP:
        return _STICK_SLIP
    return _SLIDES if regime == CONTINUOUS else 0


@kernel
def _proved(row, beta):
    """Flags of the regimes that are proven without following a motion."""
    if beta == 0.0:
        return _SLIDES
    flags = _SLIDES if beta < row.lim else 0
    return flags | _STICKS if beta >= row.stick else flags


@kernel
def _contact(system, row, beta):
    return contact_at(system, row.m, row.i, beta, row.mu)


@kernel
def _settle(motion, row, contact, at, moves, limits, cancel):
    """Find the steady state that a motion reaches, independent of orbits solved for before.

    The cell is unresolved if the row has no scan steps left.

    Parameters
    ----------
    motion, row, limits, cancel : see `_from_start`
    contact : Contact
    at : ContactState
    moves : whether the motion starts with a slide
    """
    allowed = min(limits.steps, row.left[0])
    if not allowed > 0.0:
        return unresolved(NOT_REACHED, 0.0)
    forget_neighbour(motion)
    bounded = Limits(limits.cycles, limits.tolerance, limits.newton, allowed)
    found = steady_state(motion, contact, at, moves, bounded, cancel)
    row.left[0] -= allowed - motion.scratch.left[0]
    return found


@kernel
def _from_start(motion, system, row, beta, moving, limits, cancel):
    """Find the steady state reached at beta from rest or from the moving start.

    Parameters
    ----------
    motion : a kind of motion
    system : the system over the map
    row : Row
    beta : friction ratio
    moving : whether to use the moving start
    limits : Limits
    cancel : (1,) set by another thread to end the computation
    """
    contact = _contact(system, row, beta)
    at = start(motion, system, row.i, contact, moving)
    return _settle(motion, row, contact, at, moving, limits, cancel)


@kernel
def _from_node(motion, system, row, ladder, way, k, beta, limits, cancel):
    """Find the steady state reached at beta from the state at a node.

    Parameters
    ----------
    motion, system, row, limits, cancel : see `_from_start`
    ladder : Ladder
    way : direction, _UP or _DOWN
    k : index of the node
    beta : friction ratio
    """
    restore_state(motion, ladder.slot + way * ladder.beta.size + k)
    at = ladder.at[way, k]
    moment = ContactState(at[0], at[1], at[2], at[3], at[4])
    return _settle(motion, row, _contact(system, row, beta), moment, False, limits, cancel)


@kernel
def _keep(motion, system, row, ladder, way, k, beta, found):
    """Save a sliding steady state at a node, unless it is the continuous one that exists there anyway.

    Parameters
    ----------
    motion, system, row : see `_from_start`
    ladder, way, k : see `_from_node`
    beta : friction ratio
    found : Cell
    """
    continuous = found.regime == CONTINUOUS
    if not (continuous or found.regime == STICK_SLIP):
        return
    ladder.moves[k] = True
    at = found.contact_state
    if found.slides == 0:
        if not continuous or math.isinf(motion.v_abs) or (beta < row.lim and beta < row.stick):
            return
        at = on_continuous(motion, _contact(system, row, beta))
    save_state(motion, ladder.slot + way * ladder.beta.size + k)
    numbers = ladder.at[way, k]
    numbers[0], numbers[1], numbers[2], numbers[3], numbers[4] = at.z, at.w, at.cos, at.sin, at.contact_force
    ladder.slides[way, k] = True


@kernel
def _take_over(motion, ladder, way, k):
    """Copy the state at a node from the other direction."""
    count = ladder.beta.size
    restore_state(motion, ladder.slot + (1 - way) * count + k)
    save_state(motion, ladder.slot + way * count + k)
    for j in range(ladder.at.shape[2]):
        ladder.at[way, k, j] = ladder.at[1 - way, k, j]
    ladder.slides[way, k] = True


@kernel
def _climb(motion, system, row, ladder, way, limits, cancel):
    """Follow sliding motions from node to node; upwards, a node with no motion to follow uses the moving
    start.

    Parameters
    ----------
    motion, system, row, limits, cancel : see `_from_start`
    ladder, way : see `_from_node`
    """
    count = ladder.beta.size
    before = -1
    for step in range(count):
        k = step if way == _UP else count - 1 - step
        beta = ladder.beta[k]
        # above mu beta_stick no sliding persists
        if 0.0 < beta <= row.mu * row.stick and cancel[0] == 0:
            if before >= 0 and ladder.slides[way, before]:
                found = _from_node(motion, system, row, ladder, way, before, beta, limits, cancel)
                _keep(motion, system, row, ladder, way, k, beta, found)
            elif way == _UP:
                found = _from_start(motion, system, row, beta, True, limits, cancel)
                _keep(motion, system, row, ladder, way, k, beta, found)
            elif ladder.slides[_UP, k]:
                _take_over(motion, ladder, way, k)
        before = k


@kernel
def _fill_ladders(motion, system, row, around, above, limits, cancel):
    """Follow the sliding motions around beta_lim and from beta_stick upwards.

    Parameters
    ----------
    motion, system, row, limits, cancel : see `_from_start`
    around, above : Ladder around beta_lim, and from beta_stick upwards
    """
    for ladder in (around, above):
        ladder.slides[:] = False
        ladder.moves[:] = False
    for k in range(around.beta.size):
        around.beta[k] = row.lim * ((k + 1) / 8.0)
    for k in range(above.beta.size):
        # at a resonance of the held structure the contact never sticks, and there is nothing to search for
        step = (row.mu - 1.0) * k / above.beta.size
        above.beta[k] = 0.0 if math.isinf(row.stick) else row.stick * (1.0 + step)
    for way in range(2):
        _climb(motion, system, row, around, way, limits, cancel)
        _climb(motion, system, row, above, way, limits, cancel)


@kernel
def _next_node(ladder, way, beta):
    """Index of the next node below (upwards) or above beta (downwards) if a motion slides there; else -1."""
    count = ladder.beta.size
    for step in range(count):
        k = count - 1 - step if way == _UP else step
        if (ladder.beta[k] <= beta) if way == _UP else (ladder.beta[k] >= beta):
            return k if ladder.slides[way, k] else -1
    return -1


@kernel
def _from_ladders(motion, system, row, beta, around, above, flags, limits, cancel):
    """Add to `flags` the regimes reached from the nodes beside a cell, where they can add any.

    Parameters
    ----------
    motion, system, row, limits, cancel : see `_from_start`
    beta : friction ratio
    around, above : see `_fill_ladders`
    flags : flags of the regimes found so far
    """
    for way in range(2):
        k = _next_node(around, way, beta)
        if k >= 0 and (beta < row.lim or flags == 0) and not flags & _STICK_SLIP:
            flags |= _bit(
                _from_node(motion, system, row, around, way, k, beta, limits, cancel).regime
            )  # fmt: skip
        k = _next_node(above, way, beta)
        if k >= 0 and (beta >= row.stick or flags == 0) and flags & 6 != _STICK_SLIP | _SLIDES:
            flags |= _bit(_from_node(motion, system, row, above, way, k, beta, limits, cancel).regime)
    return flags


@kernel
def _decided(row, beta):
    """Whether what is proved is all: no friction, or none beside the load's rounding; or too much of it."""
    lost = beta < row.lim and beta < NO_FRICTION * row.stick and row.stick < math.inf
    return beta == 0.0 or lost or beta > row.mu * row.stick * (1.0 + _ROUNDING)


@kernel
def _any_open(row, beta):
    """Whether a cell of a row is not decided."""
    found = False
    for j in range(beta.size):
        found = found or not _decided(row, beta[j])
    return found


@kernel
def _reachable(motion, system, row, beta, around, above, limits, cancel):
    """Flags of the regimes that a cell can reach.

    Parameters
    ----------
    motion, system, row, limits, cancel : see `_from_start`
    beta : friction ratio
    around, above : see `_fill_ladders`
    """
    flags = _proved(row, beta)
    if _decided(row, beta):
        return flags
    if row.mu == 1.0:  # the steady state is unique
        if flags == 0:
            flags = _bit(_from_start(motion, system, row, beta, False, limits, cancel).regime)
        return flags
    for k in range(2):
        flags |= _bit(_from_start(motion, system, row, beta, k == 1, limits, cancel).regime)
    return _from_ladders(motion, system, row, beta, around, above, flags, limits, cancel)


@kernel
def _sliding_limit(motion, system, row, above, limits, cancel):
    """Largest beta at which sliding persists, followed upwards from the highest node with sliding motion."""
    if row.mu == 1.0 or math.isinf(row.stick):
        return row.stick
    last = -1
    for k in range(above.beta.size):
        if above.moves[k]:
            last = k
    least = max(row.stick, row.lim)  # up to there sliding is proven
    if last < 0:
        return least
    low = above.beta[last]
    high = above.beta[last + 1] if last + 1 < above.beta.size else row.mu * row.stick
    way = _UP if above.slides[_UP, last] else _DOWN
    for _ in range(_HALVINGS if above.slides[way, last] else 0):
        middle = 0.5 * (low + high)
        if not low < middle < high or cancel[0] != 0:
            break
        found = _from_node(motion, system, row, above, way, last, middle, limits, cancel)
        if found.regime == STICK_SLIP or found.regime == CONTINUOUS:
            low = middle
            _keep(motion, system, row, above, way, last, middle, found)
        else:
            high = middle
    return max(least, low)


@kernel
def _fill_still(row, no_load, beta, reachable, sliding_limit):
    """Fill the row r = 0, at which no motion can be followed."""
    m, i = row.m, row.i
    for j in range(beta.size if reachable.size else 0):
        flags = _STICKS if no_load else _proved(row, beta[j])
        reachable[m, i, j] = flags if flags != 0 else _STICK_SLIP
    if sliding_limit.size:
        sliding_limit[m, i] = row.stick


@kernel
def _fill_row(row, beta, motion, system, around, above, limits, out, cancel):
    """Fill one row; whether it was not cancelled.

    Parameters
    ----------
    row : Row
    beta : friction ratios
    motion : a kind of motion
    around, above : Ladder, scratch
    system, limits, out, cancel : see `fill_reachable`
    """
    motion, system, around, above = packed(motion), packed(system), packed(around), packed(above)
    reachable, sliding_limit = out.also_reachable, out.sliding_limit
    row.left[0] = _ROW_SHARE * limits.steps
    if row.mu > 1.0 and (sliding_limit.size or _any_open(row, beta)):
        _fill_ladders(motion, system, row, around, above, limits, cancel)
    on_ladders = row.left[0]
    for j in range(beta.size if reachable.size else 0):
        if cancel[0] != 0:
            return False
        row.left[0] = _CELL_SHARE * limits.steps
        found = _reachable(motion, system, row, beta[j], around, above, limits, cancel)
        reachable[row.m, row.i, j] = found
    if sliding_limit.size:
        row.left[0] = on_ladders
        sliding_limit[row.m, row.i] = _sliding_limit(motion, system, row, above, limits, cancel)
    return True


@entry
def fill_reachable(first, last, axes, lim, stick, no_load, system, limits, out, cancel):
    """Fill `out.also_reachable` and `out.sliding_limit` for rows first..last-1 of the (mu, r) grid.

    Parameters
    ----------
    first, last : range of rows
    axes : Axes
    lim, stick : (n_mu, n_r) beta_lim and beta_stick
    no_load : (n_r,) bool, where the contact carries no load
    system : a system over the map, see `motion`
    limits : Limits
    out : named tuple of output arrays; those that are not requested have size 0
    cancel : (1,) set by another thread to end the computation
    """
    n_r = axes.r.size
    around, above = _make_ladder(EIGHTHS, AROUND), _make_ladder(RUNGS, ABOVE)
    left = np.empty(1)
    for place in range(first, last):
        m, i = place // n_r, place % n_r
        row = Row(m, i, axes.mu[m], lim[m, i], stick[m, i], left)
        if axes.r[i] == 0.0:
            _fill_still(row, no_load[i], axes.beta, out.also_reachable, out.sliding_limit)
            continue
        motion = at_frequency(system, i)
        if not _fill_row(row, axes.beta, motion, system, around, above, limits, out, cancel):
            return

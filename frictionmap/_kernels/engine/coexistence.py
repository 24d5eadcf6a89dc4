"""Which regimes a cell can end in, and how far in beta a sliding motion reaches.

What is proved is listed without looking (theory.md 6): below beta_lim the continuous motion, from beta_stick
on sticking; beyond mu beta_stick nothing else lasts.  What is left is looked for by motions from a fixed set
of starts: rest; a large sliding motion; and the steady states on two ladders of nodes in beta, followed
upwards and downwards as in a slow sweep of the friction, one around beta_lim and one from beta_stick up.  The
ladders belong to (mu, r): no cell depends on which others a map has.  A regime counts where a motion from
such a start settles in it: what is found is stable.
"""

import math
from typing import NamedTuple

import numpy as np

from ...regimes import CONTINUOUS, PERMANENT_STICKING, STICK_SLIP
from ..jit import entry, kernel
from .march import steady_state
from .motion import at_frequency, bring_back, contact_at, forget_neighbour, keep_state, on_continuous, start
from .policies import ABOVE, AROUND, EIGHTHS, RUNGS
from .records import ContactState

#: Halvings of the step of the ladder in which a sliding motion ends.
_HALVINGS = 22

#: Beyond mu beta_stick by more than this, relative to it: the rounding of either.
_ROUNDING = 1e-12

#: Flags of regimes.
_STICKS, _STICK_SLIP, _SLIDES = 1, 2, 4

#: Ways along a ladder.
_UP, _DOWN = 0, 1


class Row(NamedTuple):
    """A row of cells: one mu and one frequency."""

    m: int
    i: int
    mu: float
    lim: float
    stick: float


class Ladder(NamedTuple):
    """Nodes in beta, and the sliding steady states found there either way, (2, k, ...)."""

    beta: np.ndarray  # (k,)
    slides: np.ndarray  # (2, k) bool, whether there is one
    moves: np.ndarray  # (k,) bool, whether anything slides there, also what does not repeat
    at: np.ndarray  # (2, k, 5) its moment; its state is kept in the slots from `slot` on
    slot: int


@entry
def _make_ladder(count, slot):
    return Ladder(
        np.zeros(count), np.zeros((2, count), dtype=np.bool_), np.zeros(count, dtype=np.bool_),
        np.zeros((2, count, 5)), slot,
    )  # fmt: skip


@kernel
def _bit(regime):
    """Flag of a regime; 0 where unresolved."""
    if regime == PERMANENT_STICKING:
        return _STICKS
    if regime == STICK_SLIP:
        return _STICK_SLIP
    return _SLIDES if regime == CONTINUOUS else 0


@kernel
def _proved(row, beta):
    """Flags of the regimes that need no motion to be found."""
    if beta == 0.0:
        return _SLIDES
    flags = _SLIDES if beta < row.lim else 0
    return flags | _STICKS if beta >= row.stick else flags


@kernel
def _contact(system, row, beta):
    return contact_at(system, row.m, row.i, beta, row.mu)


@kernel
def _settle(motion, contact, at, moves, limits, cancel):
    """Where a motion ends, whatever was solved for before."""
    forget_neighbour(motion)
    return steady_state(motion, contact, at, moves, limits, cancel)


@kernel
def _from_start(motion, system, row, beta, moving, limits, cancel):
    contact = _contact(system, row, beta)
    at = start(motion, system, row.i, contact, moving)
    return _settle(motion, contact, at, moving, limits, cancel)


@kernel
def _from_node(motion, system, row, ladder, way, k, beta, limits, cancel):
    """Where the motion at beta ends that starts from the state at a node."""
    bring_back(motion, ladder.slot + way * ladder.beta.size + k)
    at = ladder.at[way, k]
    moment = ContactState(at[0], at[1], at[2], at[3], at[4])
    return _settle(motion, _contact(system, row, beta), moment, False, limits, cancel)


@kernel
def _keep(motion, system, row, ladder, way, k, beta, found):
    """Keep a steady state at a node, if it slides; but not the continuous one that is there anyway."""
    continuous = found.regime == CONTINUOUS
    if not (continuous or found.regime == STICK_SLIP):
        return
    ladder.moves[k] = True
    at = found.contact_state
    if found.slides == 0:
        if not continuous or math.isinf(motion.v_abs) or (beta < row.lim and beta < row.stick):
            return
        at = on_continuous(motion, _contact(system, row, beta))
    keep_state(motion, ladder.slot + way * ladder.beta.size + k)
    numbers = ladder.at[way, k]
    numbers[0], numbers[1], numbers[2], numbers[3], numbers[4] = at.z, at.w, at.cos, at.sin, at.contact_force
    ladder.slides[way, k] = True


@kernel
def _take_over(motion, ladder, way, k):
    """The state at a node as it was found the other way."""
    count = ladder.beta.size
    bring_back(motion, ladder.slot + (1 - way) * count + k)
    keep_state(motion, ladder.slot + way * count + k)
    for j in range(ladder.at.shape[2]):
        ladder.at[way, k, j] = ladder.at[1 - way, k, j]
    ladder.slides[way, k] = True


@kernel
def _climb(motion, system, row, ladder, way, limits, cancel):
    """Follow what slides from node to node; upwards, where nothing does, a large motion tries."""
    count = ladder.beta.size
    before = -1
    for step in range(count):
        k = step if way == _UP else count - 1 - step
        beta = ladder.beta[k]
        # beyond, nothing slides for good
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
    """Follow the sliding motions around beta_lim and from beta_stick up."""
    for ladder in (around, above):
        ladder.slides[:] = False
        ladder.moves[:] = False
    for k in range(around.beta.size):
        around.beta[k] = row.lim * ((k + 1) / 8.0)
    for k in range(above.beta.size):
        # where the held structure resonates nothing sticks, and there is nothing to look for
        step = (row.mu - 1.0) * k / above.beta.size
        above.beta[k] = 0.0 if math.isinf(row.stick) else row.stick * (1.0 + step)
    for way in range(2):
        _climb(motion, system, row, around, way, limits, cancel)
        _climb(motion, system, row, above, way, limits, cancel)


@kernel
def _beside(ladder, way, beta):
    """The node next below beta, upwards, or next above it, if a motion slides there; else -1."""
    count = ladder.beta.size
    for step in range(count):
        k = count - 1 - step if way == _UP else step
        if (ladder.beta[k] <= beta) if way == _UP else (ladder.beta[k] >= beta):
            return k if ladder.slides[way, k] else -1
    return -1


@kernel
def _from_ladders(motion, system, row, beta, around, above, flags, limits, cancel):
    """`flags` with those of the motions from the nodes beside a cell, as far as they can add any."""
    for way in range(2):
        k = _beside(around, way, beta)
        if k >= 0 and (beta < row.lim or flags == 0) and not flags & _STICK_SLIP:
            flags |= _bit(
                _from_node(motion, system, row, around, way, k, beta, limits, cancel).regime
            )  # fmt: skip
        k = _beside(above, way, beta)
        if k >= 0 and (beta >= row.stick or flags == 0) and flags & 6 != _STICK_SLIP | _SLIDES:
            flags |= _bit(_from_node(motion, system, row, above, way, k, beta, limits, cancel).regime)
    return flags


@kernel
def _reachable(motion, system, row, beta, around, above, limits, cancel):
    """Flags of the regimes that a cell can end in."""
    flags = _proved(row, beta)
    if beta == 0.0 or beta > row.mu * row.stick * (1.0 + _ROUNDING):
        return flags
    if row.mu == 1.0:  # one answer
        if flags == 0:
            flags = _bit(_from_start(motion, system, row, beta, False, limits, cancel).regime)
        return flags
    for k in range(2):
        flags |= _bit(_from_start(motion, system, row, beta, k == 1, limits, cancel).regime)
    return _from_ladders(motion, system, row, beta, around, above, flags, limits, cancel)


@kernel
def _sliding_limit(motion, system, row, above, limits, cancel):
    """The largest beta at which a motion slides for good, followed on from the highest node with one."""
    if row.mu == 1.0 or math.isinf(row.stick):
        return row.stick
    last = -1
    for k in range(above.beta.size):
        if above.moves[k]:
            last = k
    least = max(row.stick, row.lim)  # up to there one is sure to
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
    """The row r = 0, where there is no motion to follow."""
    m, i = row.m, row.i
    for j in range(beta.size if reachable.size else 0):
        flags = _STICKS if no_load else _proved(row, beta[j])
        reachable[m, i, j] = flags if flags != 0 else _STICK_SLIP
    if sliding_limit.size:
        sliding_limit[m, i] = row.stick


@entry
def fill_reachable(first, last, axes, lim, stick, no_load, system, limits, out, cancel):
    """Rows first..last-1 of (mu, r): `out.also_reachable` and `out.sliding_limit`.

    One that was not asked for has no values.  no_load : (n_r,) bool, where nothing loads the contact.
    """
    reachable, sliding_limit = out.also_reachable, out.sliding_limit
    beta, n_r = axes.beta, axes.r.size
    around, above = _make_ladder(EIGHTHS, AROUND), _make_ladder(RUNGS, ABOVE)
    for place in range(first, last):
        m, i = place // n_r, place % n_r
        row = Row(m, i, axes.mu[m], lim[m, i], stick[m, i])
        if axes.r[i] == 0.0:
            _fill_still(row, no_load[i], beta, reachable, sliding_limit)
            continue
        motion = at_frequency(system, i)
        if row.mu > 1.0:
            _fill_ladders(motion, system, row, around, above, limits, cancel)
        for j in range(beta.size if reachable.size else 0):
            if cancel[0] != 0:
                return
            reachable[m, i, j] = _reachable(
                motion, system, row, beta[j], around, above, limits, cancel
            )  # fmt: skip
        if sliding_limit.size:
            sliding_limit[m, i] = _sliding_limit(motion, system, row, above, limits, cancel)

"""Which regimes a cell can end in, from a fixed set of starts; and how far in beta a sliding motion reaches.

For mu > 1 the start decides (theory.md 6).  The starts: rest; a large sliding motion; the steady states of
the neighbours in beta, upwards and downwards, as in a slow sweep of the friction; and, by their closed
forms, the continuous orbit below beta_lim and the contact held from beta_stick on.  A regime counts where a
motion from such a start settles in it: what is found is stable.
"""

import math
from typing import NamedTuple

from ...regimes import CONTINUOUS, NOT_COMPUTED, PERMANENT_STICKING, STICK_SLIP
from ..jit import entry, kernel
from .answers import Moment, nowhere
from .march import steady_state
from .motion import (
    at_frequency,
    bring_back,
    contact_at,
    forget_neighbour,
    keep_state,
    on_continuous,
    start,
)
from .policies import FARTHEST, NEIGHBOUR

#: Halvings of the step of the grid in which a sliding motion ends.
_HALVINGS = 30

#: Starts of a row, in this order.
_REST, _MOVING, _UPWARDS, _DOWNWARDS = 0, 1, 2, 3

#: Flags of regimes.
_STICKS, _STICK_SLIP, _SLIDES = 1, 2, 4


class Row(NamedTuple):
    """A row of cells: one mu and one frequency."""

    m: int
    i: int
    mu: float
    lim: float
    stick: float


class Far(NamedTuple):
    """The sliding motion at the largest beta so far; its state is kept in the slot FARTHEST."""

    beta: float  # 0 if there is none
    at: Moment


@kernel
def _bit(regime):
    """Flag of a regime; 0 where unresolved."""
    if regime == PERMANENT_STICKING:
        return _STICKS
    if regime == STICK_SLIP:
        return _STICK_SLIP
    return _SLIDES if regime == CONTINUOUS else 0


@kernel
def _keep(motion, contact, found, slot):
    """(slides, moment): whether `found` slides; then its state is kept in the slot."""
    slides = found.regime == STICK_SLIP or found.regime == CONTINUOUS
    if slides and found.slides > 0:
        keep_state(motion, slot)
        return True, found.at
    if found.regime == CONTINUOUS and not math.isinf(motion.v_abs):
        at = on_continuous(motion, contact)
        keep_state(motion, slot)
        return True, at
    return False, nowhere()


@kernel
def _by_formula(row, beta, flags):
    """Flags of what needs no start: the continuous orbit attracts, and so does the held contact."""
    for j in range(beta.size):
        if beta[j] < row.lim or beta[j] == 0.0:
            flags[j] |= _SLIDES
        if beta[j] >= row.stick and beta[j] > 0.0:
            flags[j] |= _STICKS


@kernel
def _from_starts(motion, system, row, beta, first, limits, flags, far, cancel):
    """(whether to go on, far): the cells of a row, each from one kind of start."""
    unique = row.mu == 1.0
    slides, kept = False, nowhere()
    for k in range(beta.size):
        j = beta.size - 1 - k if first == _DOWNWARDS else k
        if beta[j] == 0.0 or (unique and flags[j] != 0):
            continue
        contact = contact_at(system, row.m, row.i, beta[j], row.mu)
        moves = False
        if first >= _UPWARDS and slides:
            bring_back(motion, NEIGHBOUR)
            at = kept
        elif first >= _UPWARDS and not flags[j] & (_STICK_SLIP | _SLIDES):
            continue
        else:
            # nothing slid below (above): a large motion shows whether anything does here
            moves = first != _REST
            at = start(motion, system, row.i, contact, moves)
        found = steady_state(motion, contact, at, moves, limits, cancel)
        if found.status == NOT_COMPUTED:
            return False, far
        flags[j] |= _bit(found.regime)
        slides, kept = _keep(motion, contact, found, NEIGHBOUR)
        if slides and beta[j] >= far.beta:
            far = Far(beta[j], kept)
            keep_state(motion, FARTHEST)
    return True, far


@kernel
def _reach(motion, system, row, beta, limits, far, cancel):
    """The largest beta to which the motion that slides farthest can be followed; nan if that was ended."""
    low = high = far.beta
    at = far.at
    for j in range(beta.size - 1, -1, -1):
        if beta[j] > far.beta:
            high = beta[j]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        contact = contact_at(system, row.m, row.i, middle, row.mu)
        bring_back(motion, FARTHEST)
        found = steady_state(motion, contact, at, False, limits, cancel)
        if found.status == NOT_COMPUTED:
            return math.nan
        goes_on, kept = _keep(motion, contact, found, FARTHEST)
        if goes_on:
            low, at = middle, kept
        else:
            high = middle
    return low


@entry
def fill_reachable(first, last, axes, lim, stick, system, limits, reachable, sliding_limit, cancel):
    """Rows first..last-1 of (mu, r): `reachable` (n_mu, n_r, n_beta) flags, `sliding_limit` (n_mu, n_r)."""
    beta = axes.beta
    n_r = axes.r.size
    for place in range(first, last):
        m, i = place // n_r, place % n_r
        row = Row(m, i, axes.mu[m], lim[m, i], stick[m, i])
        flags = reachable[m, i]
        unique = row.mu == 1.0
        _by_formula(row, beta, flags)
        if unique:
            sliding_limit[m, i] = row.stick
        if axes.r[i] == 0.0:
            for j in range(beta.size):
                flags[j] = flags[j] if flags[j] != 0 else _STICK_SLIP
            continue
        motion = at_frequency(system, i)
        forget_neighbour(motion)
        far = Far(0.0, nowhere())
        goes_on = True
        for first_start in range(1 if unique else 4):
            if goes_on:
                goes_on, far = _from_starts(
                    motion, system, row, beta, first_start, limits, flags, far, cancel
                )
        if not goes_on:
            return
        if unique:
            continue
        # up to beta_lim the continuous orbit exists; a motion that does not repeat slides too
        limit = row.lim
        for j in range(beta.size):
            if flags[j] & (_STICK_SLIP | _SLIDES):
                limit = max(limit, beta[j])
        if far.beta > 0.0:
            limit = max(limit, _reach(motion, system, row, beta, limits, far, cancel))
        sliding_limit[m, i] = limit

"""Friction with which no contact stops: intervals of beta, from the motions themselves (theory.md 11)."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..compiler.packed import packed
from .follow import MOVED, NEAREST_STOP, STOPS
from .record import NOTHING
from .series import Friction
from .steady import REPEATS, begin_row, from_rest, make_tools, solve

#: Nodes in beta at which the motion is tried: so many in geometric progression from _LOWEST of the top up,
#: then equally spaced ones.
_GEOMETRIC, _EQUAL, _LOWEST = 32, 48, 1e-6
NODES = _GEOMETRIC + _EQUAL

#: Trials around an end at most, of which each third halves the interval; and the first distance of a trial
#: from where the end should be, over that from the last trial inside.
_TRIALS = 160
_OFF = 0.01


class Search(NamedTuple):
    """Friction over beta, as in `fill.Grid`, and where to search."""

    kinetic: np.ndarray  # (N, 2)
    static: np.ndarray  # (n_mu, N, 2)
    top: np.ndarray  # (n_r,) largest beta that is tried
    sticks: np.ndarray  # (n_r,) bool: whether all contacts stick permanently at `top`: motions there creep
    starts: np.ndarray  # (n_r, 2, m)
    cycles: float
    tolerance: float


@kernel
def _node(top, k):
    """Friction ratio of node k = 0..NODES."""
    if k > _GEOMETRIC:
        return top * (k - _GEOMETRIC) / _EQUAL
    return top * math.pow(_LOWEST, 1.0 - k / (_GEOMETRIC + 1.0)) / _EQUAL


@kernel
def _margin(search, m, beta, kept, k):
    """Distance from a stop, > 0 where no contact stops, from what was kept of the motion in row k."""
    if kept[k, 0] > 0.0 or kept[k, 0] != kept[k, 0]:
        return -1.0
    worst = 0.0
    for j in range(search.kinetic.shape[0]):
        kinetic = search.kinetic[j, 0] * beta + search.kinetic[j, 1]
        static = search.static[m, j, 0] * beta + search.static[m, j, 1]
        if kinetic > 0.0:
            worst = max(worst, static / kinetic * kept[k, 1 + j])
    return 1.0 - worst


@kernel
def _try(problem, i, search, beta, near, friction, tools, kept, k):
    """Keep the number of stops, and how near the turns are to one, of the motion with mu = 1 at beta.

    Parameters
    ----------
    problem, i : Problem, index of r
    search : Search
    beta : friction ratio
    near : whether the state in memory is that of a steady state near by
    friction : Friction, filled
    tools : Tools, after `begin_row`
    kept, k : row k is filled: stops, NaN without a steady state; NEAREST_STOP of every contact
    """
    memory = tools.memory
    contacts = problem.spring.size
    for j in range(contacts):
        friction.kinetic[j] = search.kinetic[j, 0] * beta + search.kinetic[j, 1]
        friction.static[j] = friction.kinetic[j]
    if not near:
        from_rest(problem, tools.row, friction, search.starts[i], tools.work, memory, tools.record, NOTHING)
    found, _, _ = solve(problem, friction, search.cycles, search.tolerance, tools, NOTHING)
    kept[k, 0] = math.nan
    if found.status != REPEATS:
        return False
    kept[k, 0] = 0.0
    for j in range(contacts):
        kept[k, 0] += memory.counts[STOPS, j]
        if memory.counts[MOVED, j] == 0.0:
            kept[k, 0] += 1.0  # it sticks permanently
        kept[k, 1 + j] = memory.counts[NEAREST_STOP, j]
    return True


@kernel
def _end(problem, i, search, m, inside, outside, friction, tools, kept):
    """End of an interval between a beta without stops and one with.

    Where a turn becomes a stop, the margin goes to zero there: trials on both sides of where it should be
    zero close in on it.  Where a slide begins to touch zero velocity, it does not: the interval is halved.

    Parameters
    ----------
    problem, i : Problem, index of r
    search, m : Search, index of mu
    inside, outside : friction ratios without and with stops
    friction, tools, kept : see `_try`
    """
    near = _try(problem, i, search, inside, False, friction, tools, kept, NODES + 1)
    margin = _margin(search, m, inside, kept, NODES + 1)
    guess = math.nan
    off = _OFF
    for count in range(_TRIALS):
        beta = guess + off * (guess - inside)
        aimed = count % 3 < 2 and min(inside, outside) < beta < max(inside, outside)
        if not aimed:
            beta = 0.5 * (inside + outside)
        if beta == inside or beta == outside:
            break
        near = _try(problem, i, search, beta, near, friction, tools, kept, NODES + 1)
        now = _margin(search, m, beta, kept, NODES + 1)
        if aimed and (now > 0.0) == (off < 0.0):
            off *= -0.1
        elif aimed:
            off *= 10.0 if abs(off) < _OFF else -1.0
        if now > 0.0:
            guess = beta + now * (beta - inside) / (margin - now)
            inside, margin = beta, now
        else:
            outside = beta
    return inside


@kernel
def _ends_at(i, search, m, kept, k):
    """Whether an interval without stops ends between the nodes k - 1 and k."""
    if k == 0 or _margin(search, m, _node(search.top[i], k), kept, k) > 0.0:
        return False
    return _margin(search, m, _node(search.top[i], k - 1), kept, k - 1) > 0.0


@kernel
def _enough_end(i, search, wanted, kept, last):
    """Whether the wanted number of intervals ends between the nodes 0..last, for every mu."""
    for m in range(search.static.shape[0]):
        count = 0
        for k in range(1, last + 1):
            if _ends_at(i, search, m, kept, k):
                count += 1
        if count < wanted:
            return False
    return True


@kernel
def _try_nodes(problem, i, search, wanted, friction, tools, kept):
    """Try the nodes until the wanted number of intervals has ended for every mu; return the last one tried.

    Parameters
    ----------
    problem, i, search : Problem, index of r, Search
    wanted : number of intervals
    friction, tools, kept : see `_try`
    """
    near = False
    for k in range(NODES + 1):
        if k == NODES and search.sticks[i]:
            kept[k, 0] = 1.0
        else:
            near = _try(problem, i, search, _node(search.top[i], k), near, friction, tools, kept, k)
        ended = False
        for m in range(search.static.shape[0]):
            ended = ended or _ends_at(i, search, m, kept, k)
        if ended and _enough_end(i, search, wanted, kept, k):  # the number changes where one ends
            return k
    return NODES


@kernel
def _fill(first, last, problem, search, begins, ends, tools, friction, kept, cancel):
    """Fill the intervals; see `fill_no_stop`.

    Parameters
    ----------
    first, last, problem, search, begins, ends, cancel : see `fill_no_stop`
    tools, friction : Tools, Friction; their content does not matter
    kept : see `_try`
    """
    problem, search, tools, friction = packed(problem), packed(search), packed(tools), packed(friction)
    for i in range(first, last):
        if cancel[0] != 0:
            return
        if problem.r[i] == 0.0:
            continue
        begin_row(problem, i, tools)
        last = _try_nodes(problem, i, search, begins.shape[2], friction, tools, kept)
        for m in range(search.static.shape[0]):
            count = 0
            margin = _margin(search, m, _node(search.top[i], 0), kept, 0)
            if margin > 0.0:
                begins[m, i, 0] = 0.0
            for k in range(1, last + 1):
                before, here = _node(search.top[i], k - 1), _node(search.top[i], k)
                now = _margin(search, m, here, kept, k)
                if margin > 0.0 and now <= 0.0 and count < begins.shape[2]:
                    ends[m, i, count] = _end(problem, i, search, m, before, here, friction, tools, kept)
                    count += 1
                if margin <= 0.0 and now > 0.0 and count < begins.shape[2]:
                    begins[m, i, count] = _end(problem, i, search, m, here, before, friction, tools, kept)
                margin = now
            if margin > 0.0 and count < begins.shape[2]:
                ends[m, i, count] = math.inf


@entry
def fill_no_stop(first, last, problem, search, begins, ends, cancel):
    """Fill the intervals of beta in which no contact stops, at the frequencies first..last-1.

    Parameters
    ----------
    first, last : range of r
    problem : Problem
    search : Search
    begins, ends : (n_mu, n_r, intervals) filled, NaN where there are fewer
    cancel : (1,) set by another thread to end the computation
    """
    tools = make_tools(problem, np.empty((0, problem.squares.size)), 0)
    contacts = problem.spring.size
    friction = Friction(np.empty(contacts), np.empty(contacts))
    kept = np.zeros((NODES + 2, 1 + contacts))
    _fill(first, last, problem, search, begins, ends, tools, friction, kept, cancel)

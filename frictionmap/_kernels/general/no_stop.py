"""Friction with which no contact stops: intervals of beta, from the motions themselves (theory.md 11).

The steady state for mu = 1 is followed from beta = 0 up, and a step is shortened until nothing unseen can lie
between two motions (`neighbours`).  A step of the motions is one of beta.
"""

import math

from ..compiler import entry, kernel
from .ends import (
    RESOLVED,
    change_at_larger_static_friction,
    close_in,
    is_certain,
    open_interval,
    pass_end,
    put_between,
)
from .neighbours import (
    GROWS,
    HAS_STOPS,
    LINKED,
    NOT_FOUND,
    SLIDES,
    TURNING,
    clear_motions,
    copy_neighbour,
    doubt_between,
    keep_at_rest,
    link,
    way_to_stop,
)
from .reach import (
    AFTER_END,
    EQUAL,
    HERE,
    INSIDE_END,
    LOOSE,
    LOWEST,
    NEXT,
    find_first_motion,
    find_motion,
    keep_unknown,
    margin,
)
from .return_map import allow_factors
from .steady import begin_row

#: Places in `Walk.pace`: the next step; a friction ratio whose motion is not like that HERE; where to go on
#: after friction ratios at which none was found, 0 where there are none.
_STEP, _WALL, _LEAP = 0, 1, 2

#: First step, over the change at which a contact begins to stop if all goes on as it begins, or over the
#: scale: the rates by which the next steps are judged are known from it.
_FIRST = 0.01

#: Largest change of a step from one to the next, and the doubt that is aimed at: less than the accepted
#: one, 1, since it changes with the square of the step.
_GROWS, _SHRINKS, _AIM = 2.5, 0.2, 0.8

#: Where contacts stop, the largest step over beta: contacts that rest say nothing about what the others do.
_LARGEST = 0.5

#: A step this much longer than the way to an end passes it.
_BEYOND = 1.05

#: Change of beta over beta below which motions that are not alike count as next to each other: where two
#: contacts turn together margins jump.
_LEAST = 1e-8

#: The same before friction ratios at which no motion is found, where contacts stop: some creeping motions are
#: not. The search goes on at this multiple of beta.
_LEAST_UNKNOWN, _LEAPS = 1e-3, 1.25


@kernel
def _first_step(i, search, walk):
    """First step from the motion HERE."""
    motions = walk.motions
    beta = motions.beta[HERE]
    if search.known[i] == search.known[i]:
        return AFTER_END * beta
    nearest = 0.0
    if motions.kind[HERE] == SLIDES:
        for j in range(search.kinetic.shape[0]):
            if search.kinetic[j, 1] == 0.0:
                nearest = max(nearest, motions.margins[HERE, TURNING, j])
    return _FIRST * (beta / nearest if nearest > 0.0 else search.scale[i])


@kernel
def _begin(problem, i, search, found, walk):
    """Find the first motion, and begin the intervals that it lies in.

    Parameters
    ----------
    problem, i, search, found : Problem, index of r, Search, Intervals
    walk : Walk
    """
    motions = walk.motions
    clear_motions(motions)
    known = search.known[i] == search.known[i]
    find_first_motion(problem, i, search, walk)
    if known and motions.kind[HERE] == SLIDES:  # a further interval, from between here and the known end on
        keep_unknown(max(search.known[i], LOWEST * search.scale[i]), walk, HERE, NEXT)
        put_between(walk, HERE, NEXT)
        close_in(problem, i, search, EQUAL, walk, RESOLVED)
        copy_neighbour(motions, INSIDE_END, HERE)
    for m in range(walk.ended.size):
        walk.ended[m], walk.open[m] = 1 if known else 0, 0
        if margin(search, m, walk, HERE) > 0.0:
            open_interval(found, i, m, motions.beta[HERE] if known else 0.0, walk)
    walk.pace[_STEP], walk.pace[_WALL], walk.pace[_LEAP] = _first_step(i, search, walk), math.inf, 0.0


@kernel
def _target(walk, top):
    """Friction ratio of the next motion."""
    beta, pace = walk.motions.beta[HERE], walk.pace
    if pace[_LEAP] > 0.0:
        return min(pace[_LEAP], top)
    if beta >= pace[_WALL]:
        pace[_WALL] = math.inf
    near = pace[_WALL] - beta <= _LEAST * pace[_WALL]
    return min(beta + pace[_STEP], pace[_WALL] if near else 0.5 * (beta + pace[_WALL]), top)


@kernel
def _shorten_or_leap(walk, target):
    """Go on after no motion was found at the target: with a shorter step, or beyond."""
    step = target - walk.motions.beta[HERE]
    least = _LEAST if walk.motions.kind[HERE] == SLIDES else _LEAST_UNKNOWN
    if walk.pace[_LEAP] > 0.0 or step <= least * target:
        walk.pace[_LEAP] = _LEAPS * target
    else:
        walk.pace[_STEP] = 0.25 * step


@kernel
def _next_step(step, doubt, walk):
    """The step after one of this doubt was accepted."""
    motions = walk.motions
    beta = motions.beta[HERE]
    if motions.kind[HERE] == GROWS:
        return _GROWS * step
    if motions.linked[HERE] != LINKED:
        return AFTER_END * beta
    step *= min(_GROWS, math.sqrt(_AIM / doubt)) if doubt > 0.0 else _GROWS
    if motions.kind[HERE] != SLIDES:
        return min(step, _LARGEST * beta)
    way = way_to_stop(motions, HERE, walk.levels, EQUAL, 1.0)
    return min(step, max(_BEYOND * way, AFTER_END * beta))


@kernel
def _pass(problem, i, search, found, walk, linked):
    """Pass from the motion HERE to NEXT of the same kind, with what lies between; HERE is replaced.

    Parameters
    ----------
    problem, i, search, found : Problem, index of r, Search, Intervals
    walk : Walk
    linked : whether the changes from one to the other are rates
    """
    motions = walk.motions
    if motions.kind[HERE] == SLIDES or motions.kind[HERE] == GROWS:
        change_at_larger_static_friction(problem, i, search, found, walk, HERE, NEXT)
    if linked:
        link(motions, HERE, NEXT)
    copy_neighbour(motions, NEXT, HERE)


@kernel
def _go_on(problem, i, search, found, walk, blind):
    """Pass to the motion NEXT, or shorten the step.

    Parameters
    ----------
    problem, i, search, found : Problem, index of r, Search, Intervals
    walk : Walk
    blind : whether motions between are not found: nothing can be seen of what lies there
    """
    motions, pace = walk.motions, walk.pace
    step = motions.beta[NEXT] - motions.beta[HERE]
    least = _LEAST * motions.beta[NEXT]
    here, there = motions.kind[HERE], motions.kind[NEXT]
    if (here == HAS_STOPS or here == NOT_FOUND) != (there == HAS_STOPS):
        if is_certain(problem, i, search, walk, least) or blind:
            pass_end(problem, i, search, found, walk)
            pace[_STEP], pace[_WALL] = AFTER_END * motions.beta[HERE], math.inf
        else:
            pace[_STEP] = 0.5 * step
        return
    doubt = 0.0
    if not blind and here != GROWS:
        doubt = doubt_between(walk.workspace.row, motions, HERE, NEXT, False)
    if doubt <= 1.0 or step <= least:
        _pass(problem, i, search, found, walk, doubt <= 1.0 and not blind and here != GROWS)
        pace[_STEP] = _next_step(step, doubt, walk)
    elif doubt == math.inf:
        pace[_WALL] = motions.beta[NEXT]
    else:
        pace[_STEP] = step * max(_SHRINKS, math.sqrt(_AIM / doubt))


@kernel
def _all_ended(found, walk):
    """Whether the wanted number of intervals has ended for every mu."""
    ended = True
    for m in range(walk.ended.size):
        ended = ended and walk.ended[m] == found.begins.shape[2]
    return ended


@kernel
def _walk_up(problem, i, search, found, walk):
    """Find the intervals at r[i].

    Parameters
    ----------
    problem, i, search, found : Problem, index of r, Search, Intervals
    walk : Walk
    """
    motions = walk.motions
    _begin(problem, i, search, found, walk)
    top = search.top[i]
    while motions.settled[HERE] == 0 and motions.beta[HERE] < top and not _all_ended(found, walk):
        target = _target(walk, top)
        if target == top and search.sticks[i]:
            keep_at_rest(top, motions, NEXT)
        else:
            find_motion(problem, i, search, target, LOOSE, walk, HERE, NEXT)
        if motions.kind[NEXT] != NOT_FOUND:
            blind = walk.pace[_LEAP] > 0.0 or motions.kind[HERE] == NOT_FOUND
            walk.pace[_LEAP] = 0.0
            _go_on(problem, i, search, found, walk, blind)
        elif target < top:
            _shorten_or_leap(walk, target)
        else:
            break
    for m in range(walk.ended.size):
        if walk.open[m] != 0:
            found.ends[m, i, walk.ended[m]] = math.inf


@kernel
def _fill(first, last, problem, search, found, walk, cancel):
    """Fill the intervals; see `fill_no_stop`.

    Parameters
    ----------
    first, last, problem, search, found, walk, cancel : see `fill_no_stop`
    """
    for i in range(first, last):
        if cancel[0] != 0:
            return
        if problem.r[i] == 0.0:
            continue
        begin_row(problem, i, walk.workspace)
        allow_factors(walk.workspace.memory, True)
        _walk_up(problem, i, search, found, walk)


@entry
def fill_no_stop(first, last, problem, search, found, walk, cancel):
    """Fill the intervals of beta in which no contact stops, at the frequencies first..last-1.

    Parameters
    ----------
    first, last : range of r
    problem, search : Problem, Search, lent
    found : Intervals, filled, lent
    walk : Walk, lent; its content does not matter
    cancel : (1,) set by another thread to end the computation
    """
    _fill(first, last, problem, search, found, walk, cancel)

"""Ends of intervals of friction without stops, located and stored."""

import math
from typing import NamedTuple

import numpy as np

from ...regimes import COINCIDENCE, INSIDE, TURN
from ..compiler import kernel, late_kernel
from .events import CONTACT, LENGTH, STOPS_LISTED
from .neighbours import (
    AT_END,
    GROWS,
    HAS_STOPS,
    NOT_FOUND,
    SLIDES,
    SLOWING,
    TURNING,
    UNLINKED,
    copy_neighbour,
    doubt_between,
    level_doubt,
    link,
    way_to_stop,
)
from .reach import (
    EQUAL,
    FIRST_STOPPED,
    HERE,
    INSIDE_END,
    LAST_SLIDING,
    NEXT,
    OUTSIDE_END,
    PART,
    PART_END,
    TRIAL,
    find_motion,
    margin,
    set_levels,
)

#: Places in `Walk.aim`: predicted end; its error; distance of both sides at the last check, and trials since;
#: where no motion was found.
_GUESS, _ERROR, _WIDTH, _TRIES, _UNKNOWN = 0, 1, 2, 3, 4

#: Trials around an end at most: halving to rounding takes 60.
_TRIALS = 160

#: Error of the predicted end: share of its distance from the last motion inside at first, then of the last
#: change of the prediction; and the factor by which it grows where a trial contradicts it.  The prediction,
#: linear in the last two motions, converges faster than linearly: a twentieth is a cautious share.
_OFF, _WORSE = 0.05, 4.0

#: If the interval has not been halved after this number of trials, it is: the margin does not go to zero.
_CHECKED = 3

#: Distance of both sides in the end, over beta, some units of rounding of a margin; and over a step of the
#: search, where it is seen whether the end is the only one.
RESOLVED, _COARSE = 1e-14, 0.02

#: Parts of a step for mu = 1 that is too long for a larger static friction: the doubt falls with their
#: square.
_PARTS = 4

#: Margin at an end that is zero there: trials leave some 1e-12, and margins at jumps are larger by far.
_NO_MARGIN = 1e-5


class Intervals(NamedTuple):
    """Intervals of friction without stops, (n_mu, n_r, ...)."""

    begins: np.ndarray  # (n_mu, n_r, intervals) NaN where there are fewer
    ends: np.ndarray
    kind: np.ndarray  # int: what ends the first interval, if it begins at 0
    contact: np.ndarray  # int: the contact that stops there, counted from 1


@kernel
def _next_trial(search, m, walk, resolved):
    """Friction ratio of the next trial: on this side or the other of where the end should be, or in the
    middle.

    Parameters
    ----------
    search, m : Search, row of mu
    walk : Walk
    resolved : see `close_in`
    """
    motions, aim = walk.motions, walk.aim
    inside, outside = motions.beta[INSIDE_END], motions.beta[OUTSIDE_END]
    if aim[_UNKNOWN] == aim[_UNKNOWN]:  # nearer to the last motion the next one is found
        return 0.5 * (inside + aim[_UNKNOWN])
    sense = 1.0 if outside > inside else -1.0
    if m != EQUAL:
        set_levels(search, inside, walk)
    guess = inside + sense * way_to_stop(motions, INSIDE_END, walk.levels, m, sense)
    ahead = abs(guess - inside)
    if aim[_GUESS] != aim[_GUESS]:
        aim[_ERROR] = _OFF * ahead
    elif guess != aim[_GUESS]:
        aim[_ERROR] = _OFF * abs(guess - aim[_GUESS])
    aim[_GUESS] = guess
    error = max(aim[_ERROR], 0.25 * resolved * outside)
    beta = guess + sense * error if ahead <= 3.0 * error else guess - sense * error
    aim[_TRIES] += 1.0
    if aim[_TRIES] == _CHECKED:
        if abs(outside - inside) > 0.5 * aim[_WIDTH]:
            beta = math.nan
        aim[_TRIES], aim[_WIDTH] = 0.0, abs(outside - inside)
    return beta if min(inside, outside) < beta < max(inside, outside) else 0.5 * (inside + outside)


@kernel
def close_in(problem, i, search, m, walk, resolved):
    """Close in on the end of an interval between the motions INSIDE_END and OUTSIDE_END, which are replaced.

    Where a margin goes to zero at the end, trials on both sides of where it should be zero close in on it.
    Where it jumps, the interval is halved.

    Parameters
    ----------
    problem, i : Problem, index of r
    search, m : Search, row of mu
    walk : Walk
    resolved : distance of both in the end, over beta
    """
    motions, aim = walk.motions, walk.aim
    aim[_GUESS] = aim[_ERROR] = aim[_UNKNOWN] = math.nan
    aim[_WIDTH], aim[_TRIES] = math.inf, 0.0
    for _ in range(_TRIALS):
        inside, outside = motions.beta[INSIDE_END], motions.beta[OUTSIDE_END]
        if abs(outside - inside) <= resolved * outside:
            break
        beta = _next_trial(search, m, walk, resolved)
        find_motion(problem, i, search, beta, search.tolerance, walk, INSIDE_END, TRIAL)
        missed = motions.kind[TRIAL]
        if (missed == NOT_FOUND or missed == GROWS) and motions.kind[OUTSIDE_END] == HAS_STOPS:
            find_motion(problem, i, search, beta, search.tolerance, walk, OUTSIDE_END, TRIAL)
            if motions.kind[TRIAL] == NOT_FOUND:
                motions.kind[TRIAL] = missed
        aim[_UNKNOWN] = math.nan
        if motions.kind[TRIAL] == NOT_FOUND and abs(beta - inside) > resolved * outside:
            aim[_UNKNOWN] = beta
        elif margin(search, m, walk, TRIAL) > 0.0:
            link(motions, INSIDE_END, TRIAL)
            copy_neighbour(motions, TRIAL, INSIDE_END)
        else:
            aim[_ERROR] *= _WORSE
            copy_neighbour(motions, TRIAL, OUTSIDE_END)


@kernel
def put_between(walk, a, b):
    """Take the motions a without stops and b with stops as those on both sides of an end."""
    copy_neighbour(walk.motions, a, INSIDE_END)
    copy_neighbour(walk.motions, b, OUTSIDE_END)
    if walk.motions.beta[a] > walk.motions.beta[b]:
        walk.motions.linked[INSIDE_END] = UNLINKED  # its rates are those on the other side


@kernel
def _nearest_turn(motions, levels, m, a):
    """The contact with a turn nearest to a stop in motion a."""
    worst = 0
    for j in range(levels.shape[1]):
        if (
            motions.margins[a, TURNING, j] * levels[m, worst]
            > motions.margins[a, TURNING, worst] * levels[m, j]
        ):
            worst = j
    return worst


@kernel
def _slowest(motions, a):
    """The contact with the slowest minimum inside a slide in motion a."""
    worst = 0
    for j in range(motions.senses.shape[1]):
        if motions.margins[a, SLOWING, j] < motions.margins[a, SLOWING, worst]:
            worst = j
    return worst


@kernel
def _cause_of_end(search, m, walk, a, b):
    """Cause of the end of an interval without stops, and the contact, from the motions a and b beside it."""
    motions = walk.motions
    turning, slowing = _nearest_turn(motions, walk.levels, m, a), _slowest(motions, a)
    if motions.kind[a] == SLIDES and margin(search, m, walk, a) <= _NO_MARGIN:
        return TURN, turning + 1
    if motions.kind[a] == SLIDES and motions.margins[a, SLOWING, slowing] <= _NO_MARGIN:
        return INSIDE, slowing + 1
    first = _nearest_turn(motions, walk.levels, m, b)
    longest = 0.0
    if motions.kind[b] == HAS_STOPS:
        for k in range(min(motions.counts[b, STOPS_LISTED], motions.stops.shape[1])):
            if motions.stops[b, k, LENGTH] > longest:
                longest, first = motions.stops[b, k, LENGTH], int(motions.stops[b, k, CONTACT])
    return COINCIDENCE, first + 1


@kernel
def open_interval(found, i, m, beta, walk):
    """Begin an interval at beta."""
    if walk.ended[m] < found.begins.shape[2]:
        found.begins[m, i, walk.ended[m]] = beta
        walk.open[m] = 1


@kernel
def _close_interval(search, found, i, m, walk, a, b):
    """End an interval between the motions a and b.

    Parameters
    ----------
    search, found : Search, Intervals
    i, m : indices of r and mu
    walk : Walk
    a, b : places of motions
    """
    k = walk.ended[m]
    if walk.open[m] == 0:
        return
    found.ends[m, i, k] = walk.motions.beta[a]
    if k == 0 and found.begins[m, i, 0] == 0.0:
        set_levels(search, walk.motions.beta[a], walk)
        found.kind[m, i], found.contact[m, i] = _cause_of_end(search, m, walk, a, b)
    walk.ended[m], walk.open[m] = k + 1, 0


@kernel
def _change_between(problem, i, search, m, found, walk, a, b):
    """Begin or end an interval for a row of mu if it does so between the motions a and b without stops for mu
    = 1.

    Parameters
    ----------
    problem, i : Problem, index of r
    search, m, found : Search, row of mu, Intervals
    walk : Walk
    a, b : places of motions
    """
    before, here = margin(search, m, walk, a) > 0.0, margin(search, m, walk, b) > 0.0
    if before and not here:
        put_between(walk, a, b)
        close_in(problem, i, search, m, walk, RESOLVED)
        _close_interval(search, found, i, m, walk, INSIDE_END, OUTSIDE_END)
    elif here and not before:
        put_between(walk, b, a)
        close_in(problem, i, search, m, walk, RESOLVED)
        open_interval(found, i, m, walk.motions.beta[INSIDE_END], walk)


@late_kernel(None)
def change_at_larger_static_friction(problem, i, search, found, walk, a, b):
    """Begin or end intervals of larger static friction between the motions a and b, which both have no stops.

    Steps are those for mu = 1, so that no row of mu changes another. Where they are long for a row, parts of
    them are looked at.

    Parameters
    ----------
    problem, i, search, found : Problem, index of r, Search, Intervals
    walk : Walk
    a, b : places of motions
    """
    motions = walk.motions
    for m in range(search.static.shape[0]):
        set_levels(search, motions.beta[b], walk)
        parts = 1
        if motions.kind[a] == SLIDES and level_doubt(motions, a, b, walk.levels, m) > 1.0:
            parts = _PARTS
        copy_neighbour(motions, a, PART)
        step = (motions.beta[b] - motions.beta[a]) / parts
        for k in range(1, parts + 1):
            if k < parts:
                beta = motions.beta[a] + k * step
                find_motion(problem, i, search, beta, search.tolerance, walk, PART, PART_END)
                if motions.kind[PART_END] != SLIDES:
                    continue
            else:
                copy_neighbour(motions, b, PART_END)
            _change_between(problem, i, search, m, found, walk, PART, PART_END)
            copy_neighbour(motions, PART_END, PART)


@kernel
def is_certain(problem, i, search, walk, least):
    """Whether the end of an interval is the only one between the motions HERE and NEXT, so far as can be
    seen.

    Parameters
    ----------
    problem, i, search : Problem, index of r, Search
    walk : Walk; INSIDE_END and OUTSIDE_END are replaced by motions around the end
    least : change of beta that is as good as none
    """
    motions = walk.motions
    slid = margin(search, EQUAL, walk, HERE) > 0.0
    if slid:
        put_between(walk, HERE, NEXT)
    else:
        put_between(walk, NEXT, HERE)
    step = motions.beta[NEXT] - motions.beta[HERE]
    close_in(problem, i, search, EQUAL, walk, _COARSE * step / motions.beta[NEXT])
    like = INSIDE_END if slid else OUTSIDE_END
    if step <= least or motions.kind[HERE] == NOT_FOUND or motions.kind[like] != motions.kind[HERE]:
        return True
    return doubt_between(walk.workspace.row, motions, HERE, like, True) <= 1.0


@kernel
def pass_end(problem, i, search, found, walk):
    """Pass from the motion HERE to the other side of the end of an interval for mu = 1, which lies between
    INSIDE_END and OUTSIDE_END; HERE is replaced.

    Parameters
    ----------
    problem, i, search, found : Problem, index of r, Search, Intervals
    walk : Walk
    """
    motions = walk.motions
    slid = margin(search, EQUAL, walk, HERE) > 0.0
    close_in(problem, i, search, EQUAL, walk, RESOLVED)
    copy_neighbour(motions, INSIDE_END, LAST_SLIDING)
    copy_neighbour(motions, OUTSIDE_END, FIRST_STOPPED)
    if slid:
        change_at_larger_static_friction(problem, i, search, found, walk, HERE, LAST_SLIDING)
        for m in range(search.static.shape[0]):
            _close_interval(search, found, i, m, walk, LAST_SLIDING, FIRST_STOPPED)
        copy_neighbour(motions, FIRST_STOPPED, HERE)
    else:
        copy_neighbour(motions, LAST_SLIDING, HERE)
        for m in range(search.static.shape[0]):
            if margin(search, m, walk, HERE) > 0.0:
                open_interval(found, i, m, motions.beta[HERE], walk)
    motions.linked[HERE] = AT_END

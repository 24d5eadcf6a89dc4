"""The steady state for mu = 1 at a friction ratio, from one next to it.

Newton's method solves for it.  Only where that fails beside a motion with stops, the motion is followed.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..structure.newton import solve_linear
from .counts import STUCK
from .events import clear_events, close_lists
from .follow import FOLLOWED
from .laws.kinds import state_size
from .neighbours import (
    GROWS,
    HAS_STOPS,
    NOT_FOUND,
    SLIDES,
    TURNING,
    UNLINKED,
    Motions,
    begin_from,
    copy_neighbour,
    keep_neighbour,
    make_motions,
)
from .orbits import MEASURED, REPEATS, newton
from .problem import SECTION, H, P
from .record import EVENTS, NOTHING, Record, make_list
from .return_map import (
    base_halves,
    fill_newton,
    forget_factors,
    from_rest,
    go_round,
    keeps_factors,
    motion_size,
    return_distance,
    take_step,
)
from .row import set_channels
from .series import Friction
from .steady import Workspace, find, make_workspace

#: Places of motions: the last one accepted and the next one; on both sides of an end, and the last trial
#: there; on both sides of an end for mu = 1; on both sides of a part of a step.
HERE, NEXT, INSIDE_END, OUTSIDE_END, TRIAL, LAST_SLIDING, FIRST_STOPPED, PART, PART_END = range(9)
_PLACES = 9

#: The row of mu that stands for mu = 1.
EQUAL = -1

#: Steps of Newton's method in which a turn may pass the section: from one motion to the next few turns are so
#: near.
_MOST_PASSED = 4

#: Part of the time for which a contact stops at least if the motion, followed for long, counts as one with
#: stops though it has not settled: a motion that goes to one without stops has short ones by then.
_LONG = 0.25

#: Least rise of friction that is there at beta = 0, over all of it: Newton's method leads farther, as a rule
#: at once.
_LEAST_RISE = 1e-6

#: First friction ratio over the scale, at which friction changes the motion without it by less than margins
#: are solved for; and the least one where the first interval is known: further ones have some friction.
LOWEST = 1e-10
_LOWEST_AFTER = 1e-4

#: First motions that are tried, each with ten times as much friction: where a harmonic of friction meets an
#: undamped resonance there is no steady state near the motion without friction.
_BEGINNINGS = 9

#: Tolerance of Newton's method away from ends: margins are then off by its square at most.
LOOSE = 1e-7

#: First step after an end, over beta: few things change so fast, and the next steps grow.
AFTER_END = 1e-3


class Search(NamedTuple):
    """Friction over beta, as in `fill.Grid`, and where to search."""

    kinetic: np.ndarray  # (N, 2)
    static: np.ndarray  # (n_mu, N, 2)
    scale: np.ndarray  # (n_r,) size of beta at which friction matters
    top: np.ndarray  # (n_r,) largest beta that is tried
    sticks: np.ndarray  # (n_r,) bool: whether all contacts stick permanently at `top`: motions there creep
    known: np.ndarray  # (n_r,) where the first interval for mu = 1 is known to end, and filled; NaN: unknown
    tallest: np.ndarray  # (n_r,) largest motion that may be a steady state
    grows: np.ndarray  # (n_r,) bool: whether the motion without friction grows without bound
    starts: np.ndarray  # (n_r, 2, m) modes and velocities at tau = 0 without friction; of rest where it grows
    cycles: float
    tolerance: float


class Walk(NamedTuple):
    """The memory of a search at one r."""

    workspace: Workspace
    listing: Record
    friction: Friction
    motions: Motions
    share: np.ndarray  # (1,) part of the friction at beta = 0 that acts
    levels: np.ndarray  # (n_mu, N) kinetic over static friction
    pace: np.ndarray  # see `no_stop`
    aim: np.ndarray  # see `ends`
    ended: np.ndarray  # (n_mu,) int: intervals that have ended
    open: np.ndarray  # (n_mu,) int: whether one has begun


@entry
def make_walk(problem, rows):
    """Allocate the memory of a search with `rows` values of mu."""
    contacts = problem.spring.size
    return Walk(
        make_workspace(problem, np.empty((0, problem.squares.size)), 0), make_list(problem),
        Friction(np.empty(contacts), np.empty(contacts)), make_motions(problem, _PLACES), np.ones(1),
        np.empty((rows, contacts)), np.zeros(3), np.zeros(5), np.zeros(rows, np.int64),
        np.zeros(rows, np.int64),
    )  # fmt: skip


@kernel
def set_levels(search, beta, walk):
    """Fill the kinetic over the static friction at beta; 1 in contacts without friction."""
    for m in range(search.static.shape[0]):
        for j in range(search.kinetic.shape[0]):
            kinetic = search.kinetic[j, 0] * beta + search.kinetic[j, 1]
            static = search.static[m, j, 0] * beta + search.static[m, j, 1]
            walk.levels[m, j] = kinetic / static if static > 0.0 else 1.0


@kernel
def margin(search, m, walk, a):
    """Distance from a stop at a turn in motion a for a row of mu, > 0 where no contact stops."""
    motions = walk.motions
    if motions.kind[a] == GROWS:
        return 1.0
    if motions.kind[a] != SLIDES:
        return -1.0
    worst = 0.0
    if m != EQUAL:
        set_levels(search, motions.beta[a], walk)
    for j in range(search.kinetic.shape[0]):
        level = 1.0 if m == EQUAL else walk.levels[m, j]
        worst = max(worst, motions.margins[a, TURNING, j] / level)
    return 1.0 - worst


@kernel
def _set_friction(search, beta, walk):
    """Friction of every contact at beta, for mu = 1."""
    for j in range(search.kinetic.shape[0]):
        force = search.kinetic[j, 0] * beta + walk.share[0] * search.kinetic[j, 1]
        walk.friction.kinetic[j] = walk.friction.static[j] = force


@kernel
def _list_motion(problem, search, beta, walk, tolerance, a):
    """Follow the motion in memory once more and keep it as motion a; False if that is not possible."""
    row, motion, memory = walk.workspace.row, walk.workspace.motion, walk.workspace.memory
    halves = base_halves(problem)
    for repeat in range(2):
        clear_events(walk.listing.events)
        walk.listing.active[0] = EVENTS
        code = go_round(problem, row, walk.friction, halves, motion, memory, walk.listing, False)
        walk.listing.active[0] = NOTHING
        if code != FOLLOWED:
            return False
        if repeat > 0 or return_distance(problem, row, memory) <= max(MEASURED, tolerance):
            break
        newton(problem, row, walk.friction, halves, MEASURED, motion, memory, walk.workspace.record)
    close_lists(walk.listing.events)
    keep_neighbour(problem, search.kinetic, beta, memory, walk.listing.events, walk.motions, a)
    return True


@kernel
def _set_senses(problem, walk):
    """Set the senses of sliding contacts in memory to those of their velocities: from one motion to the next
    a turn may pass the section.
    """
    row, motion, memory = walk.workspace.row, walk.workspace.motion, walk.workspace.memory
    modes, channels = problem.push.shape
    motion.clock[0] = math.nan
    set_channels(problem, row, SECTION, 0, motion)
    for j in range(memory.senses.size):
        w = -row.numbers[H] * problem.belt[j]
        for m in range(modes):
            w += problem.chi[j, m] * memory.start[P, m]
        for d in range(channels):
            w -= problem.base[j, d] * motion.series[modes + d, 1]
        if memory.senses[j] != 0 and w != 0.0:
            memory.senses[j] = 1 if w > 0.0 else -1


@kernel
def _turned_at_section(memory):
    """Whether contacts that slide, and these alone, have another sense after the return."""
    turned = False
    for j in range(memory.senses.size):
        if memory.senses[j] != memory.end_senses[j]:
            if memory.senses[j] == 0 or memory.end_senses[j] == 0:
                return False
            turned = True
    return turned


@kernel
def _solve(problem, tolerance, walk):
    """Find the steady state from the state in memory by Newton's method; whether it is found.

    Where a turn is so near to the section that it passes it in a step of Newton's method, the step is taken
    all the same, and the sense follows.
    """
    workspace = walk.workspace
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    halves = base_halves(problem)
    for _ in range(_MOST_PASSED):
        _set_senses(problem, walk)
        status, _ = newton(problem, row, walk.friction, halves, tolerance, motion, memory, workspace.record)
        if status == REPEATS or not _turned_at_section(memory):
            break
        if keeps_factors(memory):  # the last way may have been without derivatives
            go_round(problem, row, walk.friction, halves, motion, memory, workspace.record, True)
        fill_newton(problem, row, halves, motion, memory)
        if not solve_linear(memory.matrix, memory.right, state_size(problem)):
            break
        take_step(problem, row, memory)
    return status == REPEATS


@kernel
def _begin_motion(problem, i, search, beta, walk, a):
    """Put the motion at beta in memory that motion a points to; without one, the motion without friction."""
    workspace = walk.workspace
    if walk.motions.kind[a] == SLIDES or walk.motions.kind[a] == HAS_STOPS:
        begin_from(walk.motions, a, beta, workspace.memory)
    else:
        motion, memory, state = workspace.motion, workspace.memory, search.starts[i]
        from_rest(problem, workspace.row, walk.friction, state, motion, memory, workspace.record, NOTHING)


@kernel
def _find(problem, i, search, beta, tolerance, walk, a):
    """Find the steady state at beta from motion a; whether it is found, in memory.

    Beside a motion without stops a shorter step leads to the next one sooner than following the motion does.

    Parameters
    ----------
    problem, i, search : Problem, index of r, Search
    beta : friction ratio
    tolerance : of Newton's method, see `find`
    walk : Walk
    a : place of a motion
    """
    workspace, motions = walk.workspace, walk.motions
    _begin_motion(problem, i, search, beta, walk, a)
    found = _solve(problem, tolerance, walk)
    if not found and motions.kind[a] != SLIDES:
        _begin_motion(problem, i, search, motions.beta[a], walk, a)
        followed = find(problem, walk.friction, search.cycles, search.tolerance, workspace)
        found = followed.status == REPEATS
    # a larger motion hardly differs from one period to the next, but is no steady state
    return found and motion_size(problem, workspace.row, workspace.memory) <= search.tallest[i]


@kernel
def keep_unknown(beta, walk, a, b):
    """Keep as motion b, after motion a, that no steady state was found at beta.

    If there is none without friction, neither may there be one with little: the motion grows for ever.
    """
    motions = walk.motions
    motions.kind[b] = GROWS if motions.kind[a] == GROWS else NOT_FOUND
    motions.beta[b] = beta
    motions.linked[b], motions.settled[b] = UNLINKED, 0


@kernel
def find_motion(problem, i, search, beta, tolerance, walk, a, b):
    """Find the motion at beta from motion a, and keep it as motion b.

    A contact that creeps has long stops long before it has settled: such a motion is kept as it is.

    Parameters
    ----------
    problem, i, search : Problem, index of r, Search
    beta : friction ratio
    tolerance : of Newton's method, see `find`
    walk : Walk
    a, b : places of motions
    """
    motions = walk.motions
    forget_factors(walk.workspace.memory)  # no other search changes it
    _set_friction(search, beta, walk)
    if _find(problem, i, search, beta, tolerance, walk, a):
        if _list_motion(problem, search, beta, walk, tolerance, b):
            return
    elif motions.kind[a] == HAS_STOPS and _list_motion(problem, search, beta, walk, math.inf, b):
        for j in range(motions.senses.shape[1]):
            if walk.workspace.memory.counts[STUCK, j] > _LONG * motions.window[0]:
                motions.settled[b] = 0
                return
    keep_unknown(beta, walk, a, b)


@kernel
def _raise_own_friction(problem, i, search, beta, walk):
    """Raise the friction that is there at beta = 0 step by step: the motion without it may be far from that
    with it.

    Parameters
    ----------
    problem, i, search : Problem, index of r, Search
    beta : friction ratio
    walk : Walk; HERE is the motion without that friction, and is replaced
    """
    motions = walk.motions
    rise = 1.0
    while walk.share[0] < 1.0 and motions.kind[HERE] != NOT_FOUND and rise > _LEAST_RISE:
        share = walk.share[0]
        walk.share[0] = min(share + rise, 1.0)
        find_motion(problem, i, search, beta, LOOSE, walk, HERE, NEXT)
        if motions.kind[NEXT] == NOT_FOUND:
            walk.share[0] = share
            rise *= 0.25
        else:
            copy_neighbour(motions, NEXT, HERE)
            rise *= 2.0
    if walk.share[0] < 1.0:
        walk.share[0] = 1.0
        motions.kind[HERE] = NOT_FOUND
        find_motion(problem, i, search, beta, LOOSE, walk, HERE, HERE)


@kernel
def find_first_motion(problem, i, search, walk):
    """Find the first motion, HERE: next to beta = 0, or next to the known end of the first interval."""
    motions = walk.motions
    beta = LOWEST * search.scale[i]
    if search.known[i] == search.known[i]:
        beta = max(_LOWEST_AFTER * search.scale[i], (1.0 + AFTER_END) * search.known[i])
    for _ in range(_BEGINNINGS):
        motions.kind[HERE] = GROWS if search.grows[i] else NOT_FOUND
        walk.share[0] = 0.0
        find_motion(problem, i, search, beta, LOOSE, walk, HERE, HERE)
        _raise_own_friction(problem, i, search, beta, walk)
        if motions.kind[HERE] != NOT_FOUND:
            break
        beta *= 10.0

"""Steady states next to each other in friction, and whether anything unseen can lie between them.

A quantity that is smooth in beta, such as the phase of a turn or the length of a stop, is extrapolated from
the last two motions to the next one.  What it is off by there is more than four times as large as the
distance of its course between two motions from a straight line.  Where that is less than half of the quantity
itself, it does not vanish between the two.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from .counts import MOVED, NEAREST_STOP, STOPS
from .events import CONTACT, DOWN, FASTEST, LENGTH, MOST, SLOWEST, STOPS_LISTED, TIME, TURNS_LISTED, UP
from .problem import padded, varies

#: Kinds of motion: no contact stops; some do; it grows without bound, so that no contact stops; not found.
SLIDES, HAS_STOPS, GROWS, NOT_FOUND = 0, 1, 2, 3

#: Rates of a motion, its changes per beta: not known; those from the motion before; not known, next to an
#: end, where margins or stops begin with zero.
UNLINKED, LINKED, AT_END = 0, 1, 2

#: Rows of `margins` of a motion: largest share of its friction that the force holding a contact at a turn
#: has, inverted (1 at a stop); least speed inside a slide over the largest (0 at a stop), infinite without a
#: minimum.
TURNING, SLOWING = 0, 1

#: Columns of `turns` and `stops` after those of `events`: change per beta, NaN where it is not known.
_TURN_RATE, _STOP_RATE = 2, 3

#: Largest change of the phase of a turn from one motion to the next [rad].
_FARTHEST = 0.3

#: Turns nearer to each other than this are at the same time: those of symmetric contacts differ by rounding.
_TOGETHER = 1e-9

#: Mobility between two contacts that is rounding error, over that of their own.
_NO_MOBILITY = 1e-12

#: A minimum of the speed inside a slide may appear or vanish from one motion to the next only above this
#: share of the largest speed.
_HIGH_MINIMUM = 0.05


class Motions(NamedTuple):
    """Some steady states with N contacts; the first index is that of the motion."""

    beta: np.ndarray
    kind: np.ndarray  # int
    states: np.ndarray  # (..., 3, W) at the section
    senses: np.ndarray  # (..., N) int
    counts: np.ndarray  # (..., 2) int, see `Events`
    turns: np.ndarray  # (..., MOST, 3) see `Events`, and change per beta
    stops: np.ndarray  # (..., MOST, 4) see `Events`, and change per beta
    margins: np.ndarray  # (..., 2, N)
    rates: np.ndarray  # (..., 2, N) of the margins per beta
    state_rates: np.ndarray  # (..., 3, W)
    linked: np.ndarray  # (...) int: UNLINKED, LINKED or AT_END
    settled: np.ndarray  # (...) int: whether the motion is the same for any larger beta
    window: np.ndarray  # (1,) time covered: a period, or half of one
    partner: np.ndarray  # (MOST,) int: scratch


@entry
def make_motions(problem, count):
    """Allocate `count` motions."""
    contacts, modes = problem.chi.shape
    width = padded(max(modes, contacts))
    return Motions(
        np.zeros(count), np.zeros(count, np.int64), np.zeros((count, 3, width)),
        np.zeros((count, contacts), np.int64), np.zeros((count, 2), np.int64), np.zeros((count, MOST, 3)),
        np.zeros((count, MOST, 4)), np.zeros((count, 2, contacts)), np.zeros((count, 2, contacts)),
        np.zeros((count, 3, width)), np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros(1),
        np.zeros(MOST, np.int64),
    )  # fmt: skip


@kernel
def clear_motions(motions):
    """Forget all motions."""
    motions.window[0] = 0.0
    for a in range(motions.beta.size):
        motions.beta[a] = 0.0
        motions.kind[a] = motions.linked[a] = motions.settled[a] = 0
        for which in range(2):
            motions.counts[a, which] = 0
            for j in range(motions.senses.shape[1]):
                motions.margins[a, which, j] = motions.rates[a, which, j] = 0.0
        for j in range(motions.senses.shape[1]):
            motions.senses[a, j] = 0
        for part in range(3):
            for i in range(motions.states.shape[2]):
                motions.states[a, part, i] = motions.state_rates[a, part, i] = 0.0


@kernel
def _listed(motions, a, which):
    """Turns or stops of motion a that are listed: all, or none where there are too many."""
    count = motions.counts[a, which]
    return count if count <= motions.partner.size else 0


@kernel
def copy_neighbour(motions, a, b):
    """Copy motion a to b."""
    motions.beta[b], motions.kind[b] = motions.beta[a], motions.kind[a]
    motions.linked[b], motions.settled[b] = motions.linked[a], motions.settled[a]
    for part in range(3):
        for i in range(motions.states.shape[2]):
            motions.states[b, part, i] = motions.states[a, part, i]
            motions.state_rates[b, part, i] = motions.state_rates[a, part, i]
    for part in range(2):
        motions.counts[b, part] = motions.counts[a, part]
        for j in range(motions.senses.shape[1]):
            motions.margins[b, part, j] = motions.margins[a, part, j]
            motions.rates[b, part, j] = motions.rates[a, part, j]
    for j in range(motions.senses.shape[1]):
        motions.senses[b, j] = motions.senses[a, j]
    for k in range(_listed(motions, a, TURNS_LISTED)):
        for part in range(motions.turns.shape[2]):
            motions.turns[b, k, part] = motions.turns[a, k, part]
    for k in range(_listed(motions, a, STOPS_LISTED)):
        for part in range(motions.stops.shape[2]):
            motions.stops[b, k, part] = motions.stops[a, k, part]


@kernel
def _stays_on_one_side(problem, events, j):
    """Whether a contact on a belt slides one way only, under a constant normal load: its friction is then a
    constant pull, up to what it is in stops.
    """
    if problem.belt[j] == 0.0 or (events.last[UP, j] != 0.0 and events.last[DOWN, j] != 0.0):
        return False
    return not varies(problem, j)


@kernel
def keep_neighbour(problem, kinetic, beta, memory, events, motions, a):
    """Keep the motion in memory as motion a.

    Parameters
    ----------
    problem : Problem
    kinetic : (N, 2) friction, slope over beta and value at 0
    beta : friction ratio
    memory : Return, after a way with `events`
    events : Events, closed
    motions, a : Motions, and the place in them
    """
    motions.beta[a], motions.kind[a] = beta, SLIDES
    motions.linked[a], motions.settled[a] = UNLINKED, 1
    motions.window[0] = events.clock[0]
    for part in range(3):
        for i in range(motions.states.shape[2]):
            motions.states[a, part, i] = memory.start[part, i]
    for j in range(memory.senses.size):
        motions.senses[a, j] = memory.senses[j]
        rests = memory.counts[MOVED, j] == 0.0
        if rests or memory.counts[STOPS, j] > 0.0:
            motions.kind[a] = HAS_STOPS
        if kinetic[j, 0] > 0.0 and not rests and not _stays_on_one_side(problem, events, j):
            motions.settled[a] = 0
        motions.margins[a, TURNING, j] = memory.counts[NEAREST_STOP, j]
        fastest = events.speeds[FASTEST, j]
        motions.margins[a, SLOWING, j] = events.speeds[SLOWEST, j] / fastest if fastest > 0.0 else math.inf
        motions.rates[a, TURNING, j] = motions.rates[a, SLOWING, j] = math.nan
    for which in range(2):
        motions.counts[a, which] = events.counts[which]
    for k in range(_listed(motions, a, TURNS_LISTED)):
        motions.turns[a, k, CONTACT], motions.turns[a, k, TIME] = (
            events.turns[k, CONTACT],
            events.turns[k, TIME],
        )
        motions.turns[a, k, _TURN_RATE] = math.nan
    for k in range(_listed(motions, a, STOPS_LISTED)):
        for part in range(_STOP_RATE):
            motions.stops[a, k, part] = events.stops[k, part]
        motions.stops[a, k, _STOP_RATE] = math.nan


@kernel
def keep_at_rest(beta, motions, a):
    """Keep as motion a that all contacts rest."""
    motions.beta[a], motions.kind[a] = beta, HAS_STOPS
    motions.linked[a], motions.settled[a] = UNLINKED, 1
    motions.counts[a, TURNS_LISTED] = 0
    motions.counts[a, STOPS_LISTED] = motions.senses.shape[1]
    for j in range(motions.senses.shape[1]):
        motions.stops[a, j, CONTACT], motions.stops[a, j, TIME] = j, 0.0
        motions.stops[a, j, LENGTH], motions.stops[a, j, _STOP_RATE] = motions.window[0], math.nan


@kernel
def _apart(motions, later, earlier):
    """Difference of two phases, in the middle of its possible values."""
    whole = motions.window[0]
    return later - earlier - whole * math.floor((later - earlier) / whole + 0.5)


@kernel
def _next_of(motions, a, j, k):
    """The next turn of contact j in motion a after place k; -1 after the last one."""
    for i in range(k + 1, _listed(motions, a, TURNS_LISTED)):
        if motions.turns[a, i, CONTACT] == j:
            return i
    return -1


@kernel
def _count_of(motions, a, j):
    """Number of turns of contact j in motion a."""
    count = 0
    for k in range(_listed(motions, a, TURNS_LISTED)):
        if motions.turns[a, k, CONTACT] == j:
            count += 1
    return count


@kernel
def _pair_turns_of(motions, a, b, j, skip):
    """Pair the turns of contact j in motions a and b, whose first one is b's after `skip` of them.

    Returns
    -------
    float : largest distance of two partners, which are in `partner`
    """
    farthest = 0.0
    other = _next_of(motions, b, j, -1)
    for _ in range(skip):
        other = _next_of(motions, b, j, other)
    k = _next_of(motions, a, j, -1)
    while k >= 0:
        motions.partner[k] = other
        moved = _apart(motions, motions.turns[b, other, TIME], motions.turns[a, k, TIME])
        farthest = max(farthest, abs(moved))
        other = _next_of(motions, b, j, other)
        if other < 0:
            other = _next_of(motions, b, j, -1)
        k = _next_of(motions, a, j, k)
    return farthest


@kernel
def _pair_turns(motions, a, b):
    """Pair the turns of motions a and b; infinite if their numbers differ, else the largest distance.

    From one motion to the next a turn of a contact may pass the section: the pairs are those that are
    nearest. Where not all are listed none is paired.
    """
    if motions.counts[a, TURNS_LISTED] != motions.counts[b, TURNS_LISTED]:
        return math.inf
    farthest = 0.0
    for j in range(motions.senses.shape[1]):
        count = _count_of(motions, a, j)
        if count != _count_of(motions, b, j):
            return math.inf
        if count == 0:
            continue
        best, skip = math.inf, 0
        for tried in (0, 1, count - 1):
            if tried < count:
                moved = _pair_turns_of(motions, a, b, j, tried)
                if moved < best:
                    best, skip = moved, tried
        farthest = max(farthest, _pair_turns_of(motions, a, b, j, skip))
    return farthest


@kernel
def _partner_stop(motions, a, b, k):
    """The stop of motion b that overlaps most with stop k of motion a; -1 if none does."""
    best, found = 0.0, -1
    length = motions.stops[a, k, LENGTH]
    middle = motions.stops[a, k, TIME] + 0.5 * length
    for i in range(_listed(motions, b, STOPS_LISTED)):
        if motions.stops[b, i, CONTACT] == motions.stops[a, k, CONTACT]:
            other = motions.stops[b, i, LENGTH]
            moved = abs(_apart(motions, motions.stops[b, i, TIME] + 0.5 * other, middle))
            overlap = min(length, other, 0.5 * (length + other) - moved)
            if overlap > best:
                best, found = overlap, i
    return found


@kernel
def link(motions, a, b):
    """Find how motion b changes per beta, from motion a before it."""
    step = motions.beta[b] - motions.beta[a]
    motions.linked[b] = LINKED
    same = True
    for j in range(motions.senses.shape[1]):
        same = same and motions.senses[a, j] == motions.senses[b, j]
    for part in range(3):
        for i in range(motions.states.shape[2]):
            change = motions.states[b, part, i] - motions.states[a, part, i]
            motions.state_rates[b, part, i] = change / step if same else 0.0
    for part in range(2):
        for j in range(motions.senses.shape[1]):
            known = math.isfinite(motions.margins[a, part, j]) and math.isfinite(motions.margins[b, part, j])
            change = motions.margins[b, part, j] - motions.margins[a, part, j] if known else math.nan
            motions.rates[b, part, j] = change / step
    if math.isfinite(_pair_turns(motions, a, b)):
        for k in range(_listed(motions, a, TURNS_LISTED)):
            i = motions.partner[k]
            moved = _apart(motions, motions.turns[b, i, TIME], motions.turns[a, k, TIME])
            motions.turns[b, i, _TURN_RATE] = moved / step
    for k in range(_listed(motions, a, STOPS_LISTED)):
        i = _partner_stop(motions, a, b, k)
        if i >= 0:
            change = motions.stops[b, i, LENGTH] - motions.stops[a, k, LENGTH]
            motions.stops[b, i, _STOP_RATE] = change / step


@kernel
def _doubt(before, here, rate, step, ends):
    """Error of an extrapolation over half of the smaller one of two values with the same sign.

    Infinite where the sign changes.

    Parameters
    ----------
    before, here : values of a quantity
    rate, step : its change per beta before, NaN if it is not known, and the change of beta
    ends : whether `here` may be next to an end, where the quantity vanishes: what falls ever faster counts
        beside its value before
    """
    if before == here:
        return 0.0
    if not before * here > 0.0:
        return math.inf
    if rate != rate:
        rate = 0.0
    off = here - before - rate * step
    size = min(abs(before), abs(here))
    if ends and off * before < 0.0:
        size = abs(before)
    return 2.0 * abs(off) / size


@kernel
def _act_on_each_other(row, j, k):
    """Whether a force in one contact accelerates the other; the sum over the modes has rounding errors."""
    return abs(row.mobility[j, k]) > _NO_MOBILITY * math.sqrt(row.mobility[j, j] * row.mobility[k, k])


@kernel
def _order_doubt(row, motions, a, b):
    """Largest doubt that two contacts acting on each other turn in the same order all the way from a to b,
    whose turns are paired; infinite where they do not.
    """
    step = motions.beta[b] - motions.beta[a]
    worst = 0.0
    turns = _listed(motions, a, TURNS_LISTED)
    for k in range(turns):
        for i in range(k):
            one, other = int(motions.turns[a, k, CONTACT]), int(motions.turns[a, i, CONTACT])
            if one == other or not _act_on_each_other(row, one, other):
                continue
            before = _apart(motions, motions.turns[a, k, TIME], motions.turns[a, i, TIME])
            if abs(before) > 4.0 * _FARTHEST:  # partners are too near to pass each other
                continue
            here = _apart(
                motions,
                motions.turns[b, motions.partner[k], TIME],
                motions.turns[b, motions.partner[i], TIME],
            )
            if max(abs(before), abs(here)) > _TOGETHER:
                rate = motions.turns[a, k, _TURN_RATE] - motions.turns[a, i, _TURN_RATE]
                worst = max(worst, _doubt(before, here, rate, step, False))
    return worst


@kernel
def _margins_doubt(motions, a, b, ends):
    """Largest doubt that no contact stops between motions a and b, with as many turns and no stops each."""
    step = motions.beta[b] - motions.beta[a]
    worst = 0.0
    for j in range(motions.senses.shape[1]):
        before, here = motions.margins[a, TURNING, j], motions.margins[b, TURNING, j]
        worst = max(worst, _doubt(1.0 - before, 1.0 - here, -motions.rates[a, TURNING, j], step, ends))
        before, here = motions.margins[a, SLOWING, j], motions.margins[b, SLOWING, j]
        if math.isfinite(before) and math.isfinite(here):
            worst = max(worst, _doubt(before, here, motions.rates[a, SLOWING, j], step, ends))
        elif min(before, here) < _HIGH_MINIMUM:
            worst = math.inf
    return worst


@kernel
def level_doubt(motions, a, b, levels, m):
    """Largest doubt that no turn reaches the level of a stop, for a row of mu, between motions a and b.

    Parameters
    ----------
    motions, a, b : Motions, and places in them
    levels, m : (n_mu, N) kinetic over static friction, a share of the force at a turn, and the row
    """
    step = motions.beta[b] - motions.beta[a]
    worst = 0.0
    for j in range(motions.senses.shape[1]):
        before = levels[m, j] - motions.margins[a, TURNING, j]
        here = levels[m, j] - motions.margins[b, TURNING, j]
        if before * here > 0.0:
            worst = max(worst, _doubt(before, here, -motions.rates[a, TURNING, j], step, False))
    return worst


@kernel
def _stops_doubt(motions, a, b, ends):
    """Doubt that one and the same stop lasts all the way from motion a to b: that of the most certain one.

    A stop that becomes permanent lengthens ever faster, so that twice as much is accepted of it.
    """
    step = motions.beta[b] - motions.beta[a]
    best = math.inf
    for k in range(_listed(motions, a, STOPS_LISTED)):
        i = _partner_stop(motions, a, b, k)
        if i >= 0:
            rate = motions.stops[a, k, _STOP_RATE]
            before, here = motions.stops[a, k, LENGTH], motions.stops[b, i, LENGTH]
            certain = 0.5 if here >= motions.window[0] else 1.0
            best = min(best, certain * _doubt(before, here, rate, step, ends))
    return best


@kernel
def doubt_between(row, motions, a, b, ends):
    """Doubt about what lies between motion a and the next one, b: both without stops, or both with some.

    Parameters
    ----------
    row : Row
    motions, a, b : Motions, and places in them
    ends : whether b is next to a motion of another kind

    Returns
    -------
    float : at most 1 where nothing unseen lies between; it falls with the square of the step; infinite where
        the motions are not alike
    """
    if motions.kind[a] == HAS_STOPS:
        return _stops_doubt(motions, a, b, ends) if motions.linked[a] != AT_END else 0.0
    moved = _pair_turns(motions, a, b)
    if not math.isfinite(moved) or motions.linked[a] == AT_END:
        return moved / _FARTHEST
    doubt = max(_order_doubt(row, motions, a, b), _margins_doubt(motions, a, b, ends))
    return max(doubt, moved / _FARTHEST)


@kernel
def begin_from(motions, a, beta, memory):
    """Begin the motion at beta where motion a points to."""
    step = beta - motions.beta[a] if motions.linked[a] == LINKED else 0.0
    for part in range(3):
        for i in range(motions.states.shape[2]):
            memory.start[part, i] = motions.states[a, part, i] + step * motions.state_rates[a, part, i]
    for j in range(memory.senses.size):
        memory.senses[j] = motions.senses[a, j]


@kernel
def _way_to_zero(left, rate):
    """Change of beta after which a quantity > 0 is zero at its rate, which may be unknown (NaN); infinite if
    never.
    """
    return left / -rate if left > 0.0 and rate < 0.0 else math.inf


@kernel
def way_to_stop(motions, a, levels, m, sense):
    """Change of beta at which the rates of motion a say that a contact begins to stop; infinite without one.

    Parameters
    ----------
    motions, a : Motions, and the place in them
    levels, m : (n_mu, N) kinetic over static friction, and the row that counts; -1: they are equal
    sense : 1.0 if beta is to rise, -1.0 if it is to fall
    """
    nearest = math.inf
    if motions.linked[a] == LINKED:
        for j in range(motions.senses.shape[1]):
            level = levels[m, j] if m >= 0 else 1.0
            left, rate = level - motions.margins[a, TURNING, j], -sense * motions.rates[a, TURNING, j]
            nearest = min(nearest, _way_to_zero(left, rate))
            rate = sense * motions.rates[a, SLOWING, j]
            nearest = min(nearest, _way_to_zero(motions.margins[a, SLOWING, j], rate))
    return nearest

"""Steady sliding, the stick-slip cycle and the cycles without stops of one cell."""

import math
from typing import NamedTuple

import numpy as np

from ... import regimes
from ..compiler import inner_kernel, kernel
from .cycles import (
    MOST_CYCLES,
    MOST_INTERVALS,
    damping_of,
    find_between,
    find_beyond,
    first_to_stop,
    last_to_stop,
)
from .orbit import (
    KNOTS,
    LOWEST,
    MAXIMUM,
    STOP,
    TIME,
    X,
    damping_in,
    factor_at,
    from_release,
    next_maximum,
    release_of,
    segment_above,
    segment_below,
)


class Portraits(NamedTuple):
    """Outputs of cells (mu, belt speed, beta)."""

    regime: np.ndarray  # of the motion that begins where the belt releases the mass
    reachable: np.ndarray  # bits of the regimes of all attracting motions
    status: np.ndarray
    growth: np.ndarray  # of a small vibration about steady sliding, over omega_1
    frequency: np.ndarray  # of it, over omega_1
    period: np.ndarray  # of the cycle, over 1/omega_1
    stops: np.ndarray  # per cycle
    stuck: np.ndarray  # share of the cycle
    highest: np.ndarray  # largest and least displacement of the motion
    lowest: np.ndarray
    multiplier: np.ndarray  # without the 1 along the cycle
    knots: np.ndarray  # crossings of break points per cycle
    threshold: np.ndarray  # maximum of the least unstable cycle; NaN if there is none


@inner_kernel
def _half_turn(delta):
    """Frequency and time of half a turn; 0 and infinity where there is none."""
    square = 1.0 - delta * delta
    w = math.sqrt(square) if square > 0.0 else 0.0
    return w, math.pi / w if w > 0.0 else math.inf


@inner_kernel
def _aperiodic(delta):
    """Largest rate of a motion without oscillation, abs(delta) >= 1."""
    h = math.sqrt(delta * delta - 1.0)
    return h - delta if delta < 0.0 else -1.0 / (delta + h)


@kernel
def growth_of(belt):
    """Growth rate and frequency of a small vibration about steady sliding.

    At a break point, each half of a turn is in a segment of its own.  Where one of them has no half turn, the
    motion grows or settles in it, and growth wins: its own direction is never left.
    """
    above = damping_in(belt, segment_above(belt, belt.v))
    below = damping_in(belt, segment_below(belt, belt.v))
    w_above, t_above = _half_turn(above)
    w_below, t_below = _half_turn(below)
    if above == below and w_above > 0.0:
        return -above, w_above
    if w_above > 0.0 and w_below > 0.0:
        whole = t_above + t_below
        return -(above * t_above + below * t_below) / whole, 2.0 * math.pi / whole
    if min(above, below) <= -1.0:
        return _aperiodic(min(above, below)), 0.0
    return _aperiodic(max(above, below)), 0.0


@kernel
def _undecided(first, second):
    """Whether a turn, in two parts, has neither gain nor loss: an undamped mass under constant friction."""
    gains_or_losses = False
    for i in range(LOWEST + 2, LOWEST + 7):  # LOSS and the four sums
        gains_or_losses = gains_or_losses or first[i] != 0.0 or second[i] != 0.0
    return not gains_or_losses


@kernel
def slip_from_release(belt, first, second):
    """How the slip that begins at the end of a stop goes on, from there and from its maximum."""
    code = from_release(belt, first)
    if code != MAXIMUM:
        return code
    code = next_maximum(belt, second, first[X])
    if belt.mu == 1.0 and code == STOP and _undecided(first, second):
        return MAXIMUM  # it only just returns, and a stop has no duration
    return code


@kernel
def _put_stick_slip(belt, found, at, first, second):
    """Store the stick-slip cycle."""
    stop = (release_of(belt) - second[X]) / belt.v
    period = first[TIME] + second[TIME] + stop
    found.period[at] = period
    found.stops[at] = 1.0
    found.stuck[at] = stop / period
    found.highest[at] = first[X]
    found.lowest[at] = second[LOWEST]
    found.multiplier[at] = 0.0
    found.knots[at] = first[KNOTS] + second[KNOTS]


@kernel
def _put_cycle(belt, found, at, turn, x):
    """Store a cycle without stops from its maximum."""
    next_maximum(belt, turn, x)
    found.period[at] = turn[TIME]
    found.stops[at] = 0.0
    found.stuck[at] = 0.0
    found.highest[at] = x
    found.lowest[at] = turn[LOWEST]
    found.multiplier[at] = math.exp(-damping_of(turn))
    found.knots[at] = turn[KNOTS]


@kernel
def _put_sliding(belt, found, at):
    """Store steady sliding."""
    steady = belt.beta * factor_at(belt, belt.v)
    found.period[at] = math.nan
    found.stops[at] = 0.0
    found.stuck[at] = 0.0
    found.highest[at] = steady
    found.lowest[at] = steady
    found.multiplier[at] = math.nan
    found.knots[at] = 0.0


@kernel
def _find_cycles(belt, search, steady):
    """Find all cycles without stops; their number, and whether it is proved that there are no more."""
    turn = search.turns[2]
    first, last = first_to_stop(belt, turn), last_to_stop(belt, turn)
    begin = steady
    if not math.isnan(first):
        gap = 1e-12 * (abs(first) + abs(steady))  # as in `cycles`
        count = find_between(belt, search, 0, begin, first - gap, steady)
        if math.isnan(last):
            return count, True  # every larger motion stops
        begin = last + 1e-12 * (abs(last) + abs(steady))
    else:
        count = 0
    return find_beyond(belt, search, count, begin, steady)


@kernel
def _ends_at(belt, search, count, first, second):
    """The cycle without stops in which the slip from the release ends; -1 for steady sliding."""
    place = 0
    while place < min(count, MOST_CYCLES) and search.cycles[place] < first[X]:
        place += 1
    outwards = second[X] > first[X]
    chosen = place if outwards else place - 1
    return chosen if chosen < min(count, MOST_CYCLES) else -1


@kernel
def put_portrait(belt, found, at, search):
    """Fill a cell."""
    first, second = search.turns[0], search.turns[1]
    steady = belt.beta * factor_at(belt, belt.v)
    growth, frequency = growth_of(belt)
    found.growth[at], found.frequency[at] = growth, frequency
    search.left[0] = MOST_INTERVALS
    count, proved = _find_cycles(belt, search, steady)
    whole = proved and count <= MOST_CYCLES and search.left[0] > 0
    found.status[at] = regimes.RESOLVED if whole else regimes.NOT_REACHED
    bits = 1 << regimes.STEADY_SLIDING if growth < 0.0 else 0
    found.threshold[at] = math.nan
    for i in range(min(count, MOST_CYCLES) - 1, -1, -1):
        if search.damping[i] > 0.0:
            bits |= 1 << regimes.CYCLE_WITHOUT_STOPS
        else:
            found.threshold[at] = search.cycles[i]
    code = slip_from_release(belt, first, second)
    if code == STOP:
        bits |= 1 << regimes.STICK_SLIP_CYCLE
        found.regime[at] = regimes.STICK_SLIP_CYCLE
        _put_stick_slip(belt, found, at, first, second)
    else:
        place = _ends_at(belt, search, count, first, second) if code == MAXIMUM else -1
        if place >= 0:
            found.regime[at] = regimes.CYCLE_WITHOUT_STOPS
            _put_cycle(belt, found, at, search.turns[2], search.cycles[place])
        else:
            found.regime[at] = regimes.STEADY_SLIDING
            _put_sliding(belt, found, at)
            if growth == 0.0:
                found.status[at] = regimes.MARGINAL
    found.reachable[at] = bits

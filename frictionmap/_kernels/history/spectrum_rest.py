"""One oscillator after its record, without load, until it rests permanently."""

import math

from ..compiler import kernel
from .course import CREEPING, RESOLVED, RINGING
from .spectrum_lanes import (
    ACC,
    ASLEEP,
    BETA,
    DAMPING,
    DISTANCE,
    FORCE,
    FROM,
    LOAD,
    MOST_TERMS,
    PEAK,
    RATE,
    REACH,
    SENSE,
    SQUARE,
    STATIC,
    STATUS,
    STOPS,
    TURN,
    TURNS,
    V,
    X,
)
from .spectrum_sample import release, slide, stick

#: Steps to the first stop at most.  Each is 1 over the rate of the fastest part, in which the slowest one has
#: then fallen by e^-40, or a velocity that changes its sign has done so.
_MOST_STEPS = 80

#: Half cycles after which a motion is not asleep.
_MOST_HALVES = 10**6


@kernel
def _sleeps(state, i, time):
    """End the motion at rest."""
    state[STATUS, i], state[ASLEEP, i] = RESOLVED, time


@kernel
def _ends_in_the_limit(state, i, stops, time):
    """End a slide where friction and spring balance; it takes for ever unless it stops."""
    x = -state[FORCE, i] / state[SQUARE, i]
    state[DISTANCE, i] += abs(x - state[FROM, i])
    state[REACH, i] = max(state[REACH, i], abs(x))
    state[X, i] = x
    if stops:
        state[STOPS, i] += 1.0
        stick(state, i)
        _sleeps(state, i, time)
    else:
        state[STATUS, i], state[ASLEEP, i] = CREEPING, math.nan


@kernel
def _slide_freely(state, i, time):
    """Slide without a spring until friction has taken the velocity."""
    v, beta = state[V, i], state[BETA, i]
    if beta == 0.0:  # for ever
        state[REACH, i] = state[DISTANCE, i] = math.inf
        state[STATUS, i], state[ASLEEP, i] = RINGING, math.nan
        return
    state[X, i] += v * abs(v) / (2.0 * beta)
    state[DISTANCE, i] += abs(state[X, i] - state[FROM, i])
    state[REACH, i] = max(state[REACH, i], abs(state[X, i]))
    state[STOPS, i] += 1.0
    stick(state, i)
    _sleeps(state, i, time + abs(v) / beta)


@kernel
def _swing(state, i, zeta, time):
    """Swing from a turn until asleep: a half cycle costs 2 beta of the force of the spring, and damping."""
    square = state[SQUARE, i]
    centre, limit = state[BETA, i] / square, state[STATIC, i] / square
    root = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    half = math.pi / (math.sqrt(square) * root)
    decay = math.exp(-math.pi * zeta / root)
    place, side = abs(state[X, i]), -state[SENSE, i]
    if centre == 0.0:
        state[DISTANCE, i] += place * (1.0 + decay) / (1.0 - decay)
        state[STATUS, i], state[ASLEEP, i] = RINGING, math.nan
        return
    for n in range(_MOST_HALVES):
        new = (place - centre) * decay - centre
        state[DISTANCE, i] += place + new
        if new <= limit:
            state[STOPS, i] += 1.0
            state[X, i] = -side * new
            stick(state, i)
            _sleeps(state, i, time + (n + 1.0) * half)
            return
        state[TURNS, i] += 1.0
        place, side = new, -side
    state[STATUS, i], state[ASLEEP, i] = RINGING, math.nan


@kernel
def _stops(state, i, zeta):
    """Whether the velocity of a slide changes its sign.

    With zeta >= 1 it does so once at most: if the slow part of it, v' + w (zeta + sqrt(zeta^2 - 1)) v, is
    opposed to it.
    """
    if zeta < 1.0:
        return True
    slow = state[ACC, i] + state[RATE, i] * state[V, i]
    return state[SENSE, i] * slow < 0.0


@kernel
def _until_first_stop(lanes, i, zeta, time):
    """Slide until the velocity is zero; return when."""
    state, given = lanes.state, lanes.series[LOAD]
    for k in range(given.size):
        given[k] = 0.0
    h = TURN / state[RATE, i]
    for _ in range(_MOST_STEPS):
        x = slide(lanes, i, h, False, MOST_TERMS)
        if x <= 1.0:
            return time + x * h
        time += h
    _ends_in_the_limit(state, i, zeta < 1.0, time)
    return time


@kernel
def rest(lanes, i, time):
    """Follow lane i after its record, which ends at `time`, until it is asleep."""
    state = lanes.state
    if state[STATUS, i] != RESOLVED:
        state[ASLEEP, i] = math.nan
        return
    square, damping = state[SQUARE, i], state[DAMPING, i]
    pull = -square * state[X, i]
    if state[SENSE, i] == 0.0:
        if abs(pull) <= state[STATIC, i]:
            _sleeps(state, i, time)
            return
        release(state, i, 1.0 if pull > 0.0 else -1.0, pull)
    state[ACC, i] = pull - state[FORCE, i] - damping * state[V, i]
    state[PEAK, i] = max(state[PEAK, i], abs(state[ACC, i]))
    if square == 0.0:
        _slide_freely(state, i, time)
        return
    zeta = 0.5 * damping / math.sqrt(square)
    state[STATUS, i] = RINGING
    if state[V, i] != 0.0:
        if not _stops(state, i, zeta):
            _ends_in_the_limit(state, i, False, time)
            return
        time = _until_first_stop(lanes, i, zeta, time)
        if state[STATUS, i] != RINGING:
            return
    if state[SENSE, i] == 0.0:
        _sleeps(state, i, time)
    elif zeta < 1.0:
        _swing(state, i, zeta, time)
    else:
        _ends_in_the_limit(state, i, False, time)

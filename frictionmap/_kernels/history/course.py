"""A record as polynomials over its intervals, and what a motion under it is asked for."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..general.problem import TURN

#: What became of a motion.
RESOLVED, RINGING, CREEPING, TOO_MANY_EVENTS, RECORD_TOO_SHORT, UNDETERMINED = 0, 1, 2, 3, 4, 5

#: Events in a part of an interval at most: more are chattering.
MOST_EVENTS = 2000

#: A force within this share of its limit is at it.
AT_LIMIT = 1e-14

#: Sense of a contact at the start that its law decides.
BY_LAW = 9

#: Places in `limits`: number of samples from a kept state to the next, 0: none; intervals after the record at
#: most; whether to end when asleep; whether states at events are kept.
EVERY, AFTER, TO_REST, LISTED = 0, 1, 2, 3

#: Whether a motion has ended: not yet, for all contacts, and not in the phase that is asked about.
AWAKE, ASLEEP, ELSEWHERE = 0, 1, 2

#: A slide is over for practical purposes below this speed, relative to displacements and the fastest rate, if
#: the structure has moved by less than this share of its displacements since the last sample: not at a turn.
_CREEP, _MOVED = 1e-15, 1e-12


class Course(NamedTuple):
    """A record in K - 1 intervals, and the one after it, which is repeated."""

    pieces: np.ndarray  # (K, D, terms) polynomials of the channels over the interval
    steps: np.ndarray  # (K,) lengths of the intervals
    times: np.ndarray  # (K,) when they begin
    jumps: np.ndarray  # (K,) bool: whether a channel jumps where the interval begins
    ties: np.ndarray  # (N, N) bool: `Problem.ties` of springs under varying normal loads
    direct: np.ndarray  # (N, D) displacement of walls by channels whose places or rates may jump


@kernel
def parts_of(rate, step):
    """Equal parts of an interval in which series are exact to rounding, at a bound on the rate of motion."""
    return max(1, int(math.ceil(rate * step / TURN)))


@kernel
def any_slides(sense):
    """Whether any contact slides; sense : (N,), or levels of banks."""
    found = False
    for j in range(sense.size):
        found = found or sense[j] != 0
    return found


@kernel
def slides_on_slowly(sense, place, velocity, last, size):
    """Whether a contact slides so slowly that rounding error hides it.

    Parameters
    ----------
    sense : see `any_slides`
    place, velocity : of the structure
    last : (m,) its place at the last sample; replaced by the present one
    size : displacement that the load can be expected to cause
    """
    speed, moved = 0.0, 0.0
    for m in range(last.size):
        speed = max(speed, abs(velocity[m]))
        size = max(size, abs(place[m]))
        moved = max(moved, abs(place[m] - last[m]))
        last[m] = place[m]
    return any_slides(sense) and speed <= _CREEP * size and moved <= _MOVED * size

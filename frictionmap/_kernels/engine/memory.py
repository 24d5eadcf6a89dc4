"""Anchors remembered, and how far two of them lie apart."""

import math
from typing import NamedTuple

import numpy as np

from ..jit import entry, inner_kernel, kernel
from ..one_mass.newton import full_period, half_periods

#: Anchors remembered, at least and at most: a steady period with more is not recognised.
_SHORTEST = 2048
_LONGEST = 2**18

#: Columns of the memory of anchors; the state follows.
COS, SIN, TIME, SIGN, STATE = 0, 1, 2, 3, 4

#: Excitation periods after which a steady motion repeats; one that takes more counts as not periodic.
LONGEST_PERIOD = 8


class Memory(NamedTuple):
    """The last anchors, in rings."""

    events: np.ndarray  # (length,) that ended the slides before them
    anchors: np.ndarray  # (length, STATE + numbers of a state)


class Recurrence(NamedTuple):
    """A moment when the motion was nearly where it is now."""

    lag: int  # slides since then; 0 if there was none
    distance: float  # how far from there it is now, relative to the motion
    halves: int  # half periods of the excitation since then


@entry
def make_memory(h, size):
    """Memory for scan steps of length h: the anchors of four periods of the load, and many more.

    It is as long as that and no longer: how far a return is looked for must not depend on another frequency.
    """
    length = int(min(max(_SHORTEST, math.ceil(2.0 / h)), _LONGEST))
    return Memory(np.empty(length), np.empty((length, STATE + size)))


@inner_kernel
def record_anchor(memory, column, event, contact_state, time, sign):
    """Note an anchor, all but its state."""
    memory.events[column] = event
    memory.anchors[column, COS] = contact_state.cos
    memory.anchors[column, SIN] = contact_state.sin
    memory.anchors[column, TIME] = time
    memory.anchors[column, SIGN] = sign


@inner_kernel
def turned(memory, now, then):
    """How far apart the load's phases of two anchors are."""
    anchors = memory.anchors
    return abs(anchors[now, COS] - anchors[then, COS]) + abs(anchors[now, SIN] - anchors[then, SIN])


@inner_kernel
def halves_between(memory, now, then):
    """Half periods between two anchors; 0 if one cannot be the return of the other."""
    anchors = memory.anchors
    halves = half_periods(anchors[now, TIME] - anchors[then, TIME])
    # after an odd number of them it is its mirror image
    mirrored = anchors[now, SIGN] != anchors[then, SIGN]
    return halves if (halves % 2 == 1) == mirrored else 0


@kernel
def could_recur(halves):
    """Whether a steady motion may take so many half periods to return."""
    return halves >= 1 and full_period(halves) <= LONGEST_PERIOD


@kernel
def settled(distance, old_distance, tolerance):
    """Whether returns that were `old_distance` and are `distance` off leave less than the tolerance to go."""
    rate = min(distance / old_distance, 0.999999) if old_distance > 0.0 else 0.0
    return distance * rate <= 10.0 * tolerance * (1.0 - rate)
